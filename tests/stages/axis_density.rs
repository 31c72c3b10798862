//! Requests of pixels to the axes against their footprints in `f64`; densities and borders exactly, or as rounding lets them, from what was asked.

use crate::support::axes::Warped;
use crate::support::pages::ten_a_row;
use crate::support::shadow::{
    World, above, camera, looked_down_on as world, random_light, random_scene, samples, sheet,
};
use crate::support::spsm::{faces_away, noise, on_plane};
use crate::support::{POISON, Random, gpu, sizes_around};
use oracle::reference::axis_density::{CELLS, borders, density, logarithmic, requested, wanted};
use oracle::reference::prefix_scan::exclusive;
use subpixel_shadows::frame::sample_box;
use subpixel_shadows::glam::{DVec2, DVec3, DVec4};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::axis_density::DensityRule;
use test_support::gpu_test;

/// Spans of 2^k cells, k from 0 on.
const LEVELS: usize = 11;

/// Request of a pixel to either axis, the box of its samples, its distance from the eye; `None` where a corner of its box is not seen.
fn footprint(world: &World, pixel: u32, t: u32) -> Option<(DVec2, [DVec2; 2], f64)> {
    let at = |x: f64, y: f64| on_plane(world, pixel, t, DVec2::new(x, y)).map(|p| p.truncate());
    let h = 1.0 / 4096.0;
    let (right, down) = ((at(h, 0.0)? - at(-h, 0.0)?) / (2.0 * h), (at(0.0, h)? - at(0.0, -h)?) / (2.0 * h));
    let [low, high] = sample_box(&world.samples).map(|corner| corner.map(f64::from));
    let mut reached = [DVec2::MAX, DVec2::MIN];
    for [x, y] in [low, [high[0], low[1]], [low[0], high[1]], high] {
        reached = [reached[0].min(at(x, y)?), reached[1].max(at(x, y)?)];
    }
    let [a, b, c] = world.triangles[t as usize].corners?;
    let normal = (b - a).cross(c - a);
    let ray = oracle::reference::facet_classify::pixel_ray(&world.view, pixel, DVec2::ZERO);
    let point = ray * (normal.dot(a) / normal.dot(ray));
    // No more than single precision tells apart.
    let map = &world.view.map;
    let row = |row: DVec4| 2f64.powi(-20) * row.abs().element_sum();
    let rounding = row(map.u).max(row(map.v)) + row(map.w) * f64::from(map.map_size);
    let told = 0.5 * map.w.dot(point.extend(1.0)) / rounding;
    Some((wanted(right, down).min(DVec2::splat(told)), reached, point.length()))
}

/// Requests to each cell of an axis: of each the greatest of the spans that hold it.
fn asked(ran: &Warped, axis: usize) -> Vec<u32> {
    let mut asked = vec![0; CELLS];
    for level in 0..LEVELS {
        let words = &ran.requests[(axis * LEVELS + level) * CELLS..][..CELLS];
        for (first, &word) in words.iter().enumerate().filter(|(_, word)| **word > 0) {
            let end = (first + (1 << level)).min(CELLS);
            asked[first..end].iter_mut().for_each(|cell| *cell = word.max(*cell));
        }
    }
    asked
}

/// Least and greatest that pixels may ask of each cell of either axis, and the nearest distance of one from the eye, as far as it is known; `None`
/// where a footprint has no end.
struct Bounds {
    cells: [Vec<[u32; 2]>; 2],
    near: Option<[f64; 2]>,
    endless: bool,
}

