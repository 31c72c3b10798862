//! Visibility functions of the texels of a deep shadow map (Lokovic and Veach 2000), compressed.
//!
//! - **Reads** the nearest depths of [`light_layers`](super::light_layers), whose texels are the sub-texels here: `sub_texels` squared of them make a
//!   texel, those beyond the map's border count as empty.
//! - **Writes** `deep`, a word and [`DeepMapOptions::nodes`] nodes a texel, row by row: in the word how many nodes there are (16 bits), and above that the greatest
//!   difference from the steps of the sub-texels at any depth (of [`ERROR_UNIT`], rounded up); in a node its place of depth (24 bits, 2^22 to depth 1)
//!   above its light (8 bits, of [`WHOLE`]). Before the first node is all light, between two a line, behind the last what that has; no node
//!   at all where there is no caster. Adds up in `worst`, 0 before: the greatest of these differences, and the texels that took more than the error asked.
//! - **Guarantee.** Bit-equal from run to run. The difference is that of the nodes as they are written, measured at both ends of every step, so it
//!   holds at every place of depth. All light before the first step and what is left behind the last are exact, and no line rises. Depths are rounded away
//!   from the light, by less than 2^-22; from depth 4 on there is no caster.
//! - **Cost.** One dispatch, an invocation a sub-texel: as many comparisons as a texel has of them, and twice as many steps of the search. 4 bytes read a
//!   sub-texel, 4 and 4 a node written a texel.
//! - **Source.** Lokovic and Veach 2000, sections 3.1 and 3.3 (the greedy search by a window of slopes); Scherzer 2011, section 6.

use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::deep_map as kernel;
use crate::gpu::{Buffer, Groups, Stage};

pub use kernel::{ERROR_UNIT, MOST_NODES, NO_PLACE, WHOLE};

/// Settings that the pipeline is compiled for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeepMapOptions {
    /// Sub-texels a side of a texel: 2, 4 or 8.
    pub sub_texels: u32,
    /// Nodes of a texel at most: 2 to [`MOST_NODES`].
    pub nodes: u32,
    /// Share of light by which lines may be off, 0 to 0.5; more where so many nodes do not suffice. Nodes are rounded by half of a 128th besides.
    pub error: f32,
}

impl DeepMapOptions {
    /// Deep texels a side of a map of `size` sub-texels a side.
    pub fn side(&self, size: u32) -> u32 {
        size.div_ceil(self.sub_texels.max(1))
    }

    /// Words of a deep map whose sub-texels are a map of `size` a side.
    pub fn words(&self, size: u32) -> usize {
        (self.side(size) as usize).pow(2) * (self.nodes as usize + 1)
    }
}

/// The pipeline.
#[derive(Debug)]
pub struct DeepMap {
    compress: kernel::CompressProgram,
    options: DeepMapOptions,
}

impl DeepMap {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device, options: DeepMapOptions) -> Self {
        let DeepMapOptions { sub_texels: sub, nodes, error } = options;
        let constants = kernel::Constants { sub, nodes, error: error * WHOLE as f32 };
        Self { compress: kernel::CompressProgram::new(device, constants), options }
    }

    /// Memory for a map of `size` sub-texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn memory(&self, device: &wgpu::Device, size: u32) -> Result<Buffer<u32>> {
        Buffer::storage(device, "deep_map.deep", self.options.words(size))
    }

    /// Memory for what is worst in it.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn worst(device: &wgpu::Device) -> Result<Buffer<u32>> {
        Buffer::storage(device, "deep_map.worst", 2)
    }

    /// Records it, for a map of `size` sub-texels a side, which is that of the frame.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        nearest_keys: &Buffer<u32>,
        (deep, worst): (&Buffer<u32>, &Buffer<u32>),
        size: u32,
    ) {
        let bindings = kernel::Compress {
            frame: frame.as_uniform(),
            nearest_keys: nearest_keys.as_read(),
            deep: deep.as_write(),
            worst: worst.as_write(),
        };
        let texels = u64::from(self.options.side(size)).pow(2);
        let together = u64::from(kernel::WORKGROUP / self.options.sub_texels.max(1).pow(2)).max(1);
        stage.run(&self.compress, bindings, Groups::Workgroups(texels.div_ceil(together)));
    }
}
