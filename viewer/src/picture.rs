//! The picture: the mesh drawn with four samples a pixel, its shading times the visibility of either half.

use crate::overlay::Overlay;
use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use lab::scene::{Camera, Light};
use subpixel_shadows::Result;
use subpixel_shadows::pass::{DepthTerms, UploadedCasters};
use subpixel_shadows::stages::pixel_counts::PixelCounts;
use subpixel_shadows::wgpu;
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

const FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
const DEPTH: TextureFormat = TextureFormat::Depth32Float;
const SAMPLES: u32 = 4;

/// The shaders; holes are where kernels have them.
const TEXT: &str = concat!(include_str!("shade.wgsl"), include_str!("../../kernels/shared/alpha.wgsl"));

/// Inputs of a picture beside the mesh and the two visibilities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// The camera.
    pub camera: Camera,
    /// The light.
    pub light: Light,
    /// Where the wipe stands, 0 at the left end to 1 at the right one.
    pub wipe: f32,
    /// Quantity that is shown.
    pub overlay: Overlay,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Uniform {
    clip: [f32; 16],
    eye: [f32; 4],
    light: [f32; 4],
    cone: [f32; 4],
    size: [f32; 2],
    wipe: f32,
    overlay: u32,
    /// Whether each half has counts, and which of them is shown.
    counted: [u32; 4],
    palette: [[f32; 4]; 12],
}

/// The light that a byte of sRGB means.
fn linear(byte: u8) -> f32 {
    let v = f32::from(byte) / 255.0;
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// A half as the picture reads it.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// Visibility of each pixel, below 0 where it is not known yet.
    pub visibility: &'a wgpu::Texture,
    /// Counts of each pixel, where there are some.
    pub counts: Option<&'a wgpu::Buffer>,
}

impl Uniform {
    fn new(shot: &Shot, size: [u32; 2], halves: [Shown; 2]) -> Result<Self> {
        let Shot { camera, light, wipe, overlay } = *shot;
        let projection = DepthTerms::of_camera(&camera, size).projection(&camera, size)?;
        let clip = Mat4::from_cols_array_2d(&projection) * Mat4::from_cols_array_2d(&camera.view());
        let [ex, ey, ez] = camera.eye;
        let none = [0.0, 0.0, 0.0, -2.0];
        let (light, cone) = match light {
            Light::Directional { direction: [x, y, z] } => ([x, y, z, 0.0], none),
            Light::Point { position: [x, y, z] } => ([x, y, z, 1.0], none),
            Light::Spot { position, target, angle_degrees } => {
                let [x, y, z] = position;
                let axis = (Vec3::from(position) - Vec3::from(target)).normalize_or_zero();
                ([x, y, z, 1.0], axis.extend((angle_degrees.to_radians() * 0.5).cos()).to_array())
            }
        };
        let [w, h] = size.map(|side| side as f32);
        let [left, right] = halves.map(|half| u32::from(overlay.counted().is_some() && half.counts.is_some()));
        let mut palette = [[0.0; 4]; 12];
        for (entry, (_, [r, g, b])) in palette.iter_mut().zip(overlay.legend()) {
            *entry = [linear(r), linear(g), linear(b), 1.0];
        }
        Ok(Self {
            clip: clip.to_cols_array(),
            eye: [ex, ey, ez, 0.0],
            light,
            cone,
            size: [w, h],
            wipe: (wipe * w).round(),
            overlay: overlay as u32,
            counted: [left, right, overlay.counted().unwrap_or(0), 0],
            palette,
        })
    }
}

/// Pipelines that pictures of every size share.
#[derive(Debug)]
pub struct Shader {
    mesh: wgpu::BindGroupLayout,
    halves: wgpu::BindGroupLayout,
    draw: wgpu::RenderPipeline,
    sky: wgpu::RenderPipeline,
    counts: wgpu::RenderPipeline,
    /// Bound where a half has no counts.
    none: wgpu::Buffer,
}

fn buffer_entry(
    binding: u32,
    ty: wgpu::BufferBindingType,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayoutEntry {
    let ty = wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
}

impl Shader {
    /// Compiles it.
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("viewer.shade"),
            source: wgpu::ShaderSource::Wgsl(TEXT.into()),
        });
        let (vertex, fragment) = (wgpu::ShaderStages::VERTEX, wgpu::ShaderStages::FRAGMENT);
        let both = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let read = wgpu::BufferBindingType::Storage { read_only: true };
        let mesh = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("viewer.mesh"),
            entries: &[
                buffer_entry(0, wgpu::BufferBindingType::Uniform, both),
                buffer_entry(1, read, vertex),
                buffer_entry(2, read, both),
            ],
        });
        let texture = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: fragment,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let halves = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("viewer.halves"),
            entries: &[texture(0), texture(1), buffer_entry(2, read, fragment), buffer_entry(3, read, fragment)],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("viewer"),
            bind_group_layouts: &[Some(&mesh), Some(&halves)],
            immediate_size: 0,
        });
        let pipeline = |label, vertex, fragment, writes, compare| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(vertex),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(writes),
                    depth_compare: Some(compare),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(fragment),
                    compilation_options: Default::default(),
                    targets: &[Some(FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        use wgpu::CompareFunction::{Always, GreaterEqual};
        Self {
            draw: pipeline("viewer.draw", "draw", "shade", true, GreaterEqual),
            sky: pipeline("viewer.sky", "sky_corner", "sky", false, GreaterEqual),
            counts: pipeline("viewer.counts", "sky_corner", "counted", false, Always),
            none: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("viewer.no counts"),
                size: size_of::<PixelCounts>() as u64,
                usage: BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            mesh,
            halves,
        }
    }
}

