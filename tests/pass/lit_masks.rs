//! Lit masks read by a shader of an application's.

use super::*;
use subpixel_shadows::pass::{SampleTexture, lit_masks_wgsl};

/// Draws a triangle over the whole of a target, whose fragments show what the masks say: the visibility, that of the four hardware samples, and
/// the bits of the first 32 samples.
const SHADER: &str = "
@vertex fn corners(@builtin(vertex_index) k: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(k % 2u) * 4.0 - 1.0, f32(k / 2u) * 4.0 - 1.0, 0.0, 1.0);
}
struct Shown { @location(0) share: vec4<f32>, @location(1) bits: vec4<u32> }
@fragment fn shown(@builtin(position) at: vec4<f32>) -> Shown {
    let pixel = vec2<u32>(at.xy);
    var bits = vec4<u32>(0u);
    for (var k = 0u; k < SAMPLES; k++) {
        bits[k / 32u] |= u32(lit_sample(pixel, WIDTH, k)) << (k % 32u);
    }
    var hardware = 0.0;
    for (var k = 0u; k < 4u; k++) {
        hardware += lit_hardware(pixel, WIDTH, k);
    }
    let share = vec4<f32>(lit_fraction(pixel, WIDTH), hardware, lit_hardware(pixel, WIDTH, 0u), lit_hardware(pixel, WIDTH, 3u));
    return Shown(share, bits);
}
";

/// Reads the masks in a fragment shader: four shares and four words a pixel.
fn shown(samples: &Samples, lit: &wgpu::Buffer) -> (Vec<[f32; 4]>, Vec<[u32; 4]>) {
    let device = &gpu().device;
    let module = lit_masks_wgsl(samples, 1, 3, &SampleTexture::STANDARD_4).expect("a module");
    let text = format!("{module}\nconst SAMPLES = {}u;\nconst WIDTH = {}u;\n{SHADER}", samples.count(), SIZE[0]);
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("an application's"),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    });
    let entry = wgpu::BindGroupLayoutEntry {
        binding: 3,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let layouts = [&[][..], &[entry]]
        .map(|entries| device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries }));
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layouts[0]), Some(&layouts[1])],
        immediate_size: 0,
    });
    let formats = [TextureFormat::Rgba32Float, TextureFormat::Rgba32Uint];
    let targets = formats.map(|format| Some(format.into()));
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("corners"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("shown"),
            compilation_options: Default::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    });
    let groups = [(&layouts[0], None), (&layouts[1], Some(lit))].map(|(layout, lit)| {
        let entries: Vec<_> =
            lit.iter().map(|lit| wgpu::BindGroupEntry { binding: 3, resource: lit.as_entire_binding() }).collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    });
    let textures =
        formats.map(|format| texture(SIZE, format, TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC));
    let views = textures.each_ref().map(|texture| texture.create_view(&Default::default()));
    let attachments = views.each_ref().map(|view| {
        Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops: Default::default() })
    });
    let mut encoder = gpu().encoder();
    {
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor { color_attachments: &attachments, ..Default::default() });
        pass.set_pipeline(&pipeline);
        groups.iter().zip(0..).for_each(|(group, k)| pass.set_bind_group(k, group, &[]));
        pass.draw(0..3, 0..1);
    }
    gpu().submit_and_wait(encoder).expect("it is drawn");
    let [share, bits] = textures.each_ref().map(|texture| targets::bytes(texture, 0, 0));
    (bytemuck::pod_collect_to_vec(&share), bytemuck::pod_collect_to_vec(&bits))
}

#[gpu_test]
fn shaders_read_the_masks() {
    for count in [1, 8, 64] {
        let samples = Samples::new(Pattern::LowDiscrepancy, count).expect("samples");
        let scene = scene("windmill");
        let settings = Settings { samples: samples.clone(), ..settings(FacetMode::All) };
        let words = samples.words() as usize;
        let mut pass = pass(settings, casters(&scene.mesh));
        let picture = programs::picture(&mut pass, gpu(), &scene);
        let (visibility, masks) = picture.split_at(pass.visibility().size() as usize / 4);
        let (shares, bits) = shown(&samples, pass.lit().expect("lit masks"));
        // The hardware samples of each sample, by the definition.
        let nearest: Vec<Vec<usize>> = samples.offsets().iter().map(|o| nearest_of(*o)).collect();
        let count = count as usize;
        // Where the three functions depart from a pixel's mask.
        let fault = |pixel: usize, own: &[u32]| {
            let is_lit = |k: usize| own[k / 32] >> (k % 32) & 1 != 0;
            let lit = (0..count).filter(|&k| is_lit(k)).count() as f32;
            let of = |h: usize| {
                let mine: Vec<usize> = (0..count).filter(|&k| nearest[k].contains(&h)).collect();
                let mine = if mine.is_empty() { vec![0] } else { mine };
                mine.iter().filter(|&&k| is_lit(k)).count() as f32 / mine.len() as f32
            };
            let wanted = [lit / count as f32, (0..4).map(of).sum(), of(0), of(3)];
            let off = shares[pixel].iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            let other = (0..count).find(|&k| (bits[pixel][k / 32] >> (k % 32) & 1 != 0) != is_lit(k));
            (off > 1e-5 || other.is_some()).then(|| format!("{:?}, not {wanted:?}; sample {other:?}", shares[pixel]))
        };
        let mut partly = 0;
        for (pixel, own) in masks[..shares.len() * words].chunks(words).enumerate() {
            let [share, ..] = shares[pixel];
            assert_eq!(fault(pixel, own), None, "{count}, pixel {pixel}");
            let mut spoilt = own.to_vec();
            spoilt[0] ^= 1 << (pixel % count.min(32));
            assert!(fault(pixel, &spoilt).is_some(), "{count}, pixel {pixel}: a sample turned over passes");
            // Visibility is of the samples that see a surface.
            assert!(share <= f32::from_bits(visibility[pixel]) + 1e-6, "{count}, pixel {pixel}: {share}");
            partly += usize::from(share > 0.0 && share < 1.0);
        }
        assert!(partly > 50 || count == 1, "{count}: {partly} pixels are lit in part");
    }
}

/// The places of four hardware samples that are nearest to a sample.
fn nearest_of(o: [f32; 2]) -> Vec<usize> {
    let far: Vec<f64> =
        SampleTexture::STANDARD_4.iter().map(|h| (0..2).map(|c| f64::from(h[c] - o[c]).powi(2)).sum::<f64>()).collect();
    (0..4).filter(|&h| far.iter().all(|&other| far[h] <= other)).collect()
}
