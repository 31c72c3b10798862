//! Scenes for unit tests, of the types of this build: those of `lab` are of the library as it is built without tests.

use crate::scene::{Camera, Lens, Light, Mesh};

/// A mesh, seen and lit.
pub(crate) struct Scene {
    pub mesh: Mesh,
    pub camera: Camera,
    pub light: Light,
}

/// The built-in scene of that name.
pub(crate) fn builtin(name: &str) -> Scene {
    of_lab(lab::scene::builtin(name).expect("a built-in scene"))
}

/// A mesh, framed by the camera.
pub(crate) fn of_mesh(mesh: Mesh) -> Scene {
    let Mesh { positions, triangles } = mesh;
    let mesh = lab::scene::Mesh { positions, triangles };
    of_lab(lab::scene::Scene::of_mesh("test", mesh).expect("a scene"))
}

fn of_lab(scene: lab::scene::Scene) -> Scene {
    let lab::scene::Mesh { positions, triangles } = scene.mesh;
    let lab::scene::Camera { eye, target, up, vertical_fov_degrees, near, far, lens, near_plane } = scene.camera;
    let lab::scene::Lens { shift, pixel_aspect, mirrored } = lens;
    let lens = Lens { shift, pixel_aspect, mirrored };
    let light = match scene.light {
        lab::scene::Light::Directional { direction } => Light::Directional { direction },
        lab::scene::Light::Point { position } => Light::Point { position },
        lab::scene::Light::Spot { position, target, angle_degrees } => Light::Spot { position, target, angle_degrees },
    };
    let camera = Camera { eye, target, up, vertical_fov_degrees, near, far, lens, near_plane };
    Scene { mesh: Mesh { positions, triangles }, camera, light }
}
