//! The closest triangle of each texel and its record, against `f64`; and the codes themselves, bit for bit.

mod arithmetic;

use crate::support::shadow::{
    World, above, add_triangle, camera, doubled, folding_gpu, random_light, random_scene, samples, sheet, soup,
    uniform, vector,
};
use crate::support::spsm::{Made, middle, noise};
use crate::support::{Random, gpu, run, sizes_around, upload};
use oracle::reference::light_layers::depth_in_front;
use oracle::reference::spsm_map::{
    EMPTY, closest, direction_code, distance_code, lifted, slope_code_16, slope_of_16, unorm_code,
};
use oracle::reference::triangle_setup::Triangle;
use oracle::reference::view::Flat;
use subpixel_shadows::entry_point;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::bindings::{Read, Uniform, Write};
use subpixel_shadows::gpu::{Buffer, Gpu, Groups};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::spsm_code::SlopeCode;
use test_support::gpu_test;

fn world(gpu: &'static Gpu, mesh: &Mesh, light: Light, map: u32) -> World {
    let camera = camera(DVec3::new(0.5, 2.0, 5.0), DVec3::ZERO, 40.0);
    World::new(gpu, mesh, camera, light, [4, 3], map, samples(1))
}

/// Where the stage departs from its definition.
fn fault(world: &World, made: &Made) -> Option<String> {
    let size = world.view.map.map_size;
    let [place, depth] = noise(world);
    // Rounding may let a triangle touch a texel more or less; what lies well within or without is certain.
    let inner = closest(&world.triangles, size, 0.5 - place, 0.0);
    let outer = closest(&world.triangles, size, 0.5 + 3.0 * place, depth);
    if made.records.len() != inner.len() {
        return Some(format!("{} texels", made.records.len()));
    }
    for texel in 0..inner.len() {
        let at = format!("texel {} {}", texel as u32 % size, texel as u32 / size);
        let Some(t) = made.triangle(texel) else {
            if inner[texel].is_some() || made.keys[texel][1] != 0 {
                return Some(format!("{at}: empty, {:?} expected", inner[texel]));
            }
            if made.records[texel][3] != EMPTY {
                return Some(format!("{at}: a record without a triangle"));
            }
            continue;
        };
        let Some(flat) = world.triangles.get(t as usize).and_then(Triangle::flat) else {
            return Some(format!("{at}: triangle {t}"));
        };
        let steep = |f: &Flat| f.slope.map_or(0.0, |s| s.x.abs() + s.y.abs());
        let doubt = |f: &Flat| depth + 4.0 * place * (1.0 + steep(f));
        let got = made.depth(texel);
        if let Some((least, s)) = inner[texel] {
            let of = world.triangles[s as usize].flat().expect("it is there");
            if got > least + doubt(&of) {
                return Some(format!("{at}: depth {got}, {least} of {s} expected"));
            }
        }
        let own = lifted(&flat, middle(texel, size), 0.5, 0.0);
        if (got - own).abs() > doubt(&flat) || outer[texel].is_none_or(|(least, _)| got < least - doubt(&flat)) {
            return Some(format!("{at}: depth {got} of triangle {t}, {own} expected"));
        }
        if let Some(text) = record_fault(made, texel, &flat, size) {
            return Some(format!("{at}, triangle {t}: {text}"));
        }
    }
    None
}

/// Where a record departs from that of its triangle by more than rounding and a step of the code.
fn record_fault(made: &Made, texel: usize, flat: &Flat, size: u32) -> Option<String> {
    let [a, b, c] = flat.corners.map(|p| p.truncate());
    let shortest = (b - a).length().min((c - b).length()).min((a - c).length());
    let size_of = flat.corners.iter().fold(1.0f64, |m, p| m.max(p.x.abs()).max(p.y.abs()));
    // Directions of short edges are lost in the rounding of their ends.
    if shortest < 1e-4 * size_of || flat.is_thin() {
        return None;
    }
    let at = middle(texel, size);
    let Some(sheet) = made.coding.decode(made.records[texel], at) else { return Some("no record".to_owned()) };
    let exact = made.coding.decode(made.coding.encode(flat, at), at).expect("a record");
    let step = if made.coding.lines { 2.5 / 1024.0 } else { 4.0 * f64::from(size) / 65_535.0 / shortest.min(1.0) };
    let step = step + 3e-6 * size_of / shortest;
    // Edges in any order: a canonical mesh has its vertices in order of index, as the kernel takes them.
    for e in sheet.edges {
        let near = |o: &DVec3| {
            (*o - e).truncate().abs().max_element() <= step && (o.z - e.z).abs() <= step * (1.0 + o.z.abs())
        };
        if !exact.edges.iter().any(near) {
            return Some(format!("edge {e:?}, {:?} expected", exact.edges));
        }
    }
    // What rounding of the corners makes of the slope, and of the depth at the centre.
    let [a, b, c] = flat.corners.map(|p| p.truncate());
    let extent = (b - a).abs().max_element().max((c - a).abs().max_element());
    let share = 8e-6 * (size_of + extent) * extent / (b - a).perp_dot(c - a).abs();
    let area = (b - a).perp_dot(c - a).abs();
    let tilt = DVec2::splat(exact.depth.truncate().abs().max_element() * share + 4e-7 * extent / area);
    let rounding =
        tilt.extend((tilt.x + tilt.y) * extent + 4e-6 + (exact.depth.x.abs() + exact.depth.y.abs()) * 4e-6 * size_of);
    let off = (sheet.depth - exact.depth).abs();
    let most = (sheet.doubt + exact.doubt) * 1.1 + rounding;
    (off.cmpgt(most).any()).then(|| format!("plane {:?}, {:?} expected", sheet.depth, exact.depth))
}

