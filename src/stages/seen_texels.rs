//! Which texels of the light-view map the pixels ask for: with a map that has many more texels than the image has pixels, few.
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets; then the list of the pixels that
//!   their own texels do not settle.
//! - **Writes** [`TexelMarks`]: a bit a texel, and a bit for those that only the listed pixels ask for.
//! - **Guarantee.** Bit-equal from run to run. A texel is marked if the footprint of a pixel that faces the light touches it, or
//!   that of a listed pixel comes within `radius + stretch` texels of it, a fiftieth of a texel and a thousandth of the
//!   footprint added for rounding; of a footprint without end, or of more than 25 texels, if one of its samples does, and only
//!   for listed pixels.
//! - **Cost.** One dispatch over pixels, one over the listed ones. A quarter of a byte a texel.

use super::PrimaryHits;
use super::spsm_map::SpsmTexels;
use super::spsm_query::{SpsmPixels, SpsmQueryOptions};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::seen_texels as kernel;
use crate::gpu::{Buffer, Gpu, Groups, Recorder, Stage};

/// The pipelines.
#[derive(Debug)]
pub struct SeenTexels {
    mark: kernel::MarkProgram,
    around: kernel::AroundProgram,
    all: kernel::AllTexelsProgram,
}

/// Bits of the texels, what is counted with them, and a list of pixels.
#[derive(Debug)]
pub struct TexelMarks {
    /// A header of [`TexelMarks::HEADER`] words; the bits, two words a block of 8 × 8 texels, the upper four rows first; as
    /// many words for those asked for last; the list of the uncertain pixels as [`SpsmPixels::list`] has it, for which a binding
    /// of its own would be one too many.
    pub words: Buffer<u32>,
    blocks: usize,
}

impl TexelMarks {
    /// Words before the bits.
    pub const HEADER: usize = kernel::SEEN_BITS as usize;
    /// Word that is not 0 if a texel was read that is not made.
    pub const MISSED: usize = kernel::SEEN_MISSED as usize;

    /// Memory for a map of `size` texels a side and an image of `pixels` pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, size: usize, pixels: usize) -> Result<Self> {
        let blocks = size.div_ceil(8).pow(2);
        let words = Self::HEADER + 4 * blocks + pixels + 2;
        Ok(Self { words: Buffer::storage(device, "seen_texels.words", words)?, blocks })
    }

    /// Words of bits.
    pub fn bit_words(&self) -> usize {
        2 * self.blocks
    }

    /// Records that the list of the uncertain pixels is copied behind the bits, for
    /// [`SpsmQuery::record_recover`](super::spsm_query::SpsmQuery::record_recover).
    pub fn take_list(&self, rec: &mut Recorder, pixels: &SpsmPixels) {
        let at = Self::HEADER + 2 * self.bit_words();
        rec.copy_words(pixels.list.raw(), 0, self.words.raw(), at as u64, pixels.list.len() as u64);
    }

    /// Whether a texel is marked, given the words and the map's size; what they do not hold is not.
    pub fn is_marked(words: &[u32], size: usize, [x, y]: [usize; 2]) -> bool {
        let block = y / 8 * size.div_ceil(8) + x / 8;
        let word = words.get(Self::HEADER + 2 * block + y / 4 % 2);
        x < size && y < size && word.is_some_and(|w| w >> (8 * (y % 4) + x % 8) & 1 == 1)
    }

    /// Whether the frame read a texel that is not made: rounding has put a pixel elsewhere than where it was looked for.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`].
    pub fn missed(&self, gpu: &Gpu) -> Result<bool> {
        Ok(self.words.read_first(gpu, Self::HEADER)?.get(Self::MISSED).is_some_and(|w| *w != 0))
    }
}

impl SeenTexels {
    /// Builds the pipelines for what `options` ask of `texels`.
    pub fn new(device: &wgpu::Device, options: SpsmQueryOptions, texels: &SpsmTexels) -> Self {
        let own = kernel::Constants { many: u32::from(options.many), ..Default::default() };
        let around = kernel::Constants {
            reach: (options.radius + options.stretch) as i32,
            encoding: options.encoding,
            split: u32::from(texels.is_split()),
            bias: options.bias,
            ..own
        };
        Self {
            mark: kernel::MarkProgram::new(device, own),
            around: kernel::AroundProgram::new(device, around),
            all: kernel::AllTexelsProgram::new(device, own),
        }
    }

    /// Marks the texels that all pixels fall into. The words must be 0 before.
    pub fn record(&self, stage: &mut Stage, frame: &Buffer<Frame>, seen: PrimaryHits, texels: &SpsmTexels) {
        let bindings = kernel::Mark {
            frame: frame.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            seen: texels.marks.words.as_write(),
        };
        stage.run(&self.mark, bindings, Groups::Items(seen.id_keys.len() as u64));
    }

    /// Marks all texels. The words must be 0 before.
    pub fn record_all(&self, stage: &mut Stage, frame: &Buffer<Frame>, texels: &TexelMarks) {
        let bindings = kernel::AllTexels { frame: frame.as_uniform(), seen: texels.words.as_write() };
        stage.run(&self.all, bindings, Groups::Items(texels.bit_words() as u64));
    }

    /// Marks what the pixels ask for that [`super::spsm_query`] lists as not settled by these. The words of those asked for
    /// last must be 0 before.
    pub fn record_around(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        texels: &SpsmTexels,
        pixels: &SpsmPixels,
    ) {
        let (kept, groups) = pixels.unsettled();
        let bindings = kernel::Around {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            kept: kept.as_read(),
            seen: texels.marks.words.as_write(),
            slopes: texels.slopes.as_uniform(),
            upper_records: texels.records[0].as_read(),
            lower_records: texels.records[1].as_read(),
        };
        stage.run(&self.around, bindings, groups);
    }
}
