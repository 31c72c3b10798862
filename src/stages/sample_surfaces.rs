//! Sample surfaces: which surface each sample sees, and one facet for each surface that a pixel's samples see.
//!
//! - **Reads** the triangles that cover samples of complex pixels, and which ([`super::pixel_coverage`]), the compacted list of those
//!   pixels, triangles, projected vertices; `id_keys` of single pixels.
//! - **Writes** facets (pixel, triangle, origin), their coverage masks, `pixel_facets`, and `id_keys` of complex pixels (complement of
//!   the triangle at each pixel centre). Lists and masks are left with what is seen, at the front; [`PixelLists::counts`] is 0 again.
//! - **Guarantee.** Each sample that sees a surface lies in exactly one facet: that of the nearest triangle, of equally near
//!   ones the lowest; with [`SampleSurfaces::merging`] that of the nearest triangle's surface. Depths within 2^-20 of one
//!   another are compared with 46 bits, however many they are. Bit-equal from run to run. Nothing is written beyond the capacities.
//! - **Capacity.** As many triangles of a pixel a round as [`Profile::turns`] of 512 says; longer lists take more rounds.
//! - **Cost.** One invocation a complex pixel and 32 samples: a word a listed triangle; where several cover a sample, about 10 flop a
//!   sample for each of those, twice. A sample at which bounds leave several costs about 150 for each. Then a word a triangle
//!   that is seen, twice for each surface.

mod complex_pixels;

use super::facet_classify::Facets;
use super::pixel_coverage::PairCoverage;
use super::pixel_triangles::PixelLists;
use super::{Count, PrefixScan, prefix_scan};
use crate::frame::Frame;
use crate::gpu::kernels::sample_surfaces as kernel;
use crate::gpu::{Buffer, Groups, Profile, Stage, Uniforms};
use crate::{Error, Result, shared_struct};

pub use complex_pixels::ComplexPixels;
pub use kernel::{SEVERAL, WORKGROUP};

shared_struct! {
    /// The part of its work that a run does.
    "sample_surfaces/surface_step" => pub struct SurfaceStep {
        /// Which part of each list of triangles.
        pub round: u32,
        /// Word of the samples.
        pub word: u32,
    }
}

shared_struct! {
    /// A complex pixel, and where its list stands.
    "sample_surfaces/pixel_entries" => pub struct PixelSlot {
        /// The pixel; `u32::MAX` beyond the last.
        pub pixel: u32,
        /// Where its list begins.
        pub first: u32,
        /// Where that ends.
        pub end: u32,
        /// Triangles that see anything, at the front.
        pub kept: u32,
        /// View depth of their farthest corner, if one of their surfaces has several triangles.
        pub far: f32,
    }
}

/// Whether the triangles of one surface make one facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Merging {
    Never,
    Always,
    WhereGiven,
}

/// The pipelines for one number of samples.
#[derive(Debug)]
pub struct SampleSurfaces {
    begin: kernel::BeginProgram,
    nearest: kernel::NearestProgram,
    settle: kernel::SettleProgram,
    /// Pipelines for triangles by themselves, and for surfaces.
    gather: [Option<kernel::GatherProgram>; 2],
    emit: [Option<kernel::EmitProgram>; 2],
    emit_single: kernel::EmitSingleProgram,
    scan: PrefixScan,
    words: u32,
    round_length: u32,
    uniforms: Uniforms,
}

/// Inputs of the stage besides the lists.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceInputs<'a> {
    /// Sample offsets.
    pub samples: &'a Buffer<[f32; 4]>,
    /// Vertex indices, 16 bytes a triangle: three, and a word that this stage does not read.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Projected vertices.
    pub points: &'a Buffer<[f32; 4]>,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a Buffer<[f32; 4]>,
    /// Lowest triangle of each triangle's surface, with [`SEVERAL`] where that has more than one; read if surfaces merge.
    pub surfaces: Option<&'a Buffer<u32>>,
}

