//! Triangle-texel pairs: place by place, the casters that touch it, where pixel-texel pairs are (Pan 2009, section 3.3). A place
//! is a texel, or a tile of 2 × 2 texels ([`PairTiles`]).
//!
//! - **Reads** the casters' blocks, `place_deepest` of the pixel-texel pairs.
//! - **Writes** on counting `place_counts`, on emitting `triangle_pairs` grouped by place; or all at once the pairs as they
//!   come, for [`SortedPairs`](super::SortedPairs).
//! - **Guarantee.** Conservative: every caster that may shadow a facet listed at a place is listed there, with every cell of a
//!   tile that it touches. Nothing is written beyond the capacity. The order inside a place is not defined; what is made of it
//!   does not depend on it.
//! - **Cost.** One indirect dispatch to count, two to emit; one invocation looks at up to 64 places, once, as long as
//!   [`PairLists::touched`] has room for what it found.

use super::camera_visibility::{Blocks, Pass};
use super::pixel_texel_pairs::{PairLists, PairTiles};
use super::sorted_pairs;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::triangle_texel_pairs as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};

/// The pipeline.
#[derive(Debug)]
pub struct TriangleTexelPairs {
    count: kernel::CountProgram,
    emit: kernel::EmitProgram,
    emit_rest: kernel::EmitRestProgram,
    append: kernel::AppendProgram,
    uniforms: Uniforms,
    places: PairTiles,
}

impl TriangleTexelPairs {
    /// Builds the pipeline for pairs that meet at `places`.
    pub fn new(device: &wgpu::Device, places: PairTiles) -> Self {
        let constants = kernel::Constants { tile_shift: places.shift() };
        Self {
            count: kernel::CountProgram::new(device, constants),
            emit: kernel::EmitProgram::new(device, constants),
            emit_rest: kernel::EmitRestProgram::new(device, constants),
            append: kernel::AppendProgram::new(device, kernel::Constants::default()),
            uniforms: Uniforms::default(),
            places,
        }
    }

    /// Where pairs meet.
    pub fn places(&self) -> PairTiles {
        self.places
    }

    /// Records run `index`: 0 counts, 1 emits. `rest`: arguments for those blocks that find no room in [`PairLists::touched`].
    ///
    /// # Errors
    /// [`Error::Config`](crate::Error::Config) if the lists are of other places.
    pub fn record(
        &self,
        stage: &mut Stage,
        index: u32,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        rest: (&wgpu::Buffer, u64),
        lists: &PairLists,
    ) -> Result<()> {
        lists.check(self.places)?;
        let kept = self.uniforms.get(stage.device, &Pass { index: lists.touched.len() as u32 })?;
        let bindings = kernel::Pairs {
            frame: frame.as_uniform(),
            step: kept.as_uniform(),
            triangles: blocks.triangles.as_read(),
            map_points: blocks.points.as_read(),
            light_rects: blocks.rects.as_read(),
            work_offsets: blocks.offsets.as_read(),
            place_deepest: lists.place_deepest.as_read(),
            place_counts: lists.place_counts.as_write(),
            pair_offsets: lists.triangle_offsets.as_read(),
            pair_triangles: lists.triangle_pairs.as_write(),
            touched: lists.touched.as_write(),
        };
        let all = Groups::Indirect(blocks.args.0, blocks.args.1);
        if index == 0 {
            stage.run(&self.count, bindings, all);
            return Ok(());
        }
        stage.run(&self.emit, bindings, all);
        stage.run(&self.emit_rest, bindings, Groups::Indirect(rest.0, rest.1));
        Ok(())
    }

    /// Records the listing of pairs as they come, texel by texel, to be sorted; the capacity of `frame` may not be above that
    /// of `to`.
    ///
    /// # Errors
    /// [`Error::Config`](crate::Error::Config) if the lists are of tiles.
    pub fn record_append(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        blocks: Blocks,
        lists: &PairLists,
        to: &sorted_pairs::SortedPairsScratch,
    ) -> Result<()> {
        lists.check(PairTiles::Texels)?;
        let bindings = kernel::Append {
            frame: frame.as_uniform(),
            triangles: blocks.triangles.as_read(),
            map_points: blocks.points.as_read(),
            light_rects: blocks.rects.as_read(),
            work_offsets: blocks.offsets.as_read(),
            place_deepest: lists.place_deepest.as_read(),
            appended: to.appended.as_write(),
            keys: to.keys.as_write(),
            values: to.values.as_write(),
        };
        stage.run(&self.append, bindings, Groups::Indirect(blocks.args.0, blocks.args.1));
        Ok(())
    }
}
