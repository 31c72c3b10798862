//! Several lights of one frame: what the camera sees is found once, and each picture is that of a frame of its own.

use super::*;

/// Frames of all lights from one encoder, each complete, with their targets' pictures.
fn complete_lights(pass: &mut ShadowPass, inputs: &Inputs, lights: &[Light]) -> Vec<(Picture, FrameStatus)> {
    for _ in 0..5 {
        let targets: Vec<Targets> = lights.iter().map(|_| Targets::new()).collect();
        let asked = lights.iter().zip(&targets).map(|(light, to)| LightTarget::new(*light, to.target()));
        let asked: Vec<LightTarget> = asked.collect();
        let mut encoder = gpu().encoder();
        let numbers = pass.record_lights(&mut encoder, inputs, &asked).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        gpu().check().expect("no error of the device");
        let statuses: Vec<FrameStatus> = numbers.iter().map(|_| status_of(pass)).collect();
        assert!(statuses.iter().map(|status| status.frame).eq(numbers), "a status each, in their order");
        if statuses.iter().all(|status| status.complete || !status.overflowed) {
            return targets.iter().map(Targets::read).zip(statuses).collect();
        }
        // Lists of what the camera sees are those of all of them.
        let counted = |s: &FrameStatus| s.counts.complex_pixels;
        assert!(statuses.iter().all(|status| counted(status) == counted(&statuses[0])), "{statuses:?}");
    }
    panic!("no complete frames by the fifth");
}

fn directions() -> Vec<Light> {
    let all = [[0.5, 1.0, 0.3], [-0.6, 1.0, 0.1], [0.1, 1.0, -0.8]];
    all.map(|direction| Light::Directional { direction }).to_vec()
}

fn runs(status: &FrameStatus, names: &[&str]) -> bool {
    status.stages.iter().any(|stage| names.contains(&stage.name))
}

const OF_THE_CAMERA: [&str; 4] = ["camera_visibility", "pixel_triangles", "pixel_coverage", "sample_surfaces"];

#[gpu_test]
fn lights_share_what_the_camera_sees() {
    let all = [(1, None), (1, Some(1)), (2, None)];
    for (name, among, ways) in [("spheres", [0.8, 1.9, 0.9], &all[..]), ("plant", [0.3, 1.3, 0.2], &all[..1])] {
        let scene = scene(name);
        // A cube of views between lights of one view each.
        let mut lights = directions();
        lights.insert(1, Light::Point { position: among });
        for facets in [FacetMode::All, FacetMode::One] {
            let settings = settings(facets);
            for &(strips, start) in ways {
                let what = format!("{name}, {facets:?}, {strips} strips, lists from {start:?}");
                let budget = Budget { start, ..Budget::default() };
                let config = PassConfig {
                    strips,
                    budget,
                    timing: true,
                    ..PassConfig::new(settings.clone(), casters(&scene.mesh))
                };
                let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
                let inputs = Inputs::new(&scene.camera, &scene.light);
                for round in 0..ways.len().min(2) {
                    let got = complete_lights(&mut pass, &inputs, &lights);
                    for (k, ((got, status), light)) in got.iter().zip(&lights).enumerate() {
                        let want = picture(&rendered(&scene.mesh, &scene.camera, light, &settings).0);
                        assert_same(&format!("{what}, light {k} of round {round}"), got, &want);
                        let finds = strips > 1 || k == 0;
                        assert_eq!(runs(status, &OF_THE_CAMERA), finds, "{what}, light {k}: {:?}", status.stages);
                    }
                    // A frame of one light between finds it again and keeps it for nobody.
                    let alone = complete(&mut pass, &Inputs { light: &lights[2], ..inputs });
                    assert_same(&format!("{what}, alone"), &alone.0, &got[2].0);
                    assert!(runs(&alone.1, &OF_THE_CAMERA));
                    lights.rotate_left(1);
                }
            }
        }
    }
}

