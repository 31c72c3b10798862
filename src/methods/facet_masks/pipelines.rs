//! The pipelines of `facet-masks`.

use super::super::every_surface::SurfacePipelines;
use super::super::geometry::GeometryPipelines;
use super::super::light_maps::LightMapPipelines;
use super::super::settings::{FacetMode, PairVariant, ProjectionVariant, Settings};
use crate::gpu::KeptPrograms;
use crate::mask_table::MaskVariant;
use crate::pixel_filter::PixelFilter;
use crate::stages::candidate_pairs::CandidatePairs;
use crate::stages::facet_classify::FacetClassify;
use crate::stages::pixel_counts::{CountedPairs, CountedPixels};
use crate::stages::pixel_filter::FilterMasks;
use crate::stages::pixel_texel_pairs::PixelTexelPairs;
use crate::stages::requested_blocks::RequestedBlocks;
use crate::stages::resolve::Resolve;
use crate::stages::triangle_texel_pairs::TriangleTexelPairs;
use crate::stages::visibility_masks::{Casting, VisibilityMasks};
use crate::stages::work_owners::ListWork;
use crate::stages::{DispatchArgs, PrefixScan, SortedPairs};

/// The pipelines, which may serve any number of meshes, images and settings with as many samples, facets alike and the same
/// variants of masks, pairs, projection and filter, and counts of pixels or none.
#[derive(Debug)]
pub struct Pipelines {
    pub(super) samples: u32,
    pub(super) facets: FacetMode,
    pub(super) masks_by: MaskVariant,
    pub(super) pairs_by: PairVariant,
    pub(super) lines_by: ProjectionVariant,
    pub(super) filter_by: PixelFilter,
    /// Casters may be alpha-tested.
    pub(super) alpha: bool,
    /// With a facet for every surface.
    pub(super) surfaces: Option<SurfacePipelines>,
    pub(super) geometry: GeometryPipelines,
    pub(super) light_maps: LightMapPipelines,
    pub(super) requests: RequestedBlocks,
    pub(super) classify: FacetClassify,
    /// `None` for frames in which nothing casts a shadow.
    pub(super) pairs: Option<PairPipelines>,
    pub(super) resolve: Resolve,
    /// With a filter other than a box.
    pub(super) filter: Option<FilterMasks>,
    /// Where pixels are counted.
    pub(super) counted: Option<CountedPixels>,
    pub(super) scan: PrefixScan,
    pub(super) work: ListWork,
    pub(super) fold: DispatchArgs,
}

/// The pipelines that test casters against facets.
#[derive(Debug)]
pub struct PairPipelines {
    pub(super) pixel_pairs: PixelTexelPairs,
    pub(super) triangle_pairs: TriangleTexelPairs,
    pub(super) candidates: CandidatePairs,
    pub(super) masks: VisibilityMasks,
    pub(super) sorted: Option<SortedPairs>,
    pub(super) counted: Option<CountedPairs>,
}

impl Pipelines {
    /// Builds the pipelines that `settings` need.
    pub fn new(device: &wgpu::Device, settings: &Settings) -> Self {
        KeptPrograms::once(|| Self::build(device, settings, false, true))
    }

    /// As [`Pipelines::new`], for frames with surfaces that are no casters, too.
    pub fn with_receivers(device: &wgpu::Device, settings: &Settings) -> Self {
        KeptPrograms::once(|| Self::build(device, settings, true, true))
    }

    /// As [`Pipelines::new`], for frames in which nothing casts a shadow ([`Extent::Facing`](super::Extent::Facing)) alone.
    pub fn facing(device: &wgpu::Device, settings: &Settings) -> Self {
        KeptPrograms::once(|| Self::build(device, settings, false, false))
    }

    fn build(device: &wgpu::Device, settings: &Settings, receivers: bool, casters: bool) -> Self {
        let clamp = settings.facets == FacetMode::All;
        let two_step = settings.projection == ProjectionVariant::TwoStep;
        let (words, alpha) = (settings.samples.words(), settings.alpha_tested);
        let scan = PrefixScan::new(device);
        let (sorted, places) = (settings.pairs == PairVariant::Sorted, settings.pairs.places());
        Self {
            samples: settings.samples.count(),
            facets: settings.facets,
            masks_by: settings.masks,
            pairs_by: settings.pairs,
            lines_by: settings.projection,
            filter_by: settings.filter,
            alpha,
            surfaces: clamp.then(|| SurfacePipelines::new(device, &scan, settings.samples.count(), [alpha, receivers])),
            geometry: GeometryPipelines::new(device, alpha, settings.tells_depths()),
            light_maps: LightMapPipelines::new(device, &scan),
            requests: RequestedBlocks::specialised(device, clamp, receivers),
            classify: FacetClassify::specialised(device, words, clamp, receivers),
            pairs: casters.then(|| PairPipelines {
                pixel_pairs: PixelTexelPairs::new(device, places),
                triangle_pairs: TriangleTexelPairs::new(device, places),
                candidates: CandidatePairs::new(device, words, places, clamp),
                masks: VisibilityMasks::specialised(
                    device,
                    settings.samples.count(),
                    settings.masks.size(),
                    Casting { two_step, cuts: !clamp, alpha },
                ),
                sorted: sorted.then(|| SortedPairs::new(device, &scan)),
                counted: settings.count_pixels.then(|| CountedPairs::new(device, places)),
            }),
            resolve: Resolve::new(device, words),
            filter: (settings.filter != PixelFilter::Box).then(|| FilterMasks::new(device, words, settings.filter)),
            counted: settings.count_pixels.then(|| CountedPixels::new(device)),
            work: ListWork::new(device, &scan),
            scan,
            fold: DispatchArgs::new(device),
        }
    }

    /// Whether pixels may show, with a facet for every surface, what casts nothing.
    pub fn take_receivers(&self) -> bool {
        self.surfaces.as_ref().is_some_and(SurfacePipelines::takes_receivers)
    }

    /// Whether they serve `settings`.
    pub fn serve(&self, settings: &Settings) -> bool {
        let ours = (self.samples, self.facets, self.masks_by, self.pairs_by, self.lines_by);
        ours == (settings.samples.count(), settings.facets, settings.masks, settings.pairs, settings.projection)
            && (self.filter_by, self.alpha) == (settings.filter, settings.alpha_tested)
            && self.counted.is_some() == settings.count_pixels
            && self.geometry.tells_depths() == settings.tells_depths()
    }
}
