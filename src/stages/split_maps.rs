//! The nearest caster at every texel centre of the maps of slices of what the camera sees.
//!
//! - **Purpose.** Shadow maps in parallel splits (Zhang et al. 2006), warped or not ([`LightView::split`]).
//! - **Reads** triangles, vertices relative to the eye, the rectangles of the whole light view (only whether they are empty).
//! - **Writes** `map_keys`, view after view, row by row (complement of the bits of the depth of the whole view; 0 where there is
//!   none). All must be 0 before. In between, of each triangle in each view the rectangle of texels and its 8 × 8 blocks.
//! - **Guarantee.** Bit-equal from run to run: the largest key stays, in whatever order they come. Triangles that are not surely in
//!   front of a light at a point cast nothing.
//! - **Cost.** About 18 bytes a triangle and view, 4 a texel and view; one dispatch for rectangles, three of the scan of their blocks, one
//!   to list the blocks' owners, one for arguments, one indirect over blocks.

use super::dispatch_args::{ArgsRequest, DispatchArgs, Requests};
use super::work_owners::{ListWork, WorkOwners};
use super::{PrefixScan, prefix_scan};
use crate::frame::Frame;
use crate::gpu::kernels::split_maps as kernel;
use crate::gpu::{Buffer, Groups, Stage};
use crate::light_view::{LightView, SeenBox, SplitPlan, SplitView};
use crate::{Result, shared_struct};

shared_struct! {
    /// Uniform of the slices' views.
    "shared/raster/split_views" => pub struct SplitViews {
        /// Three rows a view: point to texel x and y, times the third.
        pub rows: [[f32; 4]; 12],
        /// Likewise from texels of the whole view.
        pub warps: [[f32; 4]; 12],
        /// The inverse of those.
        pub backs: [[f32; 4]; 12],
        /// View depth at which each slice ends.
        pub ends: [f32; 4],
        /// Views.
        pub count: u32,
        /// Levels of moments above the texels.
        pub levels: u32,
        /// Moments of a view.
        pub level_stride: u32,
        /// Depth where there is no caster: not less than that of anything.
        pub far: f32,
        /// Where each level begins among the moments of its view.
        pub level_starts: [[u32; 4]; 4],
    }
}

impl SplitViews {
    /// At most [`SplitPlan::MOST`] views, of maps of `map_size` texels a side, at most [`LightView::LARGEST_MAP`]; depths to `far`.
    pub fn new(views: &[SplitView], map_size: u32, far: f64) -> Self {
        let count = (views.len() as u32).min(SplitPlan::MOST);
        let mut made = Self { count, far: far as f32, ends: [3e38; 4], ..Self::default() };
        for (k, view) in views.iter().take(SplitPlan::MOST as usize).enumerate() {
            let back = view.warp.inverse();
            for (r, row) in view.rows.iter().enumerate() {
                made.rows[3 * k + r] = row.as_vec4().into();
                made.warps[3 * k + r] = view.warp.row(r).extend(0.0).as_vec4().into();
                made.backs[3 * k + r] = back.row(r).extend(0.0).as_vec4().into();
            }
            made.ends[k] = view.end.min(3e38) as f32;
        }
        let map_size = map_size.min(LightView::LARGEST_MAP);
        let levels = Self::levels_of(map_size);
        made.levels = levels;
        for level in 1..=levels {
            made.level_starts[level as usize / 4][level as usize % 4] = made.level_stride;
            made.level_stride += Self::side_of(map_size, level).pow(2);
        }
        made
    }

    /// Levels above the texels of a map: until one cell holds all of it.
    pub fn levels_of(map_size: u32) -> u32 {
        u32::BITS - (map_size.max(1) - 1).leading_zeros()
    }

    /// Cells a side of a level.
    pub fn side_of(map_size: u32, level: u32) -> u32 {
        ((map_size.max(1) - 1) >> level) + 1
    }

    /// Moments of all levels of a map.
    pub fn moments_of(map_size: u32) -> usize {
        (1..=Self::levels_of(map_size)).map(|l| (Self::side_of(map_size, l) as usize).pow(2)).sum()
    }

    /// Views of all slices of what is seen in `view`.
    pub fn of_view(view: &LightView, seen: &SeenBox, plan: &SplitPlan) -> Self {
        Self::new(&view.split(seen, plan), view.map_size, Self::farthest(view, seen.box_corners()))
    }

