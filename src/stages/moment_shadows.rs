//! Shadows by mean and variance of the depths in a pixel's footprint (Donnelly and Lauritzen 2006), of exponentials of them (Annen et al. 2008;
//! Lauritzen and McCool 2008), by four moments (Peters and Klein 2015), or by the Fourier series of the comparison (Annen et al. 2007).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, the nearest depths of
//!   [`light_layers`](super::light_layers) and their [moments](super::map_moments).
//! - **Writes** `visibility`: that of one lookup, whatever the samples; 1 where the pixel sees nothing.
//! - **Guarantee.** Bit-equal from run to run. Nothing is exact: the moments of what lies behind each other leak light.
//! - **Cost.** One dispatch over pixels; per pixel up to 16 lookups of eight cells, as many times as there are terms.

use super::PrimaryHits;
use super::map_moments::{MapLevels, MomentMeasures};
use crate::frame::Frame;
use crate::gpu::kernels::moment_shadows as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// Settings that the pipeline is compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentShadowsOptions {
    /// Depth that a receiver is moved towards the light; depth 1 is the extent of the casters along the light.
    pub constant: f32,
    /// Share of light that is taken off, against leaks: 0 for none, below 1.
    pub bleeding: f32,
    /// Sine of the elevation of the light over a receiver below which half of it is lit; 0 for none.
    pub grazing: f32,
    /// Measure that the moments are of, and so how they are asked: of depths, the share of light is at most variance / (variance + difference²)
    /// (Chebyshev); of the rising exponential alone, their mean over the receiver's; of both, the less of either bound; of four, the bound that they have (Hamburger's problem); of waves, the series of the comparison.
    pub measures: MomentMeasures,
}

/// The pipeline.
#[derive(Debug)]
pub struct MomentShadows {
    filter: kernel::FilterMomentsProgram,
}

/// A map and what is made of it.
#[derive(Clone, Copy, Debug)]
pub struct MapWithMoments<'a> {
    /// Where the levels of the moments begin.
    pub levels: &'a Buffer<MapLevels>,
    /// Keys of the nearest depths.
    pub nearest_keys: &'a Buffer<u32>,
    /// Mean and variance of squares of them.
    pub moments: &'a Buffer<[f32; 2]>,
}

impl MomentShadows {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device, options: MomentShadowsOptions) -> Self {
        let MomentShadowsOptions { constant, bleeding, grazing, measures } = options;
        let (query, exponent) = match measures {
            MomentMeasures::Depths => (kernel::QUERY_DEPTHS, 0.0),
            MomentMeasures::Rising(exponent) => (kernel::QUERY_MEAN, exponent),
            MomentMeasures::Both(exponent) => (kernel::QUERY_BOTH, exponent),
            MomentMeasures::Four => (kernel::QUERY_FOUR, 0.0),
            MomentMeasures::Layers(_) => (kernel::QUERY_LAYERS, 0.0),
            MomentMeasures::Waves(_) => (kernel::QUERY_WAVES, 0.0),
        };
        let (layers, terms) = measures.counts();
        let constants = kernel::Constants {
            paraboloids: 1,
            bias_constant: constant,
            bleeding,
            grazing,
            query,
            exponent,
            layers,
            terms,
            ringing: MomentMeasures::RINGING,
            flattest: MomentMeasures::FLATTEST,
        };
        Self { filter: kernel::FilterMomentsProgram::new(device, constants) }
    }

    /// Records all pixels.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        map: MapWithMoments,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::FilterMoments {
            frame: frame.as_uniform(),
            levels: map.levels.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            nearest_keys: map.nearest_keys.as_read(),
            moments: map.moments.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.filter, bindings, Groups::Items(visibility.len() as u64));
    }
}
