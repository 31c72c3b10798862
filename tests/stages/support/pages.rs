//! The three stages of pages, run one after another, and what they left.

use super::shadow::{World, uniform};
use super::spsm::{on_plane, with_blocks};
use super::{POISON, run};
use oracle::reference::page_requests::{Asked, TreePage, thirds};
use oracle::reference::summed_area::table;
use std::collections::BTreeMap;
use std::sync::OnceLock;
use subpixel_shadows::frame::sample_box;
use subpixel_shadows::glam::DVec2;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::page_casters::{PageCasters, PageTexels};
use subpixel_shadows::stages::page_query::PageQuery;
use subpixel_shadows::stages::page_requests::{PageNodes, PageRequests, PageRequestsOptions, PageRule, PageTree};

/// Constant and slope of the bias.
pub const BIAS: [f32; 2] = [5e-5, 1.05];

/// The word of the requests that sums the weights of cells up.
pub const WEIGHTS: usize = 31;

/// A device whose dispatches fold over ten workgroups a dimension, which nodes of a small tree take.
pub fn ten_a_row() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| super::small_gpu(10, 1 << 26))
}

/// Words that are read back.
pub struct Paged {
    pub tree: PageTree,
    pub budget: u32,
    pub finer: u32,
    pub rule: PageRule,
    /// Texels with silhouettes, where these count.
    pub edges: Option<Vec<[u32; 2]>>,
    pub seen: Vec<Option<u32>>,
    pub requests: Vec<u32>,
    pub levels: Vec<u32>,
    pub flags: Vec<u32>,
    pub masks: Vec<u32>,
    pub sat: Vec<u32>,
    pub table: Vec<u32>,
    pub counts: [u32; 3],
    pub keys: Vec<u32>,
    pub visibility: Vec<f32>,
}

impl Paged {
    /// Runs the stages on a world; pages are asked for by pixels.
    pub fn new(world: &World, budget: u32, finer: u32) -> Self {
        Self::by(PageRule::Matched, world, budget, finer)
    }

    /// The same by a rule, with no silhouettes.
    pub fn by(rule: PageRule, world: &World, budget: u32, finer: u32) -> Self {
        Self::marked(rule, world, budget, finer, &[])
    }

