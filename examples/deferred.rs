//! Shadows inside an application's own frame: its device, its G-buffer pass, the shadow pass and its shading pass in one
//! encoder and one submission.
//!
//! `cargo run --release --example deferred`
//!
//! The G-buffer is drawn with the hardware's rasterizer (triangle numbers, reversed depth); the shadow pass reads it and
//! writes a texture, which the shading pass multiplies with diffuse light. A second frame without the G-buffer is compared
//! with what the library's own renderer gives: not a bit may differ.

use futures::executor::block_on;
use std::path::Path;
use subpixel_shadows::glam::{DMat4, DVec3, DVec4};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::render::{Budget, Renderer};
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::pass::{Casters, GBuffer, Inputs, PassConfig, Target, TriangleTexture};
use subpixel_shadows::report::write_png_rgb;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Scene;
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

const SIZE: [u32; 2] = [640, 480];

const SHADER: &str = "
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> positions: array<f32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
@group(1) @binding(0) var ids: texture_2d<u32>;
@group(1) @binding(1) var visibility: texture_2d<f32>;
@group(1) @binding(2) var<storage, read_write> image: array<u32>;

struct View { clip: mat4x4<f32>, eye: vec4<f32>, light: vec4<f32> }
struct Corner { @builtin(position) clip: vec4<f32>, @location(0) @interpolate(flat, either) id: u32 }

fn corner(i: u32) -> vec3<f32> {
    let v = 3u * triangles[i];
    return vec3(positions[v], positions[v + 1u], positions[v + 2u]);
}

@vertex
fn draw(@builtin(vertex_index) i: u32) -> Corner {
    return Corner(view.clip * vec4(corner(i), 1.0), i / 3u);
}

@fragment
fn number(at: Corner) -> @location(0) u32 {
    return at.id;
}

@compute @workgroup_size(8, 8)
fn shade(@builtin(global_invocation_id) at: vec3<u32>) {
    let size = textureDimensions(ids);
    if at.x >= size.x || at.y >= size.y { return; }
    let t = textureLoad(ids, at.xy, 0).x;
    var colour = vec3(0.75, 0.82, 0.9);
    if t != 0xffffffffu {
        let a = corner(3u * t);
        let n = normalize(cross(corner(3u * t + 1u) - a, corner(3u * t + 2u) - a));
        let to_light = normalize(view.light.xyz - a * view.light.w);
        let seen = n * sign(dot(n, view.eye.xyz - a));
        let lit = max(dot(seen, to_light), 0.0) * textureLoad(visibility, at.xy, 0).x;
        colour = vec3(0.9, 0.85, 0.78) * (0.2 + 0.8 * lit);
    }
    image[at.y * size.x + at.x] = pack4x8unorm(vec4(sqrt(colour), 1.0));
}
";

/// The application: its device, its buffers and textures, its two pipelines.
struct App {
    device: wgpu::Device,
    queue: wgpu::Queue,
    ids: wgpu::Texture,
    depth: wgpu::Texture,
    visibility: wgpu::Texture,
    image: wgpu::Buffer,
    draw: wgpu::RenderPipeline,
    shade: wgpu::ComputePipeline,
    scene: [wgpu::BindGroup; 2],
    screen: wgpu::BindGroup,
    vertices: u32,
}

fn main() -> Result<()> {
    let scene = Scene::open("windmill", &Default::default())?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
    let adapter =
        block_on(instance.request_adapter(&Default::default())).map_err(|e| Error::NoAdapter(e.to_string()))?;
    let descriptor = wgpu::DeviceDescriptor {
        required_features: ShadowPass::required_features() | (adapter.features() & ShadowPass::optional_features()),
        required_limits: ShadowPass::required_limits(),
        ..Default::default()
    };
    let (device, queue) = block_on(adapter.request_device(&descriptor)).map_err(|e| Error::Gpu(e.to_string()))?;
    let app = App::new(device, queue, &scene);

    let settings = Settings::new(SIZE, 512, Samples::new(Pattern::LowDiscrepancy, 32)?);
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let config = PassConfig { timing: true, ..PassConfig::new(settings.clone(), casters) };
    let mut pass = ShadowPass::new(&app.device, &app.queue, &config)?;
    let plain = Inputs::new(&scene.camera, &scene.light);
    let gbuffer = GBuffer::TriangleIds(TriangleTexture::new(&app.ids));

    let shaded = app.complete_frame(&mut pass, &Inputs { gbuffer, ..plain })?;
    let path = Path::new("out/deferred.png");
    std::fs::create_dir_all("out").map_err(|e| Error::file("out", e.to_string()))?;
    write_png_rgb(path, SIZE[0], SIZE[1], &shaded)?;
    println!("wrote {}", path.display());

    app.complete_frame(&mut pass, &plain)?;
    let ours = app.read(pass.visibility())?;
    let gpu = Gpu::from_adapter(&adapter, None)?;
    let prepared = Prepared::new(&scene.mesh);
    let theirs = Renderer::new(&gpu, &prepared, &settings, Budget::default())?.render(&scene.camera, &scene.light)?;
    let differ = ours.iter().zip(&theirs.visibility).filter(|(a, b)| **a != b.to_bits()).count();
    println!("{differ} of {} pixels differ from the renderer's", ours.len());
    if differ == 0 && ours.len() == theirs.visibility.len() {
        Ok(())
    } else {
        Err(Error::Gpu(format!("{differ} pixels differ from the renderer's")))
    }
}

