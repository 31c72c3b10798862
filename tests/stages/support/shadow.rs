//! What the tests of the shadow stages share: random scenes, and stages run one at a time on lists made by hand.

pub use super::meshes::*;
pub use super::pair_lists::*;
use super::{POISON, Random, run};
use oracle::reference::camera_visibility::{DepthMargin, nearest};
use oracle::reference::front_layer::{Margin, Split};
use oracle::reference::prefix_scan::exclusive;
use oracle::reference::summed_area::table;
use oracle::reference::triangle_setup::{Triangle, mark_tested, setup};
use oracle::reference::vertex_project::project;
use oracle::reference::view::View;
use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock};
use subpixel_shadows::frame::{Frame, sample_box, sample_words};
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::{Buffer, Gpu, Groups, recorder};
use subpixel_shadows::light_view::{LightView, SplitPlan};
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::prepared::CasterBuffers;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::facet_classify::{ClassifyInputs, Facet, FacetClassify, Facets};
use subpixel_shadows::stages::front_layer::{MARKED, UNCOVERED};
use subpixel_shadows::stages::pixel_texel_pairs::{PairLists, PairTiles, PixelTexelPairs};
use subpixel_shadows::stages::requested_blocks::RequestedBlocks;
use subpixel_shadows::stages::triangle_setup::{TriangleFacts, TriangleSetup};
use subpixel_shadows::stages::triangle_texel_pairs::TriangleTexelPairs;
use subpixel_shadows::stages::vertex_project::VertexProject;
use subpixel_shadows::wgpu;

/// The low-discrepancy pattern.
pub fn samples(count: u32) -> Samples {
    Samples::new(Pattern::LowDiscrepancy, count).expect("a pattern")
}

/// Pipelines of a stage, made once for each device and number of mask words.
pub struct Pipelines<T: 'static>(Mutex<BTreeMap<(u32, usize), &'static T>>);

impl<T> Pipelines<T> {
    pub const fn new() -> Self {
        Self(Mutex::new(BTreeMap::new()))
    }

    pub fn get(&self, gpu: &Gpu, words: usize, make: impl FnOnce() -> T) -> &'static T {
        let key = (gpu.device.limits().max_compute_workgroups_per_dimension, words);
        let mut made = self.0.lock().expect("no test panicked while making a pipeline");
        made.entry(key).or_insert_with(|| Box::leak(Box::new(make())))
    }
}

/// A mesh under camera and light, its vertices and triangles set up on the GPU and by their definitions.
pub struct World {
    pub gpu: &'static Gpu,
    pub prepared: Prepared,
    pub camera: Camera,
    pub light: Light,
    pub samples: Samples,
    pub frame: Frame,
    pub casters: CasterBuffers,
    pub map_points: Buffer<[f32; 4]>,
    pub facts: TriangleFacts,
    pub view: View,
    pub triangles: Vec<Triangle>,
}

struct Front {
    project: VertexProject,
    setup: TriangleSetup,
}

impl World {
    pub fn new(
        gpu: &'static Gpu,
        mesh: &Mesh,
        camera: Camera,
        light: Light,
        size: [u32; 2],
        map: u32,
        samples: Samples,
    ) -> Self {
        Self::in_slice(gpu, mesh, (camera, light), size, map, samples, None)
    }

    /// The same of a mesh that is prepared.
    pub fn of(
        gpu: &'static Gpu,
        prepared: Prepared,
        (camera, light): (Camera, Light),
        size: [u32; 2],
        map: u32,
        samples: Samples,
        slice: Option<(SplitPlan, usize)>,
    ) -> Self {
        let fitted = LightView::fit(prepared.mesh(), &light, map).expect("a light view");
        let bounds = prepared.mesh().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let view = slice.map_or(fitted, |(plan, k)| fitted.slices(&camera, size, bounds, &plan, 0.0, None)[k]);
        Self::in_view(gpu, prepared, (camera, light), size, samples, view)
    }

