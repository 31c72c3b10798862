//! Surfaces that cast nothing in the lists of pixels, against their definition.

use crate::support::shadow::{Pipelines, World, camera, folding_gpu, random_scene, samples, uniform, unit, vector};
use crate::support::{POISON, Random, filled_texture, gpu, poisoned, read_padded, run, sizes_around, upload};
use oracle::reference::prefix_scan::exclusive;
use oracle::reference::surface_receivers::{OWN, ReceiverImage, ShownSurface};
use std::collections::BTreeMap;
use subpixel_shadows::frame::sample_words;
use subpixel_shadows::glam::{DVec2, DVec3, Vec3};
use subpixel_shadows::gpu::{Buffer, Gpu, Groups};
use subpixel_shadows::scene::Light;
use subpixel_shadows::stages::pixel_coverage::{Covering, PairCoverage};
use subpixel_shadows::stages::pixel_receivers::{GIVEN_POSITIONS, GivenTexture, PixelReceiversParams, unread_samples};
use subpixel_shadows::stages::pixel_triangles::{PixelLists, PixelPair};
use subpixel_shadows::stages::surface_receivers::{
    GivenSurfaces, ListedPixels, ReceiverPlaces, SurfaceReceivers, WORKGROUP,
};
use subpixel_shadows::wgpu;
use test_support::gpu_test;

const TOLERANCE: f32 = 1e-3;

/// An image of casters, receivers, places that are none, and nothing, in patches.
struct Case {
    world: World,
    /// World positions, alpha 0 of nothing.
    texels: Vec<[f32; 4]>,
    keys: Vec<u32>,
    /// Corners of each pixel's receiver, world units.
    corners: Vec<[[f32; 3]; 3]>,
    /// Casters counted in each pixel, and whether one covers it.
    counted: Vec<(u32, bool)>,
}

impl Case {
    fn new(gpu: &'static Gpu, size: [u32; 2], count: u32, random: &mut Random) -> Self {
        let mesh = random_scene(random.below(4), random);
        let eye = vector(random).normalize() * (1.5 + 2.0 * unit(random));
        let light = Light::Directional { direction: [0.3, 1.0, 0.2] };
        let mut world = World::new(gpu, &mesh, camera(eye, vector(random) * 0.3, 50.0), light, size, 8, samples(count));
        world.frame.image_size = size;
        let view = world.view;
        let planes: Vec<(DVec3, f64)> =
            (0..3).map(|_| (vector(random).normalize(), 1.0 + 2.0 * unit(random))).collect();
        let pixels = size[0] * size[1];
        let (mut texels, mut keys, mut corners) = (Vec::new(), Vec::new(), Vec::new());
        for pixel in 0..pixels {
            let (x, y) = (pixel % size[0], pixel / size[0]);
            let ray = view.rays.direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
            // Seen from the eye, planes of a normal at a distance.
            let (normal, away) = match random.below(8) {
                0 => (vector(random).normalize(), 0.5 + 2.0 * unit(random)),
                _ => planes[((x / 7 + y / 5) % 3) as usize],
            };
            let facing = if normal.dot(ray) > 0.0 { normal } else { -normal };
            let depth = (away / facing.dot(ray).max(0.05)).min(6.0);
            let place = view.rays.eye + ray * depth;
            let kind = random.below(20);
            let at = if kind == 1 { Vec3::NAN } else { place.as_vec3() };
            texels.push(at.extend(if kind == 0 { 0.0 } else { 1.0 }).into());
            let receives = kind > 1 && (random.below(3) > 0) == ((x / 3 + y / 4) % 3 > 0);
            keys.push(match kind {
                0 | 1 => 0,
                _ if receives => !(world.frame.triangle_count + pixel),
                _ => !random.below(world.frame.triangle_count),
            });
            let (u, leg) = (normal.any_orthonormal_vector(), 2.0 * at.abs().max_element().max(depth as f32));
            let v = normal.cross(u);
            let corner = |a: f64, b: f64| (at.as_dvec3() + f64::from(leg) * (a * u + b * v)).as_vec3().into();
            corners.push([corner(-1.0, -1.0), corner(1.0, 0.0), corner(0.0, 1.0)]);
        }
        let counted = (0..pixels).map(|_| (random.below(4), random.below(3) == 0)).collect();
        Self { world, texels, keys, corners, counted }
    }

