//! The pass with an application's G-buffer: surfaces by depth or position, be they casters or not, and triangle numbers of
//! several samples a pixel.

#[path = "shared/device.rs"]
mod device;
#[path = "shared/frames.rs"]
mod frames;

use device::gpu;
use frames::status_of;
use gpu_test::gpu_test;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::pass::{
    Casters, DepthTerms, Faults, FrameStatus, GBuffer, Inputs, Moved, PassConfig, SampleTexture, SurfacePosition,
    SurfaceTextures, Target, TriangleTexture, Vertices,
};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh, Scene, builtin};
use subpixel_shadows::truth::{FacetInput, FacetResult, FacetTruth, Tracer};
use subpixel_shadows::{Error, ShadowPass, wgpu};
use wgpu::{TextureFormat, TextureUsages};

const SIZE: [u32; 2] = [83, 61];
const PIXELS: usize = (SIZE[0] * SIZE[1]) as usize;

fn settings(facets: FacetMode, count: u32) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, count).expect("samples");
    Settings { facets, ..Settings::new(SIZE, 64, samples) }
}

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

fn pass(settings: Settings, mesh: &Mesh) -> ShadowPass {
    let casters = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
    let config = PassConfig { receivers: settings.facets == FacetMode::One, ..PassConfig::new(settings, casters) };
    ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
}

fn texture([width, height]: [u32; 2], layers: u32, format: TextureFormat, bytes: &[u8]) -> wgpu::Texture {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers };
    let texture = gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    if !bytes.is_empty() {
        let row = bytes.len() as u32 / height / layers;
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(height) };
        gpu().queue.write_texture(texture.as_image_copy(), bytes, layout, size);
    }
    texture
}

/// Visibility and lit words.
#[derive(Clone, Debug, PartialEq)]
struct Picture {
    visibility: Vec<f32>,
    lit: Vec<u32>,
}

fn read(buffer: &wgpu::Buffer) -> Vec<u32> {
    let (device, queue) = (&gpu().device, &gpu().queue);
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("test"),
        size: buffer.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu().encoder();
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu().wait(None).expect("the copy runs");
    let bytes = staging.get_mapped_range(..).expect("mapped").to_vec();
    bytemuck::pod_collect_to_vec(&bytes)
}

/// The first frame that no list was too short for.
fn frame(pass: &mut ShadowPass, inputs: &Inputs) -> (Picture, FrameStatus) {
    for _ in 0..6 {
        let mut encoder = gpu().encoder();
        pass.record(&mut encoder, inputs, &Target::default()).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        let status = status_of(pass);
        gpu().check().expect("no error of the device");
        if !status.overflowed {
            let mut visibility: Vec<f32> = bytemuck::cast_vec(read(pass.visibility()));
            visibility.truncate(PIXELS);
            return (Picture { visibility, lit: read(pass.lit().expect("lit masks")) }, status);
        }
    }
    panic!("no lists that suffice by the sixth frame");
}

/// What a rasterizer would write at each pixel centre of a scene: triangle, view depth and normal, by the pass itself.
struct Raster {
    triangles: Vec<Option<u32>>,
    points: Vec<Option<(DVec3, f64, DVec3)>>,
}

fn raster(mesh: &Mesh, camera: &Camera) -> Raster {
    use subpixel_shadows::render::{Budget, Renderer};
    let prepared = Prepared::new(mesh).expect("a sound mesh");
    let mut renderer =
        Renderer::new(gpu(), &prepared, &settings(FacetMode::One, 1), Budget::default()).expect("a renderer");
    let seen = renderer.render(camera, &Light::Directional { direction: [0.3, 1.0, 0.2] }).expect("a frame").triangles;
    let triangles: Vec<Option<u32>> = seen.iter().map(|&t| prepared.given.get(t as usize).copied()).collect();
    let rays = camera.rays(SIZE[0], SIZE[1]);
    let point = |(pixel, t): (usize, &Option<u32>)| {
        let [a, b, c] = mesh.triangles[(*t)? as usize].map(|v| Vec3::from(mesh.positions[v as usize]).as_dvec3());
        let normal = (b - a).cross(c - a);
        let (x, y) = (pixel % SIZE[0] as usize, pixel / SIZE[0] as usize);
        let ray = rays.direction(x as f64 + 0.5, y as f64 + 0.5);
        let depth = normal.dot(a - rays.eye) / normal.dot(ray);
        Some((rays.eye + ray * depth, depth, normal.normalize()))
    };
    let points = triangles.iter().enumerate().map(point).collect();
    Raster { triangles, points }
}

