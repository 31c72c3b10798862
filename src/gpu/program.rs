//! A compute pipeline whose bindings are known by name.

use super::kept::KeptPrograms;
use crate::{Error, Result};
use std::cell::Cell;

/// What messages of the pipelines that are made have as their target, at the level of debugging: a JSON array of the kernel, the
/// entry point and the constants.
pub const LOG: &str = "subpixel_shadows::pipelines";

thread_local! {
    static MADE: Cell<u64> = const { Cell::new(0) };
}

/// How many pipelines this thread has made, on any device. Making one takes milliseconds to seconds.
pub fn made_here() -> u64 {
    MADE.get()
}

/// How a kernel uses a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// A uniform buffer.
    Uniform,
    /// A storage buffer that is only read.
    Read,
    /// A storage buffer that is written.
    ReadWrite,
    /// A texture of unsigned integers, one sample a texel, that is read texel by texel.
    TextureUint,
    /// Layers of such textures.
    TextureUintLayers,
    /// A multisampled texture of unsigned integers that is read sample by sample.
    TextureUintSamples,
    /// A texture of `f32`, or a depth texture, that is read texel by texel and never filtered.
    TextureFloat,
    /// A storage texture of format `r32float` that is only written.
    TextureStoreR32Float,
}

impl Access {
    /// Whether it counts against the limit of storage buffers a stage.
    pub fn is_storage_buffer(self) -> bool {
        matches!(self, Self::Read | Self::ReadWrite)
    }

    fn layout(self) -> wgpu::BindingType {
        use wgpu::TextureViewDimension::{D2, D2Array};
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let texture = |sample_type, view_dimension, multisampled| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled,
        };
        match self {
            Self::Uniform => buffer(wgpu::BufferBindingType::Uniform),
            Self::Read => buffer(wgpu::BufferBindingType::Storage { read_only: true }),
            Self::ReadWrite => buffer(wgpu::BufferBindingType::Storage { read_only: false }),
            Self::TextureUint => texture(wgpu::TextureSampleType::Uint, D2, false),
            Self::TextureUintLayers => texture(wgpu::TextureSampleType::Uint, D2Array, false),
            Self::TextureUintSamples => texture(wgpu::TextureSampleType::Uint, D2, true),
            Self::TextureFloat => texture(wgpu::TextureSampleType::Float { filterable: false }, D2, false),
            Self::TextureStoreR32Float => wgpu::BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format: wgpu::TextureFormat::R32Float,
                view_dimension: wgpu::TextureViewDimension::D2,
            },
        }
    }
}

/// One binding that an entry point uses.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// `@binding` index in group 0.
    pub index: u32,
    /// Its name in the kernel.
    pub name: &'static str,
    /// How it is used.
    pub access: Access,
}

/// An entry point of a kernel, as `build.rs` found it with naga.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The kernel's stem.
    pub kernel: &'static str,
    /// The entry point.
    pub name: &'static str,
    /// The kernel's text, imports joined.
    pub source: &'static str,
    /// The workgroup size.
    pub workgroup: [u32; 3],
    /// The bindings it uses, in the order of the kernel.
    pub bindings: &'static [Binding],
}

/// A compute pipeline made from an [`Entry`]. A clone is the same pipeline.
#[derive(Clone, Debug)]
pub struct Program {
    entry: Entry,
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
}

impl Program {
    /// Builds the pipeline, or takes one that is kept ([`KeptPrograms`]); `constants` are values for the kernel's `override`s.
    pub fn new(device: &wgpu::Device, entry: Entry, constants: &[(&str, f64)]) -> Self {
        KeptPrograms::get_or_make(device, entry, constants, || Self::build(device, entry, constants))
    }

