//! The samples of a multisampled picture.

use super::*;

/// Triangle that each of a picture's samples sees, by the full search: a layer of triangle numbers for each sample.
fn sample_layers(scene: &Scene, samples: &Samples) -> Vec<Vec<u32>> {
    use subpixel_shadows::render::{Budget, Renderer};
    let mut prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    // Every triangle a surface of its own, so that facets say which one each sample sees.
    prepared.surfaces = (0..prepared.surfaces.len() as u32).collect();
    let settings = Settings { samples: samples.clone(), ..settings(FacetMode::All, 32) };
    let mut renderer = Renderer::new(gpu(), &prepared, &settings, Budget::default()).expect("a renderer");
    renderer.render(&scene.camera, &scene.light).expect("a frame");
    let facets = renderer.facets().expect("facets");
    let (list, masks) = (facets.list.read(gpu()).expect("facets"), facets.masks.read(gpu()).expect("masks"));
    let (words, ends) = (samples.words() as usize, facets.pixel_facets.read(gpu()).expect("pixels"));
    let mut layers = vec![vec![u32::MAX; PIXELS]; samples.count() as usize];
    for f in 0..ends[PIXELS] as usize {
        for (k, layer) in layers.iter_mut().enumerate() {
            if masks[3 * words * f + k / 32] >> (k % 32) & 1 == 1 {
                layer[list[f].pixel as usize] = prepared.given[list[f].triangle as usize];
            }
        }
    }
    layers
}

fn layer_texture(layers: &[Vec<u32>]) -> wgpu::Texture {
    texture(SIZE, layers.len() as u32, TextureFormat::R32Uint, bytemuck::cast_slice(&layers.concat()))
}

/// A G-buffer with the samples of the picture is the full search, bit for bit; one with fewer is not, but nearly.
#[gpu_test]
fn the_samples_of_the_picture_are_the_full_search() {
    for (name, count) in [("windmill", 32), ("bicycle", 32), ("plant", 128), ("spheres", 8)] {
        let scene = scene(name);
        let settings = settings(FacetMode::All, count);
        let mut pass = pass(settings.clone(), &scene.mesh);
        let plain = Inputs::new(&scene.camera, &scene.light);
        let (want, status) = frame(&mut pass, &plain);
        assert!(status.complete && status.counts.complex_pixels > 200, "{name}: {status:?}");
        let layers = sample_layers(&scene, &settings.samples);
        let mut ask = |layers: &[Vec<u32>], places: &[[f32; 2]]| {
            let texture = layer_texture(layers);
            let gbuffer = GBuffer::SampleIds(SampleTexture::new(&texture, places));
            let (got, status) = frame(&mut pass, &Inputs { gbuffer, ..plain });
            assert!(status.complete, "{name}: {status:?}");
            got
        };
        assert_same(name, &ask(&layers, settings.samples.offsets()), &want);
        // In any order of the samples.
        let (mut turned, mut places) = (layers.clone(), settings.samples.offsets().to_vec());
        turned.iter_mut().for_each(|layer| layer.rotate_left(1));
        assert!(ask(&turned, &places) != want, "{name}: samples of other pixels pass");
        turned.iter_mut().for_each(|layer| layer.rotate_right(1));
        turned.rotate_left(3);
        places.rotate_left(3);
        assert_same(&format!("{name}, turned"), &ask(&turned, &places), &want);
        // Every fourth of them: most pixels are the same.
        let fewer: Vec<_> = layers.iter().step_by(4).cloned().collect();
        let places: Vec<_> = settings.samples.offsets().iter().step_by(4).copied().collect();
        let got = ask(&fewer, &places);
        // Seen by the light in slices of what the camera sees: nearly the same. What a texel settles shows at samples that no surface of
        // the few is at.
        let partition = Some(SplitPlan { splits: 2, warp: Warp::Fitted, focus: 0.6, ..SplitPlan::default() });
        let mut sliced = self::pass(Settings { partition, ..settings.clone() }, &scene.mesh);
        let texture = layer_texture(&fewer);
        let gbuffer = GBuffer::SampleIds(SampleTexture::new(&texture, &places));
        let (of_slices, status) = frame(&mut sliced, &Inputs { gbuffer, ..plain });
        let others = (0..PIXELS).filter(|&p| of_slices.visibility[p] != got.visibility[p]).count();
        assert!(status.complete && others * 100 < PIXELS, "{name}, in slices: {others} pixels differ");
        let off = |p: &usize| (got.visibility[*p] - want.visibility[*p]).abs() > 1.0 / 32.0;
        let wrong = (0..PIXELS).filter(off).count();
        println!("{name}: {wrong} of {PIXELS} pixels off with {} of {count} samples", fewer.len());
        assert!(wrong > 0 && wrong < PIXELS / 5, "{name}: {wrong} pixels");
    }
}

