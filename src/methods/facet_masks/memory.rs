//! The memory of a frame of `facet-masks`: every buffer, how the lists are sized, what the status words say.

use super::{PairVariant, Pipelines, Settings};
use crate::Result;
use crate::frame::{Frame, sample_words};
use crate::gpu::kernels::{candidate_pairs, facet_classify, pixel_texel_pairs, triangle_texel_pairs, visibility_masks};
use crate::gpu::{Buffer, Profile};
use crate::mask_table::mask_table;
use crate::methods::TexelQuery;
use crate::methods::geometry::{Geometry, culled_views};
use crate::methods::light_maps::LightMaps;
use crate::methods::prepared::CasterBuffers;
use crate::pixel_filter::PixelFilter;
use crate::stages::candidate_pairs::tally;
use crate::stages::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use crate::stages::facet_classify::Facets;
use crate::stages::pixel_counts::PixelCounts;
use crate::stages::pixel_filter::FilterMemory;
use crate::stages::pixel_texel_pairs::PairLists;
use crate::stages::{PrefixScan, SortedPairs, WorkOwners, prefix_scan, sorted_pairs};
use crate::status::Status;

/// How the lists of a frame are sized.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacities {
    /// Pixel-texel pairs of a band.
    pub pixel_pairs: usize,
    /// Triangle-texel pairs of a band.
    pub triangle_pairs: usize,
    /// Candidates of a band.
    pub candidates: usize,
    /// Bands of facets that are evaluated one after the other.
    pub bands: u32,
    /// Views of the light; each part of a map is one.
    pub views: u32,
    /// Triangles over one place of the map.
    pub most_at_place: u32,
    /// Facets.
    pub facets: usize,
    /// Triangles in the lists of all pixels; 0 with one facet a pixel.
    pub pixel_triangles: usize,
    /// Pixels that may show several surfaces; 0 with one facet a pixel.
    pub complex_pixels: usize,
    /// Triangles of one pixel.
    pub most_at_pixel: u32,
}

impl Capacities {
    /// No list: one view and band.
    pub const NONE: Self = Self {
        pixel_pairs: 0,
        triangle_pairs: 0,
        candidates: 0,
        bands: 1,
        views: 1,
        most_at_place: 0,
        facets: 0,
        pixel_triangles: 0,
        complex_pixels: 0,
        most_at_pixel: 0,
    };

    /// The same with as long lists of triangles as one dispatch goes through, which take nothing.
    pub(crate) fn in_turns(self, profile: Profile) -> Self {
        let [most_at_place, most_at_pixel] = [self.most_at_place, self.most_at_pixel].map(|most| profile.turns(most));
        Self { most_at_place, most_at_pixel, ..self }
    }

    /// Bands of all views.
    pub(crate) fn all_bands(self) -> usize {
        (self.views * self.bands) as usize
    }

    /// First word of the status of a band of a view.
    pub(crate) fn status_band(self, view: u32, band: u32) -> usize {
        Status::band((view * self.bands + band) as usize)
    }
}

/// Indirect arguments, by position.
#[derive(Clone, Copy)]
pub enum Arg {
    Listed,
    Facets,
    Pairs,
    Candidates,
    Doubts,
    /// Blocks of facets whose texels are found twice.
    FacetsAgain,
    /// The same of casters.
    CastersAgain,
}

impl Arg {
    pub fn word(self) -> u64 {
        self as u64 * 3
    }
}

/// Every buffer of a frame.
pub struct Memory {
    pub samples: Buffer<[f32; 4]>,
    pub table: Buffer<u32>,
    pub frames: Vec<Buffer<Frame>>,
    pub geometry: Geometry,
    pub maps: LightMaps,
    pub facets: Facets,
    pub facet_offsets: Buffer<u32>,
    pub lists: PairLists,
    /// Pairs as they come, of facets and of triangles, where they are sorted.
    pub unsorted: Option<[sorted_pairs::SortedPairsScratch; 2]>,
    pub scan_scratch: prefix_scan::PrefixScanScratch,
    pub args: Buffer<u32>,
    pub requests: Vec<Requests>,
    pub status: Buffer<u32>,
    pub visibility: Buffer<f32>,
    pub lit: Buffer<u32>,
    /// With a filter other than a box.
    pub filter: Option<FilterMemory>,
    /// Where pixels are counted.
    pub counts: Option<Buffer<PixelCounts>>,
}

