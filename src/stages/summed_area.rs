//! Summed-area table of a map of counts or of bits.
//!
//! - **Purpose.** Answers "how many marked texels lie in this rectangle" with four reads
//!   (`rect_sum` of `kernels/shared/raster/summed_area.wgsl`, `rect_sum` of the oracle).
//! - **Reads** the map, row-major: [`Texels::Words`] (one `u32` a texel) or [`Texels::Bits`] (bit `x % 32` of word
//!   `x / 32` of its row, each row padded to whole words; what the padding holds does not matter).
//! - **Writes** the inclusive table, `width * height` words, row-major: element `(x, y)` is the sum over all texels
//!   `(i, j)` with `i ≤ x` and `j ≤ y`.
//! - **Guarantee.** Exact modulo 2^32, the same bits on every run. Sums of rectangles are exact as long as the true sum is
//!   below 2^32, whatever wrapped before.
//! - **Capacity.** [`SummedArea::MAX_SIDE`] a side. A table above the binding limit ([`Buffer::banded`]) is written in
//!   bands of rows.
//! - **Cost.** Two dispatches, or three where columns are split into strips; bits: 4 bytes of traffic a texel, words: 14.
//! - **Source.** Crow, *Summed-area tables for texture mapping*, SIGGRAPH 1984; strips after Nehab et al., *GPU-efficient
//!   recursive filtering and summed-area tables*, 2011.

use super::holds;
use crate::gpu::kernels::summed_area as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::{Error, Result, shared_struct};

shared_struct! {
    /// Parameters of the kernel.
    "summed_area" => pub struct SummedAreaParams {
        /// Texels a row.
        pub width: u32,
        /// Rows.
        pub height: u32,
        /// Partial sums a row.
        pub row_words: u32,
        /// Rows of a strip.
        pub strip_rows: u32,
        /// First row of the bound band.
        pub first_row: u32,
        /// Rows of the bound band.
        pub rows: u32,
        /// Rectangles to query.
        pub rects: u32,
        /// Unused.
        pub pad: u32,
    }
}

/// How a map lies in its buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Texels {
    /// One `u32` a texel, rows without padding.
    Words,
    /// One bit a texel, rows padded to whole words.
    Bits,
}

impl Texels {
    /// Words of a row of `width` texels.
    pub fn row_words(self, width: usize) -> usize {
        match self {
            Self::Words => width,
            Self::Bits => width.div_ceil(32),
        }
    }
}

/// The pipelines of the table.
#[derive(Debug)]
pub struct SummedArea {
    texels: Texels,
    rows: kernel::RowsProgram,
    strips: kernel::StripsProgram,
    columns: kernel::ColumnsProgram,
    columns_ragged: kernel::ColumnsRaggedProgram,
    query: kernel::QueryProgram,
    uniforms: Uniforms,
}

/// Partial sums for maps of one size.
#[derive(Debug)]
pub struct SummedAreaScratch {
    texels: Texels,
    width: usize,
    height: usize,
    strip_rows: usize,
    band_rows: usize,
    /// Partial sums a row.
    row_words: usize,
    row_sums: Buffer<u32>,
    strip_sums: Buffer<[u32; 4]>,
}

/// Pass of the summation.
#[derive(Clone, Copy)]
enum Run {
    Rows,
    Strips,
    Columns,
}

impl SummedArea {
    /// Longest side of a map: a row of it is 4,096 loop steps of one invocation.
    pub const MAX_SIDE: usize = kernel::MAX_SIDE as usize;

    /// Builds the pipelines for maps that lie as `texels` says.
    pub fn new(device: &wgpu::Device, texels: Texels) -> Self {
        let packed = kernel::Constants { packed: texels == Texels::Bits };
        Self {
            texels,
            rows: kernel::RowsProgram::new(device, packed),
            strips: kernel::StripsProgram::new(device, packed),
            columns: kernel::ColumnsProgram::new(device, packed),
            columns_ragged: kernel::ColumnsRaggedProgram::new(device, packed),
            query: kernel::QueryProgram::new(device, kernel::Constants::default()),
            uniforms: Uniforms::default(),
        }
    }

    /// Scratch memory for maps of `width` by `height`.
    ///
    /// # Errors
    /// [`Error::Config`] above [`SummedArea::MAX_SIDE`], [`Error::Memory`] if 64 rows exceed the binding limit, else as
    /// [`Buffer::storage`].
    pub fn scratch(&self, device: &wgpu::Device, width: usize, height: usize) -> Result<SummedAreaScratch> {
        // A software adapter has few threads and likes long columns; a GPU wants thousands.
        let software = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
        let longest = kernel::MAX_STRIP_ROWS as usize;
        let strip_rows = if software { longest } else { height.isqrt().next_power_of_two().clamp(16, 128) };
        self.scratch_with_strips(device, width, height, strip_rows)
    }

