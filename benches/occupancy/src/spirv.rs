//! SPIR-V of a pipeline, as the Vulkan backend of wgpu 30 makes it on RADV.

use crate::Pipeline;
use naga::back::{PipelineConstants, pipeline_constants::process_overrides, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, ImageClass, Module, ShaderStage, TypeInner};

/// A kernel, read and checked.
pub struct Kernel {
    module: Module,
    info: ModuleInfo,
}

/// Kind of a binding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// A uniform buffer.
    Uniform,
    /// A storage buffer.
    Storage,
    /// A texture that is read.
    Texture,
    /// A texture that is written.
    StorageTexture,
}

impl Kernel {
    /// Reads a kernel's WGSL.
    ///
    /// # Errors
    /// The first fault of the text.
    pub fn read(source: &str) -> Result<Self, String> {
        let module = naga::front::wgsl::parse_str(source).map_err(|e| e.emit_to_string(source))?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::all())
            .validate(&module)
            .map_err(|e| e.emit_to_string(source))?;
        Ok(Self { module, info })
    }

    /// The bindings of group 0.
    pub fn bindings(&self) -> Vec<(u32, Bound)> {
        let of = |space, ty: naga::Handle<naga::Type>| match (space, &self.module.types[ty].inner) {
            (AddressSpace::Uniform, _) => Bound::Uniform,
            (AddressSpace::Storage { .. }, _) => Bound::Storage,
            (_, TypeInner::Image { class: ImageClass::Storage { .. }, .. }) => Bound::StorageTexture,
            _ => Bound::Texture,
        };
        let variables = self.module.global_variables.iter();
        variables.filter_map(|(_, v)| v.binding.as_ref().map(|b| (b.binding, of(v.space, v.ty)))).collect()
    }

    /// SPIR-V of one of its pipelines.
    ///
    /// # Errors
    /// The message of naga.
    pub fn spirv(&self, pipeline: &Pipeline) -> Result<Vec<u32>, String> {
        let Pipeline(_, entry, constants) = pipeline;
        let constants: PipelineConstants = constants.iter().map(|(name, value)| (name.clone(), *value)).collect();
        let point = Some((ShaderStage::Compute, entry.as_str()));
        let made = process_overrides(&self.module, &self.info, point, &constants);
        let (module, info) = made.map_err(|e| format!("{}: {e}", pipeline.name()))?;
        let point = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: entry.clone() };
        spv::write_vec(&module, &info, &options(), Some(&point)).map_err(|e| format!("{}: {e}", pipeline.name()))
    }
}

/// The options of `wgpu-hal`'s `vulkan/adapter.rs` for a device with Vulkan 1.3 and `VK_EXT_robustness2`, which keeps accesses to buffers and
/// textures in bounds by itself.
fn options() -> spv::Options<'static> {
    spv::Options {
        lang_version: (1, 6),
        flags: spv::WriterFlags::LABEL_VARYINGS | spv::WriterFlags::FORCE_POINT_SIZE,
        fake_missing_bindings: true,
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            buffer: BoundsCheckPolicy::Unchecked,
            image_load: BoundsCheckPolicy::Unchecked,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::Native,
        force_loop_bounding: true,
        emit_int_div_checks: true,
        ..spv::Options::default()
    }
}
