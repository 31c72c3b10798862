//! Clusters of a ball of this many triangles, its edges and vertices, in the camera's view and then in the light's.

use crate::harness::Case;
use crate::harness::geometry::Setup;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::cluster_culling::{ClusterCulling, ClusterList, cluster_boxes};

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let Some(setup) = Setup::new(gpu, size)? else { return Ok(Vec::new()) };
    let (mesh, edges) = (setup.prepared.mesh(), &setup.prepared.edges);
    let elements = [mesh.triangles.len(), edges.len(), mesh.positions.len()];
    let boxes = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.boxes", &cluster_boxes(mesh, edges))?;
    let list = ClusterList::new(&gpu.device, &gpu.queue, elements)?;
    let stage = ClusterCulling::new(&gpu.device, &PrefixScan::new(&gpu.device));
    let clusters = boxes.len();
    Ok(vec![Case {
        name: "cluster_culling".to_owned(),
        size: clusters,
        // Both tests, then lists of those that are kept.
        bytes: 2 * clusters * 36,
        atomics: 0,
        // Eight corners in either view.
        flops: clusters * 8 * (25 + 60),
        record: Box::new(move |s| {
            stage.record_camera(s, &setup.frame, &boxes, &list, &setup.status)?;
            stage.record_light(s, &setup.frame, &boxes, &setup.requested, &list, &setup.status)
        }),
    }])
}
