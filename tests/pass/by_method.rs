//! A method a light in one frame: passes over the same casters in the same memory.

use super::parts::of;
use super::*;
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::pass::{CasterPart, Transforms};

fn made(config: &PassConfig) -> ShadowPass {
    ShadowPass::new(&gpu().device, &gpu().queue, config).expect("a pass")
}

/// A light's visibility, read from its texture.
fn target() -> wgpu::Texture {
    texture(SIZE, TextureFormat::R32Float, TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC)
}

fn read(texture: &wgpu::Texture) -> Vec<u32> {
    let [width, height] = SIZE.map(|n| n as usize);
    let row = (4 * width).next_multiple_of(256);
    let staging = buffer((row * height) as u64, BufferUsages::COPY_DST | BufferUsages::MAP_READ);
    let mut encoder = gpu().encoder();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &staging, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    gpu().queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu().wait(None).expect("the copy runs");
    let bytes = staging.get_mapped_range(..).expect("mapped").to_vec();
    bytes.chunks(row).flat_map(|r| bytemuck::pod_collect_to_vec::<u8, u32>(&r[..4 * width])).collect()
}

/// Complete frames of all lights.
fn complete_by(passes: &mut [&mut ShadowPass], inputs: &Inputs, lights: &[(usize, Light)]) -> Vec<Vec<u32>> {
    for _ in 0..6 {
        let targets: Vec<wgpu::Texture> = lights.iter().map(|_| target()).collect();
        let asked: Vec<(usize, LightTarget)> = lights
            .iter()
            .zip(&targets)
            .map(|(&(of, light), to)| (of, LightTarget::new(light, Target::texture(to))))
            .collect();
        let mut encoder = gpu().encoder();
        let numbers = ShadowPass::record_by_method(passes, &mut encoder, inputs, &asked).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        let mut whole = true;
        for (k, pass) in passes.iter_mut().enumerate() {
            let own: Vec<u64> = lights.iter().zip(&numbers).filter(|((of, _), _)| *of == k).map(|(_, n)| *n).collect();
            let statuses: Vec<FrameStatus> = own.iter().map(|_| status_of(pass)).collect();
            assert!(statuses.iter().map(|s| s.frame).eq(own), "a number a light");
            whole &= statuses.iter().all(|s| s.complete);
        }
        if whole {
            return targets.iter().map(read).collect();
        }
    }
    panic!("no complete frames by the sixth");
}

fn lights(scene: &Scene) -> [(usize, Light); 4] {
    let sun = |direction| Light::Directional { direction };
    [(0, sun([0.5, 1.0, 0.3])), (1, scene.light), (0, sun([-0.6, 1.0, 0.1])), (2, sun([0.1, 1.0, -0.8]))]
}

const METHODS: [MethodName; 3] = [MethodName::FacetMasks, MethodName::Pcf, MethodName::Variance];

fn settings_of(method: MethodName) -> Settings {
    let facets = if method == MethodName::FacetMasks { FacetMode::All } else { FacetMode::One };
    Settings { map: if method == MethodName::Variance { 128 } else { 64 }, ..settings(facets) }
}

/// Facets for the sun, cheap maps for other lights: each light's picture is that of its method alone, in a pass of its own casters, to the bit; of casters
/// that stand, and that move between frames. The passes beside the first hold no casters.
#[gpu_test]
fn lights_have_methods_of_their_own() {
    let scene = scene("spheres");
    let moving = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    for (casters, times) in [(casters(&scene.mesh), 1), (moving, 2)] {
        let config = |method| PassConfig { method, ..PassConfig::new(settings_of(method), casters) };
        let mut first = made(&config(METHODS[0]));
        let none = Casters::Static { positions: &[], triangles: &[] };
        let [mut pcf, mut variance] =
            [1, 2].map(|k| first.beside(&PassConfig { casters: none, ..config(METHODS[k]) }).expect("a pass"));
        let own = |pass: &ShadowPass| pass.memory().iter().filter(|b| b.label.starts_with("casters.")).count();
        assert!(own(&first) >= 4 && own(&pcf) == 0 && own(&variance) == 0, "{:?}", pcf.memory());
        let mut before: Option<Vec<Vec<u32>>> = None;
        for time in 0..times {
            let mut mesh = scene.mesh.clone();
            mesh.positions.iter_mut().filter(|p| p[1] > 0.1).for_each(|p| p[0] += 0.25 * time as f32);
            let buffer = vertex_buffer(&mesh.positions);
            let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
            let moved = matches!(casters, Casters::Moving { .. }).then(|| Moved { vertices, bounds: bounds(&mesh) });
            let inputs = Inputs { moved, ..Inputs::new(&scene.camera, &scene.light) };
            let lights = lights(&scene);
            let got = complete_by(&mut [&mut first, &mut pcf, &mut variance], &inputs, &lights);
            for (k, ((of, light), got)) in lights.iter().zip(&got).enumerate() {
                let mut alone = made(&config(METHODS[*of]));
                let want = complete_by(&mut [&mut alone], &inputs, &[(0, *light)]);
                assert!(*got == want[0], "light {k} by {:?} at {time}", METHODS[*of]);
                assert!(got.iter().filter(|v| **v == 0).count() > 100, "light {k}: dark pixels");
            }
            // Another method, light or time is told apart.
            let other =
                complete_by(&mut [&mut first, &mut pcf, &mut variance], &inputs, &lights.map(|(of, l)| (2 - of, l)));
            assert!(other.iter().zip(&got).filter(|(a, b)| a != b).count() >= 3 && got[0] != got[2]);
            assert!(before.replace(got.clone()).is_none_or(|before| before.iter().zip(&got).all(|(a, b)| a != b)));
        }
    }
}

