//! Sample surfaces: which surface each sample sees, and one facet for each surface that a pixel's samples see.
//!
//! - **Reads** the lists of [`super::pixel_triangles`], the compacted list of complex pixels, triangles, projected vertices.
//! - **Writes** facets (pixel, triangle, origin), their coverage masks, `pixel_facets`, and `id_keys` (complement of the
//!   triangle at each pixel centre; must be 0 before).
//! - **Guarantee.** Each sample that sees a surface lies in exactly one facet: that of the nearest triangle, of equally near
//!   ones the lowest; with [`SampleSurfaces::merging`] that of the nearest triangle's surface. Depths within 2^-20 of one
//!   another are compared with 46 bits, however many they are. Edges belong to both sides, and around a vertex all edges agree
//!   on where the sample is. Bit-equal from run to run. Nothing is written beyond the capacities.
//! - **Capacity.** As many triangles of a pixel a dispatch as [`Profile::turns`] of 512 says; longer lists take more dispatches.
//!   Samples of more complex pixels than one binding holds are taken in bands, one after the other.
//! - **Cost.** One invocation for each complex pixel and word of its samples: about 45 flop for each sample and triangle of
//!   its list, and 250 a triangle. A sample within rounding of an edge, or of two surfaces that bounds of their depths do not
//!   tell apart, costs about 150 more. Per complex pixel 4 bytes a sample, read once for each of its surfaces and once more.
//!   Where three or more surfaces touch, the pixel's list is gone through once more for each such sample.

mod complex_pixels;

use super::facet_classify::Facets;
use super::pixel_triangles::PixelLists;
use super::{Count, DispatchArgs, PrefixScan, prefix_scan};
use crate::frame::Frame;
use crate::gpu::kernels::sample_surfaces as kernel;
use crate::gpu::{Buffer, Groups, Profile, Stage, Uniforms};
use crate::{Error, Result, shared_struct};

pub use complex_pixels::ComplexPixels;
pub use kernel::{SEVERAL, WORKGROUP};

shared_struct! {
    /// Complex pixels that a dispatch takes.
    "sample_surfaces/surface_step" => pub struct SurfaceStep {
        /// Which part of each list of triangles.
        pub round: u32,
        /// First complex pixel.
        pub first_slot: u32,
        /// Complex pixels at most.
        pub slots: u32,
        /// Word of the samples.
        pub word: u32,
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
    nearest: kernel::NearestProgram,
    begin: kernel::BeginProgram,
    rivals: kernel::SettleRivalsProgram,
    crowds: kernel::SettleCrowdsProgram,
    name: Option<kernel::NameSurfacesProgram>,
    group: kernel::GroupSamplesProgram,
    /// Pipelines for triangles by themselves, and for surfaces.
    emit: [Option<kernel::EmitProgram>; 2],
    emit_single: kernel::EmitSingleProgram,
    fold: DispatchArgs,
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

/// Buffers of the kernels that look for the nearest surface, of one band.
#[derive(Clone, Copy)]
struct Seen<'a> {
    frame: &'a Buffer<Frame>,
    mesh: SurfaceInputs<'a>,
    lists: &'a PixelLists,
    complex: &'a ComplexPixels,
    keys: &'a Buffer<u32>,
}

impl<'s> Seen<'s> {
    fn bindings<'a>(self, step: &'a Buffer<SurfaceStep>) -> kernel::Search<'a>
    where
        's: 'a,
    {
        let Self { frame, mesh, lists, complex, keys } = self;
        kernel::Search {
            frame: frame.as_uniform(),
            samples: mesh.samples.as_uniform(),
            step: step.as_uniform(),
            triangles: mesh.triangles.as_read(),
            points: mesh.points.as_read(),
            positions: mesh.positions.as_read(),
            pixel_offsets: lists.offsets.as_read(),
            pixel_list: lists.list.as_read(),
            complex_pixels: complex.pixels.as_read(),
            complex_total: complex.total.as_read(),
            sample_keys: keys.as_write(),
            rivals_found: complex.rivals.as_write(),
            crowds: complex.crowds.as_write(),
        }
    }
}