    /// The same in a view of the light.
    pub(super) fn in_view(
        gpu: &'static Gpu,
        prepared: Prepared,
        (camera, light): (Camera, Light),
        size: [u32; 2],
        samples: Samples,
        fitted: LightView,
    ) -> Self {
        let map = fitted.map_size;
        static FRONT: Pipelines<Front> = Pipelines::new();
        let make = || Front { project: VertexProject::new(&gpu.device), setup: TriangleSetup::new(&gpu.device) };
        let front = FRONT.get(gpu, 0, make);
        let casters = prepared.upload(&gpu.device, &gpu.queue).expect("memory");
        let bounds = prepared.mesh().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let mut frame = Frame::new(&camera, &light, &fitted, bounds, size, &samples);
        let (vertices, triangles) = (prepared.mesh().positions.len(), prepared.mesh().triangles.len());
        (frame.vertex_count, frame.triangle_count) = (vertices as u32, triangles as u32);
        let points = Buffer::storage(&gpu.device, "test.points", vertices).expect("memory");
        let map_points = Buffer::storage(&gpu.device, "test.map_points", vertices).expect("memory");
        let facts = TriangleFacts::new(&gpu.device, triangles).expect("memory");
        let uniform = uniform(gpu, &frame);
        let requested = RequestedBlocks::memory(&gpu.device, map as usize).expect("memory");
        run(gpu, |s| {
            front.project.record_place(s, &uniform, &casters.positions, &points);
            front.project.record_project(s, &uniform, &points, &map_points, vertices)?;
            let (indices, map) = (&casters.triangles, &map_points);
            front.setup.record_camera(s, &uniform, indices, &points, &facts, triangles)?;
            front.setup.record_light(s, &uniform, indices, &points, map, &requested, &facts, triangles)
        });
        let view = View::new(&camera, &light, &fitted, bounds, size, false);
        let projected = project(&view, &prepared.mesh().positions);
        let mut set_up = setup(&view, &projected, &prepared.mesh().triangles, &prepared.bodies);
        mark_tested(&mut set_up, prepared.alpha());
        Self { gpu, prepared, camera, light, samples, frame, casters, map_points, facts, view, triangles: set_up }
    }

    pub fn words(&self) -> usize {
        self.samples.words() as usize
    }

    pub fn margin(&self) -> Margin {
        Margin { texels: f64::from(self.frame.map_margin), depth: f64::from(self.frame.depth_margin) }
    }

    /// One facet a pixel: the triangle at its centre.
    pub fn seen(&self) -> Vec<(u32, Option<u32>)> {
        let seen = nearest(&self.view, &self.triangles, DepthMargin { edge: 0.0, depth: 0.0 });
        (0u32..).zip(seen).map(|(pixel, s)| (pixel, s.triangle)).collect()
    }

    /// `count` facets of a random pixel and a random triangle whose plane the pixel's centre ray meets.
    pub fn anything(&self, count: usize, random: &mut Random) -> Vec<(u32, Option<u32>)> {
        let pixels = self.view.image[0] * self.view.image[1];
        let mut out = Vec::with_capacity(count);
        for _ in 0..count * 50 {
            let (pixel, t) = (random.below(pixels), random.below(self.triangles.len() as u32));
            let Some([a, b, c]) = self.triangles[t as usize].corners else { continue };
            let normal = (b - a).cross(c - a);
            let ray = oracle::reference::facet_classify::pixel_ray(&self.view, pixel, Default::default());
            let depth = normal.dot(a) / normal.dot(ray);
            if depth > 1e-4 && depth < 100.0 {
                out.push((pixel, Some(t)));
            }
            if out.len() == count {
                break;
            }
        }
        out
    }

    /// Runs `classify` on listed facets over given marks and splits.
    pub fn classify(&self, listed: &[(u32, Option<u32>)], marked: &[bool], splits: &[Split]) -> Facets {
        // With CLAMP the stage before says what it merged: nothing.
        let state = if self.frame.flags & Frame::CLAMP == 0 { POISON } else { 0 };
        self.classify_of(listed, state, marked, splits)
    }

