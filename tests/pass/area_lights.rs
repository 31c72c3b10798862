//! Lights of some extent: the mean over their points, which is that of rays to them.

use super::*;
use oracle::truth::{SceneTruth, Tracer};
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::scene::AreaLight;

const PIXELS: usize = (SIZE[0] * SIZE[1]) as usize;

/// The first complete picture, its frames' statuses, and the points.
fn soft(pass: &mut ShadowPass, scene: &Scene, area: &AreaLight) -> (Vec<f32>, Vec<FrameStatus>) {
    soft_of(pass, &Inputs::new(&scene.camera, &scene.light), area)
}

/// As [`soft`], of any inputs.
fn soft_of(pass: &mut ShadowPass, inputs: &Inputs, area: &AreaLight) -> (Vec<f32>, Vec<FrameStatus>) {
    for _ in 0..6 {
        let targets = Targets::new();
        let target = Target { lit: None, ..targets.target() };
        let mut encoder = gpu().encoder();
        let numbers = pass.record_area(&mut encoder, inputs, area, &target).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        gpu().check().expect("no error of the device");
        let statuses: Vec<FrameStatus> = numbers.iter().map(|_| status_of(pass)).collect();
        assert!(statuses.iter().map(|s| s.frame).eq(numbers) && statuses.len() == area.points as usize);
        if statuses.iter().all(|s| s.complete) {
            return (targets.read().0[..PIXELS].iter().map(|v| f32::from_bits(*v)).collect(), statuses);
        }
        assert!(statuses.iter().any(|s| s.overflowed), "{statuses:?}");
    }
    panic!("no complete frames by the sixth");
}

fn points(scene: &Scene, area: &AreaLight) -> Vec<Light> {
    let (low, high) = scene.mesh.bounds().expect("casters");
    area.points(0.5 * (low + high))
}

/// How many pixels are another share.
fn other(a: &[f32], b: &[f32]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| (**a - **b).abs() > 1e-5).count()
}