/// A mesh on the GPU, as the picture reads it.
#[derive(Debug)]
pub struct DrawnMesh {
    uniform: wgpu::Buffer,
    bindings: wgpu::BindGroup,
    corners: u32,
}

impl DrawnMesh {
    /// A mesh in the memory of casters, with the holes of its triangles.
    pub fn new(device: &wgpu::Device, shader: &Shader, casters: &UploadedCasters) -> Self {
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("viewer.view"),
            size: size_of::<Uniform>() as u64,
            usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let entries = [(0, &uniform), (1, casters.positions()), (2, casters.triangles())]
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("viewer.mesh"),
            layout: &shader.mesh,
            entries: &entries,
        });
        Self { uniform, bindings, corners: 3 * casters.mesh().triangles.len() as u32 }
    }
}

/// A picture of one size.
#[derive(Debug)]
pub struct Picture {
    /// Its width and height, pixels.
    pub size: [u32; 2],
    /// Colours, 8 bits a channel in sRGB.
    pub colour: wgpu::Texture,
    many: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Picture {
    /// A picture of `size` pixels.
    pub fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let make = |label, format, sample_count, usage, view_formats: &[TextureFormat]| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: extent(size),
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats,
            })
        };
        let drawn = TextureUsages::RENDER_ATTACHMENT;
        let shown = drawn | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        Self {
            size,
            colour: make("viewer.colour", FORMAT, 1, shown, &[FORMAT.remove_srgb_suffix()]),
            many: make("viewer.colour of samples", FORMAT, SAMPLES, drawn, &[]).create_view(&Default::default()),
            depth: make("viewer.depth", DEPTH, SAMPLES, drawn, &[]).create_view(&Default::default()),
        }
    }

    /// The colour as egui reads it: encoded.
    pub fn encoded(&self) -> wgpu::TextureView {
        let format = Some(FORMAT.remove_srgb_suffix());
        let usage = Some(TextureUsages::TEXTURE_BINDING);
        self.colour.create_view(&wgpu::TextureViewDescriptor { format, usage, ..Default::default() })
    }

    /// Draws it and submits that.
    ///
    /// # Errors
    /// For a camera that has no projection.
    pub fn draw(
        &self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        shader: &Shader,
        mesh: &DrawnMesh,
        halves: [Shown; 2],
        shot: &Shot,
    ) -> Result<()> {
        queue.write_buffer(&mesh.uniform, 0, bytemuck::bytes_of(&Uniform::new(shot, self.size, halves)?));
        let views = halves.map(|half| half.visibility.create_view(&Default::default()));
        let counts = halves.map(|half| half.counts.unwrap_or(&shader.none).as_entire_binding());
        let [left, right] = [&views[0], &views[1]].map(wgpu::BindingResource::TextureView);
        let [left_counts, right_counts] = counts;
        let resources = [left, right, left_counts, right_counts];
        let entries: Vec<_> =
            (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let halves = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("viewer.halves"),
            layout: &shader.halves,
            entries: &entries,
        });
        let resolved = self.colour.create_view(&Default::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("viewer.picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.many,
                depth_slice: None,
                resolve_target: Some(&resolved),
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Discard },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, &mesh.bindings, &[]);
        pass.set_bind_group(1, &halves, &[]);
        pass.set_pipeline(&shader.sky);
        pass.draw(0..3, 0..1);
        pass.set_pipeline(&shader.draw);
        pass.draw(0..mesh.corners, 0..1);
        if shot.overlay.counted().is_some() {
            pass.set_pipeline(&shader.counts);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        queue.submit([encoder.finish()]);
        Ok(())
    }
}

/// A buffer of counts, as a pass writes them.
pub fn counts(device: &wgpu::Device, [width, height]: [u32; 2]) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("viewer.counts"),
        size: u64::from(width) * u64::from(height) * size_of::<PixelCounts>() as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A texture of visibility, as a pass writes it.
pub fn visibility(device: &wgpu::Device, size: [u32; 2]) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("viewer.visibility"),
        size: extent(size),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::R32Float,
        usage: TextureUsages::STORAGE_BINDING
            | TextureUsages::TEXTURE_BINDING
            | TextureUsages::COPY_SRC
            | TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// A texture of visibility in which no pixel's is known.
pub fn unknown_visibility((device, queue): (&wgpu::Device, &wgpu::Queue), size: [u32; 2]) -> wgpu::Texture {
    let (texture, [width, height]) = (visibility(device, size), size);
    write_visibility(queue, &texture, [0; 2], size, &vec![-1.0; width as usize * height as usize]);
    texture
}

/// Writes visibility from a pixel on.
pub fn write_visibility(queue: &wgpu::Queue, to: &wgpu::Texture, [x, y]: [u32; 2], size: [u32; 2], values: &[f32]) {
    let origin = wgpu::Origin3d { x, y, z: 0 };
    queue.write_texture(
        wgpu::TexelCopyTextureInfo { origin, ..to.as_image_copy() },
        bytemuck::cast_slice(values),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size[0]), rows_per_image: None },
        extent(size),
    );
}

/// The extent of an image.
pub fn extent([width, height]: [u32; 2]) -> wgpu::Extent3d {
    wgpu::Extent3d { width, height, depth_or_array_layers: 1 }
}
