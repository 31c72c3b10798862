//! Every method in an application's own frame, and frames of which little is needed.

use lab::scene::{Scene, builtin};
use subpixel_shadows::gpu::program::made_here;
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::methods::{FacetMode, HistorySettings, MethodName, Prepared, Settings};
use subpixel_shadows::pass::{
    Casters, FrameStatus, GBuffer, Inputs, LightTarget, Moved, PassConfig, Target, TriangleTexture, Vertices,
};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{AreaLight, Camera, Light, Mesh};
use subpixel_shadows::{Error, ShadowPass, wgpu};
use test_support::gpu;
use test_support::gpu_test;
use test_support::status_of;
use wgpu::util::DeviceExt;

const SIZE: [u32; 2] = [61, 47];

fn settings(samples: u32) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, samples).expect("samples");
    Settings { facets: FacetMode::One, ..Settings::new(SIZE, 96, samples) }
}

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

fn casters(mesh: &Mesh) -> Casters<'_> {
    Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles }
}

fn others() -> impl Iterator<Item = MethodName> {
    MethodName::ALL.into_iter().filter(|method| *method != MethodName::FacetMasks)
}

fn pass(config: &PassConfig) -> ShadowPass {
    ShadowPass::new(&gpu().device, &gpu().queue, config).expect("a pass")
}

/// Bits of visibility, and lit masks.
type Picture = (Vec<u32>, Vec<u32>);

fn words(from: &wgpu::Buffer) -> Vec<u32> {
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
    let descriptor =
        wgpu::BufferDescriptor { label: Some("test"), size: from.size(), usage, mapped_at_creation: false };
    let staging = gpu().device.create_buffer(&descriptor);
    let mut encoder = gpu().encoder();
    encoder.copy_buffer_to_buffer(from, 0, &staging, 0, from.size());
    gpu().queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu().wait(None).expect("the copy runs");
    bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).expect("mapped"))
}

fn picture(pass: &ShadowPass) -> Picture {
    let [width, height] = pass.settings().size.map(|side| side as usize);
    let pixels = width * height;
    let lit = pass.lit().map_or(Vec::new(), |lit| words(lit)[..pixels].to_vec());
    (words(pass.visibility())[..pixels].to_vec(), lit)
}

/// The first complete frame of nine.
fn frame(pass: &mut ShadowPass, inputs: &Inputs) -> (Picture, FrameStatus) {
    for _ in 0..9 {
        let mut encoder = gpu().encoder();
        let number = pass.record(&mut encoder, inputs, &Target::default()).expect("a frame");
        gpu().submit_and_wait(encoder).expect("it runs");
        let status = status_of(pass);
        assert_eq!((status.frame, &status.error), (number, &None));
        if status.complete {
            return (picture(pass), status);
        }
    }
    panic!("no complete frame");
}

/// Frames before count while the light stands, whatever the camera does; of another light there are none, nor after they are forgotten.
#[gpu_test]
fn a_history_is_that_of_one_light() {
    let scene = scene("spheres");
    let history = Some(HistorySettings::default());
    let made = || {
        let settings = Settings { history, ..settings(1) };
        pass(&PassConfig { method: MethodName::ShadowMap, ..PassConfig::new(settings, casters(&scene.mesh)) })
    };
    let other = Light::Directional { direction: [-0.3, 1.0, 0.2] };
    let (here, there) = (Inputs::new(&scene.camera, &scene.light), Inputs::new(&scene.camera, &other));
    let mut turned = scene.camera;
    turned.eye[0] += 0.05;
    let moved = Inputs::new(&turned, &scene.light);
    let mut kept = made();
    let first = frame(&mut kept, &here).0;
    let second = frame(&mut kept, &here).0;
    assert!(first != second, "the second frame is the first");
    // The same maps without a past: a pass that had another light before.
    let after_other = |inputs: &Inputs| {
        let mut pass = made();
        for _ in 0..2 {
            frame(&mut pass, &there);
        }
        frame(&mut pass, inputs).0
    };
    let third = frame(&mut kept, &moved).0;
    assert!(third != after_other(&moved), "nothing is left of the frames before");
    // Its fourth frame, of another light.
    let alone = || {
        let mut pass = made();
        for _ in 0..3 {
            frame(&mut pass, &here);
        }
        frame(&mut pass, &there).0
    };
    assert!(frame(&mut kept, &there).0 == alone(), "something is left of another light");
    kept.forget_history();
    assert!(frame(&mut kept, &here).0 == first, "something is left of what is forgotten");
    let mut encoder = gpu().encoder();
    let both = [scene.light, other].map(|light| LightTarget::new(light, Target::default()));
    let refused = kept.record_lights(&mut encoder, &here, &both);
    assert!(matches!(&refused, Err(Error::Config(text)) if text.contains("2 lights")), "{refused:?}");
    let area = AreaLight { light: scene.light, radius: 0.1, points: 3 };
    let refused = kept.record_area(&mut encoder, &here, &area, &Target::default());
    assert!(matches!(&refused, Err(Error::Config(text)) if text.contains("3 points")), "{refused:?}");
}