    fn build(device: &wgpu::Device, entry: Entry, constants: &[(&str, f64)]) -> Self {
        let label = format!("{}.{}", entry.kernel, entry.name);
        MADE.set(MADE.get() + 1);
        log::debug!(target: LOG, "{}", described(entry, constants));
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&label),
            source: wgpu::ShaderSource::Wgsl(entry.source.into()),
        });
        let entries: Vec<_> = entry
            .bindings
            .iter()
            .map(|b| wgpu::BindGroupLayoutEntry {
                binding: b.index,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: b.access.layout(),
                count: None,
            })
            .collect();
        let layout = device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(&label), entries: &entries });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&label),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: Some(&pipeline_layout),
            module: &module,
            entry_point: Some(entry.name),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        Self { entry, pipeline, layout }
    }

    /// The entry point it was made from.
    pub fn entry(&self) -> &Entry {
        &self.entry
    }

    /// Invocations in one workgroup.
    pub fn workgroup_invocations(&self) -> u32 {
        self.entry.workgroup.iter().product()
    }

    /// The wgpu pipeline.
    pub fn pipeline(&self) -> &wgpu::ComputePipeline {
        &self.pipeline
    }

    /// A bind group of the named buffers; names that the entry point does not use are left out.
    ///
    /// # Errors
    /// [`Error::Gpu`] if a binding of the kernel is not among the names.
    pub fn bind(&self, device: &wgpu::Device, buffers: &[(&str, &wgpu::Buffer)]) -> Result<wgpu::BindGroup> {
        let ranges: Vec<_> = buffers.iter().map(|(name, buffer)| (*name, whole(buffer))).collect();
        self.bind_ranges(device, &ranges)
    }

    /// As [`Program::bind`], of ranges of buffers (for buffers above the binding limit).
    ///
    /// # Errors
    /// As [`Program::bind`].
    pub fn bind_ranges(
        &self,
        device: &wgpu::Device,
        ranges: &[(&str, wgpu::BufferBinding)],
    ) -> Result<wgpu::BindGroup> {
        let all: Vec<_> =
            ranges.iter().map(|(name, range)| (*name, wgpu::BindingResource::Buffer(range.clone()))).collect();
        self.bind_resources(device, &all)
    }

    /// As [`Program::bind`], of anything that can be bound.
    ///
    /// # Errors
    /// As [`Program::bind`].
    pub fn bind_resources(
        &self,
        device: &wgpu::Device,
        resources: &[(&str, wgpu::BindingResource)],
    ) -> Result<wgpu::BindGroup> {
        let mut entries = Vec::with_capacity(self.entry.bindings.len());
        for binding in self.entry.bindings {
            let (_, resource) = resources.iter().find(|(name, _)| *name == binding.name).ok_or_else(|| {
                Error::Gpu(format!("{}.{} needs a binding '{}'", self.entry.kernel, self.entry.name, binding.name))
            })?;
            entries.push(wgpu::BindGroupEntry { binding: binding.index, resource: resource.clone() });
        }
        Ok(device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.entry.kernel),
            layout: &self.layout,
            entries: &entries,
        }))
    }
}

/// A pipeline, as [`LOG`] says.
fn described(entry: Entry, constants: &[(&str, f64)]) -> String {
    let constants: Vec<_> = constants.iter().map(|(name, value)| format!("{name:?}: {value:?}")).collect();
    format!("[{:?}, {:?}, {{{}}}]", entry.kernel, entry.name, constants.join(", "))
}

/// The whole of a buffer, for [`Program::bind_ranges`].
pub fn whole(buffer: &wgpu::Buffer) -> wgpu::BufferBinding<'_> {
    wgpu::BufferBinding { buffer, offset: 0, size: None }
}

/// `len` elements of `T` from element `first` of a buffer, rounded up to 16 bytes (which every
/// [`Buffer`](super::Buffer) has).
pub fn range<T: bytemuck::Pod>(buffer: &super::Buffer<T>, first: usize, len: usize) -> wgpu::BufferBinding<'_> {
    let bytes = ((len.max(1) * size_of::<T>()) as u64).next_multiple_of(16);
    wgpu::BufferBinding {
        buffer: buffer.raw(),
        offset: (first * size_of::<T>()) as u64,
        size: std::num::NonZeroU64::new(bytes),
    }
}
