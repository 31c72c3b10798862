//! The triangles that an application's G-buffer of several samples a pixel shows: lists as [`super::pixel_triangles`] makes.
//!
//! - **Reads** a texture of triangle numbers, a layer or a sample of the texture for each sample of the G-buffer, and the
//!   casters' number of each of the application's triangles.
//! - **Writes** `complex_flags` (1 where samples show several triangles, or one and something else), `list` (the different
//!   triangles of each such pixel), `offsets`, and `facet_counts` (1 where all samples show one triangle, whose complement is then in
//!   `id_keys`). Counts into `faults` the samples that name no triangle ([`FAULT_UNKNOWN`]); they count as none.
//!   [`GbufferTriangles::record_fill`] gives each sample of a complex pixel that lies in none of its triangles to that which the nearest
//!   sample of the G-buffer shows, if any.
//! - **Strips.** Of a strip of rows ([`Frame::first_row`](crate::frame::Frame)) the texture is still the whole image's, and faults
//!   count in rows that are its own.
//! - **Guarantee.** Same inputs, same bits. Nothing is written beyond the capacity.
//! - **Error.** A surface that no sample of the G-buffer shows is missing.
//! - **Cost.** Two dispatches over pixels that read every sample, and a scan; a pixel that shows `n` triangles compares up to
//!   `n` times the number of samples.

use super::pixel_coverage::PairCoverage;
use super::pixel_triangles::PixelLists;
use super::{Count, PrefixScan, prefix_scan};
use crate::frame::Frame;
use crate::gpu::bindings::{TextureUintLayers, TextureUintSamples};
use crate::gpu::kernels::gbuffer_triangles as kernel;
pub use crate::gpu::kernels::gbuffer_triangles::{FAULT_UNKNOWN, MOST, WORKGROUP};
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Error, Result, shared_struct};

shared_struct! {
    /// How an application counts samples and triangles.
    "gbuffer_triangles" => pub struct GbufferTrianglesParams {
        /// Samples of the G-buffer.
        pub count: u32,
        /// The number of its first triangle.
        pub first: u32,
        /// Stands for no triangle.
        pub none: u32,
        /// Unused.
        pub pad_0: u32,
        /// Nearest sample of the G-buffer to each sample of the picture.
        pub nearest: [[u32; 4]; 32],
    }
}

impl GbufferTrianglesParams {
    /// Parameters of a G-buffer with samples at `theirs`, for a picture with samples at `ours` (both offsets in the pixel).
    ///
    /// # Errors
    /// [`Error::Config`] if there are none or more than [`MOST`] of either, or one of `theirs` is not in `[0, 1)`.
    pub fn new(ours: &[[f32; 2]], theirs: &[[f32; 2]], first: u32, none: u32) -> Result<Self> {
        for (whose, count) in [("the picture", ours.len()), ("the G-buffer", theirs.len())] {
            if count == 0 || count > MOST as usize {
                return Err(Error::Config(format!("{count} samples a pixel in {whose}; 1 to {MOST} are possible")));
            }
        }
        if let Some((k, p)) = theirs.iter().enumerate().find(|(_, p)| !p.iter().all(|v| (0.0..1.0).contains(v))) {
            return Err(Error::Config(format!(
                "sample {k} of the G-buffer is at ({}, {}), not in its pixel, [0, 1)",
                p[0], p[1]
            )));
        }
        let mut nearest = [[0; 4]; 32];
        for (k, &at) in ours.iter().enumerate() {
            nearest[k / 4][k % 4] = nearest_of(at, theirs);
        }
        Ok(Self { count: theirs.len() as u32, first, none, nearest, ..Self::default() })
    }
}

/// The nearest of some places, of equally near ones the first.
pub(crate) fn nearest_of(at: [f32; 2], places: &[[f32; 2]]) -> u32 {
    let distance = |p: &[f32; 2]| (0..2).map(|k| (f64::from(p[k]) - f64::from(at[k])).powi(2)).sum::<f64>();
    let all = (0..).zip(places);
    all.min_by(|(_, p), (_, q)| distance(p).total_cmp(&distance(q))).map_or(0, |(k, _)| k)
}

/// Triangle numbers of several samples.
#[derive(Clone, Copy, Debug)]
pub enum Texture<'a> {
    /// A view of dimension `D2Array`, a layer a sample.
    Layers(&'a wgpu::TextureView),
    /// A multisampled view.
    Samples(&'a wgpu::TextureView),
}

/// An application's G-buffer and what its numbers mean.
#[derive(Clone, Copy, Debug)]
pub struct SampleGbuffer<'a> {
    /// Triangle numbers, the size of the image.
    pub texture: Texture<'a>,
    /// How they are counted.
    pub params: GbufferTrianglesParams,
    /// The casters' number of each triangle of the application.
    pub numbers: &'a Buffer<u32>,
}

/// The pipelines.
#[derive(Debug)]
pub struct GbufferTriangles {
    count_layers: kernel::CountLayersProgram,
    emit_layers: kernel::EmitLayersProgram,
    fill_layers: kernel::FillLayersProgram,
    count_samples: kernel::CountSamplesProgram,
    emit_samples: kernel::EmitSamplesProgram,
    fill_samples: kernel::FillSamplesProgram,
    scan: PrefixScan,
    uniforms: Uniforms,
}

