//! Shadows from the sub-pixel shadow map, sample by sample against the definition in `f64` on the same records. A sample whose
//! answer is another a little to the side, or at a little more or less depth, may be given either way.

use crate::support::geometry::ball;
use crate::support::shadow::{
    World, above, add_triangle, camera, folding_gpu, looked_down_on as world, random_light, random_scene, samples,
    sheet, uniform,
};
use crate::support::spsm::{Made, faces_away, noise, receiver, take_list};
use crate::support::{POISON, Random, gpu, run, sizes_around};
use oracle::reference::facet_classify::pixel_ray;
use oracle::reference::spsm_query::{PlanePoint, Query, texel_of};
use oracle::truth::{SceneTruth, Tracer};
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::PrefixScan;
use subpixel_shadows::stages::PrimaryHits;
use subpixel_shadows::stages::spsm_query::{Class, SpsmPixels, SpsmQuery, SpsmQueryOptions};
use test_support::gpu_test;

const BIAS: f32 = 1e-5;

/// Texels searched around a place's own, beyond these along the border's tangents, and whether the border is recovered.
type Search = (u32, u32, bool);
const NEAR: Search = (1, 0, true);
const SEARCHES: [Search; 5] = [NEAR, (2, 0, true), (1, 1, true), (1, 2, true), (1, 2, false)];

struct Ran {
    made: Made,
    search: Search,
    classes: Vec<u32>,
    visibility: Vec<f32>,
    lit: Vec<u32>,
    list: Vec<u32>,
    seen: Vec<Option<u32>>,
}

fn ask(world: &World, lines: bool, search: Search) -> Ran {
    let gpu = world.gpu;
    let made = Made::new(world, lines);
    let pixels = (world.view.image[0] * world.view.image[1]) as usize;
    let words = world.words();
    let out = SpsmPixels::new(&gpu.device, &gpu.queue, pixels, words).expect("memory");
    for buffer in [&out.lit, &out.marks, &out.list] {
        buffer.write(&gpu.queue, &vec![POISON; buffer.len()]);
    }
    let seen: Vec<Option<u32>> = world.seen().into_iter().map(|(_, t)| t).collect();
    let keys: Vec<u32> = seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
    let id_keys = Buffer::from_slice(&gpu.device, &gpu.queue, "test.ids", &keys).expect("memory");
    let points = world.points();
    let options = SpsmQueryOptions {
        encoding: u32::from(lines),
        words: words as u32,
        many: world.samples.count() > 1,
        radius: search.0,
        stretch: search.1,
        recovery: search.2,
        bias: BIAS,
    };
    let query = SpsmQuery::new(&gpu.device, &PrefixScan::new(&gpu.device), options, &made.texels);
    let (frame, offsets) = (uniform(gpu, &world.frame), world.sample_offsets());
    let from =
        PrimaryHits { samples: &offsets, id_keys: &id_keys, triangles: &world.casters.triangles, points: &points };
    run(gpu, |s| {
        query.record_classify(s, &frame, from, &made.texels, &out)?;
        query.record_settle(s, &frame, from, &made.texels, &out)
    });
    take_list(gpu, &made.texels.marks, &out);
    run(gpu, |s| query.record_recover(s, &frame, from, &made.texels, &out));
    assert!(!made.texels.marks.missed(gpu).expect("readback"), "a texel is missed where all are made");
    let mut list = out.list.read(gpu).expect("readback");
    list.truncate(list[pixels] as usize);
    Ran {
        search,
        classes: out.classes(gpu).expect("readback"),
        visibility: out.visibility.read(gpu).expect("readback"),
        lit: out.lit.read(gpu).expect("readback"),
        list,
        seen,
        made,
    }
}

/// Whether the ray of each sample meets triangle `t`: what it may be, as far as rounding goes.
fn on_triangle(world: &World, pixel: u32, t: u32) -> Vec<Vec<bool>> {
    let [a, b, c] = world.triangles[t as usize].corners.expect("it is seen");
    let sides = [a.cross(b - a), b.cross(c - b), c.cross(a - c)];
    let of = |offset: DVec2| {
        let ray = pixel_ray(&world.view, pixel, offset);
        let values = sides.map(|s| s.dot(ray));
        let noise = 1e-5 * ray.length() * a.length().max(b.length()) * (b - a).length().max((c - a).length());
        let inside = |by: f64| values.iter().all(|v| *v >= by) || values.iter().all(|v| *v <= -by);
        if inside(noise) == inside(-noise) { vec![inside(0.0)] } else { vec![false, true] }
    };
    if world.samples.count() == 1 {
        return vec![vec![true]];
    }
    world.samples.offsets().iter().map(|o| of(DVec2::from(o.map(f64::from)) - 0.5)).collect()
}

