//! What the tests of the geometry stages share: meshes that are hard to get right, and a run of all six stages in order,
//! with the offsets and arguments between them made here.

pub use super::shapes::*;
use super::{NO_TABLE, run};
use bytemuck::Pod;
use oracle::reference::front_layer::Margin;
use oracle::reference::light_layers::{self, Layer};
use oracle::reference::prefix_scan;
use oracle::reference::triangle_setup::{self, Triangle};
use oracle::reference::vertex_project::{self, Vertex};
use oracle::reference::view::View;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::recorder::fold_within;
use subpixel_shadows::gpu::{Buffer, Gpu, kernels};
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::geometry::SetupOf;
use subpixel_shadows::methods::prepared::{marked_triangles, padded};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{
    AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Camera, Light, Mesh, Roles, TestedTriangle,
};
use subpixel_shadows::stages::camera_visibility::{Blocks, CameraVisibility, Centres};
use subpixel_shadows::stages::front_layer::FrontLayer;
use subpixel_shadows::stages::light_layers::{Layers, LightLayers};
use subpixel_shadows::stages::requested_blocks::RequestedBlocks;
use subpixel_shadows::stages::silhouette_mask::SilhouetteMask;
use subpixel_shadows::stages::triangle_setup::{TriangleFacts, TriangleSetup};
use subpixel_shadows::stages::vertex_project::VertexProject;
use subpixel_shadows::status_word;

/// Everything a frame is made from.
#[derive(Clone)]
pub struct Case {
    /// Canonical, with its edges.
    pub prepared: Prepared,
    /// Positions on the GPU, if not those of the mesh.
    pub positions: Option<Vec<[f32; 3]>>,
    /// The camera.
    pub camera: Camera,
    /// The light.
    pub light: Light,
    /// Image size.
    pub image: [u32; 2],
    /// Map size.
    pub map: u32,
    /// Leave out what faces away from the light.
    pub cull_back: bool,
    /// Leave out of the camera's view what faces away from it.
    pub backs_hidden: bool,
    /// Validity masks are kept: what is left out may cut facets, and keeps its texels.
    pub validity: bool,
    /// Blocks of texels that are requested; `None`: all.
    pub requested: Option<Vec<bool>>,
}

/// Every third triangle of a mesh with holes by one of two maps.
pub fn holes(mesh: &Mesh) -> AlphaTested {
    let map = |k: usize| AlphaMap {
        size: [5, 4],
        alpha: (0..20usize).map(|t| (t * (67 + 30 * k) % 256) as u8).collect(),
        cutoff: 0.5,
        filter: [AlphaFilter::Nearest, AlphaFilter::Bilinear][k],
        wrap: [AlphaWrap::Repeat, AlphaWrap::Mirror],
    };
    let of = |triangle: u32| {
        let uv = [[0.0, 0.25], [1.5, -0.5], [0.75, 2.0]];
        TestedTriangle { triangle, map: triangle % 2, uv, roles: Roles::ALL }
    };
    let triangles = (0..mesh.triangles.len() as u32).step_by(3).map(of).collect();
    AlphaTested { maps: vec![map(0), map(1)], triangles }
}

impl Case {
    /// A case framed from the mesh's bounds.
    pub fn new(mesh: &Mesh, light: Light, image: [u32; 2], map: u32) -> Self {
        let (lo, hi) = mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let camera = Camera::framing(lo, hi);
        Self {
            prepared: Prepared::new(mesh).expect("a sound mesh"),
            positions: None,
            camera,
            light,
            image,
            map,
            cull_back: false,
            backs_hidden: false,
            validity: false,
            requested: None,
        }
    }

    /// The same with holes in every third triangle.
    pub fn with_holes(self) -> Self {
        let mesh = self.prepared.mesh();
        let prepared = Prepared::with_alpha(mesh, &holes(mesh)).expect("a sound mesh");
        Self { prepared, ..self }
    }

