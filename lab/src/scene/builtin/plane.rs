//! Few long edges over one plane.

use super::View;
use super::build::{Build, at};
use glam::DVec3;
use subpixel_shadows::scene::Light;

pub(super) fn plane() -> View {
    let mut b = Build::default();
    b.plane(30.0);
    // A slab on edge, a leaning plank, a gate, a long thin bar, a board that floats, and a tilted sheet.
    b.block(at(-2.2, 1.1, -0.6), at(0.9, 0.0, 0.35), at(0.0, 1.2, 0.0), at(-0.03, 0.0, 0.08));
    b.beam(at(-0.6, -0.1, 1.4), at(1.3, 2.6, -1.1), 0.35, 0.09);
    for x in [1.9, 3.3] {
        b.beam(at(x, -0.1, -0.4), at(x + 0.2, 2.4, -0.7), 0.16, 0.16);
    }
    b.beam(at(1.6, 2.3, -0.55), at(4.0, 2.5, -0.85), 0.22, 0.14);
    b.beam(at(-3.9, 0.25, 2.1), at(4.2, 1.05, 0.9), 0.03, 0.03);
    b.block(at(0.5, 1.5, 0.9), at(0.8, 0.1, 0.2), at(0.0, 0.02, 0.0), at(-0.1, 0.05, 0.4));
    b.beam(at(-3.4, -0.1, -2.2), at(-2.9, 3.3, -2.6), 0.1, 0.1);
    b.beam(at(-3.4, 3.2, -2.55), at(2.2, 2.9, -2.4), 0.08, 0.12);
    let (corner, right, up) = (at(2.5, 0.6, 1.2), at(1.2, 0.25, 0.3), at(-0.2, 0.9, -0.4));
    b.polygon(&[corner, corner + right, corner + right + up, corner + up]);
    b.polygon(&[at(-1.6, 0.4, 1.2), at(-0.7, 0.5, 1.5), DVec3::new(-1.2, 1.4, 1.0)]);
    View {
        build: b,
        eye: [1.4, 4.2, 8.0],
        target: [0.6, 0.75, 0.2],
        fov: 42.0,
        light: Light::Directional { direction: [-0.62, 0.7, 0.13] },
    }
}