fn rendered(scene: &Scene, method: MethodName, settings: &Settings) -> Picture {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let mut renderer = Renderer::of_method(gpu(), &prepared, method, settings, Budget::default()).expect("a renderer");
    let output = renderer.render(&scene.camera, &scene.light).expect("a frame");
    (output.visibility.iter().map(|v| v.to_bits()).collect(), output.lit)
}

fn turned(camera: &Camera, by: f32) -> Camera {
    let eye = [camera.eye[0] + by, camera.eye[1], camera.eye[2] - by];
    Camera { eye, ..*camera }
}

/// Two frames in one submission, another size and back, other casters: each the renderer's picture, with no pipeline made after the pass.
#[gpu_test]
fn every_method_is_recorded() {
    let (plain, other) = (scene("windmill"), scene("spheres"));
    for method in others() {
        let name = method.name();
        let settings = settings(8);
        let mut pass = pass(&PassConfig { method, ..PassConfig::new(settings.clone(), casters(&plain.mesh)) });
        let want = rendered(&plain, method, &settings);
        assert!(want.0.contains(&0), "{name}: no shadow");
        assert_eq!(pass.lit().is_some(), !want.1.is_empty(), "{name}");
        let (got, status) = frame(&mut pass, &Inputs::new(&plain.camera, &plain.light));
        assert!(got == want, "{name}: another picture");
        assert!(status.dispatches > 5 && status.lists.is_empty() && status.counts.facets > 0, "{name}: {status:?}");
        // The second of one submission is no other for the first one before it, and the first none for the second.
        let aside = Scene { camera: turned(&plain.camera, 0.4), ..plain.clone() };
        let moved = Light::Directional { direction: [0.7, 1.0, -0.2] };
        let wants = [
            rendered(&aside, method, &settings),
            rendered(&Scene { light: moved, ..aside.clone() }, method, &settings),
        ];
        assert!(wants[0].0 != want.0 && wants[1].0 != wants[0].0, "{name}");
        let pictures = [&aside.light, &moved].map(|light| {
            let inputs = Inputs::new(&aside.camera, light);
            let mut encoder = gpu().encoder();
            let kept = gpu().device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("test"),
                size: pass.visibility().size(),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            pass.record(&mut encoder, &inputs, &Target::default()).expect("a frame");
            encoder.copy_buffer_to_buffer(pass.visibility(), 0, &kept, 0, kept.size());
            (encoder.finish(), kept)
        });
        let [(first, one), (second, two)] = pictures;
        gpu().queue.submit([first, second]);
        gpu().wait(None).expect("they run");
        assert!([status_of(&mut pass), status_of(&mut pass)].iter().all(|s| s.complete), "{name}");
        let pixels = (SIZE[0] * SIZE[1]) as usize;
        assert!(words(&one)[..pixels] == wants[0].0 && words(&two)[..pixels] == wants[1].0, "{name}: frames mix");
        let before = made_here();
        pass.set_size([24, 18]).expect("another size");
        frame(&mut pass, &Inputs::new(&plain.camera, &plain.light));
        pass.set_casters(&casters(&other.mesh)).expect("other casters");
        pass.set_size(SIZE).expect("the first size");
        let (got, _) = frame(&mut pass, &Inputs::new(&other.camera, &other.light));
        assert_eq!(made_here() - before, 0, "{name}: pipelines are made anew");
        assert!(got == rendered(&other, method, &settings), "{name}: another picture of other casters");
    }
}

