//! Sample surfaces: which surface each sample sees, and one facet for each surface that a pixel's samples see.
//!
//! - **Reads** the lists of [`super::pixel_triangles`], the compacted list of complex pixels, triangles, projected vertices.
//! - **Writes** facets (pixel, triangle, origin), their coverage masks, `pixel_facets`, and `id_keys` (complement of the
//!   triangle at each pixel centre; must be 0 before).
//! - **Guarantee.** Each sample that sees a surface lies in exactly one facet: that of the nearest triangle, of equally near
//!   ones the lowest; with [`SampleSurfaces::merging`] that of the nearest triangle's surface. Depths within 2^-20 of one
//!   another are compared with 46 bits, however many they are. Edges belong to both sides, and around a vertex all edges agree
//!   on where the sample is. Bit-equal from run to run. Nothing is written beyond the capacities.
//! - **Capacity.** [`ROUND_LENGTH`] triangles of a pixel a dispatch; longer lists take more rounds.
//!   Samples of more complex pixels than one binding holds are taken in bands, one after the other.
//! - **Cost.** One invocation for each complex pixel and word of its samples: about 45 flop for each sample and triangle of
//!   its list, and 250 a triangle. A sample within rounding of an edge, or of two surfaces that bounds of their depths do not
//!   tell apart, costs about 150 more. Per complex pixel 4 bytes a sample, read once for each of its surfaces and once more.
//!   Where three or more surfaces touch, the pixel's list is gone through once more for each such sample.

mod complex_pixels;

use super::facet_classify::Facets;
use super::pixel_triangles::PixelLists;
use super::{Count, DispatchArgs, PrefixScan, prefix_scan};
use crate::gpu::kernels::sample_surfaces as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};
use crate::{Error, Result, shared_struct};

pub use complex_pixels::ComplexPixels;
pub use kernel::{ROUND_LENGTH, SEVERAL, WORKGROUP};

shared_struct! {
    /// Complex pixels that a dispatch takes.
    "sample_surfaces" => pub struct Step {
        /// Which [`ROUND_LENGTH`] triangles of each list.
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
    nearest: Program,
    begin: Program,
    rivals: Program,
    crowds: Program,
    name: Option<Program>,
    group: Program,
    /// Of triangles by themselves, and of surfaces.
    emit: [Option<Program>; 2],
    emit_single: Program,
    fold: DispatchArgs,
    scan: PrefixScan,
    words: u32,
    uniforms: Uniforms,
}

/// Inputs of the stage besides the lists.
#[derive(Clone, Copy, Debug)]
pub struct Mesh<'a> {
    /// Sample offsets.
    pub samples: &'a wgpu::Buffer,
    /// Vertex indices, 16 bytes a triangle: three, and a word that this stage does not read.
    pub triangles: &'a wgpu::Buffer,
    /// Projected vertices.
    pub points: &'a Buffer<[f32; 4]>,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a wgpu::Buffer,
    /// Of each triangle the lowest of its surface, with [`SEVERAL`] where that has more than one; read if surfaces merge.
    pub surfaces: Option<&'a Buffer<u32>>,
}

/// Buffers of the kernels that look for the nearest surface, of one band.
struct Seen<'a> {
    frame: &'a wgpu::Buffer,
    mesh: Mesh<'a>,
    lists: &'a PixelLists,
    complex: &'a ComplexPixels,
    keys: &'a Buffer<u32>,
}

impl Seen<'_> {
    /// By the kernels' names, with the uniform `step`; each binds those it declares.
    fn buffers<'a>(&'a self, step: &'a wgpu::Buffer) -> [(&'static str, &'a wgpu::Buffer); 13] {
        let Self { frame, mesh, lists, complex, keys } = *self;
        [
            ("frame", frame),
            ("samples", mesh.samples),
            ("step", step),
            ("triangles", mesh.triangles),
            ("points", mesh.points.raw()),
            ("positions", mesh.positions),
            ("pixel_offsets", lists.offsets.raw()),
            ("pixel_list", lists.list.raw()),
            ("complex_pixels", complex.pixels.raw()),
            ("complex_total", complex.total.raw()),
            ("sample_keys", keys.raw()),
            ("rivals_found", complex.rivals.raw()),
            ("crowds", complex.crowds.raw()),
        ]
    }
}

/// Records what samples see that lie in no listed triangle: of so many complex pixels from the first on, into the keys of
/// their samples ([`ComplexPixels::keys`]), with a workgroup for each [`WORKGROUP`] pixels.
pub type Fill<'a> = &'a dyn Fn(&mut Stage, [u32; 2], &Buffer<u32>, Groups) -> Result<()>;

