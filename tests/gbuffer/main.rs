//! The pass with an application's G-buffer: surfaces by depth or position, be they casters or not, and triangle numbers of
//! several samples a pixel.

mod every_surface;
mod frames;
mod light_lists;
mod orthographic;
mod receivers;
mod roles;
mod samples;
mod spots;
mod strips;

use lab::scene::{Scene, builtin};
use oracle::truth::{FacetInput, FacetResult, FacetTruth, Tracer};
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::Buffer;
use subpixel_shadows::light_view::{OmniMaps, SplitPlan, Warp};
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared, Settings};
use subpixel_shadows::pass::{
    Casters, DepthTerms, Faults, FrameStatus, GBuffer, Inputs, LightTarget, Moved, PassConfig, SampleTexture,
    SurfacePosition, SurfaceTextures, Target, TriangleTexture, Vertices,
};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{
    AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Camera, Light, Mesh, Roles, TestedTriangle,
};
use subpixel_shadows::{Error, ShadowPass, wgpu};
use test_support::gpu;
use test_support::gpu_test;
use test_support::status_of;
use wgpu::{TextureFormat, TextureUsages};

const SIZE: [u32; 2] = [83, 61];
const PIXELS: usize = (SIZE[0] * SIZE[1]) as usize;

fn settings(facets: FacetMode, count: u32) -> Settings {
    let samples = Samples::new(Pattern::LowDiscrepancy, count).expect("samples");
    Settings { facets, ..Settings::new(SIZE, 512, samples) }
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

/// Visibility and lit words, of methods that have such.
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
            return (Picture { visibility, lit: pass.lit().map_or(Vec::new(), read) }, status);
        }
    }
    panic!("no lists that suffice by the sixth frame");
}

/// Surface at each pixel centre of a scene, as a rasterizer would write it: triangle, view depth and normal, by the pass itself.
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
        DepthTerms::of_projection(&of.to_cols_array_2d()).expect("a projection")
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
    refused("room for receivers", every.record(&mut encoder, &inputs, &none));
    let ids = texture(SIZE, 1, TextureFormat::R32Uint, &[]);
    let gbuffer = GBuffer::TriangleIds(TriangleTexture::new(&ids));
    refused("one sample", every.record(&mut encoder, &Inputs { gbuffer, ..plain }, &none));
    gpu().submit_and_wait(encoder).expect("one frame was recorded");
    gpu().check().expect("no error of the device");
}