/// With a facet for every surface rays and supersampling find as many facets as `facet-masks` does, and say what it says of them. Frames with
/// more than they had room for are incomplete, also those recorded before that was known, and change nothing that stands.
#[gpu_test]
fn rays_and_supersampling_take_every_surface() {
    let plain = scene("bicycle");
    let settings = Settings { facets: FacetMode::All, ..settings(8) };
    let inputs = Inputs::new(&plain.camera, &plain.light);
    let want = rendered(&plain, MethodName::FacetMasks, &settings);
    let pixels = want.0.len();
    for method in [MethodName::RayTraced, MethodName::Supersampled] {
        let name = method.name();
        let config = PassConfig { method, ..PassConfig::new(settings.clone(), casters(&plain.mesh)) };
        let mut pass = pass(&PassConfig { keep_last: true, ..config });
        let [first, second] = [(); 2].map(|()| {
            let mut encoder = gpu().encoder();
            pass.record(&mut encoder, &inputs, &Target::default()).expect("a frame");
            encoder.finish()
        });
        gpu().queue.submit([first, second]);
        gpu().wait(None).expect("they run");
        for status in [status_of(&mut pass), status_of(&mut pass)] {
            assert!(status.overflowed && !status.complete && status.error.is_none(), "{name}: {status:?}");
        }
        assert!(picture(&pass).0.iter().all(|v| *v == 1f32.to_bits()), "{name}: an incomplete picture shows");
        let (got, status) = frame(&mut pass, &inputs);
        assert!(status.counts.facets > pixels as u64 * 3 / 2, "{name}: {} facets", status.counts.facets);
        let other = got.0.iter().zip(&want.0).filter(|(a, b)| a != b).count();
        assert!(other * 200 < pixels && want.0.contains(&0), "{name}: {other} of {pixels} pixels differ");
        let one = rendered(&plain, method, &Settings { facets: FacetMode::One, ..settings.clone() });
        let far = one.0.iter().zip(&want.0).filter(|(a, b)| a != b).count();
        assert!(far * 20 > pixels, "{name}: one facet a pixel says the same");
        assert!(rendered(&plain, method, &settings) == got, "{name}: another picture of the renderer's");
    }
}

/// A light that goes in among its casters and out again, and slices: the renderer's picture each time. From the first such frame on no
/// pipeline is made, in another size neither.
#[gpu_test]
fn several_views_are_recorded() {
    let plain = scene("spheres");
    let lamp = Light::Point { position: [0.8, 1.9, 0.9] };
    for method in others().filter(|method| *method != MethodName::Supersampled) {
        let name = method.name();
        let plan = SplitPlan { splits: 2, warp: Warp::Fitted, focus: 0.6, ..SplitPlan::default() };
        let settings = Settings { partition: Some(plan), ..settings(8) };
        let mut pass = pass(&PassConfig { method, ..PassConfig::new(settings.clone(), casters(&plain.mesh)) });
        let mut pictures = Vec::new();
        let mut made = 0;
        for (k, light) in [plain.light, lamp, plain.light, lamp].into_iter().enumerate() {
            let lit = Scene { light, ..plain.clone() };
            if k == 2 {
                made = made_here();
                pass.set_size([24, 18]).expect("another size");
                frame(&mut pass, &Inputs::new(&lit.camera, &lit.light));
                pass.set_size(SIZE).expect("the first size");
            }
            let (got, _) = frame(&mut pass, &Inputs::new(&lit.camera, &lit.light));
            if k == 3 {
                assert_eq!(made_here(), made, "{name}: pipelines are made anew");
            }
            pictures.push((lit, got));
        }
        for (k, (lit, got)) in pictures.iter().enumerate() {
            assert!(*got == rendered(lit, method, &settings), "{name}, frame {k}: another picture");
        }
        assert!(pictures[0].1 != pictures[1].1, "{name}: both lights show the same");
    }
}

