//! The pass inside an application's own frame, against the renderer: the same bits, and no frame silently wrong.

#[path = "shared/device.rs"]
mod device;
#[path = "shared/frames.rs"]
mod frames;

use device::gpu;
use frames::status_of;
use gpu_test::gpu_test;
use std::sync::{Arc, Mutex};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::light_view::MapTiles;
use subpixel_shadows::methods::facet_masks::Pipelines;
use subpixel_shadows::methods::{FacetMode, PairVariant, Prepared, Settings};
use subpixel_shadows::pass::{
    Casters, Faults, FrameStatus, GBuffer, Inputs, Moved, PassConfig, Target, TriangleTexture, Vertices,
};
use subpixel_shadows::render::{Budget, Counts, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh, Scene, builtin};
use subpixel_shadows::{Error, ShadowPass, wgpu};
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

const SIZE: [u32; 2] = [83, 61];

fn settings(facets: FacetMode) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, 32).expect("32 samples");
    Settings { facets, cull_back: true, ..Settings::new(SIZE, 64, samples) }
}

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

fn casters(mesh: &Mesh) -> Casters<'_> {
    Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles }
}

fn pass(settings: Settings, casters: Casters) -> ShadowPass {
    ShadowPass::new(&gpu().device, &gpu().queue, &PassConfig::new(settings, casters)).expect("a pass")
}

/// The renderer's picture; pipelines are made once.
fn rendered(mesh: &Mesh, camera: &Camera, light: &Light, settings: &Settings) -> (Output, Prepared) {
    static MADE: Mutex<Vec<Arc<Pipelines>>> = Mutex::new(Vec::new());
    let mut made = MADE.lock().expect("no test panicked while making pipelines");
    let pipelines = made.iter().find(|p| p.serve(settings)).cloned().unwrap_or_else(|| {
        made.push(Arc::new(Pipelines::new(&gpu().device, settings)));
        made[made.len() - 1].clone()
    });
    drop(made);
    let prepared = Prepared::new(mesh).expect("a sound mesh");
    let output = Renderer::with_pipelines(gpu(), &prepared, settings, Budget::default(), pipelines)
        .and_then(|mut renderer| renderer.render(camera, light))
        .expect("a frame");
    (output, prepared)
}

fn texture([width, height]: [u32; 2], format: TextureFormat, usage: TextureUsages) -> wgpu::Texture {
    gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn buffer(size: u64, usage: BufferUsages) -> wgpu::Buffer {
    let descriptor = wgpu::BufferDescriptor { label: Some("test"), size, usage, mapped_at_creation: false };
    gpu().device.create_buffer(&descriptor)
}

/// Where the application wants its results.
struct Targets {
    visibility: wgpu::Texture,
    lit: wgpu::Buffer,
}

/// What it finds there: bits of visibility, lit masks.
#[derive(Clone, Debug, PartialEq)]
struct Picture(Vec<u32>);

impl Targets {
    fn new() -> Self {
        let usage = TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC | TextureUsages::COPY_DST;
        let visibility = texture(SIZE, TextureFormat::R32Float, usage);
        // Neither may be left as it was.
        let poison = vec![0xdead_beefu32; (SIZE[0] * SIZE[1]) as usize];
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIZE[0]), rows_per_image: None };
        let bytes = bytemuck::cast_slice(&poison);
        gpu().queue.write_texture(visibility.as_image_copy(), bytes, layout, visibility.size());
        let lit = buffer(bytes.len() as u64, BufferUsages::COPY_SRC | BufferUsages::COPY_DST);
        gpu().queue.write_buffer(&lit, 0, bytes);
        Self { visibility, lit }
    }

    fn target(&self) -> Target<'_> {
        Target { visibility: Some(&self.visibility), lit: Some(&self.lit) }
    }

    fn read(&self) -> Picture {
        let (width, height) = (SIZE[0] as usize, SIZE[1] as usize);
        let row = (4 * width).next_multiple_of(256);
        let staging = buffer((row * height) as u64 + self.lit.size(), BufferUsages::COPY_DST | BufferUsages::MAP_READ);
        let mut encoder = gpu().encoder();
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row as u32), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &staging, layout };
        encoder.copy_texture_to_buffer(self.visibility.as_image_copy(), to, self.visibility.size());
        encoder.copy_buffer_to_buffer(&self.lit, 0, &staging, (row * height) as u64, self.lit.size());
        gpu().queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu().wait(None).expect("the copies run");
        let bytes = staging.get_mapped_range(..).expect("mapped").to_vec();
        let (rows, lit) = bytes.split_at(row * height);
        let rows = rows.chunks(row).flat_map(|r| r[..4 * width].to_vec());
        Picture(bytemuck::pod_collect_to_vec(&rows.chain(lit.to_vec()).collect::<Vec<u8>>()))
    }
}

