//! Several views of the light for a method that asks one a pixel: each view is a run of its own, on the pixels that ask it.

use super::geometry::Geometry;
use super::prepared::CasterBuffers;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::{Buffer, Recorder};
use crate::stages::PrimaryHits;
use crate::stages::pixel_views::{PixelChoice, PixelViews, TakeWords};

/// Results that a method leaves of every pixel.
#[derive(Clone, Copy)]
pub struct Left<'a> {
    /// Visibility.
    pub visibility: &'a Buffer<f32>,
    /// Lit samples, where it keeps them.
    pub lit: Option<&'a Buffer<u32>>,
    /// Classes, where it keeps them, behind as many other words.
    pub classes: Option<&'a Buffer<u32>>,
}

/// Pipelines and memory.
#[derive(Debug)]
pub struct ByViews {
    with: PixelViews,
    choice: PixelChoice,
    visibility: Joined,
    lit: Option<Joined>,
    classes: Option<Joined>,
}

/// Words of all pixels, each from the run of its view.
#[derive(Debug)]
struct Joined {
    take: TakeWords,
    words: Buffer<u32>,
}

impl Joined {
    fn new(device: &wgpu::Device, pixels: usize, words: usize, skip: u32) -> Result<Self> {
        Ok(Self {
            take: TakeWords::new(device, (words / pixels.max(1)) as u32, skip),
            words: Buffer::storage(device, "pixel_views.taken", words)?,
        })
    }
}

impl ByViews {
    /// Builds pipelines and memory for what a method leaves, which asks up to `reach` texels around what a pixel touches.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, reach: f32, left: Left) -> Result<Self> {
        let pixels = left.visibility.len();
        let joined = |words, skip| Joined::new(device, pixels, words, skip);
        Ok(Self {
            with: PixelViews::new(device, reach),
            choice: PixelChoice::new(device, pixels)?,
            visibility: joined(pixels, 0)?,
            lit: left.lit.map(|lit| joined(lit.len(), 0)).transpose()?,
            classes: left.classes.map(|_| joined(pixels, 1)).transpose()?,
        })
    }

    /// The views and what each pixel asks.
    pub fn choice(&self) -> &PixelChoice {
        &self.choice
    }

    /// Records which pixels ask view `view`, before the first which view each asks, after `triangle_setup`; returns their triangles.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_keep(
        &self,
        rec: &mut Recorder,
        view: u32,
        (frame, samples): (&Buffer<Frame>, &Buffer<[f32; 4]>),
        casters: &CasterBuffers,
        geometry: &Geometry,
    ) -> Result<&Buffer<u32>> {
        let stage = &mut rec.stage("pixel_views");
        let Geometry { id_keys, points, .. } = geometry;
        if view == 0 {
            let seen = PrimaryHits { samples, id_keys, triangles: &casters.triangles, points };
            self.with.record_choose(stage, frame, seen, &self.choice);
        }
        self.with.record_keep(stage, frame, view, id_keys, &self.choice)?;
        Ok(&self.choice.view_keys)
    }

    /// Records that what the method left of these pixels is kept.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_take(&self, rec: &mut Recorder, view: u32, frame: &Buffer<Frame>, left: Left) -> Result<()> {
        let stage = &mut rec.stage("pixel_views");
        let visibility = Some((left.visibility.as_read().cast(), &self.visibility));
        let lit = left.lit.map(Buffer::as_read).zip(self.lit.as_ref());
        let classes = left.classes.map(Buffer::as_read).zip(self.classes.as_ref());
        for (left, joined) in [visibility, lit, classes].into_iter().flatten() {
            joined.take.record(stage, frame, view, &self.choice, (left, &joined.words))?;
        }
        Ok(())
    }

    /// Records that it takes the place of what the method left of the last view.
    pub fn record_put(&self, rec: &mut Recorder, left: Left) {
        let pixels = left.visibility.len() as u64;
        rec.copy(self.visibility.words.raw(), left.visibility.raw(), 4 * pixels);
        if let Some((joined, lit)) = self.lit.as_ref().zip(left.lit) {
            rec.copy(joined.words.raw(), lit.raw(), 4 * lit.len() as u64);
        }
        if let Some((joined, classes)) = self.classes.as_ref().zip(left.classes) {
            rec.copy_words(joined.words.raw(), 0, classes.raw(), pixels, pixels);
        }
    }
}
