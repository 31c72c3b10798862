//! A bicycle: tubes, spokes, chain.

use super::View;
use super::build::{Build, at};
use glam::{DAffine3, DQuat, DVec3};
use std::f64::consts::TAU;
use subpixel_shadows::scene::Light;

const REAR: DVec3 = DVec3::new(-0.52, 0.345, 0.0);
const FRONT: DVec3 = DVec3::new(0.53, 0.345, 0.0);
const CRANK: DVec3 = DVec3::new(-0.09, 0.28, 0.0);
const SEAT: DVec3 = DVec3::new(-0.24, 0.78, 0.0);
const HEAD: DVec3 = DVec3::new(0.34, 0.8, 0.0);

pub(super) fn bicycle() -> View {
    let mut b = Build::default();
    b.plane(8.0);
    // Leaning a little, as on a stand.
    b.within(DAffine3::from_rotation_x(-0.08), |b| {
        for (hub, turned) in [(REAR, 0.0), (FRONT, 0.1)] {
            b.within(DAffine3::from_rotation_translation(DQuat::from_rotation_z(turned), hub), wheel);
        }
        frame(b);
        steering(b);
        drive(b);
        saddle(b);
    });
    b.rod(at(-0.16, 0.3, 0.05), at(-0.2, -0.01, 0.32), 0.011, 0.009, 12);
    View {
        build: b,
        eye: [0.5, 1.5, 2.3],
        target: [0.07, 0.27, 0.24],
        fov: 39.0,
        light: Light::Directional { direction: [-0.22, 0.78, -0.55] },
    }
}

/// A point on a circle about the z axis.
fn turned(radius: f64, angle: f64, z: f64) -> DVec3 {
    at(radius * angle.cos(), radius * angle.sin(), z)
}

fn hoop(n: u32, radius: f64, thickness: f64) -> Vec<(DVec3, f64)> {
    (0..n).map(|k| (turned(radius, TAU * f64::from(k) / f64::from(n), 0.0), thickness)).collect()
}

/// A wheel about the z axis at the origin.
fn wheel(b: &mut Build) {
    b.tube(&hoop(112, 0.328, 0.0165), 14, true);
    b.tube(&hoop(112, 0.304, 0.009), 8, true);
    // Tread.
    for k in 0..112 {
        let angle = TAU * (f64::from(k) + 0.5) / 112.0;
        let side = if k % 2 == 0 { 0.006 } else { -0.006 };
        let out = turned(1.0, angle, 0.0);
        b.block(out * 0.3445 + DVec3::Z * side, out * 0.002, turned(0.005, angle + TAU * 0.25, 0.0), DVec3::Z * 0.005);
    }
    b.rod(at(0.0, 0.0, -0.05), at(0.0, 0.0, 0.05), 0.016, 0.016, 16);
    for side in [-1.0, 1.0] {
        b.rod(at(0.0, 0.0, side * 0.034), at(0.0, 0.0, side * 0.038), 0.029, 0.029, 24);
        // Spokes leave the flange along its tangent, two and two crossing.
        for k in 0..18 {
            let angle = TAU * (f64::from(k) + if side > 0.0 { 0.25 } else { -0.25 }) / 18.0;
            let swing = if k % 2 == 0 { 1.25 } else { -1.25 };
            let layer = if k % 2 == 0 { 0.0022 } else { -0.0022 };
            let start = turned(0.026, angle + swing, side * 0.036 + layer);
            b.rod(start, turned(0.299, angle, side * 0.003), 0.0011, 0.0011, 6);
        }
    }
}

