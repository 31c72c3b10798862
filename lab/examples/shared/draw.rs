//! A renderer of an application's own: triangles drawn forward with a depth buffer, shaded by a light times its visibility.

use lab::scene::{Camera, Light, Mesh};
use subpixel_shadows::glam::{Mat4, Vec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::pass::DepthTerms;
use subpixel_shadows::wgpu::{self, BufferUsages, TextureFormat, TextureUsages};
use subpixel_shadows::{Error, Result};

const SHADER: &str = "
struct View { clip: mat4x4<f32>, light: vec4<f32>, eye: vec4<f32> }
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> corners: array<vec4<f32>>;
@group(0) @binding(2) var visibility: texture_2d<f32>;
struct Corner { @builtin(position) at: vec4<f32>, @location(0) world: vec3<f32> }
@vertex fn corner(@builtin(vertex_index) k: u32) -> Corner {
    let p = corners[k].xyz;
    return Corner(view.clip * vec4<f32>(p, 1.0), p);
}
@fragment fn shade(corner: Corner) -> @location(0) vec4<f32> {
    let lit = textureLoad(visibility, vec2<u32>(corner.at.xy), 0).x;
    var normal = normalize(cross(dpdx(corner.world), dpdy(corner.world)));
    normal *= sign(dot(normal, view.eye.xyz - corner.world));
    let way = normalize(view.light.xyz - view.light.w * corner.world);
    return vec4<f32>(vec3<f32>(0.12 + 0.8 * lit * max(dot(normal, way), 0.0)), 1.0);
}";

/// The renderer, with the texture that it takes visibility from.
pub struct Draw {
    /// Visibility of each pixel, written by whoever knows it.
    pub visibility: wgpu::Texture,
    size: [u32; 2],
    format: TextureFormat,
    depth: wgpu::Texture,
    pipeline: wgpu::RenderPipeline,
    view: wgpu::Buffer,
    corners: wgpu::Buffer,
    count: u32,
}

fn texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    format: TextureFormat,
    usage: TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("draw"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// Visibility and depth of an image.
fn images(device: &wgpu::Device, size: [u32; 2]) -> [wgpu::Texture; 2] {
    let visibility = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    [
        texture(device, size, TextureFormat::R8Unorm, visibility),
        texture(device, size, TextureFormat::Depth32Float, TextureUsages::RENDER_ATTACHMENT),
    ]
}

impl Draw {
    /// For a mesh, into targets of this size and format.
    pub fn new(device: &wgpu::Device, mesh: &Mesh, size: [u32; 2], format: TextureFormat) -> Result<Self> {
        let corners: Vec<[f32; 4]> = mesh
            .triangles
            .iter()
            .flatten()
            .map(|v| Vec3::from(mesh.positions[*v as usize]).extend(1.0).into())
            .collect();
        let buffer = |bytes: usize, usage, mapped_at_creation| {
            let size = bytes as u64;
            device.create_buffer(&wgpu::BufferDescriptor { label: Some("draw"), size, usage, mapped_at_creation })
        };
        let held = buffer(16 * corners.len(), BufferUsages::STORAGE, true);
        let mut mapped = held.get_mapped_range_mut(..).map_err(|e| Error::Gpu(e.to_string()))?;
        mapped.copy_from_slice(bytemuck::cast_slice(&corners));
        drop(mapped);
        held.unmap();
        let source = wgpu::ShaderSource::Wgsl(SHADER.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("draw"), source });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("draw"),
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
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let [visibility, depth] = images(device, size);
        let view = buffer(96, BufferUsages::UNIFORM | BufferUsages::COPY_DST, false);
        let count = corners.len() as u32;
        Ok(Self { visibility, size, format, depth, pipeline, view, corners: held, count })
    }

    /// Draws images of another size from now on.
    #[cfg(feature = "window")]
    pub fn resize(&mut self, device: &wgpu::Device, size: [u32; 2]) {
        self.size = size;
        [self.visibility, self.depth] = images(device, size);
    }

    /// A texture to draw into.
    pub fn target(&self, device: &wgpu::Device) -> wgpu::Texture {
        texture(device, self.size, self.format, TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC)
    }

    /// Records the frame: what was written to `visibility` before is shown.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (camera, light): (&Camera, &Light),
        to: &wgpu::TextureView,
    ) -> Result<()> {
        let projection = DepthTerms::reversed_infinite(camera.near).projection(camera, self.size)?;
        let matrix = |m: [[f32; 4]; 4]| Mat4::from_cols_array_2d(&m);
        let clip = (matrix(projection) * matrix(camera.view())).to_cols_array_2d();
        let eye = Vec3::from(camera.eye).extend(1.0).into();
        let view = [clip[0], clip[1], clip[2], clip[3], light.homogeneous().as_vec4().into(), eye];
        gpu.queue.write_buffer(&self.view, 0, bytemuck::cast_slice(&view));
        let visibility = self.visibility.create_view(&Default::default());
        let resources = [
            self.view.as_entire_binding(),
            self.corners.as_entire_binding(),
            wgpu::BindingResource::TextureView(&visibility),
        ];
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let layout = &self.pipeline.get_bind_group_layout(0);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("draw"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: to,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::WHITE), store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth.create_view(&Default::default()),
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..self.count, 0..1);
        Ok(())
    }
}

/// A camera that has gone around its target by an angle.
#[cfg(feature = "window")]
pub fn around(camera: &Camera, angle: f32) -> Camera {
    let target = Vec3::from(camera.target);
    let away = Vec3::from(camera.eye) - target;
    let (s, c) = angle.sin_cos();
    let eye = target + Vec3::new(c * away.x + s * away.z, away.y, c * away.z - s * away.x);
    Camera { eye: eye.into(), ..*camera }
}