/// The last complete picture stands for them too, and a G-buffer of triangle numbers tells what is seen.
#[gpu_test]
fn every_method_takes_triangle_numbers_and_keeps_its_picture() {
    let plain = scene("plant");
    let prepared = Prepared::new(&plain.mesh).expect("a sound mesh");
    let one = settings(1);
    let mut renderer = Renderer::new(gpu(), &prepared, &one, Budget::default()).expect("a renderer");
    let seen = renderer.render(&plain.camera, &plain.light).expect("a frame").triangles;
    let ids: Vec<u32> = seen.iter().map(|&t| prepared.given.get(t as usize).copied().unwrap_or(u32::MAX)).collect();
    let texture = gpu().device.create_texture_with_data(
        &gpu().queue,
        &wgpu::TextureDescriptor {
            label: Some("test"),
            size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        bytemuck::cast_slice(&ids),
    );
    let gbuffer = GBuffer::TriangleIds(TriangleTexture { texture: &texture, first: 0, none: u32::MAX });
    for method in others() {
        let name = method.name();
        let config = PassConfig { method, keep_last: true, ..PassConfig::new(one.clone(), casters(&plain.mesh)) };
        let mut pass = pass(&config);
        let (got, status) = frame(&mut pass, &Inputs { gbuffer, ..Inputs::new(&plain.camera, &plain.light) });
        assert!(got == rendered(&plain, method, &one), "{name}: another picture");
        let (found, whole) = frame(&mut pass, &Inputs::new(&plain.camera, &plain.light));
        assert!(found == got && whole.dispatches > status.dispatches, "{name}: what is seen was searched for");
        // Of several lights each takes them: no other method keeps what the camera sees.
        let config = PassConfig { keep_last: false, ..config };
        let mut several = self::pass(&config);
        let inputs = Inputs { gbuffer, ..Inputs::new(&plain.camera, &plain.light) };
        let mut encoder = gpu().encoder();
        let lights = [LightTarget::new(plain.light, Target::default()); 2];
        several.record_lights(&mut encoder, &inputs, &lights).expect("two frames");
        gpu().submit_and_wait(encoder).expect("they run");
        let dispatches = [status_of(&mut several).dispatches, status_of(&mut several).dispatches];
        assert_eq!(dispatches[0], dispatches[1], "{name}: the second light searches for what is seen");
        assert!(picture(&several) == got, "{name}: another picture of the second light");
        // Triangles that there are not are a fault, and the picture before stands.
        let none = GBuffer::TriangleIds(TriangleTexture { texture: &texture, first: 0, none: 7 });
        let mut encoder = gpu().encoder();
        let aside = turned(&plain.camera, 0.2);
        pass.record(&mut encoder, &Inputs { gbuffer: none, ..Inputs::new(&aside, &plain.light) }, &Target::default())
            .expect("a frame");
        gpu().submit_and_wait(encoder).expect("it runs");
        let status = status_of(&mut pass);
        assert!(!status.complete && status.faults.unknown_triangles > 0, "{name}: {status:?}");
        assert!(picture(&pass) == got, "{name}: the picture of a faulty frame");
    }
}

/// Casters in a vertex buffer, for methods that keep no tree of them.
#[gpu_test]
fn moved_casters_shadow_as_fresh_ones() {
    let plain = scene("windmill");
    let mut far = plain.clone();
    far.mesh.positions.iter_mut().for_each(|p| *p = [p[0] + 0.25, p[1] * 0.75, p[2]]);
    let points: Vec<[f32; 4]> = far.mesh.positions.iter().map(|p| [p[0], p[1], p[2], 0.0]).collect();
    let buffer = gpu().device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some("test"),
        contents: bytemuck::cast_slice(&points),
        usage: wgpu::BufferUsages::STORAGE,
    });
    let (low, high) = far.mesh.positions.iter().fold(([f32::MAX; 3], [f32::MIN; 3]), |(low, high), p| {
        ([0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k])))
    });
    let rest = Casters::Moving { rest: &plain.mesh.positions, triangles: &plain.mesh.triangles };
    let settings = settings(8);
    for method in others() {
        let name = method.name();
        let config = PassConfig { method, ..PassConfig::new(settings.clone(), rest) };
        if matches!(method, MethodName::RayTraced | MethodName::Supersampled) {
            let refused = ShadowPass::new(&gpu().device, &gpu().queue, &config).err().map(|e| e.to_string());
            assert!(refused.is_some_and(|text| text.contains(name) && text.contains("cannot move")), "{name}");
            let standing = PassConfig { method, ..PassConfig::new(settings.clone(), casters(&plain.mesh)) };
            assert!(pass(&standing).set_casters(&rest).is_err(), "{name}");
            continue;
        }
        let mut pass = pass(&config);
        let vertices = Vertices { buffer: &buffer, offset: 0, stride: 16 };
        let moved = Some(Moved { vertices, bounds: [low, high] });
        let (got, status) = frame(&mut pass, &Inputs { moved, ..Inputs::new(&far.camera, &far.light) });
        let want = rendered(&far, method, &settings);
        // The view holds the box, which is wider: shadows are where they were, their texels are others.
        let off = |a: &Picture, b: &Picture| {
            let far = |(a, b): &(&u32, &u32)| (f32::from_bits(**a) - f32::from_bits(**b)).abs() > 0.5;
            a.0.iter().zip(&b.0).filter(far).count()
        };
        let unmoved = rendered(&plain, method, &settings);
        let [off, away] = [off(&got, &want), off(&unmoved, &want)];
        assert!(off * 20 < want.0.len() && off * 2 < away, "{name}: {off} pixels differ, {away} unmoved, {status:?}");
    }
}

