//! Multisampled textures, of which one sample is read.

use super::*;
use crate::support::multisampled::{SAMPLES, multisampled};
use subpixel_shadows::stages::pixel_receivers::{GIVEN_NORMAL_SAMPLES, GIVEN_SAMPLES};

/// The sample of multisampled textures by which a case is given.
#[derive(Clone, Copy, Debug)]
pub struct GivenSample {
    /// Its number.
    held: u32,
    /// The number of the one that is read.
    read: u32,
    /// Where it lies in a pixel.
    pub at: [f32; 2],
}

/// Depths and normals of a case by one of four samples, the others holding something else, and what says so; what is not read where the case has none.
pub fn textures(gpu: &Gpu, case: &Case, size: [u32; 2], params: &mut PixelReceiversParams) -> [wgpu::TextureView; 2] {
    let unread = || unread_samples(&gpu.device);
    let Some(GivenSample { held, read, at }) = case.sample else { return [unread(), unread()] };
    let (values, ..) = case.depths.as_ref().expect("depths");
    let of = |rows: &dyn Fn(usize) -> [f32; 4], format| {
        let texel = |k: u32| {
            let pixels = 0..case.seen.len();
            pixels.map(move |p| if k == held { rows(p).map(f32::to_bits) } else { [(0.3 + k as f32).to_bits(); 4] })
        };
        multisampled(gpu, size, format, &(0..SAMPLES).flat_map(texel).collect::<Vec<_>>())
    };
    (params.sample, params.at) = (read, at);
    params.given |= GIVEN_SAMPLES;
    let depths = of(&|p| [values[p], 0.0, 0.0, 1.0], wgpu::TextureFormat::R32Float);
    let Some(normals) = &case.normals else { return [depths, unread()] };
    params.given |= GIVEN_NORMAL_SAMPLES;
    [depths, of(&|p| normals[p], wgpu::TextureFormat::Rgba16Float)]
}

/// Lets every caster be looked for in all pixels, as it may show where it holds no pixel's centre.
fn everywhere(world: &World) {
    let ([w, h], queue) = (world.view.image, &world.gpu.queue);
    let (casters, blocks) = (world.frame.triangle_count as usize, w.div_ceil(8) * h.div_ceil(8));
    world.facts.camera_rects.write(queue, &vec![[0, (w - 1) | (h - 1) << 16]; casters]);
    world.facts.camera_items.write(queue, &vec![blocks; casters]);
}

#[gpu_test]
fn one_sample_of_each_texel_is_read() {
    let mut random = Random::new(9);
    let mut casters = 0;
    for round in 0..8u32 {
        let world = world(gpu(), [[48, 36], [61, 31]][round as usize % 2], &mut random);
        everywhere(&world);
        let at = [unit(&mut random) * 0.99, unit(&mut random) * 0.99].map(|v| v as f32);
        let mut case = Case::new_at(&world, &mut random, at.map(f64::from));
        let sample = GivenSample { held: round % SAMPLES, read: round % SAMPLES, at };
        case.sample = Some(sample);
        let got = check(&world, &case);
        casters += got.keys.iter().filter(|&&key| key != 0 && !key < world.frame.triangle_count).count();
        // Normals of 16 bits.
        let mut with_normals = case.clone().with_normals(&mut random);
        let rounded = |v: f32| (v * 256.0).round() / 256.0;
        with_normals.normals.iter_mut().flatten().for_each(|n| *n = n.map(rounded));
        check(&world, &with_normals);
        // Another sample holds something else, and so does another place in the pixel.
        let elsewhere = at.map(|v| (v + 0.4) % 1.0);
        for other in [GivenSample { read: (round + 1) % SAMPLES, ..sample }, GivenSample { at: elsewhere, ..sample }] {
            let (found, _) = faults(&world, &case, &ask(&world, &Case { sample: Some(other), ..case.clone() }));
            assert!(found.len() > 20, "{other:?} passes for {sample:?}: {}", found.len());
        }
    }
    assert!(casters > 2000, "{casters} casters");
}