/// The place of a pixel's centre on its receiver.
fn middle_of(world: &World, pixel: u32, t: u32) -> Option<DVec3> {
    let [a, b, c] = world.triangles[t as usize].corners?;
    let normal = (b - a).cross(c - a);
    let ray = pixel_ray(&world.view, pixel, DVec2::ZERO);
    world.view.on_map(ray * (normal.dot(a) / normal.dot(ray))).map(|p| p.truncate())
}

/// The first of the places in the texel of `p`; none where rounding may put another first.
fn first_beside(p: DVec3, places: &[Option<DVec3>]) -> Option<usize> {
    let own = texel_of(p.truncate());
    for (k, q) in places.iter().enumerate() {
        let Some(q) = q else { continue };
        let near = |x: f64, y: f64| texel_of(q.truncate() + DVec2::new(x, y)) == own;
        let step = 2e-3;
        let around = [near(step, step), near(step, -step), near(-step, step), near(-step, -step)];
        if around.contains(&true) {
            return around.iter().all(|&n| n).then_some(k);
        }
    }
    None
}

/// Where the stage departs from its definition; how many samples were compared and how many left open.
fn fault(world: &World, ran: &Ran) -> Result<[u64; 2], String> {
    let [place, depth] = noise(world);
    let query = |bias: f64| Query {
        records: &ran.made.records,
        coding: &ran.made.coding,
        radius: ran.search.0 as i32,
        stretch: ran.search.1 as i32,
        recovery: ran.search.2,
        bias: f64::from(BIAS) + depth + bias,
        noise: place,
    };
    let (exact, more, less) = (query(0.0), query(3e-6), query(-3e-6));
    let (words, count) = (world.words(), world.samples.count());
    let uncertain: Vec<u32> =
        (0u32..).zip(&ran.classes).filter(|(_, c)| **c == Class::Uncertain as u32).map(|(p, _)| p).collect();
    if uncertain != ran.list {
        return Err(format!("{} uncertain pixels, {} listed", uncertain.len(), ran.list.len()));
    }
    let (mut compared, mut open) = (0, 0);
    for (pixel, &class) in ran.classes.iter().enumerate() {
        let masks = &ran.lit[pixel * words..(pixel + 1) * words];
        let lit = |k: u32| masks[k as usize / 32] >> (k % 32) & 1 == 1;
        let share = (0..count).filter(|&k| lit(k)).count() as f32 / count as f32;
        let at = format!("pixel {pixel}, class {class}");
        let Some(t) = ran.seen[pixel] else {
            if class != Class::Empty as u32 || ran.visibility[pixel] != 1.0 {
                return Err(format!("{at}: nothing is seen"));
            }
            continue;
        };
        let Some(dark) = faces_away(world, t) else { continue };
        if dark != (class == Class::Dark as u32) {
            return Err(format!("{at}: that it faces away from the light is {dark}"));
        }
        if class == Class::Dark as u32 {
            if ran.visibility[pixel] != 0.0 || masks.iter().any(|m| *m != 0) {
                return Err(format!("{at}: dark, and lit"));
            }
            continue;
        }
        let Some((places, slope, far)) = receiver(world, pixel as u32, t) else { continue };
        if places.iter().all(Option::is_some) && (ran.visibility[pixel] - share).abs() > 1e-6 {
            return Err(format!("{at}: visibility {}, lit share {share}", ran.visibility[pixel]));
        }
        if class == Class::Shadowed as u32 {
            if masks.iter().any(|m| *m != 0) || ran.visibility[pixel] != 0.0 {
                return Err(format!("{at}: shadowed, and lit"));
            }
            // One sheet covers all samples, a little less of them will do; or each is shadowed by itself.
            let there: Vec<DVec3> = places.iter().flatten().copied().collect();
            let (low, high) =
                there.iter().fold((DVec2::MAX, DVec2::MIN), |(l, h), p| (l.min(p.truncate()), h.max(p.truncate())));
            let Some(centre) = middle_of(world, pixel as u32, t) else { continue };
            if less.covered(low + 2e-3, (high - 2e-3).max(low + 2e-3), centre, slope) {
                compared += u64::from(count);
                continue;
            }
        }
        let owned = on_triangle(world, pixel as u32, t);
        let Some(centre) = middle_of(world, pixel as u32, t) else { continue };
        for (k, p) in (0..count).zip(&places) {
            let Some(p) = *p else { continue };
            let Some(first) = first_beside(p, &places[..=k as usize]) else { continue };
            let start = places[first].expect("it is a place");
            let known = owned[k as usize].iter().flat_map(|o| owned[first].iter().map(move |f| [*o, *f]));
            let at_depth = |q: &Query, x: f64, y: f64, z: f64| {
                let step = DVec3::new(x, y, slope.dot(DVec2::new(x, y)) + z);
                let place = |at: DVec3, own| PlanePoint { at: at + step, own };
                let mut answers =
                    known.clone().map(|[o, f]| q.shadowed(place(p, o), place(start, f), centre + step, slope, far));
                let first = answers.next();
                first.filter(|f| answers.all(|a| a == *f))
            };
            let answer = |q: &Query, x: f64, y: f64| at_depth(q, x, y, 0.0);
            let shadowed = answer(&exact, 0.0, 0.0);
            let step = 2e-3;
            let sure = shadowed.is_some()
                && [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)]
                    .iter()
                    .all(|&(x, y)| answer(&exact, x, y) == shadowed)
                && answer(&more, 0.0, 0.0) == shadowed
                && answer(&less, 0.0, 0.0) == shadowed
                && [3e-6, -3e-6].iter().all(|&z| at_depth(&exact, 0.0, 0.0, z) == shadowed)
                && [&more, &less].iter().all(|q| [step, -step].iter().all(|&x| answer(q, x, -x) == shadowed));
            compared += 1;
            open += u64::from(!sure);
            if sure && shadowed == Some(lit(k)) {
                return Err(format!("{at}, sample {k} at {p:?}, slope {slope:?}: shadowed {shadowed:?} expected"));
            }
        }
    }
    Ok([compared, open])
}