fn picture(output: &Output) -> Picture {
    Picture(output.visibility.iter().map(|v| v.to_bits()).chain(output.lit.iter().copied()).collect())
}

/// Records, submits, polls, and asks how it came out.
fn frame(pass: &mut ShadowPass, inputs: &Inputs) -> (Picture, FrameStatus) {
    let targets = Targets::new();
    let mut encoder = gpu().encoder();
    let number = pass.record(&mut encoder, inputs, &targets.target()).expect("recorded");
    gpu().submit_and_wait(encoder).expect("the frame runs");
    let status = status_of(pass);
    assert_eq!((status.frame, pass.frames_in_flight()), (number, 0));
    assert!(pass.status().is_none(), "said once");
    (targets.read(), status)
}

/// A complete frame: one of the first four, where lists were too short for those before.
fn complete(pass: &mut ShadowPass, inputs: &Inputs) -> (Picture, FrameStatus) {
    complete_within(4, pass, inputs)
}

/// A complete frame: one of the first `frames`.
fn complete_within(frames: u32, pass: &mut ShadowPass, inputs: &Inputs) -> (Picture, FrameStatus) {
    for _ in 1..frames {
        let first = frame(pass, inputs);
        if first.1.complete {
            return first;
        }
        assert!(first.1.overflowed, "{:?}", first.1);
    }
    let last = frame(pass, inputs);
    assert!(last.1.complete, "{:?}", last.1);
    last
}

#[track_caller]
fn assert_same(what: &str, got: &Picture, want: &Picture) {
    assert_eq!(got.0.len(), want.0.len(), "{what}");
    let wrong = got.0.iter().zip(&want.0).filter(|(g, w)| g != w).count();
    assert_eq!(wrong, 0, "{what}: {wrong} of {} words differ", want.0.len());
    // The comparison must notice one bit, and the picture must hold more than one answer.
    let mut corrupted = got.clone();
    corrupted.0[want.0.len() / 3] ^= 1;
    assert!(corrupted != *want, "{what}: a corrupted picture passes");
    assert!(want.0.iter().any(|&v| v == 1.0f32.to_bits()) && want.0.contains(&0), "{what}: nothing to see");
}

#[gpu_test]
fn the_picture_is_the_renderers() {
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = settings(facets);
        let mut pass = pass(settings.clone(), casters(&Mesh::default()));
        for name in ["windmill", "spheres", "plant"] {
            let scene = scene(name);
            // Of closed bodies the pass leaves out what turns away, if it cannot cut facets.
            let kept = Settings { cull_back: false, ..settings.clone() };
            let all = rendered(&scene.mesh, &scene.camera, &scene.light, &kept).0;
            let (want, prepared) = rendered(&scene.mesh, &scene.camera, &scene.light, &settings);
            pass.set_casters(&casters(&scene.mesh)).expect("other casters");
            let (got, status) = complete(&mut pass, &Inputs::new(&scene.camera, &scene.light));
            assert_same(&format!("{name}, {facets:?}"), &got, &picture(&want));
            // With one facet a pixel those of casters left out settle nothing, so other pixels are settled: all samples of these are
            // lit, while of those that are evaluated the invalid ones are not.
            let visibility = |p: &Picture| Picture(p.0[..all.visibility.len()].to_vec());
            let (of_both, and_lit) = match facets {
                FacetMode::One => ((visibility(&got), visibility(&picture(&all))), ""),
                FacetMode::All => ((got.clone(), picture(&all)), " and lit samples"),
            };
            assert_same(
                &format!("{name}, {facets:?}, no caster left out, visibility{and_lit}"),
                &of_both.0,
                &of_both.1,
            );
            let fewer = status.counts.triangle_texel_pairs * 10 < all.counts.triangle_texel_pairs * 9;
            let expected = facets == FacetMode::All && prepared.bodies.contains(&true);
            assert_eq!(fewer, expected, "{name}, {facets:?}: {:?} of {:?}", status.counts, all.counts);
            // How many evaluations it takes depends on who comes first.
            let counts = |c: &Counts| Counts { visibility_evaluations: 0, refined_evaluations: 0, ..*c };
            assert_eq!(counts(&status.counts), counts(&want.counts), "{name}, {facets:?}");
        }
    }
}

