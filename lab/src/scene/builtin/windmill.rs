//! A tower windmill: lattice sails, railing, fence.

use super::View;
use super::build::{Build, around, at, steps};
use glam::{DAffine3, DQuat, DVec3};
use std::f64::consts::TAU;
use subpixel_shadows::scene::Light;

/// Height of the sails' shaft, and how far it stands before the tower's axis.
const HUB: DVec3 = DVec3::new(0.0, 11.2, 3.3);

pub(super) fn windmill() -> View {
    let mut b = Build::default();
    b.plane(80.0);
    tower(&mut b);
    gallery(&mut b);
    // Cap and sails are turned into the wind, which comes from the side of the sun.
    b.within(DAffine3::from_rotation_y(-0.85), |b| {
        cap(b);
        sails(b);
    });
    fence(&mut b);
    View {
        build: b,
        eye: [9.0, 13.5, 33.0],
        target: [5.4, 7.5, -1.5],
        fov: 43.0,
        light: Light::Directional { direction: [-0.66, 0.74, 0.2] },
    }
}

fn sails(b: &mut Build) {
    // The shaft rises a little towards the front.
    let shaft = DQuat::from_rotation_x(-0.12);
    b.within(DAffine3::from_rotation_translation(shaft, HUB), |b| {
        b.rod(at(0.0, 0.0, -3.0), at(0.0, 0.0, 0.5), 0.28, 0.2, 16);
        for k in 0..4 {
            let turn = DQuat::from_rotation_z(0.42 + TAU * 0.25 * f64::from(k));
            b.within(DAffine3::from_quat(turn), sail);
        }
    });
}

/// Radius of the tower at height `y`.
fn tower_radius(y: f64) -> f64 {
    4.2 - 0.17 * y
}

/// An eight-sided tower of overlapping boards on a brick base.
fn tower(b: &mut Build) {
    b.lathe(&[(0.0, -0.3), (4.3, -0.3), (4.3, 1.2), (0.0, 1.2)], 32);
    b.lathe(&[(0.0, 1.1), (tower_radius(1.1) - 0.12, 1.1), (tower_radius(10.0) - 0.12, 10.0), (0.0, 10.0)], 8);
    for k in 0..46 {
        let y = 1.25 + 0.19 * f64::from(k);
        b.rail(around(8, tower_radius(y) - 0.02, y), true, 0.05, 0.16);
    }
    for corner in 0..8 {
        let up = |y: f64| around(8, tower_radius(y) + 0.02, y).nth(corner).unwrap_or_default();
        b.beam(up(1.15), up(10.05), 0.2, 0.2);
    }
    // Door with boards, on the side that the camera sees.
    for k in 0..6 {
        let z = -0.62 + 0.25 * f64::from(k);
        b.brick(at(4.2, -0.1, z - 0.11), at(4.42, 2.1, z + 0.11));
    }
    b.brick(at(4.1, 2.14, -0.95), at(4.55, 2.3, 0.95));
}

/// The gallery around the tower with its struts and railing.
fn gallery(b: &mut Build) {
    let y = 4.4;
    for (k, (inner, outer)) in around(120, 3.2, y).zip(around(120, 5.3, y)).enumerate() {
        // Boards lie at two heights in turn, so that they do not cross each other's faces near the tower.
        let lift = DVec3::Y * (0.061 * (k % 2) as f64);
        b.beam(inner + lift, outer + lift, 0.2, 0.06);
    }
    b.rail(around(32, 4.9, y - 0.16), true, 0.16, 0.2);
    for (foot, head) in around(16, tower_radius(2.2) - 0.15, 2.2).zip(around(16, 4.9, y - 0.12)) {
        b.beam(foot, head, 0.13, 0.13);
    }
    for (foot, head) in around(32, 5.2, y - 0.1).zip(around(32, 5.2, y + 1.15)) {
        b.beam(foot, head, 0.09, 0.09);
    }
    for (foot, head) in around(256, 5.2, y + 0.2).zip(around(256, 5.2, y + 1.0)) {
        b.rod(foot, head, 0.014, 0.014, 6);
    }
    for (height, width) in [(0.18, 0.05), (0.62, 0.03), (1.02, 0.11)] {
        b.rail(around(64, 5.2, y + height), true, width, 0.05);
    }
    // Stair from the ground to the gallery.
    let (foot, head) = (at(-8.6, -0.1, 0.0), at(-4.9, y, 0.0));
    for side in [-0.5, 0.5] {
        let z = DVec3::Z * side;
        b.beam(foot + z, head + z, 0.06, 0.26);
        let lift = DVec3::Y * 0.95;
        b.beam(foot + z + lift, head + z + lift, 0.05, 0.05);
        for p in steps(foot + z, head + z, 11).skip(1) {
            b.beam(p, p + lift, 0.03, 0.03);
        }
    }
    for p in steps(foot, head, 22).skip(1) {
        b.brick(p + at(-0.14, -0.02, -0.49), p + at(0.14, 0.02, 0.49));
    }
}

