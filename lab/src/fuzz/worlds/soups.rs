//! Triangles without order: loose, welded, in fans, thin, repeated, degenerate.

use super::place::{few_ulps, moved};
use crate::fuzz::random::Random;
use crate::report::stability::shapes::add;
use glam::DVec3;
use subpixel_shadows::scene::Mesh;

const ONE: [u32; 3] = [0, 1, 2];

/// Triangles that share no vertex, of one size or of all.
pub(super) fn loose(r: &mut Random, most: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let size = r.pick([1.0, 0.5, 0.2, 0.05, 0.0]);
    for _ in 0..r.count(2, most) {
        let at = r.point();
        let each = if size == 0.0 { r.by_size(1e-3, 1.0) } else { size };
        add(&mut mesh, &[at, at + r.vector() * each, at + r.vector() * each], &[ONE]);
    }
    mesh
}

/// Triangles of any three of a few vertices.
pub(super) fn welded(r: &mut Random) -> Mesh {
    let vertices = r.count(4, 80);
    let positions: Vec<[f32; 3]> = (0..vertices).map(|_| r.point().as_vec3().into()).collect();
    let last = vertices - 1;
    let triangles = (0..r.count(2, 200)).map(|_| [r.whole(0, last), r.whole(0, last), r.whole(0, last)]).collect();
    Mesh { positions, triangles }
}

/// Fans of 3 to 19 triangles round common edges.
pub(super) fn fans(r: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    let (fans, most) = (r.count(1, 70), r.pick([10, 10, 19]));
    for _ in 0..fans {
        let blades = r.whole(3, most);
        let corners: Vec<DVec3> = (0..blades + 2).map(|_| r.point()).collect();
        let triangles: Vec<[u32; 3]> = (0..blades).map(|k| [0, 1, k + 2]).collect();
        add(&mut mesh, &corners, &triangles);
        if mesh.triangles.len() > 500 {
            break;
        }
    }
    mesh
}

/// Long thin triangles, beside a few that are not.
pub(super) fn slivers(r: &mut Random) -> Mesh {
    let mut mesh = loose(r, 6);
    for _ in 0..r.count(2, 120) {
        let (at, along, width) = (r.point(), r.direction() * r.between(0.3, 2.0), r.by_size(1e-6, 1e-1));
        add(&mut mesh, &[at, at + along, at + along * r.unit() + r.vector() * width], &[ONE]);
    }
    mesh
}

/// A mesh with some of its triangles again: the same, turned over, or both, once or many times.
pub(super) fn repeated(r: &mut Random, mut mesh: Mesh) -> Mesh {
    let before = mesh.triangles.len();
    let share = r.pick([0.1, 0.5, 1.0]);
    for t in 0..before {
        if !r.chance(share) {
            continue;
        }
        let many = r.whole(3, 19);
        for _ in 0..r.pick([1, 1, 1, 2, many]) {
            let [a, b, c] = mesh.triangles[t];
            let turned = r.chance(0.5);
            mesh.triangles.push(if turned { [a, c, b] } else { [b, c, a] });
        }
        if mesh.triangles.len() > 400 {
            break;
        }
    }
    mesh
}

/// A mesh with triangles of no area among its own: of two vertices, of one, with corners in a line, with corners at one place.
pub(super) fn degenerate(r: &mut Random, mut mesh: Mesh) -> Mesh {
    let before = mesh.triangles.len();
    for _ in 0..r.count(1, 40) {
        let t = r.whole(0, before.max(1) as u32 - 1) as usize;
        let Some(&[a, b, c]) = mesh.triangles.get(t) else { break };
        let corners = mesh.corners(t);
        match r.whole(0, 4) {
            0 => mesh.triangles.push([a, b, a]),
            1 => mesh.triangles.push([c, c, c]),
            2 => {
                let middle = corners[0].lerp(corners[1], r.pick([0.5, 0.25, 1.0 / 3.0]));
                mesh.positions.push(middle.as_vec3().into());
                mesh.triangles.push([a, b, mesh.positions.len() as u32 - 1]);
            }
            3 => {
                mesh.positions.push(mesh.positions[a as usize]);
                mesh.triangles.push([a, mesh.positions.len() as u32 - 1, c]);
            }
            _ => {
                let at = r.point();
                add(&mut mesh, &[at; 3], &[ONE]);
            }
        }
    }
    mesh
}

/// A placed mesh with copies of its triangles, a few ulps away at some of their corners, the others shared.
pub(super) fn near_copies(r: &mut Random, mut mesh: Mesh) -> Mesh {
    let before = mesh.triangles.len();
    let (share, same) = (r.pick([0.3, 1.0]), few_ulps(r));
    for t in 0..before {
        if !r.chance(share) {
            continue;
        }
        let mut copy = mesh.triangles[t];
        let (which, axes) = (r.whole(1, 7), r.whole(1, 7));
        for corner in (0..3).filter(|k| which >> k & 1 == 1) {
            let by = if r.chance(0.5) { same } else { few_ulps(r) };
            let p = moved(mesh.positions[copy[corner] as usize], axes, by);
            mesh.positions.push(p);
            copy[corner] = mesh.positions.len() as u32 - 1;
        }
        if r.chance(0.3) {
            copy.swap(1, 2);
        }
        mesh.triangles.push(copy);
    }
    mesh
}
