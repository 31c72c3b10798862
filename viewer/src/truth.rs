//! Traced truth, a run of pixels at a time.

use crate::beside::{Rays, Traced, TracedView};
use crate::job::Job;
use crate::picture::{unknown_visibility, write_visibility};
use subpixel_shadows::wgpu;

/// Visibility by 1024 rays a pixel to each point of the light, from the top.
pub struct Tracing {
    rays: Rays,
    view: TracedView,
    done: u32,
    runs: Option<Job<Traced>>,
    /// Visibility of the pixels that are traced, below 0 elsewhere.
    pub shown: wgpu::Texture,
}

impl Tracing {
    /// Begins with no pixel.
    pub fn new((device, queue): (&wgpu::Device, &wgpu::Queue), rays: Rays, view: TracedView) -> Self {
        let shown = unknown_visibility((device, queue), view.size);
        Self { rays, view, done: 0, runs: None, shown }
    }

    /// Whether it is of this view.
    pub fn is_of(&self, view: &TracedView) -> bool {
        self.view == *view
    }

    /// Its width and height.
    pub fn size(&self) -> [u32; 2] {
        self.view.size
    }

    /// Share of the pixels that are traced.
    pub fn share(&self) -> f32 {
        let [width, height] = self.view.size;
        self.done as f32 / (width * height).max(1) as f32
    }

    /// Takes over what was traced beside the window, and has the next pixels traced. Whether there are new ones.
    ///
    /// # Errors
    /// One line: why none can be traced.
    pub fn advance(&mut self, queue: &wgpu::Queue, context: &egui::Context) -> Result<bool, String> {
        let mut new = false;
        if let Some(traced) = self.runs.as_ref().and_then(Job::take) {
            self.runs = None;
            // Where this cannot be traced, nothing more comes.
            let traced = traced.inspect_err(|_| self.done = self.view.size[0] * self.view.size[1])?;
            self.take(queue, &traced);
            new = !traced.is_empty();
        }
        let [width, height] = self.view.size;
        if self.runs.is_none() && self.done < width * height {
            self.runs = Some(self.rays.trace(context, &self.view, self.done));
        }
        Ok(new)
    }

    /// Writes a run of pixels: the rest of a row, whole rows, the begin of one.
    fn take(&mut self, queue: &wgpu::Queue, mut traced: &[f32]) {
        let [width, _] = self.view.size;
        while !traced.is_empty() {
            let (x, count) = (self.done % width, traced.len() as u32);
            let size = if x == 0 && count >= width { [width, count / width] } else { [count.min(width - x), 1] };
            let (run, rest) = traced.split_at((size[0] * size[1]) as usize);
            write_visibility(queue, &self.shown, [x, self.done / width], size, run);
            self.done += run.len() as u32;
            traced = rest;
        }
    }
}
