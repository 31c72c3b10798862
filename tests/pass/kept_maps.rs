//! Light maps that stand from frame to frame: every picture is that of a fresh frame, and none uses maps that are not there.

use super::*;

/// The same camera, elsewhere: its place and aim times `factor`, turned by `angle` about the vertical.
pub(crate) fn elsewhere(camera: &Camera, factor: f32, angle: f32) -> Camera {
    let (sin, cos) = angle.sin_cos();
    let [x, y, z] = camera.eye.map(|c| c * factor);
    Camera { eye: [x * cos - z * sin, y, x * sin + z * cos], far: camera.far * factor.max(1.0), ..*camera }
}

/// The words that maps cannot change: visibility, and with every surface the lit masks. With one facet a pixel that is settled as lit counts the samples
/// beside its facet, too.
pub(crate) fn certain(facets: FacetMode, picture: &Picture) -> Picture {
    match facets {
        FacetMode::One => Picture(picture.0[..(SIZE[0] * SIZE[1]) as usize].to_vec()),
        FacetMode::All => picture.clone(),
    }
}

fn assert_is(what: &str, pass: &ShadowPass, scene: &Scene, inputs: &Inputs, got: &Picture) {
    let settings = pass.settings();
    let want = picture(&rendered(&scene.mesh, inputs.camera, inputs.light, settings).0);
    let certain = |p: &Picture| certain(settings.facets, p);
    let (got, want) = (certain(got), certain(&want));
    assert_eq!(got.0.len(), want.0.len(), "{what}");
    let wrong = got.0.iter().zip(&want.0).filter(|(g, w)| g != w).count();
    assert_eq!(wrong, 0, "{what}: {wrong} of {} words differ", want.0.len());
    // The comparison must notice one bit, and the picture must hold light and shadow.
    let mut corrupted = got.clone();
    corrupted.0[want.0.len() / 3] ^= 1;
    assert!(corrupted != want, "{what}: a corrupted picture passes");
    assert!(want.0.iter().any(|&v| v == 1.0f32.to_bits()) && want.0.contains(&0), "{what}: nothing to see");
}

fn pass_of(settings: Settings, scene: &Scene, change: impl Fn(&mut PassConfig)) -> ShadowPass {
    let mut config = PassConfig::new(settings, casters(&scene.mesh));
    change(&mut config);
    ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
}

#[gpu_test]
fn a_moving_camera_keeps_the_light_maps() {
    let [whole, held, thirds, halves] =
        [(FacetMode::All, 1, false), (FacetMode::One, 1, true), (FacetMode::All, 3, false), (FacetMode::One, 2, false)];
    for (name, position, ways) in [
        ("windmill", None, [whole, halves]),
        ("spheres", Some([6.0, 9.0, 4.0]), [held, thirds]),
        ("cage", Some([2.0, 9.0, 1.0]), [whole, held]),
    ] {
        let scene = scene(name);
        let light = position.map_or(scene.light, |position| Light::Point { position });
        for (facets, strips, keep_last) in ways {
            let what = format!("{name}, {facets:?}, {strips} strips");
            let [mut pass, mut never] = [true, false].map(|keeps| {
                pass_of(settings(facets), &scene, |config| {
                    (config.strips, config.keep_last, config.keep_maps) = (strips, keep_last, keeps);
                })
            });
            let inputs = Inputs::new(&scene.camera, &light);
            let first = frame(&mut pass, &inputs).1;
            assert!(!first.maps_kept, "{what}: {first:?}");
            complete(&mut pass, &inputs);
            let mut pictures = Vec::new();
            for (k, (factor, angle)) in [(1.0, 0.0), (1.0, 0.4), (0.7, -0.8), (3.0, 2.5)].iter().enumerate() {
                let camera = elsewhere(&scene.camera, *factor, *angle);
                let inputs = Inputs::new(&camera, &light);
                let (got, status) = complete(&mut pass, &inputs);
                assert_is(&format!("{what}, camera {k}"), &pass, &scene, &inputs, &got);
                let (again, kept) = complete(&mut pass, &inputs);
                assert!(kept.maps_kept, "{what}, camera {k}: {kept:?}");
                if k == 0 {
                    complete(&mut never, &inputs);
                    let all = complete(&mut never, &inputs).1.dispatches;
                    assert!(kept.dispatches + 10 < all, "{what}: {} of {all} dispatches", kept.dispatches);
                }
                assert_eq!(certain(facets, &again), certain(facets, &got), "{what}, camera {k}");
                // Every frame that uses the maps says their counts.
                let of_maps = |c: &Counts| (c.silhouette_edges, c.silhouette_pixels);
                assert_eq!(of_maps(&kept.counts), of_maps(&status.counts), "{what}, camera {k}");
                assert!(kept.counts.silhouette_edges > 0 && kept.counts.silhouette_pixels > 0, "{what}: {kept:?}");
                pictures.push(got);
            }
            assert!(pictures.windows(2).all(|two| two[0] != two[1]), "{what}: a camera that sees the same");
        }
    }
}

