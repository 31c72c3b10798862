//! Leaves and a fence that are cards: alpha says where they are.

use super::View;
use super::build::{Build, at};
use super::random::Random;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;
use subpixel_shadows::scene::{AlphaFilter, AlphaMap, AlphaWrap, Light};

/// Texels a side of the leaf's map.
const LEAF: u32 = 64;
/// Texels a side of a mesh of the fence.
const MESH: u32 = 32;

pub(super) fn leaves() -> View {
    let mut b = Build::default();
    let mut random = Random::new(11);
    b.plane(6.0);
    b.alpha.maps = vec![leaf(), mesh()];
    for x in [-1.3, 0.1, 1.5] {
        b.rod(at(x, 0.0, -0.9), at(x, 1.25, -0.9), 0.03, 0.03, 12);
    }
    // The fence repeats its map along both axes.
    b.card([at(-1.3, 0.05, -0.9), at(1.5, 0.05, -0.9), at(1.5, 1.15, -0.9), at(-1.3, 1.15, -0.9)], 1, [28.0, 11.0]);
    b.rod(at(-0.9, 0.0, 0.55), at(0.15, 1.5, 0.3), 0.035, 0.012, 10);
    for k in 0..70 {
        let t = 0.25 + 0.75 * f64::from(k) / 69.0;
        let turn = TAU * (0.381_966 * f64::from(k) + random.between(-0.05, 0.05));
        let root = at(-0.9, 0.0, 0.55).lerp(at(0.15, 1.5, 0.3), t);
        let way = at(turn.cos(), random.between(-0.4, 0.6), turn.sin()).normalize();
        let across = way.cross(DVec3::Y).normalize();
        let across = DMat3::from_axis_angle(way, random.between(-0.7, 0.7)) * across;
        let (along, half) = (way * random.between(0.26, 0.4), across * random.between(0.12, 0.17));
        b.card([root - half, root + half, root + half + along, root - half + along], 0, [1.0, 1.0]);
    }
    View {
        build: b,
        eye: [1.9, 1.75, 2.9],
        target: [0.05, 0.42, -0.15],
        fov: 42.0,
        light: Light::Directional { direction: [-0.5, 0.8, 0.55] },
    }
}

/// A leaf with five lobes and gaps between its veins; alpha falls off over about two texels, so that it has smooth borders.
fn leaf() -> AlphaMap {
    let inside = |x: f64, y: f64| {
        let (u, v) = (x - 0.5, y - 0.42);
        let (radius, angle) = (u.hypot(v), u.atan2(v));
        let lobe = 0.24 + 0.16 * (2.5 * angle).cos().abs() - 0.05 * (angle / 3.2).abs();
        let gap = 0.021 - ((radius * 14.0).sin().abs() * 0.05 + (5.0 * angle).sin().abs() * 0.09);
        let stalk = if y < 0.42 { 0.018 - u.abs() } else { -1.0 };
        (lobe - radius).min(if radius > 0.1 { -gap } else { 1.0 }).max(stalk)
    };
    map(LEAF, AlphaFilter::Bilinear, AlphaWrap::Clamp, |at| {
        let [x, y] = at.map(|t| (f64::from(t) + 0.5) / f64::from(LEAF));
        (127.5 + 127.5 * (inside(x, y) * f64::from(LEAF)).clamp(-1.0, 1.0)) as u8
    })
}

/// A mesh of wire: two diagonals.
fn mesh() -> AlphaMap {
    map(MESH, AlphaFilter::Nearest, AlphaWrap::Repeat, |[x, y]| {
        let on = |d: u32| d.min(MESH - d) <= 2;
        if on((x + y) % MESH) || on((x + MESH - y) % MESH) { 255 } else { 0 }
    })
}

/// A square map of the alpha of each texel, cut off at a half.
fn map(side: u32, filter: AlphaFilter, wrap: AlphaWrap, alpha: impl Fn([u32; 2]) -> u8) -> AlphaMap {
    AlphaMap {
        size: [side; 2],
        alpha: (0..side * side).map(|k| alpha([k % side, k / side])).collect(),
        cutoff: 0.5,
        filter,
        wrap: [wrap; 2],
    }
}