    /// The requested blocks as the stages read them.
    fn requested_words(&self) -> Vec<u32> {
        let mut words = vec![0; RequestedBlocks::words(self.map as usize)];
        let Some(blocks) = &self.requested else { return words };
        let across = self.map.div_ceil(8) as usize;
        words[0] = 1;
        for k in (0..blocks.len()).filter(|&k| blocks[k]) {
            words[1 + k / across * across.div_ceil(32) + k % across / 32] |= 1 << (k % across % 32);
        }
        words
    }

    /// Positions the stages read.
    pub fn positions(&self) -> &[[f32; 3]] {
        self.positions.as_deref().unwrap_or(&self.prepared.mesh().positions)
    }

    fn bounds(&self) -> (DVec3, DVec3) {
        self.prepared.mesh().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE))
    }

    fn light_view(&self) -> LightView {
        LightView::fit(self.prepared.mesh(), &self.light, self.map).expect("a light view")
    }

    /// The frame in `f64`.
    pub fn view(&self) -> View {
        View::new(&self.camera, &self.light, &self.light_view(), self.bounds(), self.image, self.cull_back)
    }

    /// The frame of the kernels.
    pub fn frame(&self) -> Frame {
        let samples = Samples::new(Default::default(), 8).expect("a pattern");
        let view = self.light_view();
        let mut frame = Frame::new(&self.camera, &self.light, &view, self.bounds(), self.image, &samples);
        frame.flags |= if self.cull_back { Frame::CULL_BACK } else { 0 };
        frame.flags |= if self.backs_hidden { Frame::BACKS_HIDDEN } else { 0 };
        frame.flags |= if self.validity { Frame::VALIDITY } else { 0 };
        frame.flags |= Frame::CUT_LAYERS;
        frame.vertex_count = self.positions().len() as u32;
        frame.triangle_count = self.prepared.mesh().triangles.len() as u32;
        frame.edge_count = self.prepared.edges.len() as u32;
        frame
    }

    /// What the stages are defined to find.
    pub fn wanted(&self) -> Wanted {
        let view = self.view();
        let vertices = vertex_project::project(&view, self.positions());
        let mut triangles =
            triangle_setup::setup(&view, &vertices, &self.prepared.mesh().triangles, &self.prepared.bodies);
        triangle_setup::mark_tested(&mut triangles, self.prepared.alpha());
        Wanted { view, vertices, triangles }
    }
}

/// The definitions of the first two stages.
pub struct Wanted {
    /// The frame.
    pub view: View,
    /// Of `vertex_project`.
    pub vertices: Vec<Vertex>,
    /// Of `triangle_setup`.
    pub triangles: Vec<Triangle>,
}

impl Wanted {
    /// The definition of `light_layers`.
    pub fn layers(&self, guard: f64, tie: f64) -> Vec<Layer> {
        light_layers::layers(&self.triangles, self.view.map.map_size, guard, tie)
    }
}

/// What all six stages wrote.
#[derive(Clone, PartialEq)]
pub struct Ran {
    pub frame: Frame,
    pub points: Vec<[f32; 4]>,
    pub map_points: Vec<[f32; 4]>,
    pub facing: Vec<u32>,
    pub camera_rects: Vec<[u32; 2]>,
    pub light_rects: Vec<[u32; 2]>,
    pub camera_items: Vec<u32>,
    pub light_items: Vec<u32>,
    pub seen_keys: Vec<[u32; 2]>,
    pub id_keys: Vec<u32>,
    /// Pixels and triangles that single precision left open.
    pub noted: u32,
    pub nearest_keys: Vec<u32>,
    pub second_keys: Vec<u32>,
    /// Marked texels after light_layers, silhouette_mask and front_layer.
    pub marks: [Vec<bool>; 3],
    pub edge_rects: Vec<[u32; 2]>,
    pub edge_items: Vec<u32>,
    pub silhouettes: u32,
    pub splits: Vec<f32>,
}