/// Triangle numbers as an application would write them.
fn id_texture(ids: &[u32]) -> wgpu::Texture {
    let texture = texture(SIZE, TextureFormat::R32Uint, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIZE[0]), rows_per_image: None };
    gpu().queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(ids), layout, texture.size());
    texture
}

#[gpu_test]
fn triangle_ids_stand_in_for_camera_visibility() {
    let settings = settings(FacetMode::One);
    let scene = scene("spheres");
    let (want, prepared) = rendered(&scene.mesh, &scene.camera, &scene.light, &settings);
    let config = PassConfig { timing: true, ..PassConfig::new(settings, casters(&scene.mesh)) };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let given = |t: u32, first: u32| prepared.given.get(t as usize).map_or(first.wrapping_sub(1), |g| g + first);
    for first in [0, 1, 1000] {
        let ids: Vec<u32> = want.triangles.iter().map(|&t| given(t, first)).collect();
        let with = |ids: &[u32], pass: &mut ShadowPass| {
            let texture = id_texture(ids);
            let given = TriangleTexture { texture: &texture, first, none: first.wrapping_sub(1) };
            let gbuffer = GBuffer::TriangleIds(given);
            complete_or_faulty(pass, &Inputs { gbuffer, ..Inputs::new(&scene.camera, &scene.light) })
        };
        let (got, status) = with(&ids, &mut pass);
        assert!(status.complete, "{status:?}");
        assert_same(&format!("numbers from {first}"), &got, &picture(&want));
        let ran = |name: &str| status.stages.iter().any(|s| s.name == name);
        assert!(status.stages.is_empty() || ran("triangle_ids") && !ran("camera_visibility"), "{:?}", status.stages);
        // Numbers of other triangles give another picture, and a number of none is found out.
        let mut off = ids.clone();
        off.rotate_left(700);
        assert!(with(&off, &mut pass).0 != picture(&want), "wrong triangles pass");
        let mut off = ids.clone();
        off[77] = first + prepared.given.len() as u32;
        let (_, status) = with(&off, &mut pass);
        assert_eq!(status.faults, Faults { unknown_triangles: 1, ..Faults::default() });
        assert!(!status.complete && !status.overflowed, "{status:?}");
    }
}

/// The first frame that no list was too short for.
fn complete_or_faulty(pass: &mut ShadowPass, inputs: &Inputs) -> (Picture, FrameStatus) {
    let frames = (0..3).map(|_| frame(pass, inputs));
    frames.into_iter().find(|f| !f.1.overflowed).expect("lists that suffice by the third frame")
}

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
        let fresh = complete(&mut pass(settings(facets), casters(&scene.mesh)), &Inputs::new(&far, &scene.light));
        let mut used = pass(settings(facets), casters(&scene.mesh));
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

/// A vertex buffer of eight words a vertex, the position from the fourth on.
fn vertex_buffer(positions: &[[f32; 3]]) -> wgpu::Buffer {
    let mut words = vec![f32::NAN; 8 * positions.len() + 8];
    for (v, p) in positions.iter().enumerate() {
        words[8 * v + 4..8 * v + 7].copy_from_slice(p);
    }
    let bytes = bytemuck::cast_slice(&words);
    let buffer = buffer(bytes.len() as u64, BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_DST);
    gpu().queue.write_buffer(&buffer, 0, bytes);
    buffer
}

fn bounds(mesh: &Mesh) -> [[f32; 3]; 2] {
    let (low, high) = mesh.bounds().expect("a mesh");
    [low.as_vec3().into(), high.as_vec3().into()]
}

