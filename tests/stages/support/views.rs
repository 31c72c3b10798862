//! Worlds in views of the light other than the fitted one.

use super::shadow::World;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::light_view::{LightView, SplitPlan};
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Light, Mesh};

impl World {
    /// The same in the light's view of slice number `k` of what the camera sees.
    pub fn in_slice(
        gpu: &'static Gpu,
        mesh: &Mesh,
        (camera, light): (Camera, Light),
        size: [u32; 2],
        map: u32,
        samples: Samples,
        slice: Option<(SplitPlan, usize)>,
    ) -> Self {
        let prepared = Prepared::new(mesh).expect("a sound mesh");
        Self::of(gpu, prepared, (camera, light), size, map, samples, slice)
    }

    /// The same of a mesh in one of the paraboloid views of a light at a point, the last if there are fewer.
    pub fn in_paraboloid(
        gpu: &'static Gpu,
        mesh: &Mesh,
        (camera, light): (Camera, Light),
        size: [u32; 2],
        map: u32,
        samples: Samples,
        k: usize,
    ) -> Self {
        let prepared = Prepared::new(mesh).expect("a sound mesh");
        let bounds = prepared.mesh().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let views = LightView::paraboloids(bounds, &light, map, false).expect("views");
        Self::in_view(gpu, prepared, (camera, light), size, samples, views[k.min(views.len() - 1)])
    }
}
