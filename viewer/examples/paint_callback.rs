//! Shadows inside an egui window: a paint callback whose `prepare` records the shadow pass into egui's encoder, and whose `paint` shades with it.
//!
//! `cargo run --release -p subpixel-shadows-viewer --example paint_callback -- [--out DIR | --window] [SCENE]`
//!
//! Without a window egui draws into a texture: its picture is written as `egui.png`, its visibility held against rays through the same samples, and
//! each of its pixels against colour times visibility.

use egui_wgpu::{Callback, CallbackResources, CallbackTrait, Renderer, RendererOptions, ScreenDescriptor};
use lab::report::{TracedScene, write_png_rgb};
use lab::scene::{Scene, builtin};
use oracle::truth::Tracer;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use subpixel_shadows::glam::Vec3;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::Settings;
use subpixel_shadows::pass::{Casters, DepthTerms, Inputs, PassConfig, Target};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use wgpu::util::DeviceExt;
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

/// Pixels of the shadowed picture, and of all that egui draws.
const SIZE: [u32; 2] = [480, 360];
const WINDOW: [u32; 2] = [520, 420];

const SHADER: &str = "
struct View { clip: mat4x4<f32>, light: vec4<f32> }
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> corners: array<vec4<f32>>;
@group(0) @binding(0) var colour: texture_2d<f32>;
@group(0) @binding(1) var visibility: texture_2d<f32>;
struct Corner { @builtin(position) clip: vec4<f32>, @location(0) @interpolate(flat, either) shade: f32 }
struct Texel { @builtin(position) clip: vec4<f32>, @location(0) at: vec2<f32> }

@vertex
fn place(@builtin(vertex_index) i: u32) -> Corner {
    let first = i - i % 3u;
    let a = corners[first].xyz;
    let normal = normalize(cross(corners[first + 1u].xyz - a, corners[first + 2u].xyz - a));
    let way = normalize(view.light.xyz - view.light.w * a);
    return Corner(view.clip * vec4(corners[i].xyz, 1.0), abs(dot(normal, way)));
}

@fragment
fn diffuse(at: Corner) -> @location(0) vec4<f32> { return vec4(vec3(0.95, 0.9, 0.8) * at.shade, 1.0); }

@vertex
fn cover(@builtin(vertex_index) i: u32) -> Texel {
    let at = vec2(f32(i & 1u), f32(i >> 1u)) * 2.0;
    return Texel(vec4(at.x * 2.0 - 1.0, 1.0 - at.y * 2.0, 0.0, 1.0), at);
}

@fragment
fn shade(texel: Texel) -> @location(0) vec4<f32> {
    let at = vec2<i32>(texel.at * vec2<f32>(textureDimensions(visibility)));
    return vec4(textureLoad(colour, at, 0).rgb * (0.2 + 0.8 * textureLoad(visibility, at, 0).r), 1.0);
}
";

/// Pipelines that the callback draws with; egui keeps them.
struct Shown {
    pass: ShadowPass,
    scene: Arc<Scene>,
    draw: (wgpu::RenderPipeline, wgpu::BindGroup),
    shade: (wgpu::RenderPipeline, wgpu::BindGroup),
    colour: wgpu::Texture,
    depth: wgpu::Texture,
    visibility: wgpu::Texture,
    error: Option<Error>,
}