impl Ran {
    /// The margins the kernels test with.
    pub fn margin(&self) -> Margin {
        Margin { texels: f64::from(self.frame.map_margin), depth: f64::from(self.frame.depth_margin) }
    }

    /// Everything as words, to compare runs bit by bit.
    pub fn words(&self) -> Vec<u32> {
        let mut words = Vec::new();
        words.extend(self.points.iter().flatten().map(|f| f.to_bits()));
        words.extend(self.map_points.iter().flatten().map(|f| f.to_bits()));
        words.extend(self.splits.iter().map(|f| f.to_bits()));
        for rects in [&self.camera_rects, &self.light_rects, &self.edge_rects] {
            words.extend(rects.iter().flatten());
        }
        words.extend(self.seen_keys.iter().flatten());
        for list in [
            &self.facing,
            &self.camera_items,
            &self.light_items,
            &self.id_keys,
            &self.nearest_keys,
            &self.second_keys,
            &self.edge_items,
        ] {
            words.extend(list);
        }
        words.extend(self.marks.iter().flatten().map(|&m| u32::from(m)));
        words.push(self.silhouettes);
        words
    }
}

/// Corners of a packed rectangle; `None` if it is empty.
pub fn unpack([low, high]: [u32; 2]) -> Option<[u32; 4]> {
    let r = [low & 0xffff, low >> 16, high & 0xffff, high >> 16];
    (r[0] <= r[2]).then_some(r)
}

const SPARE: u8 = 0xab;

fn poisoned<T: Pod>(gpu: &Gpu, len: usize) -> Buffer<T> {
    let buffer = Buffer::storage(&gpu.device, "test.output", len + 1).expect("memory");
    gpu.queue.write_buffer(buffer.raw(), 0, &vec![SPARE; buffer.bytes() as usize]);
    buffer
}

/// Reads all but the spare element at the end, which nothing may have touched.
#[track_caller]
fn read<T: Pod + PartialEq + std::fmt::Debug>(gpu: &Gpu, buffer: &Buffer<T>) -> Vec<T> {
    let mut all = buffer.read(gpu).expect("readback");
    let spare = all.pop().expect("a spare element");
    assert!(bytemuck::bytes_of(&spare).iter().all(|&b| b == SPARE), "written past the end: {spare:?}");
    all
}

/// Offsets of a list of counts, and arguments that cover them all.
pub fn work(gpu: &Gpu, items: &[u32], per_group: u32) -> (Buffer<u32>, Buffer<u32>) {
    let scan = prefix_scan::exclusive(items);
    let offsets = [scan.sums, vec![scan.total, 0], NO_TABLE.to_vec()].concat();
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let args = fold_within(u64::from(scan.total.div_ceil(per_group)), most);
    let buffer = Buffer::indirect(&gpu.device, "test.args", 4).expect("memory");
    buffer.write(&gpu.queue, &args);
    (super::upload(gpu, &offsets), buffer)
}

/// Balls over a ground with what turns away of them as casters, left out, and left out but for keeping its texels, since it may cut
/// facets.
pub fn with_what_turns_away(gpu: &Gpu, seed: u64) -> [Ran; 3] {
    let mut balls = mesh("closed balls", seed);
    let ground = balls.ground_below().expect("a ground");
    balls.add_ground(&ground);
    let [with_all, culled, cutting] = [(false, false), (true, false), (true, true)].map(|(cull_back, validity)| {
        run_all(gpu, &Case { cull_back, validity, ..Case::new(&balls, light(seed), [1, 1], 100) })
    });
    assert!(cutting.light_rects != culled.light_rects && cutting.light_rects == with_all.light_rects);
    [with_all, culled, cutting]
}

/// Memory of the stages that set casters up.
struct SetUp {
    points: Buffer<[f32; 4]>,
    map_points: Buffer<[f32; 4]>,
    facts: TriangleFacts,
}

