//! Clusters that a view keeps, against `f64`: those with a point in the view, and none that lies well beyond one of its sides; the list of them, word
//! by word; and that stages make of kept elements what they make of all.

use crate::support::shapes::ball;
use crate::support::{POISON, Random, assert_same, difference, gpu, poisoned, run, sizes_around, small_gpu, upload};
use oracle::reference::cluster_culling::{Extents, is_mapped, is_off_the_map, is_out_of_sight, is_seen, list};
use oracle::reference::view::View;
use std::sync::OnceLock;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::DVec3;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::prepared::{marked_triangles, padded};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::stages::cluster_culling::{
    CLUSTER, ClusterBox, ClusterCulling, ClusterList, ClusterPart, cluster_boxes,
};
use subpixel_shadows::stages::dispatch_args::ArgsRequest;
use subpixel_shadows::stages::requested_blocks::RequestedBlocks;
use subpixel_shadows::stages::silhouette_mask::SilhouetteMask;
use subpixel_shadows::stages::triangle_setup::{TriangleFacts, TriangleSetup};
use subpixel_shadows::stages::vertex_project::VertexProject;
use subpixel_shadows::stages::work_owners::ListWork;
use subpixel_shadows::stages::{DispatchArgs, PrefixScan, WorkOwners};
use subpixel_shadows::status_word;
use test_support::gpu_test;

fn stage() -> &'static ClusterCulling {
    static STAGE: OnceLock<ClusterCulling> = OnceLock::new();
    STAGE.get_or_init(|| ClusterCulling::new(&gpu().device, &PrefixScan::new(&gpu().device)))
}

/// Between -1 and 1.
fn unit(random: &mut Random) -> f64 {
    f64::from(random.below(1 << 20)) / f64::from(1 << 19) - 1.0
}

fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(unit(random), unit(random), unit(random))
}

/// A camera and a light's view of a part of a world.
struct Looks {
    view: View,
    frame: Frame,
}

impl Looks {
    /// At a place in a world of 20 units, from nearby; the light sees a ball there.
    fn new(random: &mut Random, map: u32) -> Self {
        let at = 6.0 * vector(random);
        let eye = at + 3.0 * vector(random);
        let camera = Camera {
            eye: eye.as_vec3().into(),
            target: at.as_vec3().into(),
            ..Camera::framing(-DVec3::ONE, DVec3::ONE)
        };
        let light = match random.below(3) {
            0 => Light::Directional { direction: (vector(random) + 1.5 * DVec3::Y).as_vec3().into() },
            _ => Light::Point { position: (at + 4.0 * vector(random).normalize()).as_vec3().into() },
        };
        let mut part = Mesh::default();
        ball(&mut part, at, 1.0, 12, 8);
        let mut fitted = LightView::fit(&part, &light, map).expect("a light view");
        // Beyond few sides parts of casters are left out.
        fitted.ends = [(); 4].map(|()| random.below(8) == 0);
        let (bounds, image) = ((DVec3::splat(-10.0), DVec3::splat(10.0)), [90, 60]);
        let samples = Samples::new(Default::default(), 8).expect("a pattern");
        let view = View::new(&camera, &light, &fitted, bounds, image, false);
        Self { view, frame: Frame::new(&camera, &light, &fitted, bounds, image, &samples) }
    }

    fn extents(&self, of: &ClusterBox) -> Extents {
        let [low, high] = [of.low, of.high].map(|[x, y, z, _]| self.view.point([x, y, z]));
        Extents { low, high }
    }
}

fn boxes(random: &mut Random, count: usize) -> Vec<ClusterBox> {
    let of = |random: &mut Random| {
        let size = [0.02, 0.2, 1.0, 5.0][random.below(4) as usize];
        let (middle, half) = (9.0 * vector(random), 0.5 * size * vector(random).abs());
        let corner = |p: DVec3| p.as_vec3().extend(0.0).into();
        ClusterBox { low: corner(middle - half), high: corner(middle + half) }
    };
    (0..count).map(|_| of(random)).collect()
}

/// A list whose memory holds anything, for so many elements.
fn list_for(gpu: &Gpu, elements: [usize; 3]) -> ClusterList {
    let mut list = ClusterList::new(&gpu.device, &gpu.queue, elements).expect("memory");
    list.kept = poisoned(gpu, list.kept.len());
    list
}

