//! Orthographic cameras: frames of a mapped world, held against rays of the world itself.

use super::*;
use crate::frames::{Eye, ORIGIN, draw, turned_round, where_truth_is_sure, wrong};
use crate::receivers::judged;
use glam::camera::{lh::proj::directx as lh, lh::view as left_view, rh::proj::directx as rh, rh::view as right_view};
use glam::{DVec2, Mat4};
use subpixel_shadows::gpu::Recorder;
use subpixel_shadows::pass::{CasterMesh, LightTarget, Placed, Transforms};
use subpixel_shadows::scene::{AreaLight, Lens, Orthographic, OrthographicView};
use subpixel_shadows::stages::instance_positions::InstancePositions;

/// Share of a pixel within which a sample may see or be lit otherwise.
const BAND: f64 = 1.0 / 256.0;
const SAME: [[f32; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// A scene as one instance of its mesh.
struct Instanced {
    scene: Scene,
    transforms: wgpu::Buffer,
    bounds: [[f32; 3]; 2],
}

impl Instanced {
    fn new(name: &str) -> Self {
        Self::of(scene(name))
    }

    fn of(scene: Scene) -> Self {
        let transforms = Buffer::<[[f32; 4]; 3]>::from_slice(&gpu().device, &gpu().queue, "test.transforms", &[SAME]);
        let (low, high) = scene.mesh.bounds().expect("a mesh");
        let bounds = [low, high].map(|p| p.as_vec3().into());
        Self { scene, transforms: transforms.expect("memory").raw().clone(), bounds }
    }

    fn pass(&self, settings: Settings) -> ShadowPass {
        self.pass_of(MethodName::FacetMasks, settings)
    }

    fn pass_of(&self, method: MethodName, settings: Settings) -> ShadowPass {
        let Scene { mesh, alpha, .. } = &self.scene;
        let alpha = Some(alpha).filter(|alpha| !alpha.is_empty());
        let settings = Settings { alpha_tested: alpha.is_some(), ..settings };
        let meshes = [CasterMesh { alpha, ..CasterMesh::new(&mesh.positions, &mesh.triangles) }];
        let casters = Casters::Instanced { meshes: &meshes, instances: &[0] };
        let receivers = method == MethodName::FacetMasks;
        let config = PassConfig { method, receivers, ..PassConfig::new(settings, casters) };
        ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
    }

    fn inputs<'a>(&'a self, view: &'a OrthographicView, light: &'a Light) -> Inputs<'a> {
        let transforms = Transforms { buffer: &self.transforms, offset: 0 };
        Inputs { placed: Some(Placed { transforms, bounds: self.bounds }), ..Inputs::orthographic(view, light) }
    }

    /// The mesh of the mapped world, as the pass has it.
    fn mapped(&self, view: &OrthographicView) -> Mesh {
        let (device, queue) = (&gpu().device, &gpu().queue);
        let padded = |&[x, y, z]: &[f32; 3]| [x, y, z, 0.0];
        let vertices: Vec<_> = self.scene.mesh.positions.iter().map(padded).collect();
        let vertices = Buffer::from_slice(device, queue, "test.vertices", &vertices).expect("memory");
        let sources: Vec<_> = (0..vertices.len() as u32).map(|v| [v, 0]).collect();
        let sources = Buffer::from_slice(device, queue, "test.sources", &sources).expect("memory");
        let positions = Buffer::<[f32; 4]>::storage(device, "test.positions", vertices.len()).expect("memory");
        let faults = Buffer::<u32>::storage(device, "test.faults", 1).expect("memory");
        let bounds = view.homography.bounds(self.bounds).expect("a box");
        let (to, transforms) = ((bounds, view.homography), Transforms { buffer: &self.transforms, offset: 0 });
        let stage = InstancePositions::new(device);
        let mut encoder = gpu().encoder();
        let rec = &mut Recorder::new(device, &mut encoder, None);
        let recorded =
            stage.record(&mut rec.stage("test"), (transforms, 1), &sources, &vertices, to, (&positions, 0), &faults);
        recorded.expect("recorded");
        gpu().submit_and_wait(encoder).expect("the stage runs");
        assert_eq!(faults.read(gpu()).expect("readback"), [0]);
        let positions = positions.read(gpu()).expect("readback").iter().map(|&[x, y, z, _]| [x, y, z]).collect();
        Mesh { positions, triangles: self.scene.mesh.triangles.clone() }
    }

    /// A camera that looks at the scene as its own does, its image so high as that of the other at the target.
    fn camera(&self) -> Orthographic {
        let Camera { eye, target, up, vertical_fov_degrees, .. } = self.scene.camera;
        let tan = (0.5 * vertical_fov_degrees.to_radians()).tan();
        Orthographic::look_at(eye, target, up, 1.8 * tan * Vec3::from(eye).distance(Vec3::from(target)))
    }
}