impl Raster {
    fn depths(&self, terms: DepthTerms, nothing: f32) -> Vec<f32> {
        let [a, b, c, d] = [terms.scale, terms.offset, terms.w_scale, terms.w_offset].map(f64::from);
        let value = |z: f64| ((a * z + b) / (c * z + d)) as f32;
        self.points.iter().map(|p| p.map_or(nothing, |(_, z, _)| value(z))).collect()
    }

    fn positions(&self) -> Vec<[f32; 4]> {
        let texel =
            |p: &Option<(DVec3, f64, DVec3)>| p.map_or([7.0, 7.0, 7.0, 0.0], |p| p.0.as_vec3().extend(1.0).into());
        self.points.iter().map(texel).collect()
    }

    fn normals(&self) -> Vec<[f32; 4]> {
        self.points.iter().map(|p| p.map_or([0.0; 4], |p| (p.2 * 3.0).as_vec3().extend(0.0).into())).collect()
    }

    fn ids(&self, count: usize) -> Vec<u32> {
        self.triangles.iter().map(|t| t.filter(|&t| (t as usize) < count).unwrap_or(u32::MAX)).collect()
    }
}

fn floats(format: TextureFormat, values: &[f32]) -> wgpu::Texture {
    texture(SIZE, 1, format, bytemuck::cast_slice(values))
}

/// A depth texture that hardware wrote: `Depth32Float` can only be rendered to.
fn rendered_depth(values: &[f32]) -> wgpu::Texture {
    let device = &gpu().device;
    let from = floats(TextureFormat::R32Float, values);
    let depth = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test.depth"),
        size: from.size(),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Depth32Float,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(
            "@group(0) @binding(0) var values: texture_2d<f32>;
             @vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
                 return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
             }
             @fragment fn copy(@builtin(position) at: vec4<f32>) -> @builtin(frag_depth) f32 {
                 return textureLoad(values, vec2<u32>(at.xy), 0).x;
             }"
            .into(),
        ),
    });
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        }],
    });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
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
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("copy"),
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(&from.create_view(&Default::default())),
        }],
    });
    let mut encoder = gpu().encoder();
    {
        let view = depth.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.5), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    gpu().submit_and_wait(encoder).expect("the depth is written");
    depth
}

#[track_caller]
fn assert_same(what: &str, got: &Picture, want: &Picture) {
    let wrong = (0..PIXELS).filter(|&p| got.visibility[p].to_bits() != want.visibility[p].to_bits());
    let wrong: Vec<_> = wrong.map(|p| (p, got.visibility[p], want.visibility[p])).collect();
    assert!(wrong.is_empty(), "{what}: {} pixels differ: {:?}", wrong.len(), &wrong[..wrong.len().min(8)]);
    assert_eq!(got.lit, want.lit, "{what}");
    let shares = |v: f32| want.visibility.iter().filter(|&&w| w == v).count();
    assert!(shares(0.0) > 50 && shares(1.0) > 50, "{what}: nothing to see");
}

/// The same visibility, of the same samples: where all that count are lit, those that do not count may differ.
fn assert_same_shadows(what: &str, got: &Picture, want: &Picture) {
    let counted = |picture: &Picture| {
        let lit = |p: usize| if want.visibility[p] < 1.0 { picture.lit[p] } else { u32::MAX };
        Picture { visibility: picture.visibility.clone(), lit: (0..PIXELS).map(lit).collect() }
    };
    assert_same(what, &counted(got), &counted(want));
}

