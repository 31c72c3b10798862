//! Where a shape stands in the world, and what is an ulp away.

use crate::fuzz::random::Random;
use glam::{DMat3, DQuat, DVec3, Vec3};
use subpixel_shadows::scene::Mesh;

/// A turn, a size and a shift.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    turn: DMat3,
    shift: DVec3,
}

impl Place {
    /// Any: often as it is, so that faces stay in planes of the axes and coordinates stay exact; else turned, larger or smaller by
    /// up to 10^6, and away from the origin by up to 100 of its sizes.
    pub fn any(r: &mut Random) -> Self {
        let turn = match r.whole(0, 9) {
            0..=3 => DMat3::IDENTITY,
            4 | 5 => axes(r),
            _ => DMat3::from_quat(DQuat::from_axis_angle(r.direction(), r.between(0.0, std::f64::consts::TAU))),
        };
        let size = match r.whole(0, 9) {
            0..=6 => 1.0,
            7 | 8 => f64::from(r.whole(0, 24) as i32 - 12).exp2(),
            _ => r.by_size(1e-6, 1e6),
        };
        let away = match r.whole(0, 19) {
            0..=14 => 0.0,
            15..=17 => r.between(0.0, 3.0),
            _ => r.by_size(1.0, 100.0),
        };
        Self { turn: turn * size, shift: r.direction() * (away * size) }
    }

    /// Away from the origin by 10^2 to 10^6 of its sizes.
    pub fn far(r: &mut Random) -> Self {
        let far = r.by_size(1e2, 1e6);
        Self { turn: DMat3::IDENTITY, shift: r.direction() * far }
    }

    /// The mesh there.
    pub fn put(&self, mesh: &Mesh) -> Mesh {
        let moved = |p: &[f32; 3]| (self.turn * Vec3::from(*p).as_dvec3() + self.shift).as_vec3().into();
        Mesh { positions: mesh.positions.iter().map(moved).collect(), triangles: mesh.triangles.clone() }
    }
}

/// A turn that takes axes to axes.
fn axes(r: &mut Random) -> DMat3 {
    let mut columns = [DVec3::X, DVec3::Y, DVec3::Z];
    columns.rotate_left(r.whole(0, 2) as usize);
    let sign = |up: bool| if up { 1.0 } else { -1.0 };
    let [a, b] = [sign(r.chance(0.5)), sign(r.chance(0.5))];
    DMat3::from_cols(columns[0] * a, columns[1] * b, columns[2] * (a * b))
}

/// `v` moved by `n` of its ulps; near 0 by those of 2^-10, so that nothing vanishes beneath the smallest number.
pub(super) fn ulps(v: f32, n: i32) -> f32 {
    let size = v.abs().max(1.0 / 1024.0);
    let ulp = f32::from_bits(size.to_bits() + 1) - size;
    v + ulp * n as f32
}

/// A point moved by `n` ulps along the axes that `axes` names by bits.
pub(super) fn moved(p: [f32; 3], axes: u32, n: i32) -> [f32; 3] {
    let mut q = p;
    for (k, c) in q.iter_mut().enumerate().filter(|(k, _)| axes >> k & 1 == 1) {
        *c = ulps(p[k], n);
    }
    q
}

/// A count of ulps, 1 to 1000 either way.
pub(super) fn few_ulps(r: &mut Random) -> i32 {
    let n = r.count(1, 1000) as i32;
    if r.chance(0.5) { n } else { -n }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ulps_are_those_of_the_number() {
        for v in [1.0f32, 1.5, -3.25, 1000.1, -7e-3] {
            for n in [1, -1, 5, 300] {
                let step = f32::from_bits(v.abs().to_bits() + 1) - v.abs();
                let moved = ulps(v, n);
                assert!(
                    moved != v
                        && (f64::from(moved) - f64::from(v) - f64::from(step) * f64::from(n)).abs() <= f64::from(step)
                );
            }
        }
        assert!((1e-11..1e-9).contains(&ulps(0.0, 1)));
        assert_eq!(moved([1.0, 2.0, 3.0], 0b101, 2), [ulps(1.0, 2), 2.0, ulps(3.0, 2)]);
    }
}
