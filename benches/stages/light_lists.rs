//! Lights listed by tiles: visibility of the pixels of a light that reaches half of them, from one facet a pixel; entries of a light.

use crate::harness::Case;
use crate::harness::geometry::{IMAGE, Setup, samples};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::facet_classify::{Facet, Facets};
use subpixel_shadows::stages::light_lists::{LightListMemory, LightLists, LightPart, words_for};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let side = 1 << (size.ilog2() / 2);
    let image = [side, size as u32 / side];
    let mut cases = Vec::new();
    let memory = LightListMemory::new(&gpu.device, image)?;
    let tiles = memory.tiles();
    memory.shares.write(&gpu.queue, &(0..16 * tiles as u32).map(|k| k / 16 % 2).collect::<Vec<_>>());
    let part = LightPart::everywhere(0, image, tiles as u32);
    let lists = Buffer::<u32>::storage(&gpu.device, "bench.lists", words_for(image, tiles as u64) as usize)?;
    let stage = LightLists::new(&gpu.device, 1);
    cases.push(Case {
        name: "light_lists append".to_owned(),
        size,
        // Bytes of visibility, a scan over tiles, and entries of half of them.
        bytes: 64 * tiles + 24 * tiles + (64 + 72 + 16) * tiles / 2,
        atomics: 0,
        flops: 0,
        record: Box::new(move |s| {
            stage.record_begin(s, part, lists.raw())?;
            stage.record_append(s, part, &memory, lists.raw())
        }),
    });
    if let Some(setup) = Setup::new(gpu, size)? {
        let pixels = setup.id_keys.len();
        let image = IMAGE;
        let facets = Facets::new(&gpu.device, pixels, pixels, 1)?;
        facets.list.write(&gpu.queue, &vec![Facet { state: 2, ..Facet::default() }; pixels]);
        facets.masks.write(&gpu.queue, &vec![u32::MAX; 3 * pixels]);
        facets.pixel_facets.write(&gpu.queue, &(0..=pixels as u32).collect::<Vec<_>>());
        let (samples, memory) = (samples(gpu, 32)?, LightListMemory::new(&gpu.device, image)?);
        let stage = LightLists::new(&gpu.device, 1);
        let part = LightPart { everywhere: 0, range: 1.0, ..LightPart::everywhere(0, image, 0) };
        cases.push(Case {
            name: "light_lists share".to_owned(),
            size: pixels,
            // State, triangle, masks and place of a facet, and a byte.
            bytes: pixels * (8 + 4 + 4 + 1),
            atomics: 0,
            // A plane, and where the ray and four corners meet it.
            flops: pixels * 150,
            record: Box::new(move |s| {
                let of = (&setup.frame, &samples, image);
                stage.record_share(s, of, part, &setup.casters, &facets, &memory)
            }),
        });
    }
    Ok(cases)
}
