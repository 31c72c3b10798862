//! A facet for every surface, of which some are known by depth or position alone.

use super::frames::{ORIGIN, draw, draw_samples, eyes};
use super::*;
use subpixel_shadows::scene::{AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Roles, TestedTriangle};

fn with_receivers(settings: Settings, mesh: &Mesh, strips: u32) -> ShadowPass {
    let casters = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
    let config = PassConfig { receivers: true, strips, ..PassConfig::new(settings, casters) };
    ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
}

/// Pixels in which more than one sample of 32 differs.
fn off(got: &Picture, want: &Picture) -> usize {
    (0..PIXELS).filter(|&p| (got.visibility[p] - want.visibility[p]).abs() * 32.0 > 1.5).count()
}

/// A ground that is given by its depth has, with a facet for every surface, the shadows that it has as a caster, also between and behind casters
/// smaller than a pixel.
#[gpu_test]
fn a_ground_by_its_depth_is_one_among_the_casters() {
    let mut in_shadow = 0;
    for (name, among) in
        [("bicycle", None), ("spheres", Some([0.8, 1.9, 0.9])), ("plant", Some([0.3, 1.3, 0.2])), ("windmill", None)]
    {
        let (all, casters, scene) = grounded(name, 0.01);
        let seen = raster(&all, &scene.camera);
        let terms = DepthTerms::reversed_infinite(0.1);
        let depth = floats(TextureFormat::R32Float, &seen.depths(terms, 0.0));
        let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
        let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
        let ids = seen.ids(casters.triangles.len());
        let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&ids));
        let by_depth = SurfaceTextures::new(SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 });
        let by_position = SurfaceTextures::new(SurfacePosition::Position(&positions));
        let (normals, ids) = (Some(&normals), Some(TriangleTexture::new(&ids)));
        let mut as_caster = pass(settings(FacetMode::All, 32), &all);
        let mut every = with_receivers(settings(FacetMode::All, 32), &casters, 1);
        let mut one = with_receivers(settings(FacetMode::One, 32), &casters, 1);
        let lights = [[0.5, 1.0, 0.3], [-0.6, 0.4, 0.8]].map(|direction| Light::Directional { direction });
        for light in lights.into_iter().chain(among.map(|position| Light::Point { position })) {
            let plain = Inputs::new(&scene.camera, &light);
            let (want, _) = frame(&mut as_caster, &plain);
            in_shadow += (0..PIXELS).filter(|&p| want.visibility[p] < 1.0).count();
            for (what, given, most) in [
                ("depth", by_depth, 32),
                ("depth, normals", SurfaceTextures { normals, ..by_depth }, 24),
                ("position, normals, numbers", SurfaceTextures { normals, ids, ..by_position }, 24),
                ("depth, numbers", SurfaceTextures { ids, ..by_depth }, 32),
            ] {
                let inputs = Inputs { gbuffer: GBuffer::Surfaces(given), ..plain };
                let (got, status) = frame(&mut every, &inputs);
                let (poor, _) = frame(&mut one, &inputs);
                let counts = [off(&got, &want), off(&poor, &want)];
                println!("{name} {light:?}, {what}: {counts:?} pixels are off");
                assert!(status.complete, "{name}, {what}: {status:?}");
                assert!(counts[0] <= most, "{name}, {light:?}, {what}: {} pixels", counts[0]);
                assert!(counts[1] > 100, "{name}, {light:?}, {what}: one facet a pixel is as good");
            }
        }
    }
    assert!(in_shadow > 10_000, "{in_shadow} pixels in shadow");
}