/// Whether what a ray of the world sees is lit, and whether light nearly shines along it: what is mapped does not tell from which side.
fn traced(tracer: &Tracer, light: &Light, (from, way): (DVec3, DVec3), near: f64) -> Option<(bool, bool)> {
    let hit = tracer.closest(from, way, near)?;
    let [a, b, c] = tracer.corners(hit.triangle);
    let (normal, place) = ((b - a).cross(c - a), from + way * hit.t);
    let to_light = light.towards(place).normalize();
    let sine = normal.normalize().dot(to_light);
    let faces = normal.dot(-way) * sine > 0.0;
    let shade = tracer.shade(place, hit.error, light.homogeneous(), &|t| t == hit.triangle);
    let grazed = (1e-9..1e-3).contains(&sine.abs());
    Some((faces && !shade.occluded, grazed))
}

/// Pixels with another visibility than rays of the world say, of those that are compared: of whose samples each sees and is lit alike by every ray within
/// the band.
fn held(got: &Picture, tracer: &Tracer, camera: &Orthographic, light: &Light, samples: &Samples) -> [usize; 2] {
    held_within(1e-4, got, tracer, (camera, light), samples)
}

/// Likewise of visibilities that may be off by as much.
fn held_within(
    off: f32,
    got: &Picture,
    tracer: &Tracer,
    (camera, light): (&Orthographic, &Light),
    samples: &Samples,
) -> [usize; 2] {
    let mut out = [0; 2];
    for pixel in 0..PIXELS {
        let corner = DVec2::new((pixel % SIZE[0] as usize) as f64, (pixel / SIZE[0] as usize) as f64);
        let sees = |at: DVec2| traced(tracer, light, camera.ray(at.into(), SIZE), f64::from(camera.near));
        let sample = |offset: &[f32; 2]| {
            let at = corner + DVec2::from(offset.map(f64::from));
            let wanted = sees(at);
            let alike = |x: f64, y: f64| sees(at + DVec2::new(x, y)) == wanted;
            let sure = [-BAND, BAND].iter().all(|&x| [-BAND, BAND].iter().all(|&y| alike(x, y)));
            (sure && !wanted.is_some_and(|(_, grazed)| grazed)).then_some(wanted.map(|(lit, _)| lit))
        };
        let Some(wanted) = samples.offsets().iter().map(sample).collect::<Option<Vec<_>>>() else { continue };
        let [seen, lit] = [wanted.iter().flatten().count(), wanted.iter().flatten().filter(|lit| **lit).count()];
        let visibility = if seen == 0 { 1.0 } else { lit as f32 / seen as f32 };
        out[0] += usize::from((got.visibility[pixel] - visibility).abs() > off);
        out[1] += 1;
    }
    out
}

