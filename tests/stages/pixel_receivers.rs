//! Surfaces out of depth and position textures: casters, and triangles made of what is none.

mod case;
mod far;
mod samples;

use self::case::Case;
use crate::support::shadow::{
    World, camera, folding_gpu, random_scene, samples as sample_pattern, uniform, unit, vector,
};
use crate::support::{Random, difference, filled_texture, gpu, poisoned, read_padded, run, sizes_around, upload};
use oracle::reference::pixel_receivers::{GbufferTexels, Ids, PixelContent, PositionSource, ReceiverPixel, pixels};
use std::sync::OnceLock;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::methods::prepared::padded;
use subpixel_shadows::scene::Light;
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::pixel_receivers::{
    FAULT_UNKNOWN, FAULT_UNUSABLE, GIVEN_IDS, GIVEN_NORMALS, GIVEN_POSITIONS, GivenTexture, PixelReceivers,
    PixelReceiversParams, ReceiverKeys, ReceiverRoom, SeenCasters, Textures, unread_samples,
};
use subpixel_shadows::wgpu;
use test_support::gpu_test;

const TOLERANCE: f32 = 1e-3;
/// Reversed, infinite.
const TERMS: [f32; 4] = [0.0, 0.25, 1.0, 0.0];

fn world(gpu: &'static Gpu, size: [u32; 2], random: &mut Random) -> World {
    let mesh = random_scene(random.below(4), random);
    let eye = vector(random).normalize() * (1.5 + 2.0 * unit(random));
    let light = Light::Directional { direction: [0.3, 1.0, 0.2] };
    let mut world = World::new(gpu, &mesh, camera(eye, vector(random) * 0.3, 50.0), light, size, 8, sample_pattern(8));
    world.frame.image_size = size;
    world
}

fn blocks<'a>(world: &'a World, offsets: &'a Buffer<u32>, args: &'a Buffer<u32>) -> Blocks<'a> {
    Blocks {
        triangles: &world.casters.triangles,
        points: &world.map_points,
        rects: &world.facts.camera_rects,
        facing: &world.facts.facing,
        offsets,
        args: (args.raw(), 0),
    }
}

/// What the GPU wrote: keys with their padding, the triangles and positions behind the casters, faults.
#[derive(Clone, PartialEq, Debug)]
struct Got {
    keys: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    positions: Vec<[f32; 3]>,
    faults: Vec<u32>,
}

