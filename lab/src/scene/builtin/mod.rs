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
mod leaves;
mod plane;
mod plant;
mod random;
mod sparse_city;
mod spheres;
mod treeline;
mod windmill;

use super::options::camera_at;
use super::{Base, Light, Scene};
use build::Build;

/// Names of the built-in scenes.
pub const BUILTIN_NAMES: [&str; 9] =
    ["windmill", "cage", "bicycle", "plant", "spheres", "knot", "city", "bumpy", "plane"];

/// Names of the built-in scenes in which casters are alpha-tested, which not all methods take.
pub const ALPHA_NAMES: [&str; 1] = ["leaves"];

/// Names of the built-in scenes that are made as a paper describes its own, for its experiments.
pub const PAPER_NAMES: [&str; 2] = ["treeline", "sparse-city"];

/// Names of all built-in scenes.
pub fn names() -> impl Iterator<Item = &'static str> {
    BUILTIN_NAMES.into_iter().chain(ALPHA_NAMES).chain(PAPER_NAMES)
}

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
        "leaves" => leaves::leaves(),
        "treeline" => treeline::treeline(),
        "sparse-city" => sparse_city::sparse_city(),
        _ => return None,
    };
    let camera = camera_at(&view.build.mesh, view.eye, view.target, view.fov);
    let Build { mesh, alpha, .. } = view.build;
    Some(Scene {
        name: name.into(),
        base: Base::Builtin(name.into()),
        mesh,
        alpha,
        camera,
        light: view.light,
        ground: None,
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::scene::Adjacency;

    #[test]
    fn scenes_have_about_the_triangles_that_are_stated() {
        let stated = [40_000, 60_000, 30_000, 21_000, 12_000, 155_000, 2_300_000, 460_000, 113, 111_000, 33_000];
        for (name, stated) in BUILTIN_NAMES.iter().chain(&PAPER_NAMES).zip(stated) {
            let scene = builtin(name).unwrap();
            let n = scene.mesh.triangles.len();
            assert!(n.abs_diff(stated) * 20 <= stated, "{name}: {n} triangles");
        }
    }

    #[test]
    fn scenes_can_be_used_and_are_the_same_every_time() {
        for name in names() {
            let scene = builtin(name).unwrap();
            assert_eq!(scene.name, name);
            scene.alpha.check(&scene.mesh).unwrap();
            assert_eq!(scene.alpha.is_empty(), !ALPHA_NAMES.contains(&name));
            scene.mesh.check(name).unwrap();
            scene.camera.check().unwrap();
            scene.light.check().unwrap();
            assert_eq!(scene.mesh, builtin(name).unwrap().mesh, "{name}");
        }
        assert!(builtin("Windmill").is_none());
    }

    #[test]
    fn scenes_are_wound_consistently_without_shared_or_collapsed_faces() {
        for name in BUILTIN_NAMES.into_iter().chain(PAPER_NAMES) {
            let adjacency = Adjacency::of(&builtin(name).unwrap().mesh);
            let faults = (adjacency.non_manifold, adjacency.inconsistent, adjacency.collapsed);
            assert_eq!(faults, (0, 0, 0), "{name}");
            assert_eq!(adjacency.closed, matches!(name, "spheres" | "knot"), "{name}");
        }
    }

    #[test]
    fn lights_of_every_kind_shine() {
        let kinds = |wanted: fn(&Light) -> bool| BUILTIN_NAMES.iter().any(|n| wanted(&builtin(n).unwrap().light));
        assert!(kinds(|l| matches!(l, Light::Directional { .. })));
        assert!(kinds(|l| matches!(l, Light::Spot { .. })));
        assert!(kinds(|l| matches!(l, Light::Point { .. })));
    }
}