/// Every sample of the pass's own search is lit as a parallel ray of the world says, from outside and inside, with jitter, mirrored, cut open, under
/// lights at infinity, at a point, and behind the camera.
#[gpu_test]
fn every_sample_is_that_of_a_parallel_ray() {
    let lens = Lens { shift: [0.2, -0.1], pixel_aspect: 1.25, mirrored: true };
    for name in ["spheres", "windmill"] {
        let world = Instanced::new(name);
        let settings = settings(FacetMode::All, 8);
        let samples = settings.samples.clone();
        let mut pass = world.pass(settings);
        let tracer = Tracer::new(&world.scene.mesh).expect("a tracer");
        let camera = world.camera();
        let middle = Vec3::from(camera.eye).distance(Vec3::from(camera.target));
        let [low, high] = world.bounds.map(Vec3::from);
        let lamp = Light::Point { position: (0.5 * (low + high) + Vec3::Y * (high.y - low.y)).into() };
        let behind = Light::Directional {
            direction: (Vec3::from(camera.eye) - Vec3::from(camera.target) + 0.4 * Vec3::Y).into(),
        };
        let jittered = Orthographic { lens: camera.lens.jittered([0.3, -0.4], SIZE), ..camera };
        for (view_name, camera, light) in [
            ("straight", camera, world.scene.light),
            ("mirrored and jittered, a lamp", Orthographic { lens, ..jittered }, lamp),
            ("cut open", Orthographic { near: middle, ..camera }, world.scene.light),
            ("light behind", Orthographic { height: 0.4 * camera.height, ..camera }, behind),
        ] {
            let view = camera.in_world(world.bounds, &[light], SIZE).expect("a view");
            let (got, status) = frame(&mut pass, &world.inputs(&view, &light));
            assert!(status.complete, "{name}, {view_name}: {status:?}");
            let [off, compared] = held(&got, &tracer, &camera, &light, &samples);
            assert!(off == 0 && compared > 4000, "{name}, {view_name}: {off} of {compared} pixels wrong");
            let partly = got.visibility.iter().filter(|&&v| v > 0.0 && v < 1.0).count();
            assert!(partly > 100, "{name}, {view_name}: {partly} pixels partly in shadow");
            // The comparison must notice another camera.
            let moved = Orthographic { height: 1.02 * camera.height, ..camera };
            let [off, _] = held(&got, &tracer, &moved, &light, &samples);
            assert!(off > 50, "{name}, {view_name}: a picture of another height passes");
        }
    }
}

/// Holes of alpha-tested casters lie where the world has them: seen, and in their shadows, also where light and camera are near to the cards and the
/// map of the world is steep.
#[gpu_test]
fn holes_are_those_of_the_world() {
    let world = Instanced::new("leaves");
    let mut pass = world.pass(settings(FacetMode::All, 8));
    let samples = pass.settings().samples.clone();
    let tracer = Tracer::with_alpha(&world.scene.mesh, &world.scene.alpha).expect("a tracer");
    let solid = Tracer::new(&world.scene.mesh).expect("a tracer");
    let camera = world.camera();
    let [eye, target] = [camera.eye, camera.target].map(Vec3::from);
    let steep = Light::Directional { direction: ((target - eye).normalize() + 0.3 * Vec3::Y).into() };
    let lamp = Light::Point { position: (target + 0.6 * (target - eye).length() * Vec3::Y).into() };
    for (view_name, camera, light) in [
        ("its own light", camera, world.scene.light),
        ("light ahead, close", Orthographic { height: 0.5 * camera.height, ..camera }, steep),
        ("a lamp", camera, lamp),
    ] {
        let view = camera.in_world(world.bounds, &[light], SIZE).expect("a view");
        let (got, status) = frame(&mut pass, &world.inputs(&view, &light));
        assert!(status.complete, "{view_name}: {status:?}");
        let [off, compared] = held(&got, &tracer, &camera, &light, &samples);
        assert!(off == 0 && compared > 2000, "{view_name}: {off} of {compared} pixels wrong");
        let [off, _] = held(&got, &solid, &camera, &light, &samples);
        assert!(off > 50, "{view_name}: without the holes {off} pixels are wrong");
    }
}

