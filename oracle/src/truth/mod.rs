//! Ray-traced truth, in `f64`: what the shadow masks are measured against.
//!
//! Two truths, with the same sample positions as the image:
//! - [`scene_truth`]: every sample sends a ray to the nearest surface and from there one to the light. The honest
//!   picture.
//! - [`facet_truth`]: the model of Pan 2009, whose sample points lie on the plane of a given facet. Separates numeric
//!   error from model error.
//!
//! And [`seen_truth`]: whether each sample was given the surface that it sees, which neither of them asks.
//!
//! A third answer beside lit and shadowed is *ambiguous*: within [`AMBIGUITY`] of a pixel of a place where the answer
//! changes, or undecided by the error bound of `f64`. The bounds are forward error bounds, relative to the numbers that
//! enter a decision, so nothing depends on the size or the place of a scene.
//!
//! The tree of `obvhs` is used for its topology only; boxes, traversal and every decision are our own (see
//! [`hierarchy`]).
//!
//! Everything here is deterministic: the same input gives the same bits, whatever the number of threads.

pub mod beam;
pub mod facet_truth;
pub mod hierarchy;
mod packet;
pub mod predicate;
pub mod rays;
pub mod scene_truth;
pub mod seen_truth;

use glam::DVec3;

pub use facet_truth::{FacetInput, FacetResult, FacetTruth};
pub use rays::{Hit, Shade, Tracer};
pub use scene_truth::{PixelTruth, SceneTruth, TruthImage};
pub use seen_truth::{SeenResult, SeenTruth};

/// Half-width of the ambiguity band around an edge, in pixels: 2^-8, the uncertainty that the second tier of
/// conservative rasterization is allowed.
pub const AMBIGUITY: f64 = 1.0 / 256.0;

/// Error bound of a determinant of three vectors, relative to the product of their lengths.
///
/// With `u = 2^-53`: differences of coordinates carry `u` each, a product of three and a sum of six terms add `5u`, and
/// the sum of the absolute products is at most `sqrt(2)` times the product of the lengths: below `12u`.
pub(crate) const DETERMINANT_ERROR: f64 = 1.0 / (1u64 << 49) as f64;

/// A light lies in a triangle's plane if the determinant of two edges and the direction to it is at most this share of the product of
/// their largest components: 2^-40, which 46 bits still tell from 0. Such a triangle casts nothing, and is dark: the cosine under which
/// light falls on it is below 10^-12.
const IN_PLANE: f64 = 1.0 / (1u64 << 40) as f64;

/// The side of a triangle that a light is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightSide {
    /// 1, -1, or 0 in the plane.
    pub sign: f64,
    /// So near to the bound between one side and the plane that kernels, which have 46 bits, may take the other.
    pub open: bool,
}

/// The side of the triangle with the edges `ab` and `ac` from its first corner that a light in the direction `to_light` from there is on.
#[inline]
pub(crate) fn light_side(ab: DVec3, ac: DVec3, to_light: DVec3) -> LightSide {
    let size = |v: DVec3| v.abs().max_element();
    let side = ab.cross(ac).dot(to_light);
    let bound = IN_PLANE * size(ab) * size(ac) * size(to_light);
    let sign = if side.abs() > bound { side.signum() } else { 0.0 };
    LightSide { sign, open: (side.abs() - bound).abs() <= bound / 2.0 && bound > 0.0 }
}

/// Receives progress: how many rows (or facets) are done, and how many there are. Called from any thread, not always in
/// order.
pub type Progress<'a> = Option<&'a (dyn Fn(usize, usize) + Sync)>;

/// The samples of a mask as one integer: bit `k` is sample `k`.
pub fn join_mask(words: [u32; 4]) -> u128 {
    words.iter().rev().fold(0, |mask, &word| mask << 32 | u128::from(word))
}

/// The four words of a mask, as the kernels hold it: bit `k % 32` of word `k / 32` is sample `k`.
pub fn split_mask(mask: u128) -> [u32; 4] {
    [0, 32, 64, 96].map(|shift| (mask >> shift) as u32)
}

/// The mask of the samples below `count`.
pub fn full_mask(count: u32) -> u128 {
    if count >= 128 { u128::MAX } else { (1 << count) - 1 }
}

/// The samples of `mask`, from the lowest up.
pub fn bits(mut mask: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let k = mask.trailing_zeros();
        (k < 128).then(|| {
            mask &= mask - 1;
            k as usize
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_survive_joining_and_splitting() {
        let words = [1, 0x8000_0000, 0xdead_beef, 7];
        assert_eq!(split_mask(join_mask(words)), words);
        assert_eq!(join_mask([0, 0, 0, 1]), 1 << 96);
        assert_eq!(full_mask(32), 0xffff_ffff);
        assert_eq!(full_mask(128), u128::MAX);
        assert_eq!(bits(0b1010_0001).collect::<Vec<_>>(), [0, 5, 7]);
        assert_eq!(bits(u128::MAX).count(), 128);
    }
}
