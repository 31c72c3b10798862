//! Roles of objects: what casts, receives and is seen, per light.

use super::*;
use crate::frames::{ORIGIN, draw, eyes, where_truth_is_sure, wrong};
use oracle::truth::{SceneTruth, TruthImage, join_mask};
use subpixel_shadows::pass::LightTarget;
use subpixel_shadows::scene::{AlphaTested, Roles};

/// Objects of `spheres`: the slab, then its balls.
const BALLS: u32 = 9;

/// A ball each: everything, cast-only, receive-only, neither, unseen, and two that cast or receive in the first layer alone.
fn roles() -> [Roles; BALLS as usize] {
    let first = Roles { casts: 1, ..Roles::ALL };
    let dark_in_first = Roles { receives: 1, ..Roles::ALL };
    let all = Roles::ALL;
    [Roles::RECEIVE_ONLY, Roles::CAST_ONLY, all, Roles::NEITHER, first, dark_in_first, Roles::UNSEEN, first, all]
}

fn given(mesh: &Mesh, roles: &[Roles]) -> AlphaTested {
    let of_ball = (mesh.triangles.len() as u32 - 12) / BALLS;
    assert_eq!(12 + of_ball * BALLS, mesh.triangles.len() as u32);
    let mut tested = AlphaTested::default();
    for (k, &roles) in (0..).zip(roles) {
        tested.set_roles(12 + k * of_ball..12 + (k + 1) * of_ball, roles);
    }
    tested
}

/// The slab's roles, and the balls'.
fn with_slab(mesh: &Mesh, slab: Roles) -> AlphaTested {
    let mut tested = given(mesh, &roles());
    tested.set_roles(0..12, slab);
    tested
}

fn pass_of(settings: &Settings, mesh: &Mesh, tested: &AlphaTested, method: MethodName) -> ShadowPass {
    let casters = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
    let casters = Casters::AlphaTested { casters: &casters, tested };
    let config = PassConfig { method, ..PassConfig::new(settings.clone(), casters) };
    ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
}

/// Scene truth in a light of some layers, with its ambiguity band.
fn truth(scene: &Scene, tested: &AlphaTested, light: &Light, layers: u8, samples: &Samples) -> TruthImage {
    let prepared = Prepared::with_alpha(&scene.mesh, tested).expect("a sound mesh");
    let tracer = Tracer::of(&prepared).expect("a tracer").in_layers(layers);
    let truth = SceneTruth::new(&tracer, &scene.camera, light, samples, SIZE[0], SIZE[1]).expect("a truth");
    let mut image = truth.image(None);
    for (pixel, p) in image.pixels.iter_mut().enumerate() {
        let around = truth.ambiguous_mask(pixel as u32);
        p.ambiguous = std::array::from_fn(|k| p.ambiguous[k] | around[k]);
    }
    image
}

/// Samples that differ outside the ambiguity band.
fn off(lit: &[u32], truth: &TruthImage) -> u32 {
    let of = |(&lit, p): (&u32, &oracle::truth::PixelTruth)| match p.seen_count {
        0 => 0,
        _ => ((u128::from(lit) ^ join_mask(p.lit)) & !join_mask(p.ambiguous)).count_ones(),
    };
    lit.iter().zip(&truth.pixels).map(of).sum()
}

fn lamps(scene: &Scene) -> [(Light, u8); 3] {
    let sun = Light::Directional { direction: [0.4, 1.0, 0.3] };
    [(scene.light, 1), (scene.light, 2), (sun, 6)]
}

/// Every sample of every light by every exact method, with the slab in the same role as others or not; each light sees other casters.
#[gpu_test]
fn objects_cast_and_receive_as_they_are_told() {
    let scene = scene("spheres");
    let settings = settings(FacetMode::All, 32);
    for slab in [Roles::ALL, Roles::RECEIVE_ONLY] {
        let tested = with_slab(&scene.mesh, slab);
        let truths = lamps(&scene).map(|(light, layers)| truth(&scene, &tested, &light, layers, &settings.samples));
        for method in [MethodName::FacetMasks, MethodName::RayTraced, MethodName::Supersampled] {
            let mut pass = pass_of(&settings, &scene.mesh, &tested, method);
            let mut got = Vec::new();
            for ((light, layers), truth) in lamps(&scene).iter().zip(&truths) {
                let (picture, status) =
                    frame(&mut pass, &Inputs { layers: *layers, ..Inputs::new(&scene.camera, light) });
                assert!(status.complete, "{method:?}: {status:?}");
                assert_eq!(off(&picture.lit, truth), 0, "{method:?}, {slab:?}, layers {layers}: samples wrong");
                got.push(picture);
            }
            // The truths of others, and of objects without roles, are told apart.
            let whole = truth(&scene, &AlphaTested::default(), &scene.light, 1, &settings.samples);
            for other in [&truths[1], &truths[2], &whole] {
                assert!(off(&got[0].lit, other) > 300, "{method:?}: {}", off(&got[0].lit, other));
            }
        }
    }
}

