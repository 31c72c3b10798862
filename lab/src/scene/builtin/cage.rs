//! A bird cage of thin wires, with a ball on a perch inside, over a plane.

use super::View;
use super::build::{Build, around, at};
use glam::DVec3;
use std::f64::consts::TAU;
use subpixel_shadows::scene::Light;

/// Wires from bottom to top.
const WIRES: u32 = 84;

pub(super) fn cage() -> View {
    let mut b = Build::default();
    b.plane(12.0);
    // Radius and height of the wires along their length: a cylinder with a dome.
    let profile: Vec<(f64, f64)> = (0..=12)
        .map(|k| (1.0, 0.12 + 1.5 * f64::from(k) / 12.0))
        .chain((1..=24).map(|k| {
            let (sin, cos) = (TAU * 0.25 * f64::from(k) / 25.0).sin_cos();
            (cos, 1.62 + 0.95 * sin)
        }))
        .collect();
    for spoke in around(WIRES, 1.0, 0.0) {
        let path: Vec<(DVec3, f64)> = profile.iter().map(|&(r, y)| (spoke * r + DVec3::Y * y, 0.0075)).collect();
        b.tube(&path, 6, false);
    }
    // Hoops lie just outside the wires they hold.
    let hoops = [(0.3, 1.0), (0.62, 1.0), (0.94, 1.0), (1.26, 1.0), (1.62, 1.0)];
    let dome = [6, 11, 16, 20].map(|k| (profile[12 + k].1, profile[12 + k].0));
    for (y, r) in hoops.into_iter().chain(dome) {
        let ring: Vec<(DVec3, f64)> = around(168, r + 0.012, y).map(|p| (p, 0.009)).collect();
        b.tube(&ring, 6, true);
    }
    b.lathe(&[(0.0, -0.02), (1.12, -0.02), (1.14, 0.05), (1.06, 0.13), (0.0, 0.13)], 96);
    b.ball(at(0.0, 2.6, 0.0), 0.08, 24, 12);
    let ring: Vec<(DVec3, f64)> = around(32, 0.13, 0.0).map(|p| (at(p.x, 2.79 + p.z, 0.0), 0.018)).collect();
    b.tube(&ring, 8, true);
    b.rod(at(-1.0, 0.7, 0.1), at(1.0, 0.7, 0.1), 0.022, 0.022, 12);
    b.ball(at(0.12, 1.06, 0.1), 0.34, 48, 24);
    // The door stands open.
    let hinge = at(0.45, 0.35, 1.05);
    let across = at(0.55, 0.0, 0.42);
    for k in 0..9 {
        let p = hinge + across * (f64::from(k) / 8.0);
        b.rod(p, p + DVec3::Y * 0.62, 0.007, 0.007, 6);
    }
    for y in [0.0, 0.31, 0.62] {
        let lift = DVec3::Y * y;
        b.rod(hinge + lift - across * 0.02, hinge + lift + across * 1.02, 0.009, 0.009, 6);
    }
    View {
        build: b,
        eye: [2.6, 3.3, 5.2],
        target: [0.75, 0.75, -0.2],
        fov: 40.0,
        light: Light::Spot { position: [-3.1, 5.2, 2.3], target: [0.3, 0.6, 0.0], angle_degrees: 70.0 },
    }
}
