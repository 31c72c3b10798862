//! Random meshes, cameras and lights.

use super::Random;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};

/// A value in [0, 1).
pub fn unit(random: &mut Random) -> f64 {
    f64::from(random.word()) / (f64::from(u32::MAX) + 1.0)
}

/// A vector in the cube from -1 to 1.
pub fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(unit(random), unit(random), unit(random)) * 2.0 - 1.0
}

/// Adds the triangles of another mesh.
pub fn append(mesh: &mut Mesh, other: Mesh) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
}

/// Adds a triangle with vertices of its own.
pub fn add_triangle(mesh: &mut Mesh, corners: [[f32; 3]; 3]) {
    append(mesh, Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2]] });
}

/// `n` triangles of this size, anywhere in the cube from -1 to 1.
pub fn soup(n: usize, size: f64, random: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for _ in 0..n {
        let at = vector(random);
        let corners = [at, at + vector(random) * size, at + vector(random) * size];
        add_triangle(&mut mesh, corners.map(|c| c.as_vec3().into()));
    }
    mesh
}

/// A box between two corners, wound outward.
pub fn add_box(mesh: &mut Mesh, lo: DVec3, hi: DVec3) {
    let base = mesh.positions.len() as u32;
    for k in 0..8 {
        let pick = |bit: u32, lo: f64, hi: f64| if k >> bit & 1 == 1 { hi } else { lo };
        let p = DVec3::new(pick(0, lo.x, hi.x), pick(1, lo.y, hi.y), pick(2, lo.z, hi.z));
        mesh.positions.push(p.as_vec3().into());
    }
    for [a, b, c, d] in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        mesh.triangles.extend([[a, b, c], [a, c, d]].map(|t| t.map(|v| v + base)));
    }
}

/// A square sheet of `n` × `n` quads around the origin, of half width `half`, turned by `turn` and lifted by `bump`.
pub fn sheet(n: u32, half: f64, bump: impl Fn(f64, f64) -> f64, turn: impl Fn(DVec3) -> DVec3) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=n {
        for i in 0..=n {
            let (x, z) = (f64::from(i) / f64::from(n) * 2.0 - 1.0, f64::from(j) / f64::from(n) * 2.0 - 1.0);
            let p = turn(DVec3::new(x * half, bump(x, z), z * half));
            mesh.positions.push(p.as_vec3().into());
        }
    }
    let row = n + 1;
    for j in 0..n {
        for i in 0..n {
            let a = i + j * row;
            mesh.triangles.extend([[a, a + row, a + 1], [a + 1, a + row, a + row + 1]]);
        }
    }
    mesh
}

/// A scene of one of four kinds: soup, closed boxes that run into each other over a floor, a bumpy open sheet, all doubled.
pub fn random_scene(kind: u32, random: &mut Random) -> Mesh {
    match kind % 4 {
        0 => soup(60, 0.5, random),
        1 => {
            let mut mesh = Mesh::default();
            add_box(&mut mesh, DVec3::new(-3.0, -1.2, -3.0), DVec3::new(3.0, -1.0, 3.0));
            for _ in 0..5 {
                let (at, size) = (vector(random) * 0.7, vector(random).abs() * 0.5 + 0.1);
                add_box(&mut mesh, at - size, at + size);
            }
            mesh
        }
        2 => {
            let phase = unit(random) * 6.0;
            let mut mesh = sheet(8, 1.5, |x, z| 0.3 * (7.0 * x + phase).sin() * (5.0 * z).cos() - 0.5, |p| p);
            append(&mut mesh, soup(10, 0.7, random));
            mesh
        }
        _ => doubled(random_scene(1, random)),
    }
}

/// Every triangle twice.
pub fn doubled(mut mesh: Mesh) -> Mesh {
    mesh.triangles.extend_from_within(..);
    mesh
}

/// A camera at `eye` that looks at `target`.
pub fn camera(eye: DVec3, target: DVec3, fov: f32) -> Camera {
    Camera {
        eye: eye.as_vec3().into(),
        target: target.as_vec3().into(),
        up: [0.03, 1.0, 0.02],
        vertical_fov_degrees: fov,
        near: 1e-4,
        far: 1e4,
        lens: Lens::CENTRED,
        near_plane: None,
    }
}

/// An oblique near plane through a place between eye and target.
pub fn oblique(camera: &Camera, share: f32, tilt: [f32; 3]) -> Option<[f32; 4]> {
    let [eye, target] = [camera.eye, camera.target].map(Vec3::from);
    let normal = (target - eye).normalize() + Vec3::from(tilt);
    Some(normal.extend(-normal.dot(eye + share * (target - eye))).into())
}

/// A light in a random direction, mostly above, or at a point there outside the scene.
pub fn random_light(directional: bool, random: &mut Random) -> Light {
    let v = vector(random) + DVec3::new(0.0, 1.3, 0.0);
    if directional {
        Light::Directional { direction: v.as_vec3().into() }
    } else {
        Light::Point { position: (v.normalize() * 6.0).as_vec3().into() }
    }
}