#[track_caller]
fn check(gpu: &'static Gpu, mesh: &Mesh, light: Light, map: u32) -> [Made; 2] {
    let world = world(gpu, mesh, light, map);
    [false, true].map(|lines| {
        let made = Made::new(&world, lines);
        if let Some(text) = fault(&world, &made) {
            panic!("lines {lines}, {light:?}, map {map}: {text}");
        }
        let narrow = Made::with_list(&world, lines, 1 << 16);
        assert!(narrow.keys == made.keys && narrow.records == made.records, "atomics of 32 bits make another map");
        made
    })
}

#[gpu_test]
fn empty() {
    for map in [1, 9] {
        let [paper, lines] = check(gpu(), &Mesh::default(), above(), map);
        assert!(paper.records.iter().chain(&lines.records).all(|r| *r == [0, 0, 0, EMPTY]));
    }
}

#[gpu_test]
fn one() {
    let mesh = soup(1, 1.0, &mut Random::new(3));
    for map in [1, 2, 7, 64] {
        let [made, _] = check(gpu(), &mesh, above(), map);
        assert!(made.keys.iter().any(|k| k[0] == u32::MAX), "map {map}: triangle 0 is nowhere");
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(5);
    let mesh = random_scene(1, &mut random);
    for map in sizes_around(8) {
        check(gpu(), &mesh, above(), map as u32);
    }
    for count in sizes_around(64) {
        check(gpu(), &soup(count, 0.4, &mut random), above(), 24);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(11);
    for kind in 0..4 {
        for (k, map) in [5, 33, 150].into_iter().enumerate() {
            let mesh = random_scene(kind, &mut random);
            check(gpu(), &mesh, random_light(k % 2 == 0, &mut random), map);
        }
    }
}

#[gpu_test]
fn degenerate() {
    // Edge-on to the light, without area, doubled; and a triangle that reaches behind a point light.
    let mut mesh = sheet(3, 1.0, |_, _| 0.0, |p| DVec3::new(p.x, p.z, 0.1));
    mesh.triangles.push([0, 0, 5]);
    check(gpu(), &doubled(mesh), Light::Directional { direction: [0.0, 1.0, 0.0] }, 40);
    let mut mesh = random_scene(1, &mut Random::new(2));
    add_triangle(&mut mesh, [[-90.0, -3.0, -90.0], [90.0, -3.0, -90.0], [0.0, 4.0, 90.0]]);
    check(gpu(), &mesh, above(), 64);
}

/// The stage has no list. At most 65,535 work items fit one dimension of a dispatch of single invocations; here are more.
#[gpu_test]
fn beyond_one_dimension() {
    let mesh = sheet(190, 1.0, |x, z| 0.2 * (9.0 * x).sin() * (7.0 * z).cos(), |p| p);
    let world = world(gpu(), &mesh, above(), 150);
    let items: u64 = world.facts.light_items.read(gpu()).expect("readback").iter().map(|&n| u64::from(n)).sum();
    assert!(items > 65_535, "{items} items");
    let made = Made::new(&world, true);
    assert_eq!(fault(&world, &made), None);
}

/// How many won blocks are listed, none to all, changes nothing of the map.
#[gpu_test]
fn list_of_won_blocks_too_short() {
    // Every triangle twice: each texel has a tie to break.
    let mesh = doubled(random_scene(1, &mut Random::new(14)));
    let world = world(gpu(), &mesh, above(), 64);
    let with = |blocks| {
        let made = Made::with_list(&world, true, blocks);
        let counts = made.texels.marks.words.read_first(gpu(), 4).expect("readback");
        (made, counts)
    };
    let (whole, counts) = with(1 << 16);
    let won = counts[0];
    assert!(won > 64 && counts[1..] == [0; 3], "{counts:?}");
    assert_eq!(fault(&world, &whole), None);
    for blocks in [1, 63, won as usize / 2] {
        let (made, counts) = with(blocks);
        assert!(counts[1] == 2 * 8 * 8 && counts[2] > 0 && counts[3] == 1, "{blocks} listed: {counts:?}");
        assert!(made.keys == whole.keys && made.records == whole.records, "{blocks} listed: another map");
    }
}

#[gpu_test]
fn two_d_dispatch() {
    // Nine workgroups of texels in three rows; the lists of blocks fit in one.
    let mesh = soup(40, 0.4, &mut Random::new(8));
    let [a, b] = check(folding_gpu(), &mesh, above(), 24);
    let [c, d] = check(gpu(), &mesh, above(), 24);
    assert!(a.records == c.records && b.records == d.records, "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mesh = random_scene(1, &mut Random::new(21));
    let world = world(gpu(), &mesh, above(), 64);
    for lines in [false, true] {
        let made = Made::new(&world, lines);
        assert_eq!(fault(&world, &made), None);
        let again = Made::new(&world, lines);
        assert!(made.records == again.records && made.keys == again.keys, "another result in a second run");
        let full = (0..64 * 64).find(|&t| made.triangle(t).is_some()).expect("a texel");
        let bare = (0..64 * 64).find(|&t| made.triangle(t).is_none()).expect("a texel without one");
        let spoilt = |spoil: &dyn Fn(&mut Made)| {
            let mut off = Made::new(&world, lines);
            spoil(&mut off);
            fault(&world, &off).is_some()
        };
        assert!(spoilt(&|m| m.keys[full][0] = 0));
        assert!(spoilt(&|m| m.keys[full][1] -= 1 << 24));
        assert!(spoilt(&|m| m.records[full][3] = EMPTY));
        assert!(spoilt(&|m| m.records[full][0] ^= 0x4000_0000), "lines {lines}");
        assert!(spoilt(&|m| m.records.truncate(9)));
        assert!(spoilt(&|m| m.keys[bare][0] = u32::MAX));
    }
}

/// A triangle of 16-bit vertices and a texel: of a kind that is told by `kind`.
fn coded_triangle(kind: usize, size: u32, random: &mut Random) -> [u32; 4] {
    let texel = [random.below(size), random.below(size)];
    let centre = texel.map(|v| i64::from(2 * v + 1) * 65_535 / (2 * i64::from(size)));
    let pack = |x: i64, y: i64| (x.clamp(0, 65_535) as u32) | (y.clamp(0, 65_535) as u32) << 16;
    let mut near = |reach: i64| {
        let mut off = || i64::from(random.below(2 * reach as u32 + 1)) - reach;
        (off(), off())
    };
    let reach = i64::from(65_535 / size).max(1);
    let corners = match kind {
        0 => [near(65_535), near(65_535), near(65_535)],
        1 => [near(2 * reach), near(2 * reach), near(2 * reach)],
        // Nearly in one line.
        2 => {
            let ((x, y), (u, v)) = (near(3000), near(1));
            [(-x, -y), (x + u, y + v), near(3 * reach)]
        }
        // Right through the centre, where the second vertex is on the map.
        _ => {
            let (x, y) = near(4);
            let far = |code: i64, texel: u32| {
                let centre = i64::from(2 * texel + 1) * 65_535;
                let steps = (code * 2 * i64::from(size) - centre) * (1 - 2 * i64::from(size));
                (steps + centre) / (2 * i64::from(size))
            };
            let end = (far(centre[0] + x, texel[0]) - centre[0], far(centre[1] + y, texel[1]) - centre[1]);
            [(x, y), end, near(20_000)]
        }
    };
    let [a, b, c] = corners.map(|(x, y)| pack(centre[0] + x, centre[1] + y));
    [a, b, c, texel[0] | texel[1] << 16]
}

/// The plane that a texel stands for lies within the bound of its code, on random triangles.
#[test]
fn planes_are_rebuilt_within_their_bounds() {
    use oracle::reference::spsm_map::Coding;
    let mut random = Random::new(77);
    let mut number = |low: f64, high: f64| low + (high - low) * f64::from(random.word()) / 4_294_967_296.0;
    let codings = [false, true].map(|lines| Coding { lines, slopes: SlopeCode::new(5), size: 1024 });
    let (mut tried, mut beyond) = (0u32, 0u32);
    while tried < 1_000_000 {
        let reach = 10f64.powf(number(-1.0, 2.0));
        let at = DVec2::new(number(200.0, 800.0).floor() + 0.5, number(200.0, 800.0).floor() + 0.5);
        let corners =
            [0; 3].map(|_| (at + DVec2::new(number(-reach, reach), number(-reach, reach))).extend(number(0.2, 0.8)));
        let flat = Flat::new(corners);
        let Some(slope) = flat.slope else { continue };
        let middle = flat.corners[0].z + slope.dot(at - flat.corners[0].truncate());
        if !flat.touches(at, 0.5) || !(0.0..1.0).contains(&middle) {
            continue;
        }
        tried += 1;
        for coding in &codings {
            let sheet = coding.decode(coding.encode(&flat, at), at).expect("a record");
            let off = (sheet.depth - slope.extend(middle)).abs();
            // A slope beyond the last code is clamped; it is counted.
            let steepest = 2000.0 / 1024.0;
            if coding.lines && slope.abs().max_element() > steepest
                || slope.abs().max_element() * 1024.0 > 400.0 && !coding.lines
            {
                beyond += 1;
                continue;
            }
            assert!(off.cmple(sheet.doubt * 1.001 + DVec3::splat(1e-9)).all(), "{corners:?} {off:?} {:?}", sheet.doubt);
        }
    }
    assert!(beyond < tried, "{beyond} of {tried} are too steep");
}

/// Of a triangle that reaches behind the light edge lines hold what lies in front of it; the paper's corners hold nothing.
#[gpu_test]
fn lines_hold_what_reaches_behind_the_light() {
    let mut random = Random::new(29);
    let [mut held, mut cut] = [0; 2];
    for seed in 0..40 {
        let [a, b, c] = [vector(&mut random), vector(&mut random), vector(&mut random)];
        let up = DVec3::new(0.0, 9.0, 0.0);
        let corners = [a * 2.0 - up * 0.3, b * 2.0 + up * f64::from(seed % 2 + 1), c * 6.0 - up * 0.1];
        let mut mesh = Mesh::default();
        add_triangle(&mut mesh, corners.map(|p| p.as_vec3().into()));
        add_triangle(&mut mesh, [[-2.0, -4.0, -2.0], [2.0, -4.0, -2.0], [0.0, -4.0, 2.0]]);
        let world = world(gpu(), &mesh, Light::Point { position: [0.3, 4.0, 0.2] }, 48);
        let reaches = |t: &Triangle| {
            let corners = t.corners.expect("it is there");
            corners.iter().any(|p| world.view.on_map(*p).is_none())
        };
        let Some(t) = world.triangles.iter().position(reaches) else { continue };
        let corners = world.triangles[t].corners.expect("it is there");
        // Both kernels, where the device has atomics of 64 bits.
        let listed = |lines| Made::with_list(&world, lines, 1 << 14);
        let papers = [Made::new(&world, false), listed(false)];
        let all_lines = [Made::new(&world, true), listed(true)];
        let only = |made: &Made, texel: usize| made.triangle(texel) == Some(t as u32);
        assert!(papers.iter().all(|p| (0..48 * 48).all(|texel| !only(p, texel))), "{seed}: held by corners");
        cut += 1;
        for (lines, texel) in all_lines.iter().flat_map(|lines| (0..48 * 48).map(move |texel| (lines, texel))) {
            let found = depth_in_front(&world.view, corners, middle(texel, 48));
            let Some((depth, inside)) = found.filter(|(depth, _)| (-0.9..1.9).contains(depth)) else { continue };
            if inside < -1.6 {
                assert!(!only(lines, texel), "{seed}, texel {texel}: {inside} beside");
            }
            let other = world.triangles[1 - t].corners.expect("it is there");
            let hidden = depth_in_front(&world.view, other, middle(texel, 48)).is_some_and(|(_, by)| by > -1.6);
            if inside < 1.6 || hidden {
                continue;
            }
            held += 1;
            assert!(only(lines, texel), "{seed}, texel {texel}: not held, {inside} within");
            let sheet = lines.coding.decode(lines.records[texel], middle(texel, 48)).expect("a record");
            let off = (sheet.depth.z - depth).abs();
            let steep = sheet.depth.x.abs() + sheet.depth.y.abs();
            assert!(off < 1e-3 + 0.02 * steep, "{seed}, texel {texel}: depth {}, {depth} expected", sheet.depth.z);
            // Beyond the code's range all of the texel is within.
            let within = sheet.edges.iter().map(|edge| edge.z).fold(f64::INFINITY, f64::min);
            let same = (within - inside).abs() < 0.02 || (within.min(inside) > 3.0);
            assert!(same, "{seed}, texel {texel}: {within} within, {inside} expected");
        }
    }
    assert!(cut > 10 && held > 4000, "{cut} triangles reach behind, {held} texels hold them");
}
