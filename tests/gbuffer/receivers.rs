//! Surfaces that cast nothing and receive.

use super::*;

/// Facet truth of what each pixel shows.
pub(crate) fn judged(seen: &Raster, all: &Mesh, scene: &Scene, settings: &Settings) -> Vec<(FacetInput, FacetResult)> {
    let tracer = Tracer::new(all).expect("a tracer");
    let [w, h] = SIZE;
    let truth = FacetTruth::new(&tracer, &scene.camera, &scene.light, &settings.samples, w, h).expect("a truth");
    let coverage = [u32::MAX, 0, 0, 0];
    let input = |(pixel, t): (u32, &Option<u32>)| Some(FacetInput { pixel, triangle: (*t)?, coverage });
    let inputs: Vec<_> = (0..).zip(&seen.triangles).filter_map(input).collect();
    let results = truth.judge(&inputs, None).expect("judged");
    inputs.into_iter().zip(results).collect()
}

/// Samples that differ outside the ambiguity band of facet truth, and inside, of the pixels that `asked` says. Samples that a
/// ground among the casters cuts off are not looked at.
fn differing(
    asked: &dyn Fn(usize) -> bool,
    got: &Picture,
    want: &Picture,
    truth: &[(FacetInput, FacetResult)],
) -> [u32; 2] {
    let mut out = [0; 2];
    for (input, result) in truth.iter().filter(|(input, _)| asked(input.pixel as usize)) {
        let off = (got.lit[input.pixel as usize] ^ want.lit[input.pixel as usize]) & result.valid[0];
        out[0] += (off & !result.ambiguous()[0]).count_ones();
        out[1] += (off & result.ambiguous()[0]).count_ones();
    }
    out
}

/// A sheet over a floor, and one that runs through it: of 8 x 8 squares each, 81 vertices.
fn sheets() -> Scene {
    let mut mesh = Mesh::default();
    for (half, height, slope) in [(1.0, 0.5, 0.0), (2.0, -0.3, 0.0), (0.8, 0.5, 0.7)] {
        let base = mesh.positions.len() as u32;
        for v in 0..81u32 {
            let [x, z] = [v % 9, v / 9].map(|k| (k as f32 / 4.0 - 1.0) * half);
            mesh.positions.push([x, height + slope * x + 1e-3 * z, z]);
        }
        for a in (0..72).filter(|v| v % 9 < 8).map(|v| v + base) {
            mesh.triangles.extend([[a, a + 9, a + 1], [a + 1, a + 9, a + 10]]);
        }
    }
    let camera = Camera::framing(DVec3::new(-1.2, -0.3, -1.2), DVec3::new(1.2, 0.5, 1.2));
    Scene { mesh, camera, ..scene("spheres") }
}

/// Casters and what only receives, in one another's midst: what is settled early is as light as evaluation says.
#[gpu_test]
fn settled_receivers_are_as_evaluated() {
    for name in ["sheets", "spheres", "plant", "cage"] {
        let scene = if name == "sheets" { sheets() } else { scene(name) };
        let (lo, hi) = scene.mesh.bounds().expect("a mesh");
        let cell = (hi - lo).length() / 7.0;
        let casts = |t: &[u32; 3]| {
            if name == "sheets" {
                return t.iter().all(|&v| v < 81);
            }
            let p = (Vec3::from(scene.mesh.positions[t[0] as usize]).as_dvec3() - lo) / cell;
            (p.x.floor() + p.y.floor() + p.z.floor()) as i64 % 2 == 0
        };
        let (mut order, receivers): (Vec<_>, Vec<_>) = scene.mesh.triangles.iter().copied().partition(casts);
        let casters = Mesh { positions: scene.mesh.positions.clone(), triangles: order.clone() };
        order.extend(receivers);
        let all = Mesh { positions: scene.mesh.positions.clone(), triangles: order };
        let seen = raster(&all, &scene.camera);
        let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
        let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
        let ids = seen.ids(casters.triangles.len());
        let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&ids));
        let gbuffer = GBuffer::Surfaces(SurfaceTextures {
            normals: Some(&normals),
            ids: Some(TriangleTexture::new(&ids)),
            ..SurfaceTextures::new(SurfacePosition::Position(&positions))
        });
        for count in [1, 32] {
            let with = |settle| Settings { settle, ..settings(FacetMode::One, count) };
            let [mut settled, mut evaluated] = [true, false].map(|settle| pass(with(settle), &casters));
            let mut last = None;
            let directional = [[0.5, 1.0, 0.3], [-0.7, 0.6, 0.2]].map(|direction| Light::Directional { direction });
            // Among the casters: a cube of views.
            let position = (lo + (hi - lo) * DVec3::new(0.45, 0.55, 0.6)).as_vec3().into();
            for light in directional.into_iter().chain([Light::Point { position }]) {
                let inputs = Inputs { gbuffer, ..Inputs::new(&scene.camera, &light) };
                let (got, status) = frame(&mut settled, &inputs);
                let (want, _) = frame(&mut evaluated, &inputs);
                let early = status.counts.lit_facets + status.counts.shadowed_facets;
                assert!(early > 300, "{name}: {early} facets are settled");
                // Which samples of a lit pixel another surface cuts off is not looked at once it is settled.
                let off = |p: &usize| got.visibility[*p].to_bits() != want.visibility[*p].to_bits();
                let off: Vec<_> = (0..PIXELS).filter(off).collect();
                assert!(off.is_empty(), "{name}, {count} samples, {light:?}: pixels {off:?} differ");
                assert!(last.replace(got.clone()) != Some(got), "{name}: another light changes nothing");
            }
        }
    }
}