    fn is_receiver(&self, pixel: usize) -> bool {
        self.keys[pixel] != 0 && !self.keys[pixel] >= self.world.frame.triangle_count
    }

    fn shown(&self) -> Vec<ShownSurface> {
        let place = |p: usize| self.world.view.point([0, 1, 2].map(|k| self.texels[p][k]));
        let shown = |p: usize| match (self.texels[p][3] == 0.0, self.texels[p][0].is_nan()) {
            (true, _) => ShownSurface::Nothing,
            (_, true) => ShownSurface::Unknown,
            _ if self.is_receiver(p) => {
                ShownSurface::Receiver(place(p), self.corners[p].map(|c| self.world.view.point(c)))
            }
            _ => ShownSurface::Caster(place(p)),
        };
        (0..self.keys.len()).map(shown).collect()
    }

    /// Whether a pixel that shows a caster may show more.
    fn asks(&self, pixel: usize) -> bool {
        let (count, covered) = self.counted[pixel];
        !self.is_receiver(pixel) && self.keys[pixel] != 0 && count > 0 && !(count == 1 && covered)
    }
}

/// Everything that was written.
#[derive(Clone, PartialEq)]
struct Got {
    points: Vec<[f32; 4]>,
    cover_keys: Vec<u32>,
    id_keys: Vec<u32>,
    chosen: Vec<u32>,
    counts: Vec<u32>,
    list: Vec<PixelPair>,
    /// Elements of the list that casters keep.
    kept: Vec<u32>,
    /// Of each pixel its coverings behind those of casters.
    covered: BTreeMap<usize, Vec<(Covering, u128)>>,
    /// Words past the end of lists.
    spare: Vec<u32>,
}

