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

use crate::frame::Frame;
use crate::gpu::bindings::TextureStoreR32Float;
use crate::gpu::kernels::visibility_texture as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Result, shared_struct};

shared_struct! {
    /// Limits of a frame's lists that the uniform `frame` does not hold.
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
    store: kernel::StoreProgram,
}

/// The pipelines that keep the last complete picture.
#[derive(Debug)]
pub struct LastPicture {
    judge: kernel::JudgeProgram,
    hold: kernel::HoldProgram,
    uniforms: Uniforms,
}

impl LastPicture {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            judge: kernel::JudgeProgram::new(device, ()),
            hold: kernel::HoldProgram::new(device, ()),
            uniforms: Uniforms::default(),
        }
    }

    /// Sets the first word of `verdict`, which must be 0 before the first strip of an image, if anything is missing in the frame
    /// whose counters `status` holds, or any of `faults` was counted.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_judge(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        lists: &Lists,
        status: &Buffer<u32>,
        faults: &Buffer<u32>,
        verdict: &Buffer<u32>,
    ) -> Result<()> {
        let lists = self.uniforms.get(stage.device, lists)?;
        let bindings = kernel::Judge {
            frame: frame.as_uniform(),
            lists: lists.as_uniform(),
            status: status.as_write(),
            faults: faults.as_read(),
            verdict: verdict.as_write(),
        };
        stage.run(&self.judge, bindings, Groups::Workgroups(1));
        Ok(())
    }

    /// Copies `latest` to `held`, word by word, if the first word of `verdict` is 0; in ranges that a binding holds.
    pub fn record_hold<T: bytemuck::Pod>(
        &self,
        stage: &mut Stage,
        verdict: &Buffer<u32>,
        latest: &Buffer<T>,
        held: &Buffer<T>,
    ) {
        let most = stage.device.limits().max_storage_buffer_binding_size / size_of::<T>() as u64;
        // Ranges begin at multiples of 256 bytes.
        let most = (most as usize / 256 * 256).max(256);
        let len = latest.len().min(held.len());
        for first in (0..len).step_by(most) {
            let count = most.min(len - first);
            let bindings = kernel::Hold {
                verdict: verdict.as_write(),
                latest: latest.read_range(first, count).cast(),
                held: held.write_range(first, count).cast(),
            };
            let words = count * size_of::<T>() / 4;
            stage.run(&self.hold, bindings, Groups::Items(words as u64));
        }
    }
}

impl VisibilityTexture {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { store: kernel::StoreProgram::new(device, ()) }
    }

    /// Records the copy into `target`, a two-dimensional view of a `r32float` texture of usage `STORAGE_BINDING`; what of
    /// the image lies beyond it is left out.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        visibility: &Buffer<f32>,
        target: &wgpu::TextureView,
    ) {
        let bindings = kernel::Store {
            frame: frame.as_uniform(),
            visibility: visibility.as_read(),
            target_texture: TextureStoreR32Float(target),
        };
        stage.run(&self.store, bindings, Groups::Items(visibility.len() as u64));
    }
}