/// Records what samples see that lie in no listed triangle: of so many complex pixels from the first on, into the keys of
/// their samples ([`ComplexPixels::keys`]), with a workgroup for each [`WORKGROUP`] pixels.
pub type Fill<'a> = &'a dyn Fn(&mut Stage, [u32; 2], &Buffer<u32>, Groups) -> Result<()>;

impl SampleSurfaces {
    /// Builds the pipelines for `samples` samples a pixel; `scan` is shared. Every triangle is a surface of its own.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::Never, false)
    }

    /// As [`SampleSurfaces::new`]; triangles of one surface ([`SurfaceInputs::surfaces`]) make one facet.
    pub fn merging(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::Always, false)
    }

    /// As [`SampleSurfaces::merging`] where surfaces are given, else as [`SampleSurfaces::new`]; `alpha`: triangles may be alpha-tested.
    pub fn for_any(device: &wgpu::Device, scan: &PrefixScan, samples: u32, alpha: bool) -> Self {
        Self::with(device, scan, samples, Merging::WhereGiven, alpha)
    }

    fn with(device: &wgpu::Device, scan: &PrefixScan, samples: u32, merge: Merging, alpha: bool) -> Self {
        let words = samples.div_ceil(32);
        let round_length = Profile::of(device).turns(512);
        let (samples, alpha) = (samples.min(32), u32::from(alpha));
        let of = |merge: u32| kernel::Constants { words, merge, samples, alpha, round_length };
        let constants = of(0);
        let emit = |with: bool, merge| with.then(|| kernel::EmitProgram::new(device, of(merge)));
        Self {
            nearest: kernel::NearestProgram::new(device, constants),
            begin: kernel::BeginProgram::new(device, constants),
            rivals: kernel::SettleRivalsProgram::new(device, constants),
            crowds: kernel::SettleCrowdsProgram::new(device, constants),
            name: (merge != Merging::Never).then(|| kernel::NameSurfacesProgram::new(device, constants)),
            group: kernel::GroupSamplesProgram::new(device, constants),
            emit: [emit(merge != Merging::Always, 0), emit(merge != Merging::Never, 1)],
            emit_single: kernel::EmitSingleProgram::new(device, constants),
            fold: DispatchArgs::new(device),
            scan: scan.clone(),
            words,
            round_length,
            uniforms: Uniforms::default(),
        }
    }

    /// Records all of it, of pixels with up to `most` triangles. `args`: indirect arguments of one workgroup for each [`WORKGROUP`] complex
    /// pixels; `fill` may give samples that lie in no listed triangle what they see.
    ///
    /// # Errors
    /// Those of `fill`; [`crate::Error::Config`] if a buffer is too small for the image, or there are no surfaces to merge by.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        mesh: SurfaceInputs,
        lists: &PixelLists,
        complex: &ComplexPixels,
        args: (&wgpu::Buffer, u64),
        most: u32,
        scratch: &prefix_scan::PrefixScanScratch,
        facets: &Facets,
        id_keys: &Buffer<u32>,
        fill: Option<Fill>,
    ) -> Result<()> {
        let pixels = lists.counts.len();
        let name = self.name.as_ref().zip(mesh.surfaces);
        let Some(emit) = &self.emit[usize::from(name.is_some())] else {
            return Err(Error::Config("sample_surfaces: no surfaces to merge by".to_owned()));
        };
        // As many workgroups as there are complex pixels; with several bands, as a band may hold.
        let groups = || match complex.keys.len() {
            1 => Groups::Indirect(args.0, args.1),
            _ => Groups::Items(complex.band as u64),
        };
        let words = self.words;
        let rounds = most.div_ceil(self.round_length).max(1);
        let turns = || (0..rounds).flat_map(move |round| (0..words).map(move |word| (round, word)));
        for (band, keys) in complex.bands() {
            let seen = Seen { frame, mesh, lists, complex, keys };
            for (round, word) in turns() {
                let step = self.uniforms.get(stage.device, &SurfaceStep { round, word, ..band })?;
                stage.run(&self.nearest, seen.bindings(&step), groups());
            }
            stage.run(&self.begin, kernel::Begin { crowds: complex.crowds.as_write() }, Groups::Workgroups(1));
            if let Some(fill) = fill {
                fill(stage, [band.first_slot, band.slots], keys, groups())?;
            }
            let step = self.uniforms.get(stage.device, &band)?;
            stage.run(&self.rivals, seen.bindings(&step), groups());
            self.fold.record(stage, &complex.crowds, &complex.crowd_requests, &complex.crowd_args)?;
            for (round, word) in turns() {
                let step = self.uniforms.get(stage.device, &SurfaceStep { round, word, ..band })?;
                stage.run(&self.crowds, seen.bindings(&step), Groups::Indirect(complex.crowd_args.raw(), 0));
            }
            self.record_names(stage, frame, &step, mesh, complex, keys, groups())?;
            let group_keys = if name.is_some() { &complex.rivals } else { keys };
            let bindings = kernel::GroupSamples {
                frame: frame.as_uniform(),
                step: step.as_uniform(),
                complex_pixels: complex.pixels.as_read(),
                complex_total: complex.total.as_read(),
                group_keys: group_keys.as_read(),
                facet_counts: lists.facet_counts.as_write(),
            };
            stage.run(&self.group, bindings, groups());
        }
        let (counts, offsets) = (&lists.facet_counts, &facets.pixel_facets);
        self.scan.record(stage, counts, offsets, (offsets, pixels), scratch, Count::Exactly(pixels))?;
        let bindings = kernel::EmitSingle {
            frame: frame.as_uniform(),
            pixel_offsets: lists.offsets.as_read(),
            pixel_list: lists.list.as_read(),
            complex_flags: lists.complex_flags.as_read(),
            pixel_facets: facets.pixel_facets.as_read(),
            facets: facets.list.as_write(),
            masks: facets.masks.as_write(),
            id_keys: id_keys.as_write(),
        };
        stage.run(&self.emit_single, bindings, Groups::Items(pixels.max(facets.list.len()) as u64));
        for (band, keys) in complex.bands() {
            let step = self.uniforms.get(stage.device, &band)?;
            if complex.keys.len() > 1 {
                // Those of other bands were written over.
                self.record_names(stage, frame, &step, mesh, complex, keys, groups())?;
            }
            let group_keys = if name.is_some() { &complex.rivals } else { keys };
            let bindings = kernel::Emit {
                frame: frame.as_uniform(),
                samples: mesh.samples.as_uniform(),
                step: step.as_uniform(),
                complex_pixels: complex.pixels.as_read(),
                complex_total: complex.total.as_read(),
                seen_keys: keys.as_read(),
                group_keys: group_keys.as_read(),
                pixel_facets: facets.pixel_facets.as_read(),
                facets: facets.list.as_write(),
                masks: facets.masks.as_write(),
                id_keys: id_keys.as_write(),
            };
            stage.run(emit, bindings, groups());
        }
        Ok(())
    }

    /// Records what the surfaces of a band's samples are, where they are merged.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    fn record_names(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        step: &Buffer<SurfaceStep>,
        mesh: SurfaceInputs,
        complex: &ComplexPixels,
        keys: &Buffer<u32>,
        groups: Groups,
    ) -> Result<()> {
        let Some((name, surfaces)) = self.name.as_ref().zip(mesh.surfaces) else { return Ok(()) };
        let bindings = kernel::NameSurfaces {
            frame: frame.as_uniform(),
            step: step.as_uniform(),
            triangles: mesh.triangles.as_read(),
            points: mesh.points.as_read(),
            complex_total: complex.total.as_read(),
            sample_keys: keys.as_write(),
            surfaces: surfaces.as_read(),
            named_keys: complex.rivals.as_write(),
        };
        stage.run(name, bindings, groups);
        Ok(())
    }
}
