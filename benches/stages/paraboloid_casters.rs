//! Casters of a ball into a paraboloid view of 512 × 512 texels.

use crate::harness::Case;
use crate::harness::geometry::{IMAGE, MAP, Setup};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Light};
use subpixel_shadows::stages::paraboloid_casters::{CurvedWork, ParaboloidCasters};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let (device, queue) = (&gpu.device, &gpu.queue);
    let bounds = setup.prepared.mesh().bounds().unwrap_or_default();
    let light = Light::Point { position: [2.0, 4.0, 1.0] };
    let view = LightView::paraboloids(bounds, &light, MAP, false)?[0];
    let camera = Camera::framing(bounds.0, bounds.1);
    let mut content = Frame::new(&camera, &light, &view, bounds, IMAGE, &Samples::new(Default::default(), 32)?);
    content.vertex_count = setup.casters.positions.len() as u32;
    let triangles = setup.casters.triangles.len();
    content.triangle_count = triangles as u32;
    let frame = Buffer::uniform(device, "bench.frame", 1)?;
    frame.write(queue, &[content]);
    let made = (MAP * MAP) as usize;
    let keys = Buffer::<u32>::storage(device, "bench.keys", made)?;
    let work = CurvedWork::new(device, queue, triangles, MAP)?;
    let stage = ParaboloidCasters::new(device, false);
    Ok(vec![Case {
        name: "paraboloid_casters".to_owned(),
        size: triangles,
        bytes: triangles * (16 + 48 + 8 + 4 + 12) + made * 4,
        atomics: made,
        flops: made * 50 + triangles * 300,
        record: Box::new(move |s| {
            let mesh = (&setup.casters.triangles, &setup.points);
            stage.record(s, &frame, mesh, &work, (&keys, MAP))
        }),
    }])
}
