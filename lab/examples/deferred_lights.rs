//! A deferred frame with all that real ones have: a G-buffer of four hardware samples a pixel, a camera that is jittered for temporal antialiasing, three
//! lights into the layers of a texture, and casters that are instances and turn from frame to frame.
//!
//! `cargo run --release --example deferred_lights -- [--size WxH] [--samples N] [--out DIR]` draws four jittered frames, holds the visibility of
//! each light in each against rays, by the pass's own search and by the G-buffer, and writes `deferred_lights.png`, the mean of the frames.

#[path = "shared/asked.rs"]
mod asked;
#[path = "shared/picture.rs"]
mod picture;
#[path = "shared/read.rs"]
mod read;

use asked::Asked;
use lab::report::{TracedScene, write_png_rgb};
use lab::scene::{Camera, Light, Mesh};
use oracle::truth::Tracer;
use picture::picture;
use read::read;
use subpixel_shadows::glam::{Mat4, Vec3};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::pass::{
    CasterMesh, Casters, DepthTerms, GBuffer, Inputs, LightTarget, PassConfig, Placed, SampleTexture, Target,
    TargetTexture, Transforms,
};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::wgpu::{BufferUsages, TextureFormat, TextureUsages};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use test_support::status_of;

/// Jitter of each frame, pixels.
const JITTER: [[f32; 2]; 4] = [[-0.125, -0.375], [0.375, -0.125], [0.125, 0.375], [-0.375, 0.125]];

const SHADER: &str = "
struct View { clip: mat4x4<f32>, eye: vec4<f32>, lights: array<vec4<f32>, 3> }
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> corners: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> rows: array<vec4<f32>>;
// Of each instance the first corner of its mesh, and the number of its first triangle.
@group(0) @binding(3) var<storage, read> firsts: array<vec2<u32>>;
@group(0) @binding(4) var visibility: texture_2d_array<f32>;
struct Corner {
    @builtin(position) at: vec4<f32>,
    @location(0) @interpolate(flat, either) id: u32,
    @location(1) world: vec3<f32>,
}
@vertex fn corner(@builtin(vertex_index) v: u32, @builtin(instance_index) k: u32) -> Corner {
    let p = vec4<f32>(corners[v].xyz, 1.0);
    let world = vec3<f32>(dot(rows[3u * k], p), dot(rows[3u * k + 1u], p), dot(rows[3u * k + 2u], p));
    let id = firsts[k].y + (v - firsts[k].x) / 3u;
    return Corner(view.clip * vec4<f32>(world, 1.0), id, world);
}
@fragment fn halves(corner: Corner) -> @location(0) vec2<u32> {
    return vec2<u32>(corner.id & 0xffffu, corner.id >> 16u);
}
@fragment fn shade(corner: Corner) -> @location(0) vec4<f32> {
    var normal = normalize(cross(dpdx(corner.world), dpdy(corner.world)));
    normal *= sign(dot(normal, view.eye.xyz - corner.world));
    var colours = array<vec3<f32>, 3>(vec3<f32>(0.3, 0.28, 0.24), vec3<f32>(0.3, 0.12, 0.06), vec3<f32>(0.06, 0.15, 0.3));
    var colour = vec3<f32>(0.04);
    for (var k = 0u; k < 3u; k++) {
        let light = view.lights[k];
        let way = normalize(light.xyz - light.w * corner.world);
        let lit = textureLoad(visibility, vec2<u32>(corner.at.xy), k, 0).x;
        colour += lit * max(dot(normal, way), 0.0) * colours[k];
    }
    return vec4<f32>(sqrt(colour), 1.0);
}";

/// Rows of a matrix whose fourth column is added.
type Transform = [[f32; 4]; 3];

/// A ring that stands upright.
fn ring() -> Mesh {
    const AROUND: [u32; 2] = [24, 12];
    let mut mesh = Mesh::default();
    for k in 0..AROUND[0] * AROUND[1] {
        let [turn, tube] = [k / AROUND[1], k % AROUND[1]];
        let angle = |k: u32, of: u32| std::f32::consts::TAU * k as f32 / of as f32;
        let ((s, c), (t, d)) = (angle(turn, AROUND[0]).sin_cos(), angle(tube, AROUND[1]).sin_cos());
        let radius = 0.45 + 0.13 * d;
        mesh.positions.push([radius * c, radius * s, 0.13 * t]);
        let at = |i: u32, j: u32| (turn + i) % AROUND[0] * AROUND[1] + (tube + j) % AROUND[1];
        mesh.triangles.extend([[at(0, 0), at(1, 0), at(0, 1)], [at(0, 1), at(1, 0), at(1, 1)]]);
    }
    mesh
}

