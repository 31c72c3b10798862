//! A ball in an image of 800 × 600: the lists of all pixels.

use crate::harness::Case;
use crate::harness::geometry::{IMAGE, Setup};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::pixel_triangles::{PixelLists, PixelTriangles};

/// Triangles that the lists can hold.
pub const ROOM: usize = 1 << 23;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let change = |frame: &mut Frame| {
        frame.flags |= Frame::CLAMP;
        frame.pixel_triangle_capacity = ROOM as u32;
    };
    let Some(setup) = Setup::with(gpu, size, change)? else { return Ok(Vec::new()) };
    let pixels = (IMAGE[0] * IMAGE[1]) as usize;
    let scan = PrefixScan::new(&gpu.device);
    let scratch = PrefixScan::scratch(&gpu.device, pixels)?;
    let stage = PixelTriangles::new(&gpu.device, &scan);
    let lists = PixelLists::new(&gpu.device, pixels, ROOM)?;
    let id_keys = Buffer::storage(&gpu.device, "bench.id_keys", pixels)?;
    let status = Buffer::storage(&gpu.device, "bench.status", 32)?;
    Ok(vec![Case {
        name: "pixel_triangles".to_owned(),
        size: setup.casters.triangles.len(),
        bytes: 3 * setup.in_camera.items * 96 + pixels * 40,
        atomics: 2 * pixels,
        flops: 3 * setup.cells_seen * 6,
        record: Box::new(move |s| {
            let blocks = setup.seen();
            stage.record(s, &setup.frame, blocks, blocks.args, &lists, &id_keys, &scratch, &status)
        }),
    }])
}