impl GbufferTriangles {
    /// Builds the pipelines; `scan` is shared.
    pub fn new(device: &wgpu::Device, scan: &PrefixScan) -> Self {
        Self {
            count_layers: kernel::CountLayersProgram::new(device, ()),
            emit_layers: kernel::EmitLayersProgram::new(device, ()),
            fill_layers: kernel::FillLayersProgram::new(device, ()),
            count_samples: kernel::CountSamplesProgram::new(device, ()),
            emit_samples: kernel::EmitSamplesProgram::new(device, ()),
            fill_samples: kernel::FillSamplesProgram::new(device, ()),
            scan: scan.clone(),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the lists of all pixels.
    ///
    /// # Errors
    /// [`Error::Config`] if a buffer is too small for the image.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        given: &SampleGbuffer,
        lists: &PixelLists,
        id_keys: &Buffer<u32>,
        scratch: &prefix_scan::PrefixScanScratch,
        status: &Buffer<u32>,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        super::holds("gbuffer_triangles", "faults", faults.len(), FAULT_UNKNOWN as usize + 1)?;
        let pixels = lists.counts.len();
        let params = self.uniforms.get(stage.device, &given.params)?;
        let (frame, params, numbers) = (frame.as_uniform(), params.as_uniform(), given.numbers.as_read());
        let (pixel_counts, complex_flags) = (lists.counts.as_write(), lists.complex_flags.as_write());
        let id_keys = id_keys.as_write();
        let (facet_counts, status, faults) = (lists.facet_counts.as_write(), status.as_write(), faults.as_write());
        let groups = || Groups::Items(pixels as u64);
        match given.texture {
            Texture::Layers(view) => {
                let layers = TextureUintLayers(view);
                let bindings = kernel::CountLayers {
                    frame,
                    params,
                    layers,
                    numbers,
                    pixel_counts,
                    complex_flags,
                    facet_counts,
                    status,
                    faults,
                    id_keys,
                };
                stage.run(&self.count_layers, bindings, groups());
            }
            Texture::Samples(view) => {
                let multisampled = TextureUintSamples(view);
                let bindings = kernel::CountSamples {
                    frame,
                    params,
                    multisampled,
                    numbers,
                    pixel_counts,
                    complex_flags,
                    facet_counts,
                    status,
                    faults,
                    id_keys,
                };
                stage.run(&self.count_samples, bindings, groups());
            }
        }
        let total = (&lists.offsets, pixels);
        self.scan.record(stage, &lists.counts, &lists.offsets, total, scratch, Count::Exactly(pixels))?;
        let (pixel_offsets, pixel_list) = (lists.offsets.as_read(), lists.list.as_write());
        match given.texture {
            Texture::Layers(view) => {
                let layers = TextureUintLayers(view);
                let bindings =
                    kernel::EmitLayers { frame, params, layers, numbers, pixel_counts, pixel_offsets, pixel_list };
                stage.run(&self.emit_layers, bindings, groups());
            }
            Texture::Samples(view) => {
                let multisampled = TextureUintSamples(view);
                let bindings = kernel::EmitSamples {
                    frame,
                    params,
                    multisampled,
                    numbers,
                    pixel_counts,
                    pixel_offsets,
                    pixel_list,
                };
                stage.run(&self.emit_samples, bindings, groups());
            }
        }
        Ok(())
    }

    /// Records which listed triangles have the samples of complex pixels that none covers. `pixels`: the complex pixels, as many as
    /// `total` says; `coverage`: what covers the others; `groups`: a workgroup for each [`WORKGROUP`] pixels.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record_fill(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        given: &SampleGbuffer,
        lists: &PixelLists,
        pixels: &Buffer<u32>,
        total: &Buffer<u32>,
        coverage: &PairCoverage,
        groups: Groups,
    ) -> Result<()> {
        let params = self.uniforms.get(stage.device, &given.params)?;
        let (frame, params, numbers) = (frame.as_uniform(), params.as_uniform(), given.numbers.as_read());
        let (complex_pixels, complex_total) = (pixels.as_read(), total.as_read());
        let (pixel_offsets, pixel_counts) = (lists.offsets.as_read(), lists.counts.as_write());
        let (coverings, covering_masks) = (coverage.list.as_write(), coverage.masks.as_write());
        match given.texture {
            Texture::Layers(view) => {
                let layers = TextureUintLayers(view);
                let bindings = kernel::FillLayers {
                    frame,
                    params,
                    layers,
                    numbers,
                    pixel_counts,
                    pixel_offsets,
                    complex_pixels,
                    complex_total,
                    covering_masks,
                    coverings,
                };
                stage.run(&self.fill_layers, bindings, groups);
            }
            Texture::Samples(view) => {
                let multisampled = TextureUintSamples(view);
                let bindings = kernel::FillSamples {
                    frame,
                    params,
                    multisampled,
                    numbers,
                    pixel_counts,
                    pixel_offsets,
                    complex_pixels,
                    complex_total,
                    covering_masks,
                    coverings,
                };
                stage.run(&self.fill_samples, bindings, groups);
            }
        }
        Ok(())
    }
}