/// A floor, and over it one card from its near end to its far one, with sixteen slits across.
fn slits() -> Scene {
    let square = |y: f32, by: f32| [[-by, y, by], [by, y, by], [by, y, -by], [-by, y, -by]];
    let mesh = Mesh {
        positions: [square(0.0, 4.0), square(1.0, 3.0)].concat(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
    };
    let map = AlphaMap {
        size: [1, 2],
        alpha: vec![255, 0],
        cutoff: 0.5,
        filter: AlphaFilter::Nearest,
        wrap: [AlphaWrap::Repeat; 2],
    };
    let card = |triangle, uv| TestedTriangle { triangle, map: 0, uv, roles: Roles::ALL };
    let [near, far] = [[[0.0, 0.0], [1.0, 0.0]], [[0.0, 16.0], [1.0, 16.0]]];
    let triangles = vec![card(2, [near[0], near[1], far[1]]), card(3, [near[0], far[1], far[0]])];
    let camera = Camera { eye: [0.5, 9.0, 7.0], target: [0.0, 0.0, 0.0], ..scene("plane").camera };
    let light = Light::Directional { direction: [0.8, 1.0, 0.5] };
    Scene { mesh, alpha: AlphaTested { maps: vec![map], triangles }, camera, light, ..scene("plane") }
}

/// Holes lie there for every method of maps that casters may move in: of pixels that are wholly lit or dark next to none is nearer to the other. Where the
/// card's corners share its holes as in the mapped world, 457 to 738 are.
#[gpu_test]
fn holes_are_those_of_the_world_for_every_method() {
    let world = Instanced::of(slits());
    let scene = &world.scene;
    let tracer = Tracer::with_alpha(&scene.mesh, &scene.alpha).expect("a tracer");
    let solid = Tracer::new(&scene.mesh).expect("a tracer");
    let camera = Orthographic { height: 7.0, ..world.camera() };
    let lamp = Light::Point { position: [0.5, 6.0, 1.0] };
    for (method, omni) in [
        (MethodName::ShadowMap, OmniMaps::Planes),
        (MethodName::ShadowMap, OmniMaps::Paraboloids),
        (MethodName::ResolutionMatched, OmniMaps::Planes),
        (MethodName::Rectilinear, OmniMaps::Planes),
        (MethodName::Reconstructable, OmniMaps::Planes),
    ] {
        let mut pass = world.pass_of(method, Settings { map: 1024, omni, ..settings(FacetMode::One, 8) });
        let samples = pass.settings().samples.clone();
        for light in [scene.light, lamp].into_iter().skip(usize::from(omni == OmniMaps::Paraboloids)) {
            let view = camera.in_world(world.bounds, &[light], SIZE).expect("a view");
            let (got, status) = frame(&mut pass, &world.inputs(&view, &light));
            assert!(status.complete, "{method:?}: {status:?}");
            let [off, compared] = held_within(0.5, &got, &tracer, (&camera, &light), &samples);
            assert!(off <= 20 && compared > 4000, "{method:?}, {omni:?}: {off} of {compared} pixels wrong");
            let [off, _] = held_within(0.5, &got, &solid, (&camera, &light), &samples);
            assert!(off > 200, "{method:?}, {omni:?}: without the holes {off} pixels are wrong");
        }
    }
}

/// Frames that an application's rasterizer drew with orthographic matrices: its numbers and its depths.
#[gpu_test]
fn frames_of_an_application_are_exact() {
    let world = Instanced::new("windmill");
    let own = world.camera();
    let (eye, target, up) = (Vec3::from(own.eye), Vec3::from(own.target), Vec3::from(own.up));
    let (right, left) = (right_view::look_at_mat4(eye, target, up), left_view::look_at_mat4(eye, target, up));
    let [wide, tall] = [0.5 * own.height * SIZE[0] as f32 / SIZE[1] as f32, 0.5 * own.height];
    let middle = (target - eye).length();
    let plain = rh::orthographic(-wide, wide, -tall, tall, 0.9 * middle, 2.0 * middle);
    let jitter = Mat4::from_translation(Vec3::new(0.7 / SIZE[0] as f32, -0.5 / SIZE[1] as f32, 0.0));
    let mut pass = world.pass(Settings { settle: false, ..settings(FacetMode::One, 32) });
    for (eye, reversed) in [
        (Eye { name: "standard", view: right, projection: plain, nothing: 1.0 }, false),
        (Eye { name: "reversed, jittered", view: right, projection: turned_round(jitter * plain), nothing: 0.0 }, true),
        (
            Eye {
                name: "left-handed, off-centre, from behind",
                view: left,
                projection: lh::orthographic(-0.7 * wide, 1.2 * wide, -tall, 0.8 * tall, -middle, 3.0 * middle),
                nothing: 1.0,
            },
            false,
        ),
    ] {
        let (drawn, light) = (draw(&world.scene.mesh, &eye), world.scene.light);
        let [view, projection] = [eye.view, eye.projection].map(|m| m.to_cols_array_2d());
        let camera = Orthographic::of_matrices(&view, &projection, reversed, SIZE).expect(eye.name);
        let view = camera.in_world(world.bounds, &[light], SIZE).expect(eye.name);
        let mesh = world.mapped(&view);
        let there = view.homography.light(&light).expect("a light");
        let scene = Scene { camera: view.camera, light: there, mesh, ..world.scene.clone() };
        let seen = Raster { triangles: drawn.triangles(), points: Vec::new() };
        let mut truth = judged(&seen, &scene.mesh, &scene, pass.settings());
        where_truth_is_sure(&mut truth, &scene, &pass.settings().samples);
        assert!(truth.len() > 1500, "{}: {} pixels show something", eye.name, truth.len());
        let plain = Inputs { origin: Some(ORIGIN), ..world.inputs(&view, &light) };
        let numbers = GBuffer::TriangleIds(TriangleTexture::new(&drawn.ids));
        let (got, status) = frame(&mut pass, &Inputs { gbuffer: numbers, ..plain });
        assert!(status.complete, "{}: {status:?}", eye.name);
        let [outside, inside] = wrong(&got, &truth);
        assert_eq!(outside, 0, "{}: {outside} samples wrong, {inside} in the band", eye.name);
        let terms = DepthTerms::orthographic(&view, reversed);
        let place = SurfacePosition::Depth { texture: &drawn.depth, terms, nothing: eye.nothing };
        let by_depth = Inputs { gbuffer: GBuffer::Surfaces(SurfaceTextures::new(place)), ..plain };
        let (picture, status) = frame(&mut pass, &by_depth);
        assert!(status.complete, "{}: {status:?}", eye.name);
        let off = (0..PIXELS).filter(|&p| picture.visibility[p] != got.visibility[p]).count();
        assert!(off * 500 <= PIXELS, "{}: {off} pixels differ by depth", eye.name);
        // Depths of another camera are refused.
        let other = Orthographic { height: 1.1 * camera.height, ..camera };
        let other = other.in_world(world.bounds, &[light], SIZE).expect("a view");
        let place = SurfacePosition::Depth {
            texture: &drawn.depth,
            terms: DepthTerms::orthographic(&other, reversed),
            nothing: eye.nothing,
        };
        let by_depth = Inputs { gbuffer: GBuffer::Surfaces(SurfaceTextures::new(place)), ..plain };
        refused("depth terms", pass.record(&mut gpu().encoder(), &by_depth, &Target::default()));
        let mut moved = got.clone();
        moved.lit.rotate_right(1);
        assert!(wrong(&moved, &truth)[0] > 1000, "{}: a moved picture passes", eye.name);
    }
}

/// A ground that is given by its depth has, with a facet for every surface, the shadows that it has as an instance.
#[gpu_test]
fn a_ground_by_its_depth_is_one_of_the_world() {
    let (all, casters, scene) = grounded("windmill", 0.01);
    // The view holds the whole ground: in a small map all else would be two texels.
    let settings = || Settings { map: 512, ..settings(FacetMode::All, 32) };
    let whole = Instanced::of(Scene { mesh: all.clone(), ..scene.clone() });
    let part = Instanced { bounds: whole.bounds, ..Instanced::of(Scene { mesh: casters, ..scene.clone() }) };
    let own = whole.camera();
    let (eye, target, up) = (Vec3::from(own.eye), Vec3::from(own.target), Vec3::from(own.up));
    let [wide, tall] = [0.5 * own.height * SIZE[0] as f32 / SIZE[1] as f32, 0.5 * own.height];
    let far = 4.0 * (target - eye).length();
    let projection = rh::orthographic(-wide, wide, -tall, tall, 0.0, far);
    let eye = Eye { name: "a ground", view: right_view::look_at_mat4(eye, target, up), projection, nothing: 1.0 };
    let [view, projection] = [eye.view, eye.projection].map(|m| m.to_cols_array_2d());
    let camera = Orthographic::of_matrices(&view, &projection, false, SIZE).expect("a camera");
    let view = camera.in_world(whole.bounds, &[scene.light], SIZE).expect("a view");
    let (want, _) = frame(&mut whole.pass(settings()), &whole.inputs(&view, &scene.light));
    let drawn = draw(&all, &eye);
    let terms = DepthTerms::orthographic(&view, false);
    let place = SurfacePosition::Depth { texture: &drawn.depth, terms, nothing: eye.nothing };
    let gbuffer = GBuffer::Surfaces(SurfaceTextures::new(place));
    let inputs = Inputs { gbuffer, origin: Some(ORIGIN), ..part.inputs(&view, &scene.light) };
    let (got, status) = frame(&mut part.pass(settings()), &inputs);
    assert!(status.complete, "{status:?}");
    let off =
        |got: &Picture| (0..PIXELS).filter(|&p| (got.visibility[p] - want.visibility[p]).abs() * 32.0 > 1.5).count();
    assert!(off(&got) <= 32, "{} pixels are off", off(&got));
    let (bare, _) = frame(&mut part.pass(settings()), &part.inputs(&view, &scene.light));
    assert!(off(&bare) > 300, "without the ground {} pixels are off", off(&bare));
}

/// Several lights of one world and one camera: each as recorded by itself, to the bit; and the points of a sun of some extent.
#[gpu_test]
fn several_lights_share_a_world() {
    let world = Instanced::new("spheres");
    let lights = [world.scene.light, Light::Directional { direction: [-0.3, 1.0, 0.9] }];
    let view = world.camera().in_world(world.bounds, &lights, SIZE).expect("a view");
    let mut pass = world.pass(settings(FacetMode::All, 8));
    let alone = lights.each_ref().map(|light| frame(&mut pass, &world.inputs(&view, light)).0);
    let bytes = 4 * PIXELS as u64;
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    let of = |_| {
        gpu().device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes,
            usage,
            mapped_at_creation: false,
        })
    };
    let lit = [0, 1].map(of);
    let to = [0, 1].map(|k| LightTarget::new(lights[k], Target { lit: Some(&lit[k]), ..Target::default() }));
    for _ in 0..4 {
        let mut encoder = gpu().encoder();
        pass.record_lights(&mut encoder, &world.inputs(&view, &lights[0]), &to).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        while pass.status().is_some() {}
    }
    let together = lit.each_ref().map(read);
    let alone = alone.map(|picture| picture.lit[..PIXELS].to_vec());
    assert!(together == alone, "lights together are not those alone");
    assert_ne!(together[0], together[1]);
    // The mean over points of a sun: of four, each a frame.
    let area = AreaLight { light: lights[1], radius: 3.0, points: 4 };
    let [low, high] = world.bounds.map(|p| Vec3::from(p).as_dvec3());
    let points = area.points(0.5 * (low + high));
    let view = world.camera().in_world(world.bounds, &points, SIZE).expect("a view");
    let each: Vec<Vec<f32>> =
        points.iter().map(|light| frame(&mut pass, &world.inputs(&view, light)).0.visibility).collect();
    for _ in 0..4 {
        let mut encoder = gpu().encoder();
        let inputs = world.inputs(&view, &lights[1]);
        pass.record_area(&mut encoder, &inputs, &area, &Target::default()).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        while pass.status().is_some() {}
    }
    let mean: Vec<f32> = bytemuck::cast_vec(read(pass.visibility()));
    let off = |p: usize| (mean[p] - 0.25 * each.iter().map(|of| of[p]).sum::<f32>()).abs() > 1e-5;
    let soft = mean[..PIXELS].iter().filter(|&&v| v > 0.0 && v < 1.0).count();
    assert_eq!((0..PIXELS).filter(|&p| off(p)).count(), 0);
    assert!(soft > 200, "{soft} pixels partly lit");
}

