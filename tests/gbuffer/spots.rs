//! Spot lights whose shadows are asked in their cones, and lights with a range.

use super::*;
use oracle::truth::{SceneTruth, TruthImage, join_mask};
use subpixel_shadows::pass::{LightReach, LightTarget, TargetTexture};

pub fn truth(scene: &Scene, light: &Light, samples: &Samples) -> TruthImage {
    let tracer = Tracer::new(&scene.mesh).expect("a tracer");
    let truth = SceneTruth::new(&tracer, &scene.camera, light, samples, SIZE[0], SIZE[1]).expect("a truth");
    let mut image = truth.image(None);
    for (pixel, p) in image.pixels.iter_mut().enumerate() {
        let around = truth.ambiguous_mask(pixel as u32);
        p.ambiguous = std::array::from_fn(|k| p.ambiguous[k] | around[k]);
    }
    image
}

/// Where each sample sees a surface.
pub fn points(scene: &Scene, samples: &Samples) -> Vec<Option<DVec3>> {
    let tracer = Tracer::new(&scene.mesh).expect("a tracer");
    let rays = scene.camera.rays(SIZE[0], SIZE[1]);
    let point = |pixel: u32, offset: &[f32; 2]| {
        let [x, y] = [pixel % SIZE[0], pixel / SIZE[0]].map(f64::from);
        let way = rays.direction(x + f64::from(offset[0]), y + f64::from(offset[1]));
        tracer.closest(rays.eye, way, 0.0).map(|hit| rays.eye + way * hit.t)
    };
    (0..PIXELS as u32).flat_map(|pixel| samples.offsets().iter().map(move |offset| point(pixel, offset))).collect()
}

/// Whether a light's shadows are asked at a point.
fn is_asked(light: &Light, reach: LightReach, p: DVec3) -> bool {
    let at = light.homogeneous().truncate();
    let inside = match *light {
        Light::Spot { target, angle_degrees, .. } if reach.cone => {
            let axis = (Vec3::from(target).as_dvec3() - at).normalize();
            (p - at).normalize().dot(axis) > (f64::from(angle_degrees).to_radians() / 2.0).cos()
        }
        _ => true,
    };
    inside && (p - at).length() < f64::from(reach.range)
}

/// Samples that are wrong where they are asked, and how many are asked and dark.
fn judged(lit: &[u32], truth: &TruthImage, points: &[Option<DVec3>], asked: impl Fn(DVec3) -> bool) -> [u32; 2] {
    let mut out = [0; 2];
    for ((lit, p), points) in lit.iter().zip(&truth.pixels).zip(points.chunks(32)) {
        let mask = (0..32).filter(|&k: &usize| points[k].is_some_and(&asked)).fold(0u128, |m, k| m | 1 << k);
        let sure = mask & join_mask(p.seen) & !join_mask(p.ambiguous);
        out[0] += ((u128::from(*lit) ^ join_mask(p.lit)) & sure).count_ones();
        out[1] += (!join_mask(p.lit) & sure).count_ones();
    }
    out
}

/// Lights among the balls: views are as many as the cone and the range leave, and no sample there is wrong.
#[gpu_test]
fn cones_and_ranges_limit_the_views() {
    let scene = scene("spheres");
    let settings = settings(FacetMode::All, 32);
    let points = points(&scene, &settings.samples);
    let position = [0.8, 1.9, 0.9];
    let spot = |target, angle_degrees| Light::Spot { position, target, angle_degrees };
    let lights = [
        (spot([0.7, 0.0, 1.75], 40.0), LightReach::cone(f32::INFINITY), 1),
        (spot([-1.6, 0.5, 1.1], 75.0), LightReach::cone(4.0), 1),
        (spot([0.9, 2.25, 0.35], 20.0), LightReach::cone(f32::INFINITY), 1),
        (Light::Point { position }, LightReach { range: 1.1, ..LightReach::EVERYWHERE }, 5),
        (Light::Point { position }, LightReach { range: 0.45, ..LightReach::EVERYWHERE }, 4),
        (Light::Point { position }, LightReach::EVERYWHERE, 6),
    ];
    let mut all = 0;
    for (light, reach, most) in lights {
        let truth = truth(&scene, &light, &settings.samples);
        let pass = &mut pass(settings.clone(), &scene.mesh);
        let inputs = Inputs { reach, ..Inputs::new(&scene.camera, &light) };
        let (got, status) = frame(pass, &inputs);
        assert!(status.complete, "{light:?}: {status:?}");
        let views = pass.capacities().views;
        let [wrong, dark] = judged(&got.lit, &truth, &points, |p| is_asked(&light, reach, p));
        eprintln!("{light:?}, {reach:?}: {views} views, {wrong} of {dark} dark samples wrong");
        assert!(views <= most, "{light:?}, {reach:?}: {views} views");
        assert_eq!(wrong, 0, "{light:?}, {reach:?}");
        all += dark;
        if reach.cone {
            // Outside the cone shadows are missing: the comparison tells.
            let [outside, _] = judged(&got.lit, &truth, &points, |p| !is_asked(&light, reach, p));
            assert!(outside > 1000, "{light:?}: {outside}");
        }
    }
    assert!(all > 20000, "{all} dark samples");
    let light = Light::Point { position };
    let inputs =
        Inputs { reach: LightReach { range: -1.0, ..LightReach::EVERYWHERE }, ..Inputs::new(&scene.camera, &light) };
    let mut pass = pass(settings, &scene.mesh);
    refused("range", pass.record(&mut gpu().encoder(), &inputs, &Target::default()));
}

