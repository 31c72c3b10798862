//! The sub-pixel shadow map: the closest triangle that touches each texel, in 128 bits (Lecocq 2013, sections 3.2 to 3.4).
//!
//! - **Reads** triangles, light-view vertices, their texel rectangles and the scan of the rectangles' 8 × 8 blocks.
//! - **Writes** `keys`, two words a texel, which must be 0 before: complement of the triangle, and [`depth_of_key`] of the least
//!   depth of any triangle's plane over the texel, at most twice the triangle's own range of depths before its nearest corner;
//!   0 where there is none; and the records; all of the texels that [`seen_texels`](super::seen_texels) marks, and no other.
//! - **Guarantee.** Bit-equal from run to run: the least conservative depth, and of equal depths the lowest index. No caster
//!   over a texel lies before the depth of its key. Triangles that are not wholly in front of the light are left out.
//! - **Cost.** One indirect dispatch over blocks, one over words of marks, 32 texels each; 24 bytes a texel. On devices without
//!   [`Gpu::WIDE_ATOMICS`](crate::gpu::Gpu::WIDE_ATOMICS) one more over those blocks in which a triangle was nearest when it
//!   came; where more blocks win than are listed, or a device rounds differently in the second, two more over all blocks and
//!   words; 16 bytes a listed block.

use super::camera_visibility::{Blocks, Pass};
use super::seen_texels::TexelMarks;
use super::{DispatchArgs, dispatch_args};
use crate::Result;
use crate::gpu::kernels::{spsm_map as kernel, spsm_map_64 as wide};
use crate::gpu::{Buffer, Gpu, Groups, Program, Stage, Uniforms};
use crate::spsm_code::SlopeCode;

pub use kernel::EMPTY_WORD;

/// The depth that a key stands for.
pub fn depth_of_key(key: u32) -> f32 {
    f32::from_bits(if key >> 31 == 1 { key } else { !key & 0x7fff_ffff })
}

/// The pipelines for one encoding.
#[derive(Debug)]
pub struct SpsmMap {
    raster: Program,
    encode: Program,
    second: Option<Second>,
    uniforms: Uniforms,
}

/// Finds the triangles at the depths, on devices whose atomics have 32 bits.
#[derive(Debug)]
struct Second {
    divide: Program,
    choose: Program,
    again: Program,
    fold: DispatchArgs,
}

/// The memory of the map.
#[derive(Debug)]
pub struct SpsmTexels {
    /// Of each texel the complement of its triangle and the least depth as a key; 0 where there is none.
    pub keys: Buffer<[u32; 2]>,
    /// Records: all in the first, or those of the upper and the lower half of the map, which a binding cannot hold together
    /// at 4096 × 4096.
    pub records: [Buffer<[u32; 4]>; 2],
    /// Which texels are made.
    pub marks: TexelMarks,
    list: Option<WonBlocks>,
    /// Table of the slope code.
    pub slopes: Buffer<[f32; 4]>,
}

/// The blocks that [`Second`] goes through.
#[derive(Debug)]
struct WonBlocks {
    won: Buffer<[u32; 4]>,
    requests: dispatch_args::Requests,
    args: Buffer<u32>,
}

impl SpsmTexels {
    /// Memory for a map of `size` texels a side and an image of `pixels` pixels, and the table of the slope code of power
    /// `exponent`.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, size: usize, pixels: usize, exponent: u32) -> Result<Self> {
        if !device.features().contains(Gpu::WIDE_ATOMICS) {
            return Self::listing(device, queue, size, pixels, exponent, (size * size).min(Self::MOST_LISTED));
        }
        Self::with_list(device, queue, size, pixels, exponent, None)
    }

    /// Likewise for atomics of 32 bits, whatever the device has, with space for a list of `blocks` blocks; how many it holds
    /// changes what the map costs, not what is in it.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn listing(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        size: usize,
        pixels: usize,
        exponent: u32,
        blocks: usize,
    ) -> Result<Self> {
        let request =
            |count, at| dispatch_args::Request::new(count, kernel::WORKGROUP, dispatch_args::Request::MAX_LIMIT, at);
        let list = WonBlocks {
            won: Buffer::storage(device, "spsm_map.won", blocks)?,
            requests: DispatchArgs::requests(device, queue, &[request(Self::CHOSEN, 0)?, request(Self::AGAIN, 3)?])?,
            args: Buffer::indirect(device, "spsm_map.args", 6)?,
        };
        Self::with_list(device, queue, size, pixels, exponent, Some(list))
    }

    fn with_list(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        size: usize,
        pixels: usize,
        exponent: u32,
        list: Option<WonBlocks>,
    ) -> Result<Self> {
        let slopes = Buffer::uniform(device, "spsm_map.slopes", 256)?;
        slopes.write(queue, &SlopeCode::new(exponent).words());
        let binding = device.limits().max_storage_buffer_binding_size;
        let rows = if (size * size * 16) as u64 <= binding { size } else { size.div_ceil(2) };
        Ok(Self {
            keys: Buffer::storage(device, "spsm_map.keys", size * size)?,
            records: [
                Buffer::storage(device, "spsm_map.upper_records", rows * size)?,
                Buffer::storage(device, "spsm_map.lower_records", (size - rows) * size)?,
            ],
            marks: TexelMarks::new(device, size, pixels)?,
            list,
            slopes,
        })
    }

    const CHOSEN: usize = kernel::SEEN_CHOSEN as usize;
    const AGAIN: usize = kernel::SEEN_AGAIN as usize;

    /// Most blocks that are listed: 32 MiB.
    const MOST_LISTED: usize = 1 << 21;

    /// Whether the records are in two halves.
    pub fn is_split(&self) -> bool {
        self.records[0].len() < self.keys.len()
    }

    /// Buffers that the queries bind of it.
    pub(super) fn read_buffers(&self) -> [(&'static str, &wgpu::Buffer); 4] {
        [
            ("slopes", self.slopes.raw()),
            ("upper_records", self.records[0].raw()),
            ("lower_records", self.records[1].raw()),
            ("seen", self.marks.words.raw()),
        ]
    }

    /// Of each texel triangle and depth; `None` where there is none.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device fails.
    pub fn closest(&self, gpu: &Gpu) -> Result<Vec<Option<(u32, f32)>>> {
        let keys = self.keys.read(gpu)?;
        Ok(keys.into_iter().map(|[id, depth]| (id != 0).then(|| (!id, depth_of_key(depth)))).collect())
    }
}