impl Memory {
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        casters: &CasterBuffers,
        settings: &Settings,
        with: &Pipelines,
        capacities: Capacities,
    ) -> Result<Self> {
        let (pixels, map, words) = (settings.pixels(), settings.map as usize, settings.samples.words() as usize);
        let culls = culled_views(casters, settings, TexelQuery::Facets);
        let receivers = if with.take_receivers() { pixels } else { 0 };
        let PairMemory { lists, unsorted } = PairMemory::new(device, settings, capacities)?;
        let FacetMemory { facets, offsets, scan_scratch } =
            FacetMemory::new(device, settings, map * map, capacities.facets)?;
        let words_of = |label: &str, len: usize| Buffer::storage(device, label, len);
        let samples = Buffer::uniform(device, "samples", 64)?;
        samples.write(queue, &sample_words(&settings.samples));
        let table = mask_table(&settings.samples, settings.masks.size());
        Ok(Self {
            samples,
            table: Buffer::from_slice(device, queue, "visibility_masks.table", &table)?,
            frames: frames(device, capacities)?,
            geometry: Geometry::new(device, queue, (casters, receivers), pixels, map, culls)?,
            maps: LightMaps::new(device, queue, &with.light_maps, casters.edges.len(), map)?,
            facets,
            facet_offsets: offsets,
            lists,
            unsorted,
            scan_scratch,
            args: Buffer::indirect(device, "dispatch_args.args", 3 * 7)?,
            requests: requests(device, queue, [pixels, capacities.facets, casters.triangles.len()], capacities)?,
            status: words_of("status", Status::words(capacities.all_bands()))?,
            visibility: Buffer::storage(device, "resolve.visibility", pixels)?,
            lit: words_of("resolve.lit", pixels * words)?,
            filter: (settings.filter != PixelFilter::Box)
                .then(|| FilterMemory::new(device, queue, settings.filter, &settings.samples, pixels))
                .transpose()?,
            counts: (settings.count_pixels)
                .then(|| Buffer::storage(device, "pixel_counts.counts", pixels))
                .transpose()?,
        })
    }
}

pub fn frames(device: &wgpu::Device, c: Capacities) -> Result<Vec<Buffer<Frame>>> {
    (0..c.views * c.bands).map(|_| Buffer::uniform(device, "frame", 1)).collect()
}

/// Buffers whose length is that of the lists of pairs and candidates.
pub struct PairMemory {
    pub lists: PairLists,
    pub unsorted: Option<[sorted_pairs::SortedPairsScratch; 2]>,
}

impl PairMemory {
    pub fn new(device: &wgpu::Device, settings: &Settings, c: Capacities) -> Result<Self> {
        let (map, places) = (settings.map as usize, settings.pairs.places());
        let scratch = |pairs, both| SortedPairs::scratch(device, pairs, both);
        let sorted = settings.pairs == PairVariant::Sorted;
        Ok(Self {
            lists: PairLists::new(
                device,
                map,
                places,
                c.pixel_pairs,
                c.triangle_pairs,
                c.candidates,
                settings.keeps_validity(),
            )?,
            unsorted: if sorted {
                Some([scratch(c.pixel_pairs, true)?, scratch(c.triangle_pairs, false)?])
            } else {
                None
            },
        })
    }
}

/// Buffers whose length is the number of facets.
pub struct FacetMemory {
    pub facets: Facets,
    pub offsets: Buffer<u32>,
    pub scan_scratch: prefix_scan::PrefixScanScratch,
}

impl FacetMemory {
    /// `scans`: the longest list that is scanned besides that of facets.
    pub fn new(device: &wgpu::Device, settings: &Settings, scans: usize, facets: usize) -> Result<Self> {
        let (pixels, words, map) = (settings.pixels(), settings.samples.words() as usize, settings.map as usize);
        Ok(Self {
            facets: Facets::new(device, facets, pixels, words)?,
            offsets: Buffer::storage(device, "facets.offsets", WorkOwners::words(facets, map * map))?,
            scan_scratch: PrefixScan::scratch(device, scans.max(facets))?,
        })
    }
}

/// Requests of indirect arguments, one list of one for each [`Arg`]. `totals` are the words of the totals of listed facets, blocks of facets and of
/// casters; the rest are in the tally.
pub fn requests(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    totals: [usize; 3],
    c: Capacities,
) -> Result<Vec<Requests>> {
    let [listed, facets, casters] = totals;
    let all = ArgsRequest::MAX_LIMIT;
    let found_once = PairLists::touched_words(c.pixel_pairs, c.triangle_pairs);
    let all = [
        (listed, facet_classify::WORKGROUP, c.facets, 0),
        (facets, pixel_texel_pairs::WORKGROUP, all, 0),
        (tally::TALLY_PAIRS as usize, candidate_pairs::WORKGROUP, c.pixel_pairs, 0),
        (tally::TALLY_CANDIDATES as usize, visibility_masks::WORKGROUP, c.candidates, 0),
        (tally::TALLY_DOUBTS as usize, visibility_masks::WORKGROUP, c.candidates, 0),
        (facets, pixel_texel_pairs::WORKGROUP, all, found_once),
        (casters, triangle_texel_pairs::WORKGROUP, all, found_once),
    ];
    let request = |(k, (count, group, limit, skip)): (usize, (usize, u32, usize, usize))| {
        DispatchArgs::requests(device, queue, &[ArgsRequest::new(count, group, limit, 3 * k)?.after(skip)])
    };
    all.into_iter().enumerate().map(request).collect()
}