impl Bounds {
    fn of(world: &World, ran: &Warped) -> Self {
        let mut all = Self { cells: [0, 1].map(|_| vec![[0; 2]; CELLS]), near: None, endless: false };
        let (size, place) = (f64::from(world.view.map.map_size), noise(world)[0]);
        for (pixel, t) in (0..).zip(&ran.seen) {
            let Some(t) = *t else { continue };
            let dark = faces_away(world, t);
            if dark == Some(true) {
                continue;
            }
            let Some((wanted, [low, high], distance)) = footprint(world, pixel, t) else {
                all.endless = true;
                continue;
            };
            let grow = DVec2::splat(4.0 * place) + 0.02 * (high - low);
            let beside =
                |grow: DVec2| (high + grow).cmplt(DVec2::ZERO).any() || (low - grow).cmpge(DVec2::splat(size)).any();
            if beside(grow) {
                continue;
            }
            let sure = dark == Some(false) && !beside(-grow);
            let [least, most] = all.near.unwrap_or([f64::MAX; 2]);
            all.near = Some([least.min(distance), if sure { most.min(distance) } else { most }]);
            for axis in 0..2 {
                let cell = |at: f64| (at * CELLS as f64 / size).clamp(0.0, CELLS as f64 - 1.0) as usize;
                let of = |more: f64| match ran.rule {
                    DensityRule::Requested => density(wanted[axis] * more),
                    DensityRule::Logarithmic => 1,
                };
                for cell in cell(low[axis] - grow[axis])..=cell(high[axis] + grow[axis]) {
                    let [_, most] = &mut all.cells[axis][cell];
                    *most = of(1.02).max(*most);
                }
                // Wherever in its doubt the box begins and ends: none from the last cell on before the first.
                let inner = cell(low[axis] + grow[axis])..=cell(high[axis] - grow[axis]);
                for cell in inner.filter(|_| sure) {
                    let [least, _] = &mut all.cells[axis][cell];
                    *least = of(1.0 / 1.02).max(*least);
                }
            }
        }
        all
    }
}

/// Where the stage departs from its definition; how many cells were asked for, and how many of them are known to be.
fn fault(world: &World, ran: &Warped) -> Result<[usize; 2], String> {
    let map = world.view.map.map_size;
    let bounds = Bounds::of(world, ran);
    let nearest = *ran.requests.last().expect("words");
    let near = f64::from(f32::from_bits(!nearest));
    if ran.rule == DensityRule::Logarithmic {
        let wanted = bounds.near.unwrap_or([f64::MAX; 2]);
        let right = if nearest == 0 { wanted[1] == f64::MAX } else { near < 1.001 * wanted[1] };
        if !right || (nearest != 0 && near < 0.999 * wanted[0] && !bounds.endless) {
            return Err(format!("nearest {near}, {wanted:?} expected"));
        }
    }
    let (mut marked, mut known) = (0, 0);
    for axis in 0..2 {
        let asked = asked(ran, axis);
        for (cell, (&found, &[least, most])) in asked.iter().zip(&bounds.cells[axis]).enumerate() {
            marked += usize::from(found > 0);
            known += usize::from(least > 0);
            if found < least || (found > most && !bounds.endless) {
                return Err(format!("cell {cell} of axis {axis} is asked {found}, {least} to {most} expected"));
            }
        }
        let found = &ran.densities[axis * CELLS..][..CELLS];
        match ran.rule {
            DensityRule::Requested => {
                if found != requested(&asked, ran.stretch) {
                    return Err(format!("densities of axis {axis}"));
                }
            }
            DensityRule::Logarithmic => {
                let wanted = logarithmic(&world.view, axis, near, &asked, ran.stretch);
                for (cell, (&found, &wanted)) in found.iter().zip(&wanted).enumerate() {
                    let doubt = 3.0 + 0.003 * f64::from(wanted);
                    if (f64::from(found) - f64::from(wanted)).abs() > doubt {
                        return Err(format!("density of cell {cell} of axis {axis}: {found}, {wanted} expected"));
                    }
                }
            }
        }
        let side = f64::from(map);
        for (texel, (found, wanted)) in ran.borders_of(axis).into_iter().zip(borders(found, map)).enumerate() {
            if (found - wanted).abs() > 2.5e-7 * side || !(0.0..=side).contains(&found) {
                return Err(format!("border {texel} of axis {axis}: {found}, {wanted} expected"));
            }
        }
    }
    let scan = exclusive(&ran.densities);
    if ran.axes[..2 * CELLS] != scan.sums || ran.axes[2 * CELLS..] != [scan.total, 0] {
        return Err("the scan does not count the densities".to_owned());
    }
    Ok([marked, known])
}

#[track_caller]
fn check(world: &World, rule: DensityRule, stretch: u32) -> Warped {
    let ran = Warped::new(world, rule, stretch);
    match fault(world, &ran) {
        Ok([marked, known]) => assert!(known * 4 + 9 >= marked, "of {marked} cells {known} are known"),
        Err(text) => panic!("{:?}, {rule:?}, {} samples: {text}", world.light, world.samples.count()),
    }
    ran
}

const RULES: [DensityRule; 2] = [DensityRule::Requested, DensityRule::Logarithmic];

#[gpu_test]
fn empty() {
    for rule in RULES {
        let ran = check(&world(gpu(), &Mesh::default(), above(), [3, 2], 9, 8), rule, 8);
        assert!(ran.densities.iter().all(|&density| density == 1), "{rule:?}: nobody asks, and the axes are even");
    }
}