/// Every convention of depth, in either format, and positions: where all surfaces are casters the picture is that of the
/// triangle numbers, and that of the pass alone. A depth that is off, or of another convention, is another picture.
#[gpu_test]
fn surfaces_of_casters_are_the_casters() {
    for name in ["windmill", "spheres", "bicycle"] {
        let scene = scene(name);
        let seen = raster(&scene.mesh, &scene.camera);
        let mut pass = pass(settings(FacetMode::One, 32), &scene.mesh);
        let plain = Inputs::new(&scene.camera, &scene.light);
        let (want, _) = frame(&mut pass, &plain);
        let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&seen.ids(usize::MAX)));
        let numbers = TriangleTexture::new(&ids);
        let (by_ids, _) = frame(&mut pass, &Inputs { gbuffer: GBuffer::TriangleIds(numbers), ..plain });
        assert_same(&format!("{name}: numbers"), &by_ids, &want);
        let mut ask = |what: &str, textures: SurfaceTextures| {
            let (got, status) = frame(&mut pass, &Inputs { gbuffer: GBuffer::Surfaces(textures), ..plain });
            assert!(status.complete, "{name}, {what}: {status:?}");
            got
        };
        let (near, far) = (scene.camera.near.max(0.1), scene.camera.far);
        for (what, terms, nothing) in [
            ("reversed infinite", DepthTerms::reversed_infinite(near), 0.0),
            ("reversed", DepthTerms::reversed(near, far), 0.0),
            ("infinite", DepthTerms::infinite(near), 1.0),
            ("standard", DepthTerms::standard(near, far), 1.0),
            ("linear", DepthTerms::linear(), -1.0),
        ] {
            let values = seen.depths(terms, nothing);
            let depth = floats(TextureFormat::R32Float, &values);
            let place = SurfacePosition::Depth { texture: &depth, terms, nothing };
            assert_same_shadows(&format!("{name}: {what}"), &ask(what, SurfaceTextures::new(place)), &want);
            if what == "linear" {
                let off: Vec<f32> = values.iter().map(|v| v * 0.97).collect();
                let depth = floats(TextureFormat::R32Float, &off);
                let off = SurfacePosition::Depth { texture: &depth, terms, nothing: -0.97 };
                assert!(ask("a depth that is off", SurfaceTextures::new(off)) != want, "a wrong depth passes");
                let ids = Some(numbers);
                let saved = ask("with numbers", SurfaceTextures { ids, ..SurfaceTextures::new(off) });
                assert_same_shadows(&format!("{name}: numbers before depth"), &saved, &want);
                continue;
            }
            let depth = rendered_depth(&values);
            let place = SurfacePosition::Depth { texture: &depth, terms, nothing };
            assert_same_shadows(&format!("{name}: {what}, rendered"), &ask(what, SurfaceTextures::new(place)), &want);
        }
        let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
        let place = SurfacePosition::Position(&positions);
        assert_same_shadows(&format!("{name}: positions"), &ask("positions", SurfaceTextures::new(place)), &want);
    }
}

/// The mesh without its ground, which is put behind all other triangles of the first of the two.
fn grounded(name: &str, gap: f32) -> (Mesh, Mesh, Scene) {
    let mut scene = scene(name);
    let (lo, hi) = scene.mesh.bounds().expect("a mesh");
    let low = lo.y as f32;
    let wide = 0.25 * (hi - lo).length() as f32;
    let flat = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| Vec3::from(scene.mesh.positions[v as usize]));
        a.max(b).max(c).y <= low + 1e-3 * (hi.y - lo.y) as f32 || (b - a).length().max((c - a).length()) > wide
    };
    let casters = Mesh {
        positions: scene.mesh.positions.clone(),
        triangles: scene.mesh.triangles.iter().copied().filter(|t| !flat(t)).collect(),
    };
    let (mut all, base) = (casters.clone(), casters.positions.len() as u32);
    let (wide, y) = (3.0 * (hi - lo).length() as f32, low - gap * (hi.y - lo.y) as f32);
    let middle = (lo + hi) * 0.5;
    for [x, z] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
        all.positions.push([middle.x as f32 + x * wide, y, middle.z as f32 + z * wide]);
    }
    all.triangles.extend([[0, 2, 1], [0, 3, 2]].map(|t: [u32; 3]| t.map(|v| v + base)));
    scene.mesh = all.clone();
    (all, casters, scene)
}