/// Lights of one frame, recorded together: what the camera sees is found once, casters differ.
#[gpu_test]
fn lights_of_one_frame_have_layers_of_their_own() {
    let scene = scene("spheres");
    let settings = settings(FacetMode::All, 32);
    let tested = with_slab(&scene.mesh, Roles::ALL);
    let mut pass = pass_of(&settings, &scene.mesh, &tested, MethodName::FacetMasks);
    let bytes = 4 * PIXELS as u64;
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    let buffers = lamps(&scene).map(|_| {
        gpu().device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage,
            mapped_at_creation: false,
        })
    });
    let asked: Vec<LightTarget> = lamps(&scene)
        .iter()
        .zip(&buffers)
        .map(|(&(light, layers), lit)| {
            let target = Target { lit: Some(lit), ..Target::default() };
            LightTarget { layers, ..LightTarget::new(light, target) }
        })
        .collect();
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for round in 0..5 {
        let mut encoder = gpu().encoder();
        pass.record_lights(&mut encoder, &inputs, &asked).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        if (0..3).filter(|_| status_of(&mut pass).complete).count() == 3 {
            break;
        }
        assert!(round < 4, "no complete frames");
    }
    for ((light, layers), lit) in lamps(&scene).iter().zip(&buffers) {
        let truth = truth(&scene, &tested, light, *layers, &settings.samples);
        assert_eq!(off(&read(lit), &truth), 0, "layers {layers}");
    }
}

