//! Balls on a slab under a lamp. Everything is closed.

use super::View;
use super::build::{Build, at};
use glam::DVec3;
use subpixel_shadows::scene::Light;

pub(super) fn spheres() -> View {
    let mut b = Build::default();
    b.brick(at(-7.0, -0.5, -7.0), at(7.0, 0.0, 7.0));
    let balls = [
        (at(0.0, 1.0, 0.0), 1.0),
        (at(1.9, 0.6, 0.7), 0.6),
        (at(-1.6, 0.5, 1.1), 0.5),
        (at(0.7, 0.35, 1.75), 0.35),
        (at(-0.5, 0.25, 1.7), 0.25),
        (at(2.6, 0.3, -0.5), 0.3),
        (at(-2.2, 0.8, -0.9), 0.8),
        (at(0.9, 2.25, 0.35), 0.28),
        (at(-0.9, 2.05, 0.75), 0.18),
    ];
    for (centre, radius) in balls {
        // Just above the slab: touching surfaces would share no edge but every rounding error.
        b.ball(centre + DVec3::Y * 0.004, radius, 32, 22);
    }
    View {
        build: b,
        eye: [1.2, 4.6, 6.6],
        target: [0.25, 0.45, 0.0],
        fov: 40.0,
        light: Light::Point { position: [-2.6, 4.9, 3.1] },
    }
}