#[gpu_test]
fn another_light_another_size_and_other_casters_make_maps_anew() {
    let (scene, other) = (scene("spheres"), scene("windmill"));
    // Two of a kind, too: their views differ in nothing but where they look.
    let lights = [
        Light::Directional { direction: [0.35, 1.0, 0.2] },
        Light::Point { position: [6.0, 9.0, 4.0] },
        Light::Directional { direction: [0.2, 1.0, 0.35] },
    ];
    for facets in [FacetMode::One, FacetMode::All] {
        let mut pass = pass_of(settings(facets), &scene, |_| {});
        let mut kept = Vec::new();
        for k in [0, 0, 1, 1, 2, 0, 0, 0] {
            let inputs = Inputs::new(&scene.camera, &lights[k]);
            let mut outcome = frame(&mut pass, &inputs);
            kept.push(outcome.1.maps_kept);
            if !outcome.1.complete {
                outcome = complete(&mut pass, &inputs);
            }
            assert_is(&format!("{facets:?}, light {k}"), &pass, &scene, &inputs, &outcome.0);
        }
        assert_eq!(kept[2..], [false, true, false, false, true, true], "{facets:?}");
        let inputs = Inputs::new(&scene.camera, &lights[0]);
        pass.set_size([SIZE[0], SIZE[1] - 1]).expect("another size");
        pass.set_size(SIZE).expect("the size before");
        let (got, status) = complete(&mut pass, &inputs);
        assert!(!status.maps_kept || status.frame > 10, "{status:?}");
        assert_is(&format!("{facets:?}, after other sizes"), &pass, &scene, &inputs, &got);
        pass.set_casters(&casters(&other.mesh)).expect("other casters");
        assert!(!frame(&mut pass, &inputs).1.maps_kept, "maps of other casters");
        let (got, _) = complete(&mut pass, &inputs);
        assert_is(&format!("{facets:?}, other casters"), &pass, &other, &inputs, &got);
        let mut never = pass_of(settings(facets), &scene, |config| config.keep_maps = false);
        let dispatches = [0; 3].map(|_| complete(&mut never, &inputs).1).map(|s| (s.maps_kept, s.dispatches));
        assert!(dispatches.iter().all(|d| *d == (false, dispatches[0].1)), "{facets:?}: {dispatches:?}");
    }
}

/// Views that follow one another in the same memory.
#[gpu_test]
fn a_light_that_goes_in_among_casters_and_out_again() {
    let scene = scene("cage");
    let mut pass = pass_of(settings(FacetMode::All), &scene, |_| {});
    let (outside, among) = ([2.0, 9.0, 1.0], [0.5, 2.0, 0.8]);
    for (k, position) in [outside, outside, among, among, outside, outside, among, outside].into_iter().enumerate() {
        let light = Light::Point { position };
        let inputs = Inputs::new(&scene.camera, &light);
        let (got, status) = complete_within(6, &mut pass, &inputs);
        assert!(status.error.is_none() && !(status.maps_kept && position == among), "{k}: {status:?}");
        assert_is(&format!("frame {k}"), &pass, &scene, &inputs, &got);
    }
}