/// A terrain of small triangles that casts nothing lies outside the light's view, and receives all the same.
#[gpu_test]
fn a_terrain_that_casts_nothing_receives() {
    let mut scene = scene("spheres");
    let casters = scene.mesh.triangles.len() as u32;
    const SIDE: u32 = 60;
    let (first, place) = (scene.mesh.positions.len() as u32, |k: u32| 0.4 * (k as f32 - 0.5 * SIDE as f32));
    let ground = scene.mesh.bounds().expect("a mesh").0.y as f32 - 0.3;
    for k in 0..(SIDE + 1) * (SIDE + 1) {
        let [x, z] = [k % (SIDE + 1), k / (SIDE + 1)].map(place);
        scene.mesh.positions.push([x, ground + 0.1 * (x * 0.7).sin(), z]);
        if k % (SIDE + 1) < SIDE && k / (SIDE + 1) < SIDE {
            let [a, b] = [first + k, first + k + SIDE + 1];
            scene.mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
    // The slab is gone: balls float above the terrain.
    scene.mesh.triangles[..12].fill([0; 3]);
    let settings = settings(FacetMode::All, 32);
    let mut pairs = Vec::new();
    for roles in [Roles::RECEIVE_ONLY, Roles::ALL] {
        let mut tested = AlphaTested::default();
        tested.set_roles(casters..scene.mesh.triangles.len() as u32, roles);
        let mut pass = pass_of(&settings, &scene.mesh, &tested, MethodName::FacetMasks);
        let among = Light::Point { position: [0.8, 1.9, 0.9] };
        for light in [Light::Directional { direction: [0.5, 1.0, 0.3] }, among] {
            let (picture, status) = frame(&mut pass, &Inputs::new(&scene.camera, &light));
            let truth = truth(&scene, &tested, &light, u8::MAX, &settings.samples);
            assert!(status.complete, "{roles:?}: {status:?}");
            assert_eq!(off(&picture.lit, &truth), 0, "{roles:?}, {light:?}: samples wrong");
            let shadowed = truth.pixels.iter().filter(|p| p.visibility < 1.0).count();
            assert!(shadowed > 300, "{roles:?}, {light:?}: {shadowed} pixels in shadow");
            pairs.push(status.counts.visibility_evaluations);
        }
    }
    assert!(pairs[0] * 10 < pairs[2] * 9, "evaluations: {pairs:?}");
}

/// Triangle numbers that the application drew with the hardware's rasterizer, without what is unseen.
#[gpu_test]
fn drawn_frames_know_roles() {
    let scene = scene("spheres");
    let tested = with_slab(&scene.mesh, Roles::ALL);
    let settings = Settings { settle: false, ..settings(FacetMode::One, 32) };
    let mut pass = pass_of(&settings, &scene.mesh, &tested, MethodName::FacetMasks);
    let prepared = Prepared::with_alpha(&scene.mesh, &tested).expect("a sound mesh");
    let mut own = vec![None; scene.mesh.triangles.len()];
    (0..).zip(&prepared.given).for_each(|(t, &given)| own[given as usize] = Some(t));
    let mut seen = scene.mesh.clone();
    for of in tested.triangles.iter().filter(|of| !of.roles.seen) {
        seen.triangles[of.triangle as usize] = [0; 3];
    }
    let eye = &eyes(&scene)[0].jittered([0.3, -0.2]);
    let drawn = draw(&seen, eye);
    let scene = Scene { camera: eye.camera(), mesh: prepared.mesh().clone(), ..scene };
    let coverage = [u32::MAX, 0, 0, 0];
    let input = |(pixel, t): (u32, Option<u32>)| Some(FacetInput { pixel, triangle: own[t? as usize]?, coverage });
    let inputs: Vec<FacetInput> = (0..).zip(drawn.triangles()).filter_map(input).collect();
    let judged = |tracer: &Tracer, light: &Light| {
        let [w, h] = SIZE;
        let truth = FacetTruth::new(tracer, &scene.camera, light, &settings.samples, w, h).expect("a truth");
        let results = truth.judge(&inputs, None).expect("judged");
        let mut truth: Vec<_> = inputs.iter().copied().zip(results).collect();
        where_truth_is_sure(&mut truth, &scene, &settings.samples);
        truth
    };
    for (light, layers) in lamps(&scene) {
        let tracer = Tracer::of(&prepared).expect("a tracer");
        let gbuffer = GBuffer::TriangleIds(TriangleTexture::new(&drawn.ids));
        let inputs = Inputs { layers, gbuffer, origin: Some(ORIGIN), ..Inputs::new(&scene.camera, &light) };
        let (got, status) = frame(&mut pass, &inputs);
        assert!(status.complete, "{status:?}");
        assert_eq!(wrong(&got, &judged(&tracer.clone().in_layers(layers), &light))[0], 0, "layers {layers}");
        assert!(wrong(&got, &judged(&tracer.in_layers(layers ^ 3), &light))[0] > 300, "layers {layers}");
    }
}

/// Methods of depth maps: what receives nothing is lit to the bit, and all of it is nearer to the truth than to that without roles.
#[gpu_test]
fn depth_maps_know_roles() {
    let scene = scene("spheres");
    let settings = settings(FacetMode::One, 32);
    let tested = with_slab(&scene.mesh, Roles::ALL);
    let own = truth(&scene, &tested, &scene.light, 2, &settings.samples);
    let none = truth(&scene, &AlphaTested::default(), &scene.light, 2, &settings.samples);
    for method in [MethodName::ShadowMap, MethodName::Pcf, MethodName::Variance, MethodName::Reconstructable] {
        let picture = |tested: &AlphaTested| -> Vec<f32> {
            let mut pass = pass_of(&settings, &scene.mesh, tested, method);
            let inputs = Inputs { layers: 2, ..Inputs::new(&scene.camera, &scene.light) };
            let mut encoder = gpu().encoder();
            pass.record(&mut encoder, &inputs, &Target::default()).expect("recorded");
            gpu().submit_and_wait(encoder).expect("the frame runs");
            assert!(status_of(&mut pass).complete, "{method:?}");
            bytemuck::cast_vec(read(pass.visibility()))
        };
        let error = |got: &[f32], truth: &TruthImage| {
            let sum: f64 = truth.pixels.iter().zip(got).map(|(p, v)| f64::from(p.visibility - v).abs()).sum();
            sum / PIXELS as f64
        };
        let [got, whole] = [&tested, &AlphaTested::default()].map(picture);
        let ([with, without], own) = ([&got, &whole].map(|got| error(got, &none)), error(&got, &own));
        assert!(
            own < 1.3 * without + 0.005 && with > 1.5 * own,
            "{method:?}: {own}, {without} without roles, {with} of that"
        );
    }
}

/// A light of no layer, and methods that know no roles.
#[gpu_test]
fn layers_that_cannot_be_are_refused() {
    let scene = scene("spheres");
    let tested = with_slab(&scene.mesh, Roles::ALL);
    let one = settings(FacetMode::One, 32);
    let mut pass = pass_of(&one, &scene.mesh, &tested, MethodName::FacetMasks);
    let inputs = Inputs { layers: 0, ..Inputs::new(&scene.camera, &scene.light) };
    refused("no layer", pass.record(&mut gpu().encoder(), &inputs, &Target::default()));
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let casters = Casters::AlphaTested { casters: &casters, tested: &tested };
    let config = PassConfig { method: MethodName::Spsm, ..PassConfig::new(one.clone(), casters) };
    let spsm = ShadowPass::new(&gpu().device, &gpu().queue, &config);
    assert!(spsm.is_err_and(|e| e.to_string().contains("spsm")));
    let prepared = Prepared::with_alpha(&scene.mesh, &tested).expect("a sound mesh");
    let request = oracle::engine::CpuRequest::default();
    let cpu = oracle::engine::render(&prepared, &one, &scene.camera, &scene.light, request);
    assert!(cpu.is_err_and(|e| e.to_string().contains("roles")));
}