/// The cap with shingles, and the tail pole with its braces.
fn cap(b: &mut Build) {
    let profile: Vec<(f64, f64)> = (0..=14)
        .map(|k| {
            let (sin, cos) = (TAU * 0.25 * f64::from(k) / 14.0).sin_cos();
            (if k == 14 { 0.0 } else { 2.75 * cos }, 10.05 + 2.6 * sin)
        })
        .collect();
    b.lathe(&[&[(0.0, 9.9), (2.9, 9.9), (2.9, 10.05)], &profile[..]].concat(), 32);
    for row in 1..13 {
        let (r, y) = profile[row];
        let (above, top) = profile[row + 1];
        let n = (r * 16.0) as u32;
        for (low, high) in around(n, r + 0.05, y).zip(around(n, above + 0.03, top)) {
            b.beam(low, low.lerp(high, 0.9), TAU * r / f64::from(n) * 0.86, 0.03);
        }
    }
    let (top, winch) = (at(0.0, 11.0, -2.4), at(0.0, 1.0, -8.4));
    b.beam(top, winch, 0.24, 0.24);
    for side in [-1.0, 1.0] {
        b.beam(at(side * 2.6, 10.3, -0.6), winch + at(side * 0.05, 0.8, 0.4), 0.14, 0.14);
        b.beam(winch + at(side * 1.1, -1.2, -0.2), winch + at(0.0, 1.2, 0.6), 0.1, 0.1);
    }
    for (k, angle) in (0..8).map(|k| (k, TAU * f64::from(k) / 8.0)) {
        let spoke = at(0.0, angle.sin(), angle.cos()) * 0.8;
        let side = 0.3 + 0.004 * f64::from(k);
        b.rod(winch + at(side, 0.0, 0.0), winch + at(side, 0.0, 0.0) + spoke, 0.03, 0.02, 6);
    }
}

/// One sail along +y: a stock, and on its one side a lattice of bars that twists towards the hub.
fn sail(b: &mut Build) {
    b.beam(at(0.0, 0.05, 0.1), at(0.0, 10.4, 0.1), 0.2, 0.26);
    let (inner, outer) = (1.7, 10.2);
    // The lattice leans back by this much per metre of width, more near the hub.
    let lean = |y: f64| 0.04 + 0.46 * (1.0 - y / 11.0).powi(2);
    let on = |x: f64, y: f64| at(x, y, 0.16 - x * lean(y));
    let rows = 102;
    for k in 0..=rows {
        let y = inner + (outer - inner) * f64::from(k) / f64::from(rows);
        let thick = if k % 6 == 0 { 0.05 } else { 0.022 };
        b.beam(on(-0.42, y), on(1.75, y), thick, thick);
    }
    for x in [-0.4, 0.3, 0.6, 0.9, 1.2, 1.45, 1.72] {
        let hem = if x == -0.4 || x == 1.72 { 0.046 } else { 0.026 };
        let path = (0..=28).map(|k| on(x, inner + (outer - inner) * f64::from(k) / 28.0));
        b.rail(path, false, hem, hem * 1.1);
    }
    // Diagonal wires.
    for k in 0..14 {
        let y = |k: i32| inner + (outer - inner) * f64::from(k) / 14.0;
        b.rod(on(0.1, y(k)), on(1.72, y(k + 1)), 0.009, 0.009, 4);
        b.rod(on(1.72, y(k)), on(0.1, y(k + 1)), 0.007, 0.007, 4);
    }
    // Wind board on the leading side.
    for k in 0..14 {
        let y = |f: f64| inner + (outer - inner) * (f64::from(k) + f) / 14.0;
        b.beam(on(-0.62, y(0.04)), on(-0.62, y(0.96)), 0.3, 0.02);
    }
}

/// A picket fence around the yard, open at the front.
fn fence(b: &mut Build) {
    let corners = [at(4.5, 0.0, 9.5), at(11.5, 0.0, 9.5), at(11.5, 0.0, -9.0), at(-12.0, 0.0, -9.0)];
    for (side, w) in corners.windows(2).enumerate() {
        let (from, to) = (w[0], w[1]);
        let along = (to - from).normalize();
        let out = along.cross(DVec3::Y);
        let n = ((to - from).length() / 0.3) as u32;
        for (k, p) in steps(from, to, n).enumerate().skip(side.min(1)) {
            let height = if k % 10 == 0 { 1.25 } else { 1.0 };
            let half = if k % 10 == 0 { 0.07 } else { 0.045 };
            let centre = p + DVec3::Y * (height * 0.5 - 0.05);
            b.block(
                centre,
                along * half,
                DVec3::Y * (height * 0.5 + 0.05),
                out * if k % 10 == 0 { 0.07 } else { 0.015 },
            );
        }
        for y in [0.3, 0.78].map(|y| y + 0.004 * side as f64) {
            b.beam(from + out * 0.03 + DVec3::Y * y, to + out * 0.03 + DVec3::Y * y, 0.04, 0.09);
        }
    }
}
