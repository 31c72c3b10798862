//! A frame for the geometry stages: one closed, bumpy ball of about as many triangles as the size asks for, seen by camera
//! and light, with every stage's input made by the stages before it.

use oracle::reference::prefix_scan;
use std::rc::Rc;
use subpixel_shadows::frame::{Frame, sample_words};
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder, Stage, kernels, recorder};
use subpixel_shadows::light_view::{LightView, unit_scale};
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::prepared::CasterBuffers;
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Light, Mesh, PixelRays};
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::camera_visibility::{Blocks, CameraVisibility, Centres};
use subpixel_shadows::stages::front_layer::FrontLayer;
use subpixel_shadows::stages::light_layers::{Layers, LightLayers};
use subpixel_shadows::stages::map_moments::{MapLevels, MapMoments, MomentMeasures};
use subpixel_shadows::stages::requested_blocks::RequestedBlocks;
use subpixel_shadows::stages::silhouette_mask::SilhouetteMask;
use subpixel_shadows::stages::triangle_setup::{TriangleFacts, TriangleSetup};
use subpixel_shadows::stages::vertex_project::VertexProject;
use subpixel_shadows::{Error, Result};

/// Image and map of the frame.
pub const IMAGE: [u32; 2] = [800, 600];
/// Texels a side.
pub const MAP: u32 = 512;
/// Sizes above this are left out: the frame would be made on the CPU for longer than it is measured.
pub const MOST: usize = 1 << 20;

/// Offsets of work items and the arguments that cover them.
pub struct Work {
    offsets: Buffer<u32>,
    args: Buffer<u32>,
    /// Work items.
    pub items: usize,
}

/// Everything that the stages read and write.
pub struct Setup {
    pub prepared: Prepared,
    /// The light's view, whose rows take points of the frame.
    pub view: LightView,
    /// Rays of the image, and the scale of the frame's points.
    pub rays: (PixelRays, f64),
    pub frame: Buffer<Frame>,
    pub casters: CasterBuffers,
    pub points: Buffer<[f32; 4]>,
    pub map_points: Buffer<[f32; 4]>,
    /// Blocks of texels that are requested: all.
    pub requested: Buffer<u32>,
    pub facts: TriangleFacts,
    pub in_camera: Work,
    /// Pixels in the triangles' rectangles, halved, as a triangle fills half of a box.
    pub cells_seen: usize,
    /// Texels likewise.
    pub cells_lit: usize,
    pub in_light: Work,
    pub centres: Centres,
    pub id_keys: Buffer<u32>,
    pub layers: Layers,
    pub edge_rects: Buffer<[u32; 2]>,
    pub edge_items: Buffer<u32>,
    pub edge_work: Work,
    pub status: Buffer<u32>,
}

/// The map of a setup by its moments.
pub struct WithMoments {
    pub setup: Rc<Setup>,
    pub levels: Buffer<MapLevels>,
    pub moments: Buffer<[f32; 2]>,
    reduce: MapMoments,
}

impl WithMoments {
    /// Of a frame of about `size` triangles, made once; `None` above what [`Setup`] makes.
    pub fn new(gpu: &Gpu, size: usize) -> Result<Option<Self>> {
        let Some(setup) = Setup::new(gpu, size)? else { return Ok(None) };
        let levels = Buffer::uniform(&gpu.device, "bench.levels", 1)?;
        levels.write(&gpu.queue, &[MapLevels::new(MAP, 2.0)]);
        let reduce = MapMoments::new(&gpu.device, MomentMeasures::Depths);
        let moments = reduce.memory(&gpu.device, MAP)?;
        let made = Self { setup, levels, moments, reduce };
        submit(gpu, |stage| {
            made.record(stage);
            Ok(())
        })?;
        Ok(Some(made))
    }

    /// Records the moments.
    pub fn record(&self, stage: &mut Stage) {
        let Setup { frame, layers, .. } = &*self.setup;
        self.reduce.record(stage, frame, &self.levels, &layers.nearest_keys, &self.moments, MAP);
    }
}

