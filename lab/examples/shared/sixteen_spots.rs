//! Boxes on a floor, and a spot above each.

use lab::scene::{Camera, Light, Mesh};

/// Sixteen boxes on a floor with their spots, and the camera that sees them.
pub fn sixteen_spots() -> (Mesh, Camera, Vec<Light>) {
    let mut mesh = Mesh {
        positions: vec![[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let mut lights = Vec::new();
    for k in 0..16u32 {
        let [x, z] = [k % 4, k / 4].map(|c| c as f32 * 1.7 - 2.55);
        let first = mesh.positions.len() as u32;
        for corner in 0..8u32 {
            let [a, b, c] = [0, 1, 2].map(|axis| (corner >> axis & 1) as f32);
            mesh.positions.push([x + 0.4 * a - 0.13 * c, 0.1 + 0.7 * b, z + 0.35 * c + 0.11 * a]);
        }
        for quad in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 2, 6, 4], [1, 5, 7, 3], [2, 3, 7, 6], [0, 4, 5, 1]] {
            let [a, b, c, d] = quad.map(|v: u32| first + v);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        let position = [x - 0.4, 1.9, z + 0.5];
        lights.push(Light::Spot { position, target: [x + 0.2, 0.2, z + 0.1], angle_degrees: 50.0 });
    }
    (mesh, Camera::look_at([0.5, 6.0, 7.0], [0.0; 3], [0.0, 1.0, 0.0], 45.0, 0.1), lights)
}
