//! Surfaces in strips.

use super::*;

/// In strips of rows a pixel shows what it shows in one piece, though neighbours are looked at that other strips hold; faults are
/// counted once.
#[gpu_test]
fn surfaces_in_strips_are_the_whole() {
    let (all, casters, scene) = grounded("spheres", 0.01);
    let seen = raster(&all, &scene.camera);
    let plain = Inputs::new(&scene.camera, &scene.light);
    let terms = DepthTerms::reversed_infinite(0.1);
    // On the right only every fourth row sees something, so that neighbours lie as far as is looked; one pixel in each row is no place.
    let mut values = seen.depths(terms, 0.0);
    (0..PIXELS).filter(|p| p % 83 > 40 && p / 83 % 4 != 2).for_each(|p| values[p] = 0.0);
    (0..PIXELS).filter(|p| p % 83 == 40).for_each(|p| values[p] = f32::NAN);
    let depth = floats(TextureFormat::R32Float, &values);
    let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
    let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
    let numbers = seen.ids(casters.triangles.len());
    let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&numbers));
    let by_depth = SurfaceTextures::new(SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 });
    let by_position = SurfaceTextures::new(SurfacePosition::Position(&positions));
    let ids = Some(TriangleTexture::new(&ids));
    let words: Vec<[f32; 4]> = casters.positions.iter().map(|&[x, y, z]| [x, y, z, f32::NAN]).collect();
    let rest = Buffer::from_slice(&gpu().device, &gpu().queue, "test", &words).expect("memory");
    let (low, high) = casters.bounds().expect("a mesh");
    let bounds = [(low - 0.01).as_vec3().into(), (high + 0.01).as_vec3().into()];
    let at_rest = Moved { vertices: Vertices { buffer: rest.raw(), offset: 0, stride: 16 }, bounds };
    for (what, given) in [
        ("depth", by_depth),
        ("depth, numbers", SurfaceTextures { ids, ..by_depth }),
        ("position, normals", SurfaceTextures { normals: Some(&normals), ..by_position }),
    ] {
        let inputs = Inputs { gbuffer: GBuffer::Surfaces(given), ..plain };
        let slices = SplitPlan { splits: 3, warp: Warp::Fitted, focus: 0.6, ..SplitPlan::default() };
        let in_strips_of = |strips, partition, casters, inputs: &Inputs| {
            let settings = Settings { partition, ..settings(FacetMode::One, 32) };
            let config = PassConfig { receivers: true, strips, ..PassConfig::new(settings, casters) };
            let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
            (frame(&mut pass, inputs), pass.strips())
        };
        let (positions, triangles) = (&casters.positions, &casters.triangles);
        let standing = Casters::Static { positions, triangles };
        let in_strips = |strips| in_strips_of(strips, None, standing, &inputs);
        let ((want, status), _) = in_strips(1);
        // Seen by the light in slices of what the camera sees.
        let ((got, of_slices), _) = in_strips_of(1, Some(slices), standing, &inputs);
        assert_same_shadows(&format!("{what}, in slices"), &got, &want);
        assert_eq!(of_slices.faults, status.faults, "{what}, in slices");
        // Moving casters, at rest.
        let moving = Casters::Moving { rest: positions, triangles };
        let ((got, of_strips), _) = in_strips_of(3, Some(slices), moving, &Inputs { moved: Some(at_rest), ..inputs });
        assert_same_shadows(&format!("{what}, moving"), &got, &want);
        assert_eq!(of_strips.faults, status.faults, "{what}, moving");
        for strips in [2, 5, 61] {
            let ((got, of_strips), count) = in_strips(strips);
            assert!(count > 1 && count <= strips);
            assert_same(&format!("{what}, {strips} strips"), &got, &want);
            assert_eq!(of_strips.faults, status.faults, "{what}, {strips} strips");
        }
        let faults = status.faults.unusable_surfaces;
        assert!(what != "depth" || faults > 40, "{what}: {faults} faults");
    }
}
