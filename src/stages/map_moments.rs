//! Mean and variance of the depths of ever larger squares of texels, or of exponentials of them, or their first four moments, or means of waves of
//! them: filtering a map of depths takes these.
//!
//! - **Purpose.** Variance shadow maps (Donnelly and Lauritzen 2006), prefiltered as mip maps are (Oliveira 2009, section 3.4). Mean and
//!   variance stand for the two moments: the same numbers, of which nothing cancels in single precision.
//!   Of exponentials: exponential shadow maps (Annen et al. 2008) and exponential variance shadow maps (Lauritzen and McCool 2008), whose two
//!   warps, rising and falling, have moments each. Of four moments: moment shadow maps (Peters and Klein 2015).
//!   Of waves: convolution shadow maps (Annen, Mertens, Bekaert, Seidel, Kautz 2007).
//! - **Reads** the nearest depths of [`light_layers`](super::light_layers).
//! - **Writes** `moments`, level after level from the first above the texels, row by row. A cell of level `k` is the square of `2^k` texels
//!   a side, cut at the map's border; a texel without a caster is as deep as [`MapLevels::far`].
//! - **Guarantee.** Bit-equal from run to run.
//! - **Cost.** A third of 8 bytes a texel; a dispatch for every five levels, which go through workgroup memory. Twice that for both exponentials and for four moments, as many times as there are layers or terms.

use crate::frame::Frame;
use crate::gpu::kernels::map_moments as kernel;
use crate::gpu::{Buffer, Groups, Stage};
use crate::light_view::LightView;
use crate::{Result, shared_struct};
use glam::DVec3;

shared_struct! {
    /// Levels of moments of a map.
    "shared/raster/moments" => pub struct MapLevels {
        /// Depth where there is no caster: 1 more than that of anything.
        pub far: f32,
        /// Levels above the texels.
        pub count: u32,
        /// Moments of a set: mean and variance of a warp or layer, means of a wave; third and fourth moments are a set behind these.
        pub second: u32,
        /// Unused.
        pub pad: u32,
        /// Where each level begins among the moments.
        pub starts: [[u32; 4]; 4],
    }
}

impl MapLevels {
    /// Levels of a map of `size` texels a side, at most [`LightView::LARGEST_MAP`]; depth `far` where there is no caster.
    pub fn new(size: u32, far: f64) -> Self {
        let size = size.min(LightView::LARGEST_MAP);
        let second = Self::moments_of(size) as u32;
        let mut made = Self { far: far as f32, count: Self::count_of(size), second, ..Self::default() };
        let mut start = 0;
        for level in 1..=made.count {
            made.starts[level as usize / 4][level as usize % 4] = start;
            start += Self::side_of(size, level).pow(2);
        }
        made
    }

    /// Levels above the texels of a map: until one cell holds all of it.
    pub fn count_of(size: u32) -> u32 {
        u32::BITS - (size.max(1) - 1).leading_zeros()
    }

    /// Cells a side of a level.
    pub fn side_of(size: u32, level: u32) -> u32 {
        ((size.max(1) - 1) >> level) + 1
    }

    /// Moments of all levels of a map.
    pub fn moments_of(size: u32) -> usize {
        (1..=Self::count_of(size)).map(|l| (Self::side_of(size, l) as usize).pow(2)).sum()
    }

    /// A depth in `view` for texels without a caster: by the casters' extent along the light beyond the greatest of a box, so that the plane of
    /// a surface that ends lies before it beside its border too. The view may be warped if its light is `directional`.
    pub fn farthest(view: &LightView, directional: bool, (low, high): (DVec3, DVec3)) -> f64 {
        // Beyond all points in front of a light at a point lies the depth of what is infinitely far along its axis.
        let axis = view.w.truncate();
        let limit = if view.perspective { view.z.truncate().dot(axis) / axis.length_squared() } else { f64::INFINITY };
        let depth = |p: DVec3| match directional {
            // The divisor of a warp is 1 where it is least.
            true => view.z.dot(p.extend(1.0)),
            false => view.project(p).map_or(limit, |p| p.z),
        };
        let corner = |k: u32| {
            let side = |bit: u32, low: f64, high: f64| if k >> bit & 1 == 1 { high } else { low };
            DVec3::new(side(0, low.x, high.x), side(1, low.y, high.y), side(2, low.z, high.z))
        };
        (0..8).map(|k| depth(corner(k))).fold(1.0, f64::max) + 1.0
    }
}