/// A light that goes in among its casters and out again, with casters that stand and with casters that move.
#[gpu_test]
fn a_light_among_its_casters_has_a_cube_of_views() {
    let settings = settings(FacetMode::All);
    let scene = scene("cage");
    let buffer = vertex_buffer(&scene.mesh.positions);
    let moving = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let mut passes = [pass(settings.clone(), casters(&scene.mesh)), pass(settings.clone(), moving)];
    let mut pictures: Vec<Picture> = Vec::new();
    for (position, views) in [([2.0, 9.0, 1.0], 1), ([0.5, 2.0, 0.8], 6), ([2.0, 9.0, 1.0], 1)] {
        let light = Light::Point { position };
        let want = picture(&rendered(&scene.mesh, &scene.camera, &light, &settings).0);
        let inputs = Inputs::new(&scene.camera, &light);
        let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
        let moved = Inputs { moved: Some(Moved { vertices, bounds: bounds(&scene.mesh) }), ..inputs };
        for (pass, inputs) in passes.iter_mut().zip([&inputs, &moved]) {
            // What views share out is guessed less well.
            let (got, _) = complete_within(6, pass, inputs);
            assert_same(&format!("{position:?}"), &got, &want);
            // Of casters that move all six sides are looked at.
            let of = pass.capacities().views;
            assert!(of == views || (of > 1 && of < views && inputs.moved.is_none()), "{position:?}: {of} views");
        }
        pictures.push(want);
    }
    assert!(pictures[0] != pictures[1] && pictures[0] == pictures[2]);
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

/// A map that is more than a binding holds, which is 128 MiB of a device that has no more than WebGPU's defaults.
#[gpu_test]
fn a_map_larger_than_a_binding_is_cut() {
    let scene = scene("plane");
    let small = settings(FacetMode::One);
    let (output, _) = rendered(&scene.mesh, &scene.camera, &scene.light, &small);
    let settings = Settings { map: 5800, ..small };
    let parts = MapTiles::within(settings.map, &gpu().device.limits()).across();
    let bound = gpu().device.limits().max_storage_buffer_binding_size;
    assert!(parts == 2 || bound > 128 << 20, "{parts} parts a side where {bound} bytes are bound");
    let visibility: Vec<u32> = output.visibility.iter().map(|v| v.to_bits()).collect();
    let dark = output.visibility.iter().filter(|&&v| v < 1.0).count();
    assert!(dark > 100 && dark < visibility.len() - 100, "{dark} pixels in shadow");
    let buffer = vertex_buffer(&scene.mesh.positions);
    let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
    let still = Inputs::new(&scene.camera, &scene.light);
    let moving = Inputs { moved: Some(Moved { vertices, bounds: bounds(&scene.mesh) }), ..still };
    let moving_casters = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    for (what, casters, inputs) in [("still", casters(&scene.mesh), still), ("moving", moving_casters, moving)] {
        let mut pass = pass(settings.clone(), casters);
        let (got, _) = complete_within(4, &mut pass, &inputs);
        // Which samples of a pixel settled as lit see other surfaces is not looked at, and another map settles others.
        assert!(got.0[..visibility.len()] == visibility, "{what}: a pixel differs");
        assert_eq!((pass.capacities().views, pass.settings()), (parts.pow(2), &settings), "{what}");
    }
}

/// In strips of rows, as many as there may be, the picture is that of one piece: also of moved casters, with a cube of views, with
/// lists that grow from nothing, in another size, and with triangle numbers, whose faults are counted once.
#[gpu_test]
fn strips_are_the_whole() {
    let scene = scene("spheres");
    let mesh = &scene.mesh;
    let buffer = vertex_buffer(&mesh.positions);
    let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
    let moved = Some(Moved { vertices, bounds: bounds(mesh) });
    let moving = Casters::Moving { rest: &mesh.positions, triangles: &mesh.triangles };
    let still = Inputs::new(&scene.camera, &scene.light);
    let among = Light::Point { position: [0.8, 1.9, 0.9] };
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = settings(facets);
        let strips_of = |strips: u32, casters, start| {
            let budget = Budget { start, ..Budget::default() };
            let config = PassConfig { strips, budget, timing: true, ..PassConfig::new(settings.clone(), casters) };
            ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
        };
        for (what, casters, inputs, cuts) in [
            ("still", casters(mesh), still, &[2, 3, 61][..]),
            ("moving", moving, Inputs { moved, ..still }, &[4]),
            ("a light among them", casters(mesh), Inputs { light: &among, ..still }, &[3]),
        ] {
            let mut whole = strips_of(1, casters, None);
            let (want, in_one) = complete(&mut whole, &inputs);
            assert_eq!(whole.strips(), 1);
            for &strips in cuts {
                let mut pass = strips_of(strips, casters, None);
                assert_eq!(pass.strips(), strips);
                let (got, status) = complete(&mut pass, &inputs);
                assert_same(&format!("{facets:?}, {what}, {strips} strips"), &got, &want);
                let of = |c: &Counts| (c.silhouette_edges, c.silhouette_texels);
                assert_eq!(of(&status.counts), of(&in_one.counts), "{facets:?}, {what}");
                assert!(status.counts.facets >= in_one.counts.facets);
                if strips == 3 && what == "still" {
                    let names = |s: &FrameStatus| s.stages.iter().map(|t| t.name).collect::<Vec<_>>();
                    assert_eq!(names(&status), names(&in_one), "every stage is timed once");
                    let bytes = |pass: &ShadowPass| (pass.visibility().size(), pass.lit().map(|lit| lit.size()));
                    assert_eq!(bytes(&pass), bytes(&whole));
                }
            }
        }
        // Pair lists in bands of facets, and sorted.
        let (want, _) = complete(&mut strips_of(1, casters(mesh), None), &still);
        for pairs in [PairVariant::Tiled, PairVariant::Sorted] {
            let settings = Settings { pairs, ..settings.clone() };
            let budget = Budget { start: Some(64), bytes: 1 << 16 };
            let config = PassConfig { strips: 3, budget, ..PassConfig::new(settings, casters(mesh)) };
            let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
            let (got, _) = complete_within(9, &mut pass, &still);
            assert!(pass.capacities().bands > 1 && pass.strips() == 3, "{:?}", pass.capacities());
            assert_same(&format!("{facets:?}, {pairs:?}, in bands"), &got, &want);
        }
        // Every list short, of every strip.
        let (got, _) = complete_within(7, &mut strips_of(3, casters(mesh), Some(1)), &still);
        assert_same(&format!("{facets:?}, from nothing"), &got, &want);
        let mut pass = strips_of(2, casters(mesh), None);
        // From another size, there and back.
        pass.set_size([20, 90]).expect("another size");
        assert_eq!(pass.strips(), 2);
        pass.set_size(SIZE).expect("the first size");
        assert_same(&format!("{facets:?}, back"), &complete(&mut pass, &still).0, &want);
    }
    let settings = settings(FacetMode::One);
    let (want, prepared) = rendered(mesh, &scene.camera, &scene.light, &settings);
    let config = PassConfig { strips: 4, ..PassConfig::new(settings, casters(mesh)) };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let number = |t: &u32| prepared.given.get(*t as usize).map_or(u32::MAX, |g| *g);
    let mut ids: Vec<u32> = want.triangles.iter().map(number).collect();
    let mut ask = |ids: &[u32]| {
        let texture = id_texture(ids);
        let gbuffer = GBuffer::TriangleIds(TriangleTexture { texture: &texture, first: 0, none: u32::MAX });
        complete_or_faulty(&mut pass, &Inputs { gbuffer, ..still })
    };
    let (got, status) = ask(&ids);
    assert!(status.complete, "{status:?}");
    assert_same("numbers", &got, &picture(&want));
    // One in each row, of which the last strip shares some with the one before.
    (0..SIZE[1]).for_each(|y| ids[(y * SIZE[0] + 7 * y % SIZE[0]) as usize] = 1 << 30);
    assert_eq!(ask(&ids).1.faults, Faults { unknown_triangles: SIZE[1], ..Faults::default() });
}

