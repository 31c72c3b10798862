//! The view that each pixel asks, against `f64`: where rounding may turn over which it is, either. What each asks is kept and taken exactly.

use crate::support::shadow::{
    World, above, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples, uniform,
};
use crate::support::spsm::faces_away;
use crate::support::{POISON, Random, gpu, run, sizes_around, upload};
use oracle::reference::facet_classify::pixel_ray;
use oracle::reference::pixel_views::{inset, may_be_chosen};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::pixel_views::{LightViews, PixelChoice, PixelViews, TakeWords};
use test_support::gpu_test;

const REACH: f32 = 1.5;

/// Results of the stage for a world in some views.
#[derive(Clone)]
struct Ran {
    views: Vec<LightView>,
    seen: Vec<Option<u32>>,
    view_of: Vec<u32>,
    /// Of each view the triangles kept.
    kept: Vec<Vec<u32>>,
    /// Words a pixel that were taken; word `w` of pixel `p`, left by view `v`, is `1000 v + words p + w`.
    words: usize,
    taken: Vec<u32>,
}

/// Windows of the light's view, anywhere in it and of any size.
fn windows(world: &World, count: usize, random: &mut Random) -> Vec<LightView> {
    let view = world.view.map;
    let side = f64::from(view.map_size);
    let mut share = || f64::from(random.word()) / 4294967296.0;
    (0..count)
        .map(|k| {
            let (zoom, x, y) = (1.0 + 3.0 * share() * k as f64, share() * side, share() * side);
            let about = |row, at: f64| (row - view.w * at) * zoom + view.w * at;
            LightView { u: about(view.u, x), v: about(view.v, y), ..view }
        })
        .rev()
        .collect()
}

fn ask(world: &World, views: Vec<LightView>, words: usize) -> Ran {
    let gpu = world.gpu;
    let (device, queue) = (&gpu.device, &gpu.queue);
    let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
    let pixels = seen.len();
    let id_keys = upload(gpu, &seen.iter().map(|t| t.map_or(0, |t| !t)).collect::<Vec<_>>());
    let (frame, samples, points) = (uniform(gpu, &world.frame), world.sample_offsets(), world.points());
    let choice = PixelChoice::new(device, pixels).expect("memory");
    choice.views.write(queue, &[LightViews::new(&views)]);
    choice.view_of.write(queue, &vec![POISON; choice.view_of.len()]);
    choice.view_keys.write(queue, &vec![POISON; choice.view_keys.len()]);
    let stage = PixelViews::new(device, REACH);
    let take = TakeWords::new(device, words as u32, 1);
    let taken = Buffer::<u32>::storage(device, "test.taken", words * pixels).expect("memory");
    taken.write(queue, &vec![POISON; taken.len()]);
    let from =
        PrimaryHits { samples: &samples, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
    run(gpu, |s| stage.record_choose(s, &frame, from, &choice));
    let mut kept = Vec::new();
    for view in 0..views.len() as u32 {
        let all = (0..(1 + words) * pixels).map(|k| (1000 * view + k as u32).wrapping_sub(pixels as u32));
        let left = upload(gpu, &all.collect::<Vec<_>>());
        run(gpu, |s| {
            stage.record_keep(s, &frame, view, &id_keys, &choice).expect("recorded");
            take.record(s, &frame, view, &choice, (left.as_read(), &taken)).expect("recorded");
        });
        kept.push(choice.view_keys.read(gpu).expect("readback"));
    }
    let view_of = choice.view_of.read(gpu).expect("readback");
    Ran { views, seen, view_of, kept, words, taken: taken.read(gpu).expect("readback") }
}

/// The plane's points at middle and corners of a pixel; `None` where one of them is too far out to be placed well.
fn around(world: &World, pixel: u32, t: u32) -> Option<Vec<DVec3>> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let normal = (b - a).cross(c - a).normalize();
    let offsets = [[0.0, 0.0], [-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(DVec2::from);
    let point = |offset| {
        let ray = pixel_ray(&world.view, pixel, offset);
        let depth = normal.dot(a) / normal.dot(ray);
        (normal.dot(ray).abs() > 1e-3 * ray.length() && depth > 0.0).then(|| ray * depth)
    };
    offsets.into_iter().map(point).collect()
}

/// Where the stage departs from its definition; how many pixels were compared.
fn fault(world: &World, ran: &Ran) -> Result<usize, String> {
    let mut compared = 0;
    for (pixel, &view) in ran.view_of.iter().enumerate() {
        let at = format!("pixel {pixel}, view {view} of {}", ran.views.len());
        if view as usize >= ran.views.len() {
            return Err(at);
        }
        for (k, kept) in ran.kept.iter().enumerate() {
            let want = if k == view as usize { ran.seen[pixel].map_or(0, |t| !t) } else { 0 };
            if kept[pixel] != want {
                return Err(format!("{at}: {} kept for {k}, {want} expected", kept[pixel]));
            }
        }
        for word in ran.words * pixel..ran.words * (pixel + 1) {
            let want = 1000 * view + word as u32;
            if ran.taken[word] != want {
                return Err(format!("{at}: {} taken, {want} expected", ran.taken[word]));
            }
        }
        let open = ran.seen[pixel].map(|t| (t, faces_away(world, t)));
        let (t, away) = match open {
            None => (0, Some(true)),
            Some((t, away)) => (t, away),
        };
        let Some(away) = away else { continue };
        if away {
            if view != 0 {
                return Err(format!("{at}: nothing lit is seen"));
            }
            continue;
        }
        let Some(points) = around(world, pixel as u32, t) else { continue };
        let insets: Vec<f64> = ran.views.iter().map(|view| inset(view, &points)).collect();
        let doubts: Vec<f64> = insets.iter().map(|i| 1e-2 + if i.is_finite() { 1e-3 * i.abs() } else { 0.0 }).collect();
        compared += 1;
        if !may_be_chosen(view as usize, &insets, &doubts, f64::from(REACH)) {
            return Err(format!("{at}: insets {insets:?}"));
        }
    }
    Ok(compared)
}

#[track_caller]
fn check(world: &World, views: Vec<LightView>) -> (Ran, usize) {
    let ran = ask(world, views, 3);
    match fault(world, &ran) {
        Ok(compared) => (ran, compared),
        Err(text) => panic!("{:?}: {text}", world.light),
    }
}

#[gpu_test]
fn empty() {
    let world = world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8);
    let views = windows(&world, 3, &mut Random::new(3));
    assert!(check(&world, views).0.view_of.iter().all(|&view| view == 0));
}

#[gpu_test]
fn one() {
    let mesh = random_scene(1, &mut Random::new(5));
    let world = world(gpu(), &mesh, above(), [40, 30], 64, 1);
    let (ran, compared) = check(&world, vec![world.view.map]);
    assert!(compared > 200 && ran.view_of.iter().all(|&view| view == 0));
}

#[gpu_test]
fn every_size_around_workgroup() {
    let (mesh, mut random) = (random_scene(1, &mut Random::new(31)), Random::new(7));
    for pixels in sizes_around(64) {
        let world = world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8);
        check(&world, windows(&world, 4, &mut random));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..8 {
        let mesh = random_scene(kind, &mut random);
        let world = world(gpu(), &mesh, random_light(kind % 2 == 0, &mut random), [40, 30], 64, 8);
        let (ran, compared) = check(&world, windows(&world, 2 + kind as usize % 5, &mut random));
        let asked = (0..ran.views.len() as u32).filter(|view| ran.view_of.contains(view)).count();
        assert!(compared > 50 && asked > 1, "{compared} pixels compared, {asked} views asked");
    }
}

/// A point that no view is in front of, and more views than there may be: the last are none.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(11);
    let mesh = random_scene(1, &mut random);
    let world = world(gpu(), &mesh, random_light(false, &mut random), [40, 30], 64, 8);
    let mut behind = windows(&world, 2, &mut random);
    behind[0].near = 1e9;
    let (ran, _) = check(&world, behind.clone());
    let open = |p: &usize| ran.seen[*p].is_some_and(|t| faces_away(&world, t) == Some(false));
    assert!((0..ran.seen.len()).filter(open).any(|p| ran.view_of[p] == 1));
    behind[1].near = 1e9;
    assert!(check(&world, behind).0.view_of.iter().all(|&view| view == 0));
    let many = LightViews::new(&windows(&world, 9, &mut random));
    assert_eq!(many.count as usize, LightViews::MOST);
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let world = world(gpu(), &mesh, above(), [65_537, 1], 16, 1);
    check(&world, windows(&world, 3, &mut Random::new(13)));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| {
        let world = world(gpu, &mesh, above(), [24, 24], 24, 8);
        ask(&world, windows(&world, 3, &mut Random::new(17)), 1).view_of
    };
    assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
}