fn frame(b: &mut Build) {
    let tube = |b: &mut Build, from: DVec3, to: DVec3, r: f64| b.rod(from, to, r, r, 20);
    tube(b, SEAT - DVec3::Y * 0.04, HEAD + at(0.005, -0.03, 0.0), 0.0135);
    tube(b, CRANK, HEAD + at(0.025, -0.1, 0.0), 0.0165);
    tube(b, CRANK, SEAT, 0.0145);
    tube(b, HEAD + at(0.035, -0.13, 0.0), HEAD + at(-0.005, 0.02, 0.0), 0.019);
    b.rod(CRANK - DVec3::Z * 0.036, CRANK + DVec3::Z * 0.036, 0.022, 0.022, 24);
    for side in [-1.0, 1.0] {
        let z = DVec3::Z * side;
        tube(b, CRANK + z * 0.02, REAR + z * 0.062, 0.0085);
        tube(b, SEAT + z * 0.012 - DVec3::Y * 0.05, REAR + z * 0.062, 0.0075);
    }
    // Rack over the rear wheel.
    for side in [-1.0, 1.0] {
        let z = DVec3::Z * side;
        b.rod(at(-0.75, 0.73, 0.0) + z * 0.055, at(-0.34, 0.73, 0.0) + z * 0.055, 0.004, 0.004, 8);
        for x in [-0.7, -0.52, -0.45] {
            b.rod(at(x, 0.73, 0.0) + z * 0.055, REAR + z * 0.072, 0.003, 0.003, 8);
        }
    }
    for k in 0..12 {
        let x = -0.75 + 0.41 * f64::from(k) / 11.0;
        b.rod(at(x, 0.733, -0.06), at(x, 0.733, 0.06), 0.003, 0.003, 8);
    }
    // Mudguard of the rear wheel.
    for k in 0..40 {
        let angle = |k: i32| 0.7 + 2.5 * f64::from(k) / 40.0;
        let (from, to) = (REAR + turned(0.375, angle(k), 0.0), REAR + turned(0.375, angle(k + 1), 0.0));
        b.beam(from, to, 0.046, 0.0015);
    }
}

fn steering(b: &mut Build) {
    let crown = HEAD + at(0.04, -0.15, 0.0);
    for side in [-1.0, 1.0] {
        let z = DVec3::Z * side;
        let bend = [crown + z * 0.045, crown.lerp(FRONT, 0.45) + z * 0.055 + at(-0.012, 0.0, 0.0), FRONT + z * 0.06];
        b.tube(&bend.map(|p| (p, 0.0095)), 14, false);
        // Drop handlebar.
        let path: Vec<(DVec3, f64)> = (0..=28)
            .map(|k| {
                let angle = TAU * (0.25 - 0.5 * f64::from(k) / 28.0);
                (at(0.43 + 0.075 * angle.cos(), 0.85 + 0.075 * angle.sin(), side * 0.2), 0.0135)
            })
            .collect();
        b.tube(&path, 14, false);
        b.rod(at(0.43, 0.775, side * 0.2), at(0.33, 0.765, side * 0.2), 0.0135, 0.013, 14);
        b.beam(at(0.5, 0.9, side * 0.2), at(0.52, 0.79, side * 0.21), 0.009, 0.012);
        // Brake cable in a bow from lever to fork or seat stay.
        let end = if side > 0.0 { at(0.4, 0.69, 0.02) } else { at(0.2, 0.78, -0.015) };
        let start = at(0.5, 0.9, side * 0.2);
        let bow: Vec<(DVec3, f64)> = (0..=32)
            .map(|k| {
                let t = f64::from(k) / 32.0;
                let lift = at(0.12, 0.1, 0.0) * (4.0 * t * (1.0 - t));
                (start.lerp(end, t) + lift, 0.0022)
            })
            .collect();
        b.tube(&bow, 6, false);
    }
    b.rod(at(0.43, 0.925, -0.205), at(0.43, 0.925, 0.205), 0.0125, 0.0125, 14);
    b.rod(crown - DVec3::Z * 0.056, crown + DVec3::Z * 0.056, 0.013, 0.013, 14);
    b.rod(HEAD + at(-0.003, 0.0, 0.0), HEAD + at(-0.03, 0.12, 0.0), 0.0115, 0.0115, 16);
    b.rod(HEAD + at(-0.03, 0.12, 0.0), at(0.44, 0.925, 0.0), 0.012, 0.012, 16);
}