#[gpu_test]
fn what_a_method_cannot_do_is_refused() {
    let plain = scene("windmill");
    let refused = |what: &str, result: Result<(), Error>| {
        assert!(matches!(result, Err(Error::Config(_) | Error::Scene(_))), "{what}: {result:?}");
    };
    for method in others() {
        let name = method.name();
        let config = PassConfig { method, ..PassConfig::new(settings(8), casters(&plain.mesh)) };
        let receivers = PassConfig { receivers: true, ..config.clone() };
        refused(name, ShadowPass::new(&gpu().device, &gpu().queue, &receivers).map(drop));
        let mut pass = pass(&config);
        let mut record = |light: &Light, target: &Target| {
            let mut encoder = gpu().encoder();
            pass.record(&mut encoder, &Inputs::new(&plain.camera, light), target).map(drop)
        };
        // A light among its casters has a cube of views.
        record(&Light::Point { position: [0.0, 0.5, 0.0] }, &Target::default()).expect("a cube of views");
        let lit = gpu().device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("test"),
            size: 4 * u64::from(SIZE[0] * SIZE[1]),
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let kept = record(&plain.light, &Target { lit: Some(&lit), ..Target::default() });
        let keeps = !rendered(&plain, method, &settings(8)).1.is_empty();
        assert_eq!(kept.is_ok(), keeps, "{name}: {kept:?}");
    }
}

