//! Built-in scenes: made from numbers alone, the same every time.
//!
//! The casters are in the spirit of those that the papers show: thin bars, wires, spokes and leaves, tangled tubes,
//! very many triangles, and few long edges.

mod bicycle;
mod build;
mod bumpy;
mod cage;
mod city;
mod knot;
mod plane;
mod plant;
mod random;
mod spheres;
mod windmill;

use super::options::camera_at;
use super::{Light, Scene};
use build::Build;

/// Names of the built-in scenes.
pub const BUILTIN_NAMES: [&str; 9] =
    ["windmill", "cage", "bicycle", "plant", "spheres", "knot", "city", "bumpy", "plane"];

/// The built-in scene of this name, if there is one. Lengths are in metres, y is up.
pub fn builtin(name: &str) -> Option<Scene> {
    let view = match name {
        "windmill" => windmill::windmill(),
        "cage" => cage::cage(),
        "bicycle" => bicycle::bicycle(),
        "plant" => plant::plant(),
        "spheres" => spheres::spheres(),
        "knot" => knot::knot(),
        "city" => city::city(),
        "bumpy" => bumpy::bumpy(),
        "plane" => plane::plane(),
        _ => return None,
    };
    let camera = camera_at(&view.build.mesh, view.eye, view.target, view.fov);
    Some(Scene { name: name.into(), mesh: view.build.mesh, camera, light: view.light, ground: None })
}

/// A scene's geometry with the place it is seen from and lit from.
struct View {
    build: Build,
    eye: [f32; 3],
    target: [f32; 3],
    /// Vertical field of view, degrees.
    fov: f32,
    light: Light,
}