/// Meshes, and the mesh of each instance: a floor, and nine rings above it.
struct World {
    meshes: [Mesh; 2],
    instances: Vec<u32>,
}

impl World {
    fn new() -> Self {
        let floor = Mesh {
            positions: vec![[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        Self { meshes: [floor, ring()], instances: [0].into_iter().chain([1; 9]).collect() }
    }

    /// Where the instances are at a moment.
    fn places(&self, moment: f32) -> Vec<Transform> {
        let ring = |k: usize| {
            let (s, c) = (moment + 0.7 * k as f32).sin_cos();
            let [x, z] = [k % 3, k / 3].map(|at| 1.5 * at as f32 - 1.5);
            [[c, 0.0, s, x], [0.0, 1.0, 0.0, 0.8], [-s, 0.0, c, z]]
        };
        let flat = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
        std::iter::once(flat).chain((0..9).map(ring)).collect()
    }

    /// The same as one mesh, by products in double precision rounded once.
    fn expanded(&self, places: &[Transform]) -> Mesh {
        let mut all = Mesh::default();
        for (mesh, rows) in self.instances.iter().map(|k| &self.meshes[*k as usize]).zip(places) {
            let first = all.positions.len() as u32;
            let moved = |p: &[f32; 3]| {
                rows.map(|r| (0..3).map(|k| f64::from(r[k]) * f64::from(p[k])).sum::<f64>() + f64::from(r[3]))
                    .map(|c| c as f32)
            };
            all.positions.extend(mesh.positions.iter().map(moved));
            all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| first + v)));
        }
        all
    }
}

/// The renderer of the application.
struct Deferred {
    ids: wgpu::Texture,
    depth: wgpu::Texture,
    colour: wgpu::Texture,
    image: wgpu::Texture,
    visibility: wgpu::Texture,
    number: wgpu::RenderPipeline,
    shade: wgpu::RenderPipeline,
    groups: [wgpu::BindGroup; 2],
    view: Buffer<[f32; 4]>,
    transforms: wgpu::Buffer,
    /// Corners of the mesh of each instance.
    drawn: Vec<std::ops::Range<u32>>,
}

