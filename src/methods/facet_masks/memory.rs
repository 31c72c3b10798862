//! The memory of a frame of `facet-masks`: every buffer, how the lists are sized, what the status words say.

use super::{PairVariant, Settings};
use crate::Result;
use crate::frame::{Frame, sample_words};
use crate::gpu::Buffer;
use crate::gpu::kernels::{
    candidate_pairs, facet_classify, pixel_texel_pairs, silhouette_mask, triangle_texel_pairs, visibility_masks,
};
use crate::mask_table::mask_table;
use crate::methods::geometry::Geometry;
use crate::methods::prepared::CasterBuffers;
use crate::stages::candidate_pairs::tally;
use crate::stages::dispatch_args::{DispatchArgs, Request, Requests};
use crate::stages::facet_classify::Facets;
use crate::stages::light_layers::Layers;
use crate::stages::pixel_texel_pairs::PairLists;
use crate::stages::{PrefixScan, SortedPairs, SummedArea, WorkOwners, prefix_scan, sorted_pairs, summed_area};

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
    /// Rounds of [`candidate_pairs::ROUND_LENGTH`] triangles.
    pub rounds: u32,
    /// Facets.
    pub facets: usize,
    /// Triangles in the lists of all pixels; 0 with one facet a pixel.
    pub pixel_triangles: usize,
    /// Pixels that may show several surfaces; 0 with one facet a pixel.
    pub complex_pixels: usize,
    /// Rounds of [`ROUND_LENGTH`](crate::stages::sample_surfaces::ROUND_LENGTH) triangles of a pixel.
    pub camera_rounds: u32,
}

/// Words of the status buffer.
pub mod status {
    /// Silhouette edges.
    pub const EDGES: usize = 8;
    /// Triangles tested against facets, low and high word.
    pub const TESTS: usize = 10;
    /// The stamp of the frame, once its last stage has run; 0 before.
    pub const FINISHED: usize = crate::stages::resolve::STATUS_FINISHED as usize;
    /// Facets by state.
    pub const STATES: usize = 16;
    /// First word of the bands.
    pub const BANDS: usize = 32;
    /// Longest list of triangles of a pixel.
    pub const LONGEST_PIXEL: usize = crate::stages::pixel_triangles::PixelTriangles::STATUS_LONGEST;
    /// Triangles in the lists of all pixels, and a flag: more than 2^32.
    pub const PIXEL_TRIANGLES: usize = 26;
    /// Pixels whose samples are looked at one by one, and 0.
    pub const COMPLEX_PIXELS: usize = 28;
    /// Facets, and a flag: more than 2^32.
    pub const FACETS: usize = 30;
    /// Words of a band of a view: pixel-texel pairs and flag, triangle-texel pairs and flag, candidates, doubts, longest list,
    /// marked texels (of the first band).
    pub const BAND_WORDS: usize = 8;
    /// Which of them that is.
    pub const BAND_TEXELS: usize = 7;

    /// The first word of a band of a view, of which there are `bands`.
    pub(crate) fn band(view: u32, band: u32, bands: u32) -> usize {
        BANDS + BAND_WORDS * (view * bands + band) as usize
    }

    /// All words.
    pub(crate) fn words(of: super::Capacities) -> usize {
        band(of.views, 0, of.bands)
    }
}

/// Indirect arguments, by position.
#[derive(Clone, Copy)]
pub enum Arg {
    Edges,
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
    pub layers: Layers,
    pub edge_rects: Buffer<[u32; 2]>,
    pub edge_items: Buffer<u32>,
    pub edge_offsets: Buffer<u32>,
    pub sat: Buffer<u32>,
    pub sat_scratch: summed_area::Scratch,
    pub facets: Facets,
    pub facet_offsets: Buffer<u32>,
    pub lists: PairLists,
    /// Pairs as they come, of facets and of triangles, where they are sorted.
    pub unsorted: Option<[sorted_pairs::Scratch; 2]>,
    pub scan_scratch: prefix_scan::Scratch,
    pub args: Buffer<u32>,
    pub requests: Vec<Requests>,
    pub status: Buffer<u32>,
    pub visibility: Buffer<f32>,
    pub lit: Buffer<u32>,
}