/// A device whose bindings do not hold the image has it in strips, from the start, or once its lists do not fit any more.
#[gpu_test]
fn a_device_that_binds_little_has_strips() {
    let scene = scene("windmill");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 19, ..wgpu::Limits::default() };
    // Facets of all pixels do not fit; with all surfaces the lists start small enough and grow.
    for (facets, start, map) in
        [(FacetMode::One, None, 64), (FacetMode::One, None, 512), (FacetMode::All, Some(1000), 64)]
    {
        let settings = Settings { size: [160, 120], map, ..settings(facets) };
        let mesh = Mesh { triangles: scene.mesh.triangles[..2500].to_vec(), ..scene.mesh.clone() };
        let (want, _) = rendered(&mesh, &scene.camera, &scene.light, &settings);
        let small = Gpu::open_with_limits(None, Some(limits.clone())).expect("a GPU");
        let budget = Budget { start, ..Budget::default() };
        let config = PassConfig { budget, ..PassConfig::new(settings, casters(&mesh)) };
        let mut pass = ShadowPass::new(&small.device, &small.queue, &config).expect("a pass");
        assert_eq!(pass.strips() > 1, start.is_none(), "{facets:?}");
        // An application may bind the results once.
        let results = (pass.visibility().clone(), pass.lit().cloned());
        let mut frames = 0;
        let visibility = loop {
            let mut encoder = small.encoder();
            pass.record(&mut encoder, &inputs, &Target::default()).expect("recorded");
            small.submit_and_wait(encoder).expect("the frame runs");
            small.check().expect("no error of the device");
            let status = status_of(&mut pass);
            frames += 1;
            if status.complete {
                break read_words(&small, pass.visibility());
            }
            assert!(status.overflowed && frames < 9, "{facets:?}: {status:?}");
        };
        assert!(pass.strips() > 1, "{facets:?}: one binding was enough");
        assert_eq!(pass.capacities().views > 1, map > 64, "{facets:?}");
        assert!(results == (pass.visibility().clone(), pass.lit().cloned()), "{facets:?}: other buffers");
        let wanted: Vec<u32> = want.visibility.iter().map(|v| v.to_bits()).collect();
        let dark = want.visibility.iter().filter(|&&v| v < 1.0).count();
        assert!(dark > 300 && visibility[..wanted.len()] == wanted, "{facets:?}: a pixel differs");
    }
}

