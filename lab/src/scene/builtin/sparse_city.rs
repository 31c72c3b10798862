//! A very large place of plain buildings with small things among them, as Oliveira 2009 describes its SparseCity (section 5.2).

use super::View;
use super::build::{Build, at};
use super::random::Random;
use glam::DVec3;
use subpixel_shadows::scene::Light;

/// Lots along one side.
const SIDE: u32 = 42;
/// Distance of one lot from the next.
const PITCH: f64 = 70.0;

pub(super) fn sparse_city() -> View {
    let mut b = Build::default();
    let mut random = Random::new(33);
    b.plane(2400.0);
    for j in 0..SIDE {
        for i in 0..SIDE {
            let along = |k: u32| (f64::from(k) - 0.5 * f64::from(SIDE - 1)) * PITCH;
            let centre = at(along(i), 0.0, along(j));
            // Nothing is built on the square that is looked at, and on a third of the lots.
            let square = centre.x.abs() < 80.0 && (-60.0..160.0).contains(&centre.z);
            if !square && random.below(3) > 0 {
                building(&mut b, &mut random, centre);
            }
        }
    }
    for k in 0..9 {
        let z = 120.0 - 22.0 * f64::from(k);
        lamp(&mut b, at(-14.0, 0.0, z), 1.0);
        lamp(&mut b, at(14.0, 0.0, z + 11.0), -1.0);
        bench(&mut b, at(-18.0, 0.0, z + 7.0));
    }
    View {
        build: b,
        eye: [30.0, 34.0, 190.0],
        target: [-6.0, 0.0, 20.0],
        fov: 45.0,
        light: Light::Directional { direction: [-0.7, 0.6, 0.35] },
    }
}

/// A box, on many of them a smaller one, and on some a chimney.
fn building(b: &mut Build, random: &mut Random, centre: DVec3) {
    let half = at(random.between(14.0, 26.0), 0.0, random.between(14.0, 26.0));
    let height = random.between(9.0, 34.0) + if random.below(9) == 0 { 50.0 } else { 0.0 };
    b.brick(centre + at(-half.x, -1.0, -half.z), centre + at(half.x, height, half.z));
    let (top, inner) = (centre + DVec3::Y * height, half * random.between(0.4, 0.8));
    if random.below(10) < 6 {
        let rise = random.between(3.0, 12.0);
        b.brick(top + at(-inner.x, -0.5, -inner.z), top + at(inner.x, rise, inner.z));
    } else {
        b.brick(top + at(-2.0, -0.5, -2.0), top + at(2.0, 5.0, 2.0));
    }
}

/// A post with an arm over the road and a lantern at its end.
fn lamp(b: &mut Build, foot: DVec3, towards: f64) {
    let top = foot + DVec3::Y * 7.5;
    b.rod(foot - DVec3::Y * 0.2, top, 0.12, 0.07, 10);
    let arm: Vec<(DVec3, f64)> = (0..=6)
        .map(|k| {
            let t = f64::from(k) / 6.0;
            (top + at(towards * 2.6 * t, 0.9 * (1.0 - (1.0 - t) * (1.0 - t)) - 0.1, 0.0), 0.06)
        })
        .collect();
    b.tube(&arm, 6, false);
    b.ball(top + at(towards * 2.7, 0.55, 0.0), 0.28, 10, 6);
}

/// A bench of planks.
fn bench(b: &mut Build, at_ground: DVec3) {
    for k in 0..5 {
        let z = 0.16 * f64::from(k);
        b.brick(at_ground + at(-0.06 + z, 0.45, -1.1), at_ground + at(0.06 + z, 0.5, 1.1));
    }
    for (x, z) in [(0.0, -0.9), (0.64, -0.9), (0.0, 0.9), (0.64, 0.9)] {
        b.brick(at_ground + at(x - 0.04, -0.1, z - 0.04), at_ground + at(x + 0.04, 0.451, z + 0.04));
    }
}
