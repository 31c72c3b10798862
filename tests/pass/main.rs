//! The pass inside an application's own frame, against the renderer: the same bits, and no frame silently wrong.

mod alpha;
mod area_lights;
mod by_method;
mod clusters;
mod counts;
mod filters;
mod focus;
mod instances;
mod kept_maps;
mod lights;
mod lists;
mod lit_masks;
mod parts;
mod programs;
mod refusals;
mod strips;
mod targets;

use lab::scene::{Scene, builtin};
use std::sync::{Arc, Mutex};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::gpu::bind_groups::bind_groups_here;
use subpixel_shadows::light_view::MapTiles;
use subpixel_shadows::methods::facet_masks::Pipelines;
use subpixel_shadows::methods::{FacetMode, PairVariant, Prepared, Settings};
use subpixel_shadows::pass::{
    Casters, Faults, FrameStatus, GBuffer, Inputs, LightTarget, Moved, PassConfig, Target, TriangleTexture, Vertices,
};
use subpixel_shadows::render::{Budget, Counts, Output, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::{Error, ShadowPass, wgpu};
use test_support::gpu;
use test_support::gpu_test;
use test_support::status_of;
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

/// Result there: bits of visibility, lit masks.
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
        Target { lit: Some(&self.lit), ..Target::texture(&self.visibility) }
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

/// The first frame that no list was too short for.
fn complete_or_faulty(pass: &mut ShadowPass, inputs: &Inputs) -> (Picture, FrameStatus) {
    let frames = (0..3).map(|_| frame(pass, inputs));
    frames.into_iter().find(|f| !f.1.overflowed).expect("lists that suffice by the third frame")
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
            let counts =
                |c: &Counts| Counts { visibility_evaluations: 0, refined_evaluations: 0, silhouette_texels: 0, ..*c };
            assert_eq!(counts(&status.counts), counts(&want.counts), "{name}, {facets:?}");
            // The pass keeps its maps and makes them whole, the renderer makes what its facets ask.
            let [kept, asked] = [&status.counts, &want.counts].map(|c| c.silhouette_texels);
            assert!(asked > 0 && kept >= asked, "{name}, {facets:?}: {kept} marks, {asked} asked for");
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
            // Lists that views share out are guessed less well.
            let (got, _) = complete_within(6, pass, inputs);
            assert_same(&format!("{position:?}"), &got, &want);
            // Of a cube the sides in which something is seen.
            let of = pass.capacities().views;
            assert!(of == views || (of > 1 && of < views), "{position:?}: {of} views");
        }
        pictures.push(want);
    }
    assert!(pictures[0] != pictures[1] && pictures[0] == pictures[2]);
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
    for (k, factor) in [1.0, 0.5, 2.0].into_iter().enumerate() {
        let mut moved = mesh.clone();
        moved.positions.iter_mut().flatten().for_each(|c| *c *= factor);
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
        assert_same(&format!("{factor}"), &got, &picture(&want));
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
