//! The summed-area table of a square map, of bits and of words, with long and with short strips.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::SummedArea;
use subpixel_shadows::stages::summed_area::Texels;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let side = size.isqrt();
    let mut cases = Vec::new();
    for (name, texels, strip) in [
        ("summed_area bits", Texels::Bits, 4096),
        ("summed_area bits, strips", Texels::Bits, 32),
        ("summed_area words", Texels::Words, 4096),
    ] {
        let stage = SummedArea::new(&gpu.device, texels);
        let map = words(texels.row_words(side) * side);
        let input = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.input", &map)?;
        let sat = Buffer::storage(&gpu.device, "bench.sat", side * side)?;
        let scratch = stage.scratch_with_strips(&gpu.device, side, side, strip)?;
        cases.push(Case {
            name: name.to_owned(),
            size: side * side,
            bytes: (map.len() + side * side) * 4,
            atomics: 0,
            flops: 0,
            record: Box::new(move |s| stage.record(s, &input, &sat, &scratch)),
        });
    }
    Ok(cases)
}