/// Walls that the light shines along are dark, whichever way rounding turns what was mapped.
#[gpu_test]
fn what_a_light_shines_along_is_dark() {
    let corner = |k: u32| [(k & 1) as f32 - 0.5, (k >> 1 & 1) as f32, (k >> 2 & 1) as f32 - 0.5];
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<_> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mut mesh = Mesh::default();
    for k in 0..9u32 {
        let at = [(k % 3) as f32 * 1.7 - 1.9, 0.0, (k / 3) as f32 * 1.7 - 1.6];
        mesh.triangles.extend(triangles.iter().map(|t| t.map(|v| v + 8 * k)));
        mesh.positions.extend((0..8).map(|v| [0, 1, 2].map(|axis| corner(v)[axis] + at[axis])));
    }
    let scene = Scene { mesh, light: Light::Directional { direction: [0.0, 1.0, 0.0] }, ..scene("spheres") };
    let world = Instanced::of(scene);
    let camera = Orthographic::look_at([9.0, 8.0, 7.0], [0.0, 0.4, 0.0], [0.0, 1.0, 0.0], 6.0);
    let tracer = Tracer::new(&world.scene.mesh).expect("a tracer");
    let mut pass = world.pass(settings(FacetMode::All, 8));
    for direction in [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0]] {
        let light = Light::Directional { direction };
        let view = camera.in_world(world.bounds, &[light], SIZE).expect("a view");
        let (got, _) = frame(&mut pass, &world.inputs(&view, &light));
        let [off, compared] = held(&got, &tracer, &camera, &light, &pass.settings().samples);
        assert!(off == 0 && compared > 3500, "{direction:?}: {off} of {compared} pixels wrong");
    }
}

