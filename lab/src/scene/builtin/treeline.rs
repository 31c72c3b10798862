//! Three trees in a line over a floor, leaf by leaf, as Oliveira 2009 describes its TreeLine (section 5.2).

use super::View;
use super::build::{Build, at};
use super::random::Random;
use glam::DVec3;
use std::f64::consts::TAU;
use subpixel_shadows::scene::Light;

/// Turn from one branch to the next, of a whole turn.
const GOLDEN: f64 = 0.381_966;

pub(super) fn treeline() -> View {
    let mut b = Build::default();
    let mut random = Random::new(46);
    b.plane(25.0);
    for x in [-7.0, 0.0, 7.0] {
        let foot = at(x, 0.0, random.between(-0.6, 0.6));
        tree(&mut b, &mut random, foot);
    }
    View {
        build: b,
        eye: [0.0, 4.8, 18.5],
        target: [0.0, 2.4, 0.0],
        fov: 45.0,
        light: Light::Directional { direction: [-0.45, 0.8, 0.3] },
    }
}

/// Branches of each branch of a level, their corners around, and their points along.
const LEVELS: [(u32, u32, u32); 3] = [(14, 6, 8), (6, 5, 6), (5, 4, 5)];
/// Leaves of a last branch.
const LEAVES: u32 = 9;

fn tree(b: &mut Build, random: &mut Random, foot: DVec3) {
    let top = foot + at(random.between(-0.3, 0.3), 5.6, random.between(-0.3, 0.3));
    let path: Vec<(DVec3, f64)> = (0..=9)
        .map(|k| {
            let t = f64::from(k) / 9.0;
            (foot.lerp(top, t) + at(0.08 * (5.0 * t).sin(), -0.05, 0.08 * (4.0 * t).cos()), 0.24 - 0.19 * t)
        })
        .collect();
    b.tube(&path, 10, false);
    branches(b, random, (foot.lerp(top, 0.28), top), 0, 2.6);
}

/// The branches of the branch from `along.0` to `along.1`, as long as `length` where it begins.
fn branches(b: &mut Build, random: &mut Random, along: (DVec3, DVec3), level: usize, length: f64) {
    let (count, sides, points) = LEVELS[level];
    let axis = (along.1 - along.0).normalize();
    let across = axis.any_orthonormal_vector();
    for k in 0..count {
        let t = (f64::from(k) + random.between(0.1, 0.9)) / f64::from(count);
        let turn = TAU * (GOLDEN * f64::from(k) + random.between(-0.08, 0.08));
        let out = across * turn.cos() + axis.cross(across) * turn.sin();
        let way = (out + axis * random.between(0.35, 0.9) + DVec3::Y * 0.15).normalize();
        let root = along.0.lerp(along.1, t);
        let size = length * (1.0 - 0.55 * t) * random.between(0.8, 1.15);
        let tip = root + way * size;
        let bend = DVec3::Y * (0.12 * size);
        let path: Vec<(DVec3, f64)> = (0..points)
            .map(|k| {
                let t = f64::from(k) / f64::from(points - 1);
                (root.lerp(tip, t) + bend * (t * t), size * 0.022 * (1.0 - 0.8 * t))
            })
            .collect();
        b.tube(&path, sides, false);
        if level + 1 < LEVELS.len() {
            branches(b, random, (root.lerp(tip, 0.3), tip + bend), level + 1, 0.52 * size);
        } else {
            for k in 0..LEAVES {
                let t = 0.25 + 0.75 * f64::from(k) / f64::from(LEAVES - 1);
                leaf(b, random, root.lerp(tip, t) + bend * (t * t), way);
            }
        }
    }
}

/// A leaf: four triangles that fold along the middle.
fn leaf(b: &mut Build, random: &mut Random, root: DVec3, way: DVec3) {
    let mut side = || random.between(-1.0, 1.0);
    let along = (way * 0.4 + at(side(), side(), side())).normalize();
    let across = along.cross(DVec3::Y + way * 0.01).normalize();
    let fold = across.cross(along);
    let length = 0.13 + 0.05 * side().abs();
    let (tip, middle) = (root + along * length, root + along * (0.5 * length));
    for sign in [-1.0, 1.0] {
        let edge = middle + across * (sign * 0.32 * length) + fold * (0.1 * length);
        let mut halves = [[root, edge, middle], [middle, edge, tip]];
        for half in &mut halves {
            if sign > 0.0 {
                half.swap(1, 2);
            }
            b.polygon(half);
        }
    }
}