    /// A depth in `view` for texels without a caster: by the casters' extent along the light beyond the greatest of a box, given by its
    /// corners in the space of the view's rows, so that the plane of a surface that ends lies before it beside its border too.
    pub fn farthest(view: &LightView, corners: impl Iterator<Item = glam::DVec3>) -> f64 {
        // Beyond all points in front of a light at a point lies the depth of what is infinitely far along its axis.
        let axis = view.w.truncate();
        let limit = if view.perspective { view.z.truncate().dot(axis) / axis.length_squared() } else { f64::INFINITY };
        corners.map(|p| view.project(p).map_or(limit, |p| p.z)).fold(1.0, f64::max) + 1.0
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct SplitMaps {
    measure: kernel::MeasureProgram,
    raster: kernel::RasterProgram,
    work: ListWork,
}

/// The maps, and what making them takes.
#[derive(Debug)]
pub struct Maps {
    /// Keys of the nearest depths, view after view.
    pub keys: Buffer<u32>,
    /// Texels that each triangle may cover in each view: packed corners, both included.
    pub rects: Buffer<[u32; 2]>,
    /// How many 8 × 8 blocks these are.
    pub items: Buffer<u32>,
    offsets: Buffer<u32>,
    scratch: prefix_scan::PrefixScanScratch,
    requests: Requests,
    args: Buffer<u32>,
}

impl Maps {
    /// Memory for `views` maps of `size` texels a side, and `triangles` triangles.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        views: usize,
        size: usize,
        triangles: usize,
    ) -> Result<Self> {
        let (owners, texels) = (views * triangles, views * size * size);
        let request = ArgsRequest::new(owners, kernel::WORKGROUP, ArgsRequest::MAX_LIMIT, 0)?;
        Ok(Self {
            keys: Buffer::storage(device, "split_maps.keys", texels)?,
            rects: Buffer::storage(device, "split_maps.rects", owners)?,
            items: Buffer::storage(device, "split_maps.items", owners)?,
            offsets: Buffer::storage(device, "split_maps.offsets", WorkOwners::words(owners, texels))?,
            scratch: PrefixScan::scratch(device, owners)?,
            requests: DispatchArgs::requests(device, queue, &[request])?,
            args: Buffer::indirect(device, "split_maps.args", 3)?,
        })
    }
}

/// The mesh as the stage takes it.
#[derive(Clone, Copy, Debug)]
pub struct SplitMapInputs<'a> {
    /// Vertex indices.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Vertices relative to the eye, scaled.
    pub points: &'a Buffer<[f32; 4]>,
    /// Rectangles in the whole light view, of `triangle_setup`.
    pub light_rects: &'a Buffer<[u32; 2]>,
}

impl SplitMaps {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        Self {
            measure: kernel::MeasureProgram::new(device, ()),
            raster: kernel::RasterProgram::new(device, ()),
            work: ListWork::new(device, &PrefixScan::new(device)),
        }
    }

    /// Records the rectangles and block counts alone, which [`SplitMaps::record`] begins with.
    pub fn measure(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        splits: &Buffer<SplitViews>,
        mesh: SplitMapInputs,
        maps: &Maps,
    ) {
        let bindings = kernel::Measure {
            frame: frame.as_uniform(),
            splits: splits.as_uniform(),
            triangles: mesh.triangles.as_read(),
            points: mesh.points.as_read(),
            light_rects: mesh.light_rects.as_read(),
            split_rects: maps.rects.as_write(),
            split_items: maps.items.as_write(),
        };
        stage.run(&self.measure, bindings, Groups::Items(maps.items.len() as u64));
    }

    /// Records it, for as many views as the maps are for, of which `splits` tells.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        splits: &Buffer<SplitViews>,
        mesh: SplitMapInputs,
        maps: &Maps,
    ) -> Result<()> {
        self.measure(stage, frame, splits, mesh, maps);
        let offsets = &maps.offsets;
        self.work.record(
            stage,
            (&maps.items, maps.items.len()),
            offsets,
            &maps.scratch,
            (&maps.requests, &maps.args),
        )?;
        let bindings = kernel::Raster {
            frame: frame.as_uniform(),
            splits: splits.as_uniform(),
            triangles: mesh.triangles.as_read(),
            points: mesh.points.as_read(),
            rects: maps.rects.as_read(),
            work_offsets: offsets.as_read(),
            map_keys: maps.keys.as_write(),
        };
        stage.run(&self.raster, bindings, Groups::Indirect(maps.args.raw(), 0));
        Ok(())
    }
}
