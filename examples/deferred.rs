//! Shadows inside an application's own frame: its device, its G-buffer pass, the shadow pass and its shading pass in one
//! encoder and one submission.
//!
//! `cargo run --release --example deferred -- [--size WxH] [--samples N] [--map N] [--ground] [--out DIR] [SCENE]`
//!
//! The G-buffer is drawn with the hardware's rasterizer (triangle numbers, reversed depth); the shadow pass reads it and
//! writes a texture, which the shading pass multiplies with diffuse light. Three ways to hand it over follow each other:
//! triangle numbers; depth alone, as for an application that has no numbers, or draws what casts nothing; and the numbers of
//! four samples a pixel, from a multisampled texture, for a facet for each surface that they show. Each is held against rays through
//! the same samples. A last frame without a G-buffer is compared with what the library's own renderer gives: not a bit may differ.

use futures::executor::block_on;
use lab::arguments::Arguments;
use lab::report::{TracedScene, write_png_rgb};
use lab::scene::{Scene, SceneOptions};
use oracle::truth::Tracer;
use std::path::PathBuf;
use subpixel_shadows::glam::{DMat4, DVec3, DVec4};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::pass::{
    Casters, DepthTerms, GBuffer, Inputs, PassConfig, SampleTexture, SurfacePosition, SurfaceTextures, Target,
    TriangleTexture,
};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

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

