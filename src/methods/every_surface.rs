//! The camera side of `facet-masks` with a facet for every surface that a pixel's samples see: which pixels show one
//! surface is proved; in all others, masks of the samples that triangles cover, nearer ones first.

use super::facet_masks::{Capacities, Settings};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::pixel_triangles;
use crate::gpu::{Buffer, Groups, Recorder};
use crate::stages::camera_visibility::Blocks;
use crate::stages::compact::{self, Compact, Flags};
use crate::stages::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use crate::stages::facet_classify::Facets;
use crate::stages::gbuffer_triangles::{GbufferTriangles, SampleGbuffer};
use crate::stages::pixel_coverage::{self, PairCoverage, PixelCoverage};
use crate::stages::pixel_triangles::{PixelLists, PixelTriangles};
use crate::stages::sample_surfaces::{ComplexPixels, SampleSurfaces, SurfaceInputs, WORKGROUP};
use crate::stages::surface_receivers::{GivenSurfaces, ListedPixels, ReceiverPlaces, SurfaceReceivers};
use crate::stages::{Count, PrefixScan, prefix_scan};
use crate::status_word;

/// A G-buffer of several samples a pixel in place of the search for what pixels show.
#[derive(Clone, Copy, Debug)]
pub struct SampleIds<'a> {
    /// The pipelines.
    pub stage: &'a GbufferTriangles,
    /// The G-buffer.
    pub given: SampleGbuffer<'a>,
    /// Takes the count of samples that name no triangle.
    pub faults: &'a Buffer<u32>,
}

/// Source of the surfaces that pixels show besides the triangles that are searched.
#[derive(Clone, Copy, Debug)]
pub enum SurfacesBy<'a> {
    /// None: the triangles are all there is.
    Search,
    /// A G-buffer of several samples, and no search.
    Samples(&'a SampleIds<'a>),
    /// A G-buffer of depths or positions: some of what it shows casts nothing.
    Receivers(GivenSurfaces<'a>),
}

/// The pipelines, for any mesh and image.
#[derive(Debug)]
pub struct SurfacePipelines {
    triangles: PixelTriangles,
    coverage: PixelCoverage,
    compact: Compact,
    surfaces: SampleSurfaces,
    fold: DispatchArgs,
    receivers: Option<SurfaceReceivers>,
}

impl SurfacePipelines {
    /// Builds them for so many samples a pixel; `alpha`: triangles may be alpha-tested, `receivers`: pixels may show what casts nothing.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, samples: u32, [alpha, receivers]: [bool; 2]) -> Self {
        Self {
            triangles: PixelTriangles::new(device, scan),
            coverage: PixelCoverage::new(device, samples, alpha),
            compact: Compact::new(device, scan),
            surfaces: SampleSurfaces::for_any(device, scan, samples),
            fold: DispatchArgs::new(device),
            receivers: receivers.then(|| SurfaceReceivers::new(device, samples)),
        }
    }

    /// Whether pixels may show what casts nothing.
    pub fn takes_receivers(&self) -> bool {
        self.receivers.is_some()
    }
}

/// The memory of one mesh and image.
#[derive(Debug)]
pub struct EverySurface {
    lists: PixelLists,
    coverage: PairCoverage,
    complex: ComplexPixels,
    compact_scratch: compact::CompactScratch,
    scan_scratch: prefix_scan::PrefixScanScratch,
    requests: [Requests; 3],
    args: [Buffer<u32>; 3],
    casters: usize,
    most_at_pixel: u32,
    /// Receivers around pixels, if there may be any.
    chosen: Option<Buffer<u32>>,
}