/// Facet truth of what each pixel shows.
fn judged(seen: &Raster, all: &Mesh, scene: &Scene, settings: &Settings) -> Vec<(FacetInput, FacetResult)> {
    let tracer = Tracer::new(all).expect("a tracer");
    let [w, h] = SIZE;
    let truth = FacetTruth::new(&tracer, &scene.camera, &scene.light, &settings.samples, w, h).expect("a truth");
    let coverage = [u32::MAX, 0, 0, 0];
    let input = |(pixel, t): (u32, &Option<u32>)| Some(FacetInput { pixel, triangle: (*t)?, coverage });
    let inputs: Vec<_> = (0..).zip(&seen.triangles).filter_map(input).collect();
    let results = truth.judge(&inputs, None).expect("judged");
    inputs.into_iter().zip(results).collect()
}

/// Samples that differ outside the ambiguity band of facet truth, and inside, of the pixels that `asked` says. Samples that a
/// ground among the casters cuts off are not looked at.
fn differing(
    asked: &dyn Fn(usize) -> bool,
    got: &Picture,
    want: &Picture,
    truth: &[(FacetInput, FacetResult)],
) -> [u32; 2] {
    let mut out = [0; 2];
    for (input, result) in truth.iter().filter(|(input, _)| asked(input.pixel as usize)) {
        let off = (got.lit[input.pixel as usize] ^ want.lit[input.pixel as usize]) & result.valid[0];
        out[0] += (off & !result.ambiguous()[0]).count_ones();
        out[1] += (off & result.ambiguous()[0]).count_ones();
    }
    out
}

/// A sheet over a floor, and one that runs through it: of 8 x 8 squares each, 81 vertices.
fn sheets() -> Scene {
    let mut mesh = Mesh::default();
    for (half, height, slope) in [(1.0, 0.5, 0.0), (2.0, -0.3, 0.0), (0.8, 0.5, 0.7)] {
        let base = mesh.positions.len() as u32;
        for v in 0..81u32 {
            let [x, z] = [v % 9, v / 9].map(|k| (k as f32 / 4.0 - 1.0) * half);
            mesh.positions.push([x, height + slope * x + 1e-3 * z, z]);
        }
        for a in (0..72).filter(|v| v % 9 < 8).map(|v| v + base) {
            mesh.triangles.extend([[a, a + 9, a + 1], [a + 1, a + 9, a + 10]]);
        }
    }
    let camera = Camera::framing(DVec3::new(-1.2, -0.3, -1.2), DVec3::new(1.2, 0.5, 1.2));
    Scene { mesh, camera, ..scene("spheres") }
}

/// Casters and what only receives, in one another's midst: what is settled early is as light as evaluation says.
#[gpu_test]
fn settled_receivers_are_as_evaluated() {
    for name in ["sheets", "spheres", "plant", "cage"] {
        let scene = if name == "sheets" { sheets() } else { scene(name) };
        let (lo, hi) = scene.mesh.bounds().expect("a mesh");
        let cell = (hi - lo).length() / 7.0;
        let casts = |t: &[u32; 3]| {
            if name == "sheets" {
                return t.iter().all(|&v| v < 81);
            }
            let p = (Vec3::from(scene.mesh.positions[t[0] as usize]).as_dvec3() - lo) / cell;
            (p.x.floor() + p.y.floor() + p.z.floor()) as i64 % 2 == 0
        };
        let (mut order, receivers): (Vec<_>, Vec<_>) = scene.mesh.triangles.iter().copied().partition(casts);
        let casters = Mesh { positions: scene.mesh.positions.clone(), triangles: order.clone() };
        order.extend(receivers);
        let all = Mesh { positions: scene.mesh.positions.clone(), triangles: order };
        let seen = raster(&all, &scene.camera);
        let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
        let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
        let ids = seen.ids(casters.triangles.len());
        let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&ids));
        let gbuffer = GBuffer::Surfaces(SurfaceTextures {
            normals: Some(&normals),
            ids: Some(TriangleTexture::new(&ids)),
            ..SurfaceTextures::new(SurfacePosition::Position(&positions))
        });
        for count in [1, 32] {
            let with = |settle| Settings { settle, ..settings(FacetMode::One, count) };
            let [mut settled, mut evaluated] = [true, false].map(|settle| pass(with(settle), &casters));
            let mut last = None;
            let directional = [[0.5, 1.0, 0.3], [-0.7, 0.6, 0.2]].map(|direction| Light::Directional { direction });
            // Among the casters: a cube of views.
            let position = (lo + (hi - lo) * DVec3::new(0.45, 0.55, 0.6)).as_vec3().into();
            for light in directional.into_iter().chain([Light::Point { position }]) {
                let inputs = Inputs { gbuffer, ..Inputs::new(&scene.camera, &light) };
                let (got, status) = frame(&mut settled, &inputs);
                let (want, _) = frame(&mut evaluated, &inputs);
                let early = status.counts.lit_facets + status.counts.shadowed_facets;
                assert!(early > 300, "{name}: {early} facets are settled");
                // Which samples of a lit pixel another surface cuts off is not looked at once it is settled.
                let off = |p: &usize| got.visibility[*p].to_bits() != want.visibility[*p].to_bits();
                let off: Vec<_> = (0..PIXELS).filter(off).collect();
                assert!(off.is_empty(), "{name}, {count} samples, {light:?}: pixels {off:?} differ");
                assert!(last.replace(got.clone()) != Some(got), "{name}: another light changes nothing");
            }
        }
    }
}

