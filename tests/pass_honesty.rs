//! The pass says of no frame that it is complete that is not, whatever becomes of it; and what it cannot do it refuses.

use lab::scene::{Scene, builtin};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::gpu::KeptPrograms;
use subpixel_shadows::gpu::program::made_here;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::methods::facet_masks::Pipelines;
use subpixel_shadows::methods::list_sizing::larger;
use subpixel_shadows::methods::{FacetMode, Settings};
use subpixel_shadows::pass::{Casters, FrameStatus, Inputs, PassConfig, Target};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light};
use subpixel_shadows::{Error, ShadowPass, wgpu};
use test_support::gpu_test;
use test_support::soak::{Row, soak};
use test_support::status_of;

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
#[gpu_test]
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
#[gpu_test]
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
            let kept = KeptPrograms::default();
            kept.within(|| pass_on(&gpu, &config));
            let before = made_here();
            let mut pass = KeptPrograms::default().within(|| pass_on(&gpu, &config));
            let made = made_here();
            assert!(made > before + 30, "{} pipelines: nothing is counted", made - before);
            assert_eq!(made - before, kept.len() as u64, "{facets:?}: a pipeline is made twice");
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
#[gpu_test]
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

/// A camera that goes round a scene, a step a frame: only the first frame may find its lists too short. Lists grow and never shrink,
/// a few times only.
#[gpu_test]
fn lists_grow_before_they_overflow() {
    let gpu = Gpu::open(None).expect("a GPU");
    let mut grown = 0;
    for name in ["windmill", "cage", "bicycle", "plant", "spheres", "knot", "city", "bumpy", "plane"] {
        let scene = scene(name);
        for facets in [FacetMode::One, FacetMode::All] {
            let mut pass = pass_on(&gpu, &PassConfig::new(settings(facets, [96, 72]), casters(&scene)));
            let mut before = pass.capacities();
            for k in 0..6 {
                let camera = turned(&scene, 0.06 * k as f32);
                let status = frame(&gpu, &mut pass, &Inputs::new(&camera, &scene.light), &Target::default());
                assert!(status.complete || k == 0, "{name}, {facets:?}, frame {}: {:?}", k + 1, status.lists);
                assert_eq!(status.complete, !status.overflowed, "{status:?}");
                let now = pass.capacities();
                assert_eq!(larger(before, now), now, "{name}, {facets:?}: a list has shrunk");
                grown += usize::from(now != before);
                before = now;
            }
        }
    }
    assert!((1..40).contains(&grown), "lists have grown {grown} times");
}

/// Words of a buffer.
fn words(gpu: &Gpu, from: &wgpu::Buffer) -> Vec<u32> {
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test"),
        size: from.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder();
    encoder.copy_buffer_to_buffer(from, 0, &staging, 0, from.size());
    gpu.queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait(None).expect("the copy runs");
    bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).expect("mapped"))
}

