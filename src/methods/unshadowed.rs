//! The part of `facet-masks` that runs where the plan has proved that nothing casts a shadow: which triangle each pixel sees, and
//! whether it faces the light. The same stages decide it, so the picture is the same as that of the whole method.

use super::facet_masks::Settings;
use super::geometry::{Geometry, GeometryPipelines};
use super::prepared::{CasterBuffers, Prepared};
use super::render::{Counts, Output};
use super::strips::{Rows, Strips};
use crate::frame::{Frame, sample_words};
use crate::gpu::{Buffer, Gpu, Groups, KeptPrograms, Recorder, Timer};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use crate::stages::facet_classify::{ClassifyInputs, FacetClassify, FacetState, Facets};
use crate::stages::front_layer::UNCOVERED;
use crate::stages::resolve::Resolve;
use crate::status::Status;
use crate::{Error, Result};
use std::time::Instant;

/// The frame of a scene in which no pixel sees a surface: lit everywhere. Nothing is dispatched.
pub fn nothing_seen(settings: &Settings) -> Output {
    let pixels = settings.size.iter().map(|&s| s as usize).product::<usize>();
    let words = settings.samples.words();
    Output {
        visibility: vec![1.0; pixels],
        lit: vec![u32::MAX; pixels * words as usize],
        words,
        triangles: vec![u32::MAX; pixels],
        counts: Counts { empty_facets: pixels as u64, ..Counts::default() },
        lists: Vec::new(),
        stages: Vec::new(),
        wall_ms: 0.0,
        dispatches: 0,
    }
}

/// Looks at the facets of each strip of rows.
pub type FacetLook<'a> = &'a mut dyn FnMut(&Facets, Rows) -> Result<()>;

/// Renders a frame in which nothing casts a shadow: facets that face the light are lit, the others dark. In strips of rows where one
/// binding does not hold the facets.
///
/// # Errors
/// As [`super::render::Renderer::render`].
pub fn render(gpu: &Gpu, prepared: &Prepared, settings: &Settings, camera: &Camera, light: &Light) -> Result<Output> {
    Unshadowed::new(gpu, prepared, settings)?.render(camera, light)
}

/// As [`render`], and lets `look` see the facets with their masks after each strip of rows; from row 0 on once more, with other rows,
/// where strips turned out too large.
///
/// # Errors
/// As [`render`], and those of `look`.
pub fn render_and(
    gpu: &Gpu,
    prepared: &Prepared,
    settings: &Settings,
    camera: &Camera,
    light: &Light,
    look: FacetLook,
) -> Result<Output> {
    Unshadowed::new(gpu, prepared, settings)?.render_and(camera, light, look)
}

/// Frames in which nothing casts a shadow, set up for one mesh and one setting, to be rendered again and again.
pub struct Unshadowed<'a> {
    gpu: &'a Gpu,
    prepared: &'a Prepared,
    settings: Settings,
    casters: CasterBuffers,
    with: Pipelines,
    strips: Strips,
    /// Memory of one strip, of that size; made by the first frame.
    memory: Option<([u32; 2], Memory)>,
}

impl<'a> Unshadowed<'a> {
    /// Uploads the mesh and builds pipelines.
    ///
    /// # Errors
    /// As [`super::render::Renderer::new`].
    pub fn new(gpu: &'a Gpu, prepared: &'a Prepared, settings: &Settings) -> Result<Self> {
        settings.check()?;
        let casters = prepared.upload(&gpu.device, &gpu.queue)?;
        let (with, strips) = (Pipelines::new(gpu, settings), Strips::new(settings.size, 1));
        Ok(Self { gpu, prepared, settings: settings.clone(), casters, with, strips, memory: None })
    }

    /// Renders one frame.
    ///
    /// # Errors
    /// As [`super::render::Renderer::render`].
    pub fn render(&mut self, camera: &Camera, light: &Light) -> Result<Output> {
        self.render_and(camera, light, &mut |_, _| Ok(()))
    }

    /// As [`render_and`].
    ///
    /// # Errors
    /// As [`render_and`].
    pub fn render_and(&mut self, camera: &Camera, light: &Light, look: FacetLook) -> Result<Output> {
        let frame = frame(self.prepared, &self.settings, camera, light, &self.casters)?;
        'image: loop {
            let mut image: Option<Output> = None;
            for rows in self.strips.rows() {
                let of_strip = Settings { size: self.strips.size(), ..self.settings.clone() };
                let mut frame = Frame { image_size: of_strip.size, first_row: rows.first, ..frame };
                frame.facets_total = of_strip.pixels() as u32;
                frame.facet_count = frame.facets_total;
                let (size, memory) = match self.memory.take().filter(|(size, _)| *size == of_strip.size) {
                    Some(kept) => kept,
                    None => match Memory::new(self.gpu, &self.casters, &of_strip) {
                        Err(error @ Error::Memory { .. }) => {
                            self.strips = self.strips.more().ok_or(error)?;
                            continue 'image;
                        }
                        made => (of_strip.size, made?),
                    },
                };
                let (_, memory) = self.memory.insert((size, memory));
                let output = memory.strip(self.gpu, &self.with, &self.casters, &of_strip, frame)?;
                look(&memory.facets, rows)?;
                match &mut image {
                    None => image = Some(output),
                    Some(image) => image.add_rows(output, rows),
                }
            }
            return image.ok_or_else(|| Error::Config("an image without rows".to_owned()));
        }
    }
}

struct Pipelines {
    geometry: GeometryPipelines,
    classify: FacetClassify,
    resolve: Resolve,
}