fn ask(case: &Case, room: Option<usize>) -> Got {
    static STAGES: Pipelines<SurfaceReceivers> = Pipelines::new();
    let (world, pixels) = (&case.world, case.keys.len());
    let (gpu, words) = (world.gpu, world.words());
    let count = world.samples.count();
    let stage = STAGES.get(gpu, words, || SurfaceReceivers::new(&gpu.device, count));
    let vertices = world.frame.vertex_count as usize;
    let rows = |p: &[f32; 3]| [p[0], p[1], p[2], 0.0];
    let all: Vec<[f32; 4]> =
        world.prepared.mesh().positions.iter().chain(case.corners.iter().flatten()).map(rows).collect();
    let with_room = |data: &[[f32; 4]]| {
        let buffer = Buffer::with_room(&gpu.device, &gpu.queue, "test", &[], vertices + 3 * pixels).expect("memory");
        gpu.queue.write_buffer(buffer.raw(), 0, bytemuck::cast_slice(data));
        buffer
    };
    let (positions, points) = (with_room(&all), with_room(&vec![[f32::NAN; 4]; all.len()]));
    let (size, format) = (world.view.image, wgpu::TextureFormat::Rgba32Float);
    let place = filled_texture(gpu, size, format, bytemuck::cast_slice(&case.texels));
    let params =
        PixelReceiversParams { given: GIVEN_POSITIONS, tolerance: TOLERANCE, ..PixelReceiversParams::at_centres() };
    let unread = unread_samples(&gpu.device);
    let keys = upload(gpu, &case.keys);
    let place = GivenTexture { single: &place, samples: &unread };
    let given = GivenSurfaces { params, place, keys: &keys };
    let offsets_of_samples = Buffer::uniform(&gpu.device, "samples", 64).expect("memory");
    offsets_of_samples.write(&gpu.queue, &sample_words(&world.samples));
    let mut frame = world.frame;
    let lists = PixelLists::new(&gpu.device, pixels, 1).expect("memory");
    let (id_keys, chosen) = (upload(gpu, &vec![0u32; pixels]), poisoned::<u32>(gpu, pixels));
    let uniform_frame = uniform(gpu, &frame);
    run(gpu, |s| {
        let places = ReceiverPlaces { positions: &positions, points: &points };
        stage.record_own(s, &uniform_frame, given, places, &lists, &id_keys, &chosen)
    });
    let of_all = Buffer::<[f32; 4]>::storage(&gpu.device, "test.copy", all.len()).expect("memory");
    let mut encoder = gpu.encoder();
    encoder.copy_buffer_to_buffer(points.raw(), 0, of_all.raw(), 0, 16 * all.len() as u64);
    gpu.submit_and_wait(encoder).expect("the copy runs");
    let made = of_all.read(gpu).expect("readback");
    let cover_keys = lists.cover_keys.read(gpu).expect("readback");
    // As if casters had been counted.
    let own = lists.counts.read(gpu).expect("readback");
    let counts: Vec<u32> = own.iter().zip(&case.counted).map(|(own, (count, _))| own + count).collect();
    let covers: Vec<u32> = (0..pixels).map(|p| if case.counted[p].1 { 77 } else { cover_keys[p] }).collect();
    lists.counts.write(&gpu.queue, &counts);
    lists.cover_keys.write(&gpu.queue, &covers);
    run(gpu, |s| stage.record_choose(s, &uniform_frame, given, &points, &lists, &id_keys, &chosen));
    let chosen_bits = chosen.read(gpu).expect("readback");
    let counts = lists.counts.read(gpu).expect("readback");
    let covers = lists.cover_keys.read(gpu).expect("readback");
    // As pixel_triangles lists them: none of pixels that one triangle covers.
    let listed: Vec<u32> = (0..pixels).map(|p| if counts[p] == 1 && covers[p] != 0 { 0 } else { counts[p] }).collect();
    let offsets = exclusive(&listed).sums;
    let total = listed.iter().sum::<u32>() as usize;
    let room = room.unwrap_or(total);
    frame.pixel_triangle_capacity = room as u32;
    let complex: Vec<u32> = (0..pixels as u32).filter(|&p| listed[p as usize] > 0).collect();
    frame.complex_capacity = complex.len() as u32;
    let lists = PixelLists {
        list: poisoned(gpu, room),
        counts: upload(gpu, &listed),
        offsets: upload(gpu, &offsets.iter().copied().chain([total as u32, 0]).take(pixels + 2).collect::<Vec<_>>()),
        ..lists
    };
    let uniform_frame = uniform(gpu, &frame);
    run(gpu, |s| stage.record_list(s, &uniform_frame, &lists, &chosen));
    let kept = lists.counts.read(gpu).expect("readback");
    // Some of the casters cover samples.
    let casters: Vec<u32> = kept.iter().map(|n| n / 2).collect();
    lists.counts.write(&gpu.queue, &casters);
    let coverage = PairCoverage { list: poisoned(gpu, room), masks: poisoned(gpu, room * words) };
    let (pixels_listed, number) = (upload(gpu, &complex), upload(gpu, &[complex.len() as u32, 0]));
    run(gpu, |s| {
        let groups = Groups::Items(complex.len().max(1) as u64);
        let listed = ListedPixels { pixels: &pixels_listed, total: &number, groups };
        stage.record_cover(s, &uniform_frame, &offsets_of_samples, given, &points, listed, &lists, (&coverage, &chosen))
    });
    let ends = lists.counts.read(gpu).expect("readback");
    let (coverings, masks) = (coverage.list.read(gpu).expect("readback"), coverage.masks.read(gpu).expect("readback"));
    let covered = complex.iter().map(|&p| {
        let p = p as usize;
        let mask = |n: usize| (0..words).map(|w| u128::from(masks[n * words + w]) << (32 * w)).sum();
        let range = offsets[p] + casters[p]..offsets[p] + ends[p];
        (p, range.map(|n| (coverings[n as usize], mask(n as usize))).collect())
    });
    let mut spare = read_padded(gpu, &lists.list).split_off(2 * room);
    spare.extend(read_padded(gpu, &coverage.masks).split_off(room * words));
    Got {
        covered: covered.collect(),
        points: made,
        cover_keys,
        id_keys: id_keys.read(gpu).expect("readback"),
        chosen: chosen_bits,
        counts,
        list: lists.list.read(gpu).expect("readback"),
        kept,
        spare,
    }
}