impl SampleSurfaces {
    /// Builds the pipelines for `samples` samples a pixel; `scan` is shared. Every triangle is a surface of its own.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::Never)
    }

    /// As [`SampleSurfaces::new`]; triangles of one surface ([`SurfaceInputs::surfaces`]) make one facet.
    pub fn merging(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::Always)
    }

    /// As [`SampleSurfaces::merging`] where surfaces are given, else as [`SampleSurfaces::new`].
    pub fn for_any(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::WhereGiven)
    }

    fn with(device: &wgpu::Device, scan: &PrefixScan, samples: u32, merge: Merging) -> Self {
        let words = samples.div_ceil(32);
        let round_length = Profile::of(device).turns(512);
        let of = |merge: u32| kernel::Constants { words, merge, samples: samples.min(32), round_length };
        let with = [merge != Merging::Always, merge != Merging::Never];
        Self {
            begin: kernel::BeginProgram::new(device, of(0)),
            nearest: kernel::NearestProgram::new(device, of(0)),
            settle: kernel::SettleProgram::new(device, of(0)),
            gather: [0, 1].map(|merge| with[merge].then(|| kernel::GatherProgram::new(device, of(merge as u32)))),
            emit: [0, 1].map(|merge| with[merge].then(|| kernel::EmitProgram::new(device, of(merge as u32)))),
            emit_single: kernel::EmitSingleProgram::new(device, of(0)),
            scan: scan.clone(),
            words,
            round_length,
            uniforms: Uniforms::default(),
        }
    }

    /// Records all of it, of pixels with up to `most` triangles. `args`: indirect arguments of one workgroup for each [`WORKGROUP`] complex
    /// pixels.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if a buffer is too small for the image, or there are no surfaces to merge by.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        mesh: SurfaceInputs,
        lists: &PixelLists,
        coverage: &PairCoverage,
        complex: &ComplexPixels,
        args: (&wgpu::Buffer, u64),
        most: u32,
        scratch: &prefix_scan::PrefixScanScratch,
        facets: &Facets,
        id_keys: &Buffer<u32>,
    ) -> Result<()> {
        let pixels = lists.counts.len();
        let merge = usize::from(mesh.surfaces.is_some() && self.emit[1].is_some());
        let (Some(gather), Some(emit)) = (&self.gather[merge], &self.emit[merge]) else {
            return Err(Error::Config("sample_surfaces: no surfaces to merge by".to_owned()));
        };
        // Not read where nothing is merged.
        let surfaces = mesh.surfaces.unwrap_or(&complex.total).as_read();
        let groups = || Groups::Indirect(args.0, args.1);
        let bindings = kernel::Begin {
            frame: frame.as_uniform(),
            pixel_offsets: lists.offsets.as_read(),
            pixel_counts: lists.counts.as_write(),
            complex_pixels: complex.pixels.as_read(),
            complex_total: complex.total.as_read(),
            slots: complex.slots.as_write(),
        };
        stage.run(&self.begin, bindings, groups());
        for round in 0..most.div_ceil(self.round_length).max(1) {
            let steps: Vec<_> = (0..self.words)
                .map(|word| self.uniforms.get(stage.device, &SurfaceStep { round, word }))
                .collect::<Result<_>>()?;
            for step in &steps {
                stage.run(&self.nearest, Self::search(frame, mesh, coverage, complex, step), groups());
            }
            for step in &steps {
                stage.run(&self.settle, Self::search(frame, mesh, coverage, complex, step), groups());
            }
            let bindings = kernel::Gather {
                frame: frame.as_uniform(),
                step: steps[0].as_uniform(),
                triangles: mesh.triangles.as_read(),
                points: mesh.points.as_read(),
                coverings: coverage.list.as_write(),
                covering_masks: coverage.masks.as_write(),
                facet_counts: lists.facet_counts.as_write(),
                surfaces,
                slots: complex.slots.as_write(),
            };
            stage.run(gather, bindings, groups());
        }
        let (counts, offsets) = (&lists.facet_counts, &facets.pixel_facets);
        self.scan.record(stage, counts, offsets, (offsets, pixels), scratch, Count::Exactly(pixels))?;
        let bindings = kernel::EmitSingle {
            frame: frame.as_uniform(),
            complex_flags: lists.complex_flags.as_read(),
            pixel_facets: facets.pixel_facets.as_read(),
            facets: facets.list.as_write(),
            masks: facets.masks.as_write(),
            id_keys: id_keys.as_write(),
        };
        stage.run(&self.emit_single, bindings, Groups::Items(pixels.max(facets.list.len()) as u64));
        let bindings = kernel::Emit {
            frame: frame.as_uniform(),
            samples: mesh.samples.as_uniform(),
            coverings: coverage.list.as_write(),
            covering_masks: coverage.masks.as_write(),
            pixel_facets: facets.pixel_facets.as_read(),
            facets: facets.list.as_write(),
            masks: facets.masks.as_write(),
            id_keys: id_keys.as_write(),
            surfaces,
            slots: complex.slots.as_write(),
        };
        stage.run(emit, bindings, groups());
        Ok(())
    }

    /// Buffers of the kernels that look for the nearest triangle.
    fn search<'a>(
        frame: &'a Buffer<Frame>,
        mesh: SurfaceInputs<'a>,
        coverage: &'a PairCoverage,
        complex: &'a ComplexPixels,
        step: &'a Buffer<SurfaceStep>,
    ) -> kernel::Search<'a> {
        kernel::Search {
            frame: frame.as_uniform(),
            samples: mesh.samples.as_uniform(),
            step: step.as_uniform(),
            triangles: mesh.triangles.as_read(),
            points: mesh.points.as_read(),
            coverings: coverage.list.as_write(),
            positions: mesh.positions.as_read(),
            covering_masks: coverage.masks.as_write(),
            contested: complex.contested.as_write(),
            slots: complex.slots.as_write(),
        }
    }
}