/// Numbers of no triangle count as nothing, and are said.
#[gpu_test]
fn samples_that_name_no_triangle_are_faults() {
    let scene = scene("spheres");
    let settings = settings(FacetMode::All, 32);
    let mut pass = pass(settings.clone(), &scene.mesh);
    let mut layers = sample_layers(&scene, &settings.samples);
    for (layer, pixel) in [(0, 7), (3, 7), (31, PIXELS - 1)] {
        layers[layer][pixel] = scene.mesh.triangles.len() as u32;
    }
    let texture = layer_texture(&layers);
    let gbuffer = GBuffer::SampleIds(SampleTexture::new(&texture, settings.samples.offsets()));
    let (_, status) = frame(&mut pass, &Inputs { gbuffer, ..Inputs::new(&scene.camera, &scene.light) });
    assert_eq!(status.faults, Faults { unknown_triangles: 3, ..Faults::default() });
    assert!(!status.complete);
    // In strips the picture is the same, and so are faults, one in each row.
    (0..SIZE[1] as usize).for_each(|y| layers[2][y * SIZE[0] as usize + 50] = 1 << 30);
    let texture = layer_texture(&layers);
    let gbuffer = GBuffer::SampleIds(SampleTexture::new(&texture, settings.samples.offsets()));
    let inputs = Inputs { gbuffer, ..Inputs::new(&scene.camera, &scene.light) };
    let (want, whole) = frame(&mut pass, &inputs);
    assert_eq!(whole.faults, Faults { unknown_triangles: 3 + SIZE[1], ..Faults::default() });
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let config = PassConfig { strips: 4, ..PassConfig::new(settings.clone(), casters) };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let (got, status) = frame(&mut pass, &inputs);
    assert_eq!(status.faults, whole.faults);
    assert_same("four strips", &got, &want);
}

#[gpu_test]
fn bad_samples_are_refused() {
    let scene = scene("plane");
    let mut pass = pass(settings(FacetMode::All, 32), &scene.mesh);
    let plain = Inputs::new(&scene.camera, &scene.light);
    let mut encoder = gpu().encoder();
    let none = Target::default();
    let four = texture(SIZE, 4, TextureFormat::R32Uint, &[]);
    let places = SampleTexture::STANDARD_4;
    let mut with = |given: SampleTexture| {
        pass.record(&mut encoder, &Inputs { gbuffer: GBuffer::SampleIds(given), ..plain }, &none)
    };
    refused("4 layers, 3 places", with(SampleTexture::new(&four, &places[..3])));
    refused("0 samples", with(SampleTexture::new(&four, &[])));
    refused("129 samples", with(SampleTexture::new(&four, &[[0.5; 2]; 129])));
    for bad in [[f32::NAN, 0.5], [0.5, 1.0], [-0.1, 0.5]] {
        let places = [places[0], bad, places[2], places[3]];
        refused("sample 1", with(SampleTexture::new(&four, &places)));
    }
    let small = texture([5, 7], 4, TextureFormat::R32Uint, &[]);
    refused("5x7", with(SampleTexture::new(&small, &places)));
    let floats = texture(SIZE, 4, TextureFormat::R32Float, &[]);
    refused("R32Uint", with(SampleTexture::new(&floats, &places)));
    let multisampled = gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test"),
        size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 4,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::R16Float,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    refused("Rg16Uint", with(SampleTexture::new(&multisampled, &places)));
    let mut one = self::pass(settings(FacetMode::One, 32), &scene.mesh);
    let inputs = Inputs { gbuffer: GBuffer::SampleIds(SampleTexture::new(&four, &places)), ..plain };
    refused("every surface", one.record(&mut encoder, &inputs, &none));
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let rays = PassConfig { method: MethodName::RayTraced, ..PassConfig::new(settings(FacetMode::All, 8), casters) };
    let mut rays = ShadowPass::new(&gpu().device, &gpu().queue, &rays).expect("a pass");
    refused("facet-masks takes it", rays.record(&mut encoder, &inputs, &none));
    gpu().submit_and_wait(encoder).expect("one frame was recorded");
    gpu().check().expect("no error of the device");
}