#[track_caller]
fn check(world: &World, lines: bool, search: Search) -> Ran {
    let ran = ask(world, lines, search);
    match fault(world, &ran) {
        Ok([compared, open]) => assert!(open * 4 <= compared + 40, "{open} of {compared} samples are left open"),
        Err(text) => panic!("lines {lines}, search {search:?}, {:?}: {text}", world.light),
    }
    ran
}

#[gpu_test]
fn empty() {
    let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 8, 8), true, NEAR);
    assert!(ran.visibility.iter().all(|&v| v == 1.0) && ran.list.is_empty());
}

#[gpu_test]
fn one() {
    // A floor, and a floor under a roof.
    let floor = sheet(1, 2.0, |_, _| 0.0, |p| p);
    let ran = check(&world(gpu(), &floor, above(), [16, 12], 32, 32), true, NEAR);
    assert!(ran.classes.contains(&(Class::Lit as u32)) && !ran.classes.contains(&(Class::Shadowed as u32)));
    let mut roofed = floor.clone();
    add_triangle(&mut roofed, [[-1.0, 0.8, -1.0], [1.0, 0.8, -1.0], [0.0, 0.8, 1.0]]);
    for lines in [false, true] {
        let ran = check(&world(gpu(), &roofed, above(), [96, 72], 64, 32), lines, NEAR);
        let classes = [Class::Lit, Class::Shadowed, Class::Uncertain];
        assert!(classes.iter().all(|&c| ran.classes.contains(&(c as u32))), "every class is there");
        assert!(ran.visibility.iter().any(|&v| v > 0.0 && v < 1.0), "no edge is smooth");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for pixels in sizes_around(64) {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), true, NEAR);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(41);
    for kind in 0..4 {
        for (k, count) in [1, 8, 32, 128].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            check(
                &world(gpu(), &mesh, light, [40, 30], [64, 150][k / 2], count),
                k % 2 == 1,
                SEARCHES[(k + kind as usize) % SEARCHES.len()],
            );
        }
    }
}

/// A bare plane never shadows itself, whatever its tilt, under either encoding; and no sheet shades its own front.
#[gpu_test]
fn degenerate() {
    for degrees in [0.0f64, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0, 89.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let mesh = sheet(6, 1.5, |_, _| 0.0, |p| DVec3::new(p.x * cos, p.x * sin, p.z));
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let camera = camera(DVec3::new(-3.0, 4.0, 1.0), DVec3::ZERO, 40.0);
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], 128, samples(8));
        for lines in [false, true] {
            let ran = ask(&world, lines, NEAR);
            let dark = ran.visibility.iter().filter(|v| **v < 1.0).count();
            assert_eq!(dark, 0, "lines {lines}, {degrees} degrees: {dark} pixels of acne");
            assert!(ran.seen.iter().any(Option::is_some));
        }
    }
    // A sheet edge-on to the light.
    let mesh = sheet(3, 1.0, |_, _| 0.0, |p| DVec3::new(p.x, p.z, 0.1));
    check(&world(gpu(), &mesh, Light::Directional { direction: [0.0, 1.0, 0.0] }, [20, 15], 40, 8), true, NEAR);
}