    /// As [`SummedArea::scratch`], with a choice of how many rows one invocation runs down: a power of two up to 4,096.
    /// The table does not depend on it.
    ///
    /// # Errors
    /// As [`SummedArea::scratch`].
    pub fn scratch_with_strips(
        &self,
        device: &wgpu::Device,
        width: usize,
        height: usize,
        strip_rows: usize,
    ) -> Result<SummedAreaScratch> {
        if width.max(height) > Self::MAX_SIDE {
            let most = Self::MAX_SIDE;
            return Err(Error::Config(format!("summed_area: a map of {width}x{height}, at most {most} a side")));
        }
        let longest = kernel::MAX_STRIP_ROWS as usize;
        if !strip_rows.is_power_of_two() || strip_rows > longest {
            return Err(Error::Config(format!(
                "summed_area: strips of {strip_rows} rows, not a power of two up to {longest}"
            )));
        }
        // Bands begin at multiples of 64 rows, so that their offsets are multiples of 256 bytes.
        let limit = device.limits().max_storage_buffer_binding_size;
        let fit = (limit / (width.max(1) as u64 * 4)) as usize;
        if fit < height.min(64) {
            let needed = width as u64 * 4 * 64;
            return Err(Error::Memory { what: "summed_area: 64 rows of the table".to_owned(), needed, limit });
        }
        let (strip_rows, band_rows) = if fit >= height {
            (strip_rows, height)
        } else {
            let strip_rows = strip_rows.min(1 << fit.ilog2());
            let step = strip_rows.max(64);
            (strip_rows, fit / step * step)
        };
        let row_words = match self.texels {
            Texels::Words => width.div_ceil(4),
            Texels::Bits => width.div_ceil(32),
        };
        let strips = height.div_ceil(strip_rows).max(1);
        Ok(SummedAreaScratch {
            texels: self.texels,
            width,
            height,
            strip_rows,
            band_rows: band_rows.max(1),
            row_words,
            row_sums: Buffer::storage(device, "summed_area.row_sums", row_words * height)?,
            strip_sums: Buffer::storage(device, "summed_area.strip_sums", strips * width.div_ceil(4))?,
        })
    }

    /// Records the table `sat` of the map `texels`.
    ///
    /// # Errors
    /// [`Error::Config`] if a buffer is too small or the scratch is for the other kind of map.
    pub fn record(
        &self,
        stage: &mut Stage,
        texels: &Buffer<u32>,
        sat: &Buffer<u32>,
        scratch: &SummedAreaScratch,
    ) -> Result<()> {
        let (width, height) = (scratch.width, scratch.height);
        let stride = self.texels.row_words(width);
        if scratch.texels != self.texels {
            return Err(Error::Config(format!(
                "summed_area: scratch for {:?}, map of {:?}",
                scratch.texels, self.texels
            )));
        }
        holds("summed_area", "texels", texels.len(), stride * height)?;
        holds("summed_area", "sat", sat.len(), width * height)?;
        let quads = width.div_ceil(4);
        let summed = (height.div_ceil(scratch.strip_rows).max(1) - 1) * scratch.strip_rows;
        if width == 0 {
            return Ok(());
        }
        for (run, height) in [(Run::Rows, height), (Run::Strips, summed), (Run::Columns, height)] {
            for first in (0..height).step_by(scratch.band_rows) {
                let rows = scratch.band_rows.min(height - first);
                let params = self.uniforms.get(
                    stage.device,
                    &SummedAreaParams {
                        width: width as u32,
                        height: scratch.height as u32,
                        row_words: scratch.row_words as u32,
                        strip_rows: scratch.strip_rows as u32,
                        first_row: first as u32,
                        rows: rows as u32,
                        ..SummedAreaParams::default()
                    },
                )?;
                let bindings = kernel::Columns {
                    params: params.as_uniform(),
                    texels: texels.read_range(first * stride, rows * stride),
                    row_sums: scratch.row_sums.as_write(),
                    strip_sums: scratch.strip_sums.as_write(),
                    sat_quads: sat.write_range(first * width, rows * width).cast(),
                };
                let strips = Groups::Items((rows.div_ceil(scratch.strip_rows) * quads) as u64);
                match run {
                    Run::Rows => stage.run(&self.rows, bindings, Groups::Items(rows as u64)),
                    Run::Strips => stage.run(&self.strips, bindings, strips),
                    Run::Columns if width.is_multiple_of(4) => stage.run(&self.columns, bindings, strips),
                    Run::Columns => {
                        let kernel::Columns { params, texels, row_sums, strip_sums, sat_quads } = bindings;
                        let sat = sat_quads.cast();
                        let ragged = kernel::ColumnsRagged { params, texels, row_sums, strip_sums, sat };
                        stage.run(&self.columns_ragged, ragged, strips);
                    }
                }
            }
        }
        Ok(())
    }

    /// Records the sums over `rects` (inclusive `x0, y0, x1, y1`) of a `width` by `height` map, from its table, which one
    /// binding must hold.
    ///
    /// # Errors
    /// [`Error::Config`] if a buffer is too small.
    pub fn record_queries(
        &self,
        stage: &mut Stage,
        sat: &Buffer<u32>,
        [width, height]: [usize; 2],
        rects: &Buffer<[u32; 4]>,
        sums: &Buffer<u32>,
    ) -> Result<()> {
        holds("summed_area", "sat", sat.len(), width * height)?;
        holds("summed_area", "sums", sums.len(), rects.len())?;
        let params = SummedAreaParams {
            width: width as u32,
            height: height as u32,
            rects: rects.len() as u32,
            ..SummedAreaParams::default()
        };
        let params = self.uniforms.get(stage.device, &params)?;
        let bindings = kernel::Query {
            params: params.as_uniform(),
            sat: sat.as_write(),
            rects: rects.as_read(),
            rect_sums: sums.as_write(),
        };
        stage.run(&self.query, bindings, Groups::Items(rects.len() as u64));
        Ok(())
    }
}
