//! Marks and split depths, against `f64`: marks hold the exact ones and lie within those at twice the margin; and what
//! they are for: over every place of an unmarked texel exactly one surface lies before the split depth, so a point
//! before it is lit and a point behind it in shadow; over an uncovered texel there is no surface.

use crate::support::geometry::{
    Case, MESHES, Place, Ran, Wanted, add, fan, light, mesh, run_all, with_what_turns_away, world,
};
use crate::support::shadow::vector;
use crate::support::{Random, gpu, sizes_around, small_gpu};
use oracle::reference::front_layer::{Margin, Split, marks, settle};
use oracle::reference::triangle_setup::Triangle;
use oracle::reference::view::centre;
use oracle::truth::Tracer;
use subpixel_shadows::glam::{DVec2, DVec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::front_layer::{MARKED, UNCOVERED};
use test_support::gpu_test;

/// Where the stage departs from its definition; `bounded`: whether its excess is looked at too.
fn fault(case: &Case, ran: &Ran, bounded: bool) -> Option<String> {
    let wanted = case.wanted();
    let layers = wanted.layers(0.0, 0.0);
    let least = marks(&wanted.triangles, &layers, case.map, Margin::default());
    let double = marks(&wanted.triangles, &layers, case.map, ran.margin().times(2.0));
    if ran.splits.len() != layers.len() {
        return Some("another number of texels".to_owned());
    }
    let exact = settle(&layers, &ran.marks[2]);
    for texel in 0..layers.len() {
        let at = format!("texel {} {}", texel as u32 % case.map, texel as u32 / case.map);
        let (before, after, split) = (ran.marks[1][texel], ran.marks[2][texel], ran.splits[texel]);
        if (before || least[texel]) && !after {
            return Some(format!("{at}: not marked; {:?}", layers[texel]));
        }
        if bounded && after && !before && !double[texel] {
            return Some(format!("{at}: marked without a reason; {:?}", layers[texel]));
        }
        let right = match exact[texel] {
            Split::Marked => split == MARKED,
            Split::Uncovered => split == UNCOVERED,
            Split::At(depth) if depth.is_finite() => {
                let (a, b) = (layers[texel].nearest, layers[texel].second);
                a.zip(b).is_some_and(|(a, b)| f64::from(split) >= a.0 && f64::from(split) <= b.0)
            }
            Split::At(_) => split > 1e38,
        };
        if !right {
            return Some(format!("{at}: split {split}, {:?} expected", exact[texel]));
        }
    }
    None
}

/// Looks at places of unmarked texels; returns how many, or the first that breaks the promise.
fn promise(case: &Case, ran: &Ran, per_texel: u32, random: &mut Place) -> Result<usize, String> {
    let wanted = case.wanted();
    let lists = touching(&wanted, case.map);
    let mut looked = 0;
    for (texel, &split) in ran.splits.iter().enumerate() {
        let (x, y) = (texel as u32 % case.map, texel as u32 / case.map);
        if split == MARKED {
            continue;
        }
        if split == UNCOVERED {
            if let Some(t) = lists[texel].iter().find(|&&t| touches(&wanted.triangles[t], centre(x, y), 0.5)) {
                return Err(format!("texel {x} {y} is uncovered, but triangle {t} touches it"));
            }
            continue;
        }
        for k in 0..per_texel {
            // The corners first.
            let at =
                if k < 4 { DVec2::new(f64::from(x + (k & 1)), f64::from(y + (k >> 1))) } else { random.in_cell(x, y) };
            let (mut surely, mut maybe) = (0, 0);
            for &t in &lists[texel] {
                let (inside, depth) = met(&wanted.triangles[t], at);
                surely += u32::from(inside.iter().all(|&e| e > 1e-9) && depth < f64::from(split));
                maybe += u32::from(inside.iter().all(|&e| e >= -1e-9) && depth < f64::from(split));
            }
            looked += 1;
            if surely > 1 || maybe < 1 {
                return Err(format!("texel {x} {y} at {at}: {surely} to {maybe} surfaces before {split}"));
            }
        }
    }
    Ok(looked)
}

/// Whether it touches a square around a place of the map.
fn touches(triangle: &Triangle, at: DVec2, reach: f64) -> bool {
    let flat = triangle.flat().is_some_and(|flat| flat.touches(at, reach));
    flat || triangle.cut().is_some_and(|cut| cut.touches(at, reach))
}

/// How far a place lies inside the edges, and the depth there; before all where that is nearer than what the light's view tells.
fn met(triangle: &Triangle, at: DVec2) -> ([f64; 3], f64) {
    match (triangle.flat(), triangle.cut()) {
        (Some(flat), _) => (flat.inside(at), flat.depth(at)),
        (_, Some(cut)) => (cut.inside(at), cut.depth(at).unwrap_or(f64::NEG_INFINITY)),
        _ => ([f64::NEG_INFINITY; 3], 0.0),
    }
}

/// The triangles that may touch each texel.
fn touching(wanted: &Wanted, size: u32) -> Vec<Vec<usize>> {
    let mut lists = vec![Vec::new(); (size * size) as usize];
    for (t, triangle) in wanted.triangles.iter().enumerate() {
        let Some([x0, y0, x1, y1]) = triangle.texels(size, 0.0) else { continue };
        for y in y0..=y1 {
            for x in x0..=x1 {
                if touches(triangle, centre(x, y), 0.5 + 1e-9) {
                    lists[(y * size + x) as usize].push(t);
                }
            }
        }
    }
    lists
}

/// The same of world points on the mesh, by rays towards the light.
fn rays(case: &Case, ran: &Ran, count: u32, random: &mut Place) -> Result<usize, String> {
    let mesh = case.prepared.mesh();
    let Ok(tracer) = Tracer::of(&case.prepared) else { return Err("the mesh cannot be traced".to_owned()) };
    let wanted = case.wanted();
    let light = case.light.homogeneous();
    let mut looked = 0;
    for k in 0..count {
        let t = (k as usize) % mesh.triangles.len();
        let [a, b, c] = mesh.triangles[t].map(|v| world(mesh.positions[v as usize]));
        let (u, v) = (random.unit(), random.unit());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let p = a + (b - a) * u + (c - a) * v;
        let point = (p - wanted.view.eye) * wanted.view.scale;
        // A sheet seen edge-on is dark by definition, and one that is culled casts nothing.
        let side = wanted.triangles[t].side;
        let normal = (b - a).cross(c - a);
        let grazing = normal.normalize_or_zero().dot(case.light.towards(p).normalize_or_zero()).abs() < 1e-4;
        let Some(map) = wanted.view.on_map(point) else { continue };
        let limit = f64::from(case.map);
        if grazing
            || (case.cull_back && case.prepared.bodies[t] && side <= 0.0)
            || !(map.x >= 0.0 && map.y >= 0.0 && map.x < limit && map.y < limit)
        {
            continue;
        }
        let split = ran.splits[map.y as usize * case.map as usize + map.x as usize];
        if split == MARKED {
            continue;
        }
        if split == UNCOVERED {
            return Err(format!("a surface at {p} in an uncovered texel"));
        }
        let shade = tracer.shade(p, p.abs().max_element().max(1.0) * 1e-12, light, &|other| other as usize == t);
        looked += 1;
        if !shade.touching && shade.occluded != (map.z > f64::from(split)) {
            return Err(format!("{p} at depth {} of split {split}: occluded {}", map.z, shade.occluded));
        }
    }
    Ok(looked)
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case, bounded: bool) -> Ran {
    let ran = run_all(gpu, case);
    if let Some(text) = fault(case, &ran, bounded) {
        panic!("{:?}, map {}: {text}", case.light, case.map);
    }
    ran
}

#[gpu_test]
fn empty() {
    for map in [1, 8, 33] {
        let ran = check(gpu(), &Case::new(&Mesh::default(), light(0), [1, 1], map), true);
        assert!(ran.splits.iter().all(|&s| s == UNCOVERED));
    }
}

#[gpu_test]
fn one() {
    let mut mesh = Mesh::default();
    add(&mut mesh, &[DVec3::ZERO, DVec3::X, DVec3::Z], &[[0, 1, 2]]);
    for (k, map) in [1, 2, 3, 8, 64].into_iter().enumerate() {
        let case = Case::new(&mesh, light(k as u64), [1, 1], map);
        let ran = check(gpu(), &case, true);
        promise(&case, &ran, 8, &mut Place(Random::new(1))).expect("the promise holds");
        assert!(map < 64 || ran.splits.iter().filter(|&&s| s > 1e38).count() > 100, "the inside is one sheet");
    }
}

/// Triangles with holes settle nothing: the proofs hold where every third triangle has holes, by rays through these.
#[gpu_test]
fn what_has_holes_settles_nothing() {
    let mut random = Place(Random::new(78));
    let (mut points, mut unmarked, mut others) = (0, 0, 0);
    for (k, name) in MESHES.iter().enumerate() {
        for map in [33, 150] {
            let whole = Case::new(&mesh(name, 4), light(k as u64 + 1), [1, 1], map);
            let case = whole.clone().with_holes();
            let ran = check(gpu(), &case, !["huge", "slivers"].contains(name));
            let told = |text: String| panic!("{name}, {:?}, map {map}: {text}", case.light);
            points += rays(&case, &ran, 4000, &mut random).unwrap_or_else(told);
            unmarked += ran.splits.iter().filter(|&&s| s != MARKED && s != UNCOVERED).count();
            others += usize::from(rays(&case, &run_all(gpu(), &whole), 4000, &mut random).is_err());
        }
    }
    assert!(points > 1000 && unmarked > 1000, "{points} points, {unmarked} texels");
    assert!(others > MESHES.len() / 2, "splits that take them for whole are noticed: {others}");
}

#[gpu_test]
fn every_size_around_workgroup() {
    for size in [sizes_around(8), vec![63, 64, 65]].concat() {
        check(gpu(), &Case::new(&mesh("closed balls", size as u64), light(size as u64), [1, 1], size as u32), true);
    }
    for count in sizes_around(64) {
        let mut mesh = Mesh::default();
        fan(&mut mesh, count.max(3) as u32);
        check(gpu(), &Case::new(&mesh, light(0), [1, 1], 40), true);
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Place(Random::new(77));
    let (mut places, mut points) = (0, 0);
    for (k, name) in MESHES.iter().enumerate() {
        for (seed, map) in [3, 8, 33, 150, 100, 64].into_iter().enumerate() {
            let mut case = Case::new(&mesh(name, seed as u64), light((seed + k) as u64), [1, 1], map);
            case.cull_back = seed % 2 == 1;
            let ran = check(gpu(), &case, !["huge", "slivers"].contains(name) && !case.cull_back);
            let told = |text: String| panic!("{name} {seed}, {:?}, map {map}: {text}", case.light);
            places += promise(&case, &ran, 12, &mut random).unwrap_or_else(told);
            points += rays(&case, &ran, 4000, &mut random).unwrap_or_else(told);
        }
    }
    assert!(places > 100_000 && points > 10_000, "{places} places and {points} points were looked at");
}

#[gpu_test]
fn degenerate() {
    let mut random = Place(Random::new(78));
    // A ground that nothing is behind, under every light; also where it reaches behind the light.
    for seed in 0..6 {
        let mut mesh = mesh(if seed % 2 == 0 { "closed balls" } else { "leaves" }, seed);
        let ground = mesh.ground_below().expect("a ground");
        mesh.add_ground(&ground);
        let case = Case::new(&mesh, light(seed), [1, 1], 100);
        let ran = run_all(gpu(), &case);
        promise(&case, &ran, 12, &mut random).expect("the promise holds");
        rays(&case, &ran, 20_000, &mut random).expect("the promise holds");
    }
    // Layers apart by 0 to 1000 ulp, interleaved and tilted.
    for k in 0..10 {
        let mut mesh = Mesh::default();
        let gap = f64::from([0, 1, 2, 5, 10, 20, 50, 100, 300, 1000][k]) * 6e-8;
        let sheet = |y: f64| {
            [DVec3::new(-1.0, y, -1.0), DVec3::new(1.0, y, -1.0), DVec3::new(1.0, y, 1.0), DVec3::new(-1.0, y, 1.0)]
        };
        add(&mut mesh, &sheet(0.5), &[[0, 2, 1], [0, 3, 2]]);
        add(&mut mesh, &sheet(0.5 - gap).map(|p| p * 0.99), &[[0, 2, 1], [0, 3, 2]]);
        add(&mut mesh, &sheet(-0.5), &[[0, 2, 1], [0, 3, 2]]);
        let case = Case::new(&mesh, light(k as u64), [1, 1], 64);
        let ran = check(gpu(), &case, true);
        promise(&case, &ran, 12, &mut random).expect("the promise holds");
        rays(&case, &ran, 3000, &mut random).expect("the promise holds");
    }
    // A vertex that is no number.
    let mut case = Case::new(&mesh("closed balls", 1), light(0), [1, 1], 64);
    let mut positions = case.prepared.mesh().positions.clone();
    positions[11][2] = f32::NAN;
    case.positions = Some(positions);
    let ran = check(gpu(), &case, true);
    promise(&case, &ran, 12, &mut random).expect("the promise holds");
    // Inside a ball, and among leaves: casters all around the light.
    for (name, position) in [("doubled", [0.1, 0.0, 0.2]), ("leaves", [0.0, 0.1, 0.0])] {
        let case = Case::new(&mesh(name, 1), Light::Point { position }, [1, 1], 33);
        let ran = run_all(gpu(), &case);
        promise(&case, &ran, 12, &mut random).expect("the promise holds");
    }
}

/// Texels that a triangle covers which reaches behind the light are settled, and the promise holds there.
#[gpu_test]
fn what_reaches_behind_the_light_settles() {
    let (mut random, mut place) = (Random::new(41), Place(Random::new(42)));
    let [mut held, mut points] = [0; 2];
    for _ in 0..12 {
        let mut mesh = mesh("closed balls", 2);
        let [a, b, c] = [vector(&mut random), vector(&mut random), vector(&mut random)];
        let up = DVec3::new(0.0, 9.0, 0.0);
        add(&mut mesh, &[a * 2.0 - up * 0.3, b * 2.0 + up, c * 6.0 - up * 0.1], &[[0, 1, 2]]);
        let case = Case::new(&mesh, Light::Point { position: [0.3, 4.0, 0.2] }, [1, 1], 64);
        // Lines near the light are known less well than the margin tells.
        let (wanted, ran) = (case.wanted(), check(gpu(), &case, false));
        promise(&case, &ran, 12, &mut place).expect("the promise holds");
        points += rays(&case, &ran, 4000, &mut place).expect("the promise holds");
        let layers = wanted.layers(0.0, 0.0);
        let of_cut = |t: &usize| layers[*t].nearest.is_some_and(|(_, t)| wanted.triangles[t as usize].cut().is_some());
        held += (0..layers.len()).filter(of_cut).filter(|&t| ran.splits[t] > 0.0).count();
    }
    assert!(held > 300 && points > 1000, "{held} texels are held by what reaches behind the light, {points} points");
}

/// The stage has no list; a large map is settled to its last texel.
#[gpu_test]
fn beyond_one_dimension() {
    let case = Case::new(&mesh("closed balls", 4), light(0), [1, 1], 4096);
    let ran = run_all(gpu(), &case);
    assert_eq!(ran.splits.len(), 1 << 24);
    let wrong = ran.splits.iter().zip(&ran.marks[2]).position(|(&s, &m)| m != (s == MARKED));
    assert_eq!(wrong, None);
    assert!(ran.marks[2].iter().filter(|m| **m).count() < 1 << 20, "marks are few");
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(40, 1 << 20);
    let mut dense = Mesh::default();
    crate::support::geometry::ball(&mut dense, DVec3::ZERO, 1.0, 40, 30);
    let case = Case::new(&dense, light(0), [1, 1], 150);
    let ran = check(&small, &case, true);
    assert!(ran.words() == run_all(gpu(), &case).words(), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(&mesh("closed balls", 5), light(0), [1, 1], 64);
    let ran = check(gpu(), &case, true);
    let mut random = Place(Random::new(3));
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = ran.clone();
        spoil(&mut off);
        fault(&case, &off, true).is_some()
    };
    let added = (0..64 * 64).find(|&t| ran.marks[2][t] && !ran.marks[1][t]).expect("a texel that is marked last");
    let sheet = (0..64 * 64).find(|&t| ran.splits[t] > 0.0).expect("a sheet");
    let free = (0..64 * 64).find(|&t| ran.splits[t] == UNCOVERED).expect("an uncovered texel");
    assert!(spoilt(&|r| r.marks[2][added] = false));
    assert!(spoilt(&|r| (r.marks[2][free], r.splits[free]) = (true, MARKED)));
    assert!(spoilt(&|r| r.splits[sheet] = UNCOVERED));
    // A split before the first layer, and a marked texel that is settled: the promise is seen to break.
    let mut off = ran.clone();
    off.splits[sheet] = 0.0;
    assert!(promise(&case, &off, 12, &mut random).is_err());
    let mut off = ran.clone();
    off.splits.iter_mut().filter(|s| **s == MARKED).for_each(|s| *s = 3e38);
    assert!(promise(&case, &off, 12, &mut random).is_err() && rays(&case, &off, 4000, &mut random).is_err());
}

/// What turns away of a closed body may keep its texels, since it may cut a facet: it is held against no layer.
#[gpu_test]
fn what_only_cuts_is_left_out() {
    let mut others = 0;
    for seed in 0..6 {
        let [with_all, culled, cutting] = with_what_turns_away(gpu(), seed);
        assert_eq!(cutting.marks[2], culled.marks[2]);
        assert_eq!(cutting.splits, culled.splits);
        others += cutting.marks[2].iter().zip(&with_all.marks[2]).filter(|(a, b)| a != b).count();
    }
    assert!(others > 0, "what turns away is seen nowhere");
}