impl Deferred {
    fn new(gpu: &Gpu, world: &World, [width, height]: [u32; 2]) -> Result<Self> {
        let (device, queue) = (&gpu.device, &gpu.queue);
        let texture = |format, usage, sample_count, layers| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("deferred"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let (mut corners, mut of_mesh) = (Vec::<[f32; 4]>::new(), Vec::new());
        for mesh in &world.meshes {
            let first = corners.len() as u32;
            let of = |v: &u32| -> [f32; 4] { Vec3::from(mesh.positions[*v as usize]).extend(1.0).into() };
            corners.extend(mesh.triangles.iter().flatten().map(of));
            of_mesh.push(first..corners.len() as u32);
        }
        let drawn: Vec<_> = world.instances.iter().map(|mesh| of_mesh[*mesh as usize].clone()).collect();
        let mut number = 0;
        let firsts: Vec<[u32; 2]> = drawn
            .iter()
            .map(|range| {
                let first = [range.start, number];
                number += range.len() as u32 / 3;
                first
            })
            .collect();
        let corners = Buffer::from_slice(device, queue, "corners", &corners)?;
        let firsts = Buffer::from_slice(device, queue, "firsts", &firsts)?;
        let view = Buffer::uniform(device, "view", 8)?;
        let transforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("transforms"),
            size: Transforms::BYTES * drawn.len() as u64,
            usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let source = wgpu::ShaderSource::Wgsl(SHADER.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("deferred"), source });
        let pipeline = |entry, format: TextureFormat, compare| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(entry),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("corner"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: TextureFormat::Depth32Float,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(compare),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState { count: 4, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    targets: &[Some(format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let number = pipeline("halves", TextureFormat::Rg16Uint, wgpu::CompareFunction::Greater);
        let shade = pipeline("shade", TextureFormat::Rgba8Unorm, wgpu::CompareFunction::Greater);
        let drawn_to = TextureUsages::RENDER_ATTACHMENT;
        let visibility =
            texture(TextureFormat::R8Unorm, TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST, 1, 3);
        let array = visibility.create_view(&Default::default());
        let resources = [
            view.raw().as_entire_binding(),
            corners.raw().as_entire_binding(),
            transforms.as_entire_binding(),
            firsts.raw().as_entire_binding(),
            wgpu::BindingResource::TextureView(&array),
        ];
        let group = |pipeline: &wgpu::RenderPipeline, count: usize| {
            let entries: Vec<_> = (0..)
                .zip(resources[..count].iter().cloned())
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            let layout = &pipeline.get_bind_group_layout(0);
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        };
        let groups = [group(&number, 4), group(&shade, 5)];
        Ok(Self {
            ids: texture(TextureFormat::Rg16Uint, drawn_to | TextureUsages::TEXTURE_BINDING, 4, 1),
            depth: texture(TextureFormat::Depth32Float, drawn_to, 4, 1),
            colour: texture(TextureFormat::Rgba8Unorm, drawn_to, 4, 1),
            image: texture(TextureFormat::Rgba8Unorm, drawn_to | TextureUsages::COPY_SRC, 1, 1),
            visibility,
            number,
            shade,
            groups,
            view,
            transforms,
            drawn,
        })
    }

    /// Writes what a frame is drawn from.
    fn write(&self, gpu: &Gpu, places: &[Transform], camera: &Camera, lights: &[Light], size: [u32; 2]) -> Result<()> {
        let projection = DepthTerms::reversed_infinite(camera.near).projection(camera, size)?;
        let matrix = |m: [[f32; 4]; 4]| Mat4::from_cols_array_2d(&m);
        let clip = (matrix(projection) * matrix(camera.view())).to_cols_array_2d();
        let eye = Vec3::from(camera.eye).extend(1.0).into();
        let lights = lights.iter().map(|light| light.homogeneous().as_vec4().into());
        let view: Vec<[f32; 4]> = clip.into_iter().chain([eye]).chain(lights).collect();
        self.view.write(&gpu.queue, &view);
        gpu.queue.write_buffer(&self.transforms, 0, bytemuck::cast_slice(places));
        Ok(())
    }

    /// Records triangle numbers, or the shaded picture.
    fn record(&self, encoder: &mut wgpu::CommandEncoder, shaded: bool) {
        let [ids, depth, colour, image] =
            [&self.ids, &self.depth, &self.colour, &self.image].map(|texture| texture.create_view(&Default::default()));
        let none = f64::from(u16::MAX);
        let (view, clear) = match shaded {
            true => (&colour, wgpu::Color::WHITE),
            false => (&ids, wgpu::Color { r: none, g: none, b: 0.0, a: 0.0 }),
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("deferred"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: shaded.then_some(&image),
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(if shaded { &self.shade } else { &self.number });
        pass.set_bind_group(0, &self.groups[usize::from(shaded)], &[]);
        (0..).zip(&self.drawn).for_each(|(k, corners): (u32, _)| pass.draw(corners.clone(), k..k + 1));
    }
}

fn main() -> Result<()> {
    let asked = Asked::of(std::env::args().skip(1), "out/deferred_lights")?;
    let (gpu, world) = (Gpu::open(None)?, World::new());
    println!("adapter: {}", gpu.adapter.name);
    let lights = [
        Light::Directional { direction: [-0.5, 0.9, 0.4] },
        Light::Point { position: [2.6, 2.2, 1.4] },
        Light::Spot { position: [-2.8, 3.0, 2.0], target: [0.0, 0.3, 0.0], angle_degrees: 70.0 },
    ];
    let camera = Camera::look_at([0.6, 4.4, 5.6], [0.0, 0.3, 0.0], [0.0, 1.0, 0.0], 42.0, 0.1);
    let settings = Settings::new(asked.size, 512, Samples::new(Pattern::LowDiscrepancy, asked.samples)?);
    let meshes = world.meshes.each_ref().map(|mesh| CasterMesh::new(&mesh.positions, &mesh.triangles));
    let casters = Casters::Instanced { meshes: &meshes, instances: &world.instances };
    let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &PassConfig::new(settings.clone(), casters))?;
    let app = Deferred::new(&gpu, &world, asked.size)?;
    let pixels = (asked.size[0] * asked.size[1]) as usize;
    let buffers = [(); 3].map(|()| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("lit"),
            size: 4 * u64::from(settings.samples.words()) * pixels as u64,
            usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    });
    let samples = GBuffer::SampleIds(SampleTexture::new(&app.ids, &SampleTexture::STANDARD_4));
    // The pass's own search, and the G-buffer: the mean square, pixels off by more than an eighth.
    let mut errors = [[0.0f64; 2]; 2];
    let mut sum = vec![[0u32; 3]; pixels];
    for (frame, jitter) in (0u8..).zip(JITTER) {
        let lens = camera.lens.jittered(jitter, asked.size);
        let camera = Camera { lens, ..camera };
        let places = world.places(0.02 * f32::from(frame));
        app.write(&gpu, &places, &camera, &lights, asked.size)?;
        let bounds = [[-4.0, -0.1, -4.0], [4.0, 1.6, 4.0]];
        let placed = Some(Placed { transforms: Transforms { buffer: &app.transforms, offset: 0 }, bounds });
        let prepared = Prepared::new(&world.expanded(&places))?;
        let tracer = Tracer::of(&prepared)?;
        let truths = lights
            .iter()
            .map(|light| TracedScene::new(&tracer, &camera, light, &settings, None))
            .collect::<Result<Vec<_>>>()?;
        for (error, gbuffer) in errors.iter_mut().zip([GBuffer::None, samples]) {
            let inputs = Inputs { placed, gbuffer, ..Inputs::new(&camera, &lights[0]) };
            for round in 0.. {
                let mut encoder = gpu.encoder();
                app.record(&mut encoder, false);
                let layer = |layer: u32| TargetTexture { layer, ..TargetTexture::new(&app.visibility) };
                let target = |k: u32| Target {
                    visibility: Some(layer(k)),
                    lit: Some(&buffers[k as usize]),
                    ..Target::default()
                };
                let to: Vec<LightTarget> =
                    (0..).zip(lights).map(|(k, light)| LightTarget::new(light, target(k))).collect();
                pass.record_lights(&mut encoder, &inputs, &to)?;
                app.record(&mut encoder, true);
                gpu.submit_and_wait(encoder)?;
                let statuses = lights.map(|_| status_of(&mut pass));
                if statuses.iter().all(|status| status.complete) {
                    break;
                }
                if round == 6 {
                    return Err(Error::Gpu(format!("no complete frame: {statuses:?}")));
                }
            }
            for (truth, lit) in truths.iter().zip(&buffers) {
                let visibility = shares(&gpu, &settings, lit, truth)?;
                let found = truth.errors(&visibility)?;
                error[0] += found.scene_rmse * found.scene_rmse / 12.0;
                let off = visibility.iter().zip(truth.visibility()).filter(|(a, b)| (**a - **b).abs() > 0.125).count();
                error[1] += off as f64 / (12 * pixels) as f64;
            }
        }
        let drawn = picture(&gpu, &app.image)?;
        sum.iter_mut().zip(drawn).for_each(|(sum, p)| (0..3).for_each(|k| sum[k] += u32::from(p[k])));
    }
    let mean: Vec<[u8; 3]> = sum.iter().map(|p| p.map(|c| (c / JITTER.len() as u32) as u8)).collect();
    std::fs::create_dir_all(&asked.out).map_err(|e| Error::file(&asked.out, e.to_string()))?;
    write_png_rgb(&asked.out.join("deferred_lights.png"), asked.size[0], asked.size[1], &mean)?;
    for (what, [square, off]) in ["its own search", "four samples of a G-buffer"].into_iter().zip(errors) {
        println!(
            "checked against rays, four jittered frames of three lights and ten instances, by {what}: RMSE {:.5}, {:.3} % of the pixels off by more than 1/8",
            square.sqrt(),
            100.0 * off
        );
    }
    println!("wrote {}", asked.out.display());
    match errors[0][0].sqrt() < 0.01 {
        true => Ok(()),
        false => Err(Error::Config("the pass's own search is not that of rays".to_owned())),
    }
}

/// Visibility from lit masks: of the samples that see a surface, as truth has it; 1 where none does.
fn shares(gpu: &Gpu, settings: &Settings, lit: &wgpu::Buffer, truth: &TracedScene) -> Result<Vec<f32>> {
    let words: Vec<u32> = read(gpu, lit)?.iter().map(|word| word.to_bits()).collect();
    let each = settings.samples.words() as usize;
    let share = |(lit, p): (&[u32], &oracle::truth::PixelTruth)| {
        let seen: u32 = p.seen[..each].iter().map(|word| word.count_ones()).sum();
        let bright: u32 = lit.iter().zip(&p.seen).map(|(lit, seen)| (lit & seen).count_ones()).sum();
        if seen == 0 { 1.0 } else { bright as f32 / seen as f32 }
    };
    Ok(words.chunks(each).zip(&truth.image.pixels).map(share).collect())
}
