//! Scenes of lights among their casters.

use lab::scene::{Scene, builtin};
use subpixel_shadows::scene::{Camera, Light, Mesh};

/// A light at a point.
pub fn point(position: [f32; 3]) -> Light {
    Light::Point { position }
}

fn add(mesh: &mut Mesh, corners: &[[f32; 3]], triangles: &[[u32; 3]]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend_from_slice(corners);
    mesh.triangles.extend(triangles.iter().map(|t| t.map(|v| v + first)));
}

/// A box between two corners, its faces to the outside.
fn block(mesh: &mut Mesh, low: [f32; 3], high: [f32; 3]) {
    let corners: [[f32; 3]; 8] =
        std::array::from_fn(|k| std::array::from_fn(|axis| if k >> axis & 1 == 0 { low[axis] } else { high[axis] }));
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, c, b], [a, d, c]]).collect();
    add(mesh, &corners, &triangles);
}

/// A room of twelve triangles with some furniture around a lamp: its walls reach behind every side's view.
pub fn room() -> Scene {
    let mut mesh = Mesh::default();
    block(&mut mesh, [-4.0, 0.0, -3.0], [4.0, 3.0, 3.0]);
    block(&mut mesh, [1.0, 0.0, 0.5], [2.0, 0.8, 1.5]);
    block(&mut mesh, [-2.0, 0.2, -2.0], [-1.2, 1.9, -1.4]);
    block(&mut mesh, [-0.3, 2.5, -0.2], [0.4, 2.6, 0.3]);
    block(&mut mesh, [0.9, 1.2, -1.8], [1.0, 2.2, -0.9]);
    block(&mut mesh, [-1.5, 0.7, 1.1], [-0.5, 0.75, 1.9]);
    let mut scene = Scene::of_mesh("room", mesh).expect("a scene");
    scene.camera =
        Camera { eye: [3.7, 2.7, 2.8], target: [-1.0, 0.7, -0.6], vertical_fov_degrees: 75.0, ..scene.camera };
    scene.light = point([0.1, 1.7, 0.05]);
    scene
}

/// As [`room`], without one of the wall's triangles: it is no closed body then, and the light stands outside the furniture.
fn hall() -> Scene {
    let mut scene = room();
    scene.mesh.triangles.remove(0);
    scene
}

/// Spheres around a lamp over a ground that is wide beside them.
pub fn wide() -> Scene {
    let mut scene = builtin("spheres").expect("a built-in scene");
    let far = 60.0;
    let corners = [[-far, -0.53, -far], [far, -0.53, -far], [far, -0.53, far], [-far, -0.53, far]];
    add(&mut scene.mesh, &corners, &[[0, 2, 1], [0, 3, 2]]);
    scene.light = point([0.8, 1.9, 0.9]);
    scene
}

/// Rooms, and built-in scenes with a lamp in their midst.
pub fn scenes() -> Vec<(&'static str, Scene)> {
    let with = |name: &'static str, light| (name, Scene { light, ..builtin(name).expect("a built-in scene") });
    vec![
        ("room", room()),
        ("hall", hall()),
        with("cage", point([0.5, 2.0, 0.8])),
        with("plant", point([0.3, 1.3, 0.2])),
        with("knot", point([0.3, 1.4, 0.2])),
        with("spheres", Light::Spot { position: [0.3, 1.6, 0.2], target: [0.0; 3], angle_degrees: 90.0 }),
    ]
}
