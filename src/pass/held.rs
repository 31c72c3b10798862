//! The last complete picture, which stands until the next one.

use super::image_strips::ImageStrips;
use crate::Result;
use crate::gpu::{Buffer, Recorder};
use crate::methods::Settings;
use crate::methods::facet_masks::Capacities;
use crate::stages::visibility_texture::{LastPicture, Lists};

/// The picture, and whether it is replaced. A clone is the same memory.
#[derive(Clone)]
pub struct HeldPicture {
    pub visibility: Buffer<f32>,
    pub lit: Option<Buffer<u32>>,
    verdict: Buffer<u32>,
}

impl HeldPicture {
    /// Memory for the picture of an image; until there is a complete one all is lit.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, settings: &Settings, image: &ImageStrips) -> Result<Self> {
        let (pixels, words) = (settings.pixels(), settings.samples.words() as usize);
        let held = Self {
            visibility: Buffer::banded(device, "shadow_pass.held_visibility", pixels)?,
            lit: image.lit().map(|_| Buffer::banded(device, "shadow_pass.held_lit", pixels * words)).transpose()?,
            verdict: Buffer::storage(device, "shadow_pass.verdict", 1)?,
        };
        held.visibility.write(queue, &vec![1.0; pixels]);
        if let Some(lit) = &held.lit {
            lit.write(queue, &vec![u32::MAX; pixels * words]);
        }
        Ok(held)
    }

    /// Begins a frame: nothing is missing yet.
    pub fn record_begin(&self, rec: &mut Recorder) {
        rec.clear(self.verdict.raw());
    }

    /// Takes in what the strip that ran last left in its counters.
    pub fn record_judge(
        &self,
        rec: &mut Recorder,
        with: &LastPicture,
        image: &ImageStrips,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        let (method, c) = (&image.method, image.method.capacities());
        let frame = method.frame();
        let stage = &mut rec.stage("visibility_texture");
        with.record_judge(stage, frame, &lists(c), method.status(), faults, &self.verdict)
    }

    /// Takes over the picture of all strips, if nothing is missing in it.
    pub fn record_hold(&self, rec: &mut Recorder, with: &LastPicture, image: &ImageStrips) {
        let stage = &mut rec.stage("visibility_texture");
        with.record_hold(stage, &self.verdict, image.visibility(), &self.visibility);
        if let Some((lit, held)) = image.lit().zip(self.lit.as_ref()) {
            with.record_hold(stage, &self.verdict, lit, held);
        }
    }
}

/// Limits of a frame's lists with the capacities `c`.
fn lists(c: Capacities) -> Lists {
    Lists {
        bands: c.views * c.bands,
        most_at_place: c.most_at_place,
        most_at_pixel: c.most_at_pixel,
        ..Lists::default()
    }
}