impl App {
    /// Frames until one is complete. A game would show them as they come, and look at the status now and then.
    fn complete_frame(&self, pass: &mut ShadowPass, inputs: &Inputs) -> Result<Vec<[u8; 3]>> {
        for _ in 0..8 {
            let mut encoder = self.device.create_command_encoder(&Default::default());
            self.record_gbuffer(&mut encoder);
            let frame = pass.record(&mut encoder, inputs, &Target { visibility: Some(&self.visibility), lit: None })?;
            self.record_shading(&mut encoder);
            self.queue.submit([encoder.finish()]);
            let shaded = self.read(&self.image)?;
            let Some(status) = pass.status() else { return Err(Error::Gpu(format!("frame {frame} has no status"))) };
            let gpu_ms: f64 = status.stages.iter().map(|s| s.gpu_ms).sum();
            let said = if status.complete { "complete" } else { "lists were too short, they grow" };
            println!("frame {frame}: {said}; {} stages, {gpu_ms:.2} ms", status.stages.len());
            if status.complete {
                return Ok(shaded.iter().map(|p| [0, 8, 16].map(|shift| (p >> shift) as u8)).collect());
            }
        }
        Err(Error::Gpu("no frame was complete".to_owned()))
    }

    /// The application's first pass: triangle numbers and depth.
    fn record_gbuffer(&self, encoder: &mut wgpu::CommandEncoder) {
        let (ids, depth) = (self.ids.create_view(&Default::default()), self.depth.create_view(&Default::default()));
        let nothing = wgpu::Color { r: f64::from(u32::MAX), g: 0.0, b: 0.0, a: 0.0 };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("g-buffer"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &ids,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(nothing), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.draw);
        pass.set_bind_group(0, &self.scene[0], &[]);
        pass.draw(0..self.vertices, 0..1);
    }

    /// The application's last pass: light times visibility.
    fn record_shading(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("shade"), ..Default::default() });
        pass.set_pipeline(&self.shade);
        pass.set_bind_group(0, &self.scene[1], &[]);
        pass.set_bind_group(1, &self.screen, &[]);
        pass.dispatch_workgroups(SIZE[0].div_ceil(8), SIZE[1].div_ceil(8), 1);
    }

    fn new(device: wgpu::Device, queue: wgpu::Queue, scene: &Scene) -> Self {
        let texture = |format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let buffer = |bytes: &[u8], usage| {
            let size = bytes.len() as u64;
            let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
            let buffer = device.create_buffer(&descriptor);
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let drawn = TextureUsages::RENDER_ATTACHMENT;
        let ids = texture(TextureFormat::R32Uint, drawn | TextureUsages::TEXTURE_BINDING);
        let depth = texture(TextureFormat::Depth32Float, drawn);
        let stored = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
        let visibility = texture(TextureFormat::R32Float, stored);
        let bytes = vec![0; (4 * SIZE[0] * SIZE[1]) as usize];
        let kept = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let image = buffer(&bytes, kept | BufferUsages::COPY_SRC);
        let view = buffer(bytemuck::cast_slice(&view_words(scene)), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let positions = buffer(bytemuck::cast_slice(&scene.mesh.positions), kept);
        let triangles = buffer(bytemuck::cast_slice(&scene.mesh.triangles), kept);

        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("application"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let draw = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("g-buffer"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("draw"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("number"),
                compilation_options: Default::default(),
                targets: &[Some(TextureFormat::R32Uint.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let shade = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("shade"),
            layout: None,
            module: &module,
            entry_point: Some("shade"),
            compilation_options: Default::default(),
            cache: None,
        });
        let group = |layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource]| {
            let numbered = (0..).zip(resources.iter().cloned());
            let entries: Vec<_> =
                numbered.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        };
        let mesh = [view.as_entire_binding(), positions.as_entire_binding(), triangles.as_entire_binding()];
        let views = [&ids, &visibility].map(|t| t.create_view(&Default::default()));
        let textures = [0, 1].map(|k| wgpu::BindingResource::TextureView(&views[k]));
        let [id_view, visibility_view] = textures;
        let screen = group(&shade.get_bind_group_layout(1), &[id_view, visibility_view, image.as_entire_binding()]);
        let both = [group(&draw.get_bind_group_layout(0), &mesh), group(&shade.get_bind_group_layout(0), &mesh)];
        let vertices = 3 * scene.mesh.triangles.len() as u32;
        Self { device, queue, ids, depth, visibility, image, draw, shade, scene: both, screen, vertices }
    }

    /// Waits for the GPU and reads a buffer.
    fn read(&self, buffer: &wgpu::Buffer) -> Result<Vec<u32>> {
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: buffer.size(),
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |_| {});
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| Error::Gpu(e.to_string()))?;
        let view = staging.get_mapped_range(..).map_err(|e| Error::Gpu(e.to_string()))?;
        Ok(bytemuck::pod_collect_to_vec(&view[..(4 * SIZE[0] * SIZE[1]) as usize]))
    }
}

/// Clip matrix with reversed depth and no far plane, eye, and light, as the shader takes them.
fn view_words(scene: &Scene) -> [f32; 24] {
    let rays = scene.camera.rays(SIZE[0], SIZE[1]);
    let row = |axis: DVec3| axis.extend(-axis.dot(rays.eye));
    // Right and up, shortened by half the extent of the image at depth 1.
    let across = |step: DVec3, pixels: u32| row(step * (2.0 / (f64::from(pixels) * step.length_squared())));
    let (x, y, w) = (across(rays.step_x, SIZE[0]), across(-rays.step_y, SIZE[1]), row(rays.forward));
    let clip = DMat4::from_cols(x, y, DVec4::W * f64::from(scene.camera.near), w).transpose();
    let mut words = [0.0; 24];
    words[..16].copy_from_slice(&clip.as_mat4().to_cols_array());
    words[16..19].copy_from_slice(&scene.camera.eye);
    words[20..].copy_from_slice(&scene.light.homogeneous().as_vec4().to_array());
    words
}