impl EverySurface {
    /// Makes the memory for a mesh of `casters` triangles, and of `receivers`, if there are any.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        (casters, receivers): (usize, bool),
        settings: &Settings,
        capacities: Capacities,
    ) -> Result<Self> {
        let words = settings.samples.words();
        let pixels = settings.pixels();
        let c = capacities;
        let lists = PixelLists::new(device, pixels, c.pixel_triangles)?;
        Ok(Self {
            requests: requests(device, queue, casters, &lists, c)?,
            lists,
            coverage: PairCoverage::new(device, c.pixel_triangles, words as usize)?,
            complex: ComplexPixels::new(device, c.complex_pixels, words as usize)?,
            compact_scratch: Compact::scratch(device, pixels)?,
            scan_scratch: PrefixScan::scratch(device, pixels)?,
            args: [
                Buffer::indirect(device, "every_surface.again_args", 3)?,
                Buffer::indirect(device, "every_surface.pair_args", 3)?,
                Buffer::indirect(device, "every_surface.pixel_args", 3)?,
            ],
            casters,
            most_at_pixel: c.most_at_pixel,
            chosen: receivers.then(|| SurfaceReceivers::memory(device, pixels)).transpose()?,
        })
    }

    /// Sizes the lists anew that were made for other capacities.
    ///
    /// # Errors
    /// As [`EverySurface::new`]; all is then as before.
    pub fn resize(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        settings: &Settings,
        (now, c): (Capacities, Capacities),
    ) -> Result<()> {
        let sizes = |c: Capacities| (c.pixel_triangles, c.complex_pixels, c.facets);
        if sizes(c) != sizes(now) {
            let lists = PixelLists::new(device, settings.pixels(), c.pixel_triangles)?;
            let words = settings.samples.words() as usize;
            let coverage = PairCoverage::new(device, c.pixel_triangles, words)?;
            let complex = ComplexPixels::new(device, c.complex_pixels, words)?;
            self.requests = requests(device, queue, self.casters, &lists, c)?;
            (self.lists, self.coverage, self.complex) = (lists, coverage, complex);
        }
        self.most_at_pixel = c.most_at_pixel;
        Ok(())
    }

    /// Records the facets of all pixels: of the surfaces found among the triangles, or of those of a G-buffer. Where `merged_by` tells
    /// the surface of each triangle, the triangles of one make one facet.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        rec: &mut Recorder,
        with: &SurfacePipelines,
        frame: &Buffer<Frame>,
        samples: &Buffer<[f32; 4]>,
        in_camera: Blocks,
        positions: &Buffer<[f32; 4]>,
        merged_by: Option<&Buffer<u32>>,
        facets: &Facets,
        id_keys: &Buffer<u32>,
        status_words: &Buffer<u32>,
        by: SurfacesBy,
    ) -> Result<()> {
        let (lists, coverage, complex) = (&self.lists, &self.coverage, &self.complex);
        let points = in_camera.points;
        let receivers = match (by, &with.receivers, &self.chosen) {
            (SurfacesBy::Receivers(given), Some(with), Some(chosen)) => Some((given, with, chosen)),
            _ => None,
        };
        let [again_args, pair_args, pixel_args] = &self.args;
        let pixels = lists.counts.len();
        rec.clear(lists.cover_keys.raw());
        rec.clear(lists.counts.raw());
        if let SurfacesBy::Samples(SampleIds { stage: of_samples, given, faults }) = by {
            let stage = &mut rec.stage("gbuffer_triangles");
            of_samples.record(stage, frame, given, lists, id_keys, &self.scan_scratch, status_words, faults)?;
        } else {
            let stage = &mut rec.stage("pixel_triangles");
            with.fold.record(stage, in_camera.offsets, &self.requests[0], again_args)?;
            let rest = (again_args.raw(), 0);
            if let Some((given, with, chosen)) = receivers {
                let places = ReceiverPlaces { positions, points };
                with.record_own(stage, frame, given, places, lists, id_keys, chosen)?;
            }
            with.triangles.record_counts(stage, frame, in_camera, lists, id_keys)?;
            if let Some((given, with, chosen)) = receivers {
                with.record_choose(stage, frame, given, points, lists, id_keys, chosen)?;
            }
            let (triangles, scratch) = (&with.triangles, &self.scan_scratch);
            triangles.record_lists(stage, frame, in_camera, rest, lists, id_keys, (scratch, status_words))?;
            if let Some((_, with, chosen)) = receivers {
                with.record_list(stage, frame, lists, chosen);
            }
        }
        // Another compilation may have written fewer than were counted: they begin at 0 all the same.
        rec.clear(lists.counts.raw());
        let mesh = SurfaceInputs {
            samples,
            triangles: in_camera.triangles,
            points: in_camera.points,
            positions,
            surfaces: merged_by,
        };
        {
            let stage = &mut rec.stage("pixel_coverage");
            with.fold.record(stage, &lists.offsets, &self.requests[1], pair_args)?;
            with.coverage.record(stage, frame, mesh, lists, coverage, Groups::Indirect(pair_args.raw(), 0));
        }
        {
            let stage = &mut rec.stage("sample_surfaces");
            let flags = Flags::Words(&lists.complex_flags);
            let total = (&complex.total, 0);
            let count = Count::Exactly(pixels);
            with.compact.record(stage, flags, None, &complex.pixels, total, &self.compact_scratch, count)?;
            with.fold.record(stage, &complex.total, &self.requests[2], pixel_args)?;
            let (args, scratch) = ((pixel_args.raw(), 0), &self.scan_scratch);
            if let Some((given, with, chosen)) = receivers {
                let groups = Groups::Indirect(args.0, args.1);
                let listed = ListedPixels { pixels: &complex.pixels, total: &complex.total, groups };
                with.record_cover(stage, frame, samples, given, points, listed, lists, (coverage, chosen))?;
            }
            if let SurfacesBy::Samples(SampleIds { stage: of_samples, given, .. }) = by {
                let (listed, total, groups) = (&complex.pixels, &complex.total, Groups::Indirect(args.0, args.1));
                of_samples.record_fill(stage, frame, given, lists, listed, total, coverage, groups)?;
            }
            let most = self.most_at_pixel;
            let surfaces = &with.surfaces;
            surfaces.record(stage, frame, mesh, lists, coverage, complex, args, most, scratch, facets, id_keys)?;
        }
        let mut keep = |from: &Buffer<u32>, first: usize, at: usize| {
            rec.copy_words(from.raw(), first as u64, status_words.raw(), at as u64, 2);
        };
        keep(&lists.offsets, pixels, status_word!(pixel_triangles));
        keep(&complex.total, 0, status_word!(complex_pixels));
        keep(&facets.pixel_facets, pixels, status_word!(facets_needed));
        Ok(())
    }
}

/// Workgroups for blocks of casters whose pixels are found twice, for listed triangles, and for complex pixels.
fn requests(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    casters: usize,
    lists: &PixelLists,
    c: Capacities,
) -> Result<[Requests; 3]> {
    let again =
        ArgsRequest::new(casters, pixel_triangles::WORKGROUP, ArgsRequest::MAX_LIMIT, 0)?.after(lists.touched.len());
    let pairs = ArgsRequest::new(lists.counts.len(), pixel_coverage::WORKGROUP, c.pixel_triangles, 0)?;
    let complex = ArgsRequest::new(0, WORKGROUP, c.complex_pixels, 0)?;
    let of = |request| DispatchArgs::requests(device, queue, &[request]);
    Ok([of(again)?, of(pairs)?, of(complex)?])
}