/// Frames that are recorded and run later, never, or in another order.
#[gpu_test]
fn no_frame_uses_maps_that_are_not_there() {
    let scene = scene("spheres");
    let lights = [[0.35, 1.0, 0.2], [0.2, 1.0, 0.35]].map(|direction| Light::Directional { direction });
    let inputs = lights.each_ref().map(|light| Inputs::new(&scene.camera, light));
    for keep_last in [false, true] {
        let mut pass = pass_of(settings(FacetMode::All), &scene, |config| config.keep_last = keep_last);
        for inputs in &inputs {
            complete(&mut pass, inputs);
            assert!(complete(&mut pass, inputs).1.maps_kept);
        }
        // Three frames of one encoder, the light there and back.
        let targets = [0; 3].map(|_| Targets::new());
        let mut encoder = gpu().encoder();
        for (k, targets) in [1, 0, 1].into_iter().zip(&targets) {
            pass.record(&mut encoder, &inputs[k], &targets.target()).expect("recorded");
        }
        gpu().submit_and_wait(encoder).expect("the frames run");
        for (k, targets) in [1, 0, 1].into_iter().zip(&targets) {
            assert!(status_of(&mut pass).complete);
            assert_is(&format!("frame of light {k}"), &pass, &scene, &inputs[k], &targets.read());
        }
        // An encoder that is dropped made none.
        complete(&mut pass, &inputs[1]);
        let mut dropped = gpu().encoder();
        pass.record(&mut dropped, &inputs[0], &Target::default()).expect("recorded");
        drop(dropped);
        for k in [0, 1] {
            let (got, status) = frame(&mut pass, &inputs[k]);
            assert!(status.complete && !status.maps_kept, "{status:?}");
            assert_is(&format!("light {k} after a dropped frame"), &pass, &scene, &inputs[k], &got);
        }
        // A frame that counts on maps in memory, and runs after one that puts others there.
        complete(&mut pass, &inputs[0]);
        let late = Targets::new();
        let mut encoders = [gpu().encoder(), gpu().encoder()];
        for (k, encoder) in encoders.iter_mut().enumerate() {
            pass.record(encoder, &inputs[k], &late.target()).expect("recorded");
        }
        let [first, second] = encoders;
        gpu().submit_and_wait(second).expect("the frame runs");
        gpu().submit_and_wait(first).expect("the frame runs");
        let statuses = [status_of(&mut pass), status_of(&mut pass)];
        let wrong = statuses.iter().find(|s| s.maps_kept).expect("a frame that counts on what is there");
        assert!(!wrong.complete && wrong.error.as_ref().is_some_and(|e| e.contains("light maps")), "{wrong:?}");
        let right = statuses.iter().find(|s| !s.maps_kept).expect("the other frame");
        assert!(right.complete, "{right:?}");
        if keep_last {
            assert_is("the last complete picture", &pass, &scene, &inputs[1], &late.read());
        }
        // A frame that is on its way for long, and puts other maps there before one that was recorded after it.
        complete(&mut pass, &inputs[0]);
        let [between, after] = [Targets::new(), Targets::new()];
        let (mut waiting, mut encoder) = (gpu().encoder(), gpu().encoder());
        pass.record(&mut waiting, &inputs[1], &Target::default()).expect("recorded");
        pass.record(&mut encoder, &inputs[0], &between.target()).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        let mut encoder = gpu().encoder();
        pass.record(&mut encoder, &inputs[0], &after.target()).expect("recorded");
        gpu().submit_and_wait(waiting).expect("the frame runs");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        for _ in 0..3 {
            let status = status_of(&mut pass);
            assert!(status.complete, "{status:?}");
        }
        assert_is("before a frame that waits", &pass, &scene, &inputs[0], &between.read());
        assert_is("after a frame that waited", &pass, &scene, &inputs[0], &after.read());
        for k in [0, 1, 0] {
            let (got, status) = complete(&mut pass, &inputs[k]);
            assert!(status.error.is_none(), "{status:?}");
            assert_is(&format!("light {k} after frames out of order"), &pass, &scene, &inputs[k], &got);
        }
    }
}

/// From afar vertices are rounded more, and so are maps made of them.
#[gpu_test]
fn maps_made_from_afar_do_not_serve_a_near_camera() {
    let scene = scene("spheres");
    let mut pass = pass_of(settings(FacetMode::All), &scene, |_| {});
    let far = elsewhere(&scene.camera, 60.0, 0.0);
    let far = Camera { vertical_fov_degrees: far.vertical_fov_degrees / 60.0, ..far };
    let mut kept = Vec::new();
    for camera in [&far, &far, &scene.camera, &scene.camera, &far, &far, &scene.camera] {
        let inputs = Inputs::new(camera, &scene.light);
        let (got, _) = complete(&mut pass, &inputs);
        assert_is("a camera", &pass, &scene, &inputs, &got);
        kept.push(frame(&mut pass, &inputs).1.maps_kept);
    }
    assert!(kept[3..].iter().all(|k| *k), "{kept:?}");
}

/// Casters that move have maps of their own every frame.
#[gpu_test]
fn casters_that_move_keep_none() {
    let (settings, scene) = (settings(FacetMode::One), scene("windmill"));
    let moving = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let mut pass = pass(settings, moving);
    let buffer = vertex_buffer(&scene.mesh.positions);
    let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
    let moved = Some(Moved { vertices, bounds: bounds(&scene.mesh) });
    for _ in 0..4 {
        let inputs = Inputs { moved, ..Inputs::new(&scene.camera, &scene.light) };
        assert!(!complete(&mut pass, &inputs).1.maps_kept);
    }
}