impl SampleSurfaces {
    /// Builds the pipelines for `samples` samples a pixel; `scan` is shared. Every triangle is a surface of its own.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::Never)
    }

    /// As [`SampleSurfaces::new`]; triangles of one surface ([`Mesh::surfaces`]) make one facet.
    pub fn merging(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::Always)
    }

    /// As [`SampleSurfaces::merging`] where surfaces are given, else as [`SampleSurfaces::new`].
    pub fn for_any(device: &wgpu::Device, scan: &PrefixScan, samples: u32) -> Self {
        Self::with(device, scan, samples, Merging::WhereGiven)
    }

    fn with(device: &wgpu::Device, scan: &PrefixScan, samples: u32, merge: Merging) -> Self {
        let words = samples.div_ceil(32);
        let of = |merge: u32| {
            [("WORDS", words), ("MERGE", merge), ("SAMPLES", samples.min(32))]
                .map(|(name, value)| (name, f64::from(value)))
        };
        let constants = of(0);
        let emit = |with: bool, merge| with.then(|| Program::new(device, kernel::ENTRY_EMIT, &of(merge)));
        Self {
            nearest: Program::new(device, kernel::ENTRY_NEAREST, &constants),
            begin: Program::new(device, kernel::ENTRY_BEGIN, &[]),
            rivals: Program::new(device, kernel::ENTRY_SETTLE_RIVALS, &constants),
            crowds: Program::new(device, kernel::ENTRY_SETTLE_CROWDS, &constants),
            name: (merge != Merging::Never).then(|| Program::new(device, kernel::ENTRY_NAME_SURFACES, &constants)),
            group: Program::new(device, kernel::ENTRY_GROUP_SAMPLES, &constants),
            emit: [emit(merge != Merging::Always, 0), emit(merge != Merging::Never, 1)],
            emit_single: Program::new(device, kernel::ENTRY_EMIT_SINGLE, &constants),
            fold: DispatchArgs::new(device),
            scan: scan.clone(),
            words,
            uniforms: Uniforms::default(),
        }
    }

    /// Records all of it, in `rounds` rounds. `args`: indirect arguments of one workgroup for each [`WORKGROUP`] complex
    /// pixels; `fill` may give samples that lie in no listed triangle what they see.
    ///
    /// # Errors
    /// Those of `fill`; [`crate::Error::Config`] if a buffer is too small for the image, or there are no surfaces to merge by.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        mesh: Mesh,
        lists: &PixelLists,
        complex: &ComplexPixels,
        args: (&wgpu::Buffer, u64),
        rounds: u32,
        scratch: &prefix_scan::Scratch,
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
        let turns = || (0..rounds).flat_map(move |round| (0..words).map(move |word| (round, word)));
        for (band, keys) in complex.bands() {
            let seen = Seen { frame, mesh, lists, complex, keys };
            for (round, word) in turns() {
                let step = self.uniforms.get(stage.device, &Step { round, word, ..band })?;
                stage.run(&self.nearest, &seen.buffers(&step), groups())?;
            }
            stage.run(&self.begin, &[("crowds", complex.crowds.raw())], Groups::Workgroups(1))?;
            if let Some(fill) = fill {
                fill(stage, [band.first_slot, band.slots], keys, groups())?;
            }
            let step = self.uniforms.get(stage.device, &band)?;
            stage.run(&self.rivals, &seen.buffers(&step), groups())?;
            self.fold.record(stage, &complex.crowds, &complex.crowd_requests, &complex.crowd_args)?;
            for (round, word) in turns() {
                let step = self.uniforms.get(stage.device, &Step { round, word, ..band })?;
                stage.run(&self.crowds, &seen.buffers(&step), Groups::Indirect(complex.crowd_args.raw(), 0))?;
            }
            self.record_names(stage, frame, &step, mesh, complex, keys, groups())?;
            let group_keys = if name.is_some() { complex.rivals.raw() } else { keys.raw() };
            let buffers = [
                ("frame", frame),
                ("step", &step),
                ("complex_pixels", complex.pixels.raw()),
                ("complex_total", complex.total.raw()),
                ("group_keys", group_keys),
                ("facet_counts", lists.facet_counts.raw()),
            ];
            stage.run(&self.group, &buffers, groups())?;
        }
        let (counts, offsets) = (&lists.facet_counts, &facets.pixel_facets);
        self.scan.record(stage, counts, offsets, (offsets, pixels), scratch, Count::Exactly(pixels))?;
        let buffers = [
            ("frame", frame),
            ("pixel_offsets", lists.offsets.raw()),
            ("pixel_list", lists.list.raw()),
            ("complex_flags", lists.complex_flags.raw()),
            ("pixel_facets", facets.pixel_facets.raw()),
            ("facets", facets.list.raw()),
            ("masks", facets.masks.raw()),
            ("id_keys", id_keys.raw()),
        ];
        stage.run(&self.emit_single, &buffers, Groups::Items(pixels.max(facets.list.len()) as u64))?;
        for (band, keys) in complex.bands() {
            let step = self.uniforms.get(stage.device, &band)?;
            if complex.keys.len() > 1 {
                // Those of other bands were written over.
                self.record_names(stage, frame, &step, mesh, complex, keys, groups())?;
            }
            let group_keys = if name.is_some() { complex.rivals.raw() } else { keys.raw() };
            let buffers = [
                ("frame", frame),
                ("samples", mesh.samples),
                ("step", &step),
                ("complex_pixels", complex.pixels.raw()),
                ("complex_total", complex.total.raw()),
                ("seen_keys", keys.raw()),
                ("group_keys", group_keys),
                ("pixel_facets", facets.pixel_facets.raw()),
                ("facets", facets.list.raw()),
                ("masks", facets.masks.raw()),
                ("id_keys", id_keys.raw()),
            ];
            stage.run(emit, &buffers, groups())?;
        }
        Ok(())
    }
    /// Records what the surfaces of a band's samples are, where they are merged.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    fn record_names(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        step: &wgpu::Buffer,
        mesh: Mesh,
        complex: &ComplexPixels,
        keys: &Buffer<u32>,
        groups: Groups,
    ) -> Result<()> {
        let Some((name, surfaces)) = self.name.as_ref().zip(mesh.surfaces) else { return Ok(()) };
        let buffers = [
            ("frame", frame),
            ("step", step),
            ("triangles", mesh.triangles),
            ("points", mesh.points.raw()),
            ("complex_total", complex.total.raw()),
            ("sample_keys", keys.raw()),
            ("surfaces", surfaces.raw()),
            ("named_keys", complex.rivals.raw()),
        ];
        stage.run(name, &buffers, groups)
    }
}
