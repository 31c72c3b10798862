//! A city of millions of triangles: blocks of buildings with windows, ledges and things on their roofs.

use super::View;
use super::build::{Build, at};
use super::random::Random;
use glam::DVec3;
use subpixel_shadows::scene::Light;

/// Buildings along one side.
const SIDE: u32 = 15;
/// Distance of one building from the next.
const PITCH: f64 = 26.0;
/// Height of a storey.
const STOREY: f64 = 3.3;

pub(super) fn city() -> View {
    let mut b = Build::default();
    let mut random = Random::new(2009);
    b.plane(1500.0);
    for j in 0..SIDE {
        for i in 0..SIDE {
            // Every third row of lots is followed by a street.
            let along = |k: u32| (f64::from(k) - f64::from(SIDE) * 0.5 + 0.5) * PITCH + f64::from(k / 3) * 9.0 - 18.0;
            let centre = at(along(i), 0.0, along(j));
            building(&mut b, &mut random, centre);
        }
    }
    View {
        build: b,
        eye: [130.0, 135.0, 250.0],
        target: [10.0, 0.0, 55.0],
        fov: 40.0,
        light: Light::Directional { direction: [-0.6, 0.75, 0.2] },
    }
}

fn building(b: &mut Build, random: &mut Random, centre: DVec3) {
    let half = at(random.between(7.2, 10.4), 0.0, random.between(7.2, 10.4));
    let tall = if random.below(6) == 0 { 7 } else { 0 };
    let floors = 4 + tall + random.below(8);
    let height = f64::from(floors) * STOREY + 1.6;
    b.brick(centre + at(-half.x, -1.0, -half.z), centre + at(half.x, height, half.z));
    for floor in 0..floors {
        let y = 1.3 + f64::from(floor) * STOREY;
        if floor % 3 == 1 {
            let ledge = half + DVec3::splat(0.22);
            b.brick(centre + at(-ledge.x, y - 0.75, -ledge.z), centre + at(ledge.x, y - 0.5, ledge.z));
        }
        for (out, along, depth, width) in [(DVec3::X, DVec3::Z, half.x, half.z), (DVec3::Z, DVec3::X, half.z, half.x)] {
            let bays = (width / 1.95) as u32;
            for side in [-1.0, 1.0] {
                for bay in 0..bays {
                    let u = ((f64::from(bay) + 0.5) / f64::from(bays) * 2.0 - 1.0) * width;
                    window(b, random, centre + out * (side * depth) + along * u + DVec3::Y * y, out * side, along);
                }
            }
        }
    }
    roof(b, random, centre + DVec3::Y * height, half);
}

/// A window: sill, lintel, two posts, a bar; some have a balcony, some an awning.
fn window(b: &mut Build, random: &mut Random, at_wall: DVec3, out: DVec3, along: DVec3) {
    let bar = |b: &mut Build, u: f64, y: f64, half_u: f64, half_y: f64, depth: f64| {
        b.block(at_wall + along * u + DVec3::Y * y, along * half_u, DVec3::Y * half_y, out * depth);
    };
    bar(b, 0.0, -0.12, 0.9, 0.07, 0.3);
    bar(b, 0.0, 1.72, 0.86, 0.09, 0.2);
    bar(b, -0.74, 0.8, 0.06, 0.85, 0.14);
    bar(b, 0.74, 0.8, 0.06, 0.85, 0.14);
    match random.below(12) {
        0 => {
            // Balcony: floor, rail and bars.
            let place = |u: f64, y: f64, z: f64| at_wall + along * u + DVec3::Y * y + out * z;
            b.block(place(0.0, -0.32, 0.5), along * 0.95, DVec3::Y * 0.05, out * 0.6);
            b.block(place(0.0, 0.62, 1.03), along * 0.95, DVec3::Y * 0.03, out * 0.03);
            for k in 0..7 {
                let u = -0.9 + 0.3 * f64::from(k);
                b.block(place(u, 0.18, 1.03), along * 0.02, DVec3::Y * 0.44, out * 0.02);
            }
        }
        1 => {
            let slope = out * 0.5 - DVec3::Y * 0.2;
            let thick = slope.cross(along).normalize() * 0.02;
            b.block(at_wall + out * 0.45 + DVec3::Y * 1.55, along * 0.7, slope, thick);
        }
        _ => bar(b, 0.0, 0.8, 0.025, 0.85, 0.08),
    }
}

/// Parapet, a shed, tanks and masts.
fn roof(b: &mut Build, random: &mut Random, top: DVec3, half: DVec3) {
    for side in [-1.0, 1.0] {
        b.block(
            top + at(side * (half.x - 0.1), 0.3, 0.0),
            DVec3::X * 0.25,
            DVec3::Y * 0.45,
            DVec3::Z * (half.z + 0.17),
        );
        b.block(
            top + at(0.0, 0.28, side * (half.z - 0.1)),
            DVec3::X * (half.x - 0.2),
            DVec3::Y * 0.42,
            DVec3::Z * 0.25,
        );
    }
    let spot = |random: &mut Random| at(random.between(-0.6, 0.6) * half.x, 0.0, random.between(-0.6, 0.6) * half.z);
    let shed = top + spot(random);
    b.brick(shed + at(-2.0, -0.4, -1.5), shed + at(2.0, 2.6, 1.5));
    b.brick(shed + at(-2.3, 2.5, -1.8), shed + at(2.3, 2.8, 1.8));
    if random.below(3) == 0 {
        let tank = top + spot(random);
        for (x, z) in [(-0.8, -0.8), (0.8, -0.8), (-0.8, 0.8), (0.8, 0.8)] {
            b.beam(tank + at(x, -0.3, z), tank + at(x * 0.9, 3.1, z * 0.9), 0.15, 0.15);
        }
        b.rod(tank + DVec3::Y * 3.0, tank + DVec3::Y * 5.4, 1.3, 1.3, 16);
        b.rod(tank + DVec3::Y * 5.35, tank + DVec3::Y * 6.3, 1.45, 0.05, 16);
    }
    for _ in 0..2 + random.below(4) {
        let mast = top + spot(random);
        let high = mast + DVec3::Y * random.between(3.0, 8.0);
        b.rod(mast - DVec3::Y * 0.3, high, 0.07, 0.03, 5);
        for k in 0..4 {
            let p = mast.lerp(high, 0.6 + 0.1 * f64::from(k));
            b.rod(p - DVec3::X * 0.6, p + DVec3::X * 0.6, 0.02, 0.02, 4);
        }
    }
}