/// The same with depths that the hardware's rasterizer wrote, by every kind of projection.
#[gpu_test]
fn a_ground_in_frames_of_an_application() {
    for name in ["spheres", "windmill"] {
        let (all, casters, scene) = grounded(name, 0.01);
        let mut as_caster = pass(settings(FacetMode::All, 32), &all);
        let mut every = with_receivers(settings(FacetMode::All, 32), &casters, 1);
        for eye in eyes(&scene) {
            let (camera, drawn) = (eye.camera(), draw(&all, &eye));
            let plain = Inputs { origin: Some(ORIGIN), ..Inputs::new(&camera, &scene.light) };
            let (want, _) = frame(&mut as_caster, &Inputs { origin: None, ..plain });
            let place = SurfacePosition::Depth { texture: &drawn.depth, terms: eye.terms(), nothing: eye.nothing };
            let gbuffer = GBuffer::Surfaces(SurfaceTextures::new(place));
            let (got, status) = frame(&mut every, &Inputs { gbuffer, ..plain });
            println!("{name}, {}: {} pixels are off", eye.name, off(&got, &want));
            assert!(status.complete, "{name}, {}: {status:?}", eye.name);
            // An oblique near plane cuts the ground: there one place a pixel says which side it is on.
            let most = if eye.name.contains("oblique") { 120 } else { 16 };
            assert!(off(&got, &want) <= most, "{name}, {}: {} pixels", eye.name, off(&got, &want));
            // The comparison must notice a picture that is moved by a pixel.
            let mut moved = got.clone();
            moved.visibility.rotate_right(1);
            assert!(off(&moved, &want) > 300, "{name}, {}: a moved picture passes", eye.name);
        }
    }
}

/// The same with multisampled depths, of which none lies at a pixel's centre.
#[gpu_test]
fn a_ground_in_multisampled_frames() {
    for name in ["spheres", "windmill"] {
        let (all, casters, scene) = grounded(name, 0.01);
        let mut as_caster = pass(settings(FacetMode::All, 32), &all);
        let mut every = with_receivers(settings(FacetMode::All, 32), &casters, 1);
        for eye in eyes(&scene).into_iter().filter(|eye| !eye.name.contains("oblique")) {
            let (camera, drawn) = (eye.camera(), draw_samples(&all, &eye, 4));
            let plain = Inputs { origin: Some(ORIGIN), ..Inputs::new(&camera, &scene.light) };
            let (want, _) = frame(&mut as_caster, &Inputs { origin: None, ..plain });
            let place = SurfacePosition::Depth { texture: &drawn.depth, terms: eye.terms(), nothing: eye.nothing };
            let given = SurfaceTextures::new(place);
            let mut ask = |given| {
                let (got, status) = frame(&mut every, &Inputs { gbuffer: GBuffer::Surfaces(given), ..plain });
                assert!(status.complete, "{name}, {}: {status:?}", eye.name);
                off(&got, &want)
            };
            let wrong = ask(given);
            // The same depths said to lie elsewhere in their pixels.
            let places = [[0.625, 0.875], [0.125, 0.625], [0.875, 0.375], [0.375, 0.125]];
            let elsewhere = ask(SurfaceTextures { places: &places, ..given });
            println!("{name}, {}: {wrong} pixels are off, {elsewhere} by other places", eye.name);
            assert!(wrong <= 24 && elsewhere > 3 * wrong + 20, "{name}, {}: {wrong}, {elsewhere}", eye.name);
        }
    }
}

#[gpu_test]
fn multisampled_depths_that_do_not_fit_are_refused() {
    let scene = scene("plane");
    let samples = |format| {
        gpu().device.create_texture(&wgpu::TextureDescriptor {
            label: Some("test"),
            size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 4,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        })
    };
    let (depth, normals) = (samples(TextureFormat::Depth32Float), samples(TextureFormat::Rgba16Float));
    let single = texture(SIZE, 1, TextureFormat::R32Float, &[]);
    let ids = texture(SIZE, 1, TextureFormat::R32Uint, &[]);
    let of = |texture| {
        let place = SurfacePosition::Depth { texture, terms: DepthTerms::reversed_infinite(0.1), nothing: 0.0 };
        SurfaceTextures::new(place)
    };
    let [mut every, mut one] =
        [FacetMode::All, FacetMode::One].map(|facets| with_receivers(settings(facets, 32), &scene.mesh, 1));
    let plain = Inputs::new(&scene.camera, &scene.light);
    let mut encoder = gpu().encoder();
    let mut with = |pass: &mut ShadowPass, given: SurfaceTextures| {
        pass.record(&mut encoder, &Inputs { gbuffer: GBuffer::Surfaces(given), ..plain }, &Target::default())
    };
    let given = SurfaceTextures { normals: Some(&normals), ..of(&depth) };
    with(&mut every, given).expect("a frame");
    refused("a facet for every surface", with(&mut one, given));
    let places = SampleTexture::STANDARD_4;
    refused("4 samples, 3 places", with(&mut every, SurfaceTextures { places: &places[1..], ..given }));
    for bad in [[f32::NAN, 0.5], [0.5, 1.0]] {
        let places = [places[0], places[1], bad, places[3]];
        refused("sample 2", with(&mut every, SurfaceTextures { places: &places, ..given }));
    }
    let ids = Some(TriangleTexture::new(&ids));
    refused("triangle numbers of one sample", with(&mut every, SurfaceTextures { ids, ..given }));
    refused("normal", with(&mut every, SurfaceTextures { normals: Some(&normals), ..of(&single) }));
}

