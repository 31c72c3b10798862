//! Frames as an application draws them: its own matrices, the hardware's rasterizer, a viewport in a larger target. Each is held against traced truth.

use super::*;
use crate::receivers::judged;
use glam::camera::{lh::proj::directx as lh, lh::view as left_view, rh::proj::directx as rh, rh::view as right_view};
use glam::{Mat4, Vec4};

const TARGET: [u32; 2] = [140, 90];
pub(crate) const ORIGIN: [u32; 2] = [29, 13];

const SHADER: &str = "
struct View { view: mat4x4<f32>, projection: mat4x4<f32> }
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> positions: array<f32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;
struct Corner { @builtin(position) clip: vec4<f32>, @location(0) @interpolate(flat, either) id: u32 }

@vertex
fn draw(@builtin(vertex_index) i: u32) -> Corner {
    let v = 3u * triangles[i];
    let p = vec3(positions[v], positions[v + 1u], positions[v + 2u]);
    return Corner(view.projection * (view.view * vec4(p, 1.0)), i / 3u);
}

@fragment
fn number(at: Corner) -> @location(0) u32 {
    return at.id;
}
";

/// Matrices of an application, and what its depth buffer is cleared to.
#[derive(Clone, Copy)]
pub(crate) struct Eye {
    pub(crate) name: &'static str,
    pub(crate) view: Mat4,
    pub(crate) projection: Mat4,
    pub(crate) nothing: f32,
}

impl Eye {
    pub(crate) fn camera(&self) -> Camera {
        Camera::of_matrices(&self.view.to_cols_array_2d(), &self.projection.to_cols_array_2d(), SIZE).expect(self.name)
    }

    pub(crate) fn terms(&self) -> DepthTerms {
        DepthTerms::of_projection(&self.projection.to_cols_array_2d()).expect(self.name)
    }

    /// The image moved by so many pixels.
    pub(crate) fn jittered(self, [x, y]: [f32; 2]) -> Self {
        let by = Vec3::new(2.0 * x / SIZE[0] as f32, -2.0 * y / SIZE[1] as f32, 0.0);
        Self { name: "jittered", projection: Mat4::from_translation(by) * self.projection, ..self }
    }
}

/// Triangle numbers and depth, drawn into a viewport.
pub(crate) struct Drawn {
    pub(crate) ids: wgpu::Texture,
    pub(crate) depth: wgpu::Texture,
}

pub(crate) fn draw(mesh: &Mesh, eye: &Eye) -> Drawn {
    draw_samples(mesh, eye, 1)
}

