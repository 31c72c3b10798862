//! The nearest and the second nearest caster at every texel centre of the light view.
//!
//! - **Reads** triangles, light-view vertices, their texel rectangles and the scan of the rectangles' 8 × 8 blocks.
//! - **Writes** `nearest_keys`, `second_keys` (complement of the bits of depth, 0 where there is none), and marks in `mask` every texel
//!   of which an edge passes the centre too near for its layers to be certain. All must be 0 before.
//!   Alpha-tested triangles are in no layer: `front_layer` marks what they touch.
//!   Of triangles that reach behind the light's nearest distance it has what they surely cover, and no marks: `front_layer` marks the rest.
//!   With [`Frame::CULL_BACK`](crate::frame::Frame::CULL_BACK) what surely turns away of closed bodies is left out.
//! - **Guarantee.** Bit-equal from run to run: the two are the largest keys that come, in whatever order. A texel left unmarked has
//!   one caster at its nearest depth or the same key twice, and every edge passes its centre at a distance far above rounding.
//! - **Cost.** One indirect dispatch, two where casters may reach behind the light; one invocation looks at up to 64 texels.

use super::camera_visibility::Blocks;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::light_layers as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// The pipeline.
#[derive(Debug)]
pub struct LightLayers {
    raster: Raster,
}

#[derive(Debug)]
enum Raster {
    Both(kernel::RasterProgram, kernel::RasterCutProgram),
    Nearest(kernel::RasterNearestProgram),
}

/// State of every texel.
#[derive(Debug)]
pub struct Layers {
    /// Key of the nearest depth.
    pub nearest_keys: Buffer<u32>,
    /// Key of the second depth; with [`LightLayers::with_triangles`] complement of the triangle of the nearest.
    pub second_keys: Buffer<u32>,
    /// Marked texels, one bit each, rows padded to 32.
    pub mask: Buffer<u32>,
    /// Split depths, which `front_layer` writes.
    pub splits: Buffer<f32>,
}

impl Layers {
    /// Memory for a map of `size` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, size: usize) -> Result<Self> {
        Ok(Self {
            nearest_keys: Buffer::storage(device, "light_layers.nearest_keys", size * size)?,
            second_keys: Buffer::storage(device, "light_layers.second_keys", size * size)?,
            mask: Buffer::storage(device, "light_layers.mask", size * size.div_ceil(32))?,
            splits: Buffer::storage(device, "light_layers.splits", size * size)?,
        })
    }
}

impl Layers {
    /// Memory for the nearest depth alone.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn nearest_only(device: &wgpu::Device, size: usize) -> Result<Self> {
        Ok(Self {
            nearest_keys: Buffer::storage(device, "light_layers.nearest_keys", size * size)?,
            ..Self::new(device, 1)?
        })
    }

    /// Memory for the two nearest depths, without marks.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn without_marks(device: &wgpu::Device, size: usize) -> Result<Self> {
        Ok(Self {
            second_keys: Buffer::storage(device, "light_layers.second_keys", size * size)?,
            ..Self::nearest_only(device, size)?
        })
    }
}

impl LightLayers {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        let constants = kernel::Constants { layers: 2, marks: 1, alpha: 0 };
        let (raster, cut) =
            (kernel::RasterProgram::new(device, constants), kernel::RasterCutProgram::new(device, constants));
        Self { raster: Raster::Both(raster, cut) }
    }

    /// As [`LightLayers::new`], for `nearest_keys` alone: a shadow map. Of triangles that reach behind the light's nearest distance it holds
    /// the part before it, too; if `alpha` says that some may be alpha-tested, of these what is solid at a texel's centre.
    pub fn nearest_only(device: &wgpu::Device, alpha: bool) -> Self {
        Self::of_map(device, 1, alpha)
    }

    /// As [`LightLayers::nearest_only`], for `second_keys` too: the nearest depth behind that of `nearest_keys`, which is not the same
    /// however many casters are there. Memory: [`Layers::without_marks`].
    pub fn without_marks(device: &wgpu::Device, alpha: bool) -> Self {
        Self::of_map(device, 2, alpha)
    }

    /// As [`LightLayers::nearest_only`], for the triangle of that depth too, of several the lowest, whose complement takes the place of the second
    /// depth. It is recorded twice, with [`Layers::second_keys`] 0 before each: the second run knows all depths. Memory: [`Layers::without_marks`].
    pub fn with_triangles(device: &wgpu::Device, alpha: bool) -> Self {
        Self::of_map(device, kernel::NEAREST_TRIANGLE, alpha)
    }

    fn of_map(device: &wgpu::Device, layers: u32, alpha: bool) -> Self {
        let constants = kernel::Constants { layers, marks: 0, alpha: u32::from(alpha) };
        Self { raster: Raster::Nearest(kernel::RasterNearestProgram::new(device, constants)) }
    }

    /// Records it.
    pub fn record(&self, stage: &mut Stage, frame: &Buffer<Frame>, blocks: Blocks, layers: &Layers) {
        let bindings = kernel::Blocks {
            frame: frame.as_uniform(),
            triangles: blocks.triangles.as_read(),
            map_points: blocks.points.as_read(),
            light_rects: blocks.rects.as_read(),
            facing: blocks.facing.as_read(),
            work_offsets: blocks.offsets.as_read(),
            nearest_keys: layers.nearest_keys.as_write(),
            second_keys: layers.second_keys.as_write(),
            mask: layers.mask.as_write(),
        };
        let groups = Groups::Indirect(blocks.args.0, blocks.args.1);
        match &self.raster {
            Raster::Both(raster, _) => stage.run(raster, bindings, groups),
            Raster::Nearest(raster) => stage.run(raster, bindings, groups),
        }
    }

    /// Records what casters cover that reach behind the light's nearest distance, after [`LightLayers::record`]; of maps without marks that has it.
    pub fn record_cut(&self, stage: &mut Stage, frame: &Buffer<Frame>, blocks: Blocks, layers: &Layers) {
        let Raster::Both(_, cut) = &self.raster else { return };
        let bindings = kernel::RasterCut {
            frame: frame.as_uniform(),
            triangles: blocks.triangles.as_read(),
            map_points: blocks.points.as_read(),
            light_rects: blocks.rects.as_read(),
            facing: blocks.facing.as_read(),
            work_offsets: blocks.offsets.as_read(),
            nearest_keys: layers.nearest_keys.as_write(),
            second_keys: layers.second_keys.as_write(),
        };
        stage.run(cut, bindings, Groups::Indirect(blocks.args.0, blocks.args.1));
    }
}
