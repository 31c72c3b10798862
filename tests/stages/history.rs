//! Temporal reprojection against `f64`: where rounding may turn over which pixels of the past count, or which view is asked, nothing is said.

use crate::support::shadow::{
    World, above, camera, folding_gpu, looked_down_on, random_light, random_scene, samples, sheet, uniform,
};
use crate::support::spsm::{faces_away, noise};
use crate::support::{POISON, Random, gpu, run, sizes_around, upload};
use oracle::reference::facet_classify::pixel_ray;
use oracle::reference::history::{ImageBefore, blended, confidence};
use oracle::reference::pixel_views::{inset, may_be_chosen};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::scene::Mesh;
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::history::{FrameBefore, History, HistoryBuffers};
use subpixel_shadows::stages::pixel_views::LightViews;
use test_support::gpu_test;

const REACH: f32 = 1.0;
const POWER: u32 = 3;
/// Of the kernel.
const TOLERANCE: f64 = 0.01;

/// A frame, the one before, and what the stage made of them.
#[derive(Clone)]
struct Ran {
    views: Vec<LightView>,
    seen: Vec<Option<u32>>,
    /// Whether there is a frame before.
    follows: bool,
    past: Vec<[f32; 4]>,
    given: Vec<f32>,
    visibility: Vec<f32>,
    kept: Vec<[f32; 4]>,
}

/// The world as it was before, from another place.
fn before(world: &World, mesh: &Mesh, random: &mut Random) -> World {
    let mut share = || f64::from(random.word()) / 4294967296.0 - 0.5;
    let mut eye = DVec3::new(0.8 + 0.5 * share(), 2.2 + 0.5 * share(), 4.0 + share());
    if share() > 0.25 {
        // Half as far away, so with another scale.
        eye *= 0.5;
    }
    let camera = camera(eye, DVec3::new(0.2 * share(), -0.3, 0.1), 40.0);
    World::new(world.gpu, mesh, camera, world.light, world.view.image, 8, samples(1))
}

/// Where the ray of a pixel's middle meets the plane of a triangle, and its normal of length 1.
fn on_plane(world: &World, pixel: u32, t: u32, offset: DVec2) -> Option<(DVec3, DVec3)> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let normal = (b - a).cross(c - a).normalize();
    let ray = pixel_ray(&world.view, pixel, offset);
    let depth = normal.dot(a) / normal.dot(ray);
    (normal.dot(ray).abs() > 1e-3 * ray.length() && depth > 0.0).then(|| (ray * depth, normal))
}

/// Visibility at random, and the depths that are seen: of some pixels others, of some none.
fn past_of(world: &World, random: &mut Random) -> Vec<[f32; 4]> {
    let depth = |pixel: u32, t: Option<u32>| {
        let (point, _) = on_plane(world, pixel, t?, DVec2::ZERO)?;
        Some(point.dot(world.view.rays.forward) as f32)
    };
    // Of worlds with a long past and with hardly any.
    let much = [1.0, 4.0, 0.05][random.word() as usize % 3];
    let of = |(pixel, t)| {
        let by = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.0][random.word() as usize % 8];
        let [visibility, weight] = [0, 1].map(|_| (random.word() % 1025) as f32 / 1024.0);
        [visibility, by * depth(pixel, t).unwrap_or(0.0), much * (0.5 + 0.5 * weight), 0.0]
    };
    world.seen().into_iter().map(of).collect()
}