/// A light that leaves all dark, for which nothing is tested, before and behind one that casts.
#[gpu_test]
fn lights_that_need_less_share_it_too() {
    let scene = scene("plane");
    let settings = settings(FacetMode::All);
    let above = scene.light;
    let below = Light::Directional { direction: [0.2, -1.0, 0.1] };
    let mut pass = pass(settings.clone(), casters(&scene.mesh));
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for lights in [[below, above], [above, below]] {
        let got = complete_lights(&mut pass, &inputs, &lights);
        for ((got, _), light) in got.iter().zip(&lights) {
            let want = picture(&rendered(&scene.mesh, &scene.camera, light, &settings).0);
            assert!(*got == want, "{light:?}");
        }
        assert!(got[0].0 != got[1].0, "both lights are alike");
    }
}

/// With a G-buffer, and with casters that move: they are gathered once, and what is wrong with them is said of each light.
#[gpu_test]
fn inputs_are_taken_once() {
    let settings = settings(FacetMode::One);
    let (scene, lights) = (scene("spheres"), directions());
    let (seen, prepared) = rendered(&scene.mesh, &scene.camera, &scene.light, &settings);
    let mut ids: Vec<u32> =
        seen.triangles.iter().map(|&t| prepared.given.get(t as usize).copied().unwrap_or(u32::MAX)).collect();
    let ids_given = id_texture(&ids);
    let buffer = vertex_buffer(&scene.mesh.positions);
    let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
    let moved = Some(Moved { vertices, bounds: bounds(&scene.mesh) });
    let moving = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let plain = Inputs::new(&scene.camera, &scene.light);
    let numbers = GBuffer::TriangleIds(TriangleTexture::new(&ids_given));
    for (what, casters, inputs) in [
        ("numbers", casters(&scene.mesh), Inputs { gbuffer: numbers, ..plain }),
        ("moving", moving, Inputs { moved, ..plain }),
    ] {
        let config = PassConfig { timing: true, ..PassConfig::new(settings.clone(), casters) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let got = complete_lights(&mut pass, &inputs, &lights);
        for (k, ((got, status), light)) in got.iter().zip(&lights).enumerate() {
            let want = complete(&mut pass, &Inputs { light, ..inputs });
            assert_same(&format!("{what}, light {k}"), got, &want.0);
            assert_eq!(
                runs(status, &["triangle_ids", "caster_positions", "camera_visibility"]),
                k == 0,
                "{what}, light {k}"
            );
        }
    }
    ids[17] = 7_000_000;
    let wrong = id_texture(&ids);
    let inputs = Inputs { gbuffer: GBuffer::TriangleIds(TriangleTexture::new(&wrong)), ..plain };
    let mut pass = pass(settings, casters(&scene.mesh));
    let got = complete_lights(&mut pass, &inputs, &lights);
    assert!(got.iter().all(|(_, status)| status.faults.unknown_triangles == 1 && !status.complete));
}

#[gpu_test]
fn bad_lights_are_refused() {
    let scene = scene("plane");
    let plain = Inputs::new(&scene.camera, &scene.light);
    let none = Light::Directional { direction: [0.0; 3] };
    let narrow = texture([5, 5], TextureFormat::R32Float, TextureUsages::STORAGE_BINDING);
    let config = PassConfig { keep_last: true, ..PassConfig::new(settings(FacetMode::All), casters(&scene.mesh)) };
    let mut holding = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let mut pass = pass(settings(FacetMode::All), casters(&scene.mesh));
    let mut encoder = gpu().encoder();
    let good = LightTarget::new(scene.light, Target::default());
    for (what, result) in [
        ("length 0", pass.record_lights(&mut encoder, &plain, &[good, LightTarget { light: none, ..good }])),
        (
            "5x5",
            pass.record_lights(&mut encoder, &plain, &[good, LightTarget { target: Target::texture(&narrow), ..good }]),
        ),
        ("keeps the last picture", holding.record_lights(&mut encoder, &plain, &[good, good])),
    ] {
        assert!(result.as_ref().is_err_and(|e| e.to_string().contains(what)), "{what}: {result:?}");
    }
    assert_eq!((pass.frames_in_flight(), holding.frames_in_flight()), (0, 0), "nothing is recorded");
    assert_eq!(pass.record_lights(&mut encoder, &plain, &[]).expect("no frames"), Vec::<u64>::new());
    assert_eq!(holding.record_lights(&mut encoder, &plain, &[good]).expect("one light").len(), 1);
}
