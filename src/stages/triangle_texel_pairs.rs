//! Triangle-texel pairs: place by place, the casters that touch it, where pixel-texel pairs are (Pan 2009, section 3.3). A place
//! is a texel, or a tile of 2 × 2 texels ([`Places`]).
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
use super::pixel_texel_pairs::{PairLists, Places};
use super::sorted_pairs;
use crate::Result;
use crate::gpu::kernels::triangle_texel_pairs as kernel;
use crate::gpu::{Groups, Program, Stage, Uniforms};

/// The pipeline.
#[derive(Debug)]
pub struct TriangleTexelPairs {
    count: Program,
    emit: Program,
    emit_rest: Program,
    append: Program,
    uniforms: Uniforms,
    places: Places,
}

impl TriangleTexelPairs {
    /// Builds the pipeline for pairs that meet at `places`.
    pub fn new(device: &wgpu::Device, places: Places) -> Self {
        let program = |entry| Program::new(device, entry, &[places.constant()]);
        Self {
            count: program(kernel::ENTRY_COUNT),
            emit: program(kernel::ENTRY_EMIT),
            emit_rest: program(kernel::ENTRY_EMIT_REST),
            append: Program::new(device, kernel::ENTRY_APPEND, &[]),
            uniforms: Uniforms::default(),
            places,
        }
    }

    /// Where pairs meet.
    pub fn places(&self) -> Places {
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
        frame: &wgpu::Buffer,
        blocks: Blocks,
        rest: (&wgpu::Buffer, u64),
        lists: &PairLists,
    ) -> Result<()> {
        lists.check(self.places)?;
        let kept = self.uniforms.get(stage.device, &Pass { index: lists.touched.len() as u32 })?;
        let buffers = [
            ("frame", frame),
            ("step", &kept),
            ("triangles", blocks.triangles),
            ("map_points", blocks.points.raw()),
            ("light_rects", blocks.rects.raw()),
            ("work_offsets", blocks.offsets.raw()),
            ("place_deepest", lists.place_deepest.raw()),
            ("place_counts", lists.place_counts.raw()),
            ("pair_offsets", lists.triangle_offsets.raw()),
            ("pair_triangles", lists.triangle_pairs.raw()),
            ("touched", lists.touched.raw()),
        ];
        let all = Groups::Indirect(blocks.args.0, blocks.args.1);
        if index == 0 {
            return stage.run(&self.count, &buffers, all);
        }
        stage.run(&self.emit, &buffers, all)?;
        stage.run(&self.emit_rest, &buffers, Groups::Indirect(rest.0, rest.1))
    }

    /// Records the listing of pairs as they come, texel by texel, to be sorted; the capacity of `frame` may not be above that
    /// of `to`.
    ///
    /// # Errors
    /// [`Error::Config`](crate::Error::Config) if the lists are of tiles.
    pub fn record_append(
        &self,
        stage: &mut Stage,
        frame: &wgpu::Buffer,
        blocks: Blocks,
        lists: &PairLists,
        to: &sorted_pairs::Scratch,
    ) -> Result<()> {
        lists.check(Places::Texels)?;
        let buffers = [
            ("frame", frame),
            ("triangles", blocks.triangles),
            ("map_points", blocks.points.raw()),
            ("light_rects", blocks.rects.raw()),
            ("work_offsets", blocks.offsets.raw()),
            ("place_deepest", lists.place_deepest.raw()),
            ("appended", to.appended.raw()),
            ("keys", to.keys.raw()),
            ("values", to.values.raw()),
        ];
        stage.run(&self.append, &buffers, Groups::Indirect(blocks.args.0, blocks.args.1))
    }
}
