//! Pipelines that passes share, compiled on all cores and with a cache, and the account of memory.

use super::*;
use subpixel_shadows::gpu::program::made_here;
use subpixel_shadows::gpu::{AdapterSummary, BufferMemory, KeptPrograms};
use subpixel_shadows::pass::{CasterMesh, CasterPart};

pub fn picture(pass: &mut ShadowPass, gpu: &Gpu, scene: &Scene) -> Vec<u32> {
    for _ in 0..9 {
        let mut encoder = gpu.encoder();
        pass.record(&mut encoder, &Inputs::new(&scene.camera, &scene.light), &Target::default()).expect("recorded");
        gpu.submit_and_wait(encoder).expect("the frame runs");
        if status_of(pass).complete {
            return test_support::refused::words(gpu, pass.visibility(), pass.lit()).expect("a picture");
        }
    }
    panic!("no frame is complete");
}

/// Passes of one store compile what others have not; how far it is, is told; a pass may be made on another thread.
#[gpu_test]
fn passes_share_their_programs() {
    let told = Arc::new(Mutex::new(Vec::new()));
    let hears = told.clone();
    let programs =
        KeptPrograms::default().telling(move |done, of| hears.lock().expect("no test panicked").push((done, of)));
    let (windmill, spheres) = (scene("windmill"), scene("spheres"));
    let make = |scene: &Scene, size| {
        let settings = Settings { size, ..settings(FacetMode::All) };
        let config = PassConfig { programs: Some(&programs), ..PassConfig::new(settings, casters(&scene.mesh)) };
        let before = made_here();
        (ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass"), made_here() - before)
    };
    let first = std::thread::scope(|threads| threads.spawn(|| make(&windmill, SIZE)).join().expect("no panic"));
    let all = programs.len();
    assert_eq!(first.1, all as u64, "programs made for the first");
    let mut heard = std::mem::take(&mut *told.lock().expect("no test panicked"));
    assert_eq!(heard.first(), Some(&(0, all)));
    heard.sort_unstable();
    assert_eq!(heard, (0..=all).map(|done| (done, all)).collect::<Vec<_>>());
    let second = make(&spheres, [40, 30]);
    assert_eq!((second.1, programs.len()), (0, all), "programs made for the second");
    assert!(told.lock().expect("no test panicked").is_empty(), "nothing was compiled, and nothing is told");
    for (mut of_store, scene, size) in [(first.0, &windmill, SIZE), (second.0, &spheres, [40, 30])] {
        let mut own = pass(Settings { size, ..settings(FacetMode::All) }, casters(&scene.mesh));
        assert!(picture(&mut of_store, gpu(), scene) == picture(&mut own, gpu(), scene), "another picture");
    }
    #[cfg(feature = "baselines")]
    {
        let method = subpixel_shadows::methods::MethodName::Pcf;
        let config = PassConfig {
            method,
            programs: Some(&programs),
            ..PassConfig::new(settings(FacetMode::One), casters(&spheres.mesh))
        };
        let make = || ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        make();
        let (more, before) = (programs.len(), made_here());
        make();
        assert!(more > all && programs.len() == more && made_here() == before, "programs of another method are kept");
    }
}

/// Pipelines that were made beside the application, by a thread or in steps: a pass of the store compiles none, whatever its casters and size, and its
/// picture is that of another. Without a store, and with settings that cannot be, there are none.
#[gpu_test]
fn pipelines_are_made_beside_the_application() {
    let scene = scene("spheres");
    let meshes = [CasterMesh::new(&scene.mesh.positions, &scene.mesh.triangles)];
    let parts = [CasterPart::standing(meshes[0]), CasterPart::instances(meshes[0], 2)];
    let kinds = [
        (true, false, casters(&scene.mesh)),
        (false, true, Casters::Instanced { meshes: &meshes, instances: &[0] }),
        (false, false, Casters::Parts { parts: &parts, room: 9 }),
    ];
    for (threaded, keep_last, kind) in kinds {
        let programs = KeptPrograms::default();
        let config = PassConfig {
            keep_last,
            programs: Some(&programs),
            ..PassConfig::new(Settings { map: 512, ..settings(FacetMode::All) }, kind)
        };
        let (device, queue) = (&gpu().device, &gpu().queue);
        let begin = if threaded { ShadowPass::compile } else { ShadowPass::compile_in_steps };
        let mut compiling = begin(device, queue, &config).expect("begun");
        let mut last = 0;
        while !compiling.advance(5).expect("compiled") {
            let (done, of) = compiling.progress();
            assert!(done >= last && done <= of, "{done} of {of} after {last}");
            assert!(threaded || (done == last + 5 && of == programs.len()), "{done} of {of} after {last}");
            last = done;
            if threaded {
                std::thread::sleep(std::time::Duration::from_millis(5));
            }
        }
        let all = programs.len();
        assert!(all > 20 && compiling.progress() == (all, all), "{all} {:?}", compiling.progress());
        compiling.finish().expect("nothing is left");
        let before = made_here();
        let mut pass = ShadowPass::new(device, queue, &config).expect("a pass");
        assert_eq!((made_here() - before, programs.len()), (0, all), "programs made for the pass");
        pass.set_size([40, 30]).expect("another size");
        assert_eq!((made_here() - before, programs.len()), (0, all), "programs made for another size");
        // The check notices a store that was not filled.
        let without = PassConfig { programs: Some(&KeptPrograms::default()), ..config.clone() };
        drop(ShadowPass::new(device, queue, &without).expect("a pass"));
        assert_eq!(made_here() - before, all as u64);
        if threaded {
            let mut own =
                self::pass(Settings { size: [40, 30], map: 512, ..settings(FacetMode::All) }, casters(&scene.mesh));
            assert!(picture(&mut pass, gpu(), &scene) == picture(&mut own, gpu(), &scene), "another picture");
        }
        let none = begin(device, queue, &PassConfig { programs: None, ..config.clone() });
        assert!(none.is_err_and(|e| e.to_string().contains("`programs`")));
        let size = [0, 0];
        let nothing = PassConfig { settings: Settings { size, ..settings(FacetMode::All) }, ..config };
        assert!(begin(device, queue, &nothing).is_err_and(|e| e.to_string().contains("0x0")));
    }
}

/// Pipelines are compiled with the application's cache: that of another device is refused, in one line; what one held serves the next.
#[gpu_test]
fn pipeline_caches_are_the_applications() {
    let adapters = Gpu::adapters();
    let summary = |a: &wgpu::Adapter| AdapterSummary::of(&a.get_info());
    let adapter = adapters.iter().find(|a| summary(a) == gpu().adapter).expect("the adapter of the other tests");
    let required_features = adapter.features() & wgpu::Features::PIPELINE_CACHE;
    if required_features.is_empty() {
        // Vulkan has caches; others have none to hand in.
        return assert_ne!(adapter.get_info().backend, wgpu::Backend::Vulkan, "Vulkan without pipeline caches");
    }
    let open = || {
        let descriptor = wgpu::DeviceDescriptor { required_features, ..Default::default() };
        futures::executor::block_on(adapter.request_device(&descriptor)).expect("a device")
    };
    let ((device, queue), (other, _)) = (open(), open());
    let cache = |device: &wgpu::Device, data: Option<&[u8]>| {
        let descriptor = wgpu::PipelineCacheDescriptor { label: Some("test"), data, fallback: true };
        // SAFETY: `data` is what a cache on the same adapter returned, or nothing.
        #[allow(unsafe_code)]
        unsafe {
            device.create_pipeline_cache(&descriptor)
        }
    };
    let mesh = scene("plane").mesh;
    let make = |cache| {
        let programs = KeptPrograms::with_cache(cache);
        let config =
            PassConfig { programs: Some(&programs), ..PassConfig::new(settings(FacetMode::One), casters(&mesh)) };
        ShadowPass::new(&device, &queue, &config).map(|_| ())
    };
    let own = cache(&device, None);
    make(own.clone()).expect("a pass");
    let data = own.get_data().expect("a cache of a driver");
    assert!(!data.is_empty());
    make(cache(&device, Some(&data))).expect("a pass of what was kept");
    let error = make(cache(&other, None)).expect_err("a cache of another device").to_string();
    assert!(error.starts_with("gpu: ") && error.to_lowercase().contains("device") && !error.contains('\n'), "{error}");
}

fn bytes(memory: &[BufferMemory]) -> u64 {
    memory.iter().map(|buffer| buffer.bytes).sum()
}

/// The account names every buffer once, follows sizes, casters and lists, and is of one pass alone.
#[gpu_test]
fn memory_is_accounted_for() {
    let (windmill, plane) = (scene("windmill"), scene("plane"));
    let config = PassConfig {
        budget: Budget { start: Some(1), ..Budget::default() },
        ..PassConfig::new(settings(FacetMode::All), casters(&windmill.mesh))
    };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let of = |pass: &ShadowPass, label: &str| {
        let found: Vec<u64> = pass.memory().iter().filter(|b| b.label.contains(label)).map(|b| b.bytes).collect();
        assert!(!found.is_empty(), "no {label} in {:?}", pass.memory());
        found.iter().sum::<u64>()
    };
    let first = pass.memory();
    assert!(first.is_sorted_by(|a, b| a.bytes >= b.bytes), "the largest first");
    let pixels = u64::from(SIZE[0] * SIZE[1]);
    assert_eq!(of(&pass, ".visibility"), pass.visibility().size());
    assert_eq!(pass.visibility().size(), (pixels * 4).next_multiple_of(16));
    assert_eq!(of(&pass, "casters.numbers"), (windmill.mesh.triangles.len() as u64 * 4).next_multiple_of(16));
    // A pass beside it changes nothing, nor does its end.
    let beside = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    assert_eq!(pass.memory(), first);
    assert_eq!(bytes(&beside.memory()), bytes(&first));
    drop(beside);
    picture(&mut pass, gpu(), &windmill);
    let grown = pass.memory();
    assert!(bytes(&grown) > bytes(&first), "lists have grown");
    let again = pass.memory().len();
    for _ in 0..20 {
        picture(&mut pass, gpu(), &windmill);
    }
    assert!(pass.memory().len() <= again + 8, "still frames hold no more: {:?}", pass.memory());
    pass.set_size([SIZE[0] * 4, SIZE[1] * 4]).expect("another size");
    assert_eq!(of(&pass, ".visibility"), (pixels * 16 * 4).next_multiple_of(16));
    pass.set_casters(&casters(&plane.mesh)).expect("other casters");
    assert_eq!(of(&pass, "casters.numbers"), (plane.mesh.triangles.len() as u64 * 4).next_multiple_of(16));
    // In strips an image takes less.
    let strips = ShadowPass::new(&gpu().device, &gpu().queue, &PassConfig { strips: 4, ..config }).expect("a pass");
    assert!(strips.strips() > 1 && bytes(&strips.memory()) < bytes(&first), "{:?} and {first:?}", strips.memory());
}