#[gpu_test]
fn one() {
    let mesh = sheet(1, 2.0, |_, _| 0.0, |p| p);
    for rule in RULES {
        check(&world(gpu(), &mesh, above(), [1, 1], 63, 1), rule, 2);
        let ran = check(&world(gpu(), &mesh, above(), [200, 150], 64, 8), rule, 64);
        let widths: Vec<f64> = ran.borders_of(1).windows(2).map(|w| w[1] - w[0]).collect();
        let [least, most] = widths.iter().fold([f64::MAX, 0.0], |[a, b], w| [w.min(a), w.max(b)]);
        assert!(least * 1.2 < most && least * 64.0 > 0.99, "{rule:?}: {least} to {most}");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mesh = random_scene(1, &mut Random::new(31));
    for (k, pixels) in sizes_around(64).into_iter().enumerate() {
        check(&world(gpu(), &mesh, above(), [pixels as u32, 1], 40, 8), RULES[k % 2], 16);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(43);
    for kind in 0..4 {
        for (k, stretch) in [2, 9, 64, 256].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            let light = random_light(k % 2 == 0, &mut random);
            let world = world(gpu(), &mesh, light, [60, 40], [64, 150][k / 2], [1, 32, 8, 128][k]);
            for rule in RULES {
                check(&world, rule, stretch);
            }
        }
    }
}

/// A plane seen almost from its edge, whose footprints have no end, and one that the light almost misses; maps of one texel and of thousands a side.
#[gpu_test]
fn degenerate() {
    let mesh = sheet(3, 30.0, |_, _| 0.0, |p| p);
    for (height, map) in [(1e-3, 1), (0.2, 100), (0.2, 3001)] {
        let camera = camera(DVec2::new(0.0, height).extend(40.0), Default::default(), 40.0);
        for light in [above(), Light::Directional { direction: [1.0, 0.01, 0.0] }] {
            for rule in RULES {
                check(&World::new(gpu(), &mesh, camera, light, [40, 30], map, samples(8)), rule, 64);
            }
        }
    }
}

/// More pixels than one dimension of a dispatch of single invocations holds.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = random_scene(1, &mut Random::new(51));
    let ran = check(&world(gpu(), &mesh, above(), [65_537, 1], 16, 1), DensityRule::Requested, 16);
    assert!(ran.densities.iter().all(|&density| density != POISON));
}

#[gpu_test]
fn two_d_dispatch() {
    let mesh = random_scene(1, &mut Random::new(61));
    for rule in RULES {
        let of = |gpu| check(&world(gpu, &mesh, above(), [40, 24], 400, 8), rule, 64);
        let (a, b) = (of(ten_a_row()), of(gpu()));
        assert!(a.requests == b.requests && a.axes == b.axes && a.borders == b.borders, "the fold changes the result");
    }
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(71));
    // Of the map little is seen, so the limit of the stretch is felt.
    let near = camera(DVec3::new(0.3, 0.9, 1.2), DVec3::ZERO, 25.0);
    let world = World::new(gpu(), &mesh, near, above(), [96, 72], 100, samples(8));
    for rule in RULES {
        let ran = check(&world, rule, 2);
        let spoilt = |spoil: &dyn Fn(&mut Warped)| {
            let mut off = Warped::new(&world, rule, 2);
            let same = off.requests == ran.requests && off.axes == ran.axes && off.borders == ran.borders;
            assert!(same, "another result in a second run");
            spoil(&mut off);
            fault(&world, &off).is_err()
        };
        let bounds = Bounds::of(&world, &ran);
        let bare = bounds.cells[0].iter().position(|&[_, most]| most == 0).expect("a cell that nobody asks");
        let most = ran.densities.iter().copied().max().expect("cells");
        let dense = ran.densities.iter().position(|&density| density == most).expect("a cell");
        assert!(spoilt(&|r| r.requests[bare] = 1));
        assert!(spoilt(&|r| r.requests[..CELLS * LEVELS].fill(0)));
        assert!(spoilt(&|r| r.densities[dense] += most / 100));
        assert!(spoilt(&|r| r.densities.rotate_right(CELLS)));
        assert!(spoilt(&|r| r.axes[dense + 1] ^= 1));
        assert!(spoilt(&|r| r.borders[40] += 1e-3));
        assert!(spoilt(&|r| r.stretch = 256));
        if rule == DensityRule::Logarithmic {
            assert!(spoilt(&|r| *r.requests.last_mut().expect("words") -= 1 << 16));
        }
    }
}