/// Of lights of all kinds the mean over the points is that of their own pictures, and of rays to them; in strips of rows, too.
#[gpu_test]
fn visibility_is_the_mean_over_the_points() {
    let sun = Light::Directional { direction: [0.5, 1.0, 0.3] };
    let lamp = Light::Point { position: [0.4, 5.0, 1.2] };
    let spot = Light::Spot { position: [2.0, 4.0, 1.0], target: [0.0; 3], angle_degrees: 70.0 };
    for (name, light, radius, strips) in
        [("spheres", sun, 4.0, 1), ("spheres", lamp, 0.5, 3), ("knot", spot, 0.4, 1), ("bumpy", sun, 2.0, 1)]
    {
        let scene = scene(name);
        let area = AreaLight { light, radius, points: 4 };
        let settings = settings(FacetMode::All);
        let config = PassConfig { strips, timing: true, ..PassConfig::new(settings.clone(), casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let (got, statuses) = soft(&mut pass, &scene, &area);
        let finds = |s: &FrameStatus| s.stages.iter().any(|stage| stage.name == "sample_surfaces");
        let once = strips > 1 || statuses.iter().skip(1).all(|s| !finds(s));
        assert!(finds(&statuses[0]) && once, "{name}: what the camera sees is found again");
        let tracer = Tracer::new(&scene.mesh).expect("a tracer");
        let (mut mean, mut traced) = (vec![0.0; PIXELS], vec![0.0; PIXELS]);
        let mut hard = Vec::new();
        for point in points(&scene, &area) {
            let own = rendered(&scene.mesh, &scene.camera, &point, &settings).0.visibility;
            let truth = SceneTruth::new(&tracer, &scene.camera, &point, &settings.samples, SIZE[0], SIZE[1]);
            let truth = truth.expect("a view").image(None).visibility();
            mean.iter_mut().zip(&own).for_each(|(sum, v)| *sum += v / 4.0);
            traced.iter_mut().zip(&truth).for_each(|(sum, v)| *sum += v / 4.0);
            hard = own;
        }
        assert_eq!(other(&got, &mean), 0, "{name}: another mean than that of the points' pictures");
        // An edge within rounding of a sample decides it otherwise, of each point.
        let far = other(&got, &traced);
        assert!(far <= 12, "{name}: {far} pixels are another share than traced");
        let soft = other(&got, &hard);
        assert!(soft > PIXELS / 20, "{name}: {soft} pixels are soft");
        let mut corrupted = got.clone();
        let lit = got.iter().position(|v| *v == 1.0).expect("a lit pixel");
        corrupted[lit] -= 1.0 / 128.0;
        assert_eq!(other(&corrupted, &mean), 1, "{name}: a corrupted picture passes");
        assert!(got.contains(&0.0), "{name}: no umbra");
    }
}

/// One point is the light; other methods, another size and casters, and single frames between change nothing.
#[gpu_test]
fn area_lights_work_wherever_the_pass_does() {
    let scene = scene("spheres");
    let area = AreaLight { light: scene.light, radius: 3.0, points: 3 };
    let one = AreaLight { points: 1, ..area };
    let mut pass = pass(settings(FacetMode::One), casters(&scene.mesh));
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let (first, _) = soft(&mut pass, &scene, &area);
    let (hard, _) = complete(&mut pass, &inputs);
    let hard: Vec<f32> = hard.0[..PIXELS].iter().map(|v| f32::from_bits(*v)).collect();
    assert_eq!(other(&soft(&mut pass, &scene, &one).0, &hard), 0);
    pass.set_size([40, 90]).expect("another size");
    pass.set_size(SIZE).expect("the first size");
    assert_eq!(other(&soft(&mut pass, &scene, &area).0, &first), 0, "after another size");
    assert!(other(&first, &hard) > 100);
    for method in [MethodName::ShadowMap, MethodName::Variance, MethodName::RayTraced] {
        let config = PassConfig { method, ..PassConfig::new(settings(FacetMode::One), casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let (got, _) = soft(&mut pass, &scene, &area);
        let alone = |light| soft(&mut pass, &scene, &AreaLight { light, ..one }).0;
        let each: Vec<Vec<f32>> = points(&scene, &area).into_iter().map(alone).collect();
        let mean: Vec<f32> = (0..PIXELS).map(|p| each.iter().map(|v| v[p]).sum::<f32>() / 3.0).collect();
        assert_eq!(other(&got, &mean), 0, "{}", method.name());
        assert!(other(&got, &each[0]) > 100, "{}: nothing is soft", method.name());
    }
}

/// Of casters of every kind, of surfaces that the application has found, and of a lamp among its casters the mean is that of the points' own frames.
#[gpu_test]
fn area_lights_take_every_input() {
    use super::instances::{SAME, Transform, exact, expanded, meshes, uploaded};
    use subpixel_shadows::pass::{CasterMesh, Placed, Transforms};

    let (cage, leaves) = (scene("cage"), scene("leaves"));
    let sun = AreaLight { light: cage.light, radius: 4.0, points: 3 };
    let lamp = AreaLight { light: Light::Point { position: [0.5, 2.0, 0.8] }, radius: 0.25, points: 3 };
    let plain = Inputs::new(&cage.camera, &cage.light);
    let vertices = vertex_buffer(&cage.mesh.positions);
    let moved = Moved { vertices: Vertices { buffer: &vertices, offset: 16, stride: 32 }, bounds: bounds(&cage.mesh) };
    let moving = Casters::Moving { rest: &cage.mesh.positions, triangles: &cage.mesh.triangles };
    let settings = settings(FacetMode::All);
    let (seen, prepared) = rendered(&cage.mesh, &cage.camera, &cage.light, &self::settings(FacetMode::One));
    let ids: Vec<u32> = seen.triangles.iter().map(|&t| prepared.given.get(t as usize).map_or(0, |g| g + 1)).collect();
    let texture = id_texture(&ids);
    let numbers = GBuffer::TriangleIds(TriangleTexture::new(&texture));
    let bodies = meshes();
    let parts = bodies.each_ref().map(|m| CasterMesh::new(&m.positions, &m.triangles));
    let instances: Vec<u32> = (0..14).map(|k| u32::from(k == 5)).collect();
    let transforms: Vec<Transform> = (0..14).map(|k| if k == 5 { SAME } else { exact(k) }).collect();
    let buffer = uploaded(&transforms, 0);
    let bounds = bounds(&expanded(&bodies, &instances, &transforms));
    let placed = Placed { transforms: Transforms { buffer: &buffer, offset: 0 }, bounds };
    let (camera, whole) = (super::instances::camera(), casters(&leaves.mesh));
    let holes = Casters::AlphaTested { casters: &whole, tested: &leaves.alpha };
    let of_instances = Inputs { placed: Some(placed), ..Inputs::new(&camera, &cage.light) };
    let inside = Camera { eye: [0.3, 1.6, 0.4], target: [-1.5, 0.0, -1.5], vertical_fov_degrees: 60.0, ..cage.camera };
    let one = self::settings(FacetMode::One);
    for (what, casters, inputs, area, settings) in [
        ("moving", moving, Inputs { moved: Some(moved), ..plain }, sun, &settings),
        ("moving around a lamp", moving, Inputs { moved: Some(moved), ..plain }, lamp, &settings),
        ("numbers", casters(&cage.mesh), Inputs { gbuffer: numbers, ..plain }, sun, &one),
        ("inside", casters(&cage.mesh), Inputs::new(&inside, &cage.light), lamp, &settings),
        (
            "instances",
            Casters::Instanced { meshes: &parts, instances: &instances },
            of_instances,
            AreaLight { radius: 6.0, ..sun },
            &settings,
        ),
        (
            "holes",
            holes,
            Inputs::new(&leaves.camera, &leaves.light),
            AreaLight { light: leaves.light, ..sun },
            &settings,
        ),
    ] {
        let mut pass = pass(settings.clone(), casters);
        let (got, _) = soft_of(&mut pass, &inputs, &area);
        let middle = match what {
            "instances" => [0, 1, 2].map(|k| 0.5 * (bounds[0][k] + bounds[1][k])).map(f64::from).into(),
            "holes" => leaves.mesh.bounds().map(|(low, high)| 0.5 * (low + high)).expect("casters"),
            _ => cage.mesh.bounds().map(|(low, high)| 0.5 * (low + high)).expect("casters"),
        };
        let mut mean = vec![0.0; PIXELS];
        let mut last = Vec::new();
        for light in area.points(middle) {
            let (own, _) = complete_within(6, &mut pass, &Inputs { light: &light, ..inputs });
            last = own.0[..PIXELS].iter().map(|v| f32::from_bits(*v)).collect();
            mean.iter_mut().zip(&last).for_each(|(sum, v)| *sum += v / 3.0);
        }
        assert_eq!(other(&got, &mean), 0, "{what}: another mean than that of the points' own frames");
        assert!(other(&got, &last) > 40, "{what}: {} pixels are soft", other(&got, &last));
        let dark = got.iter().filter(|v| **v < 0.3).count();
        assert!(dark > 40 && got.contains(&1.0), "{what}: {dark} pixels are dark");
    }
}

#[gpu_test]
fn impossible_area_lights_are_refused() {
    let scene = scene("plane");
    let area = AreaLight { light: scene.light, radius: 1.0, points: 4 };
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let mut pass = pass(settings(FacetMode::All), casters(&scene.mesh));
    let mut encoder = gpu().encoder();
    let targets = Targets::new();
    let mut refused = |what: &str, pass: &mut ShadowPass, area: AreaLight, target: Target| {
        let error = pass.record_area(&mut encoder, &inputs, &area, &target).expect_err(what).to_string();
        assert!(error.contains(what), "{error}");
    };
    refused("lit masks", &mut pass, area, targets.target());
    refused("0 points", &mut pass, AreaLight { points: 0, ..area }, Target::default());
    refused("radius of 90", &mut pass, AreaLight { radius: 90.0, ..area }, Target::default());
    let config = PassConfig { keep_last: true, ..PassConfig::new(settings(FacetMode::All), casters(&scene.mesh)) };
    let mut keeps = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    refused("keeps the last picture", &mut keeps, area, Target::default());
    gpu().submit_and_wait(encoder).expect("nothing was recorded");
    assert!(pass.status().is_none() && keeps.status().is_none());
}