/// Runs these stages for one view or both, one frame after another, in the same memory.
fn set_up(gpu: &Gpu, case: &Case, turns: &[(SetupOf, Frame)]) -> SetUp {
    let device = &gpu.device;
    let positions = super::upload(gpu, &padded(case.positions()));
    let triangles = super::upload(gpu, &marked_triangles(&case.prepared, case.prepared.mesh().triangles.len()));
    let (vertex_count, count) = (positions.len(), triangles.len());
    let (points, map_points) = (poisoned(gpu, vertex_count), poisoned(gpu, vertex_count));
    let facts = TriangleFacts {
        facing: poisoned(gpu, count),
        camera_rects: poisoned(gpu, count),
        light_rects: poisoned(gpu, count),
        camera_items: poisoned(gpu, count),
        light_items: poisoned(gpu, count),
    };
    let requested = super::upload(gpu, &case.requested_words());
    let (project, setup) = (VertexProject::new(device), TriangleSetup::new(device));
    for (of, frame) in turns {
        let uniform = Buffer::uniform(device, "frame", 1).expect("memory");
        uniform.write(&gpu.queue, &[*frame]);
        if *of != SetupOf::Light {
            run(gpu, |s| project.record_place(s, &uniform, &positions, &points));
            run(gpu, |s| setup.record_camera(s, &uniform, &triangles, &points, &facts, count));
        }
        if *of != SetupOf::Camera {
            run(gpu, |s| project.record_project(s, &uniform, &points, &map_points, vertex_count));
            run(gpu, |s| setup.record_light(s, &uniform, &triangles, &points, &map_points, &requested, &facts, count));
        }
    }
    SetUp { points, map_points, facts }
}

/// Bits that these stages leave after one frame after another: of the camera's view, and of the light's.
pub fn set_up_in_turn(gpu: &Gpu, case: &Case, turns: &[(SetupOf, Frame)]) -> [Vec<u32>; 2] {
    let SetUp { points, map_points, facts } = set_up(gpu, case, turns);
    let bits = |points: &Buffer<[f32; 4]>| read(gpu, points).into_iter().flatten().map(f32::to_bits).collect();
    let rects = |rects: &Buffer<[u32; 2]>| read(gpu, rects).into_iter().flatten().collect::<Vec<u32>>();
    [
        [bits(&points), rects(&facts.camera_rects), read(gpu, &facts.camera_items)].concat(),
        [bits(&map_points), read(gpu, &facts.facing), rects(&facts.light_rects), read(gpu, &facts.light_items)]
            .concat(),
    ]
}

