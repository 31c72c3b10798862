//! Sheets: a few ulps apart, as thin plates, in one plane, with T-junctions.

use super::place::{Place, few_ulps, moved};
use crate::fuzz::random::Random;
use crate::report::stability::shapes::{add, at, block, sheet};
use glam::DVec3;
use subpixel_shadows::scene::Mesh;

/// A level sheet of the unit square, bumpy or not.
fn level(r: &mut Random, n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    sheet(&mut mesh, at(-0.5, 0.0, -0.5), at(0.0, 0.0, 1.0), at(1.0, 0.0, 0.0), n);
    if r.chance(0.4) {
        let bump = r.pick([0.3, 0.05, 1e-3]);
        mesh.positions.iter_mut().for_each(|p| p[1] = (bump * r.unit()) as f32);
    }
    mesh
}

/// Sheets 1 to 1000 ulps apart: loose, or welded at the border, at an edge, at a corner, or at any vertices.
pub(super) fn layered(r: &mut Random) -> Mesh {
    let n = r.count(1, 7);
    let plain = level(r, n);
    let first = Place::any(r).put(&plain);
    let mut mesh = first.clone();
    let (axes, weld) = (r.whole(1, 7), r.whole(0, 5));
    for _ in 0..r.pick([1, 1, 1, 2, 3]) {
        let by = few_ulps(r);
        let each = r.chance(0.3);
        let row = n + 1;
        let shared = |r: &mut Random, v: u32| match weld {
            0 | 1 => false,
            2 => v.is_multiple_of(row) || v % row == n || v / row == 0 || v / row == n,
            3 => v.is_multiple_of(row),
            4 => v == 0,
            _ => r.chance(0.4),
        };
        let places: Vec<u32> = (0..first.positions.len() as u32)
            .map(|v| {
                if shared(r, v) {
                    return v;
                }
                let by = if each { few_ulps(r) } else { by };
                mesh.positions.push(moved(first.positions[v as usize], axes, by));
                mesh.positions.len() as u32 - 1
            })
            .collect();
        let flip = r.chance(0.4);
        mesh.triangles.extend(first.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| places[v as usize]);
            if flip { [a, c, b] } else { [a, b, c] }
        }));
    }
    above(r, mesh)
}

/// With something that casts a shadow on it, mostly.
fn above(r: &mut Random, mut mesh: Mesh) -> Mesh {
    let Some((low, high)) = mesh.bounds() else { return mesh };
    let (size, centre) = ((high - low).length(), (low + high) * 0.5);
    if size.is_normal() && r.chance(0.7) {
        for _ in 0..r.whole(1, 3) {
            let from = centre + r.vector() * size * 0.6;
            add(&mut mesh, &[from, from + r.vector() * size * 0.4, from + r.vector() * size * 0.4], &[[0, 1, 2]]);
        }
    }
    mesh
}

/// A closed plate 10^-7 to 10^-3 thick: two sheets and a rim, or two sheets that meet at their borders.
pub(super) fn plate(r: &mut Random) -> Mesh {
    let n = r.count(1, 7);
    let thick = r.by_size(1e-7, 1e-3);
    let height = r.pick([0.0, 0.8, 0.5, 3.0]);
    let mut mesh = Mesh::default();
    sheet(&mut mesh, at(-1.0, height + thick, -1.0), at(0.0, 0.0, 2.0), at(2.0, 0.0, 0.0), n);
    let row = n + 1;
    let border = |v: u32| v.is_multiple_of(row) || v % row == n || v / row == 0 || v / row == n;
    let shared = r.chance(0.5);
    let top = mesh.positions.len() as u32;
    let beneath: Vec<u32> = (0..top)
        .map(|v| {
            if shared && border(v) {
                return v;
            }
            let [x, _, z] = mesh.positions[v as usize];
            mesh.positions.push([x, height as f32, z]);
            mesh.positions.len() as u32 - 1
        })
        .collect();
    let of_top = mesh.triangles.clone();
    mesh.triangles.extend(of_top.iter().map(|&[a, b, c]| [a, c, b].map(|v| beneath[v as usize])));
    if !shared {
        // The rim, wound outward: along each side of the square.
        let sides = [
            (0..n).map(|k| (k, k + 1)).collect::<Vec<_>>(),
            (0..n).map(|k| (row * k + n, row * k + row + n)).collect(),
        ];
        let back = [
            (0..n).map(|k| (row * n + k + 1, row * n + k)).collect::<Vec<_>>(),
            (0..n).map(|k| (row * k + row, row * k)).collect(),
        ];
        for (a, b) in sides.into_iter().chain(back).flatten() {
            let (c, d) = (beneath[a as usize], beneath[b as usize]);
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    let placed = Place::any(r).put(&mesh);
    above(r, placed)
}

/// Triangles that overlap in one plane, with coordinates that are exact, under a few that cast shadows.
pub(super) fn coplanar(r: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    let grid = f64::from(r.pick([8, 64, 1024]));
    let [tilt_x, tilt_z] = [r.pick([0.0, 0.0, 0.5, 1.0]), r.pick([0.0, 0.0, 0.25, 2.0])];
    for _ in 0..r.count(2, 60) {
        let corner = |r: &mut Random| {
            let [x, z] = [(r.unit() * grid).round() / grid, (r.unit() * grid).round() / grid];
            at(x, tilt_x * x + tilt_z * z, z)
        };
        let corners = [corner(r), corner(r), corner(r)];
        let mut order = [0, 1, 2];
        if r.chance(0.3) && (corners[1] - corners[0]).cross(corners[2] - corners[0]).y < 0.0 {
            order.swap(1, 2);
        }
        add(&mut mesh, &corners, &[order]);
    }
    above(r, mesh)
}

/// Sheets of different grids that meet at a border, and triangles with a vertex on another's edge.
pub(super) fn t_junctions(r: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    let [left, right] = [r.whole(1, 6), r.whole(1, 9)];
    let rise = r.pick([0.0, 0.0, 0.5, 0.37]);
    sheet(&mut mesh, at(-1.0, 0.0, 0.0), at(0.0, 0.0, 1.0), at(1.0, 0.0, 0.0), left);
    sheet(&mut mesh, at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.0), at(1.0, rise, 0.0), right);
    for _ in 0..r.whole(0, 12) {
        let [a, b, c, d]: [DVec3; 4] = [r.point(), r.point(), r.point(), r.point()];
        let on = a.lerp(b, r.pick([0.5, 0.25, 1.0 / 3.0, 0.123]));
        add(&mut mesh, &[a, b, c, on, d], &[[0, 1, 2], [0, 3, 4], [3, 1, 4]]);
    }
    let placed = Place::any(r).put(&mesh);
    above(r, placed)
}

/// Boxes that share faces, edges or corners, stand on each other, or go through each other.
pub(super) fn contacts(r: &mut Random) -> Mesh {
    let mut mesh = Mesh::default();
    let mut low = at(0.0, 0.0, 0.0);
    for _ in 0..r.whole(2, 9) {
        let size = at(r.pick([1.0, 0.5, 0.3]), r.pick([1.0, 0.5, 0.3]), r.pick([1.0, 0.5, 0.3]));
        block(&mut mesh, low, low + size);
        let step = |r: &mut Random| r.pick([0.0, 0.0, 1.0, -1.0, 0.5]);
        low += size * at(step(r), step(r), step(r)) + r.vector() * r.pick([0.0, 0.0, 1e-7, 1e-3, 0.1]);
    }
    mesh
}
