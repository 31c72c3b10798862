//! Memory that is refused, and devices that are lost: a clear error, and then the right picture.

use lab::scene::{Scene, builtin};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::gpu::faults::Refusal;
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::pass::{Casters, Inputs, PassConfig, Target};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, ShadowPass, wgpu};
use test_support::gpu_test;
use test_support::refused::{self, Told};
use test_support::status_of;

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

/// Of the smallest scene many requests, with both ways to refuse and both facet modes; of five others some of a renderer's.
/// `cargo run --release --example refused_memory` refuses each of all scenes.
#[gpu_test]
fn a_refused_request_is_an_error_and_no_more() {
    let gpu = Gpu::open(None).expect("a GPU");
    let mut all = [0, 0];
    let mut take = |name: &str, facets, refusal, told: Result<Told, Error>| {
        let told = told.unwrap_or_else(|e| panic!("{name}, {facets:?}, {refusal:?}: {e}"));
        assert!(told.asked > 60, "{name}, {facets:?}: {} requests: not all are counted", told.asked);
        // What the device refuses is always said, unless it was for lists that suffice as they are.
        let silent = told.absorbed > 1 + told.refused / 8;
        assert!(refusal == Refusal::Limit || !silent, "{name}, {facets:?}: {told:?}");
        all = [all[0] + told.refused, all[1] + told.absorbed];
    };
    let plane = scene("plane");
    for facets in [FacetMode::One, FacetMode::All] {
        for (refusal, step) in [(Refusal::Device, 17), (Refusal::Limit, 43)] {
            take("plane", facets, refusal, refused::renderer(&gpu, &plane, facets, 1, step, refusal));
            take("plane", facets, refusal, refused::pass(&gpu, &plane, facets, 2, step, refusal));
        }
    }
    for (k, name) in (0..).zip(["spheres", "plant", "bicycle", "windmill", "knot"]) {
        let (facets, refusal) = (FacetMode::All, Refusal::Device);
        take(name, facets, refusal, refused::renderer(&gpu, &scene(name), facets, 7 + 9 * k, 83, refusal));
    }
    assert!(all[0] > 60 && all[1] < all[0], "{all:?}");
}

/// Some of the requests of a pass as it is made, with pipelines of its own.
#[gpu_test]
fn a_pass_that_cannot_be_made_is_an_error() {
    let gpu = Gpu::open(None).expect("a GPU");
    for (facets, first, step) in [(FacetMode::One, 3, 41), (FacetMode::All, 5, 47)] {
        let told =
            refused::new_pass(&gpu, &scene("plane"), facets, first, step, Refusal::Device).expect("one error each");
        assert!(told.refused >= 2 && told.absorbed == 0, "{facets:?}: {told:?}");
    }
}

fn settings(facets: FacetMode, size: [u32; 2]) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, 32).expect("32 samples");
    Settings { facets, ..Settings::new(size, 64, samples) }
}

/// A device that is destroyed while a renderer waits for its frame: an error that says so, and no frame after it. A new renderer on a new
/// device gives the bits that the first frames had.
#[gpu_test]
fn a_renderer_whose_device_is_lost_says_so() {
    let scene = scene("windmill");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = settings(facets, [160, 120]);
        let gpu = Gpu::open(None).expect("a GPU");
        let mut renderer = Renderer::new(&gpu, &prepared, &settings, Budget::default()).expect("a renderer");
        let first = renderer.render(&scene.camera, &scene.light).expect("a frame");
        let device = gpu.device.clone();
        let destroyer = std::thread::spawn(move || {
            std::thread::sleep(std::time::Duration::from_millis(40));
            device.destroy();
        });
        let error = (0..2000).find_map(|_| renderer.render(&scene.camera, &scene.light).err());
        destroyer.join().expect("the device is destroyed");
        let text = error.expect("a lost device renders no frames").to_string();
        assert!(text.starts_with("gpu: ") && text.to_lowercase().contains("lost"), "{text}");
        let again = renderer.render(&scene.camera, &scene.light);
        assert!(again.as_ref().is_err_and(|e| matches!(e, Error::Gpu(_))), "{:?}", again.map(|o| o.counts));
        let gpu = Gpu::open(None).expect("another device");
        let mut renderer = Renderer::new(&gpu, &prepared, &settings, Budget::default()).expect("a renderer");
        let after = renderer.render(&scene.camera, &scene.light).expect("a frame");
        assert!(after.lit == first.lit && after.visibility == first.visibility, "{facets:?}: another picture");
    }
}

/// A device that is destroyed while frames of a pass are in flight, some recorded and not submitted: each frame that was submitted
/// has a status that says so, none is complete that is not, and a new pass on a new device gives the same bits.
#[gpu_test]
fn a_pass_whose_device_is_lost_says_so() {
    let scene = scene("windmill");
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for facets in [FacetMode::One, FacetMode::All] {
        let config = PassConfig::new(settings(facets, [160, 120]), casters);
        let whole = |gpu: &Gpu| {
            let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &config).expect("a pass");
            for _ in 0..4 {
                let mut encoder = gpu.encoder();
                pass.record(&mut encoder, &inputs, &Target::default()).expect("recorded");
                gpu.submit_and_wait(encoder).expect("the frame runs");
                if status_of(&mut pass).complete {
                    break;
                }
            }
            let words = refused::words(gpu, pass.visibility(), pass.lit()).expect("a picture");
            (pass, words)
        };
        let gpu = Gpu::open(None).expect("a GPU");
        let (mut pass, first) = whole(&gpu);
        let mut numbers = Vec::new();
        for _ in 0..3 {
            let mut encoder = gpu.encoder();
            numbers.push(pass.record(&mut encoder, &inputs, &Target::default()).expect("recorded"));
            gpu.queue.submit([encoder.finish()]);
        }
        gpu.device.destroy();
        // Submitted to a device that is gone already.
        let mut encoder = gpu.encoder();
        let late = pass.record(&mut encoder, &inputs, &Target::default());
        gpu.queue.submit([encoder.finish()]);
        let _ = gpu.device.poll(wgpu::PollType::Poll);
        let lost = gpu.wait(None).expect_err("the device is lost").to_string();
        assert!(lost.to_lowercase().contains("lost"), "{lost}");
        let said = |error: &str| error.contains("lost") && !error.contains('\n');
        // A frame that was done by then may well be complete; of one that was not it is said.
        for &number in &numbers {
            let status = status_of(&mut pass);
            assert_eq!(status.frame, number);
            assert!(status.complete != status.error.as_deref().is_some_and(said), "{status:?}");
        }
        match late {
            Ok(number) => {
                let status = status_of(&mut pass);
                assert!(status.frame == number && !status.complete, "{status:?}");
                assert!(status.error.as_deref().is_some_and(said), "{status:?}");
            }
            Err(error) => assert!(said(&error.to_string()), "{error}"),
        }
        assert!(pass.status().is_none());
        assert!(
            pass.set_size([40, 30])
                .and_then(|()| pass.record(&mut gpu.encoder(), &inputs, &Target::default()))
                .is_err()
        );
        let gpu = Gpu::open(None).expect("another device");
        assert!(whole(&gpu).1 == first, "{facets:?}: another picture");
    }
}