/// With lists that begin at one element no target ever shows anything but the picture of the last frame whose status says complete,
/// or, before there is one, light everywhere: in one piece and in strips, also after other casters came.
#[gpu_test]
fn the_last_complete_picture_stands() {
    let gpu = Gpu::open(None).expect("a GPU");
    // Rows of 256 bytes, as copies of textures want them.
    let size = [64, 48];
    let scenes = ["windmill", "spheres"].map(scene);
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test"),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let buffer = || {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test"),
            size: u64::from(size[0] * size[1]) * 4,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    };
    let (lit, texels) = (buffer(), buffer());
    let shown = || {
        let mut encoder = gpu.encoder();
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(256), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &texels, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
        gpu.queue.submit([encoder.finish()]);
        [words(&gpu, &texels), words(&gpu, &lit)]
    };
    let target = Target { lit: Some(&lit), ..Target::texture(&texture) };
    for facets in [FacetMode::One, FacetMode::All] {
        // What complete frames show: of each scene and camera.
        let cameras = [0, 1].map(|s| (0..9).map(|k| turned(&scenes[s], 0.05 * k as f32)).collect::<Vec<_>>());
        let right = [0, 1].map(|s: usize| {
            let mut pass = pass_on(&gpu, &PassConfig::new(settings(facets, size), casters(&scenes[s])));
            let mut of = |camera: &Camera| {
                let inputs = Inputs::new(camera, &scenes[s].light);
                assert!((0..4).any(|_| frame(&gpu, &mut pass, &inputs, &target).complete));
                shown()
            };
            cameras[s].iter().map(&mut of).collect::<Vec<_>>()
        });
        for (strips, keep_last) in [(1, true), (3, true), (1, false)] {
            let budget = Budget { start: Some(1), ..Budget::default() };
            let config = PassConfig::new(settings(facets, size), casters(&scenes[0]));
            let mut pass = pass_on(&gpu, &PassConfig { strips, keep_last, budget, ..config });
            let pixels = (size[0] * size[1]) as usize;
            let mut expected = [vec![1.0f32.to_bits(); pixels], vec![u32::MAX; pixels]];
            let (mut complete, mut broken) = ([0, 0], 0);
            for s in 0..2 {
                for k in 0..9 {
                    let inputs = Inputs::new(&cameras[s][k], &scenes[s].light);
                    let status = frame(&gpu, &mut pass, &inputs, &target);
                    complete[s] += usize::from(status.complete);
                    if status.complete {
                        expected = right[s][k].clone();
                    }
                    let got = shown();
                    let at =
                        format!("{facets:?}, {strips} strips, scene {s}, frame {k}, complete: {}", status.complete);
                    if keep_last || status.complete {
                        assert!(got == expected, "{at}");
                        let of_pass = [pass.visibility(), pass.lit().expect("lit masks")]
                            .map(|b| words(&gpu, b)[..pixels].to_vec());
                        assert!(of_pass == expected, "{at}: the pass's own");
                    } else {
                        broken += usize::from(got != expected);
                    }
                }
                pass.set_casters(&casters(&scenes[1])).expect("other casters");
            }
            assert!(complete.iter().all(|&n| (2..9).contains(&n)), "{complete:?} of 9 frames each were complete");
            assert_eq!(broken > 0, !keep_last, "frames that show what is not complete");
        }
    }
}

/// The scene's camera, turned about the target by so many radians.
fn turned(scene: &Scene, by: f32) -> Camera {
    let c = scene.camera;
    let [x, z] = [c.eye[0] - c.target[0], c.eye[2] - c.target[2]];
    let eye = [c.target[0] + x * by.cos() - z * by.sin(), c.eye[1], c.target[2] + x * by.sin() + z * by.cos()];
    Camera { eye, ..c }
}

/// A short soak: memory of the device is not more after the second half than after the first, and the last frame is that of a fresh pass.
#[gpu_test]
fn a_short_soak_is_flat() {
    for facets in [FacetMode::One, FacetMode::All] {
        let gpu = Gpu::open(None).expect("a GPU");
        // 30 legs of five frames have every size, light and kind of casters; they come again.
        let mut tell = |row: &Row| eprintln!("{} {} {} {:.1}", row.frame, row.resident, row.device, row.ms);
        let ran = soak(&gpu, facets, 300, 5, 10, &mut tell).expect("frames");
        let most = |rows: &[Row]| rows.iter().map(|row| row.device).max().expect("rows");
        let (first, second) = ran.rows.split_at(15);
        assert!(most(first) > 1 << 16 && most(second) * 20 <= most(first) * 21, "{facets:?}: {:?}", ran.rows);
        assert!(ran.last[0] == ran.last[1] && ran.last[0].len() > 100, "{facets:?}: the last frame differs");
        let mut corrupted = ran.last[0].clone();
        corrupted[50] ^= 1;
        assert!(corrupted != ran.last[1]);
        assert!(ran.complete > 200, "{facets:?}: {} of 300 frames were complete", ran.complete);
    }
}