/// Two paraboloids around a light; the reverse of the list is another choice.
#[gpu_test]
fn paraboloids() {
    let light = Light::Point { position: [0.1, 0.9, 0.2] };
    for kind in 0..4 {
        let mesh = random_scene(kind, &mut Random::new(83));
        let of = |k| {
            let from = camera(DVec3::new(0.8, 2.2, 4.0), DVec3::new(0.0, -0.3, 0.0), 40.0);
            World::in_paraboloid(gpu(), &mesh, (from, light), [48, 36], 64, samples(8), k)
        };
        let worlds = [of(0), of(1)];
        let (mut ran, compared) = check(&worlds[0], worlds.each_ref().map(|world| world.view.map).to_vec());
        assert!(compared > 50, "{compared} pixels compared");
        ran.views.reverse();
        assert!(fault(&worlds[0], &ran).is_err(), "the other view is as good");
    }
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 8);
    let views = windows(&world, 3, &mut Random::new(19));
    let (ran, _) = check(&world, views.clone());
    assert!(ran.view_of == ask(&world, views, 3).view_of, "another result in a second run");
    let open = |p: &usize| ran.seen[*p].is_some_and(|t| faces_away(&world, t) == Some(false));
    let clear = |p: &usize| around(&world, *p as u32, ran.seen[*p].unwrap_or(0)).is_some();
    let pixel = (0..ran.seen.len()).filter(open).find(clear).expect("a pixel");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ran.clone();
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    assert!(spoilt(&|r| r.view_of[pixel] = 7));
    assert!(spoilt(&|r| r.kept[0][pixel] ^= 5));
    assert!(spoilt(&|r| r.taken[3 * pixel + 2] += 1));
    assert!(spoilt(&|r| r.views.reverse()));
}
