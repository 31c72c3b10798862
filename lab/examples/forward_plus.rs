//! Sixteen small spots over a floor of boxes, shaded forward: the lists of lights by tiles of the image say which lights a pixel has, and how visible each is.
//!
//! `cargo run --release --example forward_plus -- [--size WxH] [--samples N] [--out DIR]` draws a frame, holds every byte of the lists against
//! traced truth, and writes `forward_plus.png` and `lights.png`, how many lights a tile has.

#[path = "shared/asked.rs"]
mod asked;
#[path = "shared/picture.rs"]
mod picture;
#[path = "shared/read.rs"]
mod read;
#[path = "shared/sixteen_spots.rs"]
mod sixteen_spots;

use asked::Asked;
use lab::report::write_png_rgb;
use lab::scene::{Camera, Light, Mesh};
use oracle::reference::light_lists::{LightVolume, listed};
use oracle::truth::{SceneTruth, Tracer, join_mask};
use picture::picture;
use read::read;
use sixteen_spots::sixteen_spots;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::methods::Settings;
use subpixel_shadows::pass::{
    Casters, DepthTerms, Inputs, LightReach, LightTarget, PassConfig, Target, light_list_bytes, light_lists_wgsl,
};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::wgpu::{BufferUsages, TextureFormat, TextureUsages};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};
use test_support::status_of;

/// Range of the spots.
const RANGE: f32 = 6.0;
/// Depth at the near plane is 1, infinitely far 0.
const NEAR: f32 = 0.1;

/// The application's own shader: triangles with a normal each, and the lights that the lists name.
const SHADER: &str = "
struct Spot { at: vec4<f32>, towards: vec4<f32>, colour: vec4<f32> }
@group(0) @binding(0) var<uniform> clip: mat4x4<f32>;
@group(0) @binding(1) var<storage, read> corners: array<vec4<f32>>;
@group(0) @binding(2) var<uniform> spots: array<Spot, 16>;
struct Corner { @builtin(position) at: vec4<f32>, @location(0) world: vec3<f32> }
@vertex fn corner(@builtin(vertex_index) k: u32) -> Corner {
    let p = corners[k].xyz;
    return Corner(clip * vec4<f32>(p, 1.0), p);
}
@fragment fn shade(corner: Corner) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(corner.at.xy);
    let p = corner.world;
    let normal = normalize(cross(dpdy(p), dpdx(p)));
    var colour = vec3<f32>(0.02);
    for (var entry = first_light(pixel); entry != 0u;) {
        let listed = listed_light(entry, pixel);
        let spot = spots[listed.light];
        let to = spot.at.xyz - p;
        let way = normalize(to);
        let inside = smoothstep(spot.at.w, 1.0, dot(-way, spot.towards.xyz));
        let fall = max(1.0 - dot(to, to) / (spot.towards.w * spot.towards.w), 0.0);
        colour += listed.visibility * max(dot(normal, way), 0.0) * inside * fall * spot.colour.rgb;
        entry = listed.next;
    }
    // Red where a light had no room in the lists.
    return select(vec4<f32>(1.0, 0.0, 0.0, 1.0), vec4<f32>(sqrt(colour), 1.0), lists_all_lights(pixel));
}";

/// The frame's own shading pass.
struct Forward {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    image: wgpu::Texture,
    depth: wgpu::Texture,
    corners: u32,
}