/// A spot above each of sixteen boxes on a floor.
pub fn sixteen_spots() -> (Scene, Vec<Light>) {
    let mut mesh = Mesh {
        positions: vec![[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let mut lights = Vec::new();
    for k in 0..16u32 {
        let [x, z] = [k % 4, k / 4].map(|c| c as f32 * 1.7 - 2.55);
        let first = mesh.positions.len() as u32;
        for corner in 0..8u32 {
            let [a, b, c] = [0, 1, 2].map(|axis| (corner >> axis & 1) as f32);
            mesh.positions.push([x + 0.4 * a - 0.13 * c, 0.1 + 0.7 * b, z + 0.35 * c + 0.11 * a]);
        }
        for quad in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 2, 6, 4], [1, 5, 7, 3], [2, 3, 7, 6], [0, 4, 5, 1]] {
            let [a, b, c, d] = quad.map(|v: u32| first + v);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        let position = [x - 0.4, 1.9, z + 0.5];
        lights.push(Light::Spot { position, target: [x + 0.2, 0.2, z + 0.1], angle_degrees: 50.0 });
    }
    let scene = Scene {
        mesh,
        camera: Camera::look_at([0.5, 6.0, 7.0], [0.0; 3], [0.0, 1.0, 0.0], 45.0, 0.1),
        ..scene("plane")
    };
    (scene, lights)
}

/// The spots, recorded as one frame: each has one view, and no sample in its cone is wrong.
#[gpu_test]
fn sixteen_spots_share_a_frame() {
    let (scene, lights) = sixteen_spots();
    let settings = settings(FacetMode::All, 32);
    let points = points(&scene, &settings.samples);
    let texture = super::texture(SIZE, 16, TextureFormat::R8Unorm, &vec![0; 16 * PIXELS]);
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
    let descriptor = wgpu::BufferDescriptor { label: None, size: 4 * PIXELS as u64, usage, mapped_at_creation: false };
    let buffers = [(); 16].map(|()| gpu().device.create_buffer(&descriptor));
    let reach = LightReach::cone(6.0);
    let asked: Vec<LightTarget> = (0..)
        .zip(&lights)
        .zip(&buffers)
        .map(|((layer, light), lit)| {
            let layer = TargetTexture { layer, ..TargetTexture::new(&texture) };
            let target = Target { visibility: Some(layer), lit: Some(lit), ..Target::default() };
            LightTarget { reach, ..LightTarget::new(*light, target) }
        })
        .collect();
    let mut pass = pass(settings.clone(), &scene.mesh);
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for round in 0..6 {
        let mut encoder = gpu().encoder();
        pass.record_lights(&mut encoder, &inputs, &asked).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        if (0..16).filter(|_| status_of(&mut pass).complete).count() == 16 {
            break;
        }
        assert!(round < 5, "no complete frames");
    }
    assert_eq!(pass.capacities().views, 1, "a view a spot");
    for (k, (light, lit)) in lights.iter().zip(&buffers).enumerate() {
        let truth = truth(&scene, light, &settings.samples);
        let lit = read(lit);
        let [wrong, dark] = judged(&lit, &truth, &points, |p| is_asked(light, reach, p));
        assert!(wrong == 0 && dark > 200, "spot {k}: {wrong} of {dark} dark samples wrong");
        let [other, _] = judged(&lit, &truth, &points, |p| is_asked(&lights[(k + 1) % 16], reach, p));
        assert!(other > 0 || k % 4 == 3, "spot {k}: the neighbour's cone is its own");
    }
}
