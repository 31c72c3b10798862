//! What `facet-masks` needs where the plan has proved that nothing casts a shadow: which triangle each pixel sees, and
//! whether it faces the light. The same stages decide it, so the picture is the same as that of the whole method.

use super::facet_masks::{Settings, status};
use super::geometry::{Geometry, GeometryPipelines};
use super::prepared::{CasterBuffers, Prepared};
use super::render::{Counts, Output};
use super::strips::{Rows, Strips};
use crate::frame::{Frame, sample_words};
use crate::gpu::{Buffer, Gpu, Groups, Recorder, Timer};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use crate::stages::facet_classify::{FacetClassify, Facets, State, Surroundings};
use crate::stages::front_layer::UNCOVERED;
use crate::stages::resolve::Resolve;
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
pub type Look<'a> = &'a mut dyn FnMut(&Facets, Rows) -> Result<()>;

/// Renders a frame in which nothing casts a shadow: facets that face the light are lit, the others dark. In strips of rows where one
/// binding does not hold the facets.
///
/// # Errors
/// As [`super::render::Renderer::render`].
pub fn render(gpu: &Gpu, prepared: &Prepared, settings: &Settings, camera: &Camera, light: &Light) -> Result<Output> {
    render_and(gpu, prepared, settings, camera, light, &mut |_, _| Ok(()))
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
    look: Look,
) -> Result<Output> {
    settings.check()?;
    let casters = prepared.upload(&gpu.device, &gpu.queue)?;
    let frame = frame(prepared, settings, camera, light, &casters)?;
    let with = Pipelines::new(gpu, settings);
    let mut strips = Strips::new(settings.size, 1);
    'image: loop {
        let mut image: Option<Output> = None;
        for rows in strips.rows() {
            let of_strip = Settings { size: strips.size(), ..settings.clone() };
            let mut frame = Frame { image_size: of_strip.size, first_row: rows.first, ..frame };
            frame.facets_total = of_strip.pixels() as u32;
            frame.facet_count = frame.facets_total;
            let (output, facets) = match strip(gpu, &with, &casters, &of_strip, frame) {
                Err(error @ Error::Memory { .. }) => {
                    strips = strips.more().ok_or(error)?;
                    continue 'image;
                }
                made => made?,
            };
            look(&facets, rows)?;
            match &mut image {
                None => image = Some(output),
                Some(image) => image.add_rows(output, rows),
            }
        }
        return image.ok_or_else(|| Error::Config("an image without rows".to_owned()));
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
        Self {
            geometry: GeometryPipelines::new(device),
            classify: FacetClassify::new(device, words),
            resolve: Resolve::new(device, words),
        }
    }
}

/// One strip of rows, and its facets.
fn strip(
    gpu: &Gpu,
    with: &Pipelines,
    casters: &CasterBuffers,
    settings: &Settings,
    frame: Frame,
) -> Result<(Output, Facets)> {
    let mut timer = Timer::new(gpu)?;
    let mut encoder = gpu.encoder();
    let mut recorder = Recorder::new(&gpu.device, &mut encoder, timer.as_mut());
    let made = record(gpu, &mut recorder, with, casters, settings, frame)?;
    let dispatches = recorder.dispatches();
    if let Some(timer) = &timer {
        timer.resolve(&mut encoder);
    }
    let start = Instant::now();
    gpu.submit_and_wait(encoder)?;
    let wall_ms = start.elapsed().as_secs_f64() * 1e3;
    let words = made.status.read(gpu)?;
    let state = |s: State| u64::from(words[status::STATES + s as usize]);
    let output = Output {
        visibility: made.visibility.read(gpu)?,
        lit: made.lit.read(gpu)?,
        words: settings.samples.words(),
        triangles: made.geometry.id_keys.read(gpu)?.into_iter().map(|key| !key).collect(),
        counts: Counts {
            empty_facets: state(State::Empty),
            dark_facets: state(State::Dark),
            // Without casters a facet that is not settled is lit as well.
            lit_facets: state(State::Lit) + state(State::Undecided),
            ..Counts::default()
        },
        lists: Vec::new(),
        stages: timer.as_ref().map_or(Ok(Vec::new()), |t| t.read(gpu))?,
        wall_ms,
        dispatches,
    };
    Ok((output, made.facets))
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

/// What a frame leaves behind.
struct Made {
    geometry: Geometry,
    facets: Facets,
    status: Buffer<u32>,
    visibility: Buffer<f32>,
    lit: Buffer<u32>,
}

fn record(
    gpu: &Gpu,
    rec: &mut Recorder,
    with: &Pipelines,
    casters: &CasterBuffers,
    settings: &Settings,
    frame: Frame,
) -> Result<Made> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let pixels = settings.size.iter().map(|&s| s as usize).product::<usize>();
    let words = settings.samples.words();
    let frame_buffer = Buffer::uniform(device, "frame", 1)?;
    frame_buffer.write(queue, &[frame]);
    let samples = Buffer::uniform(device, "samples", 64)?;
    samples.write(queue, &sample_words(&settings.samples));
    let made = Made {
        geometry: Geometry::new(device, queue, casters, pixels, settings.texels())?,
        facets: Facets::new(device, pixels, pixels, words as usize)?,
        status: Buffer::storage(device, "status", status::BANDS + 4)?,
        visibility: Buffer::storage(device, "resolve.visibility", pixels)?,
        lit: Buffer::storage(device, "resolve.lit", pixels * words as usize)?,
    };
    // The light view's one texel: no mark in the table, no caster.
    let sat = Buffer::storage(device, "summed_area.sat", 1)?;
    let splits = Buffer::from_slice(device, queue, "front_layer.splits", &[UNCOVERED])?;
    let (frame, triangles) = (frame_buffer.raw(), casters.triangles.raw());
    let geometry = &made.geometry;
    geometry.record_setup(rec, &with.geometry, frame, casters)?;
    geometry.record_camera(rec, &with.geometry, frame, casters)?;
    {
        let stage = &mut rec.stage("facet_classify");
        let around = Surroundings { triangles, positions: casters.positions.raw(), sat: &sat, splits: &splits };
        with.classify.record_one(stage, frame, &geometry.id_keys, &made.facets)?;
        with.classify.record_classify(
            stage,
            frame,
            samples.raw(),
            around,
            &made.facets,
            Groups::Items(pixels as u64),
        )?;
    }
    with.resolve.record(&mut rec.stage("resolve"), frame, &made.facets, &made.visibility, &made.lit, &made.status)?;
    Ok(made)
}