/// Likewise depths of so many samples a pixel; of several nothing else is drawn.
pub(crate) fn draw_samples(mesh: &Mesh, eye: &Eye, samples: u32) -> Drawn {
    let device = &gpu().device;
    let buffer = |bytes: &[u8], usage| {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        let descriptor =
            wgpu::BufferDescriptor { label: None, size: bytes.len() as u64, usage, mapped_at_creation: false };
        let buffer = device.create_buffer(&descriptor);
        gpu().queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let matrices = [eye.view, eye.projection].map(|m| m.to_cols_array());
    let view = buffer(bytemuck::cast_slice(&matrices), wgpu::BufferUsages::UNIFORM);
    let positions = buffer(bytemuck::cast_slice(&mesh.positions), wgpu::BufferUsages::STORAGE);
    let triangles = buffer(bytemuck::cast_slice(&mesh.triangles), wgpu::BufferUsages::STORAGE);
    let target = |format, more, sample_count| {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | more;
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: TARGET[0], height: TARGET[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    };
    let drawn = Drawn {
        ids: target(TextureFormat::R32Uint, TextureUsages::COPY_SRC, 1),
        depth: target(TextureFormat::Depth32Float, TextureUsages::empty(), samples),
    };
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let nearer = if eye.nothing == 0.0 { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less };
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
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
            depth_compare: Some(nearer),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: (samples == 1).then_some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("number"),
            compilation_options: Default::default(),
            targets: &[Some(TextureFormat::R32Uint.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let bound = [&view, &positions, &triangles];
    let entries: Vec<_> = (0..)
        .zip(bound)
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
        .collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let mut encoder = gpu().encoder();
    {
        let views = [&drawn.ids, &drawn.depth].map(|t| t.create_view(&Default::default()));
        let none = wgpu::Color { r: f64::from(u32::MAX), ..wgpu::Color::BLACK };
        let numbers = [Some(wgpu::RenderPassColorAttachment {
            view: &views[0],
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(none), store: wgpu::StoreOp::Store },
        })];
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: if samples > 1 { &[] } else { &numbers },
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &views[1],
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(eye.nothing),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        let ([x, y], [width, height]) = (ORIGIN.map(|c| c as f32), SIZE.map(|c| c as f32));
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        pass.set_scissor_rect(ORIGIN[0], ORIGIN[1], SIZE[0], SIZE[1]);
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3 * mesh.triangles.len() as u32, 0..1);
    }
    gpu().submit_and_wait(encoder).expect("the frame is drawn");
    drawn
}

impl Drawn {
    /// The triangle of each pixel.
    pub(crate) fn triangles(&self) -> Vec<Option<u32>> {
        let row = (4 * TARGET[0]).next_multiple_of(256);
        let words = Buffer::<u32>::storage(&gpu().device, "test.ids", (row / 4 * TARGET[1]) as usize).expect("memory");
        let mut encoder = gpu().encoder();
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: words.raw(), layout };
        encoder.copy_texture_to_buffer(self.ids.as_image_copy(), to, self.ids.size());
        gpu().submit_and_wait(encoder).expect("the copy runs");
        let words = words.read(gpu()).expect("readback");
        let pixel = |p: u32| words[(row / 4 * (ORIGIN[1] + p / SIZE[0]) + ORIGIN[0] + p % SIZE[0]) as usize];
        (0..PIXELS as u32).map(pixel).map(|t| (t != u32::MAX).then_some(t)).collect()
    }
}

/// A projection with the near plane exchanged for another, of view space, as Lengyel (2005) does: depth is 0 on it and at most 1 in the image.
fn behind(projection: Mat4, plane: Vec4) -> Mat4 {
    let corner = Vec4::new(plane.x.signum(), plane.y.signum(), 1.0, 1.0);
    let farthest = projection.inverse() * corner;
    let row = plane * (projection.row(3).dot(farthest) / plane.dot(farthest));
    let [x, y, w] = [0, 1, 3].map(|k| projection.row(k));
    Mat4::from_cols(x, y, row, w).transpose()
}

/// Depth turned round, from 1 to 0.
pub(crate) fn turned_round(projection: Mat4) -> Mat4 {
    let [x, y, z, w] = [0, 1, 2, 3].map(|k| projection.row(k));
    Mat4::from_cols(x, y, w - z, w).transpose()
}

/// The application's cameras: a scene from its own camera's place, by every kind of projection.
pub(crate) fn eyes(scene: &Scene) -> Vec<Eye> {
    let (eye, target) = (Vec3::from(scene.camera.eye), Vec3::from(scene.camera.target));
    let up = Vec3::from(scene.camera.up);
    let (right, left) = (right_view::look_at_mat4(eye, target, up), left_view::look_at_mat4(eye, target, up));
    let (fov, aspect) = (scene.camera.vertical_fov_degrees.to_radians(), SIZE[0] as f32 / SIZE[1] as f32);
    let near = 0.02 * (target - eye).length();
    let wide = near * (fov * 0.5).tan();
    // Cuts the scene's near side off.
    let plane = |view: Mat4| {
        let normal = (target - eye).normalize() + 0.4 * up.normalize();
        let plane = normal.extend(-normal.dot(eye + 0.93 * (target - eye)));
        view.inverse().transpose() * plane
    };
    let standard = |of: Mat4| behind(of, plane(right));
    let reversed = rh::perspective_infinite_reverse(fov, aspect, near);
    vec![
        Eye { name: "reversed, infinite", view: right, projection: reversed, nothing: 0.0 },
        Eye { name: "standard", view: right, projection: rh::perspective(fov, aspect, near, 1e3), nothing: 1.0 },
        Eye { name: "left-handed", view: left, projection: lh::perspective(fov, aspect, near, 1e3), nothing: 1.0 },
        Eye {
            name: "off-centre",
            view: right,
            projection: rh::frustum(-0.4 * wide, 1.3 * wide, -1.1 * wide, 0.3 * wide, near, 1e3),
            nothing: 1.0,
        },
        Eye {
            name: "oblong pixels",
            view: right,
            projection: rh::perspective_infinite(fov, 0.6 * aspect, near),
            nothing: 1.0,
        },
        Eye {
            name: "oblique",
            view: right,
            projection: standard(rh::perspective(fov, aspect, near, 1e2)),
            nothing: 1.0,
        },
        Eye {
            name: "oblique, reversed, off-centre",
            view: right,
            projection: turned_round(standard(rh::frustum(-0.9 * wide, 1.3 * wide, -1.1 * wide, wide, near, 1e2))),
            nothing: 0.0,
        },
        Eye {
            name: "upside down",
            view: right,
            projection: Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0)) * reversed,
            nothing: 0.0,
        },
    ]
}

