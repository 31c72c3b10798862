//! The pass says of no frame that it is complete that is not, whatever becomes of it; and what it cannot do it refuses.

#[path = "shared/frames.rs"]
mod frames;

use frames::status_of;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{Casters, Inputs, PassConfig, Target};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Scene, builtin};
use subpixel_shadows::{ShadowPass, wgpu};

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