/// Chainring, cranks, pedals, sprockets and chain.
fn drive(b: &mut Build) {
    let z = 0.046;
    let toothed = |b: &mut Build, centre: DVec3, teeth: u32, radius: f64| {
        b.within(DAffine3::from_translation(centre), |b| {
            b.tube(&hoop(teeth * 2, radius - 0.006, 0.0025), 6, true);
            for k in 0..teeth {
                let angle = TAU * f64::from(k) / f64::from(teeth);
                let out = turned(1.0, angle, 0.0);
                let side = turned(0.002, angle + TAU * 0.25, 0.0);
                b.block(out * (radius - 0.001), out * 0.004, side, DVec3::Z * 0.0009);
            }
        });
    };
    toothed(b, CRANK + DVec3::Z * z, 46, 0.092);
    for (k, radius) in [(0u32, 0.03), (1, 0.036), (2, 0.042), (3, 0.048)] {
        toothed(b, REAR + DVec3::Z * (z - 0.004 * f64::from(k)), 14 + 3 * k, radius);
    }
    for k in 0..5 {
        let angle = TAU * (f64::from(k) + 0.3) / 5.0;
        b.beam(CRANK + DVec3::Z * z, CRANK + turned(0.085, angle, z), 0.006, 0.012);
    }
    for (side, angle) in [(1.0, -0.5), (-1.0, TAU * 0.5 - 0.5)] {
        let foot = CRANK + turned(0.17, angle, side * 0.07);
        b.beam(CRANK + DVec3::Z * (side * 0.06), foot, 0.012, 0.022);
        b.rod(foot, foot + DVec3::Z * (side * 0.1), 0.007, 0.006, 12);
        for x in [-0.038, -0.013, 0.013, 0.038] {
            b.beam(foot + at(x, 0.0, side * 0.02), foot + at(x, 0.0, side * 0.098), 0.006, 0.016);
        }
        for depth in [0.024, 0.094] {
            b.beam(foot + at(-0.042, 0.0, side * depth), foot + at(0.042, 0.0, side * depth), 0.005, 0.012);
        }
    }
    chain(b, z);
}

/// Links along the belt around chainring and rear sprocket.
fn chain(b: &mut Build, z: f64) {
    let (big, small) = (0.094, 0.032);
    let (from, to) = (CRANK.truncate(), REAR.truncate());
    let apart = to - from;
    let toward = apart.y.atan2(apart.x);
    // Where the straight runs touch both circles.
    let touch = ((big - small) / apart.length()).acos();
    let mut belt: Vec<DVec3> = Vec::new();
    let arc = |belt: &mut Vec<DVec3>, centre: DVec3, radius: f64, start: f64, sweep: f64, n: u32| {
        belt.extend((0..=n).map(|k| centre + turned(radius, start + sweep * f64::from(k) / f64::from(n), z)));
    };
    arc(&mut belt, CRANK, big, toward + touch, TAU - 2.0 * touch, 30);
    let (upper, lower) = (toward - touch, toward + touch);
    let run = |a: f64| (CRANK + turned(big, a, z), REAR + turned(small, a, z));
    let (a, c) = run(upper);
    belt.extend((1..34).map(|k| a.lerp(c, f64::from(k) / 34.0)));
    arc(&mut belt, REAR, small, upper, 2.0 * touch, 12);
    let (a, c) = run(lower);
    belt.extend((1..34).map(|k| c.lerp(a, f64::from(k) / 34.0)));
    for (k, p) in belt.iter().enumerate() {
        let next = belt[(k + 1) % belt.len()];
        b.rod(*p - DVec3::Z * 0.0045, *p + DVec3::Z * 0.0045, 0.0028, 0.0028, 6);
        if (next - *p).length() > 1e-6 {
            let plate = if k % 2 == 0 { 0.0034 } else { 0.0048 };
            for side in [-plate, plate] {
                b.beam(*p + DVec3::Z * side, next + DVec3::Z * side, 0.0009, 0.0062);
            }
        }
    }
}

fn saddle(b: &mut Build) {
    b.rod(SEAT - DVec3::Y * 0.06, SEAT + at(-0.03, 0.12, 0.0), 0.0118, 0.0118, 16);
    let spine: Vec<(DVec3, f64)> = (0..=16)
        .map(|k| {
            let t = f64::from(k) / 16.0;
            (at(-0.4 + 0.28 * t, 0.925 + 0.012 * (TAU * 0.5 * t).cos(), 0.0), 0.012 + 0.045 * (1.0 - t).powi(2))
        })
        .collect();
    b.tube(&spine, 20, false);
    for side in [-1.0, 1.0] {
        b.rod(at(-0.38, 0.9, side * 0.03), at(-0.14, 0.905, side * 0.008), 0.0035, 0.0035, 8);
    }
}