/// Departures from the definition; how many pixels were open to rounding; how many samples see a receiver for sure.
fn faults(case: &Case, got: &Got) -> (Vec<String>, usize, u32) {
    let world = &case.world;
    let shown = case.shown();
    let image = ReceiverImage { view: &world.view, shown: &shown, tolerance: f64::from(TOLERANCE) };
    let offsets: Vec<DVec2> =
        world.samples.offsets().iter().map(|o| DVec2::new(o[0].into(), o[1].into()) - 0.5).collect();
    let (casters, vertices) = (world.frame.triangle_count, world.frame.vertex_count as usize);
    let (mut out, mut open, mut seen, mut at) = (Vec::new(), 0, 0, 0);
    for pixel in 0..case.keys.len() {
        let mut fault = |text: String| out.push(format!("pixel {pixel}: {text}"));
        let receives = case.is_receiver(pixel);
        let own = &got.points[vertices + 3 * pixel..][..3];
        if receives {
            let wrong = |k: usize| {
                let want = world.view.point(case.corners[pixel][k]);
                (Vec3::from_slice(&own[k][..3]).as_dvec3() - want).length() > 1e-6 * want.length() || own[k][3] != 1.0
            };
            if (0..3).any(wrong) {
                fault(format!("points {own:?}"));
            }
            let [least, most] = [0.5, 0.56].map(|half| image.farthest_over(pixel, half));
            match (got.cover_keys[pixel], least, most) {
                (0, _, Some(far)) if far < 5.0 => fault("passes for a part".to_owned()),
                (0, ..) => {}
                (_, None, _) => fault("passes for all of the square".to_owned()),
                (key, Some(least), most) => {
                    let far = f64::from(f32::from_bits(!key));
                    if far < least || most.is_some_and(|most| far > 1.02 * most) {
                        fault(format!("{far} off, {least} to {most:?} expected"));
                    }
                }
            }
        } else if own.iter().flatten().any(|v| !v.is_nan()) || got.cover_keys[pixel] != 0 {
            fault(format!("{own:?} and {:x} of no receiver", got.cover_keys[pixel]));
        }
        let alone = !receives && case.keys[pixel] != 0 && case.counted[pixel].0 == 0;
        if got.id_keys[pixel] != if receives || alone { case.keys[pixel] } else { 0 } {
            fault(format!("key {:x}", got.id_keys[pixel]));
        }
        let want = image.chosen(pixel);
        let bits = if receives || case.asks(pixel) { want.bits } else { 0 };
        let unsure = want.open && case.asks(pixel);
        open += usize::from(unsure);
        let chosen = got.chosen[pixel];
        if chosen != bits && !unsure {
            fault(format!("{chosen:b} are chosen, not {bits:b}"));
        }
        let count = case.counted[pixel].0 + chosen.count_ones() + u32::from(alone);
        if got.counts[pixel] != count {
            fault(format!("{} are counted, not {count}", got.counts[pixel]));
        }
        let Some(covered) = got.covered.get(&pixel) else {
            if count > 1 {
                fault("is not listed".to_owned());
            }
            continue;
        };
        let around: Vec<u32> = (0..25).filter(|k| chosen >> k & 1 == 1).collect();
        let triangles: Vec<u32> =
            around.iter().filter_map(|&k| Some(casters + image.around(pixel, k)? as u32)).collect();
        let first = at + case.counted[pixel].0 as usize;
        let filled = |p: &PixelPair| *p == PixelPair { triangle: u32::MAX, pixel: pixel as u32 + 1 };
        let rest = &got.list[first..first + triangles.len()];
        if !rest.iter().all(filled) || got.list[at..first].iter().any(|p| p.triangle != POISON) {
            fault(format!("{:?} and {rest:?} are listed", &got.list[at..first]));
        }
        if got.kept[pixel] != case.counted[pixel].0 {
            fault(format!("{} elements are left to casters", got.kept[pixel]));
        }
        at = first + triangles.len();
        if covered.iter().map(|(c, _)| c.triangle).ne(triangles.iter().copied()) {
            fault(format!("{covered:?} cover, not {triangles:?}"));
            continue;
        }
        for ((k, want), (c, mask)) in image.samples(pixel, chosen, &offsets).into_iter().zip(covered) {
            if want.sure & !mask != 0 || mask & !want.possible != 0 {
                fault(format!("receiver {k}: {mask:x}, {want:x?}"));
            }
            let Some(ShownSurface::Receiver(_, [a, b, d])) = image.around(pixel, k).map(|q| shown[q]) else { continue };
            let n = (b - a).cross(d - a);
            seen += want.sure.count_ones();
            for s in (0..offsets.len()).filter(|s| want.sure >> s & 1 == 1) {
                let (x, y) = (pixel as u32 % world.view.image[0], pixel as u32 / world.view.image[0]);
                let ray =
                    world.view.rays.direction(f64::from(x) + 0.5 + offsets[s].x, f64::from(y) + 0.5 + offsets[s].y);
                let slope = offsets[s].x * f64::from(c.slope_x) + offsets[s].y * f64::from(c.slope_y);
                let [low, high] = [c.low, c.high].map(|bound| f64::from(bound) + slope);
                let inverse = n.dot(ray) / n.dot(a);
                if !(low..=high).contains(&inverse) {
                    fault(format!("receiver {k}, sample {s}: {inverse}, {low} to {high}"));
                }
            }
        }
    }
    if got.spare.iter().any(|&w| w != POISON) {
        out.push("written past the end".to_owned());
    }
    (out, open, seen)
}