    /// As [`World::classify`], of facets that the stage before left in a state.
    pub fn classify_of(&self, listed: &[(u32, Option<u32>)], state: u32, marked: &[bool], splits: &[Split]) -> Facets {
        static MADE: Pipelines<FacetClassify> = Pipelines::new();
        let (gpu, words) = (self.gpu, self.words());
        let classify = MADE.get(gpu, words, || FacetClassify::new(&gpu.device, words as u32));
        let facets = self.listed(listed, state);
        let bits: Vec<u32> = marked.iter().map(|&m| u32::from(m)).collect();
        let sat =
            Buffer::from_slice(&gpu.device, &gpu.queue, "test.sat", &table(&bits, self.view.map.map_size as usize))
                .expect("memory");
        let splits = self.splits(splits);
        let mut frame = self.frame;
        frame.facets_total = listed.len() as u32;
        let (frame, offsets) = (uniform(gpu, &frame), self.sample_offsets());
        let around = ClassifyInputs {
            triangles: &self.casters.triangles,
            positions: &self.casters.positions,
            sat: &sat,
            splits: &splits,
        };
        let groups = Groups::Items(listed.len() as u64);
        run(gpu, |s| classify.record_classify(s, &frame, &offsets, around, &facets, groups));
        facets
    }

    /// The box of a facet that covers all samples, as the stage before packs it.
    fn whole_span(&self) -> [u32; 2] {
        let [low, high] = sample_box(&self.samples);
        let half = |x: f32| u32::from(((x * 32767.0).round() as i16) as u16);
        let packed = |corner: [f32; 2], more: f32| half(corner[0] + more) | (half(corner[1] + more) << 16);
        let more = 1.0 / 256.0 + 1.0 / 16384.0;
        [packed(low, -more), packed(high, more)]
    }

    /// The facets as the stage before leaves them, in one state.
    fn listed(&self, listed: &[(u32, Option<u32>)], state: u32) -> Facets {
        let (gpu, words) = (self.gpu, self.words());
        let pixels = (self.view.image[0] * self.view.image[1]) as usize;
        let facets = Facets::new(&gpu.device, listed.len(), pixels, words).expect("memory");
        let one = |&(pixel, t): &(u32, Option<u32>)| Facet {
            pixel,
            triangle: t.unwrap_or(u32::MAX),
            state,
            span: self.whole_span(),
            ..Facet::default()
        };
        facets.list.write(&gpu.queue, &listed.iter().map(one).collect::<Vec<_>>());
        let full: Vec<u32> = (0..words as u32).map(|w| full_word(self.samples.count(), w)).collect();
        let masks: Vec<u32> = listed.iter().flat_map(|_| [full.clone(), vec![POISON; 2 * words]].concat()).collect();
        facets.masks.write(&gpu.queue, &masks);
        facets.items.write(&gpu.queue, &vec![POISON; facets.items.len()]);
        facets
    }

    /// Runs `requested_blocks` on the first `count` of listed facets that the stage before left in a state: what it writes.
    pub fn request(&self, listed: &[(u32, Option<u32>)], count: usize, state: u32) -> Vec<u32> {
        static MADE: Pipelines<RequestedBlocks> = Pipelines::new();
        let gpu = self.gpu;
        let device = &gpu.device;
        let stage = MADE.get(gpu, 0, || RequestedBlocks::new(device));
        let facets = self.listed(listed, state);
        let frame = uniform(gpu, &Frame { facets_total: count as u32, ..self.frame });
        let map = self.view.map.map_size as usize;
        let requested = Buffer::storage(device, "test.requested", RequestedBlocks::words(map) + 1).expect("memory");
        requested.write(&gpu.queue, &[vec![0; RequestedBlocks::words(map)], vec![POISON]].concat());
        let groups = Groups::Items(listed.len() as u64);
        let (triangles, positions) = (&self.casters.triangles, &self.casters.positions);
        run(gpu, |s| stage.record(s, &frame, triangles, positions, &facets.list, &requested, groups));
        let mut words = requested.read(gpu).expect("readback");
        assert_eq!(words.pop(), Some(POISON), "written past the end");
        words
    }