/// Casters that a ground hides are not seen through it, not even beside what stands before it.
#[gpu_test]
fn casters_under_a_ground_are_not_seen() {
    let (mut all, mut casters, scene) = grounded("windmill", 0.01);
    let (lo, hi) = casters.bounds().expect("a mesh");
    // Slats in a cellar, dark or lit by turns.
    let cellar = |mesh: &mut Mesh, before: usize| {
        let first = mesh.positions.len() as u32;
        let mut slats = Vec::new();
        for k in 0..40u32 {
            let z = lo.z + (hi.z - lo.z) * f64::from(k) / 39.0;
            let y = lo.y - (hi.y - lo.y) * if k % 2 == 0 { 0.1 } else { 0.3 };
            for [x, along] in [[lo.x, 0.0], [hi.x, 0.0], [lo.x, 0.04]] {
                mesh.positions.push(DVec3::new(x, y, z + along * (hi.z - lo.z)).as_vec3().into());
            }
            slats.push([0, 1, 2].map(|v| first + 3 * k + v));
        }
        mesh.triangles.splice(before..before, slats);
    };
    let count = casters.triangles.len();
    cellar(&mut casters, count);
    cellar(&mut all, count);
    let seen = raster(&all, &scene.camera);
    let terms = DepthTerms::reversed_infinite(0.1);
    let depth = floats(TextureFormat::R32Float, &seen.depths(terms, 0.0));
    let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
    let place = SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 };
    let given = SurfaceTextures { normals: Some(&normals), ..SurfaceTextures::new(place) };
    let plain = Inputs::new(&scene.camera, &scene.light);
    let (want, _) = frame(&mut pass(settings(FacetMode::All, 32), &all), &plain);
    let mut every = with_receivers(settings(FacetMode::All, 32), &casters, 1);
    let (got, status) = frame(&mut every, &Inputs { gbuffer: GBuffer::Surfaces(given), ..plain });
    assert!(status.complete && off(&got, &want) <= 4, "{} pixels are off: {status:?}", off(&got, &want));
    let (through, _) = frame(&mut every, &plain);
    assert!(off(&through, &want) > 300, "the ground hides nothing");
}