impl Forward {
    fn new(
        gpu: &Gpu,
        mesh: &Mesh,
        camera: &Camera,
        lights: &[Light],
        size: [u32; 2],
        lists: &wgpu::Buffer,
    ) -> Result<Self> {
        let (device, queue) = (&gpu.device, &gpu.queue);
        let projection = DepthTerms::reversed_infinite(NEAR).projection(camera, size)?;
        let matrix = |m: [[f32; 4]; 4]| subpixel_shadows::glam::Mat4::from_cols_array_2d(&m);
        let clip = (matrix(projection) * matrix(camera.view())).to_cols_array_2d();
        let corners: Vec<[f32; 4]> = mesh
            .triangles
            .iter()
            .flatten()
            .map(|v| Vec3::from(mesh.positions[*v as usize]).extend(1.0).into())
            .collect();
        let spots: Vec<[f32; 4]> = (0..).zip(lights).flat_map(|(k, light)| spot(k, light)).collect();
        let uniform = |label: &str, data: &[[f32; 4]]| {
            let buffer = Buffer::uniform(device, label, data.len())?;
            buffer.write(queue, data);
            Ok::<_, Error>(buffer)
        };
        let (clip, spots) = (uniform("clip", &clip)?, uniform("spots", &spots)?);
        let held = Buffer::from_slice(device, queue, "corners", &corners)?;
        let text = format!("{}\n{SHADER}", light_lists_wgsl(0, 3));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("forward"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("forward"),
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
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("shade"),
                compilation_options: Default::default(),
                targets: &[Some(TextureFormat::Rgba8Unorm.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let buffers = [clip.raw(), held.raw(), spots.raw(), lists];
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = &pipeline.get_bind_group_layout(0);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
        let texture = |format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("forward"),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        Ok(Self {
            pipeline,
            group,
            image: texture(TextureFormat::Rgba8Unorm, TextureUsages::COPY_SRC),
            depth: texture(TextureFormat::Depth32Float, TextureUsages::TEXTURE_BINDING),
            corners: corners.len() as u32,
        })
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder) {
        let [image, depth] = [&self.image, &self.depth].map(|texture| texture.create_view(&Default::default()));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("forward"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &image,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..self.corners, 0..1);
    }
}

/// Volume of a spot.
fn volume(light: &Light) -> LightVolume {
    let at = light.homogeneous().truncate();
    let cone = match *light {
        Light::Spot { target, angle_degrees, .. } => {
            let axis = (Vec3::from(target).as_dvec3() - at).normalize();
            Some((axis, (0.5 * f64::from(angle_degrees).to_radians()).cos()))
        }
        _ => None,
    };
    LightVolume { at, range: f64::from(RANGE), cone }
}

/// A spot as the shader has it.
fn spot(k: u32, light: &Light) -> [[f32; 4]; 3] {
    let LightVolume { at, cone, .. } = volume(light);
    let (axis, cosine) = cone.unwrap_or((DVec3::NEG_Y, -1.0));
    let hue = |by: f64| (0.6 + 0.4 * (f64::from(k) * 2.4 + by).cos()) as f32;
    let vector = |v: DVec3, w: f32| v.as_vec3().extend(w).into();
    [vector(at, cosine as f32), vector(axis, RANGE), [hue(0.0), hue(2.1), hue(4.2), 1.0]]
}

fn main() -> Result<()> {
    let asked = Asked::of(std::env::args().skip(1), "out/forward_plus")?;
    let gpu = Gpu::open(None)?;
    println!("adapter: {}", gpu.adapter.name);
    let (mesh, camera, lights) = sixteen_spots();
    let settings = Settings::new(asked.size, 256, Samples::new(Pattern::LowDiscrepancy, asked.samples)?);
    let casters = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
    let config = PassConfig { light_lists: true, ..PassConfig::new(settings.clone(), casters) };
    let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &config)?;
    let asked_lights: Vec<LightTarget> = lights
        .iter()
        .map(|light| LightTarget { reach: LightReach::cone(RANGE), ..LightTarget::new(*light, Target::default()) })
        .collect();
    // Room for one light a tile, to begin with.
    let mut room = u64::from(asked.size[0].div_ceil(8)) * u64::from(asked.size[1].div_ceil(8));
    let tiles = room;
    for round in 0.. {
        let lists = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("light lists"),
            size: light_list_bytes(asked.size, room),
            usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let forward = Forward::new(&gpu, &mesh, &camera, &lights, asked.size, &lists)?;
        let mut encoder = gpu.encoder();
        let inputs = Inputs::new(&camera, &lights[0]);
        let frames = pass.record_light_lists(&mut encoder, &inputs, &asked_lights, &lists)?;
        forward.record(&mut encoder);
        gpu.submit_and_wait(encoder)?;
        let statuses: Vec<_> = frames.iter().flatten().map(|_| status_of(&mut pass)).collect();
        let needed = statuses.last().and_then(|s| s.light_lists.as_ref()).map_or(0, |list| list.needed);
        if statuses.iter().all(|status| status.complete) {
            println!(
                "{} of {} lights reach the image; {needed} entries in {tiles} tiles, {} KiB of lists",
                statuses.len(),
                lights.len(),
                lists.size() >> 10
            );
            return check(&gpu, &asked, &settings, (&mesh, &camera, &lights), &lists, &forward);
        }
        if round == 5 {
            return Err(Error::Gpu(format!("no complete frame: {statuses:?}")));
        }
        room = room.max(needed + needed / 8);
    }
    Ok(())
}

/// Holds the lists against rays and writes the pictures.
fn check(
    gpu: &Gpu,
    asked: &Asked,
    settings: &Settings,
    (mesh, camera, lights): (&Mesh, &Camera, &[Light]),
    lists: &wgpu::Buffer,
    forward: &Forward,
) -> Result<()> {
    let words: Vec<u32> = read(gpu, lists)?.iter().map(|word| word.to_bits()).collect();
    let [width, height] = asked.size;
    let of = |pixel: usize| listed(&words, [pixel % width as usize, pixel / width as usize]).0;
    let bytes: Vec<Vec<(u32, u8)>> = (0..(width * height) as usize).map(of).collect();
    let tracer = Tracer::new(mesh)?;
    let rays = camera.rays(width, height);
    let offsets = settings.samples.offsets();
    let points: Vec<Option<DVec3>> = (0..width * height)
        .flat_map(|pixel| offsets.iter().map(move |offset| (pixel, offset)))
        .map(|(pixel, offset)| {
            let (x, y) = (f64::from(pixel % width), f64::from(pixel / width));
            let way = rays.direction(x + f64::from(offset[0]), y + f64::from(offset[1]));
            tracer.closest(rays.eye, way, f64::from(camera.near)).map(|hit| rays.eye + way * hit.t)
        })
        .collect();
    let [mut sure, mut wrong] = [0u64; 2];
    for (k, light) in (0u32..).zip(lights) {
        let (volume, truth) =
            (volume(light), SceneTruth::new(&tracer, camera, light, &settings.samples, width, height)?);
        let around = |pixel: usize| truth.ambiguous_mask(pixel as u32);
        let image = truth.image(None);
        for ((pixel, p), at) in image.pixels.iter().enumerate().zip(points.chunks(offsets.len())) {
            let within: Vec<f64> = at.iter().map(|p| p.map_or(-1.0, |p| volume.within(p))).collect();
            // Rounding decides there.
            if join_mask(p.ambiguous) | join_mask(around(pixel)) != 0 || within.iter().any(|w| w.abs() < 1e-4) {
                continue;
            }
            let reached = (0..).zip(&within).filter(|(_, w)| **w > 0.0).fold(0u128, |mask, (k, _)| mask | 1 << k);
            let (seen, lit) = (join_mask(p.seen).count_ones(), (join_mask(p.lit) & reached).count_ones());
            let want = if lit == 0 { 0 } else { ((510 * lit + seen) / (2 * seen)) as u8 };
            let got = bytes[pixel].iter().find(|(light, _)| *light == k).map_or(0, |(_, byte)| *byte);
            sure += 1;
            wrong += u64::from(got != want);
        }
    }
    std::fs::create_dir_all(&asked.out).map_err(|e| Error::file(&asked.out, e.to_string()))?;
    write_png_rgb(&asked.out.join("forward_plus.png"), width, height, &picture(gpu, &forward.image)?)?;
    let count = |pixel: u32| {
        let tile = 4 + 2 * (pixel / width / 8 * words[2] + pixel % width / 8) as usize;
        let (mut entry, mut count) = (words[tile] & (u32::MAX >> 1), 0u32);
        while entry != 0 {
            entry = words[(5 + 2 * words[3] + 18 * (entry - 1)) as usize];
            count += 1;
        }
        [(60 * count).min(255) as u8; 3]
    };
    write_png_rgb(&asked.out.join("lights.png"), width, height, &(0..width * height).map(count).collect::<Vec<_>>())?;
    println!(
        "checked against rays through the same samples: {wrong} of {sure} bytes of visibility wrong ({} lights, {} samples a pixel); wrote {}",
        lights.len(),
        offsets.len(),
        asked.out.display()
    );
    if wrong > 0 {
        return Err(Error::Config(format!("{wrong} bytes are not those of rays")));
    }
    Ok(())
}
