//! Computing a frame of a method whose memory the settings alone decide: no list can overflow, so one run is the frame, unless
//! what the method left out turns out to be needed.

use super::debug_views::DebugViews;
use super::geometry::{Geometry, GeometryPipelines};
use super::prepared::{CasterBuffers, Prepared};
use super::render::{Counts, Output};
use super::settings::{FacetMode, LastView, Settings};
use crate::Result;
use crate::frame::{Frame, sample_words};
use crate::gpu::{Buffer, Gpu, Recorder, Timer};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use glam::DVec3;
use std::time::Instant;

/// Inputs of a stage of such a method.
#[derive(Clone, Copy)]
pub struct StageInputs<'a> {
    /// The frame uniform.
    pub frame: &'a Buffer<Frame>,
    /// Sample offsets, see [`sample_words`].
    pub samples: &'a Buffer<[f32; 4]>,
    /// The mesh.
    pub casters: &'a CasterBuffers,
    /// Projected vertices, rectangles, and the triangle at each pixel centre.
    pub geometry: &'a Geometry,
}

/// A method of fixed memory: stages after `triangle_setup` and `camera_visibility`, made for one mesh and setting.
pub trait FixedMethod {
    /// Whether samples on the plane of a pixel's facet count beyond the surface, too: the light's view is wider then.
    const BEYOND: bool = false;

    /// Takes in what changes from frame to frame.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for a camera or light it cannot serve.
    fn prepare(&mut self, gpu: &Gpu, camera: &Camera, light: &Light, view: &LightView, frame: &Frame) -> Result<()>;

    /// Records its stages.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()>;

    /// Whether the frame has to be recorded once more, as the method is set now: what it left out was needed.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`].
    fn runs_again(&mut self, _: &Gpu) -> Result<bool> {
        Ok(false)
    }

    /// Visibility of every pixel, row by row from the top; 1 where nothing is seen.
    fn visibility(&self) -> &Buffer<f32>;

    /// Lit samples of every pixel, where the method keeps them.
    fn lit(&self) -> Option<&Buffer<u32>>;

    /// Reads back what was counted.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`]; [`crate::Error::Limit`] if something was left out for want of steps.
    fn counts(&self, gpu: &Gpu) -> Result<Counts>;

    /// Reads back what there is to look at; `None` where the method keeps neither classes nor a map.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`].
    fn looks(&self, _: &Gpu) -> Result<Option<DebugViews>> {
        Ok(None)
    }
}

/// A method set up for one mesh and one setting, to be rendered again and again.
pub struct FixedRenderer<'a, M> {
    gpu: &'a Gpu,
    prepared: &'a Prepared,
    casters: CasterBuffers,
    settings: Settings,
    with: GeometryPipelines,
    geometry: Geometry,
    frame: Buffer<Frame>,
    samples: Buffer<[f32; 4]>,
    timer: Option<Timer>,
    method: M,
    view: LastView,
}

impl<'a, M: FixedMethod> FixedRenderer<'a, M> {
    /// Uploads the mesh and makes the memory; `make` builds the method for the uploaded mesh.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings, [`crate::Error::Memory`] and [`crate::Error::Gpu`] if memory
    /// does not suffice, and what `make` returns.
    pub fn new(
        gpu: &'a Gpu,
        prepared: &'a Prepared,
        settings: &Settings,
        make: impl FnOnce(&CasterBuffers) -> Result<M>,
    ) -> Result<Self> {
        settings.check()?;
        let casters = prepared.upload(&gpu.device, &gpu.queue)?;
        let samples = Buffer::uniform(&gpu.device, "samples", 64)?;
        samples.write(&gpu.queue, &sample_words(&settings.samples));
        let method = make(&casters)?;
        let made = Self {
            gpu,
            prepared,
            settings: settings.clone(),
            with: GeometryPipelines::new(&gpu.device),
            geometry: Geometry::new(&gpu.device, &gpu.queue, &casters, settings.pixels(), settings.texels())?,
            frame: Buffer::uniform(&gpu.device, "frame", 1)?,
            samples,
            timer: Timer::new(gpu)?,
            casters,
            method,
            view: LastView::default(),
        };
        gpu.check()?;
        Ok(made)
    }

    /// Renders one frame.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] for an impossible camera or light, [`crate::Error::Gpu`], and as [`FixedMethod::counts`].
    pub fn render(&mut self, camera: &Camera, light: &Light) -> Result<Output> {
        camera.check()?;
        light.check()?;
        let gpu = self.gpu;
        let own = Settings { facets: FacetMode::All, ..self.settings.clone() };
        let view = self.view.of(if M::BEYOND { &self.settings } else { &own }, self.prepared, light)?;
        let bounds = self.prepared.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let mut frame = Frame::new(camera, light, &view, bounds, self.settings.size, &self.settings.samples);
        frame.vertex_count = self.casters.positions.len() as u32;
        frame.triangle_count = self.casters.triangles.len() as u32;
        frame.edge_count = self.casters.edges.len() as u32;
        frame.facets_total = self.settings.pixels() as u32;
        frame.facet_count = frame.facets_total;
        self.frame.write(&gpu.queue, &[frame]);
        self.method.prepare(gpu, camera, light, &view, &frame)?;
        let mut wall_ms = 0.0;
        let mut dispatches = 0;
        loop {
            let mut encoder = gpu.encoder();
            if let Some(timer) = &mut self.timer {
                timer.reset();
            }
            let mut rec = Recorder::new(&gpu.device, &mut encoder, self.timer.as_mut());
            self.geometry.record_setup(&mut rec, &self.with, &self.frame, &self.casters)?;
            self.geometry.record_camera(&mut rec, &self.with, &self.frame, &self.casters)?;
            let inputs = StageInputs {
                frame: &self.frame,
                samples: &self.samples,
                casters: &self.casters,
                geometry: &self.geometry,
            };
            self.method.record(&mut rec, inputs)?;
            dispatches += rec.dispatches();
            if let Some(timer) = &self.timer {
                timer.resolve(&mut encoder);
            }
            let start = Instant::now();
            gpu.submit_and_wait(encoder)?;
            wall_ms += start.elapsed().as_secs_f64() * 1e3;
            if !self.method.runs_again(gpu)? {
                break;
            }
        }
        Ok(Output {
            visibility: self.method.visibility().read(gpu)?,
            lit: self.method.lit().map_or(Ok(Vec::new()), |lit| lit.read(gpu))?,
            words: self.settings.samples.words(),
            triangles: self.geometry.id_keys.read(gpu)?.into_iter().map(|key| !key).collect(),
            counts: self.method.counts(gpu)?,
            lists: Vec::new(),
            stages: self.timer.as_ref().map_or(Ok(Vec::new()), |t| t.read(gpu))?,
            wall_ms,
            dispatches,
        })
    }

    /// Looks of the last frame, see [`FixedMethod::looks`].
    ///
    /// # Errors
    /// [`crate::Error::Gpu`].
    pub fn looks(&self) -> Result<Option<DebugViews>> {
        self.method.looks(self.gpu)
    }

    /// The method, for looking at its buffers.
    pub fn method(&self) -> &M {
        &self.method
    }
}