/// In strips of rows, of several lights in one submission, and of casters that move, the picture is that of one piece, one light and one mesh.
#[gpu_test]
fn strips_lights_and_moving_casters_change_nothing() {
    let (all, casters, scene) = grounded("plant", 0.01);
    let seen = raster(&all, &scene.camera);
    let terms = DepthTerms::reversed_infinite(0.1);
    let depth = floats(TextureFormat::R32Float, &seen.depths(terms, 0.0));
    let place = SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 };
    let gbuffer = GBuffer::Surfaces(SurfaceTextures::new(place));
    let plain = Inputs { gbuffer, ..Inputs::new(&scene.camera, &scene.light) };
    let all_surfaces = settings(FacetMode::All, 32);
    let mut whole = with_receivers(all_surfaces.clone(), &casters, 1);
    let (want, _) = frame(&mut whole, &plain);
    for strips in [2, 5, 61] {
        let mut cut = with_receivers(all_surfaces.clone(), &casters, strips);
        let (got, _) = frame(&mut cut, &plain);
        assert!(cut.strips() > 1);
        assert_same(&format!("{strips} strips"), &got, &want);
    }
    // The frame of the second light keeps what the first found.
    let other = Light::Directional { direction: [-0.6, 0.7, 0.2] };
    let (of_other, _) = frame(&mut whole, &Inputs { light: &other, ..plain });
    let lights = [scene.light, other].map(|light| LightTarget::new(light, Target::default()));
    for round in 0..2 {
        let mut encoder = gpu().encoder();
        whole.record_lights(&mut encoder, &plain, &lights).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        let lit = read(whole.lit().expect("lit masks"));
        assert!(round == 0 || lit == of_other.lit, "another picture of the second light");
    }
    let words: Vec<[f32; 4]> = casters.positions.iter().map(|&[x, y, z]| [x, y, z, f32::NAN]).collect();
    let rest = Buffer::from_slice(&gpu().device, &gpu().queue, "test", &words).expect("memory");
    let (low, high) = casters.bounds().expect("a mesh");
    let bounds = [(low - 0.01).as_vec3().into(), (high + 0.01).as_vec3().into()];
    let moved = Moved { vertices: Vertices { buffer: rest.raw(), offset: 0, stride: 16 }, bounds };
    let moving = Casters::Moving { rest: &casters.positions, triangles: &casters.triangles };
    let config = PassConfig { receivers: true, ..PassConfig::new(all_surfaces, moving) };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let (got, _) = frame(&mut pass, &Inputs { moved: Some(moved), ..plain });
    assert!(off(&got, &want) <= 1, "moving casters: {} pixels are off", off(&got, &want));
    // A pass without room for them says so.
    let config = PassConfig::new(
        settings(FacetMode::All, 32),
        Casters::Static { positions: &casters.positions, triangles: &casters.triangles },
    );
    let mut poor = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    refused("room for receivers", poor.record(&mut gpu().encoder(), &plain, &Target::default()));
}

/// Depth of each pixel by the nearest of what `seen` tells of a ray from the eye: its view depth, or nothing.
fn depths_of(camera: &Camera, terms: DepthTerms, seen: &dyn Fn(DVec3, DVec3) -> Option<f64>) -> wgpu::Texture {
    let rays = camera.rays(SIZE[0], SIZE[1]);
    let depth = |p: u32| {
        let ray = rays.direction(f64::from(p % SIZE[0]) + 0.5, f64::from(p / SIZE[0]) + 0.5);
        seen(rays.eye, ray).map_or(0.0, |depth| terms.offset / depth as f32)
    };
    floats(TextureFormat::R32Float, &(0..PIXELS as u32).map(depth).collect::<Vec<_>>())
}

fn quad(mesh: &mut Mesh, corners: [[f32; 3]; 4]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| first + v)));
}

/// A ground that lies nearer to a card than the tolerance is seen through its holes.
#[gpu_test]
fn a_ground_is_seen_through_holes_that_lie_on_it() {
    let camera =
        Camera { eye: [0.0, 9.0, 15.0], target: [0.0; 3], vertical_fov_degrees: 5.33, ..scene("spheres").camera };
    let mut mesh = Mesh::default();
    quad(&mut mesh, [[-1.0, 0.001, -1.0], [1.0, 0.001, -1.0], [1.0, 0.001, 1.0], [-1.0, 0.001, 1.0]]);
    quad(&mut mesh, [[-60.0, 50.0, -60.0], [60.0, 50.0, -60.0], [60.0, 50.0, 60.0], [-60.0, 50.0, 60.0]]);
    let map = AlphaMap {
        size: [2, 1],
        alpha: vec![255, 0],
        cutoff: 0.5,
        filter: AlphaFilter::Nearest,
        wrap: [AlphaWrap::Clamp; 2],
    };
    let uv = [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
    let tested = |t: u32| TestedTriangle { triangle: t, map: 0, uv: uv[t as usize], roles: Roles::ALL };
    let tested = AlphaTested { maps: vec![map], triangles: (0..2).map(tested).collect() };
    let terms = DepthTerms::reversed_infinite(0.1);
    // The left half of the card is solid.
    let seen = |eye: DVec3, ray: DVec3| {
        let [card, ground] = [0.001, 0.0].map(|y| (y - eye.y) / ray.y);
        let at = eye + ray * card;
        Some(if at.x.abs() <= 1.0 && at.z.abs() <= 1.0 && at.x < 0.0 { card } else { ground })
    };
    let depth = depths_of(&camera, terms, &seen);
    let light = Light::Directional { direction: [0.1, 1.0, 0.05] };
    let place = SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 };
    let inputs = Inputs { gbuffer: GBuffer::Surfaces(SurfaceTextures::new(place)), ..Inputs::new(&camera, &light) };
    for facets in [FacetMode::All, FacetMode::One] {
        let lit = |mesh: &Mesh| {
            let casters = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
            let casters = Casters::AlphaTested { casters: &casters, tested: &tested };
            let settings = Settings { alpha_tested: true, ..settings(facets, 32) };
            let config = PassConfig { receivers: true, ..PassConfig::new(settings, casters) };
            let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
            let (got, status) = frame(&mut pass, &inputs);
            assert!(status.complete, "{status:?}");
            got.visibility.iter().filter(|&&v| v > 0.0).count()
        };
        assert_eq!(lit(&mesh), 0, "{facets:?}: lit under a roof");
        let open = Mesh { triangles: mesh.triangles[..2].to_vec(), ..mesh.clone() };
        assert!(lit(&open) > 4000, "{facets:?}: dark without one");
    }
}

