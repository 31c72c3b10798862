//! Lists that overflow and grow.

use super::*;

#[gpu_test]
fn an_overflow_is_said_and_the_next_frame_is_whole() {
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = settings(facets);
        let scene = scene("windmill");
        let inputs = Inputs::new(&scene.camera, &scene.light);
        let (want, _) = rendered(&scene.mesh, &scene.camera, &scene.light, &settings);
        let most = want.lists.iter().map(|l| l.needed).max().expect("lists") as usize;
        // Three quarters of the longest list: one frame short, the next whole.
        let budget = Budget { start: Some(most * 3 / 4), ..Budget::default() };
        let config = PassConfig { budget, ..PassConfig::new(settings, casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let (short, status) = frame(&mut pass, &inputs);
        assert!(status.overflowed && !status.complete, "{facets:?}: {status:?}");
        assert!(status.lists.iter().any(|l| l.needed > l.capacity), "{facets:?}: {:?}", status.lists);
        assert!(short != picture(&want), "{facets:?}: nothing was missing");
        let (got, status) = frame(&mut pass, &inputs);
        assert!(status.complete, "{facets:?}: {status:?}");
        assert_same(&format!("{facets:?}"), &got, &picture(&want));
    }
}

/// From lists of one element: each frame says of itself whether it was whole, and by the first that was the lists have grown
/// a few times only. Without growth of their own they stay as they are until they are told.
/// A frame in which less is seen than in the one before looks at nothing that is left of that: it counts what a frame of a fresh pass
/// does, and draws the same.
#[gpu_test]
fn a_frame_after_a_fuller_one_counts_as_the_first() {
    let scene = scene("windmill");
    let far = Camera { eye: scene.camera.eye.map(|x| 4.0 * x), far: 4.0 * scene.camera.far, ..scene.camera };
    for facets in [FacetMode::One, FacetMode::All] {
        // Those made from another camera may mark other texels.
        let fresh_pass = || {
            let config = PassConfig { keep_maps: false, ..PassConfig::new(settings(facets), casters(&scene.mesh)) };
            ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
        };
        let fresh = complete(&mut fresh_pass(), &Inputs::new(&far, &scene.light));
        let mut used = fresh_pass();
        let (_, fuller) = complete(&mut used, &Inputs::new(&scene.camera, &scene.light));
        let (got, status) = complete(&mut used, &Inputs::new(&far, &scene.light));
        assert_same(&format!("{facets:?}"), &got, &fresh.0);
        // How many candidates are tested and evaluated depends on who comes first.
        let certain =
            |c: &Counts| Counts { candidate_tests: 0, visibility_evaluations: 0, refined_evaluations: 0, ..*c };
        assert_eq!(certain(&status.counts), certain(&fresh.1.counts), "{facets:?}");
        assert!(fuller.counts.pixel_texel_pairs > 2 * status.counts.pixel_texel_pairs, "{facets:?}: no fuller");
    }
}

/// An application that never asks how its frames came out does not gather them.
#[gpu_test]
fn frames_nobody_asks_about_are_let_go() {
    let scene = scene("plane");
    for grow in [false, true] {
        let config = PassConfig { grow, ..PassConfig::new(settings(FacetMode::One), casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        for k in 1..=ShadowPass::KEPT as u64 + 8 {
            let mut encoder = gpu().encoder();
            let number = pass.record(&mut encoder, &Inputs::new(&scene.camera, &scene.light), &Target::default());
            assert_eq!(number.expect("recorded"), k);
            gpu().submit_and_wait(encoder).expect("the frame runs");
            // The poll of another test may be late to tell.
            assert!(pass.frames_in_flight() <= 8, "{grow}: {} after {k} frames", pass.frames_in_flight());
        }
        for _ in 0..5000 {
            // Takes in what is known.
            pass.grow().expect("memory");
            if pass.frames_in_flight() == 0 {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        assert_eq!(status_of(&mut pass).frame, 9, "the oldest that is kept");
    }
}

#[gpu_test]
fn lists_grow_from_one_element() {
    let scene = scene("spheres");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = settings(facets);
        let (want, _) = rendered(&scene.mesh, &scene.camera, &scene.light, &settings);
        let budget = Budget { start: Some(1), ..Budget::default() };
        let config = PassConfig { budget, grow: false, ..PassConfig::new(settings, casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let before = pass.capacities();
        assert!(frame(&mut pass, &inputs).1.overflowed && frame(&mut pass, &inputs).1.overflowed);
        assert_eq!(pass.capacities(), before, "{facets:?}: lists grew by themselves");
        let mut frames = 0;
        loop {
            assert!(pass.grow().expect("memory"), "{facets:?}: nothing to grow after an overflow");
            let (got, status) = frame(&mut pass, &inputs);
            frames += 1;
            assert_eq!(status.complete, !status.overflowed, "{facets:?}: {status:?}");
            if status.complete {
                assert_same(&format!("{facets:?}"), &got, &picture(&want));
                // Lists that are nearly full grow once more, others do not.
                let full = status.lists.iter().any(|l| 8 * l.needed > 7 * l.capacity);
                assert_eq!(pass.grow().expect("memory"), full, "{facets:?}: {:?}", status.lists);
                break;
            }
            assert!(frames < 6, "{facets:?}: {:?}", status.lists);
        }
        assert!(frame(&mut pass, &inputs).1.complete);
        assert!(!pass.grow().expect("memory"), "{facets:?}: grew without need");
    }
}

/// Frames of other lights and cameras that take turns, two in flight, come to lists that hold them all: with other numbers of views,
/// and where the lists may not grow as they like.
#[gpu_test]
fn frames_in_turns_come_to_lists_for_all() {
    let (settings, scene) = (settings(FacetMode::All), scene("cage"));
    let far = Camera { eye: scene.camera.eye.map(|x| 1.7 * x), far: 4.0 * scene.camera.far, ..scene.camera };
    let lights = [[2.0, 9.0, 1.0], [0.5, 2.0, 0.8]].map(|position| Light::Point { position });
    let turns = [(scene.camera, lights[0]), (far, lights[1])];
    let want = turns.map(|(camera, light)| picture(&rendered(&scene.mesh, &camera, &light, &settings).0));
    for bytes in [1 << 30, 1_000_000] {
        let budget = Budget { start: Some(16), bytes };
        let config = PassConfig { budget, ..PassConfig::new(settings.clone(), casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let mut complete = 0;
        for pair in 0.. {
            assert!(pair < 24, "{bytes}: {:?}", pass.capacities());
            let which = [2 * pair, 2 * pair + 1].map(|k| k % turns.len());
            let targets = [Targets::new(), Targets::new()];
            let mut encoder = gpu().encoder();
            for (&k, targets) in which.iter().zip(&targets) {
                let inputs = Inputs::new(&turns[k].0, &turns[k].1);
                pass.record(&mut encoder, &inputs, &targets.target()).expect("recorded");
            }
            gpu().submit_and_wait(encoder).expect("the frames run");
            for (&k, targets) in which.iter().zip(&targets) {
                let status = status_of(&mut pass);
                assert_eq!(status.complete, !status.overflowed, "{status:?}");
                if status.complete {
                    assert_same(&format!("{bytes} bytes, frame {k}"), &targets.read(), &want[k]);
                }
                complete = if status.complete { complete + 1 } else { 0 };
            }
            if complete >= 2 * turns.len() {
                break;
            }
        }
        assert_eq!(pass.capacities().bands > 1, bytes < 1 << 30, "{bytes}: {:?}", pass.capacities());
    }
}

/// A frame like the one before makes no bind group; lists of another length, and another size, make them anew.
#[gpu_test]
fn bind_groups_are_made_once() {
    let scene = scene("windmill");
    for facets in [FacetMode::One, FacetMode::All] {
        let mut pass = pass(settings(facets), casters(&scene.mesh));
        let made = |pass: &mut ShadowPass| {
            let before = bind_groups_here();
            let mut encoder = gpu().encoder();
            pass.record(&mut encoder, &Inputs::new(&scene.camera, &scene.light), &Target::default()).expect("a frame");
            gpu().submit_and_wait(encoder).expect("it runs");
            status_of(pass);
            bind_groups_here() - before
        };
        let first = made(&mut pass);
        while made(&mut pass) > 0 {}
        assert!(first > 10 && made(&mut pass) == 0, "{facets:?}: {first}");
        pass.set_size([40, 30]).expect("another size");
        assert!(made(&mut pass) > 10, "{facets:?}: those of other memory");
    }
}
