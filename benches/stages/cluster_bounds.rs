//! Boxes of the clusters of a ball of this many triangles, as if its vertices moved.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::ClusterBounds;
use subpixel_shadows::stages::cluster_bounds::{ClusterUses, cluster_uses};
use subpixel_shadows::stages::cluster_culling::CLUSTER;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let (mesh, edges) = (setup.prepared.mesh(), &setup.prepared.edges);
    let (lists, vertices) = (cluster_uses(mesh, edges), mesh.positions.len());
    let uses = ClusterUses::new(&gpu.device, &gpu.queue, &lists, vertices)?;
    let clusters = mesh.triangles.len().div_ceil(CLUSTER) + edges.len().div_ceil(CLUSTER);
    let boxes = Buffer::storage(&gpu.device, "bench.boxes", clusters)?;
    let stage = ClusterBounds::new(&gpu.device);
    Ok(vec![Case {
        name: "cluster_bounds".to_owned(),
        size: vertices,
        bytes: 16 * vertices + 36 * lists.len() + 32 * clusters,
        atomics: 0,
        flops: 6 * (vertices + lists.len()),
        record: Box::new(move |s| stage.record(s, &setup.casters.positions, &uses, &boxes)),
    }])
}