/// Samples beside the triangle at a pixel's centre lie on its plane, in a bowl below the surface that is there: its neighbours shade
/// none of them.
#[gpu_test]
fn a_bowl_does_not_shade_itself() {
    let mesh = sheet(90, 2.0, |x, z| 0.2 * (x * x + z * z), |p| p);
    let light = Light::Directional { direction: [0.2, 1.0, 0.1] };
    let camera = camera(DVec3::new(0.3, 4.0, 2.0), DVec3::ZERO, 40.0);
    for map in [128, 512] {
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], map, samples(32));
        for lines in [false, true] {
            let ran = ask(&world, lines, (1, 2, true));
            let dark = ran.visibility.iter().map(|v| 1.0 - f64::from(*v)).sum::<f64>() / ran.visibility.len() as f64;
            println!("lines {lines}, map {map}: {:.4} % of the light is missing", 100.0 * dark);
            assert!(dark < 0.02, "lines {lines}, map {map}: {dark} of the light is missing");
        }
    }
}

/// What is searched beyond the 3 x 3 texels, in a larger square or along the border's tangents, changes the answer.
#[gpu_test]
fn searches_along_the_border() {
    // Triangles smaller than a texel, over a floor: the square misses some at the border.
    let mut mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    ball(&mut mesh, DVec3::new(0.0, 0.9, 0.0), 0.6, 40, 30);
    let world = world(gpu(), &mesh, above(), [80, 60], 48, 32);
    for search in &SEARCHES[1..] {
        let ran = check(&world, true, *search);
        let judged = fault(&world, &Ran { search: NEAR, ..ran });
        assert!(judged.is_err(), "{search:?} is no other than {NEAR:?}: {judged:?}");
    }
}

/// A ground far behind all casters lies beyond the range of depths: it shadows nothing, and takes shadows as any other.
#[gpu_test]
fn ground_behind_all_casters() {
    for distance in [1.0, 3.0, 30.0] {
        let mut mesh = sheet(2, 2.0, |_, _| 0.0, |p| p);
        add_triangle(&mut mesh, [[-1.0, distance, -1.0], [1.0, distance, -1.0], [0.0, distance, 1.0]]);
        let camera = camera(DVec3::new(-3.0, 2.5, 1.0), DVec3::ZERO, 40.0);
        let light = Light::Directional { direction: [0.05, 1.0, 0.02] };
        let world = World::new(gpu(), &mesh, camera, light, [60, 45], 128, samples(8));
        let tracer = Tracer::new(world.prepared.mesh()).expect("a tracer");
        let truth = SceneTruth::new(&tracer, &world.camera, &light, &world.samples, 60, 45).expect("a truth");
        let truth = truth.image(None).visibility();
        for lines in [false, true] {
            let ran = ask(&world, lines, NEAR);
            let off = ran.visibility.iter().zip(&truth).map(|(a, b)| f64::from(a - b).abs()).sum::<f64>();
            let dark = truth.iter().map(|v| 1.0 - f64::from(*v)).sum::<f64>();
            assert!(dark > 20.0, "no shadow to see at {distance}: {dark}");
            assert!(off < 0.05 * dark, "lines {lines}, {distance}: {off} of {dark} dark pixels");
        }
    }
}

/// More pixels than one dimension of a dispatch of single invocations holds, all of them uncertain or not.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), true, NEAR);
    assert_eq!(ran.classes.len(), 65_537);
    assert!(!ran.classes.contains(&POISON) && !ran.lit.contains(&POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    // Nine workgroups in three rows.
    let of = |gpu| ask(&world(gpu, &mesh, above(), [24, 24], 24, 8), true, NEAR);
    let (a, b) = (of(folding_gpu()), of(gpu()));
    assert!(a.lit == b.lit && a.classes == b.classes && a.list == b.list, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    let world = world(gpu(), &mesh, above(), [48, 36], 64, 32);
    let ran = check(&world, true, NEAR);
    let again = ask(&world, true, NEAR);
    assert!(ran.lit == again.lit && ran.visibility == again.visibility, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ask(&world, true, NEAR);
        spoil(&mut off);
        fault(&world, &off).is_err()
    };
    let of = |class: Class| ran.classes.iter().position(|&c| c == class as u32);
    let lit = of(Class::Lit).expect("a lit pixel");
    assert!(spoilt(&|r| r.lit[lit] = 0));
    assert!(spoilt(&|r| r.visibility[lit] = 0.5));
    assert!(spoilt(&|r| r.classes[lit] = Class::Dark as u32));
    assert!(spoilt(&|r| r.classes[lit] = Class::Uncertain as u32));
    let dark = of(Class::Shadowed).expect("a shadowed pixel");
    assert!(spoilt(&|r| r.lit[dark] = u32::MAX));
    // A map without casters lights everything.
    assert!(spoilt(&|r| r.made.records.fill([0, 0, 0, u32::MAX])));
}