impl Shown {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue, scene: Arc<Scene>, shown_in: TextureFormat) -> Result<Self> {
        let settings = Settings::new(SIZE, 512, Samples::new(Pattern::LowDiscrepancy, 32)?);
        let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
        // Until a frame is complete the picture before it stands.
        let config = PassConfig { keep_last: true, ..PassConfig::new(settings, casters) };
        let pass = ShadowPass::new(device, queue, &config)?;
        let texture = |format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("paint_callback"),
                size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let (read, drawn) = (TextureUsages::TEXTURE_BINDING, TextureUsages::RENDER_ATTACHMENT);
        let colour = texture(TextureFormat::Rgba8Unorm, read | drawn | TextureUsages::COPY_SRC);
        let depth = texture(TextureFormat::Depth32Float, drawn);
        let visibility =
            texture(TextureFormat::R32Float, read | TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("paint_callback"),
            source: wgpu::ShaderSource::Wgsl(SHADER.into()),
        });
        let pipeline = |[vertex, fragment]: [&str; 2], format, depth_stencil| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(fragment),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState::from(format))],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let nearest = wgpu::DepthStencilState {
            format: depth.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: Default::default(),
            bias: Default::default(),
        };
        let draw = pipeline(["place", "diffuse"], colour.format(), Some(nearest));
        let shade = pipeline(["cover", "shade"], shown_in, None);
        let corners: Vec<[f32; 4]> = scene
            .mesh
            .triangles
            .iter()
            .flatten()
            .map(|&v| Vec3::from(scene.mesh.positions[v as usize]).extend(0.0).into())
            .collect();
        let view = scene.camera.view();
        let clip = DepthTerms::reversed_infinite(scene.camera.near).projection(&scene.camera, SIZE)?;
        let clip = subpixel_shadows::glam::Mat4::from_cols_array_2d(&clip)
            * subpixel_shadows::glam::Mat4::from_cols_array_2d(&view);
        let light = scene.light.homogeneous().as_vec4();
        let uniform: Vec<f32> = clip.to_cols_array().into_iter().chain(light.to_array()).collect();
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
        };
        let uniform = buffer(bytemuck::cast_slice(&uniform), BufferUsages::UNIFORM);
        let corners = buffer(bytemuck::cast_slice(&corners), BufferUsages::STORAGE);
        let group = |pipeline: &wgpu::RenderPipeline, resources: [wgpu::BindingResource; 2]| {
            let [a, b] = resources;
            let entries =
                [wgpu::BindGroupEntry { binding: 0, resource: a }, wgpu::BindGroupEntry { binding: 1, resource: b }];
            let layout = &pipeline.get_bind_group_layout(0);
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        };
        let of_mesh = group(&draw, [uniform.as_entire_binding(), corners.as_entire_binding()]);
        let [seen, lit] = [&colour, &visibility].map(|texture| texture.create_view(&Default::default()));
        let of_picture =
            group(&shade, [wgpu::BindingResource::TextureView(&seen), wgpu::BindingResource::TextureView(&lit)]);
        Ok(Self {
            pass,
            scene,
            draw: (draw, of_mesh),
            shade: (shade, of_picture),
            colour,
            depth,
            visibility,
            error: None,
        })
    }

    /// The application's own picture by the rasterizer, and the shadows on it.
    fn record(&mut self, encoder: &mut wgpu::CommandEncoder) -> Result<()> {
        let [colour, depth] = [&self.colour, &self.depth].map(|texture| texture.create_view(&Default::default()));
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("colour"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &colour,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&self.draw.0);
            pass.set_bind_group(0, &self.draw.1, &[]);
            pass.draw(0..3 * self.scene.mesh.triangles.len() as u32, 0..1);
        }
        let inputs = Inputs::new(&self.scene.camera, &self.scene.light);
        self.pass.record(encoder, &inputs, &Target::texture(&self.visibility))?;
        Ok(())
    }
}

/// The callback: egui makes it anew each frame.
struct Shadows;

impl CallbackTrait for Shadows {
    fn prepare(
        &self,
        _: &wgpu::Device,
        _: &wgpu::Queue,
        _: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(shown) = resources.get_mut::<Shown>() {
            shown.error = shown.record(encoder).err();
        }
        Vec::new()
    }

