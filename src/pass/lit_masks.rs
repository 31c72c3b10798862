//! The lit masks in an application's own shaders.

use crate::samples::Samples;
use crate::{Error, Result};
use std::fmt::Write;

/// WGSL that reads lit masks ([`ShadowPass::lit`](super::ShadowPass::lit), [`Target::lit`](super::Target::lit)) in a shader of the application's,
/// to be put before its text: the storage buffer `lit_masks` at this group and binding, and
///
/// - `lit_fraction(pixel: vec2<u32>, width: u32) -> f32`: share of the pixel's samples that are lit, of an image of `width` pixels a row. Those that see
///   nothing beside a surface are not: it is the pixel's visibility times the share of its samples that see any;
/// - `lit_sample(pixel: vec2<u32>, width: u32, sample: u32) -> bool`: one of its samples;
/// - with `hardware`, the places of a multisampled target's samples within the pixel (as [`SampleTexture::STANDARD_4`](super::SampleTexture::STANDARD_4)),
///   `lit_hardware(pixel: vec2<u32>, width: u32, sample: u32) -> f32`: the share of lit ones among the samples that are nearer to this hardware
///   sample than to any other, or to two alike; where there is none, of the nearest. Shading that runs a sample at a time takes each sample's own visibility from it.
///
/// # Errors
/// [`Error::Config`] for hardware samples outside the pixel, twice at one place, or more than 32.
pub fn lit_masks_wgsl(samples: &Samples, group: u32, binding: u32, hardware: &[[f32; 2]]) -> Result<String> {
    let (count, words) = (samples.count(), samples.words());
    let last = u32::MAX >> (32 * words - count);
    let mut text = include_str!("lit_masks.wgsl").to_owned();
    for (name, value) in [("group", group), ("binding", binding), ("words", words), ("last", last), ("count", count)] {
        text = text.replace(&format!("{{{name}}}"), &value.to_string());
    }
    if !hardware.is_empty() {
        text += &hardware_wgsl(&hardware_masks(samples, hardware)?, words);
    }
    Ok(text)
}

/// The samples that belong to each hardware sample, a mask each.
pub(crate) fn hardware_masks(samples: &Samples, hardware: &[[f32; 2]]) -> Result<Vec<u128>> {
    let wrong = |text: String| Err(Error::Config(format!("hardware samples: {text}")));
    if hardware.len() > 32 {
        return wrong(format!("{} a pixel; at most 32", hardware.len()));
    }
    for (k, at) in hardware.iter().enumerate() {
        if !at.iter().all(|c| (0.0..=1.0).contains(c)) {
            return wrong(format!("sample {k} at ({}, {}) lies outside the pixel", at[0], at[1]));
        }
        if let Some(same) = hardware[..k].iter().position(|other| other == at) {
            return wrong(format!("samples {same} and {k} are both at ({}, {})", at[0], at[1]));
        }
    }
    let distance = |a: &[f32; 2], b: &[f32; 2]| (f64::from(a[0] - b[0])).hypot(f64::from(a[1] - b[1]));
    let nearest =
        |from: &[f32; 2], among: &[[f32; 2]]| among.iter().map(|to| distance(from, to)).fold(f64::MAX, f64::min);
    let mask_of = |at: &[f32; 2]| {
        let own = |o: &[f32; 2]| distance(o, at) <= nearest(o, hardware);
        let closest = |o: &[f32; 2]| distance(o, at) <= nearest(at, samples.offsets());
        let of = |belongs: &dyn Fn(&[f32; 2]) -> bool| {
            samples.offsets().iter().enumerate().fold(0u128, |mask, (k, o)| mask | u128::from(belongs(o)) << k)
        };
        match of(&own) {
            0 => of(&closest),
            mask => mask,
        }
    };
    Ok(hardware.iter().map(mask_of).collect())
}

fn hardware_wgsl(masks: &[u128], words: u32) -> String {
    let mut text = String::from(
        "\n/// Share of the lit among the samples of a pixel that belong to a hardware sample.\nfn lit_hardware(pixel: vec2<u32>, width: u32, sample: u32) -> f32 {\n    let first = (pixel.y * width + pixel.x) * LIT_WORDS;\n    var own = 0u;\n    var lit = 0u;\n",
    );
    for word in 0..words {
        // A string takes all that is written.
        let _ = writeln!(text, "    switch sample {{");
        for (k, mask) in masks.iter().enumerate() {
            let case = if k + 1 == masks.len() { "default".to_owned() } else { format!("case {k}u") };
            let bits = (mask >> (32 * word)) as u32;
            let _ = writeln!(text, "        {case}: {{ own = {bits}u; }}");
        }
        let _ = writeln!(
            text,
            "    }}\n    let own_{word} = own;\n    lit += countOneBits(lit_masks[first + {word}u] & own);"
        );
    }
    let all: Vec<String> = (0..words).map(|word| format!("countOneBits(own_{word})")).collect();
    let _ = writeln!(text, "    return f32(lit) / f32({});\n}}", all.join(" + "));
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass::SampleTexture;
    use crate::samples::Pattern;

    #[test]
    fn samples_belong_to_the_nearest_hardware_sample() {
        for count in Samples::COUNTS {
            let samples = Samples::new(Pattern::LowDiscrepancy, count).expect("samples");
            let masks = hardware_masks(&samples, &SampleTexture::STANDARD_4).expect("masks");
            assert!(masks.iter().all(|mask| *mask != 0), "{count}");
            let all = masks.iter().fold(0, |all, mask| all | mask);
            assert_eq!(all, u128::MAX >> (128 - count), "{count}: each sample belongs somewhere");
            if count >= 8 {
                let owned: u32 = masks.iter().map(|mask| mask.count_ones()).sum();
                // The centre is as near to each of the four.
                assert_eq!(owned, count + 3, "{count}");
            }
        }
        let eight = Samples::new(Pattern::LowDiscrepancy, 8).expect("samples");
        for (bad, told) in [
            (&[[0.5, 1.5]][..], "sample 0 at (0.5, 1.5) lies outside the pixel"),
            (&[[0.25, 0.5], [0.75, 0.5], [0.25, 0.5]], "samples 0 and 2 are both at (0.25, 0.5)"),
            (&[[f32::NAN, 0.0]], "outside the pixel"),
            (&[[0.0; 2]; 33], "33 a pixel"),
        ] {
            let error = lit_masks_wgsl(&eight, 0, 0, bad).expect_err("refused").to_string();
            assert!(error.contains(told), "{error}");
        }
    }
}
