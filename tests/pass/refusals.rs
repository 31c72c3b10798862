//! Bad input.

use super::*;

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
        refused(what, with(&inputs, &Target::texture(&texture)));
    }
    let pixels = u64::from(SIZE[0] * SIZE[1]) * 4;
    for (what, size, usage) in
        [("bytes", pixels - 4, BufferUsages::COPY_DST), ("lacks COPY_DST", pixels, BufferUsages::STORAGE)]
    {
        let buffer = buffer(size, usage);
        refused(what, with(&inputs, &Target { lit: Some(&buffer), ..Target::default() }));
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