    /// Split depths as the kernels hold them.
    pub fn splits(&self, splits: &[Split]) -> Buffer<f32> {
        let words: Vec<f32> = splits
            .iter()
            .map(|s| match *s {
                Split::Marked => MARKED,
                Split::Uncovered => UNCOVERED,
                Split::At(depth) => depth.min(3.0e38) as f32,
            })
            .collect();
        Buffer::from_slice(&self.gpu.device, &self.gpu.queue, "test.splits", &words).expect("memory")
    }

    /// Vertices relative to the eye, scaled.
    pub fn points(&self) -> Buffer<[f32; 4]> {
        let points: Vec<[f32; 4]> =
            self.prepared.mesh().positions.iter().map(|p| self.view.point(*p).as_vec3().extend(1.0).into()).collect();
        Buffer::from_slice(&self.gpu.device, &self.gpu.queue, "test.points", &points).expect("memory")
    }

    pub fn sample_offsets(&self) -> Buffer<[f32; 4]> {
        let buffer = Buffer::uniform(&self.gpu.device, "test.samples", 64).expect("memory");
        buffer.write(&self.gpu.queue, &sample_words(&self.samples));
        buffer
    }

    /// Both runs of `pixel_texel_pairs` over the first `facets`: counts and `deepest` of each texel, and the padded list.
    pub fn pixel_pairs(&self, stage: &PixelTexelPairs, facets: &Facets, splits: &[Split], capacity: usize) -> Listed {
        let gpu = self.gpu;
        let (map, count) = (self.view.map.map_size as usize, facets.list.len());
        let places = stage.places();
        let mut lists = PairLists::new(&gpu.device, map, places, capacity.max(1), 1, 1, false).expect("memory");
        let items = facets.items.read_first(gpu, count).expect("readback");
        let (offsets, args, total) = self.items(&items);
        let splits = self.splits(splits);
        let mut frame = self.frame;
        (frame.facet_count, frame.facets_total) = (count as u32, count as u32);
        frame.pixel_texel_capacity = capacity as u32;
        let frame = uniform(gpu, &frame);
        let mut counts = Vec::new();
        let mut deepest = Vec::new();
        let mut kept = None;
        // All blocks found twice, half of them kept, all kept.
        for (room, pass) in [0, total / 2, total + 1].into_iter().flat_map(|room| [(room, 0), (room, 1)]) {
            if pass == 0 {
                lists.touched = Buffer::storage(&gpu.device, "test.touched", room as usize).expect("memory");
                lists.pixel_pairs.write(&gpu.queue, &vec![[POISON; 2]; capacity.max(1)]);
            }
            lists.place_counts.write(&gpu.queue, &vec![0; places.count(map)]);
            if total > 0 {
                run(gpu, |s| stage.record(s, pass, &frame, facets, &offsets, [(args.raw(), 0); 2], &splits, &lists));
            }
            counts.push(lists.place_counts.read(gpu).expect("readback"));
            if pass == 0 {
                deepest = lists.place_deepest.read(gpu).expect("readback");
                lists.pixel_offsets.write(&gpu.queue, &with_total(&counts[0]));
            } else if counts[0].iter().sum::<u32>() as usize <= capacity {
                let mut list = lists.pixel_pairs.read(gpu).expect("readback");
                list.sort_unstable();
                assert_eq!(*kept.get_or_insert_with(|| list.clone()), list, "what is kept of {total} blocks: {room}");
            }
        }
        assert!(counts.iter().all(|c| *c == counts[0]), "all runs find the same pairs");
        let list = lists.pixel_pairs.read(gpu).expect("readback");
        if places == PairTiles::Texels {
            // Appended instead, they are the same.
            lists.place_deepest.write(&gpu.queue, &vec![0; deepest.len()]);
            let unsorted = unsorted(gpu, capacity);
            if total > 0 {
                let args = (args.raw(), 0);
                run(gpu, |s| stage.record_append(s, &frame, facets, &offsets, args, &splits, &lists, &unsorted));
            }
            check_appended(gpu, &unsorted, capacity, &counts[0], list.iter().map(|&[facet, texel]| (texel, facet)));
            assert_eq!(lists.place_deepest.read(gpu).expect("readback"), deepest, "appended: the same depths");
        }
        let list = list.into_iter().map(|[a, b]| (a, b)).collect();
        Listed { counts: counts.swap_remove(0), deepest, list, parts: Vec::new() }
    }