    fn paint(&self, _: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, resources: &CallbackResources) {
        // The viewport is the callback's rectangle.
        if let Some(shown) = resources.get::<Shown>() {
            pass.set_pipeline(&shown.shade.0);
            pass.set_bind_group(0, &shown.shade.1, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// The window's content; the place of the picture in it.
fn content(ui: &mut egui::Ui) -> egui::Rect {
    ui.heading("Shadows in egui");
    let size = egui::Vec2::from(SIZE.map(|side| side as f32 / ui.ctx().pixels_per_point()));
    let rect = egui::Rect::from_min_size(ui.cursor().min.round(), size);
    ui.painter().add(Callback::new_paint_callback(rect, Shadows));
    rect
}

fn fonts() -> egui::FontDefinitions {
    let mut fonts = egui::FontDefinitions::empty();
    let data = egui::FontData::from_static(epaint_default_fonts::UBUNTU_LIGHT);
    fonts.font_data.insert("Ubuntu-Light".to_owned(), Arc::new(data));
    for family in [egui::FontFamily::Proportional, egui::FontFamily::Monospace] {
        fonts.families.insert(family, vec!["Ubuntu-Light".to_owned()]);
    }
    fonts
}

/// The words of a texture's rows.
fn texels(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<[u8; 4]>> {
    let [width, height] = [texture.width(), texture.height()];
    let row = (4 * width).next_multiple_of(256);
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("paint_callback.read"),
        size: u64::from(row) * u64::from(height),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &staging, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    gpu.queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait(None)?;
    let bytes = staging.get_mapped_range(..).map_err(|e| Error::Gpu(e.to_string()))?;
    let rows = bytes.chunks(row as usize).map(|row| &row[..4 * width as usize]);
    Ok(rows.flat_map(|row| bytemuck::cast_slice::<u8, [u8; 4]>(row).to_vec()).collect())
}

/// egui's frames into a texture, until one is complete.
fn headless(scene: Arc<Scene>, out: &Path) -> Result<()> {
    let gpu = Gpu::open(None)?;
    let target = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("window"),
        size: wgpu::Extent3d { width: WINDOW[0], height: WINDOW[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba8Unorm,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let mut renderer = Renderer::new(&gpu.device, target.format(), RendererOptions::default());
    renderer.callback_resources.insert(Shown::new(&gpu.device, &gpu.queue, scene.clone(), target.format())?);
    let context = egui::Context::default();
    context.set_fonts(fonts());
    let size = egui::Vec2::from(WINDOW.map(|side| side as f32));
    let screen = ScreenDescriptor { size_in_pixels: WINDOW, pixels_per_point: 1.0 };
    let none = || Error::Gpu("egui has lost what it was given".to_owned());
    let mut rect = egui::Rect::NOTHING;
    for round in 0.. {
        let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size));
        let input = egui::RawInput { screen_rect, ..Default::default() };
        let mut output = context.run_ui(input, |ui| rect = content(ui));
        for (id, deltas) in &output.textures_delta.set {
            deltas.iter().for_each(|delta| renderer.update_texture(&gpu.device, &gpu.queue, *id, delta));
        }
        output.textures_delta.clear();
        let shapes = context.tessellate(output.shapes, output.pixels_per_point);
        let mut encoder = gpu.encoder();
        renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &shapes, &screen);
        {
            let view = target.create_view(&Default::default());
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("egui"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            renderer.render(&mut pass.forget_lifetime(), &shapes, &screen);
        }
        gpu.submit_and_wait(encoder)?;
        let shown = renderer.callback_resources.get_mut::<Shown>().ok_or_else(none)?;
        if let Some(error) = shown.error.take() {
            return Err(error);
        }
        let complete = std::iter::from_fn(|| shown.pass.status()).last().is_some_and(|status| status.complete);
        if complete {
            break;
        }
        if round == 8 {
            return Err(Error::Gpu("no complete frame by the ninth".to_owned()));
        }
    }
    let shown = renderer.callback_resources.get::<Shown>().ok_or_else(none)?;
    let window = texels(&gpu, &target)?;
    let visibility = texels(&gpu, &shown.visibility)?.into_iter().map(f32::from_le_bytes).collect::<Vec<_>>();
    let colour = texels(&gpu, &shown.colour)?;
    std::fs::create_dir_all(out).map_err(|e| Error::file(out, e.to_string()))?;
    let rgb: Vec<[u8; 3]> = window.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    write_png_rgb(&out.join("egui.png"), WINDOW[0], WINDOW[1], &rgb)?;
    let first = [rect.min.x as usize, rect.min.y as usize];
    let shaded = |k: &usize| {
        let [x, y] = [k % SIZE[0] as usize, k / SIZE[0] as usize];
        let got = rgb[(first[1] + y) * WINDOW[0] as usize + first[0] + x];
        let want = colour[*k].map(|c| f32::from(c) * (0.2 + 0.8 * visibility[*k]));
        (0..3).all(|c| (f32::from(got[c]) - want[c]).abs() <= 1.0)
    };
    let shaded = (0..visibility.len()).filter(shaded).count();
    let prepared = scene.prepared()?;
    let tracer = Tracer::of(&prepared)?;
    let truth = TracedScene::new(&tracer, &scene.camera, &scene.light, shown.pass.settings(), None)?;
    let errors = truth.errors(&visibility)?;
    let mut moved = visibility.clone();
    moved.rotate_right(1);
    let moved = truth.errors(&moved)?.scene_rmse;
    println!(
        "checked against rays through the same {} samples: RMSE {:.5}, largest difference {:.3}, {:.3} % of {} pixels within one sample; {shaded} of {} pixels of the window are colour times visibility; wrote {}",
        32 * visibility.len(),
        errors.scene_rmse,
        errors.scene_max,
        100.0 * errors.scene_pixel_match.unwrap_or(1.0),
        errors.scene_pixels,
        visibility.len(),
        out.display()
    );
    // The comparison must tell a picture that is moved by a pixel.
    if shaded < visibility.len() || errors.scene_rmse > 0.01 || moved < 0.02 {
        return Err(Error::Gpu("the picture is not that of the rays".to_owned()));
    }
    Ok(())
}

/// The same in a window.
struct Application;

impl eframe::App for Application {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        content(ui);
        ui.ctx().request_repaint();
    }
}

fn window(scene: Arc<Scene>) -> Result<()> {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size(WINDOW.map(|side| side as f32)),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: viewer::configuration(),
        ..Default::default()
    };
    let made = move |created: &eframe::CreationContext| -> std::result::Result<Box<dyn eframe::App>, _> {
        let render = created.wgpu_render_state.as_ref().ok_or("no device")?;
        created.egui_ctx.set_fonts(fonts());
        let shown = Shown::new(&render.device, &render.queue, scene, render.target_format)?;
        render.renderer.write().callback_resources.insert(shown);
        Ok(Box::new(Application))
    };
    let ran = eframe::run_native("paint_callback", options, Box::new(made));
    ran.map_err(|e| Error::NoAdapter(format!("no window: {e}")))
}

fn run() -> Result<()> {
    let (mut name, mut out, mut windowed) = ("windmill".to_owned(), PathBuf::from("out/paint_callback"), false);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--window" => windowed = true,
            "--out" => out = words.next().ok_or_else(|| Error::Config("--out needs a value".to_owned()))?.into(),
            _ => name = word,
        }
    }
    let scene = builtin(&name).ok_or_else(|| Error::Config(format!("no built-in scene '{name}'")))?;
    if windowed { window(Arc::new(scene)) } else { headless(Arc::new(scene), &out) }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
