//! The samples of a ball's pixels in an image of 800 × 600, 32 a pixel. The lists are made once before.

use super::pixel_triangles::ROOM;
use crate::harness::Case;
use crate::harness::geometry::{IMAGE, Setup};
use subpixel_shadows::Result;
use subpixel_shadows::frame::{Frame, sample_words};
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder, recorder};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::stages::compact::{Compact, Flags};
use subpixel_shadows::stages::facet_classify::Facets;
use subpixel_shadows::stages::pixel_triangles::{PixelLists, PixelTriangles};
use subpixel_shadows::stages::sample_surfaces::{ComplexPixels, SampleSurfaces, SurfaceInputs, WORKGROUP};
use subpixel_shadows::stages::{Count, PrefixScan};

const FACETS: usize = 1 << 20;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let pixels = (IMAGE[0] * IMAGE[1]) as usize;
    let change = |frame: &mut Frame| {
        frame.flags |= Frame::CLAMP;
        frame.pixel_triangle_capacity = ROOM as u32;
        frame.complex_capacity = pixels as u32;
        frame.facets_total = FACETS as u32;
    };
    let Some(setup) = Setup::with(gpu, size, change)? else { return Ok(Vec::new()) };
    let device = &gpu.device;
    let scan = PrefixScan::new(device);
    let scratch = PrefixScan::scratch(device, pixels)?;
    let lists = PixelLists::new(device, pixels, ROOM)?;
    let complex = ComplexPixels::new(device, &gpu.queue, pixels, 1)?;
    let facets = Facets::new(device, FACETS, pixels, 1)?;
    let id_keys = Buffer::storage(device, "bench.id_keys", pixels)?;
    let status = Buffer::storage(device, "bench.status", 32)?;
    let samples = Buffer::uniform(device, "bench.samples", 64)?;
    samples.write(&gpu.queue, &sample_words(&Samples::new(Default::default(), 32)?));
    let mut encoder = gpu.encoder();
    {
        let mut recorder = Recorder::new(device, &mut encoder, None);
        let stage = &mut recorder.stage("setup");
        let (find, blocks) = (PixelTriangles::new(device, &scan), setup.seen());
        find.record(stage, &setup.frame, blocks, blocks.args, &lists, &scratch, &status)?;
        let (flags, compact) = (Flags::Words(&lists.complex_flags), Compact::new(device, &scan));
        let own = Compact::scratch(device, pixels)?;
        let total = (&complex.total, 0);
        compact.record(stage, flags, None, &complex.pixels, total, &own, Count::Exactly(pixels))?;
    }
    gpu.submit_and_wait(encoder)?;
    let count = complex.total.read(gpu)?[0];
    // All but those of pixels that show one triangle.
    let listed = (lists.offsets.read(gpu)?[pixels] as usize).saturating_sub(pixels);
    let args = Buffer::<u32>::indirect(device, "bench.args", 3)?;
    args.write(&gpu.queue, &recorder::fold(u64::from(count.div_ceil(WORKGROUP))));
    let stage = SampleSurfaces::new(device, &scan, 32);
    Ok(vec![Case {
        name: "sample_surfaces".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: count as usize * 32 * 12 + pixels * 24,
        atomics: 0,
        flops: listed * (32 * 45 + 250),
        record: Box::new(move |s| {
            let (triangles, points) = (&setup.casters.triangles, &setup.points);
            let positions = &setup.casters.positions;
            let mesh = SurfaceInputs { samples: &samples, triangles, points, positions, surfaces: None };
            let per_pixel = (args.raw(), 0);
            stage.record(s, &setup.frame, mesh, &lists, &complex, per_pixel, 1, &scratch, &facets, &id_keys, None)
        }),
    }])
}
