//! The sub-pixel shadow map: the closest triangle that touches each texel, in 128 bits (Lecocq 2013, sections 3.2 to 3.4).
//!
//! - **Reads** triangles, light-view vertices, their texel rectangles and the scan of the rectangles' 8 × 8 blocks.
//! - **Writes** `depth_keys` ([`depth_of_key`] of the least depth of any triangle's plane over the texel, at most twice the
//!   triangle's own range of depths before its nearest corner; 0 where there is none), `id_keys` (complement of the
//!   triangle), which must be 0 before, and the records.
//! - **Guarantee.** Bit-equal from run to run: the least conservative depth, and of equal depths the lowest index. No caster
//!   over a texel lies before the depth of its key. Triangles that are not wholly in front of the light are left out.
//! - **Cost.** Two indirect dispatches over blocks, one over texels; 24 bytes a texel.

use super::camera_visibility::{Blocks, Pass};
use crate::Result;
use crate::gpu::kernels::spsm_map as kernel;
use crate::gpu::{Buffer, Groups, Program, Stage, Uniforms};
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
    uniforms: Uniforms,
}

/// The memory of the map.
#[derive(Debug)]
pub struct SpsmTexels {
    /// Least depth over each texel, as a key.
    pub depth_keys: Buffer<u32>,
    /// Complement of its triangle; 0 where there is none.
    pub id_keys: Buffer<u32>,
    /// Records of the upper and the lower half of the map, which a binding cannot hold together at 4096 × 4096.
    pub records: [Buffer<[u32; 4]>; 2],
    /// Table of the slope code.
    pub slopes: Buffer<[f32; 4]>,
}

impl SpsmTexels {
    /// Memory for a map of `size` texels a side, and the table of the slope code of power `exponent`.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, size: usize, exponent: u32) -> Result<Self> {
        let slopes = Buffer::uniform(device, "spsm_map.slopes", 256)?;
        slopes.write(queue, &SlopeCode::new(exponent).words());
        Ok(Self {
            depth_keys: Buffer::storage(device, "spsm_map.depth_keys", size * size)?,
            id_keys: Buffer::storage(device, "spsm_map.id_keys", size * size)?,
            records: [
                Buffer::storage(device, "spsm_map.upper_records", size.div_ceil(2) * size)?,
                Buffer::storage(device, "spsm_map.lower_records", size / 2 * size)?,
            ],
            slopes,
        })
    }
}

impl SpsmMap {
    /// Builds the pipelines; `encoding` is 0 for the paper's, 1 for edge lines.
    pub fn new(device: &wgpu::Device, encoding: u32) -> Self {
        let constants = [("ENCODING", f64::from(encoding))];
        Self {
            raster: Program::new(device, kernel::ENTRY_RASTER, &[]),
            encode: Program::new(device, kernel::ENTRY_ENCODE, &constants),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the rasterization and the encoding.
    ///
    /// # Errors
    /// None that input can cause.
    pub fn record(&self, stage: &mut Stage, frame: &wgpu::Buffer, blocks: Blocks, texels: &SpsmTexels) -> Result<()> {
        for index in 0..2 {
            let pass = self.uniforms.get(stage.device, &Pass { index });
            let buffers = [
                ("frame", frame),
                ("step", &pass),
                ("triangles", blocks.triangles),
                ("map_points", blocks.points.raw()),
                ("light_rects", blocks.rects.raw()),
                ("work_offsets", blocks.offsets.raw()),
                ("depth_keys", texels.depth_keys.raw()),
                ("id_keys", texels.id_keys.raw()),
            ];
            stage.run(&self.raster, &buffers, Groups::Indirect(blocks.args.0, blocks.args.1))?;
        }
        let buffers = [
            ("frame", frame),
            ("slopes", texels.slopes.raw()),
            ("triangles", blocks.triangles),
            ("map_points", blocks.points.raw()),
            ("id_keys", texels.id_keys.raw()),
            ("upper_records", texels.records[0].raw()),
            ("lower_records", texels.records[1].raw()),
        ];
        stage.run(&self.encode, &buffers, Groups::Items(texels.id_keys.len() as u64))
    }
}