/// Samples of a picture that are wrong, and those in the band, of what each pixel shows.
pub(crate) fn wrong(got: &Picture, truth: &[(FacetInput, FacetResult)]) -> [u32; 2] {
    let mut out = [0; 2];
    for (input, result) in truth {
        let off = (got.lit[input.pixel as usize] ^ !result.occluded[0]) & result.valid[0];
        out[0] += (off & !result.ambiguous()[0]).count_ones();
        out[1] += (off & result.ambiguous()[0]).count_ones();
    }
    out
}

/// Leaves out pixels whose centre lies within 1/256 pixel of an edge of the triangle that the rasterizer chose, which may be either of two; and
/// samples whose point on the facet's plane is outside the box of the mesh: there the light's view holds no casters.
pub(crate) fn where_truth_is_sure(truth: &mut Vec<(FacetInput, FacetResult)>, scene: &Scene, samples: &Samples) {
    let (low, high) = scene.mesh.bounds().expect("a mesh");
    let rays = scene.camera.rays(SIZE[0], SIZE[1]);
    let all = truth.len();
    truth.retain(|(input, _)| {
        let [a, b, c] = scene.mesh.corners(input.triangle as usize).map(|p| p - rays.eye);
        let [x, y] = [input.pixel % SIZE[0], input.pixel / SIZE[0]].map(|c| f64::from(c) + 0.5);
        [a.cross(b), b.cross(c), c.cross(a)].iter().all(|edge| {
            let steep = edge.dot(rays.step_x).hypot(edge.dot(rays.step_y));
            edge.dot(rays.direction(x, y)).abs() * 256.0 > steep
        })
    });
    assert!(truth.len() * 20 > all * 19, "{} of {all} pixels are not on an edge", truth.len());
    for (input, result) in truth {
        let [a, b, c] = scene.mesh.corners(input.triangle as usize);
        let normal = (b - a).cross(c - a);
        let [x, y] = [input.pixel % SIZE[0], input.pixel / SIZE[0]].map(f64::from);
        for (k, o) in samples.offsets().iter().enumerate() {
            let ray = rays.direction(x + f64::from(o[0]), y + f64::from(o[1]));
            let p = rays.eye + ray * (normal.dot(a - rays.eye) / normal.dot(ray));
            if !(p.cmpge(low).all() && p.cmple(high).all()) {
                result.valid[0] &= !(1 << k);
            }
        }
    }
}

fn pass_of(scene: &Scene) -> ShadowPass {
    // A settled facet says nothing of samples beside its triangle. By depth the view holds the whole ground: in a small map all else would be two texels.
    pass(Settings { settle: false, map: 512, ..settings(FacetMode::One, 32) }, &scene.mesh)
}

/// The frame with the numbers that the application drew, its samples held against truth; and with its depth alone, which is the same.
fn holds(pass: &mut ShadowPass, scene: &Scene, eye: &Eye) -> (Picture, Vec<(FacetInput, FacetResult)>) {
    let (camera, drawn) = (eye.camera(), draw(&scene.mesh, eye));
    // Triangles hang together where vertices are one, as the pass takes them.
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let mut own = vec![None; scene.mesh.triangles.len()];
    (0..).zip(&prepared.given).for_each(|(t, &given)| own[given as usize] = Some(t));
    let triangles = drawn.triangles().into_iter().map(|t| own[t? as usize]).collect();
    let scene = Scene { camera, mesh: prepared.mesh().clone(), ..scene.clone() };
    let seen = Raster { triangles, points: Vec::new() };
    let mut truth = judged(&seen, &scene.mesh, &scene, pass.settings());
    where_truth_is_sure(&mut truth, &scene, &pass.settings().samples);
    assert!(truth.len() > 1500, "{}: {} pixels show something", eye.name, truth.len());
    let plain = Inputs { origin: Some(ORIGIN), ..Inputs::new(&scene.camera, &scene.light) };
    let numbers = GBuffer::TriangleIds(TriangleTexture::new(&drawn.ids));
    let (got, status) = frame(pass, &Inputs { gbuffer: numbers, ..plain });
    assert!(status.complete, "{}: {status:?}", eye.name);
    let [outside, inside] = wrong(&got, &truth);
    assert_eq!(outside, 0, "{}: {outside} samples wrong, {inside} in the band", eye.name);
    let place = SurfacePosition::Depth { texture: &drawn.depth, terms: eye.terms(), nothing: eye.nothing };
    let (by_depth, status) = frame(pass, &Inputs { gbuffer: GBuffer::Surfaces(SurfaceTextures::new(place)), ..plain });
    assert!(status.complete, "{}: {status:?}", eye.name);
    let off = (0..PIXELS).filter(|&p| by_depth.visibility[p] != got.visibility[p]).count();
    assert!(off * 500 <= PIXELS, "{}: {off} pixels differ by depth", eye.name);
    (got, truth)
}

