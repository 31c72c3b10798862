//! Compute pipelines that know their bindings.

use super::batch;
use super::bindings::{EntryPoint, Overrides};
use super::kept::KeptPrograms;
use super::profile::Profile;
use super::scope::caught;
use super::source::Source;
use std::cell::Cell;
use std::marker::PhantomData;
use std::sync::{Arc, OnceLock};

/// Log target of the messages about pipelines that are made, at debug level: each a JSON array of the kernel, the entry point and the
/// constants.
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
    /// A multisampled texture of `f32`, or of depths, that is read sample by sample.
    TextureFloatSamples,
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
            Self::TextureFloatSamples => texture(wgpu::TextureSampleType::Float { filterable: false }, D2, true),
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

/// An entry point of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The kernel's stem.
    pub kernel: &'static str,
    /// The entry point.
    pub name: &'static str,
    /// The kernel's text, imports first.
    pub source: Source,
    /// The workgroup size.
    pub workgroup: [u32; 3],
    /// The bindings it uses, in the order of the kernel.
    pub bindings: &'static [Binding],
}

/// The compute pipeline of an entry point. A clone is the same pipeline.
#[derive(Clone, Debug)]
pub struct Program<E> {
    compiled: Compiled,
    entry: PhantomData<fn() -> E>,
}

impl<E: EntryPoint> Program<E> {
    /// Builds the pipeline, or takes one that is kept ([`KeptPrograms`]).
    pub fn new(device: &wgpu::Device, constants: E::Constants) -> Self {
        Self { compiled: Compiled::new(device, E::ENTRY, &constants.list()), entry: PhantomData }
    }

    /// The pipeline without its type.
    pub fn compiled(&self) -> &Compiled {
        &self.compiled
    }
}

/// A compute pipeline made from an [`Entry`]. A clone is the same pipeline.
#[derive(Clone, Debug)]
pub struct Compiled(Arc<Parts>);

/// Parts that a pipeline is compiled from, and the pipeline once it is.
#[derive(Debug)]
struct Parts {
    device: wgpu::Device,
    entry: Entry,
    constants: Vec<(String, f64)>,
    module: wgpu::ShaderModule,
    cache: Option<wgpu::PipelineCache>,
    layout: wgpu::BindGroupLayout,
    pipeline: OnceLock<wgpu::ComputePipeline>,
}

impl Compiled {
    /// Builds the pipeline, or takes one that is kept ([`KeptPrograms`]); `constants` are values for the kernel's `override`s.
    pub fn new(device: &wgpu::Device, entry: Entry, constants: &[(&str, f64)]) -> Self {
        let (made, new) =
            KeptPrograms::get_or_make(device, entry, constants, || Self::described(device, entry, constants));
        if new && !batch::defer(&made) {
            made.pipeline();
        }
        made
    }

    /// All but the pipeline itself.
    fn described(device: &wgpu::Device, entry: Entry, constants: &[(&str, f64)]) -> Self {
        MADE.set(MADE.get() + 1);
        log::debug!(target: LOG, "{}", described(entry, constants));
        let module = KeptPrograms::module_or_make(device, entry.source, || {
            let source = entry.source.text();
            #[cfg(feature = "mutations")]
            let source = super::mutation::mutated(entry.kernel, source);
            let source = wgpu::ShaderSource::Wgsl(Profile::of(device).text(&source));
            device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(entry.kernel), source })
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
        let label = format!("{}.{}", entry.kernel, entry.name);
        let layout = device
            .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(&label), entries: &entries });
        Self(Arc::new(Parts {
            device: device.clone(),
            entry,
            constants: constants.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
            module,
            cache: KeptPrograms::cache(),
            layout,
            pipeline: OnceLock::new(),
        }))
    }

    fn compile(&self) -> wgpu::ComputePipeline {
        let Parts { device, entry, constants, module, cache, layout, .. } = &*self.0;
        let label = format!("{}.{}", entry.kernel, entry.name);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&label),
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
        let constants: Vec<_> = constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: Some(&layout),
            module,
            entry_point: Some(entry.name),
            compilation_options: options,
            cache: cache.as_ref(),
        })
    }

    /// Compiles it on a thread of its own, without an error: what fails is left to [`Compiled::pipeline`], which fails where it is heard.
    pub(super) fn try_compile(&self) {
        let (made, error) = caught(&self.0.device, wgpu::ErrorFilter::Validation, || self.compile());
        if error.is_none() {
            let _ = self.0.pipeline.set(made);
        }
    }

    /// The entry point it was made from.
    pub fn entry(&self) -> &Entry {
        &self.0.entry
    }

    /// Invocations in one workgroup.
    pub fn workgroup_invocations(&self) -> u32 {
        self.0.entry.workgroup.iter().product()
    }

    /// The wgpu pipeline, compiled now if it is not yet.
    pub fn pipeline(&self) -> &wgpu::ComputePipeline {
        self.0.pipeline.get_or_init(|| self.compile())
    }

    /// A bind group.
    pub fn bind(&self, device: &wgpu::Device, entries: &[wgpu::BindGroupEntry]) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(self.0.entry.kernel),
            layout: &self.0.layout,
            entries,
        })
    }
}

/// A pipeline, as [`LOG`] says.
fn described(entry: Entry, constants: &[(&str, f64)]) -> String {
    let constants: Vec<_> = constants.iter().map(|(name, value)| format!("{name:?}: {value:?}")).collect();
    format!("[{:?}, {:?}, {{{}}}]", entry.kernel, entry.name, constants.join(", "))
}