fn ask(world: &World, was: Option<&World>, views: Vec<LightView>, seed: u64) -> Ran {
    let gpu = world.gpu;
    let (device, queue) = (&gpu.device, &gpu.queue);
    let mut random = Random::new(seed);
    let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
    let id_keys = upload(gpu, &seen.iter().map(|t| t.map_or(0, |t| !t)).collect::<Vec<_>>());
    let (frame, samples, points) = (uniform(gpu, &world.frame), world.sample_offsets(), world.points());
    let given: Vec<f32> = seen.iter().map(|_| (random.word() % 129) as f32 / 128.0).collect();
    let past = was.map_or_else(|| vec![[0.5, 1.0, 1.0, 0.0]; seen.len()], |was| past_of(was, &mut random));
    let with = HistoryBuffers::new(device, seen.len()).expect("memory");
    with.views.write(queue, &[LightViews::new(&views)]);
    with.past.write(queue, &past);
    with.kept.write(queue, &vec![[f32::from_bits(POISON); 4]; seen.len()]);
    let cameras =
        |was: &World| FrameBefore::new((&world.view.rays, world.view.scale), (&was.view.rays, was.view.scale));
    with.before.write(queue, &[was.map(cameras).unwrap_or_default()]);
    let visibility = upload(gpu, &given);
    let stage = History::new(device, REACH, POWER);
    let from =
        PrimaryHits { samples: &samples, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
    run(gpu, |s| stage.record(s, &frame, from, &with, &visibility));
    let (visibility, kept) = (visibility.read(gpu).expect("readback"), with.kept.read(gpu).expect("readback"));
    Ran { views, seen, follows: was.is_some(), past, given, visibility, kept }
}

/// The least and the greatest visibility that rounding may leave of a pixel; `None` where it may leave another past.
fn expected(world: &World, was: Option<&World>, ran: &Ran, pixel: u32, t: u32) -> Option<[[f64; 2]; 2]> {
    let offsets = [[0.0, 0.0], [-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(DVec2::from);
    let points: Option<Vec<DVec3>> =
        offsets.into_iter().map(|o| on_plane(world, pixel, t, o).map(|(point, _)| point)).collect();
    let (points, (point, normal)) = (points?, on_plane(world, pixel, t, DVec2::ZERO)?);
    let insets: Vec<f64> = ran.views.iter().map(|view| inset(view, &points)).collect();
    let doubts: Vec<f64> = insets.iter().map(|i| 1e-2 + if i.is_finite() { 1e-3 * i.abs() } else { 0.0 }).collect();
    let may = |view: &usize| may_be_chosen(*view, &insets, &doubts, f64::from(REACH));
    let mut views = (0..ran.views.len()).filter(may);
    let (Some(view), None) = (views.next(), views.next()) else { return None };
    let view = ran.views[view];
    let inside = inset(&view, &[point]);
    if inside.abs() < 0.05 {
        return None;
    }
    let [texels, _] = noise(world);
    let texel = view.project(point)?.truncate();
    let moved =
        |by: f64| [[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(move |o| by * DVec2::from(o));
    let sure = if inside < 0.0 { vec![1.0] } else { moved(4.0 * texels).map(|o| confidence(texel + o)).to_vec() };
    let given = f64::from(ran.given[pixel as usize]);
    let doubled: Vec<[f64; 3]> = ran.past.iter().map(|&[v, d, w, _]| [v, d, w].map(f64::from)).collect();
    let mut found = Vec::new();
    let pasts = match was.filter(|_| ran.follows) {
        None => vec![None],
        Some(was) => {
            let view = &was.view;
            let [by, eye] = [world.view.scale / view.scale, world.view.scale];
            let image = ImageBefore {
                eye: (view.eye - world.view.eye) * eye,
                rays: [view.rays.corner, view.rays.step_x, view.rays.step_y].map(|ray| ray * by),
                size: view.image,
                past: &doubled,
            };
            let placed = image.place(point);
            let plane = (normal, normal.dot(point));
            let tries = moved(1.0 / 256.0).into_iter().flat_map(|o| [0.97, 1.03].map(|by| (o, by)));
            tries.map(|(o, by)| image.at(placed?.0 + o, plane, by * TOLERANCE)).collect()
        }
    };
    let weights = pasts.iter().map(|past| past.map_or(0.0, |(_, weight)| weight));
    let (least, most) = weights.fold((1.0f64, 0.0f64), |(lo, hi), w| (lo.min(w), hi.max(w)));
    // Another pixel of the past counts or does not, or those that count hardly do.
    if most - least > 0.05 || (most > 0.0 && least < 0.1) {
        return None;
    }
    for past in pasts {
        found.extend(sure.iter().map(|&sure| blended(given, past.map(|(v, _)| v), sure, POWER)));
    }
    let range = |k: usize| {
        let all = found.iter().map(|v| v[k]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
    };
    let ((low, high), (lightest, heaviest)) = (range(0), range(1));
    // Between two of the places tried may lie the middle of a pixel, where the past bends.
    Some([[low - 5e-3, high + 5e-3], [0.98 * lightest - 5e-3, 1.02 * heaviest + 5e-3]])
}

/// Where the stage departs from its definition; how many pixels were compared, and how many of them took something of a past.
fn fault(world: &World, was: Option<&World>, ran: &Ran) -> Result<[usize; 2], String> {
    let (mut compared, mut mixed) = (0, 0);
    for (pixel, (&v, &[kept, depth, weight, _])) in ran.visibility.iter().zip(&ran.kept).enumerate() {
        let at = format!("pixel {pixel}: {v}, given {}, depth {depth}", ran.given[pixel]);
        if kept.to_bits() != v.to_bits() {
            return Err(format!("{at}: {kept} kept"));
        }
        let open = ran.seen[pixel].map(|t| (t, faces_away(world, t)));
        let (t, away) = match open {
            None => (0, Some(true)),
            Some((t, away)) => (t, away),
        };
        let Some(away) = away else { continue };
        if away {
            if v != ran.given[pixel] || depth != 0.0 {
                return Err(format!("{at}: nothing lit is seen"));
            }
            continue;
        }
        if let Some((point, _)) = on_plane(world, pixel as u32, t, DVec2::ZERO) {
            let want = point.dot(world.view.rays.forward);
            if (f64::from(depth) - want).abs() > 1e-3 * want {
                return Err(format!("{at}: a depth of {want} expected"));
            }
        }
        let Some([[low, high], [lightest, heaviest]]) = expected(world, was, ran, pixel as u32, t) else { continue };
        compared += 1;
        mixed += usize::from(v != ran.given[pixel]);
        if !(low..=high).contains(&f64::from(v)) {
            return Err(format!("{at}: {low} to {high} expected"));
        }
        if !(lightest..=heaviest).contains(&f64::from(weight)) {
            return Err(format!("{at}: a weight of {weight}, {lightest} to {heaviest} expected"));
        }
    }
    Ok([compared, mixed])
}

#[track_caller]
fn check(world: &World, was: Option<&World>, views: Vec<LightView>, seed: u64) -> (Ran, [usize; 2]) {
    let ran = ask(world, was, views, seed);
    match fault(world, was, &ran) {
        Ok(counts) => (ran, counts),
        Err(text) => panic!("{:?}: {text}", world.light),
    }
}

#[gpu_test]
fn empty() {
    let world = looked_down_on(gpu(), &Mesh::default(), above(), [3, 2], 8, 8);
    let (ran, _) = check(&world, None, vec![world.view.map], 3);
    assert!(ran.visibility == ran.given);
}

/// Without a frame before, all is as it is given.
#[gpu_test]
fn one() {
    let world = looked_down_on(gpu(), &random_scene(1, &mut Random::new(5)), above(), [40, 30], 64, 1);
    let (ran, [compared, _]) = check(&world, None, vec![world.view.map], 7);
    assert!(compared > 200 && ran.visibility == ran.given);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let (mesh, mut random) = (random_scene(1, &mut Random::new(31)), Random::new(7));
    for pixels in sizes_around(64) {
        let world = looked_down_on(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8);
        let was = before(&world, &mesh, &mut random);
        check(&world, Some(&was), vec![world.view.map], 9);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..8 {
        let mesh = random_scene(kind, &mut random);
        let light = random_light(kind % 2 == 0, &mut random);
        let world = looked_down_on(gpu(), &mesh, light, [40, 30], 64, 8);
        let was = before(&world, &mesh, &mut random);
        // The whole map behind a part of it.
        let view = world.view.map;
        let about = |row, at: f64| (row - view.w * at) * 2.0 + view.w * at;
        let part = LightView { u: about(view.u, 40.0), v: about(view.v, 30.0), ..view };
        let views = if kind % 3 == 0 { vec![view.jittered([0.3, -0.2])] } else { vec![part, view] };
        let (_, [compared, mixed]) = check(&world, Some(&was), views, 100 + kind as u64);
        assert!(compared > 40 && mixed > 20, "kind {kind}: {compared} pixels compared, {mixed} mixed");
    }
}

/// A camera at rest finds each pixel where it was: what is given again stays, to the bit, and one surface takes all of its own past.
#[gpu_test]
fn degenerate() {
    let mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    let world = looked_down_on(gpu(), &mesh, above(), [48, 36], 64, 1);
    let (ran, [compared, mixed]) = check(&world, Some(&world), vec![world.view.map], 11);
    assert!(compared > 200 && mixed > 100, "{compared} {mixed}");
    let near = |p: &usize| (ran.past[*p][1] - ran.kept[*p][1]).abs() < 1e-3 * ran.kept[*p][1];
    for p in (0..ran.seen.len()).filter(|p| ran.kept[*p][1] > 0.0).filter(near) {
        let [was, given, v] = [ran.past[p][0], ran.given[p], ran.visibility[p]];
        assert!(v >= was.min(given) && v <= was.max(given), "pixel {p}: {was} and {given} to {v}");
    }
    // Behind the eye before, and not of this image, is nothing of the past.
    let away = camera(DVec3::new(0.0, 2.0, 30.0), DVec3::new(0.0, 2.0, 60.0), 40.0);
    let was = World::new(gpu(), &mesh, away, above(), [48, 36], 8, samples(1));
    let other = check(&world, Some(&was), vec![world.view.map], 12).0;
    assert!(other.visibility == other.given);
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let world = looked_down_on(gpu(), &mesh, above(), [65_537, 1], 16, 1);
    let was = before(&world, &mesh, &mut Random::new(13));
    check(&world, Some(&was), vec![world.view.map], 15);
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| {
        let world = looked_down_on(gpu, &mesh, above(), [24, 24], 24, 8);
        let was = before(&world, &mesh, &mut Random::new(17));
        ask(&world, Some(&was), vec![world.view.map], 19).visibility
    };
    assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = looked_down_on(gpu(), &mesh, above(), [48, 36], 64, 8);
    let was = before(&world, &mesh, &mut Random::new(23));
    let views = vec![world.view.map];
    let (ran, _) = check(&world, Some(&was), views.clone(), 29);
    assert!(ran.visibility == ask(&world, Some(&was), views, 29).visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ran.clone();
        spoil(&mut off);
        fault(&world, Some(&was), &off).is_err()
    };
    let told = |p: &usize| {
        let t = ran.seen[*p].filter(|t| faces_away(&world, *t) == Some(false));
        t.is_some_and(|t| expected(&world, Some(&was), &ran, *p as u32, t).is_some())
    };
    let pixel = (0..ran.seen.len()).find(told).expect("a pixel");
    assert!(spoilt(&|r| r.visibility[pixel] += 0.05));
    assert!(spoilt(&|r| {
        r.visibility[pixel] += 0.05;
        r.kept[pixel][0] = r.visibility[pixel];
    }));
    assert!(spoilt(&|r| r.kept[pixel][1] *= 1.01));
    assert!(spoilt(&|r| r.kept[pixel][2] += 0.3));
    assert!(spoilt(&|r| r.past.reverse()));
    assert!(spoilt(&|r| r.follows = false));
    assert!(spoilt(&|r| r.views[0] = r.views[0].jittered([0.4, 0.0])));
}