fn ask(world: &World, case: &Case) -> Got {
    static STAGES: OnceLock<[PixelReceivers; 2]> = OnceLock::new();
    let stages = STAGES.get_or_init(|| [gpu(), folding_gpu()].map(|g| PixelReceivers::new(&g.device, false)));
    let gpu = world.gpu;
    let stage = &stages[usize::from(!std::ptr::eq(gpu, self::gpu()))];
    let pixels = case.seen.len();
    let size = world.view.image;
    let (mesh, device, queue) = (world.prepared.mesh(), &gpu.device, &gpu.queue);
    let given = |on: bool, flag: u32| if on { flag } else { 0 };
    let mut params = PixelReceiversParams {
        tolerance: TOLERANCE,
        given: given(case.depths.is_none(), GIVEN_POSITIONS)
            | given(case.normals.is_some(), GIVEN_NORMALS)
            | given(case.ids.is_some(), GIVEN_IDS),
        ..PixelReceiversParams::at_centres()
    };
    let place = match &case.depths {
        Some((values, terms, nothing)) => {
            (params.depth, params.nothing) = (*terms, *nothing);
            filled_texture(gpu, size, wgpu::TextureFormat::R32Float, bytemuck::cast_slice(values))
        }
        None => filled_texture(gpu, size, wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(&case.positions)),
    };
    let normals = case
        .normals
        .as_ref()
        .map(|n| filled_texture(gpu, size, wgpu::TextureFormat::Rgba32Float, bytemuck::cast_slice(n)));
    let (texels, first, none, numbers) = case.ids.clone().unwrap_or((vec![0; pixels], 0, 0, vec![0]));
    (params.first, params.none) = (first, none);
    let ids = filled_texture(gpu, size, wgpu::TextureFormat::R32Uint, bytemuck::cast_slice(&texels));
    // One more than there is room for.
    let spare = |count: usize| [padded(&mesh.triangles), vec![[0xdead; 4]; count]].concat();
    let all_triangles = Buffer::from_slice(device, queue, "test", &spare(pixels + 1)).expect("memory");
    let triangles = Buffer::with_room(device, queue, "test", &padded(&mesh.triangles), pixels + 1).expect("memory");
    let positions = Buffer::with_room(device, queue, "test", &padded(&mesh.positions), 3 * pixels + 1).expect("memory");
    let mut encoder = gpu.encoder();
    encoder.copy_buffer_to_buffer(all_triangles.raw(), 0, triangles.raw(), 0, all_triangles.bytes());
    gpu.submit_and_wait(encoder).expect("the copy runs");
    let id_keys: Vec<u32> = case.seen.iter().map(|t| t.map_or(0, |t| !t)).collect();
    let (id_keys, numbers) = (upload(gpu, &id_keys), upload(gpu, &numbers));
    let to = ReceiverKeys { keys: poisoned(gpu, pixels), claims: poisoned(gpu, pixels) };
    let items = world.facts.camera_items.read(gpu).expect("readback");
    let (offsets, args, _) = world.items(&items);
    let seen = SeenCasters { blocks: blocks(world, &offsets, &args), id_keys: &id_keys };
    let faults = upload(gpu, &[7u32, 8, 0, 0]);
    let frame = uniform(gpu, &world.frame);
    let samples = samples::textures(gpu, case, size, &mut params);
    run(gpu, |s| {
        let [place_samples, normal_samples] = &samples;
        let normals = normals.as_ref().unwrap_or(&place);
        let textures = Textures {
            place: GivenTexture { single: &place, samples: place_samples },
            normals: GivenTexture { single: normals, samples: normal_samples },
            ids: &ids,
        };
        let surfaces = ReceiverRoom { numbers: &numbers, triangles: &triangles, positions: &positions };
        stage.record(s, &frame, params, textures, surfaces, seen, &to, &faults)
    });
    // What lies behind the casters is not seen through buffers of their length.
    let behind = |raw: &wgpu::Buffer, len: usize| {
        let all = Buffer::<[u32; 4]>::storage(device, "test.copy", len).expect("memory");
        let mut encoder = gpu.encoder();
        encoder.copy_buffer_to_buffer(raw, 0, all.raw(), 0, 16 * len as u64);
        gpu.submit_and_wait(encoder).expect("the copy runs");
        all.read(gpu).expect("readback").into_iter().map(|[x, y, z, _]| [x, y, z]).collect::<Vec<_>>()
    };
    let (t, v) = (mesh.triangles.len(), mesh.positions.len());
    let triangles = behind(triangles.raw(), t + pixels + 1);
    let positions = behind(positions.raw(), v + 3 * pixels + 1);
    assert_eq!(triangles[..t], mesh.triangles, "the casters' triangles are touched");
    let floats: Vec<[f32; 3]> = positions.iter().map(|p| p.map(f32::from_bits)).collect();
    assert_eq!(floats[..v], mesh.positions, "the casters' vertices are touched");
    assert_eq!((triangles[t + pixels], positions[v + 3 * pixels]), ([0xdead; 3], [0; 3]), "written past the end");
    Got {
        keys: read_padded(gpu, &to.keys),
        triangles: triangles[t..t + pixels].to_vec(),
        positions: floats[v..v + 3 * pixels].to_vec(),
        faults: faults.read(gpu).expect("readback"),
    }
}

