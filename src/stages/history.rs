//! Visibility that frames before had at the same point, mixed with this frame's (temporal reprojection with confidence: Scherzer, Jeschke,
//! Wimmer 2007; Scherzer 2011, section 4.6).
//!
//! - **Purpose.** Maps of depths that lie otherwise in each frame ([`LightView::jittered`](crate::light_view::LightView::jittered)): a place between two texels' centres now lies at one
//!   then, where the map is right. Of a light and casters that stand visibility converges to that of much finer maps.
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, the views of the light, the camera before ([`FrameBefore`]), what
//!   was kept of the frame before.
//! - **Writes** `visibility`, in place: the mean of all frames by `confidence^power`, of which a sum of 4 at the most is remembered, where the past is
//!   bilinear over those of four pixels that saw the same plane within a hundredth of their depth, and none where no pixel did. The paper's is
//!   `past + confidence^power (visibility - past)`, in which the first frame counts in full and takes the longer to go the higher the power. What is
//!   kept for the frame after: visibility, view depth, sum of weights.
//! - **Guarantee.** Bit-equal from run to run. Visibility that equals its past stays as it is, to the bit.
//! - **Cost.** One dispatch over pixels, 32 bytes a pixel of memory, and a copy of half of it.

use super::PrimaryHits;
use super::pixel_views::LightViews;
use crate::frame::Frame;
use crate::gpu::kernels::history as kernel;
use crate::gpu::{Buffer, Groups, Recorder, Stage};
use crate::scene::PixelRays;
use crate::{Result, shared_struct};
use glam::{DMat3, DVec3};

shared_struct! {
    /// The camera of the frame before, beside that of this one; by default there is none.
    "history" => pub struct FrameBefore {
        /// Rows of a point of this frame to x and y of its place in the image before, in pixels, times the third, its view depth then.
        pub rows: [[f32; 4]; 3],
        /// The eye before, a point of this frame; `w`: 1 if there is a frame before, else 0.
        pub eye: [f32; 4],
        /// Direction before through the top left corner of the image.
        pub corner: [f32; 4],
        /// Change of it for one pixel to the right.
        pub step_x: [f32; 4],
        /// Change of it for one pixel down.
        pub step_y: [f32; 4],
    }
}

impl FrameBefore {
    /// Rays of both cameras, with the scales of their frames ([`unit_scale`](crate::light_view::unit_scale)).
    pub fn new((now, scale): (&PixelRays, f64), (before, scale_before): (&PixelRays, f64)) -> Self {
        let eye = (before.eye - now.eye) * scale;
        let by = scale / scale_before;
        // A point is `eye + depth * by * (corner + x step_x + y step_y)`.
        let to_pixels = DMat3::from_cols(before.step_x, before.step_y, before.corner).inverse() * (1.0 / by);
        let row = |k: usize| {
            let row: DVec3 = to_pixels.row(k);
            row.extend(-row.dot(eye)).as_vec4().into()
        };
        let ray = |v: DVec3| (v * by).extend(0.0).as_vec4().into();
        Self {
            rows: [row(0), row(1), row(2)],
            eye: eye.extend(1.0).as_vec4().into(),
            corner: ray(before.corner),
            step_x: ray(before.step_x),
            step_y: ray(before.step_y),
        }
    }
}

/// The pipeline.
#[derive(Debug)]
pub struct History {
    blend: kernel::BlendProgram,
}

/// Inputs of the stage besides what the camera sees, and what it keeps.
#[derive(Debug)]
pub struct HistoryBuffers {
    /// The views of the light in this frame.
    pub views: Buffer<LightViews>,
    /// The camera of the frame before.
    pub before: Buffer<FrameBefore>,
    /// Visibility, view depth and sum of weights of each pixel of the frame before, and 0; depth 0 where nothing lit was seen.
    pub past: Buffer<[f32; 4]>,
    /// The same of this frame.
    pub kept: Buffer<[f32; 4]>,
}

impl HistoryBuffers {
    /// Memory for an image of `pixels` pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, pixels: usize) -> Result<Self> {
        Ok(Self {
            views: Buffer::uniform(device, "history.views", 1)?,
            before: Buffer::uniform(device, "history.before", 1)?,
            past: Buffer::storage(device, "history.past", pixels)?,
            kept: Buffer::storage(device, "history.kept", pixels)?,
        })
    }
}

impl History {
    /// Builds the pipeline: views are chosen as by [`PixelViews`](super::pixel_views::PixelViews) with the same `reach`; the confidence is
    /// taken to `power`.
    pub fn new(device: &wgpu::Device, reach: f32, power: u32) -> Self {
        Self { blend: kernel::BlendProgram::new(device, kernel::Constants { paraboloids: 0, reach, power }) }
    }

    /// Records what becomes of `visibility`.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        with: &HistoryBuffers,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Blend {
            frame: frame.as_uniform(),
            views: with.views.as_uniform(),
            before: with.before.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            past: with.past.as_read(),
            visibility: visibility.as_write(),
            kept: with.kept.as_write(),
        };
        stage.run(&self.blend, bindings, Groups::Items(visibility.len() as u64));
    }

    /// Records that this frame is the one before the next.
    pub fn record_turn(&self, rec: &mut Recorder, with: &HistoryBuffers) {
        rec.copy(with.kept.raw(), with.past.raw(), 16 * with.past.len() as u64);
    }
}