// For a texture of several samples: the low half of the number and the high half.
@fragment
fn halves(at: Corner) -> @location(0) vec2<u32> {
    return vec2(at.id & 0xffffu, at.id >> 16u);
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

/// Where the application draws triangle numbers, with the pipeline that does.
struct Drawn {
    ids: wgpu::Texture,
    depth: wgpu::Texture,
    /// Stands for no triangle.
    nothing: wgpu::Color,
    draw: wgpu::RenderPipeline,
    mesh: wgpu::BindGroup,
}

/// The application: its device, its buffers and textures, its pipelines.
struct App {
    device: wgpu::Device,
    queue: wgpu::Queue,
    centres: Drawn,
    samples: Drawn,
    visibility: wgpu::Texture,
    image: wgpu::Buffer,
    size: [u32; 2],
    out: PathBuf,
    shade: wgpu::ComputePipeline,
    mesh: wgpu::BindGroup,
    screen: wgpu::BindGroup,
    vertices: u32,
}

fn main() -> Result<()> {
    let arguments = Arguments::of(std::env::args().skip(1))?;
    let options = SceneOptions { ground: arguments.ground, ..SceneOptions::default() };
    let (size, scene) = (arguments.size, Scene::open(&arguments.scenes[0], &options)?);
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
    let adapter =
        block_on(instance.request_adapter(&Default::default())).map_err(|e| Error::NoAdapter(e.to_string()))?;
    let descriptor = wgpu::DeviceDescriptor {
        required_features: ShadowPass::required_features() | (adapter.features() & ShadowPass::optional_features()),
        required_limits: ShadowPass::required_limits(),
        ..Default::default()
    };
    let (device, queue) = block_on(adapter.request_device(&descriptor)).map_err(|e| Error::Gpu(e.to_string()))?;
    let app = App::new(device, queue, &scene, size, arguments.out);

    let samples = Samples::new(Pattern::LowDiscrepancy, arguments.samples.unwrap_or(32))?;
    let settings = Settings { facets: FacetMode::One, ..Settings::new(size, arguments.map, samples) };
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let config = PassConfig { timing: true, receivers: true, ..PassConfig::new(settings.clone(), casters) };
    let mut pass = ShadowPass::new(&app.device, &app.queue, &config)?;
    let plain = Inputs::new(&scene.camera, &scene.light);
    let numbers = GBuffer::TriangleIds(TriangleTexture::new(&app.centres.ids));
    app.write_frame("deferred.png", &mut pass, &Inputs { gbuffer: numbers, ..plain })?;
    let by_numbers = app.read(pass.visibility())?;

    let terms = DepthTerms::reversed_infinite(scene.camera.near);
    let depth = SurfacePosition::Depth { texture: &app.centres.depth, terms, nothing: 0.0 };
    let surfaces = GBuffer::Surfaces(SurfaceTextures::new(depth));
    app.write_frame("deferred_depth.png", &mut pass, &Inputs { gbuffer: surfaces, ..plain })?;
    let by_depth = app.read(pass.visibility())?;
    let off = by_depth.iter().zip(&by_numbers).filter(|(a, b)| a != b).count();
    println!("{off} of {} pixels differ from those by triangle numbers", by_depth.len());

    let every = PassConfig::new(Settings { facets: FacetMode::All, ..settings.clone() }, casters);
    let mut every = ShadowPass::new(&app.device, &app.queue, &every)?;
    let samples = GBuffer::SampleIds(SampleTexture::new(&app.samples.ids, &SampleTexture::STANDARD_4));
    app.write_frame("deferred_samples.png", &mut every, &Inputs { gbuffer: samples, ..plain })?;

    let by_samples = app.read(every.visibility())?;

    app.complete_frame(&mut pass, &plain)?;
    let ours = app.read(pass.visibility())?;
    let gpu = Gpu::from_adapter(&adapter, None)?;
    let prepared = Prepared::new(&scene.mesh)?;
    hold_against_rays(&scene, &prepared, &settings, [&by_numbers, &by_depth, &by_samples])?;
    let theirs = Renderer::new(&gpu, &prepared, &settings, Budget::default())?.render(&scene.camera, &scene.light)?;
    let differ = ours.iter().zip(&theirs.visibility).filter(|(a, b)| **a != b.to_bits()).count();
    println!("{differ} of {} pixels differ from the renderer's", ours.len());
    if differ == 0 && ours.len() == theirs.visibility.len() {
        Ok(())
    } else {
        Err(Error::Gpu(format!("{differ} pixels differ from the renderer's")))
    }
}

/// Holds pictures by triangle numbers, by depth and by four samples' numbers against rays through the same samples.
fn hold_against_rays(scene: &Scene, prepared: &Prepared, settings: &Settings, pictures: [&[u32]; 3]) -> Result<()> {
    let tracer = Tracer::of(prepared)?;
    let truth = TracedScene::new(&tracer, &scene.camera, &scene.light, settings, None)?;
    let mut found = Vec::new();
    for (name, bits) in ["triangle numbers", "depth", "four samples' numbers"].into_iter().zip(pictures) {
        let visibility: Vec<f32> = bits.iter().map(|bits| f32::from_bits(*bits)).collect();
        let errors = truth.errors(&visibility)?;
        let (rmse, within) = (errors.scene_rmse, 100.0 * errors.scene_pixel_match.unwrap_or(1.0));
        println!("checked against rays, by {name}: RMSE {rmse:.5}, {within:.3} % of the pixels within one sample");
        found.push(rmse);
    }
    // Four samples are nearer than the centre alone, where a pixel shows several surfaces at all.
    if found[2] <= found[0] && found[0] < 0.2 {
        return Ok(());
    }
    Err(Error::Config(format!("the pictures are not those of rays: RMSE {found:?}")))
}

impl App {
    /// Frames until one is complete. A game would show them as they come, and look at the status now and then.
    fn complete_frame(&self, pass: &mut ShadowPass, inputs: &Inputs) -> Result<Vec<[u8; 3]>> {
        for _ in 0..8 {
            let mut encoder = self.device.create_command_encoder(&Default::default());
            self.record_gbuffer(&mut encoder, &self.centres);
            self.record_gbuffer(&mut encoder, &self.samples);
            let frame = pass.record(&mut encoder, inputs, &Target::texture(&self.visibility))?;
            self.record_shading(&mut encoder);
            self.queue.submit([encoder.finish()]);
            let shaded = self.read(&self.image)?;
            let Some(status) = pass.status() else { return Err(Error::Gpu(format!("frame {frame} has no status"))) };
            let gpu_ms = status.stages.iter().fold(0.0, |sum, s| sum + s.gpu_ms);
            let said = match (status.complete, status.overflowed) {
                (true, _) => "complete".to_owned(),
                (_, true) => "lists were too short, they grow".to_owned(),
                _ => format!("{:?}", status.faults),
            };
            println!("frame {frame}: {said}; {} strips, {} stages, {gpu_ms:.2} ms", pass.strips(), status.stages.len());
            if status.complete {
                return Ok(shaded.iter().map(|p| [0, 8, 16].map(|shift| (p >> shift) as u8)).collect());
            }
        }
        Err(Error::Gpu("no frame was complete".to_owned()))
    }

    /// A complete frame as a picture.
    fn write_frame(&self, name: &str, pass: &mut ShadowPass, inputs: &Inputs) -> Result<()> {
        let shaded = self.complete_frame(pass, inputs)?;
        std::fs::create_dir_all(&self.out).map_err(|e| Error::file(&self.out, e.to_string()))?;
        let path = self.out.join(name);
        write_png_rgb(&path, self.size[0], self.size[1], &shaded)?;
        println!("wrote {}", path.display());
        Ok(())
    }

    /// The application's first passes: triangle numbers and depth, at pixel centres and for four samples.
    fn record_gbuffer(&self, encoder: &mut wgpu::CommandEncoder, drawn: &Drawn) {
        let (ids, depth) = (drawn.ids.create_view(&Default::default()), drawn.depth.create_view(&Default::default()));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("g-buffer"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &ids,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(drawn.nothing), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&drawn.draw);
        pass.set_bind_group(0, &drawn.mesh, &[]);
        pass.draw(0..self.vertices, 0..1);
    }

    /// The application's last pass: light times visibility.
    fn record_shading(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass =
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("shade"), ..Default::default() });
        pass.set_pipeline(&self.shade);
        pass.set_bind_group(0, &self.mesh, &[]);
        pass.set_bind_group(1, &self.screen, &[]);
        pass.dispatch_workgroups(self.size[0].div_ceil(8), self.size[1].div_ceil(8), 1);
    }

    fn new(device: wgpu::Device, queue: wgpu::Queue, scene: &Scene, size: [u32; 2], out: PathBuf) -> Self {
        let [width, height] = size;
        let texture = |format, usage, sample_count| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
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
        let stored = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
        let visibility = texture(TextureFormat::R32Float, stored, 1);
        let bytes = vec![0; (4 * width * height) as usize];
        let kept = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let image = buffer(&bytes, kept | BufferUsages::COPY_SRC);
        let view =
            buffer(bytemuck::cast_slice(&view_words(scene, size)), BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let positions = buffer(bytemuck::cast_slice(&scene.mesh.positions), kept);
        let triangles = buffer(bytemuck::cast_slice(&scene.mesh.triangles), kept);

        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("application"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let draw = |number, format: TextureFormat, count| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
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
                multisample: wgpu::MultisampleState { count, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(number),
                    compilation_options: Default::default(),
                    targets: &[Some(format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
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
        let drawn = |number, format, samples, none| {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
            let draw = draw(number, format, samples);
            let mesh = group(&draw.get_bind_group_layout(0), &mesh);
            Drawn {
                ids: texture(format, usage, samples),
                depth: texture(TextureFormat::Depth32Float, usage, samples),
                nothing: wgpu::Color { r: none, g: none, b: 0.0, a: 0.0 },
                draw,
                mesh,
            }
        };
        let centres = drawn("number", TextureFormat::R32Uint, 1, f64::from(u32::MAX));
        let samples = drawn("halves", TextureFormat::Rg16Uint, 4, f64::from(u16::MAX));
        let views = [&centres.ids, &visibility].map(|t| t.create_view(&Default::default()));
        let textures = [0, 1].map(|k| wgpu::BindingResource::TextureView(&views[k]));
        let [id_view, visibility_view] = textures;
        let screen = group(&shade.get_bind_group_layout(1), &[id_view, visibility_view, image.as_entire_binding()]);
        let mesh = group(&shade.get_bind_group_layout(0), &mesh);
        let vertices = 3 * scene.mesh.triangles.len() as u32;
        Self { device, queue, centres, samples, visibility, image, size, out, shade, mesh, screen, vertices }
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
        Ok(bytemuck::pod_collect_to_vec(&view[..(4 * self.size[0] * self.size[1]) as usize]))
    }
}

/// Clip matrix with reversed depth and no far plane, eye, and light, as the shader takes them.
fn view_words(scene: &Scene, [width, height]: [u32; 2]) -> [f32; 24] {
    let rays = scene.camera.rays(width, height);
    let row = |axis: DVec3| axis.extend(-axis.dot(rays.eye));
    // Right and up, shortened by half the extent of the image at depth 1.
    let across = |step: DVec3, pixels: u32| row(step * (2.0 / (f64::from(pixels) * step.length_squared())));
    let (x, y, w) = (across(rays.step_x, width), across(-rays.step_y, height), row(rays.forward));
    let clip = DMat4::from_cols(x, y, DVec4::W * f64::from(scene.camera.near), w).transpose();
    let mut words = [0.0; 24];
    words[..16].copy_from_slice(&clip.as_mat4().to_cols_array());
    words[16..19].copy_from_slice(&scene.camera.eye);
    words[20..].copy_from_slice(&scene.light.homogeneous().as_vec4().to_array());
    words
}