impl Pipelines {
    fn new(gpu: &Gpu, settings: &Settings) -> Self {
        let (device, words) = (&gpu.device, settings.samples.words());
        KeptPrograms::once(|| Self {
            geometry: GeometryPipelines::new(device),
            classify: FacetClassify::new(device, words),
            resolve: Resolve::new(device, words),
        })
    }
}

/// A frame with a light view of one texel that no caster touches.
fn frame(
    prepared: &Prepared,
    settings: &Settings,
    camera: &Camera,
    light: &Light,
    casters: &CasterBuffers,
) -> Result<Frame> {
    camera.check()?;
    let view = LightView::fit(&prepared.mesh, light, 1)?;
    let bounds = prepared.mesh.bounds().unwrap_or_default();
    let mut frame = Frame::new(camera, light, &view, bounds, settings.size, &settings.samples);
    frame.vertex_count = casters.positions.len() as u32;
    frame.triangle_count = casters.triangles.len() as u32;
    frame.edge_count = casters.edges.len() as u32;
    Ok(frame)
}

/// Memory of one strip, and what its frame leaves behind.
struct Memory {
    frame: Buffer<Frame>,
    samples: Buffer<[f32; 4]>,
    geometry: Geometry,
    facets: Facets,
    status: Buffer<u32>,
    visibility: Buffer<f32>,
    lit: Buffer<u32>,
    /// The light view's one texel: no mark in the table.
    sat: Buffer<u32>,
    /// The same: no caster.
    splits: Buffer<f32>,
    timer: Option<Timer>,
}

impl Memory {
    fn new(gpu: &Gpu, casters: &CasterBuffers, settings: &Settings) -> Result<Self> {
        let (device, queue) = (&gpu.device, &gpu.queue);
        let (pixels, words) = (settings.pixels(), settings.samples.words() as usize);
        let samples = Buffer::uniform(device, "samples", 64)?;
        samples.write(queue, &sample_words(&settings.samples));
        Ok(Self {
            frame: Buffer::uniform(device, "frame", 1)?,
            samples,
            geometry: Geometry::new(device, queue, casters, pixels, settings.texels())?,
            facets: Facets::new(device, pixels, pixels, words)?,
            status: Buffer::storage(device, "status", Status::words(1))?,
            visibility: Buffer::storage(device, "resolve.visibility", pixels)?,
            lit: Buffer::storage(device, "resolve.lit", pixels * words)?,
            sat: Buffer::storage(device, "summed_area.sat", 1)?,
            splits: Buffer::from_slice(device, queue, "front_layer.splits", &[UNCOVERED])?,
            timer: Timer::new(gpu)?,
        })
    }

    /// Renders one strip of rows.
    fn strip(
        &mut self,
        gpu: &Gpu,
        with: &Pipelines,
        casters: &CasterBuffers,
        settings: &Settings,
        frame: Frame,
    ) -> Result<Output> {
        self.frame.write(&gpu.queue, &[frame]);
        let mut timer = self.timer.take();
        if let Some(timer) = &mut timer {
            timer.reset();
        }
        let mut encoder = gpu.encoder();
        let mut recorder = Recorder::new(&gpu.device, &mut encoder, timer.as_mut());
        self.record(&mut recorder, with, casters, settings.pixels())?;
        let dispatches = recorder.dispatches();
        if let Some(timer) = &timer {
            timer.resolve(&mut encoder);
        }
        let start = Instant::now();
        gpu.submit_and_wait(encoder)?;
        let wall_ms = start.elapsed().as_secs_f64() * 1e3;
        let head = Status::of(&self.status.read(gpu)?).head;
        let state = |s: FacetState| u64::from(head.facets[s as usize]);
        let stages = timer.as_ref().map_or(Ok(Vec::new()), |t| t.read(gpu))?;
        self.timer = timer;
        Ok(Output {
            visibility: self.visibility.read(gpu)?,
            lit: self.lit.read(gpu)?,
            words: settings.samples.words(),
            triangles: self.geometry.id_keys.read(gpu)?.into_iter().map(|key| !key).collect(),
            counts: Counts {
                empty_facets: state(FacetState::Empty),
                dark_facets: state(FacetState::Dark),
                // Without casters a facet that is not settled is lit as well.
                lit_facets: state(FacetState::Lit) + state(FacetState::Undecided),
                ..Counts::default()
            },
            lists: Vec::new(),
            stages,
            wall_ms,
            dispatches,
        })
    }

    fn record(&self, rec: &mut Recorder, with: &Pipelines, casters: &CasterBuffers, pixels: usize) -> Result<()> {
        let (frame, triangles) = (&self.frame, &casters.triangles);
        rec.clear(self.status.raw());
        self.geometry.record_setup(rec, &with.geometry, frame, casters)?;
        self.geometry.record_camera(rec, &with.geometry, frame, casters)?;
        {
            let stage = &mut rec.stage("facet_classify");
            let positions = &casters.positions;
            let around = ClassifyInputs { triangles, positions, sat: &self.sat, splits: &self.splits };
            with.classify.record_one(stage, frame, &self.geometry.id_keys, &self.facets);
            let groups = Groups::Items(pixels as u64);
            with.classify.record_classify(stage, frame, &self.samples, around, &self.facets, groups);
        }
        let resolve = &mut rec.stage("resolve");
        with.resolve.record(resolve, frame, &self.facets, &self.visibility, &self.lit, &self.status);
        Ok(())
    }
}