/// A ground that is taken out of the casters and given as depth or position only has the shadows that it has as a caster, for
/// every kind of light, also far beyond the casters' box and behind the light.
#[gpu_test]
fn a_ground_that_casts_nothing_receives() {
    let (mut compared, mut in_shadow, mut noticed) = (0, 0, 0);
    for (name, lights) in [("bicycle", [1.0, 0.3]), ("spheres", [0.4, 1.5]), ("plant", [1.0, 0.15])] {
        let (all, casters, scene) = grounded(name, 0.01);
        assert!(casters.triangles.len() > 1000 && all.triangles.len() == casters.triangles.len() + 2);
        let seen = raster(&all, &scene.camera);
        let on_ground = |p: usize| seen.triangles[p].is_some_and(|t| t as usize >= casters.triangles.len());
        let count = (0..PIXELS).filter(|&p| on_ground(p)).count();
        assert!(count > 400, "{name}: {count} pixels of ground");
        compared += 1;
        let (lo, hi) = casters.bounds().expect("a mesh");
        let position = ((lo + hi) * 0.5 + DVec3::new(0.3, 1.0, 0.4) * (hi - lo).length() * 1.2).as_vec3().into();
        let beside = ((lo + hi) * 0.5 + DVec3::new(1.4, 0.8, 0.6) * (hi - lo).length()).as_vec3().into();
        let first = Light::Directional { direction: [0.5, lights[0], 0.3] };
        let mut given = vec![
            first,
            Light::Directional { direction: [-0.6, lights[1], 0.8] },
            Light::Point { position },
            Light::Point { position: beside },
        ];
        // Among the casters: a cube of views.
        let among = match name {
            "spheres" => Some([0.8, 1.9, 0.9]),
            "plant" => Some([0.3, 1.3, 0.2]),
            _ => None,
        };
        given.extend(among.map(|position| Light::Point { position }));
        for light in given {
            let counts: &[u32] = if light == first { &[1, 32] } else { &[32] };
            for &samples in counts {
                let settings = settings(FacetMode::One, samples);
                let scene = Scene { light, ..scene.clone() };
                let plain = Inputs::new(&scene.camera, &scene.light);
                let (want, _) = frame(&mut pass(settings.clone(), &all), &plain);
                let truth = judged(&seen, &all, &scene, &settings);
                let mut pass = pass(settings.clone(), &casters);
                let terms = DepthTerms::reversed_infinite(0.1);
                let depth = floats(TextureFormat::R32Float, &seen.depths(terms, 0.0));
                let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
                let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
                let ids = seen.ids(casters.triangles.len());
                let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&ids));
                let by_depth = SurfaceTextures::new(SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 });
                let by_position = SurfaceTextures::new(SurfacePosition::Position(&positions));
                let ids = Some(TriangleTexture::new(&ids));
                for (what, given) in [
                    ("depth", by_depth),
                    ("position", by_position),
                    ("position, normals, numbers", SurfaceTextures { normals: Some(&normals), ids, ..by_position }),
                    ("depth, numbers", SurfaceTextures { ids, ..by_depth }),
                ] {
                    let (got, status) = frame(&mut pass, &Inputs { gbuffer: GBuffer::Surfaces(given), ..plain });
                    assert!(status.complete, "{name}, {what}: {status:?}");
                    // Without normals, a pixel of ground must have another near in its row and its column.
                    let across = |p: usize| {
                        (1..5).any(|d| p % 83 >= d && on_ground(p - d) || p % 83 + d < 83 && on_ground(p + d))
                    };
                    let along = |p: usize| {
                        (1..5).any(|d| {
                            p >= 83 * d && on_ground(p - 83 * d) || p + 83 * d < PIXELS && on_ground(p + 83 * d)
                        })
                    };
                    let asked = |p: usize| !on_ground(p) || given.normals.is_some() || across(p) && along(p);
                    let [wrong, open] = differing(&asked, &got, &want, &truth);
                    let shadowed = (0..PIXELS).filter(|&p| on_ground(p) && want.visibility[p] < 1.0).count();
                    println!(
                        "{name} {light:?} {samples} {what}: {wrong} samples differ, {open} in the band; {shadowed} of {count} pixels of ground in shadow"
                    );
                    in_shadow += shadowed;
                    assert_eq!(wrong, 0, "{name}, {light:?}, {samples} samples, {what}");
                    assert!(u64::from(open) * 500 < PIXELS as u64 * u64::from(samples), "{name}, {what}: {open}");
                    // The comparison must notice one pixel.
                    let mut off = got.clone();
                    let Some(pixel) = (0..PIXELS).find(|&p| on_ground(p) && asked(p) && want.lit[p] == 0) else {
                        continue;
                    };
                    off.lit[pixel] = !0;
                    assert!(differing(&asked, &off, &want, &truth)[0] > 0);
                    noticed += 1;
                }
            }
        }
    }
    assert!(noticed > 10, "a wrong pixel was noticed {noticed} times");
    assert!(compared == 3 && in_shadow > 5000, "{compared} scenes, {in_shadow} pixels of ground in shadow");
}