impl SpsmMap {
    /// Builds the pipelines to fill `texels`; `encoding` is 0 for the paper's, 1 for edge lines.
    pub fn new(device: &wgpu::Device, encoding: u32, texels: &SpsmTexels) -> Self {
        let constants = [("ENCODING", f64::from(encoding)), ("SPLIT", f64::from(u32::from(texels.is_split())))];
        let (raster, encode) = match texels.list {
            None => (wide::ENTRY_RASTER, wide::ENTRY_ENCODE),
            Some(_) => (kernel::ENTRY_RASTER, kernel::ENTRY_ENCODE),
        };
        Self {
            raster: Program::new(device, raster, &[]),
            encode: Program::new(device, encode, &constants),
            second: texels.list.as_ref().map(|_| Second {
                divide: Program::new(device, kernel::ENTRY_DIVIDE, &[]),
                choose: Program::new(device, kernel::ENTRY_CHOOSE, &[]),
                again: Program::new(device, kernel::ENTRY_AGAIN, &[]),
                fold: DispatchArgs::new(device),
            }),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the rasterization and the encoding of the texels that are marked.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(&self, stage: &mut Stage, frame: &wgpu::Buffer, blocks: Blocks, texels: &SpsmTexels) -> Result<()> {
        self.run(stage, frame, blocks, texels, 0)
    }

    /// Likewise of those that were marked last, after [`SpsmMap::record`].
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record_last(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        texels: &SpsmTexels,
    ) -> Result<()> {
        self.run(stage, frame, blocks, texels, kernel::PASS_LAST)
    }

    fn run(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        texels: &SpsmTexels,
        which: u32,
    ) -> Result<()> {
        let first = self.uniforms.get(stage.device, &Pass { index: which })?;
        let buffers = Self::buffers(frame, &first, blocks, texels);
        let words = texels.marks.bit_words() as u64;
        stage.run(&self.raster, &buffers, Groups::Indirect(blocks.args.0, blocks.args.1))?;
        let (Some(second), Some(list)) = (&self.second, &texels.list) else {
            return stage.run(&self.encode, &buffers, Groups::Items(words));
        };
        stage.run(&second.divide, &buffers, Groups::Workgroups(1))?;
        second.fold.record(stage, &texels.marks.words, &list.requests, &list.args)?;
        stage.run(&second.choose, &buffers, Groups::Indirect(list.args.raw(), 0))?;
        stage.run(&self.encode, &buffers, Groups::Items(words))?;
        stage.run(&second.again, &buffers, Groups::Workgroups(1))?;
        second.fold.record(stage, &texels.marks.words, &list.requests, &list.args)?;
        let again = self.uniforms.get(stage.device, &Pass { index: which | kernel::PASS_AGAIN })?;
        let rest = Self::buffers(frame, &again, blocks, texels);
        stage.run(&self.raster, &rest, Groups::Indirect(list.args.raw(), 3))?;
        stage.run(&self.encode, &rest, Groups::Indirect(list.args.raw(), 0))
    }

    fn buffers<'a>(
        frame: &'a wgpu::Buffer,
        step: &'a wgpu::Buffer,
        blocks: Blocks<'a>,
        texels: &'a SpsmTexels,
    ) -> Vec<(&'static str, &'a wgpu::Buffer)> {
        let mut buffers = vec![
            ("frame", frame),
            ("step", step),
            ("triangles", blocks.triangles),
            ("map_points", blocks.points.raw()),
            ("light_rects", blocks.rects.raw()),
            ("work_offsets", blocks.offsets.raw()),
            ("keys", texels.keys.raw()),
        ];
        buffers.extend(texels.read_buffers());
        buffers.extend(texels.list.as_ref().map(|list| ("won", list.won.raw())));
        buffers
    }
}