    /// The list of pairs in a buffer of `len` when its capacity is said to be less.
    pub fn pixel_pairs_in(
        &self,
        stage: &PixelTexelPairs,
        facets: &Facets,
        splits: &[Split],
        capacity: usize,
        len: usize,
    ) -> Vec<[u32; 2]> {
        let gpu = self.gpu;
        let map = self.view.map.map_size as usize;
        // Nothing is kept from counting.
        let touched = Buffer::storage(&gpu.device, "test.touched", 0).expect("memory");
        let lists = PairLists {
            touched,
            ..PairLists::new(&gpu.device, map, stage.places(), len, 1, 1, false).expect("memory")
        };
        let (offsets, args, _) = self.items(&facets.items.read_first(gpu, facets.list.len()).expect("readback"));
        let splits_on_gpu = self.splits(splits);
        let mut frame = self.frame;
        (frame.facet_count, frame.facets_total) = (facets.list.len() as u32, facets.list.len() as u32);
        frame.pixel_texel_capacity = capacity as u32;
        let frame = uniform(gpu, &frame);
        let counts = self.pixel_pairs(stage, facets, splits, 1).counts;
        lists.pixel_offsets.write(&gpu.queue, &with_total(&counts));
        lists.pixel_pairs.write(&gpu.queue, &vec![[POISON; 2]; len]);
        run(gpu, |s| stage.record(s, 1, &frame, facets, &offsets, [(args.raw(), 0); 2], &splits_on_gpu, &lists));
        lists.pixel_pairs.read(gpu).expect("readback")
    }

    /// Both runs of `triangle_texel_pairs` where `deepest` says there are facets.
    pub fn triangle_pairs(&self, stage: &TriangleTexelPairs, deepest: &[Option<f32>], capacity: usize) -> Listed {
        self.triangle_pairs_in(stage, deepest, capacity, capacity.max(1))
    }

    /// The same with a list of `len` elements, of which it may use `capacity`.
    pub fn triangle_pairs_in(
        &self,
        stage: &TriangleTexelPairs,
        deepest: &[Option<f32>],
        capacity: usize,
        len: usize,
    ) -> Listed {
        let gpu = self.gpu;
        let map = self.view.map.map_size as usize;
        let places = stage.places();
        let (count, words_each) = (places.count(map), places.words());
        let mut lists = PairLists::new(&gpu.device, map, places, 1, len, 1, false).expect("memory");
        let items = self.facts.light_items.read(gpu).expect("readback");
        let (offsets, args, total) = self.items(&items);
        let across = map.div_ceil(8);
        let mut words: Vec<u32> =
            deepest_of(places, map, deepest).iter().map(|d| d.map_or(0, |d| d.to_bits() + 1)).collect();
        words.resize(count + across * across, 0);
        for texel in (0..map * map).filter(|&t| deepest[t].is_some()) {
            words[count + texel / map / 8 * across + texel % map / 8] = 1;
        }
        lists.place_deepest.write(&gpu.queue, &words);
        let mut frame = self.frame;
        frame.triangle_texel_capacity = capacity as u32;
        let frame = uniform(gpu, &frame);
        let blocks = Blocks {
            triangles: &self.casters.triangles,
            points: &self.map_points,
            rects: &self.facts.light_rects,
            facing: &self.facts.facing,
            offsets: &offsets,
            args: (args.raw(), 0),
        };
        let mut counts = Vec::new();
        let mut kept = None;
        // All blocks found twice, half of them kept, all kept.
        for (room, pass) in [0, total / 2, total + 1].into_iter().flat_map(|room| [(room, 0), (room, 1)]) {
            if pass == 0 {
                lists.touched = Buffer::storage(&gpu.device, "test.touched", room as usize).expect("memory");
                lists.triangle_pairs.write(&gpu.queue, &vec![POISON; words_each * len]);
            }
            lists.place_counts.write(&gpu.queue, &vec![0; places.count(map)]);
            if total > 0 {
                run(gpu, |s| stage.record(s, pass, &frame, blocks, blocks.args, &lists));
            }
            counts.push(lists.place_counts.read(gpu).expect("readback"));
            if pass == 0 {
                lists.triangle_offsets.write(&gpu.queue, &with_total(&counts[0]));
            } else if counts[0].iter().sum::<u32>() as usize <= capacity {
                let mut list = triangle_list(gpu, &lists);
                let offsets = with_total(&counts[0]);
                offsets[..=count].windows(2).for_each(|w| list[w[0] as usize..w[1] as usize].sort_unstable());
                assert_eq!(*kept.get_or_insert_with(|| list.clone()), list, "what is kept of {total} blocks: {room}");
            }
        }
        assert!(counts.iter().all(|c| *c == counts[0]), "all runs find the same pairs");
        let offsets = with_total(&counts[0]);
        let owner = |k: usize| offsets[..count].partition_point(|&o| o as usize <= k) as u32 - 1;
        let (list, parts): (Vec<_>, Vec<_>) = triangle_list(gpu, &lists)
            .into_iter()
            .enumerate()
            .map(|(k, (t, part))| ((t, if t == POISON { POISON } else { owner(k) }), part))
            .unzip();
        if places == PairTiles::Texels {
            // Appended instead, they are the same.
            let unsorted = unsorted(gpu, capacity);
            if total > 0 {
                run(gpu, |s| stage.record_append(s, &frame, blocks, &lists, &unsorted));
            }
            check_appended(gpu, &unsorted, capacity, &counts[0], list.iter().map(|&(t, texel)| (texel, t)));
        }
        Listed { counts: counts.swap_remove(0), deepest: Vec::new(), list, parts }
    }