/// Texels that are no number, infinite, behind the eye or without direction are counted, and count as nothing.
#[gpu_test]
fn texels_that_are_no_place_are_faults() {
    let (all, casters, scene) = grounded("spheres", 0.01);
    let seen = raster(&all, &scene.camera);
    let mut pass = pass(settings(FacetMode::One, 32), &casters);
    let plain = Inputs::new(&scene.camera, &scene.light);
    let grounds: Vec<usize> =
        (0..PIXELS).filter(|&p| seen.triangles[p].is_some_and(|t| t as usize >= casters.triangles.len())).collect();
    let mut ask = |textures: SurfaceTextures| {
        let (got, status) = frame(&mut pass, &Inputs { gbuffer: GBuffer::Surfaces(textures), ..plain });
        assert_eq!(status.complete, status.faults == Faults::default());
        (got, status.faults.unusable_surfaces as usize)
    };
    let terms = DepthTerms::reversed_infinite(0.1);
    let good = seen.depths(terms, 0.0);
    let depth = floats(TextureFormat::R32Float, &good);
    let (clean, none) = ask(SurfaceTextures::new(SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 }));
    assert_eq!(none, 0);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.25, 1e-38] {
        let mut values = good.clone();
        let at: Vec<usize> = grounds.iter().copied().step_by(97).collect();
        at.iter().for_each(|&p| values[p] = bad);
        let depth = floats(TextureFormat::R32Float, &values);
        let (got, faults) = ask(SurfaceTextures::new(SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 }));
        assert_eq!(faults, at.len(), "{bad}");
        for p in 0..PIXELS {
            if at.contains(&p) {
                assert_eq!(got.visibility[p], 1.0);
            } else {
                assert_eq!(got.visibility[p].to_bits(), clean.visibility[p].to_bits(), "{bad} spoils pixel {p}");
            }
        }
    }
    let positions = seen.positions();
    for (k, bad) in [f32::NAN, f32::INFINITY, -1e30].into_iter().enumerate() {
        let mut texels = positions.clone();
        texels[grounds[5]][k] = bad;
        let texture = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&texels));
        assert_eq!(ask(SurfaceTextures::new(SurfacePosition::Position(&texture))).1, 1, "{bad}");
    }
    let places = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&positions));
    for bad in [[f32::NAN, 1.0, 0.0, 0.0], [0.0, f32::INFINITY, 1.0, 0.0], [0.0; 4]] {
        let mut texels = seen.normals();
        texels[grounds[9]] = bad;
        let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&texels));
        let given =
            SurfaceTextures { normals: Some(&normals), ..SurfaceTextures::new(SurfacePosition::Position(&places)) };
        assert_eq!(ask(given).1, 1, "{bad:?}");
    }
}