#[gpu_test]
fn every_projection_of_an_application_is_exact() {
    for name in ["spheres", "windmill"] {
        let scene = scene(name);
        let mut pass = pass_of(&scene);
        for eye in eyes(&scene) {
            let (got, truth) = holds(&mut pass, &scene, &eye);
            let dark = got.visibility.iter().filter(|&&v| v < 1.0).count();
            assert!(dark > 200, "{name}, {}: {dark} pixels in shadow", eye.name);
            // The comparison must notice a picture that is moved by a pixel.
            let mut moved = got.clone();
            moved.lit.rotate_right(1);
            assert!(wrong(&moved, &truth)[0] > 1000, "{name}, {}: a moved picture passes", eye.name);
        }
    }
}

/// Sixteen offsets of temporal antialiasing; with the camera of the frame without, samples are wrong, and its depth is refused.
#[gpu_test]
fn jittered_frames_are_exact() {
    let scene = scene("windmill");
    let mut pass = pass_of(&scene);
    let still = eyes(&scene)[0];
    for k in 0..16u32 {
        // Each sixteenth of the pixel once.
        let offset = [(k % 4) as f32 / 4.0 - 0.375, (k / 4) as f32 / 4.0 - 0.375];
        let eye = still.jittered(offset);
        let (_, truth) = holds(&mut pass, &scene, &eye);
        let drawn = draw(&scene.mesh, &eye);
        let camera = still.camera();
        let plain = Inputs { origin: Some(ORIGIN), ..Inputs::new(&camera, &scene.light) };
        let numbers = GBuffer::TriangleIds(TriangleTexture::new(&drawn.ids));
        let (blind, _) = frame(&mut pass, &Inputs { gbuffer: numbers, ..plain });
        assert!(wrong(&blind, &truth)[0] > 100, "{offset:?}: the jitter changes nothing");
        let place = SurfacePosition::Depth { texture: &drawn.depth, terms: eye.terms(), nothing: 0.0 };
        let by_depth = Inputs { gbuffer: GBuffer::Surfaces(SurfaceTextures::new(place)), ..plain };
        refused("shifts its image", pass.record(&mut gpu().encoder(), &by_depth, &Target::default()));
    }
}

/// The depth of an oblique near plane, which goes by the pixel, says in strips of rows what it says in one piece.
#[gpu_test]
fn oblique_depths_in_strips_are_the_whole() {
    let scene = scene("windmill");
    let eye = eyes(&scene)[6];
    let (camera, drawn) = (eye.camera(), draw(&scene.mesh, &eye));
    let of = |terms, strips| {
        let place = SurfacePosition::Depth { texture: &drawn.depth, terms, nothing: eye.nothing };
        let gbuffer = GBuffer::Surfaces(SurfaceTextures::new(place));
        let inputs = Inputs { gbuffer, origin: Some(ORIGIN), ..Inputs::new(&camera, &scene.light) };
        let Mesh { positions, triangles } = &scene.mesh;
        let casters = Casters::Static { positions, triangles };
        let config = PassConfig { receivers: true, strips, ..PassConfig::new(settings(FacetMode::One, 32), casters) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let (picture, status) = frame(&mut pass, &inputs);
        assert!(status.complete && pass.strips() == strips, "{}, {strips}: {status:?}", eye.name);
        picture
    };
    let whole = of(eye.terms(), 1);
    assert_eq!(of(eye.terms(), 4), whole);
    let [right, top] = eye.terms().tilt;
    assert!(top.abs() > 1e-3, "{top}: it goes by the row");
    // Terms tilted the other way are refused.
    let place = SurfacePosition::Depth {
        texture: &drawn.depth,
        terms: DepthTerms { tilt: [right, -top], ..eye.terms() },
        nothing: eye.nothing,
    };
    let inputs = Inputs {
        gbuffer: GBuffer::Surfaces(SurfaceTextures::new(place)),
        origin: Some(ORIGIN),
        ..Inputs::new(&camera, &scene.light)
    };
    let mut pass = pass_of(&scene);
    refused("oblique near plane", pass.record(&mut gpu().encoder(), &inputs, &Target::default()));
}
