//! The view of the light that each pixel asks, where there are several and a method asks one.
//!
//! - **Purpose.** Methods of one receiver a pixel with a list of views: slices of what the camera sees (Zhang et al. 2006; a pixel
//!   chooses by map rather than by depth, as no filter then reaches over a map's side), or a cube of views around a light. Such a
//!   method runs once a view, on the pixels that ask it, and knows nothing of the others.
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices; of each view what a method left.
//! - **Writes** `view_of`: the first view that holds the pixel by [`PixelViews::new`]'s reach, else that which holds most of it;
//!   `view_keys`: the triangle at the centre of each pixel that asks one view, 0 at the others; what was left, in its place.
//! - **Guarantee.** Bit-equal from run to run; each pixel asks one view.
//! - **Cost.** Four words a pixel and what is taken; a dispatch over pixels, and two or more for each view.

use super::PrimaryHits;
use super::camera_visibility::Pass;
use crate::frame::Frame;
use crate::gpu::bindings::Read;
use crate::gpu::kernels::pixel_views as kernel;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::light_view::LightView;
use crate::{Result, shared_struct};

shared_struct! {
    /// The views of a frame.
    "shared/facet/view_choice" => pub struct LightViews {
        /// Of each view four rows: of a point to texel x and y, times the third; last the least divisor of points in front, and 1 of a paraboloid view.
        pub rows: [[f32; 4]; 24],
        /// Views.
        pub count: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
        /// Unused.
        pub pad_2: u32,
    }
}

impl LightViews {
    /// Most views.
    pub const MOST: usize = 6;

    /// These views, whose rows take points of the frame ([`LightView::relative_to`]); those beyond the first [`LightViews::MOST`] are none.
    pub fn new(views: &[LightView]) -> Self {
        let count = views.len().min(Self::MOST) as u32;
        let mut made = Self { count, ..Self::default() };
        for (rows, view) in made.rows.chunks_exact_mut(4).zip(views) {
            let [u, v, w] = [view.u, view.v, view.w].map(|row| row.as_vec4().into());
            let curved = if view.paraboloid.is_some() { 1.0 } else { 0.0 };
            rows.copy_from_slice(&[u, v, w, [view.near as f32, curved, 0.0, 0.0]]);
        }
        made
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct PixelViews {
    choose: kernel::ChooseProgram,
    keep: kernel::KeepProgram,
    uniforms: Uniforms,
}

/// Words of a pixel that a method leaves for each view.
#[derive(Debug)]
pub struct TakeWords {
    take: kernel::TakeProgram,
    uniforms: Uniforms,
}

/// Which view each pixel asks.
#[derive(Debug)]
pub struct PixelChoice {
    /// The views.
    pub views: Buffer<LightViews>,
    /// Number of the view of each pixel.
    pub view_of: Buffer<u32>,
    /// Complement of the triangle at the centre of each pixel that asks the view at hand; 0 for the others.
    pub view_keys: Buffer<u32>,
}

impl PixelChoice {
    /// Memory for an image of `pixels` pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, pixels: usize) -> Result<Self> {
        Ok(Self {
            views: Buffer::uniform(device, "pixel_views.views", 1)?,
            view_of: Buffer::storage(device, "pixel_views.view_of", pixels)?,
            view_keys: Buffer::storage(device, "pixel_views.view_keys", pixels)?,
        })
    }
}

impl PixelViews {
    /// Builds the pipelines; a method asks up to `reach` texels around what a pixel touches.
    pub fn new(device: &wgpu::Device, reach: f32) -> Self {
        let constants = kernel::Constants { reach, ..Default::default() };
        Self {
            choose: kernel::ChooseProgram::new(device, constants),
            keep: kernel::KeepProgram::new(device, constants),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the choice of every pixel, of whose views `choice` tells; `frame` may be that of any.
    pub fn record_choose(&self, stage: &mut Stage, frame: &Buffer<Frame>, seen: PrimaryHits, choice: &PixelChoice) {
        let bindings = kernel::Choose {
            frame: frame.as_uniform(),
            views: choice.views.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            view_of: choice.view_of.as_write(),
        };
        stage.run(&self.choose, bindings, Groups::Items(choice.view_of.len() as u64));
    }

    /// Records the triangles of the pixels that ask a view.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_keep(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        view: u32,
        id_keys: &Buffer<u32>,
        choice: &PixelChoice,
    ) -> Result<()> {
        let step = self.uniforms.get(stage.device, &Pass { index: view })?;
        let bindings = kernel::Keep {
            frame: frame.as_uniform(),
            step: step.as_uniform(),
            id_keys: id_keys.as_read(),
            view_of: choice.view_of.as_write(),
            view_keys: choice.view_keys.as_write(),
        };
        stage.run(&self.keep, bindings, Groups::Items(choice.view_of.len() as u64));
        Ok(())
    }
}

impl TakeWords {
    /// Builds the pipeline for `stride` words a pixel, which lie behind `skip` others a pixel.
    pub fn new(device: &wgpu::Device, stride: u32, skip: u32) -> Self {
        let constants = kernel::Constants { stride, skip, ..Default::default() };
        Self { take: kernel::TakeProgram::new(device, constants), uniforms: Uniforms::default() }
    }

    /// Records that what a method `left` of the pixels that ask a view is `taken`.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        view: u32,
        choice: &PixelChoice,
        (left, taken): (Read<u32>, &Buffer<u32>),
    ) -> Result<()> {
        let step = self.uniforms.get(stage.device, &Pass { index: view })?;
        let bindings = kernel::Take {
            frame: frame.as_uniform(),
            step: step.as_uniform(),
            view_of: choice.view_of.as_write(),
            left,
            taken: taken.as_write(),
        };
        stage.run(&self.take, bindings, Groups::Items(taken.len() as u64));
        Ok(())
    }
}
