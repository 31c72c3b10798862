//! The triangle at every pixel centre, from a texture of the application's.
//!
//! - **Reads** a `r32uint` texture of the size of the image and the casters' number of each of the application's triangles.
//! - **Writes** `id_keys` as [`camera_visibility`](super::camera_visibility) does: complement of the triangle, 0 where there
//!   is none. Counts into `faults` the texels that name no triangle ([`FAULT_UNKNOWN`]); they count as none.
//! - **Strips.** Of a strip of rows ([`Frame::first_row`](crate::frame::Frame)) the texture is still the whole image's, and faults
//!   count in rows that are its own.
//! - **Cost.** One dispatch over pixels.

use crate::Result;
use crate::frame::Frame;
use crate::gpu::bindings::TextureUint;
use crate::gpu::kernels::triangle_ids as kernel;
pub use crate::gpu::kernels::triangle_ids::FAULT_UNKNOWN;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::shared_struct;

shared_struct! {
    /// How an application counts triangles.
    "triangle_ids" => pub struct TriangleIdsParams {
        /// The number of its first.
        pub first: u32,
        /// Stands for no triangle.
        pub none: u32,
    }
}

/// The pipeline.
#[derive(Debug)]
pub struct TriangleIds {
    take: kernel::TakeProgram,
    uniforms: Uniforms,
}

impl TriangleIds {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { take: kernel::TakeProgram::new(device, ()), uniforms: Uniforms::default() }
    }

    /// Records the translation of every pixel of `ids`, a two-dimensional view of a `r32uint` texture of usage
    /// `TEXTURE_BINDING` and the size of the image.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `faults` is too short.
    #[expect(clippy::too_many_arguments, reason = "one argument a buffer, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        ids: &wgpu::TextureView,
        counted: TriangleIdsParams,
        numbers: &Buffer<u32>,
        id_keys: &Buffer<u32>,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        super::holds("triangle_ids", "faults", faults.len(), FAULT_UNKNOWN as usize + 1)?;
        let params = self.uniforms.get(stage.device, &counted)?;
        let bindings = kernel::Take {
            frame: frame.as_uniform(),
            params: params.as_uniform(),
            ids: TextureUint(ids),
            numbers: numbers.as_read(),
            id_keys: id_keys.as_write(),
            faults: faults.as_write(),
        };
        stage.run(&self.take, bindings, Groups::Items(id_keys.len() as u64));
        Ok(())
    }
}