#[track_caller]
fn refused(what: &str, result: Result<u64, Error>) {
    match result {
        Err(Error::Config(text)) => {
            assert!(text.contains(what) && !text.contains('\n'), "'{what}' expected: {text}");
        }
        other => panic!("{what}: {other:?}"),
    }
}

#[gpu_test]
fn bad_surfaces_are_refused() {
    let scene = scene("plane");
    let mut pass = pass(settings(FacetMode::One, 32), &scene.mesh);
    let plain = Inputs::new(&scene.camera, &scene.light);
    let mut encoder = gpu().encoder();
    let none = Target::default();
    let good = texture(SIZE, 1, TextureFormat::R32Float, &[]);
    let ids = texture(SIZE, 1, TextureFormat::R32Uint, &[]);
    let terms = DepthTerms::standard(0.1, 10.0);
    let depth = |texture| SurfaceTextures::new(SurfacePosition::Depth { texture, terms, nothing: 1.0 });
    let mut with = |given: SurfaceTextures| {
        pass.record(&mut encoder, &Inputs { gbuffer: GBuffer::Surfaces(given), ..plain }, &none)
    };
    let small = texture([7, 5], 1, TextureFormat::R32Float, &[]);
    refused("7x5", with(depth(&small)));
    refused("Depth32Float or R32Float", with(depth(&ids)));
    refused("Rgba32Float", with(SurfaceTextures::new(SurfacePosition::Position(&good))));
    refused("normal", with(SurfaceTextures { normals: Some(&good), ..depth(&good) }));
    refused("triangle id", with(SurfaceTextures { ids: Some(TriangleTexture::new(&good)), ..depth(&good) }));
    for tolerance in [f32::NAN, -1.0, 1.0] {
        refused("tolerance", with(SurfaceTextures { tolerance, ..depth(&good) }));
    }
    let with_terms = |terms, nothing| SurfaceTextures::new(SurfacePosition::Depth { texture: &good, terms, nothing });
    refused("no surface", with(with_terms(terms, f32::NAN)));
    for (scale, offset) in [(0.0, 0.0), (f32::NAN, 1.0), (0.0, f32::INFINITY)] {
        refused("view depths", with(with_terms(DepthTerms { scale, offset, ..DepthTerms::infinite(0.1) }, 1.0)));
    }
    // A projection of another field of view or aspect than the camera's.
    let fov = scene.camera.vertical_fov_degrees;
    let projection = |degrees: f32, aspect: f32| {
        let of = glam::camera::rh::proj::directx::perspective_infinite_reverse(degrees.to_radians(), aspect, 0.1);
        DepthTerms::of_projection(of).expect("a projection")
    };
    let aspect = SIZE[0] as f32 / SIZE[1] as f32;
    with(with_terms(projection(fov, aspect), 0.0)).expect("the camera's own");
    for (terms, number) in [
        (projection(fov + 1.0, aspect), format!("camera of {fov} degrees")),
        (projection(fov, aspect * 1.01), format!("{}x{}", SIZE[0], SIZE[1])),
    ] {
        refused(&number, with(with_terms(terms, 0.0)));
    }
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let mut without =
        ShadowPass::new(&gpu().device, &gpu().queue, &PassConfig::new(settings(FacetMode::One, 32), casters))
            .expect("a pass");
    let inputs = Inputs { gbuffer: GBuffer::Surfaces(depth(&good)), ..plain };
    refused("room for receivers", without.record(&mut encoder, &inputs, &none));
    let mut every = self::pass(settings(FacetMode::All, 32), &scene.mesh);
    refused("one sample", every.record(&mut encoder, &inputs, &none));
    gpu().submit_and_wait(encoder).expect("one frame was recorded");
    gpu().check().expect("no error of the device");
}

/// What each of a picture's samples sees, by the full search: a layer of triangle numbers for each sample.
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
        let partition = Some(SplitPlan { splits: 2, warp: Warp::Fitted, focus: 0.6 });
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