/// Runs the stage: kept or not, of each part, by the list and by words.
fn kept(gpu: &Gpu, stage: &ClusterCulling, looks: &Looks, given: &[ClusterBox], elements: [usize; 3], of: Of) -> Kept {
    let (frame, boxes) = (Buffer::uniform(&gpu.device, "frame", 1).expect("memory"), upload(gpu, given));
    frame.write(&gpu.queue, &[looks.frame]);
    let requested = match of {
        Of::Requested(words) => upload(gpu, words),
        _ => RequestedBlocks::memory(&gpu.device, looks.frame.map_size as usize).expect("memory"),
    };
    let (list, status) = (list_for(gpu, elements), upload(gpu, &[0u32; 32]));
    run(gpu, |s| match of {
        Of::Camera => stage.record_camera(s, &frame, &boxes, &list, &status),
        _ => stage.record_light(s, &frame, &boxes, &requested, &list, &status),
    });
    let counted = status.read(gpu).expect("readback")[status_word!(kept_triangles)];
    let words = list.kept.read(gpu).expect("readback");
    let clusters = elements.map(|n| n.div_ceil(CLUSTER));
    let of_part = |part: usize| {
        let mut kept = vec![false; clusters[part]];
        let first = 8 + words[3 + part] as usize;
        words[first..first + words[part] as usize].iter().for_each(|&k| kept[k as usize] = true);
        kept
    };
    assert_eq!(counted, words[6], "triangles");
    Kept { parts: [of_part(0), of_part(1), of_part(2)], words }
}

#[derive(Clone, Copy)]
enum Of<'a> {
    Camera,
    Light,
    Requested(&'a [u32]),
}

struct Kept {
    parts: [Vec<bool>; 3],
    words: Vec<u32>,
}

/// The first fault of what is kept, and how many clusters are and are not.
fn fault(
    looks: &Looks,
    given: &[ClusterBox],
    elements: [usize; 3],
    of: Of,
    got: &Kept,
) -> (Option<String>, [usize; 2]) {
    let want = list(got.parts.each_ref().map(Vec::as_slice), elements);
    if let Some(text) = difference(&got.words[..want.len().min(got.words.len())], &want) {
        return (Some(format!("list: {text}")), [0; 2]);
    }
    if got.words[want.len()..].iter().any(|&word| word != POISON) {
        return (Some("written beyond the list".to_owned()), [0; 2]);
    }
    let mut counts = [0; 2];
    for (k, (of_cluster, &kept)) in given.iter().zip(got.parts.iter().flatten()).enumerate() {
        let extents = looks.extents(of_cluster);
        let within = |p: DVec3| match of {
            Of::Camera => is_seen(&looks.view, p),
            _ => is_mapped(&looks.view, p),
        };
        let places =
            (0..5 * 5 * 5).map(|n| DVec3::new(f64::from(n % 5), f64::from(n / 5 % 5), f64::from(n / 25)) / 4.0);
        let must = places.into_iter().any(|share| within(extents.at(share)));
        let may = match of {
            Of::Camera => !is_out_of_sight(&looks.view, &extents, 1.0),
            _ => !is_off_the_map(&looks.view, &extents, 1.0),
        };
        if (must && !kept && !matches!(of, Of::Requested(_))) || (kept && !may) {
            return (Some(format!("cluster {k}: kept {kept}, from {must} to {may} expected: {of_cluster:?}")), counts);
        }
        counts[usize::from(kept)] += 1;
    }
    (None, counts)
}

#[track_caller]
fn check(gpu: &Gpu, stage: &ClusterCulling, looks: &Looks, given: &[ClusterBox], elements: [usize; 3]) -> [usize; 2] {
    let mut all = [0; 2];
    for of in [Of::Camera, Of::Light] {
        let got = kept(gpu, stage, looks, given, elements, of);
        let (fault, counts) = fault(looks, given, elements, of, &got);
        assert_eq!(fault, None, "{elements:?}, light {:?}", looks.view.light);
        (0..2).for_each(|k| all[k] += counts[k]);
    }
    all
}

