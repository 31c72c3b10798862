//! Targets of every format, layer, level and channel, and viewports.

use super::*;
use subpixel_shadows::pass::TargetTexture;

/// A texture of three layers and three levels, the second level of which holds an image at `ORIGIN` with room to spare.
fn array(format: TextureFormat, usage: TextureUsages) -> wgpu::Texture {
    gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test"),
        size: wgpu::Extent3d { width: 400, height: 200, depth_or_array_layers: 3 },
        mip_level_count: 3,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

const LEVEL: [u32; 2] = [200, 100];
const ORIGIN: [u32; 2] = [101, 37];

/// The bytes of a level and layer.
pub fn bytes(texture: &wgpu::Texture, level: u32, layer: u32) -> Vec<u8> {
    let texel = texture.format().block_copy_size(None).expect("a plain format");
    let [width, height] = [texture.width(), texture.height()].map(|side| side >> level);
    let row = (texel * width).next_multiple_of(256);
    let staging = buffer(u64::from(row * height), BufferUsages::COPY_DST | BufferUsages::MAP_READ);
    let mut encoder = gpu().encoder();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let origin = wgpu::Origin3d { x: 0, y: 0, z: layer };
    let from = wgpu::TexelCopyTextureInfo { mip_level: level, origin, ..texture.as_image_copy() };
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    encoder.copy_texture_to_buffer(from, wgpu::TexelCopyBufferInfo { buffer: &staging, layout }, size);
    gpu().queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu().wait(None).expect("the copies run");
    let bytes = staging.get_mapped_range(..).expect("mapped").to_vec();
    bytes.chunks(row as usize).flat_map(|r| r[..(texel * width) as usize].to_vec()).collect()
}

/// The values of a level of `LEVEL` texels, `channel` of four bytes.
fn values(texture: &wgpu::Texture, layer: u32, channel: usize) -> Vec<f32> {
    let bytes = bytes(texture, 1, layer);
    let half = |h: u16| match h >> 10 {
        0 => f32::from(h) / (1 << 24) as f32,
        exponent => (1.0 + f32::from(h & 1023) / 1024.0) * 2f32.powi(i32::from(exponent) - 15),
    };
    match texture.format() {
        TextureFormat::R8Unorm => bytes.iter().map(|&b| f32::from(b) / 255.0).collect(),
        TextureFormat::R16Float => bytes.chunks(2).map(|b| half(u16::from_le_bytes([b[0], b[1]]))).collect(),
        TextureFormat::R32Float => bytemuck::pod_collect_to_vec(&bytes),
        _ => bytes.chunks(4).map(|b| f32::from(b[channel]) / 255.0).collect(),
    }
}

/// The pixel farthest from what is wanted within the viewport, and the texels beside it that are not 0.
fn off(got: &[f32], wanted: &[f32]) -> (f32, usize) {
    let (mut worst, mut beside) = (0.0f32, 0);
    for (k, &v) in (0u32..).zip(got) {
        let at = [k % LEVEL[0], k / LEVEL[0]];
        if (0..2).all(|a| at[a] >= ORIGIN[a] && at[a] < ORIGIN[a] + SIZE[a]) {
            worst = worst.max((v - wanted[((at[1] - ORIGIN[1]) * SIZE[0] + at[0] - ORIGIN[0]) as usize]).abs());
        } else {
            beside += usize::from(v != 0.0);
        }
    }
    (worst, beside)
}

/// Each format at a level, layer and origin of its own holds the picture, in one piece and in strips, with the last picture kept and not; what lies
/// beside it stays.
#[gpu_test]
fn every_format_level_and_layer_takes_the_picture() {
    let scene = scene("windmill");
    let settings = settings(FacetMode::All);
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let wanted = rendered(&scene.mesh, &scene.camera, &scene.light, &settings).0.visibility;
    let (copy, store) = (TextureUsages::COPY_DST, TextureUsages::STORAGE_BINDING);
    for (strips, keep_last) in [(1, false), (3, false), (3, true)] {
        let config = PassConfig { strips, keep_last, ..PassConfig::new(settings.clone(), casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        complete(&mut pass, &inputs);
        for (format, usage, bound) in [
            (TextureFormat::R8Unorm, copy, 0.502 / 255.0),
            (TextureFormat::R16Float, copy, 1.0 / 4096.0),
            (TextureFormat::R32Float, copy, 0.0),
            (TextureFormat::R32Float, store, 0.0),
        ] {
            let texture = array(format, usage);
            let target = TargetTexture { level: 1, layer: 2, origin: Some(ORIGIN), ..TargetTexture::new(&texture) };
            let mut encoder = gpu().encoder();
            let target = Target { visibility: Some(target), ..Target::default() };
            pass.record(&mut encoder, &inputs, &target).expect("recorded");
            gpu().submit_and_wait(encoder).expect("the frame runs");
            gpu().check().expect("no error of the device");
            assert!(status_of(&mut pass).complete);
            let got = values(&texture, 2, 0);
            let (worst, beside) = off(&got, &wanted);
            assert!(worst <= bound && beside == 0, "{format:?}, {strips} strips: off by {worst}, {beside} beside it");
            // A texel that is moved is seen.
            let mut moved = got.clone();
            moved.rotate_right(1);
            assert!(off(&moved, &wanted).0 > 0.1, "{format:?}: a moved picture passes");
            assert!(values(&texture, 1, 0).iter().all(|&v| v == 0.0), "{format:?}: another layer");
        }
    }
}

/// Four lights in the channels of one texture, recorded into one encoder by one pass, and one channel anew: the others stay.
#[gpu_test]
fn four_lights_lie_in_one_texture() {
    let scene = scene("spheres");
    let settings = settings(FacetMode::All);
    let lights = [[0.5, 1.0, 0.3], [-0.6, 1.0, 0.1], [0.1, 1.0, -0.8], [0.9, 0.4, 0.2]]
        .map(|direction| Light::Directional { direction });
    let config = PassConfig { strips: 2, ..PassConfig::new(settings.clone(), casters(&scene.mesh)) };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let texture = array(TextureFormat::Rgba8Unorm, TextureUsages::COPY_DST);
    let mut of = |lights: &[(u32, Light)]| {
        for _ in 0..4 {
            let mut encoder = gpu().encoder();
            for &(channel, ref light) in lights {
                let to = TargetTexture { level: 1, channel, origin: Some(ORIGIN), ..TargetTexture::new(&texture) };
                let target = Target { visibility: Some(to), ..Target::default() };
                pass.record(&mut encoder, &Inputs::new(&scene.camera, light), &target).expect("recorded");
            }
            gpu().submit_and_wait(encoder).expect("the frames run");
            gpu().check().expect("no error of the device");
            if lights.iter().filter(|_| status_of(&mut pass).complete).count() == lights.len() {
                return;
            }
        }
        panic!("no complete frames by the fourth");
    };
    let all: Vec<(u32, Light)> = (0..).zip(lights).collect();
    of(&all);
    of(&[(2, lights[0])]);
    for (channel, light) in [lights[0], lights[1], lights[0], lights[3]].iter().enumerate() {
        let wanted = rendered(&scene.mesh, &scene.camera, light, &settings).0.visibility;
        let (worst, beside) = off(&values(&texture, 0, channel), &wanted);
        assert!(worst < 0.502 / 255.0 && beside == 0, "channel {channel}: off by {worst}, {beside} beside it");
        let other = rendered(&scene.mesh, &scene.camera, &lights[2], &settings).0.visibility;
        assert!(off(&values(&texture, 0, channel), &other).0 > 0.5, "channel {channel}: any light passes");
    }
}

/// Triangle numbers in a viewport of a larger texture: the picture is that of a texture of its own.
#[gpu_test]
fn a_gbuffer_is_read_in_a_viewport() {
    let settings = settings(FacetMode::One);
    let scene = scene("spheres");
    let (want, prepared) = rendered(&scene.mesh, &scene.camera, &scene.light, &settings);
    let ids: Vec<u32> =
        want.triangles.iter().map(|&t| prepared.given.get(t as usize).copied().unwrap_or(u32::MAX)).collect();
    // Texels beside it name no triangle of these.
    let mut all = vec![7_000_000u32; (LEVEL[0] * LEVEL[1]) as usize];
    for (k, &id) in (0u32..).zip(&ids) {
        all[((ORIGIN[1] + k / SIZE[0]) * LEVEL[0] + ORIGIN[0] + k % SIZE[0]) as usize] = id;
    }
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    let texture = texture(LEVEL, TextureFormat::R32Uint, usage);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * LEVEL[0]), rows_per_image: None };
    gpu().queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&all), layout, texture.size());
    let gbuffer = GBuffer::TriangleIds(TriangleTexture::new(&texture));
    let inputs = Inputs { gbuffer, ..Inputs::new(&scene.camera, &scene.light) };
    for strips in [1, 2] {
        let config = PassConfig { strips, ..PassConfig::new(settings.clone(), casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let (got, status) = complete(&mut pass, &Inputs { origin: Some(ORIGIN), ..inputs });
        assert_eq!(status.faults, Faults::default());
        assert_same(&format!("a viewport, {strips} strips"), &got, &picture(&want));
        let beside = frame(&mut pass, &Inputs { origin: Some([ORIGIN[0] - 1, ORIGIN[1]]), ..inputs });
        assert!(beside.1.faults.unknown_triangles > 0, "{:?}", beside.1.faults);
        let mut encoder = gpu().encoder();
        let mut with = |origin| pass.record(&mut encoder, &Inputs { origin, ..inputs }, &Target::default());
        for (origin, what) in
            [(None, "200x100 texels"), (Some([118, 0]), "at (118, 0)"), (Some([0, u32::MAX]), "do not hold")]
        {
            assert!(with(origin).is_err_and(|e| e.to_string().contains(what)), "{origin:?}");
        }
    }
}

#[gpu_test]
fn bad_targets_are_refused() {
    let scene = scene("plane");
    let mut pass = pass(settings(FacetMode::All), casters(&scene.mesh));
    let (copy, inputs) = (TextureUsages::COPY_DST, Inputs::new(&scene.camera, &scene.light));
    let (bytes, four) = (array(TextureFormat::R8Unorm, copy), array(TextureFormat::Rgba8Unorm, copy));
    let whole = TargetTexture { origin: Some([0, 0]), ..TargetTexture::new(&bytes) };
    let unread = texture(SIZE, TextureFormat::Rgba8Unorm, copy);
    let unwritten = texture(SIZE, TextureFormat::R8Unorm, TextureUsages::TEXTURE_BINDING);
    let mut encoder = gpu().encoder();
    for (what, target) in [
        ("level 3 of 3", TargetTexture { level: 3, ..whole }),
        ("layer 3 of 3", TargetTexture { layer: 3, ..whole }),
        ("channel 1", TargetTexture { channel: 1, ..whole }),
        ("channel 4", TargetTexture { channel: 4, ..TargetTexture { texture: &four, ..whole } }),
        ("200x100 texels do not hold", TargetTexture { level: 1, origin: Some([118, 0]), ..whole }),
        ("400x200 texels, the image", TargetTexture::new(&bytes)),
        ("COPY_SRC", TargetTexture::new(&unread)),
        ("COPY_DST", TargetTexture::new(&unwritten)),
    ] {
        let refused = pass.record(&mut encoder, &inputs, &Target { visibility: Some(target), ..Target::default() });
        assert!(refused.as_ref().is_err_and(|e| e.to_string().contains(what)), "{what}: {refused:?}");
    }
}