/// A ground that is taken out of the casters and given as depth or position only has the shadows that it has as a caster, for
/// every kind of light, also far beyond the casters' box and behind the light.
#[gpu_test]
fn a_ground_that_casts_nothing_receives() {
    let (mut compared, mut in_shadow, mut noticed) = (0, 0, 0);
    for (name, lights) in [("bicycle", [1.0, 0.3]), ("spheres", [0.4, 1.5]), ("plant", [1.0, 0.15])] {
        let (all, casters, scene) = grounded(name, 0.01);
        assert!(casters.triangles.len() > 1000 && all.triangles.len() == casters.triangles.len() + 2);
        let seen = raster(&all, &scene.camera);
        let on_ground = |p: usize| seen.triangles[p].is_some_and(|t| t as usize >= casters.triangles.len());
        let count = (0..PIXELS).filter(|&p| on_ground(p)).count();
        assert!(count > 400, "{name}: {count} pixels of ground");
        compared += 1;
        let (lo, hi) = casters.bounds().expect("a mesh");
        let position = ((lo + hi) * 0.5 + DVec3::new(0.3, 1.0, 0.4) * (hi - lo).length() * 1.2).as_vec3().into();
        let beside = ((lo + hi) * 0.5 + DVec3::new(1.4, 0.8, 0.6) * (hi - lo).length()).as_vec3().into();
        let first = Light::Directional { direction: [0.5, lights[0], 0.3] };
        let mut given = vec![
            first,
            Light::Directional { direction: [-0.6, lights[1], 0.8] },
            Light::Point { position },
            Light::Point { position: beside },
        ];
        // Among the casters: a cube of views.
        let among = match name {
            "spheres" => Some([0.8, 1.9, 0.9]),
            "plant" => Some([0.3, 1.3, 0.2]),
            _ => None,
        };
        given.extend(among.map(|position| Light::Point { position }));
        for light in given {
            let counts: &[u32] = if light == first { &[1, 32] } else { &[32] };
            for &samples in counts {
                let settings = settings(FacetMode::One, samples);
                let scene = Scene { light, ..scene.clone() };
                let plain = Inputs::new(&scene.camera, &scene.light);
                let (want, _) = frame(&mut pass(settings.clone(), &all), &plain);
                let truth = judged(&seen, &all, &scene, &settings);
                let mut pass = pass(settings.clone(), &casters);
                let terms = DepthTerms::reversed_infinite(0.1);
                let depth = floats(TextureFormat::R32Float, &seen.depths(terms, 0.0));
                let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
                let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
                let ids = seen.ids(casters.triangles.len());
                let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&ids));
                let by_depth = SurfaceTextures::new(SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 });
                let by_position = SurfaceTextures::new(SurfacePosition::Position(&positions));
                let ids = Some(TriangleTexture::new(&ids));
                for (what, given) in [
                    ("depth", by_depth),
                    ("position", by_position),
                    ("position, normals, numbers", SurfaceTextures { normals: Some(&normals), ids, ..by_position }),
                    ("depth, numbers", SurfaceTextures { ids, ..by_depth }),
                ] {
                    let (got, status) = frame(&mut pass, &Inputs { gbuffer: GBuffer::Surfaces(given), ..plain });
                    assert!(status.complete, "{name}, {what}: {status:?}");
                    // Without normals, a pixel of ground must have another near in its row and its column.
                    let across = |p: usize| {
                        (1..5).any(|d| p % 83 >= d && on_ground(p - d) || p % 83 + d < 83 && on_ground(p + d))
                    };
                    let along = |p: usize| {
                        (1..5).any(|d| {
                            p >= 83 * d && on_ground(p - 83 * d) || p + 83 * d < PIXELS && on_ground(p + 83 * d)
                        })
                    };
                    let asked = |p: usize| !on_ground(p) || given.normals.is_some() || across(p) && along(p);
                    let [wrong, open] = differing(&asked, &got, &want, &truth);
                    let shadowed = (0..PIXELS).filter(|&p| on_ground(p) && want.visibility[p] < 1.0).count();
                    println!(
                        "{name} {light:?} {samples} {what}: {wrong} samples differ, {open} in the band; {shadowed} of {count} pixels of ground in shadow"
                    );
                    in_shadow += shadowed;
                    assert_eq!(wrong, 0, "{name}, {light:?}, {samples} samples, {what}");
                    assert!(u64::from(open) * 500 < PIXELS as u64 * u64::from(samples), "{name}, {what}: {open}");
                    // The comparison must notice one pixel.
                    let mut off = got.clone();
                    let Some(pixel) = (0..PIXELS).find(|&p| on_ground(p) && asked(p) && want.lit[p] == 0) else {
                        continue;
                    };
                    off.lit[pixel] = !0;
                    assert!(differing(&asked, &off, &want, &truth)[0] > 0);
                    noticed += 1;
                }
            }
        }
    }
    assert!(noticed > 10, "a wrong pixel was noticed {noticed} times");
    assert!(compared == 3 && in_shadow > 5000, "{compared} scenes, {in_shadow} pixels of ground in shadow");
}