/// What is wrong with each pixel, and how many were open to rounding.
fn faults(world: &World, case: &Case, got: &Got) -> (Vec<String>, usize) {
    let (casters, vertices) = (world.frame.triangle_count, world.frame.vertex_count);
    let (mut out, mut open) = (Vec::new(), 0);
    let mut counts = [0u32; 2];
    for (pixel, want) in case.wanted(world).iter().enumerate() {
        let shown = match got.keys[pixel] {
            0 => None,
            key => Some(!key),
        };
        if want.open {
            open += 1;
            continue;
        }
        let mut fault = |what: String| out.push(format!("pixel {pixel}: {what}, expected {want:?}"));
        match want.shown {
            PixelContent::Nothing | PixelContent::Unknown | PixelContent::Unusable => {
                counts[0] += u32::from(want.shown == PixelContent::Unknown);
                counts[1] += u32::from(want.shown == PixelContent::Unusable);
                if shown.is_some() {
                    fault(format!("{shown:?}"));
                }
            }
            PixelContent::Caster(t) => {
                if shown != Some(t) {
                    fault(format!("{shown:?}"));
                }
            }
            PixelContent::Plane { point, normal, doubt } => {
                let first = vertices + 3 * pixel as u32;
                if shown != Some(casters + pixel as u32) || got.triangles[pixel] != [first, first + 1, first + 2] {
                    fault(format!("{shown:?} of {:?}", got.triangles[pixel]));
                    continue;
                }
                let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(got.positions[3 * pixel + k]).as_dvec3());
                let n = (b - a).cross(c - a).normalize();
                let size = point.abs().max_element().max((point - world.view.eye).length());
                let (off, tilt) = (n.dot(point - a).abs(), n.cross(normal.normalize()).length());
                let (u, v) = ((b - a).cross(point - a).dot(n), (point - a).cross(c - a).dot(n));
                let inside = u > 0.0 && v > 0.0 && u + v < (b - a).cross(c - a).dot(n);
                if off > 4e-6 * size || !inside || (b - a).length() < size {
                    fault(format!("{off} off the plane, inside: {inside}, {} beside {size}", (b - a).length()));
                }
                if tilt > doubt + 1e-6 {
                    fault(format!("turned by {tilt}"));
                }
            }
        }
    }
    let mut wanted = vec![7, 8, 0, 0];
    (wanted[FAULT_UNKNOWN as usize], wanted[FAULT_UNUSABLE as usize]) = (counts[0], counts[1]);
    if got.faults != wanted && open == 0 {
        out.push(format!("faults {:?}, expected {wanted:?}", got.faults));
    }
    let spare = &got.keys[case.seen.len()..];
    if spare.iter().any(|&w| w != crate::support::POISON) {
        out.push("written past the last pixel".to_owned());
    }
    (out, open)
}

#[track_caller]
fn check(world: &World, case: &Case) -> Got {
    let got = ask(world, case);
    let (found, open) = faults(world, case, &got);
    assert!(found.is_empty(), "{}: {}", found.len(), found[..found.len().min(5)].join("\n"));
    assert!(open * 10 < case.seen.len() + 100, "{open} of {} pixels are open to rounding", case.seen.len());
    got
}

#[gpu_test]
fn empty() {
    let world = world(gpu(), [5, 3], &mut Random::new(1));
    let nothing = Case {
        depths: Some((vec![0.0; 15], TERMS, 0.0)),
        positions: vec![[3.0, 4.0, 5.0, 0.0]; 15],
        normals: None,
        ids: None,
        seen: world.seen().into_iter().map(|(_, t)| t).collect(),
        sample: None,
    };
    assert!(check(&world, &nothing).keys[..15].iter().all(|&k| k == 0));
    assert!(check(&world, &nothing.by_position()).keys[..15].iter().all(|&k| k == 0));
}

