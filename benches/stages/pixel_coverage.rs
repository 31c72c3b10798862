//! The samples of a ball's pixels in an image of 800 × 600, 128 a pixel: with `sample_surfaces`, which uses up what this stage
//! leaves. The lists are made once before.

use super::pixel_triangles::ROOM;
use crate::harness::Case;
use crate::harness::geometry::{IMAGE, Setup};
use subpixel_shadows::Result;
use subpixel_shadows::frame::{Frame, sample_words};
use subpixel_shadows::gpu::{Buffer, Gpu, Groups, Recorder, recorder};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::stages::compact::{Compact, Flags};
use subpixel_shadows::stages::facet_classify::Facets;
use subpixel_shadows::stages::pixel_coverage::{PairCoverage, PixelCoverage};
use subpixel_shadows::stages::pixel_triangles::{PixelLists, PixelTriangles};
use subpixel_shadows::stages::sample_surfaces::{ComplexPixels, SampleSurfaces, SurfaceInputs, WORKGROUP};
use subpixel_shadows::stages::{Count, PrefixScan};

const FACETS: usize = 1 << 20;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    Ok(case(gpu, size, 128)?.into_iter().collect())
}

/// Both stages; `None` where the device has no room.
pub fn case(gpu: &Gpu, size: usize, samples: u32) -> Result<Option<Case<'_>>> {
    let pixels = (IMAGE[0] * IMAGE[1]) as usize;
    let change = |frame: &mut Frame| {
        frame.flags |= Frame::CLAMP;
        frame.pixel_triangle_capacity = ROOM as u32;
        frame.complex_capacity = pixels as u32;
        frame.facets_total = FACETS as u32;
        frame.sample_count = samples;
    };
    let Some(setup) = Setup::with(gpu, size, change)? else { return Ok(None) };
    let device = &gpu.device;
    let words = samples.div_ceil(32) as usize;
    let scan = PrefixScan::new(device);
    let scratch = PrefixScan::scratch(device, pixels)?;
    let lists = PixelLists::new(device, pixels, ROOM)?;
    let complex = ComplexPixels::new(device, pixels, words)?;
    let facets = Facets::new(device, FACETS, pixels, words)?;
    let id_keys = Buffer::storage(device, "bench.id_keys", pixels)?;
    let status = Buffer::storage(device, "bench.status", 32)?;
    let offsets = Buffer::uniform(device, "bench.samples", 64)?;
    offsets.write(&gpu.queue, &sample_words(&Samples::new(Default::default(), samples)?));
    let mut encoder = gpu.encoder();
    {
        let mut recorder = Recorder::new(device, &mut encoder, None);
        let stage = &mut recorder.stage("setup");
        let (find, blocks) = (PixelTriangles::new(device, &scan), setup.seen());
        find.record(stage, &setup.frame, blocks, blocks.args, &lists, &id_keys, &scratch, &status)?;
        let (flags, compact) = (Flags::Words(&lists.complex_flags), Compact::new(device, &scan));
        let own = Compact::scratch(device, pixels)?;
        let total = (&complex.total, 0);
        compact.record(stage, flags, None, &complex.pixels, total, &own, Count::Exactly(pixels))?;
    }
    gpu.submit_and_wait(encoder)?;
    let count = complex.total.read(gpu)?[0];
    let pairs = lists.offsets.read(gpu)?[pixels] as usize;
    let coverage = PairCoverage::new(device, pairs, words)?;
    let args = Buffer::<u32>::indirect(device, "bench.args", 3)?;
    args.write(&gpu.queue, &recorder::fold(u64::from(count.div_ceil(WORKGROUP))));
    let cover = PixelCoverage::new(device, samples, false);
    let stage = SampleSurfaces::new(device, &scan, samples);
    Ok(Some(Case {
        name: format!("pixel_coverage, sample_surfaces, {samples} samples"),
        size: setup.casters.triangles.len(),
        bytes: pairs * (8 + 60 + 20 + 4 * words) + pairs * 4 * (4 * words + 6) + pixels * 24,
        atomics: pairs,
        flops: pairs * (samples as usize * 34 + 300),
        record: Box::new(move |s| {
            let mesh = SurfaceInputs {
                samples: &offsets,
                triangles: &setup.casters.triangles,
                points: &setup.points,
                positions: &setup.casters.positions,
                surfaces: None,
            };
            let (frame, per_pixel) = (&setup.frame, (args.raw(), 0));
            cover.record(s, frame, mesh, &lists, &coverage, Groups::Items(pairs as u64));
            stage.record(s, frame, mesh, &lists, &coverage, &complex, per_pixel, 1, &scratch, &facets, &id_keys)
        }),
    }))
}