#[track_caller]
fn check(case: &Case) -> (Got, u32) {
    let got = ask(case, None);
    let (found, open, seen) = faults(case, &got);
    assert!(found.is_empty(), "{}: {}", found.len(), found[..found.len().min(5)].join("\n"));
    assert!(open * 10 < case.keys.len() + 100, "{open} of {} pixels are open to rounding", case.keys.len());
    (got, seen)
}

#[gpu_test]
fn empty() {
    let mut case = Case::new(gpu(), [5, 3], 8, &mut Random::new(1));
    case.texels.iter_mut().for_each(|t| t[3] = 0.0);
    case.keys.fill(0);
    let (got, seen) = check(&case);
    assert!(seen == 0 && got.chosen.iter().all(|&bits| bits == 0));
}

#[gpu_test]
fn one() {
    let mut random = Random::new(2);
    for key in [0, 1] {
        let mut case = Case::new(gpu(), [1, 1], 8, &mut random);
        case.texels[0] = (case.world.view.rays.eye + case.world.view.rays.forward).as_vec3().extend(1.0).into();
        case.keys[0] = if key == 0 { !0 } else { !case.world.frame.triangle_count };
        case.counted[0] = (2, false);
        let (got, _) = check(&case);
        assert_eq!(got.chosen, [key << OWN]);
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(3);
    for pixels in sizes_around(WORKGROUP as usize) {
        check(&Case::new(gpu(), [pixels as u32, 1], 8, &mut random));
        check(&Case::new(gpu(), [1, pixels as u32], 8, &mut random));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(4);
    let (mut around, mut own, mut seen) = (0, 0, 0);
    for count in [1, 8, 32, 128] {
        for _ in 0..4 {
            let case = Case::new(gpu(), [41, 29], count, &mut random);
            let (got, sure) = check(&case);
            own += got.chosen.iter().filter(|&&bits| bits == 1 << OWN).count();
            around += got.chosen.iter().filter(|&&bits| bits != 0 && bits != 1 << OWN).count();
            seen += sure;
        }
    }
    assert!(own > 3000 && around > 2000 && seen > 50_000, "{own}, {around} pixels, {seen} samples");
}

/// Receivers of one plane are one, and those of a hole in the casters are found from two pixels away.
#[gpu_test]
fn receivers_of_one_plane_are_one() {
    let mut random = Random::new(5);
    let mut case = Case::new(gpu(), [9, 9], 32, &mut random);
    let view = case.world.view;
    let (normal, away) = (view.rays.forward, 2.0);
    for pixel in 0..81u32 {
        let ray = view.rays.direction(f64::from(pixel % 9) + 0.5, f64::from(pixel / 9) + 0.5);
        let (p, at) = (pixel as usize, view.rays.eye + ray * away / normal.dot(ray));
        // Casters in a square of three times three, before the plane.
        let caster = (3..6).contains(&(pixel % 9)) && (3..6).contains(&(pixel / 9));
        case.texels[p] = (if caster { view.rays.eye + ray } else { at }).as_vec3().extend(1.0).into();
        case.keys[p] = if caster { !1 } else { !(case.world.frame.triangle_count + pixel) };
        let (u, v) = (normal.any_orthonormal_vector() * 8.0, normal.any_orthonormal_vector().cross(normal) * 8.0);
        case.corners[p] = [at - u - v, at + u, at + v].map(|c| c.as_vec3().into());
        case.counted[p] = (2, false);
    }
    let (got, _) = check(&case);
    for (pixel, around) in [(30, 1), (31, 1), (40, 1)] {
        assert_eq!(got.chosen[pixel].count_ones(), around, "pixel {pixel}: {:b}", got.chosen[pixel]);
    }
    assert!(got.covered[&40].iter().all(|(_, mask)| *mask == 0xffff_ffff), "the plane goes on behind the casters");
    // Before the casters it does not.
    let casters: Vec<usize> = (0..81).filter(|&p| !case.is_receiver(p)).collect();
    casters.into_iter().for_each(|p| {
        let ray = view.rays.direction((p % 9) as f64 + 0.5, (p / 9) as f64 + 0.5);
        case.texels[p] = (view.rays.eye + ray * 3.0).as_vec3().extend(1.0).into();
    });
    let (got, _) = check(&case);
    assert!([30, 31, 40].iter().all(|&p| got.chosen[p] == 0), "receivers before what pixels show");
}

#[gpu_test]
fn degenerate() {
    let mut random = Random::new(6);
    let mut case = Case::new(gpu(), [23, 17], 32, &mut random);
    // Receivers of no extent, at the eye, and far away: no more is asked than that frames end and write where they may.
    for p in 0..case.corners.len() {
        let eye = case.world.view.rays.eye.as_vec3();
        match p % 4 {
            0 => case.corners[p] = [case.corners[p][0]; 3],
            1 => case.corners[p] = [eye.into(); 3],
            2 => case.corners[p] = case.corners[p].map(|c| c.map(|v| v * 1e18)),
            _ => case.corners[p] = [[f32::NAN; 3]; 3],
        }
    }
    let got = ask(&case, None);
    assert!(got.spare.iter().all(|&w| w == POISON));
    let masks: Vec<u128> =
        (0..case.keys.len()).step_by(4).filter_map(|p| got.covered.get(&p)).flatten().map(|c| c.1).collect();
    assert!(!masks.is_empty());
}

#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(7);
    let case = Case::new(gpu(), [31, 23], 32, &mut random);
    let (all, _) = check(&case);
    let total = all.list.len();
    for room in [0, 1, total / 2, total - 1] {
        let got = ask(&case, Some(room));
        assert!(got.spare.iter().all(|&w| w == POISON), "written past {room} of {total}");
        assert!(got.list.iter().zip(&all.list).all(|(a, b)| a == b), "{room} of {total}: another list");
        assert!(2 * room > total || got.covered != all.covered, "{room} of {total}: nothing is missing");
    }
    // No room behind the casters is an error.
    let world = &case.world;
    let none = Buffer::with_room(&world.gpu.device, &world.gpu.queue, "test", &[], 2).expect("memory");
    let lists = PixelLists::new(&world.gpu.device, 1, 1).expect("memory");
    let (word, frame) = (upload(world.gpu, &[0u32]), uniform(world.gpu, &world.frame));
    let place = filled_texture(world.gpu, [1, 1], wgpu::TextureFormat::R32Float, &[0; 4]);
    let unread = unread_samples(&world.gpu.device);
    let place = GivenTexture { single: &place, samples: &unread };
    let given = GivenSurfaces { params: Default::default(), place, keys: &word };
    let stage = SurfaceReceivers::new(&world.gpu.device, 8);
    run(world.gpu, |s| {
        let places = ReceiverPlaces { positions: &none, points: &none };
        let asked = stage.record_own(s, &frame, given, places, &lists, &word, &word);
        assert!(asked.is_err(), "two vertices pass for a triangle");
    });
}

#[gpu_test]
fn two_d_dispatch() {
    let make = |gpu| check(&Case::new(gpu, [24, 24], 32, &mut Random::new(8))).0;
    let (small, all) = (make(folding_gpu()), make(gpu()));
    assert!(small.chosen == all.chosen && small.covered == all.covered, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(gpu(), [41, 29], 32, &mut Random::new(9));
    let (got, _) = check(&case);
    let broken = |change: &dyn Fn(&mut Got)| {
        let mut got = got.clone();
        change(&mut got);
        !faults(&case, &got).0.is_empty()
    };
    assert!(!broken(&|_| {}));
    let image = case.shown();
    let view = ReceiverImage { view: &case.world.view, shown: &image, tolerance: f64::from(TOLERANCE) };
    let sure = |p: &usize| got.chosen[*p].count_ones() > 0 && !view.chosen(*p).open && got.covered.contains_key(p);
    let some = (0..case.keys.len()).filter(|p| case.asks(*p)).find(sure).expect("a pixel with receivers around");
    let own = (0..case.keys.len()).find(|&p| case.is_receiver(p) && got.cover_keys[p] != 0).expect("a receiver");
    assert!(broken(&|g| g.chosen[some] = 0), "a receiver is not chosen");
    assert!(broken(&|g| g.counts[some] += 1), "one too many is counted");
    assert!(broken(&|g| g.cover_keys[own] += 0x10_0000), "a depth that is too near");
    assert!(broken(&|g| g.points[case.world.frame.vertex_count as usize + 3 * own][1] += 0.01), "a moved corner");
    assert!(broken(&|g| g.id_keys[own] = 0), "no key");
    assert!(broken(&|g| g.covered.get_mut(&some).expect("it")[0].1 ^= 0xffff_ffff), "other samples");
    let listed = |p: &usize| got.covered.get(p).is_some_and(|c| c.iter().any(|(_, mask)| mask.count_ones() > 16));
    let most = (0..case.keys.len()).find(listed).expect("a receiver that many samples see");
    let first = got.covered[&most].iter().position(|(_, mask)| mask.count_ones() > 16).expect("it");
    assert!(broken(&|g| g.covered.get_mut(&most).expect("it")[first].0.high *= 0.9), "a lower upper bound");
    assert!(broken(&|g| g.kept[some] += 1), "an element too many is left");
}