fn bumpy_ball(triangles: usize) -> Mesh {
    let n = ((triangles as f64 / 2.0).sqrt() as u32).max(4);
    let mut mesh = Mesh::default();
    for j in 0..=n {
        for i in 0..n {
            let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let (turn, polar) = (u * std::f64::consts::TAU, v * std::f64::consts::PI);
            let radius = 1.0 + 0.1 * (9.0 * turn).sin() * (7.0 * polar).sin();
            let p = DVec3::new(polar.sin() * turn.cos(), polar.cos(), -polar.sin() * turn.sin()) * radius;
            mesh.positions.push(p.as_vec3().into());
        }
    }
    let at = |i: u32, j: u32| j * n + i % n;
    for j in 0..n {
        for i in 0..n {
            let quad = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
            mesh.triangles.extend([[quad[0], quad[1], quad[2]], [quad[2], quad[1], quad[3]]]);
        }
    }
    mesh
}

fn submit(gpu: &Gpu, record: impl FnOnce(&mut Stage) -> Result<()>) -> Result<()> {
    let mut encoder = gpu.encoder();
    record(&mut Recorder::new(&gpu.device, &mut encoder, None).stage("setup"))?;
    gpu.submit_and_wait(encoder)
}

impl Work {
    fn of(gpu: &Gpu, items: &Buffer<u32>, per_group: u32) -> Result<Self> {
        let scan = prefix_scan::exclusive(&items.read(gpu)?);
        let offsets = [scan.sums, vec![scan.total, 0, 0, 0, 0]].concat();
        let args = Buffer::indirect(&gpu.device, "bench.args", 4)?;
        args.write(&gpu.queue, &recorder::fold(u64::from(scan.total.div_ceil(per_group))));
        let offsets = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.offsets", &offsets)?;
        Ok(Self { offsets, args, items: scan.total as usize })
    }

    /// The arguments of a dispatch over all items.
    pub fn args(&self) -> (&subpixel_shadows::wgpu::Buffer, u64) {
        (self.args.raw(), 0)
    }

    /// The offsets of each owner's items.
    pub fn offsets(&self) -> &Buffer<u32> {
        &self.offsets
    }
}

/// The uniform of so many samples a pixel.
pub fn samples(gpu: &Gpu, count: u32) -> Result<Buffer<[f32; 4]>> {
    let samples = Buffer::uniform(&gpu.device, "bench.samples", 64)?;
    samples.write(&gpu.queue, &sample_words(&Samples::new(Default::default(), count)?));
    Ok(samples)
}

impl Setup {
    /// What the pixels of the frame see, with these samples.
    pub fn seen_with<'a>(&'a self, samples: &'a Buffer<[f32; 4]>) -> PrimaryHits<'a> {
        let triangles = &self.casters.triangles;
        PrimaryHits { samples, id_keys: &self.id_keys, triangles, points: &self.points }
    }

    /// A frame of about `size` triangles; `None` above [`MOST`].
    pub fn new(gpu: &Gpu, size: usize) -> Result<Option<Rc<Self>>> {
        Self::with(gpu, size, |_| {})
    }

