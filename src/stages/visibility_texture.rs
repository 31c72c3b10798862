//! The visibility of every pixel, as a texture of the application's.
//!
//! - **Reads** `visibility`, row by row from the top.
//! - **Writes** a `r32float` texture, texel (x, y) for the pixel in column x from the left and row y from the top.
//! - **Strips.** Of a strip of rows ([`Frame::first_row`](crate::frame::Frame)) the texture is still the whole image's; rows that belong
//!   to other strips are not written.
//! - **Last complete picture.** `judge` finds by a frame's counters whether anything is missing in it, `hold` copies a picture, or
//!   any words, if nothing is. Nothing is read back.
//! - **Guarantee.** Bits are copied.
//! - **Cost.** One dispatch over pixels; to judge, one workgroup; to hold, 8 bytes a word.

use crate::gpu::kernels::visibility_texture as kernel;
use crate::gpu::program::range;
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};
use crate::{Result, shared_struct};

shared_struct! {
    /// What of the lengths of a frame's lists the frame itself does not tell.
    "visibility_texture" => pub struct Lists {
        /// Bands of facets of all views.
        pub bands: u32,
        /// Most triangles over a place of the map.
        pub most_at_place: u32,
        /// Most triangles over a pixel.
        pub most_at_pixel: u32,
        /// Unused.
        pub pad_0: u32,
    }
}

/// The pipeline that stores.
#[derive(Debug)]
pub struct VisibilityTexture {
    store: Program,
}

/// The pipelines that keep the last complete picture.
#[derive(Debug)]
pub struct LastPicture {
    judge: Program,
    hold: Program,
    uniforms: Uniforms,
}

impl LastPicture {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            judge: Program::new(device, kernel::ENTRY_JUDGE, &[]),
            hold: Program::new(device, kernel::ENTRY_HOLD, &[]),
            uniforms: Uniforms::default(),
        }
    }

    /// Sets the first word of `verdict`, which must be 0 before the first strip of an image, if anything is missing in the frame
    /// whose counters `status` holds, or any of `faults` was counted.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_judge(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        lists: &Lists,
        status: &Buffer<u32>,
        faults: &Buffer<u32>,
        verdict: &Buffer<u32>,
    ) -> Result<()> {
        let lists = self.uniforms.get(stage.device, lists)?;
        let buffers = [
            ("frame", frame),
            ("lists", &lists),
            ("status", status.raw()),
            ("faults", faults.raw()),
            ("verdict", verdict.raw()),
        ];
        stage.run(&self.judge, &buffers, Groups::Workgroups(1))
    }

    /// Copies `latest` to `held`, word by word, if the first word of `verdict` is 0; in ranges that a binding holds.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_hold<T: bytemuck::Pod>(
        &self,
        stage: &mut Stage,
        verdict: &Buffer<u32>,
        latest: &Buffer<T>,
        held: &Buffer<T>,
    ) -> Result<()> {
        let most = stage.device.limits().max_storage_buffer_binding_size / size_of::<T>() as u64;
        // Ranges begin at multiples of 256 bytes.
        let most = (most as usize / 256 * 256).max(256);
        let len = latest.len().min(held.len());
        for first in (0..len).step_by(most) {
            let count = most.min(len - first);
            let ranges = [
                ("verdict", crate::gpu::program::whole(verdict.raw())),
                ("latest", range(latest, first, count)),
                ("held", range(held, first, count)),
            ];
            let words = count * size_of::<T>() / 4;
            stage.run_ranges(&self.hold, &ranges, Groups::Items(words as u64))?;
        }
        Ok(())
    }
}

impl VisibilityTexture {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { store: Program::new(device, kernel::ENTRY_STORE, &[]) }
    }

    /// Records the copy into `target`, a two-dimensional view of a `r32float` texture of usage `STORAGE_BINDING`; what of
    /// the image lies beyond it is left out.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        visibility: &Buffer<f32>,
        target: &wgpu::TextureView,
    ) -> Result<()> {
        let resources = [
            ("frame", frame.as_entire_binding()),
            ("visibility", visibility.raw().as_entire_binding()),
            ("target_texture", wgpu::BindingResource::TextureView(target)),
        ];
        stage.run_resources(&self.store, &resources, Groups::Items(visibility.len() as u64))
    }
}