/// Slices of the view in a pass, with what is seen found or given: the same bits as one view. A camera that moves moves them.
#[gpu_test]
fn slices_follow_the_camera() {
    let plain = scene("windmill");
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = Settings { facets, ..settings(8) };
        let plan = SplitPlan { splits: 2, warp: Warp::Fitted, focus: 0.6, ..SplitPlan::default() };
        let sliced = Settings { partition: Some(plan), ..settings.clone() };
        let [mut one, mut several] =
            [settings, sliced].map(|settings| pass(&PassConfig::new(settings, casters(&plain.mesh))));
        for by in [0.0, 0.3, 0.9] {
            let camera = turned(&plain.camera, by);
            let inputs = Inputs::new(&camera, &plain.light);
            let [(want, whole), (got, status)] = [frame(&mut one, &inputs), frame(&mut several, &inputs)];
            assert!(got.0 == want.0 && (facets == FacetMode::One || got.1 == want.1), "{facets:?}, {by}");
            assert!(status.dispatches > whole.dispatches, "{facets:?}: one view");
            assert!(one.capacities().views == 1 && several.capacities().views > 1);
        }
    }
}

/// A frame in which nothing can be seen, or nothing can cast, is that of all stages, with a fraction of the dispatches; the frame after it
/// is whole again.
#[gpu_test]
fn what_a_frame_does_not_need_is_left_out() {
    let triangles = [[0, 1, 2], [0, 2, 3]];
    let corners = [[-3.0, 0.0, -3.0], [-3.0, 0.0, 3.0], [3.0, 0.0, 3.0], [3.0, 0.0, -3.0]];
    let camera = Camera { eye: [0.5, 2.0, 6.0], target: [0.0, 0.0, 0.0], ..scene("plane").camera };
    let away = Camera { target: [0.5, 2.0, 60.0], ..camera };
    let (sun, below) =
        (Light::Directional { direction: [0.3, 1.0, 0.2] }, Light::Directional { direction: [0.3, -1.0, 0.2] });
    let lamp = Light::Point { position: [0.4, 1.3, 0.2] };
    let flat = Casters::Static { positions: &corners, triangles: &triangles };
    let body = scene("spheres");
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = Settings { facets, ..settings(8) };
        let config = PassConfig::new(settings.clone(), flat);
        let [mut proves, mut does_not] = [true, false].map(|prove| pass(&PassConfig { prove, ..config.clone() }));
        let mut check = |what: &str, camera: &Camera, light: &Light, left_out: bool| {
            let inputs = Inputs::new(camera, light);
            let (want, whole) = frame(&mut does_not, &inputs);
            let (got, status) = frame(&mut proves, &inputs);
            assert!(got == want, "{facets:?}, {what}: another picture");
            let few = status.dispatches * 3 < whole.dispatches * 2;
            assert!(few || status.dispatches == whole.dispatches, "{facets:?}, {what}");
            assert_eq!(few, left_out, "{facets:?}, {what}: {} of {}", status.dispatches, whole.dispatches);
            let pixels = u64::from(SIZE[0] * SIZE[1]);
            assert!(
                status.counts.facets >= pixels && status.counts.facets == whole.counts.facets,
                "{facets:?}, {what}"
            );
            got
        };
        let lit = check("in one plane", &camera, &sun, true);
        assert!(lit.0.iter().all(|v| *v == 1.0f32.to_bits()));
        check("a lamp over it", &camera, &lamp, true);
        // One facet a pixel, its samples off the surface: all that is seen is dark. Of every surface the plan does not claim it.
        let dark = check("lit from below", &camera, &below, facets == FacetMode::One);
        assert!(dark.0.contains(&0));
        let none = check("looking away", &away, &sun, true);
        assert!(none == lit || none.0 == lit.0);
        check("in one plane again", &camera, &sun, true);
        for pass in [&mut proves, &mut does_not] {
            pass.set_casters(&casters(&body.mesh)).expect("other casters");
        }
        let shadows = {
            let inputs = Inputs::new(&body.camera, &body.light);
            let [(a, whole), (b, status)] = [frame(&mut does_not, &inputs), frame(&mut proves, &inputs)];
            assert!(a == b && whole.dispatches == status.dispatches, "{facets:?}: something was left out");
            a
        };
        assert!(shadows.0.contains(&0));
    }
}
