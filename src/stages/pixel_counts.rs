//! The work of each pixel in numbers, to be looked at: its class, its facets, the texels that these touch, and the pairs of facet and
//! triangle that are evaluated.
//!
//! - **Reads** facets and which of them a pixel has, or classes; the pixel-texel pairs and candidates of a band.
//! - **Writes** [`PixelCounts`]: pairs and candidates add up over bands and views, so these words are cleared before a frame; class and facets
//!   are written.
//! - **Guarantee.** Exact counts of what is in the lists; of what found no room in them, none. How many candidates there are may differ a
//!   little from run to run (see [`candidate_pairs`](super::candidate_pairs)).
//! - **Cost.** Of pixels one dispatch; of a band two, indirect: an atomic and 12 bytes read an item.

use super::facet_classify::Facets;
use super::pixel_texel_pairs::{PairLists, PairTiles};
use crate::frame::Frame;
use crate::gpu::kernels::pixel_counts as kernel;
use crate::gpu::{Buffer, Groups, Stage};
use crate::shared_struct;

shared_struct! {
    /// Work of a pixel.
    "pixel_counts" => pub struct PixelCounts {
        /// Class of its most demanding facet before evaluation, as a number of [`PixelClass::ALL`](crate::methods::PixelClass::ALL).
        pub state: u32,
        /// Facets: surfaces that its samples see.
        pub facets: u32,
        /// Texels of the light's view that undecided ones touch, those of each added up.
        pub texels: u32,
        /// Pairs of facet and triangle that are evaluated.
        pub pairs: u32,
    }
}

/// The pipelines that count pairs.
#[derive(Debug)]
pub struct CountedPairs {
    pairs: kernel::CountPairsProgram,
    candidates: kernel::CountCandidatesProgram,
}

/// The pipelines that count what pixels have.
#[derive(Debug)]
pub struct CountedPixels {
    facets: kernel::CountFacetsProgram,
    classes: kernel::CountClassesProgram,
}

impl CountedPairs {
    /// Builds the pipelines for pairs that meet at `places`.
    pub fn new(device: &wgpu::Device, places: PairTiles) -> Self {
        let constants = || kernel::Constants { tile_shift: places.shift() };
        Self {
            pairs: kernel::CountPairsProgram::new(device, constants()),
            candidates: kernel::CountCandidatesProgram::new(device, constants()),
        }
    }

    /// Records the pairs of a band, and its candidates; `args` are for as many items as there are of each.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        facets: &Facets,
        lists: &PairLists,
        [pairs, candidates]: [(&wgpu::Buffer, u64); 2],
        counts: &Buffer<PixelCounts>,
    ) {
        let bindings = kernel::CountPairs {
            frame: frame.as_uniform(),
            undecided: facets.undecided.as_read(),
            pairs: lists.pixel_pairs.as_read(),
            candidates: lists.candidates.as_write(),
            counts: counts.as_write(),
        };
        stage.run(&self.pairs, bindings, Groups::Indirect(pairs.0, pairs.1));
        let bindings = kernel::CountCandidates::from(bindings);
        stage.run(&self.candidates, bindings, Groups::Indirect(candidates.0, candidates.1));
    }
}

impl CountedPixels {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            facets: kernel::CountFacetsProgram::new(device, kernel::Constants::default()),
            classes: kernel::CountClassesProgram::new(device, kernel::Constants::default()),
        }
    }

    /// Records class and number of the facets of every pixel.
    pub fn record_facets(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        facets: &Facets,
        counts: &Buffer<PixelCounts>,
    ) {
        let bindings = kernel::CountFacets {
            frame: frame.as_uniform(),
            facets: facets.list.as_read(),
            pixel_facets: facets.pixel_facets.as_read(),
            counts: counts.as_write(),
        };
        stage.run(&self.facets, bindings, Groups::Items(counts.len() as u64));
    }

    /// Records the class of every pixel, from behind as many other words of `classes`.
    pub fn record_classes(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        classes: &Buffer<u32>,
        counts: &Buffer<PixelCounts>,
    ) {
        let bindings =
            kernel::CountClasses { frame: frame.as_uniform(), classes: classes.as_read(), counts: counts.as_write() };
        stage.run(&self.classes, bindings, Groups::Items(counts.len() as u64));
    }
}