    /// The same with silhouettes in some texels of the map.
    pub fn marked(rule: PageRule, world: &World, budget: u32, finer: u32, marked: &[[u32; 2]]) -> Self {
        let side = world.view.map.map_size;
        let mut marks = vec![0; (side * side) as usize];
        marked.iter().for_each(|[x, y]| marks[(y * side + x) as usize] = 1);
        let gpu = world.gpu;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let tree = PageTree::new(world.view.map.map_size);
        let stage = PageRequests::new(device, PageRequestsOptions { tree, budget, finer, rule }).expect("a budget");
        let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
        let keys: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
        let id_keys = Buffer::from_slice(device, queue, "test.ids", &keys).expect("memory");
        let nodes = PageNodes::new(device, stage.numbers(), tree, seen.len()).expect("memory");
        for poisoned in [&nodes.levels, &nodes.flags, &nodes.masks, &nodes.sat, &nodes.table] {
            poisoned.write(queue, &vec![POISON; poisoned.len()]);
        }
        let triangles = world.triangles.len();
        let holes = !world.prepared.alpha().is_empty();
        let sat = Buffer::from_slice(device, queue, "test.sat", &table(&marks, side as usize)).expect("memory");
        let texels = PageTexels::new(device, queue, triangles, budget).expect("memory");
        let visibility = Buffer::<f32>::storage(device, "test.visibility", seen.len()).expect("memory");
        visibility.write(queue, &vec![f32::from_bits(POISON); seen.len()]);
        let (points, frame, offsets) = (world.points(), uniform(gpu, &world.frame), world.sample_offsets());
        let from =
            PrimaryHits { samples: &offsets, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
        let casters = PageCasters::new(device, tree, budget, holes);
        let query = PageQuery::new(device, tree, BIAS);
        run(gpu, |s| {
            stage.record_request(s, &frame, from, &nodes, Some(&sat))?;
            stage.record_choose(s, &nodes)
        });
        with_blocks(world, |blocks| run(gpu, |s| casters.record(s, &frame, blocks, &nodes, &texels)));
        run(gpu, |s| query.record(s, &frame, from, (&nodes, &texels), &visibility));
        let read = |buffer: &Buffer<u32>| buffer.read(gpu).expect("readback");
        Self {
            tree,
            budget,
            finer,
            rule,
            edges: (rule == PageRule::Edges).then(|| marked.to_vec()),
            seen,
            requests: read(&nodes.requests),
            levels: read(&nodes.levels),
            flags: read(&nodes.flags),
            masks: read(&nodes.masks),
            sat: read(&nodes.sat),
            table: read(&nodes.table),
            counts: nodes.counts(gpu).expect("readback"),
            keys: read(&texels.keys),
            visibility: visibility.read(gpu).expect("readback"),
        }
    }

    /// Every page of the tree.
    pub fn all(&self) -> impl Iterator<Item = TreePage> + use<> {
        let places = |level: u32| (0..1 << level).flat_map(move |y| (0..1 << level).map(move |x| (level, [x, y])));
        (0..=self.tree.last).flat_map(places)
    }

    /// The finest level, in thirds, that is asked for of each cell.
    pub fn cells(&self) -> Vec<Option<u32>> {
        let (end, cells) = (self.requests.len(), self.tree.cells());
        self.requests[end - 2 * cells..end - cells].iter().map(|word| word.checked_sub(1)).collect()
    }

    /// The weight of each cell, and the sum of all.
    pub fn weights(&self) -> (&[u32], u32) {
        (&self.requests[self.requests.len() - self.tree.cells()..], self.requests[WEIGHTS])
    }

    /// The word of a page's bits.
    pub fn word(&self, (level, page): TreePage) -> usize {
        self.requests.len() - 2 * self.tree.cells() - self.tree.nodes() + self.tree.node(level, page)
    }

    /// The pages that pixels ask for.
    pub fn asked(&self) -> Vec<Asked> {
        let bits = |page: TreePage| self.requests[self.word(page)];
        self.all()
            .flat_map(|p| (0..3).filter(move |more| bits(p) >> (2 - more) & 1 == 1).map(move |more| (p, more)))
            .collect()
    }

    /// The pages that are made, and their numbers.
    pub fn made(&self) -> BTreeMap<TreePage, u32> {
        let node = |(level, page): TreePage| self.tree.node(level, page);
        self.all().filter(|&p| self.flags[node(p)] == 1).map(|p| (p, self.table[node(p)])).collect()
    }

    /// Nearest depths of a page that is made, by its number.
    pub fn depths(&self, number: u32) -> Vec<Option<f64>> {
        let texels = PageTree::PAGE.pow(2) as usize;
        let of = |&key: &u32| (key != 0).then(|| f64::from(f32::from_bits(!key)));
        self.keys[number as usize * texels..][..texels].iter().map(of).collect()
    }
}

/// Longer step and box of a pixel, texels of the map; `None` where a corner of its box is not seen, or it is too steep to tell.
pub fn footprint(world: &World, pixel: u32, t: u32) -> Option<(f64, [DVec2; 2])> {
    let at = |x: f64, y: f64| on_plane(world, pixel, t, DVec2::new(x, y)).map(|p| p.truncate());
    let h = 1.0 / 4096.0;
    let (right, down) = ((at(h, 0.0)? - at(-h, 0.0)?) / (2.0 * h), (at(0.0, h)? - at(0.0, -h)?) / (2.0 * h));
    let [low, high] = sample_box(&world.samples).map(|corner| corner.map(f64::from));
    let mut reached = [DVec2::MAX, DVec2::MIN];
    for [x, y] in [low, [high[0], low[1]], [low[0], high[1]], high] {
        reached = [reached[0].min(at(x, y)?), reached[1].max(at(x, y)?)];
    }
    Some((right.length().max(down.length()), reached))
}

/// The finest level, over that of the map, that single precision tells texels of: half of one is above the rounding of a place.
fn told(world: &World, pixel: u32, t: u32) -> Option<f64> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let normal = (b - a).cross(c - a);
    let ray = oracle::reference::facet_classify::pixel_ray(&world.view, pixel, DVec2::ZERO);
    let point = ray * (normal.dot(a) / normal.dot(ray));
    let map = &world.view.map;
    let w = map.w.dot(point.extend(1.0));
    let row = |row: subpixel_shadows::glam::DVec4| 2f64.powi(-20) * row.abs().element_sum();
    let noise = row(map.u).max(row(map.v)) + row(map.w) * f64::from(map.map_size);
    Some((0.5 * w / noise).log2())
}

/// The levels, in thirds, that rounding may make a pixel ask for, from the coarsest to the finest, and the box of its samples; `None` where that
/// has no end.
pub fn thirds_wanted(world: &World, pixel: u32, t: u32, finer: u32, tree: [u32; 2]) -> Option<([u32; 2], [DVec2; 2])> {
    let (step, [low, high]) = footprint(world, pixel, t)?;
    let (told, extent) = (told(world, pixel, t)?, (high - low).max_element());
    let of = |more: f64| {
        let told = (told - more.log2()).floor() as i32;
        thirds(step * more, extent * more + (more - 1.0) * 0.01, told, finer, tree)
    };
    Some(([of(1.02), of(1.0 / 1.02)], [low, high]))
}
