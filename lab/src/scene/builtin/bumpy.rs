//! A lattice over a bumpy receiver whose triangles are about as large as a pixel.

use super::View;
use super::build::{Build, at};
use glam::DVec3;
use subpixel_shadows::scene::Light;

/// Squares along one side of the receiver.
const SQUARES: u32 = 480;
/// Half its width.
const HALF: f64 = 5.0;

pub(super) fn bumpy() -> View {
    let mut b = Build::default();
    receiver(&mut b);
    // A trellis on four posts, its bars at two heights.
    let half = 2.1;
    for k in 0..=16 {
        let u = -half + 2.0 * half * f64::from(k) / 16.0;
        b.beam(at(u, 1.9, -half - 0.2), at(u, 1.9, half + 0.2), 0.07, 0.1);
        b.beam(at(-half - 0.2, 2.0, u), at(half + 0.2, 2.0, u), 0.05, 0.06);
    }
    for (x, z) in [(-half, -half), (half, -half), (-half, half), (half, half)] {
        b.beam(at(x, -0.6, z), at(x, 1.95, z), 0.16, 0.16);
    }
    b.ball(at(0.5, 2.35, -0.4), 0.42, 32, 18);
    View {
        build: b,
        eye: [2.6, 5.0, 6.4],
        target: [0.45, 0.35, 0.55],
        fov: 42.0,
        light: Light::Directional { direction: [-0.4, 0.74, -0.44] },
    }
}

fn height(x: f64, z: f64) -> f64 {
    let wave = |a: f64, c: f64, s: f64| (a * x + c * z + s).sin();
    0.16 * wave(1.3, 0.7, 0.4) * wave(-0.6, 1.7, 1.1)
        + 0.07 * wave(4.1, 2.3, 0.2) * wave(-2.9, 3.7, 2.0)
        + 0.018 * wave(15.0, 6.0, 0.0) * wave(-7.0, 17.0, 0.7)
        + 0.004 * wave(61.0, 27.0, 0.3) * wave(-33.0, 57.0, 0.9)
}

fn receiver(b: &mut Build) {
    let point = |i: u32, j: u32| {
        let u = |k: u32| HALF * (2.0 * f64::from(k) / f64::from(SQUARES) - 1.0);
        DVec3::new(u(i), height(u(i), u(j)), u(j)).as_vec3().to_array()
    };
    let base = b.mesh.positions.len() as u32;
    let row = SQUARES + 1;
    b.mesh.positions.extend((0..row * row).map(|k| point(k % row, k / row)));
    for j in 0..SQUARES {
        for i in 0..SQUARES {
            let a = base + j * row + i;
            let (right, below, across) = (a + 1, a + row, a + row + 1);
            // Diagonals alternate, so that none runs on through the whole receiver.
            b.mesh.triangles.extend(if (i + j) % 2 == 0 {
                [[a, below, across], [a, across, right]]
            } else {
                [[a, below, right], [right, below, across]]
            });
        }
    }
}
