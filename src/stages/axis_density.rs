//! How many texels each part of the axes of the light's map takes, by what the pixels ask or by the distance from the eye, and where the texels lie.
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, the box of the samples.
//! - **Writes** of each of [`AxisTables::CELLS`] cells of either axis its density, and where each texel of the warped map begins along either axis, in
//!   texels of the map that is not warped.
//! - **Guarantee.** Bit-equal from run to run. Borders rise from 0 to the map's side. Along either axis no part of a cell that a pixel's samples touch has fewer
//!   texels, of as many as that axis has, than its share of what the pixels ask; no texel is narrower than one of the map by more than the limit of the
//!   stretch, but for the rounding of densities up.
//! - **Cost.** One dispatch over pixels, four atomics each, or as many reads where another asked before; two workgroups over the cells; a scan; a search for
//!   every border. 180 KiB, and 8 bytes for each texel of a side.
//! - **Source.** Rosen 2012 ("Rectilinear texture warping for fast adaptive shadow mapping"): importance of pixels to rows and columns by the greatest, and
//!   from it a warp of each axis; Lloyd et al. 2008 ("Logarithmic perspective shadow maps") for the other rule (Scherzer 2011, section 4.2.1).

use super::{PrefixScan, PrimaryHits, holds};
use crate::frame::Frame;
use crate::gpu::kernels::axis_density as kernel;
use crate::gpu::{Buffer, Groups, Stage};
use crate::stages::Count;
use crate::stages::prefix_scan::PrefixScanScratch;
use crate::{Error, Result};

/// Rule for the texels that a part of an axis takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DensityRule {
    /// The pixels: where one wants the most (Rosen 2012).
    #[default]
    Requested,
    /// The distance of the part from the eye, where any pixel wants texels: their number grows with its logarithm (Lloyd et al. 2008).
    Logarithmic,
}

/// The axes of a frame's map.
#[derive(Debug)]
pub struct AxisTables {
    /// Greatest density that pixels ask for, by spans of cells: see the kernel.
    pub requests: Buffer<u32>,
    /// Density of each cell, those of y behind those of x.
    pub densities: Buffer<u32>,
    /// Exclusive scan of the densities, their sum, a flag.
    pub axes: Buffer<u32>,
    /// Where each warped texel begins and the last ends, of x, then of y; texels of the map that is not warped.
    pub borders: Buffer<f32>,
    scan_scratch: PrefixScanScratch,
}

impl AxisTables {
    /// Cells of an axis.
    pub const CELLS: usize = kernel::AXIS_CELLS as usize;
    /// Density that makes texels as wide as those of the map where all cells have it.
    pub const ONE: u32 = kernel::ONE;

    /// Memory for a map of `map` texels a side.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, map: u32) -> Result<Self> {
        let cells = 2 * Self::CELLS;
        Ok(Self {
            requests: Buffer::storage(device, "axis_density.requests", kernel::REQUEST_WORDS as usize)?,
            densities: Buffer::storage(device, "axis_density.densities", cells)?,
            axes: Buffer::storage(device, "axis_density.axes", cells + 2)?,
            borders: Buffer::storage(device, "axis_density.borders", 2 * (map as usize + 1))?,
            scan_scratch: PrefixScan::scratch(device, cells)?,
        })
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct AxisDensity {
    request: kernel::RequestProgram,
    shape: kernel::ShapeProgram,
    divide: kernel::DivideProgram,
    scan: PrefixScan,
}

impl AxisDensity {
    /// Limits of the stretch that are possible.
    pub const STRETCHES: std::ops::RangeInclusive<u32> = 2..=256;

    /// Builds the pipelines for a rule and a limit of the stretch: texels of an axis as much narrower than one of the map as that, at most.
    ///
    /// # Errors
    /// [`Error::Config`] for a limit that is not among [`AxisDensity::STRETCHES`].
    pub fn new(device: &wgpu::Device, rule: DensityRule, stretch: u32) -> Result<Self> {
        if !Self::STRETCHES.contains(&stretch) {
            let (least, most) = (Self::STRETCHES.start(), Self::STRETCHES.end());
            return Err(Error::Config(format!("texels stretched {stretch} times; {least} to {most} are possible")));
        }
        let density = match rule {
            DensityRule::Requested => kernel::REQUESTED,
            DensityRule::Logarithmic => kernel::LOGARITHMIC,
        };
        let constants = kernel::Constants { paraboloids: 0, density, stretch };
        Ok(Self {
            request: kernel::RequestProgram::new(device, constants),
            shape: kernel::ShapeProgram::new(device, constants),
            divide: kernel::DivideProgram::new(device, constants),
            scan: PrefixScan::new(device),
        })
    }

    /// Records what the pixels ask for. [`AxisTables::requests`] must be 0 before.
    pub fn record_request(&self, stage: &mut Stage, frame: &Buffer<Frame>, seen: PrimaryHits, tables: &AxisTables) {
        let bindings = kernel::Request {
            frame: frame.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            requests: tables.requests.as_write(),
        };
        stage.run(&self.request, bindings, Groups::Items(seen.id_keys.len() as u64));
    }

    /// Records densities, their scan and the borders of a map of `map` texels a side.
    ///
    /// # Errors
    /// [`Error::Config`] if the tables are for a smaller map, [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_shape(&self, stage: &mut Stage, frame: &Buffer<Frame>, map: u32, tables: &AxisTables) -> Result<()> {
        let (cells, borders) = (tables.densities.len(), 2 * (map as usize + 1));
        holds("axis_density", "borders", tables.borders.len(), borders)?;
        let shape = kernel::Shape {
            frame: frame.as_uniform(),
            requests: tables.requests.as_write(),
            densities: tables.densities.as_write(),
        };
        stage.run(&self.shape, shape, Groups::Workgroups(2));
        let (densities, axes, scratch) = (&tables.densities, &tables.axes, &tables.scan_scratch);
        self.scan.record(stage, densities, axes, (axes, cells), scratch, Count::Exactly(cells))?;
        let divide =
            kernel::Divide { frame: frame.as_uniform(), axes: axes.as_read(), borders: tables.borders.as_write() };
        stage.run(&self.divide, divide, Groups::Items(borders as u64));
        Ok(())
    }
}
