//! A potted plant with loose leaves, each an open sheet.

use super::View;
use super::build::{Build, at};
use super::random::Random;
use glam::DVec3;
use std::f64::consts::TAU;
use subpixel_shadows::scene::Light;

pub(super) fn plant() -> View {
    let mut b = Build::default();
    let mut random = Random::new(7);
    b.plane(6.0);
    // Up outside, over the rim, down inside to the soil.
    let pot =
        [(0.0, -0.01), (0.2, -0.01), (0.29, 0.36), (0.33, 0.36), (0.34, 0.44), (0.29, 0.44), (0.265, 0.39), (0.0, 0.4)];
    b.lathe(&pot, 64);
    for k in 0..38 {
        let angle = TAU * f64::from(k) * 0.381_966;
        let reach = random.between(0.15, 1.05);
        let height = 1.7 - 0.75 * reach + random.between(-0.2, 0.2);
        stem(&mut b, &mut random, angle, reach, height);
    }
    View {
        build: b,
        eye: [1.75, 2.05, 2.75],
        target: [0.36, 0.74, -0.1],
        fov: 40.0,
        light: Light::Directional { direction: [-0.55, 0.85, 0.42] },
    }
}

/// A stem that rises and bends outward, with leaves in a spiral around it.
fn stem(b: &mut Build, random: &mut Random, angle: f64, reach: f64, height: f64) {
    let out = at(angle.cos(), 0.0, angle.sin());
    let point = |t: f64| out * (0.1 + reach * t * t) + DVec3::Y * (0.38 + height * t * (1.0 - 0.25 * t));
    let path: Vec<(DVec3, f64)> = (0..=9)
        .map(|k| {
            let t = f64::from(k) / 9.0;
            (point(t), 0.011 - 0.009 * t)
        })
        .collect();
    b.tube(&path, 6, false);
    let leaves = 46;
    for k in 0..leaves {
        let t = 0.3 + 0.7 * f64::from(k) / f64::from(leaves - 1);
        let turn = TAU * (0.381_966 * f64::from(k) + random.between(-0.06, 0.06));
        let side = at(turn.cos(), random.between(-0.1, 0.75), turn.sin()).normalize();
        let length = 0.075 + 0.085 * (TAU * 0.5 * t).sin() * random.between(0.6, 1.2);
        leaf(b, random, point(t), side, length);
    }
}

/// A leaf: two rows of triangles that fold along the middle and hang over towards the tip.
fn leaf(b: &mut Build, random: &mut Random, root: DVec3, side: DVec3, length: f64) {
    let across = side.cross(DVec3::Y).normalize();
    let up = across.cross(side);
    let droop = random.between(0.1, 0.6) * length;
    let width = random.between(0.2, 0.3) * length;
    let middle = |t: f64| root + side * (length * t) - DVec3::Y * (droop * t * t);
    let edge = |t: f64, w: f64, sign: f64| middle(t) + across * (sign * width * w) + up * (0.35 * width * w);
    let tip = middle(1.0);
    let (low, high) = (0.18, 0.55);
    for sign in [-1.0, 1.0] {
        let mut fan = [
            [middle(0.0), edge(low, 0.8, sign), middle(low)],
            [middle(low), edge(low, 0.8, sign), edge(high, 1.0, sign)],
            [middle(low), edge(high, 1.0, sign), middle(high)],
            [middle(high), edge(high, 1.0, sign), tip],
        ];
        for t in &mut fan {
            if sign > 0.0 {
                t.swap(1, 2);
            }
            b.polygon(t);
        }
    }
    // The stalk is a sheet as well.
    let back = root - side * 0.012 - across * 0.002;
    b.polygon(&[back, root - across * 0.004, root + across * 0.004]);
}
