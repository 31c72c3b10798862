//! The pass says of no frame that it is complete that is not, whatever becomes of it; and what it cannot do it refuses.

#[path = "shared/frames.rs"]
mod frames;

use frames::status_of;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::gpu::program::made_here;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::facet_masks::Pipelines;
use subpixel_shadows::methods::render::{Budget, Renderer};
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{Casters, FrameStatus, Inputs, PassConfig, Target};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Light, Scene, builtin};
use subpixel_shadows::{Error, ShadowPass, wgpu};

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

fn settings(facets: FacetMode, size: [u32; 2]) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, 32).expect("32 samples");
    Settings { facets, ..Settings::new(size, 64, samples) }
}

fn casters(scene: &Scene) -> Casters<'_> {
    Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles }
}

fn pass_on(gpu: &Gpu, config: &PassConfig) -> ShadowPass {
    ShadowPass::new(&gpu.device, &gpu.queue, config).expect("a pass")
}

/// Commands that the device refuses, because of what the application recorded beside the frame, run nothing. The counters of
/// such a frame are zeros, or those of the frame that used their buffer before.
#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn refused_commands_are_no_frame() {
    // Of its own: other tests ask theirs for errors.
    let gpu = Gpu::open(None).expect("a GPU");
    let scene = scene("plane");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for (facets, strips) in [(FacetMode::One, 1), (FacetMode::All, 1), (FacetMode::All, 2)] {
        let config = PassConfig { strips, ..PassConfig::new(settings(facets, [48, 36]), casters(&scene)) };
        let mut pass = pass_on(&gpu, &config);
        let mut run = |refuse: bool| {
            let mut encoder = gpu.encoder();
            let number = pass.record(&mut encoder, &inputs, &Target::default()).expect("recorded");
            let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
            if refuse {
                let descriptor = wgpu::BufferDescriptor {
                    label: Some("test"),
                    size: 16,
                    usage: wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                };
                let [from, to] = [(); 2].map(|()| gpu.device.create_buffer(&descriptor));
                encoder.copy_buffer_to_buffer(&from, 0, &to, 0, 16);
            }
            gpu.queue.submit([encoder.finish()]);
            let error = futures::executor::block_on(scope.pop());
            assert_eq!(error.is_some(), refuse, "{error:?}");
            gpu.wait(None).expect("the device works");
            let status = status_of(&mut pass);
            assert_eq!(status.frame, number);
            status
        };
        // Before any frame has run, and with the counters of one that was complete left over.
        for _ in 0..2 {
            let status = run(true);
            assert!(!status.complete && !status.overflowed, "{facets:?}: {status:?}");
            assert!(status.error.as_ref().is_some_and(|e| e.contains("did not run to its end")), "{status:?}");
            assert!(status.error.is_some_and(|e| e.contains(&format!("frame {}", status.frame))));
            assert_eq!(status.counts, Default::default(), "counters of another frame");
            let complete = (0..4).map(|_| run(false)).find(|status| status.complete);
            assert!(complete.is_some_and(|status| status.error.is_none()), "{facets:?}");
        }
    }
}

/// One frame, and how it came out.
fn frame(gpu: &Gpu, pass: &mut ShadowPass, inputs: &Inputs, target: &Target) -> FrameStatus {
    let mut encoder = gpu.encoder();
    pass.record(&mut encoder, inputs, target).expect("recorded");
    gpu.submit_and_wait(encoder).expect("the frame runs");
    status_of(pass)
}

/// Whatever becomes of a pass, its pipelines are those it was made with: another size, casters that have surfaces to merge and that have
/// none, casters that move, lists that grow from one element, more strips, more views of the light.
#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn pipelines_are_made_once() {
    let gpu = Gpu::open(None).expect("a GPU");
    let mut scenes = ["windmill", "plant", "spheres"].map(scene);
    scenes[1].mesh.triangles = scenes[1].mesh.triangles.iter().copied().step_by(7).collect();
    let merges = |scene: &Scene| Prepared::new(&scene.mesh).expect("a sound mesh").merges();
    assert!(scenes.iter().any(merges) && !scenes.iter().all(merges), "surfaces to merge in some, and none in others");
    for facets in [FacetMode::One, FacetMode::All] {
        for (strips, receivers) in [(1, false), (2, facets == FacetMode::One)] {
            let budget = Budget { start: Some(1), ..Budget::default() };
            let config = PassConfig::new(settings(facets, [40, 30]), casters(&scenes[0]));
            let config = PassConfig { strips, receivers, budget, ..config };
            let before = made_here();
            let mut pass = pass_on(&gpu, &config);
            let made = made_here();
            assert!(made > before + 30, "{} pipelines: nothing is counted", made - before);
            let complete = |pass: &mut ShadowPass, scene: &Scene, light: &Light| {
                let inputs = Inputs::new(&scene.camera, light);
                (0..9).any(|_| frame(&gpu, pass, &inputs, &Target::default()).complete)
            };
            assert!(complete(&mut pass, &scenes[0], &scenes[0].light));
            for scene in &scenes[1..] {
                pass.set_casters(&casters(scene)).expect("other casters");
                assert!(complete(&mut pass, scene, &scene.light));
            }
            for size in [[1, 1], [64, 48], [17, 99]] {
                pass.set_size(size).expect("another size");
                let scene = &scenes[2];
                assert!(complete(&mut pass, scene, &scene.light), "{size:?}");
                assert!(complete(&mut pass, scene, &Light::Point { position: [0.8, 1.9, 0.9] }), "{size:?}");
            }
            assert!(pass.capacities().views > 1);
            let mesh = &scenes[1].mesh;
            pass.set_casters(&Casters::Moving { rest: &mesh.positions, triangles: &mesh.triangles }).expect("moving");
            assert_eq!(made_here() - made, 0, "{facets:?}, {strips} strips: pipelines made after the pass was");
        }
    }
}

/// Pipelines of another number of samples are no others with a word alike: what is beyond their samples is not in them.
#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn pipelines_of_other_samples_are_refused() {
    let gpu = Gpu::open(None).expect("a GPU");
    let of = |count: u32| {
        let samples = Samples::new(Pattern::LowDiscrepancy, count).expect("samples");
        Settings { facets: FacetMode::One, ..Settings::new([16, 16], 32, samples) }
    };
    let pipelines = std::sync::Arc::new(Pipelines::new(&gpu.device, &of(8)));
    let prepared = Prepared::new(&scene("plane").mesh).expect("a sound mesh");
    for (count, serve) in [(8, true), (1, false), (16, false), (32, false), (64, false)] {
        assert_eq!(pipelines.serve(&of(count)), serve, "{count} samples");
        let made = Renderer::with_pipelines(&gpu, &prepared, &of(count), Budget::default(), pipelines.clone());
        assert!(made.map_or_else(|e| matches!(e, Error::Config(_)) && !serve, |_| serve), "{count} samples");
    }
}