    /// As [`Setup::new`], with changes to the frame.
    pub fn with(gpu: &Gpu, size: usize, change: impl FnOnce(&mut Frame)) -> Result<Option<Rc<Self>>> {
        if size > MOST {
            return Ok(None);
        }
        let (device, queue) = (&gpu.device, &gpu.queue);
        let prepared = Prepared::new(&bumpy_ball(size))?;
        let casters = prepared.upload(device, queue)?;
        let bounds = prepared.mesh().bounds().ok_or_else(|| Error::Scene("no mesh".to_owned()))?;
        let light = Light::Point { position: [2.0, 4.0, 1.0] };
        let view = LightView::fit(prepared.mesh(), &light, MAP)?;
        let samples = Samples::new(Default::default(), 32)?;
        let camera = Camera::framing(bounds.0, bounds.1);
        let mut content = Frame::new(&camera, &light, &view, bounds, IMAGE, &samples);
        let eye = camera.rays(1, 1).eye;
        let view = view.relative_to(eye, unit_scale(eye, bounds));
        content.vertex_count = casters.positions.len() as u32;
        content.triangle_count = casters.triangles.len() as u32;
        content.edge_count = casters.edges.len() as u32;
        change(&mut content);
        let frame = Buffer::uniform(device, "bench.frame", 1)?;
        frame.write(queue, &[content]);
        let (vertices, triangles, edges) = (casters.positions.len(), casters.triangles.len(), casters.edges.len());
        let pixels = (IMAGE[0] * IMAGE[1]) as usize;
        let points = Buffer::storage(device, "bench.points", vertices)?;
        let map_points = Buffer::storage(device, "bench.map_points", vertices)?;
        let facts = TriangleFacts::new(device, triangles)?;
        let raw = &casters.triangles;
        let requested = RequestedBlocks::memory(device, MAP as usize)?;
        submit(gpu, |s| {
            let (project, setup) = (VertexProject::new(device), TriangleSetup::new(device));
            project.record_place(s, &frame, &casters.positions, &points);
            project.record_project(s, &frame, &points, &map_points, vertices)?;
            setup.record_camera(s, &frame, raw, &points, &facts, triangles)?;
            setup.record_light(s, &frame, raw, &points, &map_points, &requested, &facts, triangles)?;
            Ok(())
        })?;
        let in_camera = Work::of(gpu, &facts.camera_items, kernels::camera_visibility::WORKGROUP)?;
        let in_light = Work::of(gpu, &facts.light_items, kernels::light_layers::WORKGROUP)?;
        let cells = |rects: &Buffer<[u32; 2]>| -> Result<usize> {
            let side = |low: u32, high: u32| (high & 0xffff) as usize + 1 - (low & 0xffff) as usize;
            let filled = |[low, high]: &&[u32; 2]| low & 0xffff <= high & 0xffff;
            let rects = rects.read(gpu)?;
            Ok(rects.iter().filter(filled).map(|&[l, h]| side(l, h) * side(l >> 16, h >> 16)).sum::<usize>() / 2)
        };
        let (cells_seen, cells_lit) = (cells(&facts.camera_rects)?, cells(&facts.light_rects)?);
        let edge_rects = Buffer::storage(device, "bench.edge_rects", edges)?;
        let edge_items = Buffer::storage(device, "bench.edge_items", edges)?;
        let status = Buffer::storage(device, "bench.status", 64)?;
        submit(gpu, |s| {
            let (facing, map, rects, items) = (&facts.facing, &map_points, &edge_rects, &edge_items);
            let stage = SilhouetteMask::new(device);
            stage.record_classify(s, &frame, &casters.edges, facing, map, &requested, rects, items, &status, edges)?;
            Ok(())
        })?;
        let edge_work = Work::of(gpu, &edge_items, kernels::silhouette_mask::WORKGROUP)?;
        let rays = (camera.rays(IMAGE[0], IMAGE[1]), unit_scale(eye, bounds));
        let setup = Self {
            rays,
            frame,
            points,
            map_points,
            requested,
            facts,
            in_camera,
            cells_seen,
            cells_lit,
            in_light,
            centres: Centres::new(device, &gpu.queue, pixels)?,
            id_keys: Buffer::storage(device, "bench.id_keys", pixels)?,
            layers: Layers::new(device, MAP as usize)?,
            edge_rects,
            edge_items,
            edge_work,
            status,
            casters,
            prepared,
            view,
        };
        submit(gpu, |s| {
            CameraVisibility::new(device).record(
                s,
                &setup.frame,
                setup.seen(),
                &setup.casters.positions,
                &setup.centres,
                &setup.id_keys,
            )?;
            LightLayers::new(device).record(s, &setup.frame, setup.lit(), &setup.layers);
            FrontLayer::new(device).record_settle(s, &setup.frame, &setup.layers);
            Ok(())
        })?;
        Ok(Some(Rc::new(setup)))
    }

    /// What the camera sees of each triangle.
    pub fn seen(&self) -> Blocks<'_> {
        self.blocks(&self.points, &self.facts.camera_rects, &self.in_camera)
    }

    /// What the light sees.
    pub fn lit(&self) -> Blocks<'_> {
        self.blocks(&self.map_points, &self.facts.light_rects, &self.in_light)
    }

    fn blocks<'a>(&'a self, points: &'a Buffer<[f32; 4]>, rects: &'a Buffer<[u32; 2]>, work: &'a Work) -> Blocks<'a> {
        let triangles = &self.casters.triangles;
        Blocks { triangles, points, rects, facing: &self.facts.facing, offsets: &work.offsets, args: work.args() }
    }
}