/// Measure of depth that moments are of, and how many of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MomentMeasures {
    /// Depths.
    Depths,
    /// `exp(c (d / far - 1))` of depths `d`, `c` above 0 and at most [`MomentMeasures::STEEPEST`], `far` that of [`MapLevels`].
    Rising(f32),
    /// That, and behind it `-exp(-c d / far)`.
    Both(f32),
    /// Depths; behind mean and variance their third and fourth central moments (Peters and Klein 2015).
    Four,
    /// Depths in so many layers, even parts of those of casters: in each as far as it reaches (Lauritzen and McCool 2008, section 4).
    Layers(u32),
    /// Means of sine and cosine of so many terms of the Fourier series of a step over the depths of all that is there, and a tenth more (Annen et al. 2007).
    Waves(u32),
}

impl MomentMeasures {
    /// The steepest exponential: the square of its least value is still a normal number.
    pub const STEEPEST: f32 = 42.0;
    /// Most layers.
    pub const LAYERS: u32 = 8;
    /// Most terms, those of the paper.
    pub const TERMS: u32 = 16;
    /// The last term is weakened to `exp` of minus this, the others by the square of their number less, so that the series does not ring.
    pub const RINGING: f32 = 1.0;
    /// Of four moments, the fourth is above that of two depths by this share at the least, so that rounding is no shadow.
    pub const FLATTEST: f32 = 1e-3;

    /// Layers and terms, 0 where there are none.
    pub(super) fn counts(self) -> (u32, u32) {
        match self {
            Self::Layers(layers) => (layers, 0),
            Self::Waves(terms) => (0, terms),
            _ => (0, 0),
        }
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct MapMoments {
    reduce: Vec<[kernel::ReduceProgram; 3]>,
    measures: MomentMeasures,
}

impl MapMoments {
    /// Builds the pipelines, for the measures of depth that moments are to be of.
    pub fn new(device: &wgpu::Device, measures: MomentMeasures) -> Self {
        let four = u32::from(measures == MomentMeasures::Four);
        let (layers, terms) = measures.counts();
        let from = |first: u32, warp: f32| {
            kernel::ReduceProgram::new(device, kernel::Constants { first, warp, layers, terms, four })
        };
        let of = |warp: f32| [0, 1, 2].map(|k| from(k * kernel::LEVELS, warp));
        Self {
            reduce: match measures {
                MomentMeasures::Depths | MomentMeasures::Four => vec![of(0.0)],
                MomentMeasures::Rising(exponent) => vec![of(exponent)],
                MomentMeasures::Both(exponent) => vec![of(exponent), of(-exponent)],
                MomentMeasures::Layers(sets) | MomentMeasures::Waves(sets) => {
                    (0..sets).map(|set| of(set as f32)).collect()
                }
            },
            measures,
        }
    }

    /// Memory for the moments of a map of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn memory(&self, device: &wgpu::Device, size: u32) -> Result<Buffer<[f32; 2]>> {
        let sets = match self.measures {
            MomentMeasures::Depths | MomentMeasures::Rising(_) => 1,
            MomentMeasures::Both(_) | MomentMeasures::Four => 2,
            MomentMeasures::Layers(sets) | MomentMeasures::Waves(sets) => sets as usize,
        };
        Buffer::storage(device, "map_moments.moments", MapLevels::moments_of(size) * sets)
    }

    /// Records it, for a map of `size` texels a side.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        levels: &Buffer<MapLevels>,
        nearest_keys: &Buffer<u32>,
        moments: &Buffer<[f32; 2]>,
        size: u32,
    ) {
        let bindings = kernel::Reduce {
            frame: frame.as_uniform(),
            levels: levels.as_uniform(),
            nearest_keys: nearest_keys.as_read(),
            moments: moments.as_write(),
        };
        for reduce in &self.reduce {
            let firsts = (0..MapLevels::count_of(size)).step_by(kernel::LEVELS as usize);
            for (program, first) in reduce.iter().zip(firsts) {
                let tiles = MapLevels::side_of(size, first).div_ceil(kernel::TILE);
                stage.run(program, bindings, Groups::Workgroups(u64::from(tiles).pow(2)));
            }
        }
    }
}