/// In strips of rows a pixel shows what it shows in one piece, though neighbours are looked at that other strips hold; faults are
/// counted once.
#[gpu_test]
fn surfaces_in_strips_are_the_whole() {
    let (all, casters, scene) = grounded("spheres", 0.01);
    let seen = raster(&all, &scene.camera);
    let plain = Inputs::new(&scene.camera, &scene.light);
    let terms = DepthTerms::reversed_infinite(0.1);
    // On the right only every fourth row sees something, so that neighbours lie as far as is looked; one pixel in each row is no place.
    let mut values = seen.depths(terms, 0.0);
    (0..PIXELS).filter(|p| p % 83 > 40 && p / 83 % 4 != 2).for_each(|p| values[p] = 0.0);
    (0..PIXELS).filter(|p| p % 83 == 40).for_each(|p| values[p] = f32::NAN);
    let depth = floats(TextureFormat::R32Float, &values);
    let positions = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.positions()));
    let normals = texture(SIZE, 1, TextureFormat::Rgba32Float, bytemuck::cast_slice(&seen.normals()));
    let numbers = seen.ids(casters.triangles.len());
    let ids = texture(SIZE, 1, TextureFormat::R32Uint, bytemuck::cast_slice(&numbers));
    let by_depth = SurfaceTextures::new(SurfacePosition::Depth { texture: &depth, terms, nothing: 0.0 });
    let by_position = SurfaceTextures::new(SurfacePosition::Position(&positions));
    let ids = Some(TriangleTexture::new(&ids));
    let words: Vec<[f32; 4]> = casters.positions.iter().map(|&[x, y, z]| [x, y, z, f32::NAN]).collect();
    let rest = Buffer::from_slice(&gpu().device, &gpu().queue, "test", &words).expect("memory");
    let (low, high) = casters.bounds().expect("a mesh");
    let bounds = [(low - 0.01).as_vec3().into(), (high + 0.01).as_vec3().into()];
    let at_rest = Moved { vertices: Vertices { buffer: rest.raw(), offset: 0, stride: 16 }, bounds };
    for (what, given) in [
        ("depth", by_depth),
        ("depth, numbers", SurfaceTextures { ids, ..by_depth }),
        ("position, normals", SurfaceTextures { normals: Some(&normals), ..by_position }),
    ] {
        let inputs = Inputs { gbuffer: GBuffer::Surfaces(given), ..plain };
        let slices = SplitPlan { splits: 3, warp: Warp::Fitted, focus: 0.6 };
        let in_strips_of = |strips, partition, casters, inputs: &Inputs| {
            let settings = Settings { partition, ..settings(FacetMode::One, 32) };
            let config = PassConfig { receivers: true, strips, ..PassConfig::new(settings, casters) };
            let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
            (frame(&mut pass, inputs), pass.strips())
        };
        let (positions, triangles) = (&casters.positions, &casters.triangles);
        let standing = Casters::Static { positions, triangles };
        let in_strips = |strips| in_strips_of(strips, None, standing, &inputs);
        let ((want, status), _) = in_strips(1);
        // Seen by the light in slices of what the camera sees.
        let ((got, of_slices), _) = in_strips_of(1, Some(slices), standing, &inputs);
        assert_same_shadows(&format!("{what}, in slices"), &got, &want);
        assert_eq!(of_slices.faults, status.faults, "{what}, in slices");
        // Moving casters, at rest.
        let moving = Casters::Moving { rest: positions, triangles };
        let ((got, of_strips), _) = in_strips_of(3, Some(slices), moving, &Inputs { moved: Some(at_rest), ..inputs });
        assert_same_shadows(&format!("{what}, moving"), &got, &want);
        assert_eq!(of_strips.faults, status.faults, "{what}, moving");
        for strips in [2, 5, 61] {
            let ((got, of_strips), count) = in_strips(strips);
            assert!(count > 1 && count <= strips);
            assert_same(&format!("{what}, {strips} strips"), &got, &want);
            assert_eq!(of_strips.faults, status.faults, "{what}, {strips} strips");
        }
        let faults = status.faults.unusable_surfaces;
        assert!(what != "depth" || faults > 40, "{what}: {faults} faults");
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
    gpu().submit_and_wait(encoder).expect("one frame was recorded");
    gpu().check().expect("no error of the device");
}