/// A ground goes on to the horizon within its pixels, before what it hides.
#[gpu_test]
fn a_ground_hides_what_is_under_it_up_to_the_horizon() {
    let camera = Camera {
        eye: [0.0, 1.0, 0.0],
        target: [0.0, 0.7, -10.0],
        vertical_fov_degrees: 60.0,
        ..scene("spheres").camera
    };
    let mut mesh = Mesh::default();
    quad(&mut mesh, [[-900.0, -500.0, -900.0], [900.0, -500.0, -900.0], [900.0, -0.5, -900.0], [-900.0, -0.5, -900.0]]);
    let terms = DepthTerms::reversed_infinite(0.1);
    let depth =
        depths_of(&camera, terms, &|eye, ray| (ray.y < 0.0).then(|| -eye.y / ray.y).filter(|&depth| depth < 1000.0));
    let light = Light::Directional { direction: [0.0, 0.5, -1.0] };
    let place = SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 };
    let plain = Inputs::new(&camera, &light);
    let inputs = Inputs { gbuffer: GBuffer::Surfaces(SurfaceTextures::new(place)), ..plain };
    let mut pass = with_receivers(settings(FacetMode::All, 32), &mesh, 1);
    let (got, status) = frame(&mut pass, &inputs);
    let dark = |got: &Picture| got.visibility.iter().filter(|&&v| v < 1.0).count();
    assert!(status.complete && dark(&got) == 0, "{} pixels are dark: {status:?}", dark(&got));
    let (bare, _) = frame(&mut pass, &plain);
    assert!(dark(&bare) > 500, "without the ground {} pixels are dark", dark(&bare));
}

/// A pixel keeps the caster that numbers say it shows where the pass finds none.
#[gpu_test]
fn a_caster_that_numbers_tell_of_is_kept() {
    let scene = scene("spheres");
    let count = scene.mesh.triangles.len();
    let seen = raster(&scene.mesh, &scene.camera);
    let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
    let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&seen.ids(count)));
    let place = SurfacePosition::Position(&positions);
    let given = SurfaceTextures { ids: Some(TriangleTexture::new(&ids)), ..SurfaceTextures::new(place) };
    let plain = Inputs::new(&scene.camera, &scene.light);
    let (want, _) = frame(&mut pass(settings(FacetMode::One, 32), &scene.mesh), &plain);
    // The pass sees none of them.
    let mut unseen = AlphaTested::default();
    unseen.set_roles(0..count as u32, Roles { seen: false, ..Roles::ALL });
    let standing = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let casters = Casters::AlphaTested { casters: &standing, tested: &unseen };
    let settings = Settings { alpha_tested: true, ..settings(FacetMode::All, 32) };
    let config = PassConfig { receivers: true, ..PassConfig::new(settings, casters) };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let (got, status) = frame(&mut pass, &Inputs { gbuffer: GBuffer::Surfaces(given), ..plain });
    assert!(status.complete, "{status:?}");
    assert!(off(&got, &want) < 100, "{} pixels are off", off(&got, &want));
    let (bare, _) = frame(&mut pass, &plain);
    assert!(off(&bare, &want) > 500, "without numbers {} pixels are off", off(&bare, &want));
}
