//! The visibility of every pixel, as a texture of the application's.
//!
//! - **Reads** `visibility`, row by row from the top.
//! - **Writes** a `r32float` texture, texel (x, y) for the pixel in column x from the left and row y from the top.
//! - **Strips.** Of a strip of rows ([`Frame::first_row`](crate::frame::Frame)) the texture is still the whole image's; rows that belong
//!   to other strips are not written.
//! - **Guarantee.** Bits are copied.
//! - **Cost.** One dispatch over pixels.

use crate::Result;
use crate::gpu::kernels::visibility_texture as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct VisibilityTexture {
    store: Program,
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