/// Runs the six stages.
pub fn run_all(gpu: &Gpu, case: &Case) -> Ran {
    let device = &gpu.device;
    let frame = case.frame();
    let uniform = Buffer::uniform(device, "frame", 1).expect("memory");
    uniform.write(&gpu.queue, &[frame]);
    let frame_buffer = &uniform;
    let positions = super::upload(gpu, &padded(case.positions()));
    let triangles = super::upload(gpu, &marked_triangles(&case.prepared, case.prepared.mesh().triangles.len()));
    let edges = super::upload(gpu, &case.prepared.edges);
    let edge_count = edges.len();

    let SetUp { points, map_points, facts } = set_up(gpu, case, &[(SetupOf::Both, frame)]);
    let (camera_items, light_items) = (read(gpu, &facts.camera_items), read(gpu, &facts.light_items));

    let (offsets, args) = work(gpu, &camera_items, kernels::camera_visibility::WORKGROUP);
    let pixels = (case.image[0] * case.image[1]) as usize;
    let in_camera = Blocks {
        triangles: &triangles,
        points: &points,
        rects: &facts.camera_rects,
        facing: &facts.facing,
        offsets: &offsets,
        args: (args.raw(), 0),
    };
    let (keys, id_keys) = (poisoned(gpu, pixels), poisoned(gpu, pixels));
    keys.write(&gpu.queue, &vec![[0; 2]; pixels]);
    id_keys.write(&gpu.queue, &vec![0; pixels]);
    let mut centres = Centres::new(device, &gpu.queue, pixels).expect("memory");
    centres.keys = keys;
    let visibility = CameraVisibility::new(device);
    run(gpu, |s| visibility.record(s, frame_buffer, in_camera, &positions, &centres, &id_keys));
    let (seen_keys, id_keys) = (read(gpu, &centres.keys), read(gpu, &id_keys));

    let (offsets, args) = work(gpu, &light_items, kernels::light_layers::WORKGROUP);
    let in_light = Blocks {
        triangles: &triangles,
        points: &map_points,
        rects: &facts.light_rects,
        facing: &facts.facing,
        offsets: &offsets,
        args: (args.raw(), 0),
    };
    let layers = Layers::new(device, case.map as usize).expect("memory");
    let splits = poisoned(gpu, layers.splits.len());
    let layers = Layers { splits, ..layers };
    let stage = LightLayers::new(device);
    run(gpu, |s| {
        stage.record(s, frame_buffer, in_light, &layers);
        stage.record_cut(s, frame_buffer, in_light, &layers);
    });
    let after_layers = marks(gpu, &layers.mask, case.map);

    let (edge_rects, edge_items) = (poisoned(gpu, edge_count), poisoned(gpu, edge_count));
    let status = super::upload(gpu, &[0u32; 32]);
    let requested = super::upload(gpu, &case.requested_words());
    let stage = SilhouetteMask::new(device);
    run(gpu, |s| {
        let (facing, map, rects, items) = (&facts.facing, &map_points, &edge_rects, &edge_items);
        stage.record_classify(s, frame_buffer, &edges, facing, map, &requested, rects, items, &status, edge_count)
    });
    let items = read(gpu, &edge_items);
    let (edge_offsets, edge_args) = work(gpu, &items, kernels::silhouette_mask::WORKGROUP);
    run(gpu, |s| {
        let args = (edge_args.raw(), 0);
        stage.record_raster(s, frame_buffer, &edges, &map_points, &edge_rects, &edge_offsets, args, &layers)
    });
    let after_silhouettes = marks(gpu, &layers.mask, case.map);

    let stage = FrontLayer::new(device);
    run(gpu, |s| stage.record_check(s, frame_buffer, in_light, &layers));
    run(gpu, |s| {
        // The stage takes one invocation a texel, whatever the buffer's length.
        stage.record_settle(s, frame_buffer, &layers)
    });
    let after_front = marks(gpu, &layers.mask, case.map);
    let all = "readback";
    Ran {
        frame,
        points: read(gpu, &points),
        map_points: read(gpu, &map_points),
        facing: read(gpu, &facts.facing),
        camera_rects: read(gpu, &facts.camera_rects),
        light_rects: read(gpu, &facts.light_rects),
        camera_items,
        light_items,
        seen_keys,
        id_keys,
        noted: centres.doubts.read(gpu).expect(all)[0],
        nearest_keys: layers.nearest_keys.read(gpu).expect(all),
        second_keys: layers.second_keys.read(gpu).expect(all),
        marks: [after_layers, after_silhouettes, after_front],
        edge_rects: read(gpu, &edge_rects),
        edge_items: items,
        silhouettes: status.read(gpu).expect(all)[status_word!(silhouette_edges)],
        splits: read(gpu, &layers.splits),
    }
}

fn marks(gpu: &Gpu, mask: &Buffer<u32>, size: u32) -> Vec<bool> {
    let words = mask.read(gpu).expect("readback");
    let row = size.div_ceil(32);
    (0..size * size).map(|t| words[(t / size * row + t % size / 32) as usize] >> (t % size % 32) & 1 == 1).collect()
}