/// Elements in so many clusters, the last of them not full.
fn elements(random: &mut Random, clusters: [usize; 3]) -> [usize; 3] {
    clusters.map(|n| (n * CLUSTER).saturating_sub(random.below(CLUSTER as u32) as usize))
}

#[gpu_test]
fn empty() {
    let mut random = Random::new(1);
    let looks = Looks::new(&mut random, 64);
    assert_eq!(check(gpu(), stage(), &looks, &[], [0; 3]), [0; 2]);
    // Parts without elements between others.
    for parts in [[40, 0, 0], [0, 40, 0], [0, 0, 40], [20, 0, 20]] {
        let given = boxes(&mut random, 40);
        let elements = elements(&mut random, parts);
        assert_eq!(check(gpu(), stage(), &looks, &given, elements).iter().sum::<usize>(), 80);
    }
}

#[gpu_test]
fn one() {
    let mut random = Random::new(2);
    for _ in 0..20 {
        let (looks, given) = (Looks::new(&mut random, 40), boxes(&mut random, 3));
        check(gpu(), stage(), &looks, &given, [1, 64, 63]);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(3);
    for size in sizes_around(64) {
        let parts = [size, size / 2, size / 3];
        let (looks, given) = (Looks::new(&mut random, 100), boxes(&mut random, parts.iter().sum()));
        let elements = elements(&mut random, parts);
        check(gpu(), stage(), &looks, &given, elements);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(4);
    let mut all = [0; 2];
    for round in 0..40 {
        let (looks, given) = (Looks::new(&mut random, [3, 64, 700][round % 3]), boxes(&mut random, 900));
        let elements = elements(&mut random, [300, 350, 250]);
        let counts = check(gpu(), stage(), &looks, &given, elements);
        (0..2).for_each(|k| all[k] += counts[k]);
        // One box as a cluster of each part: an edge that is in the view has its triangle, which has its vertices.
        let one = given[..200].repeat(3);
        for of in [Of::Camera, Of::Light] {
            let [triangles, edges, vertices] = kept(gpu(), stage(), &looks, &one, [12_800; 3], of).parts;
            let holds = |less: &[bool], more: &[bool]| less.iter().zip(more).all(|(less, more)| *more || !less);
            assert!(holds(&edges, &triangles) && holds(&triangles, &vertices));
        }
    }
    assert!(all.iter().all(|&count| count > 10_000), "{all:?}");
}

#[gpu_test]
fn degenerate() {
    let mut random = Random::new(5);
    let looks = Looks::new(&mut random, 64);
    // The whole world, a point, one around the eye, and boxes that hold nothing.
    let point = |p: DVec3| ClusterBox { low: p.as_vec3().extend(0.0).into(), high: p.as_vec3().extend(0.0).into() };
    let world = ClusterBox { low: [-1e4; 4], high: [1e4; 4] };
    let around = point(looks.view.eye);
    let given = [world, point(DVec3::ONE), point(DVec3::splat(-9.0)), around, world, world];
    check(gpu(), stage(), &looks, &given, [256, 64, 64]);
    let got = kept(gpu(), stage(), &looks, &given, [256, 64, 64], Of::Light);
    assert!(got.parts[0][0] && got.parts[1][0] && got.parts[2][0], "the world is in every view");
    let none = ClusterBox { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };
    for of in [Of::Camera, Of::Light] {
        let got = kept(gpu(), stage(), &looks, &[world, none, world], [192, 0, 0], of);
        assert!(got.parts[0][0] && got.parts[0][2], "what holds nothing leaves its neighbours alone");
    }
}

#[gpu_test]
fn blocks_that_nobody_asks_for() {
    let mut random = Random::new(6);
    let (mut fewer, mut none) = (0, 0);
    for _ in 0..20 {
        let map = 200;
        let (looks, given) = (Looks::new(&mut random, map), boxes(&mut random, 600));
        let mut words = vec![0; RequestedBlocks::words(map as usize)];
        words[0] = 1;
        let nothing = kept(gpu(), stage(), &looks, &given, [38_400, 0, 0], Of::Requested(&words)).parts[0].clone();
        // The blocks of a quarter of the map.
        (0..12).for_each(|row| words[1 + row] = 0xfff);
        let got = kept(gpu(), stage(), &looks, &given, [38_400, 0, 0], Of::Requested(&words));
        let all = kept(gpu(), stage(), &looks, &given, [38_400, 0, 0], Of::Light).parts[0].clone();
        assert_eq!(fault(&looks, &given, [38_400, 0, 0], Of::Requested(&words), &got).0, None);
        for (k, of) in given.iter().enumerate() {
            let extents = looks.extents(of);
            let asks = |p: DVec3| looks.view.on_map(p).is_some_and(|q| q.x >= 0.0 && q.y >= 0.0 && q.x.max(q.y) < 96.0);
            let must = extents.corners().into_iter().chain([extents.at(DVec3::splat(0.5))]).any(asks);
            assert!((got.parts[0][k] || !must) && (all[k] || !got.parts[0][k]), "{of:?}");
            fewer += usize::from(all[k] && !got.parts[0][k]);
            // A box that reaches behind the light may touch any.
            none += usize::from(all[k] && !nothing[k]);
        }
    }
    assert!(fewer > 100 && none > fewer, "{fewer} and {none}");
}

/// Balls all over a world, on a ground.
fn scattered(random: &mut Random) -> Prepared {
    let mut mesh = Mesh::default();
    for _ in 0..60 {
        ball(&mut mesh, 8.0 * vector(random), 0.3 + 0.2 * unit(random), 24, 16);
    }
    let ground = mesh.ground_below().expect("a ground");
    mesh.add_ground(&ground);
    Prepared::new(&mesh).expect("a sound mesh")
}

/// Facts that stages write of the elements of a mesh.
struct Made {
    map_points: Vec<[f32; 4]>,
    facing: Vec<u32>,
    camera_rects: Vec<[u32; 2]>,
    light_rects: Vec<[u32; 2]>,
    edge_rects: Vec<[u32; 2]>,
    /// Items of triangles in the camera's view and the light's, and of edges.
    items: [Vec<u32>; 3],
    /// Owners of all items of the light's view.
    owners: Vec<u32>,
}

fn made(gpu: &Gpu, looks: &Looks, prepared: &Prepared, culled: Option<[&ClusterList; 2]>) -> Made {
    let (mesh, device) = (prepared.mesh(), &gpu.device);
    let (vertices, triangles, edges) = (mesh.positions.len(), mesh.triangles.len(), prepared.edges.len());
    let counts = (vertices as u32, triangles as u32, edges as u32);
    let mut frame = Frame { flags: looks.frame.flags | Frame::FURTHER_VIEW, ..looks.frame };
    (frame.vertex_count, frame.triangle_count, frame.edge_count) = counts;
    let uniform = Buffer::uniform(device, "frame", 1).expect("memory");
    uniform.write(&gpu.queue, &[frame]);
    let positions = upload(gpu, &padded(&mesh.positions));
    let indices = upload(gpu, &marked_triangles(prepared, triangles));
    let of_edges = upload(gpu, &prepared.edges);
    let (points, map_points) = (poisoned(gpu, vertices), poisoned(gpu, vertices));
    let facts = TriangleFacts {
        facing: poisoned(gpu, triangles),
        camera_rects: poisoned(gpu, triangles),
        light_rects: poisoned(gpu, triangles),
        camera_items: poisoned(gpu, triangles),
        light_items: poisoned(gpu, triangles),
    };
    let (edge_rects, edge_items) = (poisoned(gpu, edges), poisoned(gpu, edges));
    let requested = RequestedBlocks::memory(device, frame.map_size as usize).expect("memory");
    let status = upload(gpu, &[0u32; 32]);
    let scan = PrefixScan::new(device);
    let work = ListWork::new(device, &scan);
    let offsets = poisoned(gpu, WorkOwners::words_of_clusters(triangles, 1 << 20));
    let scratch = PrefixScan::scratch(device, triangles).expect("memory");
    let request = ArgsRequest::new(triangles, 64, 1 << 30, 0).expect("one");
    let requests = DispatchArgs::requests(device, &gpu.queue, &[request]).expect("memory");
    let args = Buffer::indirect(device, "test.args", 4).expect("memory");
    let (project, setup, silhouettes) =
        (VertexProject::new(device), TriangleSetup::new(device), SilhouetteMask::new(device));
    run(gpu, |s| {
        let part = |of: usize, part, count: usize| culled.map_or(count.into(), |lists| lists[of].elements(part, count));
        let [in_camera, in_light] = [0, 1].map(|of| part(of, ClusterPart::Triangles, triangles));
        let of_light = part(1, ClusterPart::Vertices, vertices);
        let lines = part(1, ClusterPart::Edges, edges);
        project.record_place(s, &uniform, &positions, &points);
        setup.record_camera(s, &uniform, &indices, &points, &facts, in_camera)?;
        project.record_project(s, &uniform, &points, &map_points, of_light)?;
        setup.record_light(s, &uniform, &indices, &points, &map_points, &requested, &facts, in_light)?;
        let (facing, rects, items) = (&facts.facing, &edge_rects, &edge_items);
        silhouettes.record_classify(
            s,
            &uniform,
            &of_edges,
            facing,
            &map_points,
            &requested,
            rects,
            items,
            &status,
            lines,
        )?;
        work.record(s, (&facts.light_items, in_light), &offsets, &scratch, (&requests, &args))
    });
    let readback = "readback";
    let offsets = offsets.read(gpu).expect(readback);
    let list = offsets[triangles + 2] as usize;
    let owner = |slot: usize| if list == 0 { slot as u32 } else { 64 * offsets[list + slot / 64] + slot as u32 % 64 };
    let slots = if culled.is_some() { offsets[triangles + 3] as usize } else { triangles };
    let owners = (0..offsets[triangles]).map(|item| owner(offsets[..slots].partition_point(|&o| o <= item) - 1));
    Made {
        owners: owners.collect(),
        map_points: map_points.read(gpu).expect(readback),
        facing: facts.facing.read(gpu).expect(readback),
        camera_rects: facts.camera_rects.read(gpu).expect(readback),
        light_rects: facts.light_rects.read(gpu).expect(readback),
        edge_rects: edge_rects.read(gpu).expect(readback),
        items: [&facts.camera_items, &facts.light_items, &edge_items].map(|items| items.read(gpu).expect(readback)),
    }
}

#[gpu_test]
fn stages_make_of_what_is_kept_what_they_make_of_all() {
    let mut random = Random::new(7);
    let (mut left_out, mut some_to_see) = ([0; 3], [0; 3]);
    for _ in 0..12 {
        let (looks, prepared) = (Looks::new(&mut random, 128), scattered(&mut random));
        let given = cluster_boxes(prepared.mesh(), &prepared.edges);
        let elements = [prepared.mesh().triangles.len(), prepared.edges.len(), prepared.mesh().positions.len()];
        let (frame, boxes) = (Buffer::uniform(&gpu().device, "frame", 1).expect("memory"), upload(gpu(), &given));
        frame.write(&gpu().queue, &[looks.frame]);
        let requested = RequestedBlocks::memory(&gpu().device, 128).expect("memory");
        let (camera, light) = (list_for(gpu(), [elements[0], 0, 0]), list_for(gpu(), elements));
        let status = upload(gpu(), &[0u32; 32]);
        run(gpu(), |s| {
            stage().record_camera(s, &frame, &boxes, &camera, &status)?;
            stage().record_light(s, &frame, &boxes, &requested, &light, &status)
        });
        let in_camera = kept(gpu(), stage(), &looks, &given, [elements[0], 0, 0], Of::Camera).parts;
        let in_light = kept(gpu(), stage(), &looks, &given, elements, Of::Light).parts;
        let [all, some] = [None, Some([&camera, &light])].map(|lists| made(gpu(), &looks, &prepared, lists));
        assert_same("owners", &some.owners, &all.owners);
        let is_empty = |[low, high]: [u32; 2]| low & 0xffff > high & 0xffff;
        // Of what is kept the same is written, in order; what is not has nothing, and is left alone.
        for (k, (kept, part)) in [(&in_camera[0], 0), (&in_light[0], 1), (&in_light[1], 2)].into_iter().enumerate() {
            let is_kept = |n: &usize| kept[n / CLUSTER];
            let (rects, of_all) = match k {
                0 => (&some.camera_rects, &all.camera_rects),
                1 => (&some.light_rects, &all.light_rects),
                _ => (&some.edge_rects, &all.edge_rects),
            };
            let mut slots = some.items[part].iter();
            for n in 0..rects.len() {
                if is_kept(&n) {
                    // Beyond the view nobody knows which side neighbours face, nor asks.
                    let same = rects[n] == of_all[n] || (k == 2 && is_empty(rects[n]) && is_empty(of_all[n]));
                    assert!(same, "{k}, element {n}: {:?} and {:?}", rects[n], of_all[n]);
                    assert_eq!(slots.next(), Some(&all.items[part][n]), "{k}, items of {n}");
                } else {
                    assert!(is_empty(of_all[n]) && rects[n] == [POISON; 2], "{k}, element {n}: {:?}", of_all[n]);
                    left_out[k] += 1;
                }
            }
            let rest: Vec<u32> = slots.copied().collect();
            assert!(rest.iter().all(|&word| word == POISON), "{k}: {rest:?}");
        }
        for t in (0..elements[0]).filter(|t| in_light[0][t / CLUSTER]) {
            assert_eq!(some.facing[t], all.facing[t], "triangle {t}");
            for v in prepared.mesh().triangles[t] {
                assert_eq!(some.map_points[v as usize].map(f32::to_bits), all.map_points[v as usize].map(f32::to_bits));
            }
        }
        (0..3).for_each(|k| some_to_see[k] += all.items[k].iter().filter(|count| **count > 0).count());
    }
    assert!(some_to_see.iter().all(|&count| count > 1000), "{some_to_see:?}");
    assert!(left_out.iter().all(|&count| count > 10_000), "{left_out:?}");
}

#[gpu_test]
fn overflow_by_one() {
    // No list can be too long: it has room for all. Boxes that are too few are refused.
    let mut random = Random::new(8);
    let (looks, given) = (Looks::new(&mut random, 64), boxes(&mut random, 100));
    let frame = Buffer::uniform(&gpu().device, "frame", 1).expect("memory");
    frame.write(&gpu().queue, &[looks.frame]);
    let (list, status) = (list_for(gpu(), [3200, 1600, 1600]), upload(gpu(), &[0u32; 32]));
    let mut encoder = gpu().encoder();
    let mut recorder = Recorder::new(&gpu().device, &mut encoder, None);
    let stage_of = &mut recorder.stage("test");
    assert!(stage().record_camera(stage_of, &frame, &upload(gpu(), &given), &list, &status).is_ok());
    assert!(stage().record_camera(stage_of, &frame, &upload(gpu(), &given[1..]), &list, &status).is_err());
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(10, 1 << 22);
    let stage = ClusterCulling::new(&small.device, &PrefixScan::new(&small.device));
    let mut random = Random::new(9);
    let (looks, given) = (Looks::new(&mut random, 64), boxes(&mut random, 1800));
    let counts = check(&small, &stage, &looks, &given, [800 * 64, 500 * 64, 500 * 64]);
    assert!(counts.iter().sum::<usize>() > 2 * 64 * 10, "more workgroups than fit along a dimension");
    assert!(counts.iter().all(|&count| count > 10), "{counts:?}");
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(10);
    let (given, elements) = (boxes(&mut random, 300), [100 * 64; 3]);
    let looks =
        std::iter::repeat_with(|| Looks::new(&mut random, 64)).take(50).find(|looks| looks.view.map.ends == [false; 4]);
    let looks = looks.expect("a view without ends");
    for of in [Of::Camera, Of::Light] {
        let fault = |got: &Kept| fault(&looks, &given, elements, of, got).0;
        let mut got = kept(gpu(), stage(), &looks, &given, elements, of);
        assert_eq!(fault(&got), None);
        let last = 8 + got.words[5] as usize - 1;
        got.words[last] ^= 1;
        assert!(fault(&got).is_some(), "another cluster in the list");
        got.words[last] ^= 1;
        // Clusters in the view are left out, or others kept, and the list says so.
        for wrong in [true, false] {
            let mut parts = got.parts.clone();
            parts[0].iter_mut().filter(|kept| **kept == wrong).for_each(|kept| *kept = !wrong);
            let words = list(parts.each_ref().map(Vec::as_slice), elements);
            let rest = got.words.len().saturating_sub(words.len());
            assert!(fault(&Kept { parts, words: [words, vec![POISON; rest]].concat() }).is_some(), "{wrong}");
        }
    }
}
