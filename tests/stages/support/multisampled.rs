//! Multisampled textures of known texels.

use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::wgpu;

/// Samples of a texel.
pub const SAMPLES: u32 = 4;

const COPY: &str = "
@group(0) @binding(0) var<storage, read> texels: array<vec4<u32>>;
override FIRST: u32 = 0u;
override WIDTH: u32 = 1u;
fn texel(at: vec2<f32>) -> vec4<u32> {
    return texels[FIRST + u32(at.y) * WIDTH + u32(at.x)];
}
@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
@fragment fn words(@builtin(position) at: vec4<f32>) -> @location(0) vec4<u32> {
    return texel(at.xy);
}
@fragment fn floats(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return bitcast<vec4<f32>>(texel(at.xy));
}";

/// A texture of such texels: all of the first sample row by row, then those of the next. Words are the bits of floats where the format has these.
pub fn multisampled(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    texels: &[[u32; 4]],
) -> wgpu::TextureView {
    let device = &gpu.device;
    let pixels = width * height;
    assert_eq!(texels.len() as u32, SAMPLES * pixels);
    let texels = Buffer::from_slice(device, &gpu.queue, "test", texels).expect("memory");
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test.multisampled"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: SAMPLES,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let floats = format.sample_type(None, None) != Some(wgpu::TextureSampleType::Uint);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(COPY.into()),
    });
    let to = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let mut encoder = gpu.encoder();
    for sample in 0..SAMPLES {
        let constants = [("FIRST", f64::from(sample * pixels)), ("WIDTH", f64::from(width))];
        let with = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: None,
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: with.clone(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState { count: SAMPLES, mask: 1 << sample, alpha_to_coverage_enabled: false },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(if floats { "floats" } else { "words" }),
                compilation_options: with,
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: texels.raw().as_entire_binding() }],
        });
        let load = if sample == 0 { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &to,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    gpu.submit_and_wait(encoder).expect("the samples are written");
    to
}