#[gpu_test]
fn one() {
    let mut random = Random::new(2);
    let world = world(gpu(), [1, 1], &mut random);
    let at = world.view.rays.eye + world.view.rays.direction(0.5, 0.5) * 1.75;
    let alone = Case {
        depths: Some((vec![TERMS[1] / 1.75], TERMS, 0.0)),
        positions: vec![at.as_vec3().extend(1.0).into()],
        normals: None,
        ids: None,
        seen: vec![None],
        sample: None,
    };
    // Without neighbours it faces the eye.
    check(&world, &alone);
    check(&world, &alone.clone().by_position());
    check(&world, &alone.with_normals(&mut random));
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(3);
    for pixels in sizes_around(64) {
        let world = world(gpu(), [pixels as u32, 1], &mut random);
        let case = Case::new(&world, &mut random);
        check(&world, &case);
        check(&world, &case.by_position());
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(4);
    let mut shown = [0; 3];
    for round in 0..24 {
        let size = [[48, 36], [61, 31], [3, 200]][round % 3];
        let world = world(gpu(), size, &mut random);
        let mut case = Case::new(&world, &mut random);
        if round % 2 == 1 {
            case = case.by_position();
        }
        check(&world, &case);
        let with_normals = case.clone().with_normals(&mut random);
        check(&world, &with_normals);
        let with_ids = case.with_ids(world.frame.triangle_count, &mut random);
        check(&world, &with_ids);
        for pixel in with_normals.wanted(&world) {
            match pixel.shown {
                PixelContent::Nothing => shown[0] += 1,
                PixelContent::Caster(_) => shown[1] += 1,
                _ => shown[2] += 1,
            }
        }
    }
    assert!(shown.iter().all(|&n| n > 2000), "nothing, casters, others: {shown:?}");
}

/// What is no number, infinite, behind the eye, too far away or without direction, in each texture.
#[gpu_test]
fn degenerate() {
    let mut random = Random::new(5);
    let world = world(gpu(), [16, 12], &mut random);
    let case = Case::new(&world, &mut random);
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let mut off = case.clone();
    if let Some((values, ..)) = &mut off.depths {
        values[..7].copy_from_slice(&[nan, inf, -inf, -0.5, 1e-30, f32::MAX, -1e-30]);
        values[50..53].copy_from_slice(&[nan, inf, -0.5]);
    }
    off.seen = vec![None; off.seen.len()];
    let got = check(&world, &off);
    assert!(got.faults[FAULT_UNUSABLE as usize] >= 9, "{:?}", got.faults);
    let mut off = case.clone().by_position();
    off.seen = vec![None; off.seen.len()];
    let behind = (world.view.rays.eye - world.view.rays.forward).as_vec3();
    let eye = world.camera.eye;
    for (k, p) in [
        [nan, 0.0, 0.0, 1.0],
        [0.0, inf, 0.0, 1.0],
        [0.0, 0.0, -inf, 1.0],
        [0.0, 0.0, 0.0, nan],
        behind.extend(1.0).into(),
        [eye[0], eye[1], eye[2], 1.0],
        [1e30, 1e30, 1e30, 1.0],
        [0.0, 0.0, 0.0, inf],
    ]
    .into_iter()
    .enumerate()
    {
        off.positions[20 + k] = p;
    }
    let got = check(&world, &off);
    assert!(got.faults[FAULT_UNUSABLE as usize] >= 7, "{:?}", got.faults);
    let mut off = case.with_normals(&mut random);
    let bad = [[nan, 0.0, 1.0, 0.0], [0.0, -inf, 1.0, 0.0], [0.0; 4]];
    if let Some(normals) = &mut off.normals {
        normals.iter_mut().enumerate().for_each(|(k, n)| *n = bad[k % 3]);
    }
    let got = check(&world, &off);
    assert!(got.faults[FAULT_UNUSABLE as usize] > 20, "{:?}", got.faults);
    // Far from the origin, places are as exact as their coordinates.
    let mut far = far::case_far(&mut random);
    far.1.seen = vec![None; far.1.seen.len()];
    check(&far.0, &far.1);
}

/// There is no list: nothing is written past the room of the last pixel, and too little room is refused.
#[gpu_test]
fn overflow_by_one() {
    let mut random = Random::new(7);
    for pixels in [63, 65, 127] {
        let world = world(gpu(), [pixels, 1], &mut random);
        check(&world, &Case::new(&world, &mut random).with_normals(&mut random));
    }
    let (stage, unread) = (PixelReceivers::new(&gpu().device, false), unread_samples(&gpu().device));
    let (device, queue) = (&gpu().device, &gpu().queue);
    let view = filled_texture(gpu(), [1, 1], wgpu::TextureFormat::R32Float, &[0; 4]);
    let ids = filled_texture(gpu(), [1, 1], wgpu::TextureFormat::R32Uint, &[0; 4]);
    let (numbers, faults, id_keys) = (upload(gpu(), &[0u32]), upload(gpu(), &[0u32; 4]), upload(gpu(), &[0u32; 8]));
    let to = ReceiverKeys { keys: poisoned(gpu(), 8), claims: poisoned(gpu(), 8) };
    let world = world(gpu(), [8, 1], &mut random);
    let (offsets, args, _) = world.items(&vec![0; world.frame.triangle_count as usize]);
    let frame = uniform(gpu(), &Default::default());
    for (t, v, enough) in [(8, 24, true), (6, 24, false), (8, 22, false)] {
        let triangles = Buffer::with_room(device, queue, "test", &[], t).expect("memory");
        let positions = Buffer::with_room(device, queue, "test", &[], v).expect("memory");
        run(gpu(), |s| {
            let given = GivenTexture { single: &view, samples: &unread };
            let textures = Textures { place: given, normals: given, ids: &ids };
            let surfaces = ReceiverRoom { numbers: &numbers, triangles: &triangles, positions: &positions };
            let seen = SeenCasters { blocks: blocks(&world, &offsets, &args), id_keys: &id_keys };
            let asked =
                stage.record(s, &frame, PixelReceiversParams::at_centres(), textures, surfaces, seen, &to, &faults);
            if !enough {
                assert!(asked.is_err(), "{t} triangles and {v} vertices pass for eight pixels");
            }
            Ok(())
        });
    }
}

#[gpu_test]
fn two_d_dispatch() {
    // Nine workgroups in three rows.
    let make = |gpu| {
        let mut random = Random::new(8);
        let world = world(gpu, [24, 24], &mut random);
        let case = Case::new(&world, &mut random).with_normals(&mut random);
        check(&world, &case)
    };
    assert!(make(folding_gpu()) == make(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let mut random = Random::new(9);
    let world = world(gpu(), [40, 30], &mut random);
    let case = Case::new(&world, &mut random);
    let got = check(&world, &case);
    let wanted = case.wanted(&world);
    let plane = wanted
        .iter()
        .position(|p| matches!(p.shown, PixelContent::Plane { doubt, .. } if doubt < 1e-3) && !p.open)
        .expect("a plane");
    let caster = wanted.iter().position(|p| matches!(p.shown, PixelContent::Caster(_)) && !p.open).expect("a caster");
    let mut off = got.clone();
    off.keys[caster] ^= 1;
    assert!(!faults(&world, &case, &off).0.is_empty(), "a wrong caster passes");
    let mut off = got.clone();
    (0..3).for_each(|k| off.positions[3 * plane + k][1] += 0.01);
    assert!(!faults(&world, &case, &off).0.is_empty(), "a moved plane passes");
    let mut off = got.clone();
    off.positions[3 * plane][0] *= 1.5;
    off.positions[3 * plane][1] -= 1.0;
    assert!(!faults(&world, &case, &off).0.is_empty(), "a turned plane passes");
    let mut other = case.clone();
    if let Some((values, ..)) = &mut other.depths {
        values.iter_mut().for_each(|v| *v *= 1.05);
    }
    assert!(!faults(&world, &other, &got).0.is_empty(), "another depth passes");
    assert!(difference(&got.keys, &ask(&world, &other).keys).is_some());
}
