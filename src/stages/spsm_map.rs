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
use crate::frame::Frame;
use crate::gpu::kernels::{spsm_map as kernel, spsm_map_64 as wide};
use crate::gpu::{Buffer, Gpu, Groups, Stage, Uniforms};
use crate::spsm_code::SlopeCode;
use crate::{Error, Result};

pub use kernel::EMPTY_WORD;

/// The depth that a key encodes.
pub fn depth_of_key(key: u32) -> f32 {
    f32::from_bits(if key >> 31 == 1 { key } else { !key & 0x7fff_ffff })
}

/// The pipelines for one encoding.
#[derive(Debug)]
pub struct SpsmMap {
    runs: Runs,
    uniforms: Uniforms,
}

/// The pipelines, by what the device's atomics hold.
#[derive(Debug)]
enum Runs {
    /// Depth and triangle in one.
    Wide { raster: wide::RasterProgram, encode: wide::EncodeProgram },
    /// One of them.
    Narrow(Box<Narrow>),
}

/// Finds the depths, then the triangles at the depths.
#[derive(Debug)]
struct Narrow {
    raster: kernel::RasterProgram,
    encode: kernel::EncodeProgram,
    divide: kernel::DivideProgram,
    choose: kernel::ChooseProgram,
    again: kernel::AgainProgram,
    fold: DispatchArgs,
}

/// The memory of the map.
#[derive(Debug)]
pub struct SpsmTexels {
    /// Complement of each texel's triangle, and its least depth as a key; 0 where there is none.
    pub keys: Buffer<[u32; 2]>,
    /// Records: all in the first, or those of the upper and the lower half of the map, which a binding cannot hold together
    /// at 4096 × 4096.
    pub records: [Buffer<[u32; 4]>; 2],
    /// Texels that are made.
    pub marks: TexelMarks,
    list: Option<WonBlocks>,
    /// Table of the slope code.
    pub slopes: Buffer<[f32; 4]>,
}

/// The blocks that [`Narrow`] goes through.
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
        let request = |count, at| {
            dispatch_args::ArgsRequest::new(count, kernel::WORKGROUP, dispatch_args::ArgsRequest::MAX_LIMIT, at)
        };
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

    /// Triangle and depth of each texel; `None` where there is none.
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
        let split = u32::from(texels.is_split());
        let runs = match texels.list {
            None => {
                let constants = wide::Constants { encoding, split };
                Runs::Wide {
                    raster: wide::RasterProgram::new(device, constants),
                    encode: wide::EncodeProgram::new(device, constants),
                }
            }
            Some(_) => {
                let constants = kernel::Constants { encoding, split };
                Runs::Narrow(Box::new(Narrow {
                    raster: kernel::RasterProgram::new(device, constants),
                    encode: kernel::EncodeProgram::new(device, constants),
                    divide: kernel::DivideProgram::new(device, constants),
                    choose: kernel::ChooseProgram::new(device, constants),
                    again: kernel::AgainProgram::new(device, constants),
                    fold: DispatchArgs::new(device),
                }))
            }
        };
        Self { runs, uniforms: Uniforms::default() }
    }

    /// Records the rasterization and the encoding of the texels that are marked.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(&self, stage: &mut Stage, frame: &Buffer<Frame>, blocks: Blocks, texels: &SpsmTexels) -> Result<()> {
        self.run(stage, frame, blocks, texels, 0)
    }

    /// Likewise of those that were marked last, after [`SpsmMap::record`].
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_last(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        texels: &SpsmTexels,
    ) -> Result<()> {
        self.run(stage, frame, blocks, texels, kernel::PASS_LAST)
    }

    fn run(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        texels: &SpsmTexels,
        which: u32,
    ) -> Result<()> {
        let first = self.uniforms.get(stage.device, &Pass { index: which })?;
        let words = texels.marks.bit_words() as u64;
        let all = Groups::Indirect(blocks.args.0, blocks.args.1);
        let (with, list) = match (&self.runs, &texels.list) {
            (Runs::Narrow(with), Some(list)) => (with, list),
            (Runs::Wide { raster, encode }, None) => {
                let bindings = Self::wide(frame, &first, blocks, texels);
                stage.run(raster, bindings, all);
                stage.run(encode, bindings, Groups::Items(words));
                return Ok(());
            }
            _ => return Err(Error::Config("spsm_map: texels made for atomics of another width".to_owned())),
        };
        let bindings = Self::narrow(frame, &first, blocks, texels, list);
        stage.run(&with.raster, bindings, all);
        stage.run(&with.divide, bindings, Groups::Workgroups(1));
        with.fold.record(stage, &texels.marks.words, &list.requests, &list.args)?;
        stage.run(&with.choose, bindings, Groups::Indirect(list.args.raw(), 0));
        stage.run(&with.encode, bindings, Groups::Items(words));
        stage.run(&with.again, bindings, Groups::Workgroups(1));
        with.fold.record(stage, &texels.marks.words, &list.requests, &list.args)?;
        let again = self.uniforms.get(stage.device, &Pass { index: which | kernel::PASS_AGAIN })?;
        let rest = Self::narrow(frame, &again, blocks, texels, list);
        stage.run(&with.raster, rest, Groups::Indirect(list.args.raw(), 3));
        stage.run(&with.encode, rest, Groups::Indirect(list.args.raw(), 0));
        Ok(())
    }

    fn wide<'a>(
        frame: &'a Buffer<Frame>,
        step: &'a Buffer<Pass>,
        blocks: Blocks<'a>,
        texels: &'a SpsmTexels,
    ) -> wide::Map<'a> {
        wide::Map {
            frame: frame.as_uniform(),
            step: step.as_uniform(),
            slopes: texels.slopes.as_uniform(),
            triangles: blocks.triangles.as_read(),
            map_points: blocks.points.as_read(),
            light_rects: blocks.rects.as_read(),
            work_offsets: blocks.offsets.as_read(),
            keys: texels.keys.as_write().cast(),
            upper_records: texels.records[0].as_write(),
            lower_records: texels.records[1].as_write(),
            seen: texels.marks.words.as_write(),
        }
    }

    fn narrow<'a>(
        frame: &'a Buffer<Frame>,
        step: &'a Buffer<Pass>,
        blocks: Blocks<'a>,
        texels: &'a SpsmTexels,
        list: &'a WonBlocks,
    ) -> kernel::Map<'a> {
        kernel::Map {
            frame: frame.as_uniform(),
            step: step.as_uniform(),
            slopes: texels.slopes.as_uniform(),
            triangles: blocks.triangles.as_read(),
            map_points: blocks.points.as_read(),
            light_rects: blocks.rects.as_read(),
            work_offsets: blocks.offsets.as_read(),
            keys: texels.keys.as_write().cast(),
            upper_records: texels.records[0].as_write(),
            lower_records: texels.records[1].as_write(),
            seen: texels.marks.words.as_write(),
            won: list.won.as_write(),
        }
    }
}