fn read_words(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u32> {
    let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
    let descriptor =
        wgpu::BufferDescriptor { label: Some("test"), size: buffer.size(), usage, mapped_at_creation: false };
    let staging = gpu.device.create_buffer(&descriptor);
    let mut encoder = gpu.encoder();
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait(None).expect("the copy runs");
    bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).expect("mapped"))
}

#[gpu_test]
fn a_moved_vertex_buffer_is_a_fresh_mesh() {
    let settings = settings(FacetMode::One);
    let scene = scene("windmill");
    // Two vertices at one point, and one that no triangle uses.
    let mut mesh = scene.mesh.clone();
    let twin = mesh.positions.len() as u32;
    mesh.positions.extend([mesh.positions[mesh.triangles[5][0] as usize], [1e9; 3]]);
    mesh.triangles[5][0] = twin;
    let rest = Casters::Moving { rest: &mesh.positions, triangles: &mesh.triangles };
    let mut pass = pass(settings.clone(), rest);
    let mut last = None;
    for (k, factors) in [[1.0, 1.0, 1.0], [1.25, 1.0, 0.5], [0.75, 1.5, 1.0]].into_iter().enumerate() {
        let mut moved = mesh.clone();
        moved.positions.iter_mut().for_each(|p| *p = [0, 1, 2].map(|a| p[a] * factors[a]));
        let same = Prepared::new(&moved).expect("a sound mesh").mesh().triangles
            == Prepared::new(&mesh).expect("a sound mesh").mesh().triangles;
        assert!(same, "the canonical order has changed, and ties may fall otherwise");
        let (want, _) = rendered(&moved, &scene.camera, &scene.light, &settings);
        let buffer = vertex_buffer(&moved.positions);
        let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
        let mut around = bounds(&moved);
        if k == 2 {
            around = [around[0].map(|c| c - 3.0), around[1].map(|c| c + 1.0)];
        }
        let at = |vertices, bounds| {
            let moved = Some(Moved { vertices, bounds });
            Inputs { moved, ..Inputs::new(&scene.camera, &scene.light) }
        };
        let (got, status) = complete(&mut pass, &at(vertices, around));
        assert_same(&format!("{factors:?}"), &got, &picture(&want));
        assert_eq!(status.faults, Faults::default());
        assert!(last.replace(got.clone()) != Some(got), "the picture has not moved");
        // One vertex elsewhere: another picture, found out where it leaves its twin or the box.
        let mut off = moved.positions.clone();
        off[twin as usize][1] += 0.25;
        let buffer = vertex_buffer(&off);
        let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
        let (_, status) = complete_or_faulty(&mut pass, &at(vertices, around));
        assert!(status.faults.parted > 0 && !status.complete, "{status:?}");
        let mut tight = around;
        tight[1][1] -= (tight[1][1] - tight[0][1]) * 0.5;
        let buffer = vertex_buffer(&moved.positions);
        let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
        let (_, status) = complete_or_faulty(&mut pass, &at(vertices, tight));
        assert!(status.faults.outside > 0 && !status.complete, "{status:?}");
    }
}

