//! The visibility of every pixel, as a texture of the application's.
//!
//! - **Reads** `visibility`, row by row from the top.
//! - **Writes** a `r32float` texture, texel (x, y) for the pixel in column x from the left and row y from the top; or rows in a buffer as a copy
//!   takes them into a texture of another format ([`PackedVisibility`]).
//! - **Strips.** Of a strip of rows ([`Frame::first_row`](crate::frame::Frame)) the texture is still the whole image's; rows that belong
//!   to other strips are not written.
//! - **Last complete picture.** `judge` finds by a frame's counters whether anything is missing in it, `hold` copies a picture, or
//!   any words, if nothing is. Nothing is read back.
//! - **Points of a light.** `add` makes of the visibility of several points of one light, frame by frame, their mean.
//! - **Guarantee.** Bits are copied; of 16 bits it is the nearest number (of a 128th itself), of 8 the nearest 255th.
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

shared_struct! {
    /// Rows in a buffer.
    "visibility_texture" => pub struct PackedRows {
        /// Words of a row.
        pub words: u32,
        /// Byte of each word that is written, where one is.
        pub channel: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
    }
}

shared_struct! {
    /// A point of a light, whose visibility is added to that of the points before it.
    "visibility_texture" => pub struct PointShare {
        /// Where the first pixel lies in the sums.
        pub offset: u32,
        /// Number of the point, from 0 on.
        pub point: u32,
        /// Points of the light.
        pub points: u32,
        /// Unused.
        pub pad_0: u32,
    }
}

/// The pipeline that makes the mean of several points of a light.
#[derive(Debug)]
pub struct MeanVisibility {
    add: kernel::AddProgram,
    uniforms: Uniforms,
}

impl MeanVisibility {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        let add = kernel::AddProgram::new(device, kernel::Constants::default());
        Self { add, uniforms: Uniforms::default() }
    }

    /// Adds the visibility of a point, of `pixels` pixels, to `sums`; after the last `visibility` is the mean of all.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `sums` is too short; [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        visibility: &Buffer<f32>,
        pixels: usize,
        sums: &Buffer<f32>,
        part: PointShare,
    ) -> Result<()> {
        super::holds("visibility_texture", "sums", sums.len(), part.offset as usize + pixels)?;
        let part = self.uniforms.get(stage.device, &part)?;
        let bindings = kernel::Add {
            frame: frame.as_uniform(),
            part: part.as_uniform(),
            share: visibility.as_write(),
            sums: sums.as_write(),
        };
        stage.run(&self.add, bindings, Groups::Items(pixels as u64));
        Ok(())
    }
}

/// How texels hold visibility.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// A byte a texel, the nearest 255th.
    R8Unorm,
    /// 16 bits a texel.
    R16Float,
    /// 32 bits a texel.
    R32Float,
    /// This one of four bytes a texel.
    Rgba8Channel(u32),
}

impl Packing {
    /// Bytes of a texel.
    pub fn texel_bytes(self) -> u32 {
        match self {
            Self::R8Unorm => 1,
            Self::R16Float => 2,
            Self::R32Float | Self::Rgba8Channel(_) => 4,
        }
    }

    /// Bytes of a row of `width` texels, as copies to textures need them: a multiple of 256.
    pub fn row_bytes(self, width: u32) -> u32 {
        (width * self.texel_bytes()).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
    }
}

/// The pipelines that write rows for a copy to a texture.
#[derive(Debug)]
pub struct PackedVisibility {
    pack: [kernel::PackProgram; 3],
    channel: kernel::PackChannelProgram,
    uniforms: Uniforms,
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
            judge: kernel::JudgeProgram::new(device, kernel::Constants::default()),
            hold: kernel::HoldProgram::new(device, kernel::Constants::default()),
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

impl PackedVisibility {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let pack = |bits: u32| kernel::PackProgram::new(device, kernel::Constants { bits });
        Self {
            pack: [8, 16, 32].map(pack),
            channel: kernel::PackChannelProgram::new(device, kernel::Constants::default()),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the rows of the frame's image into `packed`, [`Packing::row_bytes`] bytes each; what lies behind a row's end is not written.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `packed` is too short; [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        size: [u32; 2],
        visibility: &Buffer<f32>,
        packing: Packing,
        packed: &Buffer<u32>,
    ) -> Result<()> {
        let words = packing.row_bytes(size[0]) / 4;
        let all = words as usize * size[1] as usize;
        super::holds("visibility_texture", "packed", packed.len(), all)?;
        let channel = if let Packing::Rgba8Channel(channel) = packing { channel } else { 0 };
        let rows = self.uniforms.get(stage.device, &PackedRows { words, channel, ..PackedRows::default() })?;
        let (frame, rows) = (frame.as_uniform(), rows.as_uniform());
        let (visibility, packed) = (visibility.as_read(), packed.as_write());
        let program = match packing {
            Packing::R8Unorm => &self.pack[0],
            Packing::R16Float => &self.pack[1],
            Packing::R32Float => &self.pack[2],
            Packing::Rgba8Channel(_) => {
                let bindings = kernel::PackChannel { frame, visibility, rows, packed };
                stage.run(&self.channel, bindings, Groups::Items(u64::from(size[0]) * u64::from(size[1])));
                return Ok(());
            }
        };
        stage.run(program, kernel::Pack { frame, visibility, rows, packed }, Groups::Items(all as u64));
        Ok(())
    }
}

impl VisibilityTexture {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { store: kernel::StoreProgram::new(device, kernel::Constants::default()) }
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