/// Inputs that a mapped world cannot have are refused before anything is recorded.
#[gpu_test]
fn what_is_not_mapped_is_refused() {
    let world = Instanced::new("spheres");
    let light = world.scene.light;
    let view = world.camera().in_world(world.bounds, &[light], SIZE).expect("a view");
    let told = |pass: &mut ShadowPass, inputs: Inputs, word: &str| {
        let told = pass.record(&mut gpu().encoder(), &inputs, &Target::default()).map_err(|e| e.to_string());
        assert!(told.as_ref().is_err_and(|e| e.contains(word) && !e.contains('\n')), "{word}: {told:?}");
    };
    let mut standing = pass(settings(FacetMode::All, 8), &world.scene.mesh);
    told(&mut standing, Inputs::orthographic(&view, &light), "as instances");
    let mut one = world.pass(settings(FacetMode::One, 8));
    let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, &[]);
    let place = SurfacePosition::Position(&positions);
    let gbuffer = GBuffer::Surfaces(SurfaceTextures::new(place));
    told(&mut one, Inputs { gbuffer, ..world.inputs(&view, &light) }, "positions and normals");
    let away = Vec3::from(world.camera().target) - Vec3::from(world.camera().eye);
    let against = Light::Directional { direction: (away + 0.2 * away.length() * Vec3::X).into() };
    told(&mut one, world.inputs(&view, &against), "other lights");
    let mut towards = world.inputs(&view, &light);
    let [low, high] = world.bounds.map(Vec3::from);
    let before = high.max(0.5 * (low + high) - 100.0 * away);
    towards.placed = towards.placed.map(|placed| Placed { bounds: [low.into(), before.into()], ..placed });
    told(&mut one, towards, "given as smaller");
    let mut smaller = world.inputs(&view, &light);
    smaller.placed = smaller.placed.map(|placed| Placed { bounds: [[-1e9; 3], [1e9; 3]], ..placed });
    told(&mut one, smaller, "smaller world");
    // A box that does not hold the casters makes the frame incomplete, as of any that move.
    let mut tight = world.inputs(&view, &light);
    let [low, high] = world.bounds;
    let cut = [low, [0, 1, 2].map(|k| low[k] + 0.5 * (high[k] - low[k]))];
    tight.placed = tight.placed.map(|placed| Placed { bounds: cut, ..placed });
    let (_, status) = frame(&mut one, &tight);
    assert!(!status.complete && status.faults != Faults::default(), "{status:?}");
}