/// Two frames in one encoder have each their own camera; an encoder that is dropped leaves nothing behind.
#[gpu_test]
fn frames_of_one_submission_do_not_mix() {
    let settings = settings(FacetMode::One);
    let scene = scene("spheres");
    let mut other = scene.camera;
    other.eye[0] += 1.5;
    let all: Vec<_> = [scene.camera, other]
        .into_iter()
        .map(|camera| (picture(&rendered(&scene.mesh, &camera, &scene.light, &settings).0), camera, Targets::new()))
        .collect();
    for strips in [1, 3] {
        let config = PassConfig { strips, ..PassConfig::new(settings.clone(), casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        for camera in [&scene.camera, &other] {
            complete(&mut pass, &Inputs::new(camera, &scene.light));
        }
        let mut encoder = gpu().encoder();
        for (_, camera, targets) in &all {
            pass.record(&mut encoder, &Inputs::new(camera, &scene.light), &targets.target()).expect("recorded");
        }
        assert!(pass.status().is_none() && pass.frames_in_flight() == 2);
        gpu().submit_and_wait(encoder).expect("both frames run");
        for (want, _, targets) in &all {
            assert!(status_of(&mut pass).complete);
            assert_same("a frame of two", &targets.read(), want);
        }
        let mut dropped = gpu().encoder();
        let none = Target::default();
        pass.record(&mut dropped, &Inputs::new(&scene.camera, &scene.light), &none).expect("recorded");
        drop(dropped);
        assert!(pass.status().is_none() && pass.frames_in_flight() == 0);
        let (got, status) = frame(&mut pass, &Inputs::new(&scene.camera, &scene.light));
        assert!(status.complete);
        assert_same("after a dropped encoder", &got, &all[0].0);
        // A frame whose image is cut otherwise before it has run.
        let mut encoder = gpu().encoder();
        pass.record(&mut encoder, &Inputs::new(&scene.camera, &scene.light), &none).expect("recorded");
        pass.set_size([SIZE[0], 2]).expect("another size");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        let late = status_of(&mut pass);
        let of = |c: &Counts| (c.silhouette_edges, c.silhouette_pixels, c.pixel_texel_pairs, c.facets);
        assert!(late.complete && of(&late.counts) == of(&status.counts), "{late:?}");
    }
}

#[track_caller]
fn refused(what: &str, result: Result<u64, Error>) {
    match result {
        Err(Error::Config(text) | Error::Scene(text)) => {
            assert!(text.contains(what) && !text.contains('\n'), "'{what}' expected: {text}");
        }
        other => panic!("{what}: {other:?}"),
    }
}

#[gpu_test]
fn bad_input_is_refused() {
    let (device, queue) = (&gpu().device, &gpu().queue);
    let scene = scene("plane");
    let good = settings(FacetMode::One);
    let refuse = |config: &PassConfig| ShadowPass::new(device, queue, config).err().map(|e| e.to_string());
    let positions = [[0.0, 0.0, f32::NAN]; 3];
    let broken = Casters::Static { positions: &positions, triangles: &[[0, 1, 2]] };
    assert!(refuse(&PassConfig::new(good.clone(), broken)).expect("an error").contains("not finite"));
    let beyond = Casters::Moving { rest: &[[0.0; 3]; 3], triangles: &[[0, 1, 3]] };
    assert!(refuse(&PassConfig::new(good.clone(), beyond)).expect("an error").contains("vertex 3"));
    let flat = Settings { size: [0, 5], ..good.clone() };
    assert!(refuse(&PassConfig::new(flat, casters(&scene.mesh))).expect("an error").contains("0x5"));
    // Whatever the strips, the results of the whole image are one buffer each.
    let samples = Samples::new(Pattern::LowDiscrepancy, 128).expect("128 samples");
    let vast = Settings { size: [16384, 16384], samples, ..good.clone() };
    assert!(refuse(&PassConfig::new(vast, casters(&scene.mesh))).expect("an error").contains("memory"));

    let limits = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..wgpu::Limits::default() };
    let small = Gpu::open_with_limits(None, Some(limits)).expect("a GPU");
    let config = PassConfig::new(good.clone(), casters(&scene.mesh));
    let error = ShadowPass::new(&small.device, &small.queue, &config).err().expect("an error").to_string();
    assert!(error.contains("4 storage buffers a stage"), "{error}");

    let inputs = Inputs::new(&scene.camera, &scene.light);
    let want = complete(&mut self::pass(good.clone(), casters(&scene.mesh)), &inputs).0;
    let mut pass = pass(good, casters(&scene.mesh));
    assert!(pass.set_size([5, 20_000]).is_err() && pass.set_casters(&broken).is_err());
    assert_same("after what was refused", &complete(&mut pass, &inputs).0, &want);
    let mut encoder = gpu().encoder();
    let mut with = |inputs: &Inputs, target: &Target| pass.record(&mut encoder, inputs, target);
    let none = Target::default();
    let camera = Camera { vertical_fov_degrees: 180.0, ..scene.camera };
    refused("180", with(&Inputs { camera: &camera, ..inputs }, &none));
    let light = Light::Directional { direction: [0.0; 3] };
    refused("length 0", with(&Inputs { light: &light, ..inputs }, &none));
    let storage = TextureUsages::STORAGE_BINDING;
    for (what, size, format, usage) in [
        ("format", SIZE, TextureFormat::R32Uint, storage),
        ("84x61", [84, 61], TextureFormat::R32Float, storage),
        ("lacks", SIZE, TextureFormat::R32Float, TextureUsages::TEXTURE_BINDING),
    ] {
        let texture = texture(size, format, usage);
        refused(what, with(&inputs, &Target { visibility: Some(&texture), lit: None }));
    }
    let pixels = u64::from(SIZE[0] * SIZE[1]) * 4;
    for (what, size, usage) in
        [("bytes", pixels - 4, BufferUsages::COPY_DST), ("lacks COPY_DST", pixels, BufferUsages::STORAGE)]
    {
        let buffer = buffer(size, usage);
        refused(what, with(&inputs, &Target { visibility: None, lit: Some(&buffer) }));
    }
    for (what, size, format, usage) in [
        ("format", SIZE, TextureFormat::R32Float, TextureUsages::TEXTURE_BINDING),
        ("1x1", [1, 1], TextureFormat::R32Uint, TextureUsages::TEXTURE_BINDING),
        ("lacks", SIZE, TextureFormat::R32Uint, TextureUsages::COPY_DST),
    ] {
        let texture = texture(size, format, usage);
        let gbuffer = GBuffer::TriangleIds(TriangleTexture::new(&texture));
        refused(what, with(&Inputs { gbuffer, ..inputs }, &none));
    }
    let vertices = buffer(1 << 16, BufferUsages::STORAGE);
    let at = |buffer, bounds| Inputs { moved: Some(Moved { vertices: Vertices::packed(buffer), bounds }), ..inputs };
    refused("static casters", with(&at(&vertices, [[0.0; 3], [1.0; 3]]), &none));

    let rest = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    pass.set_casters(&rest).expect("moving casters");
    let mut with = |inputs: &Inputs| pass.record(&mut encoder, inputs, &none);
    refused("no vertex buffer", with(&inputs));
    refused("no box", with(&at(&vertices, [[0.0, 2.0, 0.0], [1.0; 3]])));
    let [short, other] = [buffer(16, BufferUsages::STORAGE), buffer(1 << 16, BufferUsages::VERTEX)];
    refused("do not hold", with(&at(&short, [[0.0; 3], [1.0; 3]])));
    refused("lacks STORAGE", with(&at(&other, [[0.0; 3], [1.0; 3]])));
    let beyond = Vertices { offset: u64::MAX - 3, ..Vertices::packed(&vertices) };
    refused(
        "do not hold",
        with(&Inputs { moved: Some(Moved { vertices: beyond, bounds: [[0.0; 3], [1.0; 3]] }), ..inputs }),
    );
    refused("32-bit numbers", with(&at(&vertices, [[-1e30; 3], [1.0; 3]])));
    let far = Camera { eye: [1e20, 0.0, 0.0], ..scene.camera };
    refused("", with(&Inputs { camera: &far, ..at(&vertices, [[0.0; 3], [1.0; 3]]) }));
    let mut every = self::pass(settings(FacetMode::All), casters(&scene.mesh));
    let texture = texture(SIZE, TextureFormat::R32Uint, TextureUsages::TEXTURE_BINDING);
    let gbuffer = GBuffer::TriangleIds(TriangleTexture::new(&texture));
    refused("one sample", every.record(&mut encoder, &Inputs { gbuffer, ..inputs }, &none));
    gpu().submit_and_wait(encoder).expect("nothing was recorded");
    assert!(pass.status().is_none() && every.status().is_none());
    gpu().check().expect("no error of the device");
}