/// Methods and passes tell what they cannot before anything is recorded.
#[gpu_test]
fn methods_that_cannot_are_told() {
    let scene = scene("spheres");
    let moving = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let mut first = made(&PassConfig::new(settings(FacetMode::All), casters(&scene.mesh)));
    let config = |method| PassConfig { method, ..PassConfig::new(settings(FacetMode::One), casters(&scene.mesh)) };
    let mut pcf = first.beside(&config(MethodName::Pcf)).expect("a pass");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let whole = LightTarget::new(scene.light, Target::default());
    let lit = buffer(4 * u64::from(SIZE[0] * SIZE[1]), BufferUsages::COPY_DST);
    let with_lit = LightTarget { target: Target { lit: Some(&lit), ..Target::default() }, ..whole };
    let nowhere = Light::Point { position: [f32::NAN; 3] };
    for (lights, told) in [
        ([(0, whole), (2, whole)], "light 1: of pass 2, there are 2"),
        ([(0, with_lit), (1, with_lit)], "light 1: lit masks: the method keeps none"),
        ([(1, whole), (0, LightTarget { light: nowhere, ..whole })], "light 1: "),
        ([(0, whole), (1, LightTarget { layers: 0, ..whole })], "light 1: the light is in no layer"),
    ] {
        let mut encoder = gpu().encoder();
        let asked = ShadowPass::record_by_method(&mut [&mut first, &mut pcf], &mut encoder, &inputs, &lights);
        let error = asked.expect_err(told).to_string();
        assert!(error.contains(told) && !error.contains('\n'), "{told}: {error}");
        assert_eq!((first.frames_in_flight(), pcf.frames_in_flight()), (0, 0), "{told}");
    }
    let keeps = PassConfig { keep_last: true, ..config(MethodName::Pcf) };
    let mut keeps = first.beside(&keeps).expect("a pass");
    let both = [(0, whole), (1, whole), (1, whole)];
    let asked = ShadowPass::record_by_method(&mut [&mut first, &mut keeps], &mut gpu().encoder(), &inputs, &both);
    assert!(asked.is_err_and(|e| e.to_string().contains("2 lights")) && first.frames_in_flight() == 0);
    let moves = made(&PassConfig::new(settings(FacetMode::All), moving));
    let refused = |pass: &ShadowPass, method| pass.beside(&config(method)).err().expect("refused").to_string();
    assert!(refused(&moves, MethodName::RayTraced).contains("ray-traced: its tree"));
    let parts = [CasterPart::standing(of(&scene.mesh))];
    let parts = made(&PassConfig::new(settings(FacetMode::All), Casters::Parts { parts: &parts, room: 0 }));
    assert!(refused(&parts, MethodName::Pcf).contains("in parts"));
    let none = PassConfig { receivers: true, ..config(MethodName::Pcf) };
    assert!(first.beside(&none).err().expect("refused").to_string().contains("pcf"));
}

/// Boxes around instances hold what the GPU makes of them, and are not much wider.
#[gpu_test]
fn boxes_of_instances_hold_them() {
    let [body, _] = super::instances::meshes();
    let own = bounds(&body);
    for step in [0.0f32, 0.37, 1.1] {
        let transforms: Vec<super::instances::Transform> = (0..9)
            .map(|k| {
                let ((s, c), at) = ((0.7 * k as f32 + step).sin_cos(), 1000.0 / 3.0 * k as f32 * step);
                [[c, 0.0, s, at], [0.1 * s, 1.0, 0.3, -at], [-s, 0.0, c, 0.3 * at]]
            })
            .collect();
        let found = Transforms::bounds(own, &transforms);
        let (low, high) =
            super::instances::expanded(std::slice::from_ref(&body), &[0; 9], &transforms).bounds().expect("vertices");
        for k in 0..3 {
            let [a, b] = [found[0][k], found[1][k]].map(f64::from);
            let slack = 2e-6 * (low[k].abs().max(high[k].abs()) + 3.0);
            assert!(a <= low[k] && b >= high[k] && a >= low[k] - slack && b <= high[k] + slack, "{a} {b} {low} {high}");
        }
        let meshes = [of(&body)];
        let casters = Casters::Instanced { meshes: &meshes, instances: &[0; 9] };
        let mut pass = made(&PassConfig::new(settings(FacetMode::One), casters));
        let buffer = super::instances::uploaded(&transforms, 0);
        let camera = super::instances::camera();
        let light = Light::Directional { direction: [0.5, 1.0, 0.2] };
        let mut outside = |bounds| {
            let transforms = Transforms { buffer: &buffer, offset: 0 };
            let placed = Some(subpixel_shadows::pass::Placed { transforms, bounds });
            frame(&mut pass, &Inputs { placed, ..Inputs::new(&camera, &light) }).1.faults.outside
        };
        assert_eq!(outside(found), 0, "{step}");
        let narrower = [found[0], found[1].map(|c| c - 2e-3 * c.abs().max(1.0))];
        assert!(outside(narrower) > 0, "{step}: a narrower box is told of");
    }
    assert_eq!(Transforms::bounds(own, &[]), [[0.0; 3]; 2]);
}
