//! What `facet-masks` needs where the plan has proved that nothing casts a shadow: which triangle each pixel sees, and
//! whether it faces the light. The same stages decide it, so the picture is the same as that of the whole method.

use super::facet_masks::{Settings, status};
use super::geometry::{Geometry, GeometryPipelines};
use super::prepared::{CasterBuffers, Prepared};
use super::render::{Counts, Output};
use crate::Result;
use crate::frame::{Frame, sample_words};
use crate::gpu::{Buffer, Gpu, Recorder, Timer};
use crate::light_view::LightView;
use crate::scene::{Camera, Light};
use crate::stages::facet_classify::{FacetClassify, Facets, State, Surroundings};
use crate::stages::front_layer::UNCOVERED;
use crate::stages::resolve::Resolve;
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

/// Renders a frame in which nothing casts a shadow: facets that face the light are lit, the others dark. Also returns the
/// facets with their masks.
///
/// # Errors
/// As [`super::render::Renderer::render`].
pub fn render(
    gpu: &Gpu,
    prepared: &Prepared,
    settings: &Settings,
    camera: &Camera,
    light: &Light,
) -> Result<(Output, Facets)> {
    settings.check()?;
    let casters = prepared.upload(&gpu.device, &gpu.queue)?;
    let frame = frame(prepared, settings, camera, light, &casters)?;
    let mut timer = Timer::new(gpu);
    let mut encoder = gpu.encoder();
    let mut recorder = Recorder::new(&gpu.device, &mut encoder, timer.as_mut());
    let made = record(gpu, &mut recorder, &casters, settings, frame)?;
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
    frame.facets_total = settings.size[0] * settings.size[1];
    frame.facet_count = frame.facets_total;
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

fn record(gpu: &Gpu, rec: &mut Recorder, casters: &CasterBuffers, settings: &Settings, frame: Frame) -> Result<Made> {
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
    let with = GeometryPipelines::new(device);
    let geometry = &made.geometry;
    geometry.record_setup(rec, &with, frame, casters)?;
    geometry.record_camera(rec, &with, frame, casters)?;
    {
        let stage = &mut rec.stage("facet_classify");
        let classify = FacetClassify::new(device, words);
        let around = Surroundings { triangles, positions: casters.positions.raw(), sat: &sat, splits: &splits };
        classify.record_one(stage, frame, &geometry.id_keys, &made.facets)?;
        classify.record_classify(stage, frame, samples.raw(), around, &made.facets, pixels)?;
    }
    let resolve = Resolve::new(device, words);
    resolve.record(&mut rec.stage("resolve"), frame, &made.facets, &made.visibility, &made.lit, &made.status)?;
    Ok(made)
}