    /// Scan of work items with its total and flag, and indirect arguments for them.
    pub fn items(&self, items: &[u32]) -> (Buffer<u32>, Buffer<u32>, u32) {
        let gpu = self.gpu;
        let mut words = with_total(items);
        words.extend(super::NO_TABLE);
        let total = words[items.len()];
        let offsets = Buffer::from_slice(&gpu.device, &gpu.queue, "test.offsets", &words).expect("memory");
        let args = indirect(gpu, total);
        (offsets, args, total)
    }
}

/// Exclusive scan, total and flag.
pub fn with_total(values: &[u32]) -> Vec<u32> {
    let scan = exclusive(values);
    [scan.sums, vec![scan.total, u32::from(scan.overflow)]].concat()
}

/// Indirect arguments for `items` invocations of workgroups of 64.
pub fn indirect(gpu: &Gpu, items: u32) -> Buffer<u32> {
    let most = gpu.device.limits().max_compute_workgroups_per_dimension;
    let args = Buffer::indirect(&gpu.device, "test.args", 4).expect("memory");
    args.write(&gpu.queue, &recorder::fold_within(u64::from(items.div_ceil(64)), most));
    args
}

/// The frame as a uniform buffer.
pub fn uniform(gpu: &Gpu, frame: &Frame) -> Buffer<Frame> {
    let buffer = Buffer::uniform(&gpu.device, "test.frame", 1).expect("memory");
    buffer.write(&gpu.queue, &[*frame]);
    buffer
}

/// The bits of samples below `count` in word `word`.
pub fn full_word(count: u32, word: u32) -> u32 {
    let left = count - 32 * word;
    if left >= 32 { u32::MAX } else { (1 << left) - 1 }
}

/// Folded to at most `groups` workgroups along a dimension: one device for the whole run.
pub fn folding_gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        let limits = wgpu::Limits { max_compute_workgroups_per_dimension: 3, ..wgpu::Limits::default() };
        Gpu::open_with_limits(None, Some(limits)).expect("a device with small limits")
    })
}

/// Light from almost straight above.
pub fn above() -> Light {
    Light::Directional { direction: [0.3, 1.0, 0.2] }
}

/// A mesh around the origin, seen from above.
pub fn looked_down_on(gpu: &'static Gpu, mesh: &Mesh, light: Light, image: [u32; 2], map: u32, count: u32) -> World {
    let camera = camera(DVec3::new(0.8, 2.2, 4.0), DVec3::new(0.0, -0.3, 0.0), 40.0);
    World::new(gpu, mesh, camera, light, image, map, samples(count))
}