impl Memory {
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        casters: &CasterBuffers,
        settings: &Settings,
        summed_area: &SummedArea,
        capacities: Capacities,
    ) -> Result<Self> {
        let (pixels, map, words) = (settings.pixels(), settings.map as usize, settings.samples.words() as usize);
        let edges = casters.edges.len();
        let PairMemory { lists, unsorted } = PairMemory::new(device, settings, capacities)?;
        let FacetMemory { facets, offsets, scan_scratch } =
            FacetMemory::new(device, settings, edges.max(map * map), capacities.facets)?;
        let words_of = |label: &str, len: usize| Buffer::storage(device, label, len);
        let samples = Buffer::uniform(device, "samples", 64)?;
        samples.write(queue, &sample_words(&settings.samples));
        let table = mask_table(&settings.samples, settings.masks.size());
        Ok(Self {
            samples,
            table: Buffer::from_slice(device, queue, "visibility_masks.table", &table)?,
            frames: frames(device, capacities)?,
            geometry: Geometry::new(device, queue, casters, pixels, map * map)?,
            layers: Layers::new(device, map)?,
            edge_rects: Buffer::storage(device, "silhouette_mask.edge_rects", edges)?,
            edge_items: words_of("silhouette_mask.edge_items", edges)?,
            edge_offsets: words_of("silhouette_mask.edge_offsets", WorkOwners::words(edges, map * map))?,
            sat: words_of("summed_area.sat", map * map)?,
            sat_scratch: summed_area.scratch(device, map, map)?,
            facets,
            facet_offsets: offsets,
            lists,
            unsorted,
            scan_scratch,
            args: Buffer::indirect(device, "dispatch_args.args", 3 * 8)?,
            requests: requests(device, queue, [edges, pixels, capacities.facets, casters.triangles.len()], capacities)?,
            status: words_of("status", status::words(capacities))?,
            visibility: Buffer::storage(device, "resolve.visibility", pixels)?,
            lit: words_of("resolve.lit", pixels * words)?,
        })
    }
}

pub fn frames(device: &wgpu::Device, c: Capacities) -> Result<Vec<Buffer<Frame>>> {
    (0..c.views * c.bands * c.rounds).map(|_| Buffer::uniform(device, "frame", 1)).collect()
}

/// Buffers whose length is that of the lists of pairs and candidates.
pub struct PairMemory {
    pub lists: PairLists,
    pub unsorted: Option<[sorted_pairs::Scratch; 2]>,
}

impl PairMemory {
    pub fn new(device: &wgpu::Device, settings: &Settings, c: Capacities) -> Result<Self> {
        let (map, places) = (settings.map as usize, settings.pairs.places());
        let scratch = |pairs, both| SortedPairs::scratch(device, pairs, both);
        let sorted = settings.pairs == PairVariant::Sorted;
        Ok(Self {
            lists: PairLists::new(device, map, places, c.pixel_pairs, c.triangle_pairs, c.candidates)?,
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
    pub scan_scratch: prefix_scan::Scratch,
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

/// Requests of indirect arguments, one list of one for each [`Arg`]. `totals` are the words of the totals of edges, listed facets, blocks of facets and of
/// casters; the rest are in the tally.
pub fn requests(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    totals: [usize; 4],
    c: Capacities,
) -> Result<Vec<Requests>> {
    let [edges, listed, facets, casters] = totals;
    let all = Request::MAX_LIMIT;
    let found_once = PairLists::touched_words(c.pixel_pairs, c.triangle_pairs);
    let all = [
        (edges, silhouette_mask::WORKGROUP, all, 0),
        (listed, facet_classify::WORKGROUP, c.facets, 0),
        (facets, pixel_texel_pairs::WORKGROUP, all, 0),
        (tally::TALLY_PAIRS as usize, candidate_pairs::WORKGROUP, c.pixel_pairs, 0),
        (tally::TALLY_CANDIDATES as usize, visibility_masks::WORKGROUP, c.candidates, 0),
        (tally::TALLY_DOUBTS as usize, visibility_masks::WORKGROUP, c.candidates, 0),
        (facets, pixel_texel_pairs::WORKGROUP, all, found_once),
        (casters, triangle_texel_pairs::WORKGROUP, all, found_once),
    ];
    let request = |(k, (count, group, limit, skip)): (usize, (usize, u32, usize, usize))| {
        DispatchArgs::requests(device, queue, &[Request::new(count, group, limit, 3 * k)?.after(skip)])
    };
    all.into_iter().enumerate().map(request).collect()
}
