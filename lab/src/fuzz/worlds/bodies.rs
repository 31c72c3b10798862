//! Closed bodies: alone, twice, one in the other; and things of very different sizes.

use super::place::{Place, few_ulps, moved};
use super::soups;
use crate::fuzz::random::Random;
use crate::report::stability::shapes::{add, at, ball, block};
use glam::{DVec3, Vec3};
use subpixel_shadows::scene::Mesh;

/// A box, a ball or a tetrahedron.
fn body(r: &mut Random, mesh: &mut Mesh) {
    let (centre, size) = (r.point(), r.by_size(0.1, 0.6));
    match r.whole(0, 3) {
        0 | 1 => block(mesh, centre - r.point() * size - 1e-3, centre + r.point() * size + 1e-3),
        2 => ball(mesh, centre, size, r.whole(3, 9), r.whole(2, 6)),
        _ => {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| centre + p * size);
            add(mesh, &corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        }
    }
}

/// A few bodies.
pub(super) fn tame(r: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    for _ in 0..r.whole(1, 4) {
        body(r, &mut mesh);
    }
    if r.chance(0.5) {
        let floor = [at(-2.0, 0.0, -2.0), at(-2.0, 0.0, 3.0), at(3.0, 0.0, 3.0), at(3.0, 0.0, -2.0)];
        add(&mut mesh, &floor, &[[0, 1, 2], [0, 2, 3]]);
    }
    mesh
}

/// Bodies that stand twice: at one place, a few ulps apart as a whole or vertex by vertex, or one in the other; some turned inside out.
pub(super) fn doubled(r: &mut Random) -> Mesh {
    let mut plain = Mesh::default();
    for _ in 0..r.whole(1, 3) {
        body(r, &mut plain);
    }
    let mut mesh = Place::any(r).put(&plain);
    let first = mesh.clone();
    for _ in 0..r.pick([1, 1, 2]) {
        let base = mesh.positions.len() as u32;
        let (how, axes, by) = (r.whole(0, 4), r.whole(1, 7), few_ulps(r));
        let few = r.pick([1, 2, 4]);
        let centre = first.bounds().map_or(DVec3::ZERO, |(low, high)| (low + high) * 0.5);
        let little = r.by_size(1e-7, 1e-1);
        let size = r.pick([1.0 + little, 0.5, 0.999]);
        for &p in &first.positions {
            mesh.positions.push(match how {
                0 => p,
                1 => moved(p, axes, by),
                2 => moved(p, axes, r.whole(0, 2 * few) as i32 - few as i32),
                _ => (centre + (Vec3::from(p).as_dvec3() - centre) * size).as_vec3().into(),
            });
        }
        let flip = r.chance(0.3);
        mesh.triangles.extend(first.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| v + base);
            if flip { [a, c, b] } else { [a, b, c] }
        }));
    }
    mesh
}

/// Huge triangles beside tiny bodies and soups.
pub(super) fn scales(r: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    let huge = r.by_size(1e1, 1e5);
    for _ in 0..r.whole(1, 5) {
        add(&mut mesh, &[r.vector() * huge, r.vector() * huge, r.vector() * huge], &[[0, 1, 2]]);
    }
    if r.chance(0.6) {
        let floor = [at(-huge, 0.0, -huge), at(-huge, 0.0, huge), at(huge, 0.0, huge), at(huge, 0.0, -huge)];
        add(&mut mesh, &floor, &[[0, 1, 2], [0, 2, 3]]);
    }
    for _ in 0..r.whole(1, 3) {
        let small = if r.chance(0.5) { tame(r) } else { soups::loose(r, 40) };
        let (size, shift) = (r.by_size(1e-4, 1.0), r.vector() * r.pick([0.0, 1.0, huge]));
        let put = |p: &[f32; 3]| (Vec3::from(*p).as_dvec3() * size + shift).as_vec3().into();
        join(&mut mesh, &Mesh { positions: small.positions.iter().map(put).collect(), triangles: small.triangles });
    }
    mesh
}

/// Adds one mesh to another.
pub(super) fn join(mesh: &mut Mesh, other: &Mesh) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend_from_slice(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
}
