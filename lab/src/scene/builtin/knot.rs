//! Three tangled tubes: the strands of a torus link, over a slab. Everything is closed.

use super::View;
use super::build::{Build, at};
use glam::{DAffine3, DQuat, DVec3};
use std::f64::consts::TAU;
use subpixel_shadows::scene::Light;

/// Tubes, each of which winds twice around the hole and five times through it.
const STRANDS: u32 = 3;
/// Radius of a tube.
const TUBE: f64 = 0.15;
/// Points along a tube.
const POINTS: u32 = 1616;

pub(super) fn knot() -> View {
    let mut b = Build::default();
    b.brick(at(-9.0, -0.5, -9.0), at(9.0, 0.0, 9.0));
    let place = DAffine3::from_rotation_translation(DQuat::from_rotation_x(0.32), at(0.0, 1.85, 0.0));
    b.within(place, |b| {
        for strand in 0..STRANDS {
            let path: Vec<(DVec3, f64)> = (0..POINTS).map(|k| (centre_line(strand, k), TUBE)).collect();
            b.tube(&path, 16, true);
        }
    });
    View {
        build: b,
        eye: [2.4, 5.4, 7.0],
        target: [0.35, 0.85, -0.15],
        fov: 40.0,
        light: Light::Directional { direction: [-0.42, 0.83, 0.36] },
    }
}

/// Point `k` of a strand's centre line, on a torus about the y axis.
fn centre_line(strand: u32, k: u32) -> DVec3 {
    let t = TAU * f64::from(k) / f64::from(POINTS);
    let turn = 5.0 * t + TAU * f64::from(strand) / f64::from(STRANDS);
    let radius = 1.85 + 0.78 * turn.cos();
    at(radius * (2.0 * t).cos(), 0.78 * turn.sin(), radius * (2.0 * t).sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tubes_do_not_touch() {
        let points: Vec<(u32, u32, DVec3)> =
            (0..STRANDS).flat_map(|s| (0..POINTS).step_by(4).map(move |k| (s, k, centre_line(s, k)))).collect();
        let mut least = f64::INFINITY;
        for (i, a) in points.iter().enumerate() {
            for b in &points[..i] {
                let along = a.1.abs_diff(b.1).min(POINTS - a.1.abs_diff(b.1));
                if a.0 != b.0 || along > POINTS / 16 {
                    least = least.min((a.2 - b.2).length());
                }
            }
        }
        assert!(least > 2.2 * TUBE, "centre lines come within {least}");
    }
}
