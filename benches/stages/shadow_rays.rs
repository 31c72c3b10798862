//! A ray from each of 32 samples of every facet to the light, through the tree of a ball of this many triangles.

use crate::harness::Case;
use crate::harness::shadow::Shadow;
use subpixel_shadows::Result;
use subpixel_shadows::caster_tree::CasterTree;
use subpixel_shadows::glam::Vec4;
use subpixel_shadows::gpu::{Gpu, Recorder};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::shadow_rays::{RayInputs, RayLists, RayStep, ShadowRays, TreeBuffers};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(shadow) = Shadow::new(gpu, size)? else { return Ok(Vec::new()) };
    let stage = ShadowRays::new(&gpu.device, &PrefixScan::new(&gpu.device), 1);
    let tree = CasterTree::new(shadow.setup.prepared.mesh())?;
    let buffers = TreeBuffers::new(&gpu.device, &gpu.queue, &tree.nodes, &tree.triangles)?;
    let eye = Vec4::from(shadow.frame.read(gpu)?[0].eye);
    buffers.place.write(&gpu.queue, &[tree.place(eye.truncate().as_dvec3(), f64::from(eye.w))]);
    let rays = RayLists::new(&gpu.device, &gpu.queue, shadow.facets.list.len(), 32)?;
    let mut encoder = gpu.encoder();
    stage.record_list(&mut Recorder::new(&gpu.device, &mut encoder, None).stage("setup"), &shadow.facets, &rays)?;
    gpu.submit_and_wait(encoder)?;
    let traced = rays.read(gpu)?[0] as usize;
    Ok(vec![Case {
        name: "shadow_rays".to_owned(),
        size,
        // A facet, and at the least a node and a triangle a ray.
        bytes: traced * (144 + 32 * (80 + 48)),
        atomics: 0,
        flops: traced * 32 * (8 * 12 + 24),
        record: Box::new(move |s| {
            let scene = RayInputs {
                samples: &shadow.samples,
                tree: &buffers,
                triangles: shadow.triangles(),
                positions: &shadow.setup.casters.positions,
            };
            stage.record(s, RayStep::Trace, &shadow.frame, scene, &shadow.facets, &rays)
        }),
    }])
}
