//! AMD's compiler as Mesa's Vulkan driver RADV has it, on null hardware.
#![allow(unsafe_code)]

use crate::Figures;
use crate::spirv::Bound;
use ash::{ext, khr, vk};
use std::ffi::{CStr, CString};

/// Package of Debian and Ubuntu that holds the driver.
pub const INSTALL: &str = "RADV with null hardware is missing: apt-get install mesa-vulkan-drivers libvulkan1";

/// A device of the driver that compiles and runs nothing.
pub struct NullDevice {
    device: ash::Device,
    executables: khr::pipeline_executable_properties::Device,
    instance: ash::Instance,
    /// The loader, which has to outlive the instance.
    _entry: ash::Entry,
    /// The driver's version.
    pub driver: String,
    /// The device's name.
    pub name: String,
}

/// Parts of a pipeline, destroyed once its figures are known.
#[derive(Default)]
struct Parts {
    set: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    module: vk::ShaderModule,
    pipeline: vk::Pipeline,
}

fn text(of: &[std::ffi::c_char]) -> String {
    let bytes: Vec<u8> = of.iter().map(|c| c.cast_unsigned()).collect();
    CStr::from_bytes_until_nul(&bytes).map_or_else(|_| String::new(), |s| s.to_string_lossy().into_owned())
}

impl NullDevice {
    /// Opens the device of this process's `RADV_FORCE_FAMILY`, with what wgpu switches on.
    ///
    /// # Errors
    /// [`INSTALL`] where there is none; what Vulkan says.
    pub fn open() -> Result<Self, String> {
        // SAFETY: the loader is Vulkan's; each create call gets structs that live as long as it; nothing is used after it was destroyed.
        unsafe {
            let entry = ash::Entry::load().map_err(|e| format!("{INSTALL} ({e})"))?;
            let app = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
            let instance = entry
                .create_instance(&vk::InstanceCreateInfo::default().application_info(&app), None)
                .map_err(|e| format!("{INSTALL} ({e})"))?;
            let made = Self::on(entry.clone(), &instance);
            if made.is_err() {
                instance.destroy_instance(None);
            }
            made
        }
    }

    /// # Safety
    /// The instance is `entry`'s and is destroyed by the caller if this fails.
    unsafe fn on(entry: ash::Entry, instance: &ash::Instance) -> Result<Self, String> {
        // SAFETY: as above.
        unsafe {
            let all = instance.enumerate_physical_devices().map_err(|e| format!("{INSTALL} ({e})"))?;
            let named = all.into_iter().map(|d| (d, text(&instance.get_physical_device_properties(d).device_name)));
            let (physical, name) = named
                .into_iter()
                .find(|(_, name)| name.starts_with("Null hardware") && name.contains("RADV"))
                .ok_or(INSTALL)?;
            let mut driver = vk::PhysicalDeviceDriverProperties::default();
            let mut properties = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
            instance.get_physical_device_properties2(physical, &mut properties);
            if properties.properties.api_version < vk::API_VERSION_1_3 {
                return Err(format!("{name}: a driver older than Vulkan 1.3"));
            }
            let driver = text(&driver.driver_info);

            let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&[1.0])];
            let extensions = [khr::pipeline_executable_properties::NAME.as_ptr(), ext::robustness2::NAME.as_ptr()];
            let core = vk::PhysicalDeviceFeatures::default().robust_buffer_access(true).shader_int64(true);
            let mut told =
                vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
            let mut robust = vk::PhysicalDeviceRobustness2FeaturesEXT::default()
                .robust_buffer_access2(true)
                .robust_image_access2(true);
            let mut of_1_2 = vk::PhysicalDeviceVulkan12Features::default()
                .vulkan_memory_model(true)
                .shader_buffer_int64_atomics(true);
            let mut of_1_3 = vk::PhysicalDeviceVulkan13Features::default()
                .robust_image_access(true)
                .shader_zero_initialize_workgroup_memory(true);
            let info = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_extension_names(&extensions)
                .enabled_features(&core)
                .push_next(&mut told)
                .push_next(&mut robust)
                .push_next(&mut of_1_2)
                .push_next(&mut of_1_3);
            let device =
                instance.create_device(physical, &info, None).map_err(|e| format!("{name}: no device: {e}"))?;
            let executables = khr::pipeline_executable_properties::Device::new(instance, &device);
            Ok(Self { device, executables, instance: instance.clone(), _entry: entry, driver, name })
        }
    }

    /// Compiles an entry point and says what came of it.
    ///
    /// # Errors
    /// The message of Vulkan.
    pub fn compile(&self, spirv: &[u32], entry: &str, bindings: &[(u32, Bound)]) -> Result<Figures, String> {
        let mut parts = Parts::default();
        let made = self.compile_into(&mut parts, spirv, entry, bindings);
        // SAFETY: what was not made is null, which these allow; nothing of it is in use.
        unsafe {
            self.device.destroy_pipeline(parts.pipeline, None);
            self.device.destroy_shader_module(parts.module, None);
            self.device.destroy_pipeline_layout(parts.layout, None);
            self.device.destroy_descriptor_set_layout(parts.set, None);
        }
        made
    }

    fn compile_into(
        &self,
        parts: &mut Parts,
        spirv: &[u32],
        entry: &str,
        bindings: &[(u32, Bound)],
    ) -> Result<Figures, String> {
        let of = |bound| match bound {
            Bound::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
            Bound::Storage => vk::DescriptorType::STORAGE_BUFFER,
            Bound::Texture => vk::DescriptorType::SAMPLED_IMAGE,
            Bound::StorageTexture => vk::DescriptorType::STORAGE_IMAGE,
        };
        let bindings: Vec<_> = bindings
            .iter()
            .map(|(index, bound)| {
                let binding = vk::DescriptorSetLayoutBinding::default().binding(*index).descriptor_type(of(*bound));
                binding.descriptor_count(1).stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let name = CString::new(entry).map_err(|e| e.to_string())?;
        let failed = |e: vk::Result| e.to_string();
        // SAFETY: the structs live as long as the calls; naga has checked the module and wrote its SPIR-V.
        unsafe {
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            parts.set = self.device.create_descriptor_set_layout(&info, None).map_err(failed)?;
            let sets = [parts.set];
            let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
            parts.layout = self.device.create_pipeline_layout(&info, None).map_err(failed)?;
            let info = vk::ShaderModuleCreateInfo::default().code(spirv);
            parts.module = self.device.create_shader_module(&info, None).map_err(failed)?;
            let stage = vk::PipelineShaderStageCreateInfo::default()
                .stage(vk::ShaderStageFlags::COMPUTE)
                .module(parts.module)
                .name(&name);
            let info = vk::ComputePipelineCreateInfo::default()
                .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
                .stage(stage)
                .layout(parts.layout);
            let made = self.device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None);
            parts.pipeline = made.map_err(|(_, e)| failed(e))?[0];
            let info = vk::PipelineExecutableInfoKHR::default().pipeline(parts.pipeline).executable_index(0);
            let told = self.executables.get_pipeline_executable_statistics(&info).map_err(failed)?;
            let value = |name: &str| match told.iter().find(|s| text(&s.name) == name) {
                // The driver gives all of these as 64 bits without a sign.
                Some(s) if s.format == vk::PipelineExecutableStatisticFormatKHR::UINT64 => Ok(s.value.u64),
                _ => Err(format!("{} {} does not tell '{name}'", self.name, self.driver)),
            };
            Ok(Figures {
                vector_registers: value("VGPRs")?,
                scalar_registers: value("SGPRs")?,
                spilled_vector: value("Spilled VGPRs")?,
                spilled_scalar: value("Spilled SGPRs")?,
                scratch: value("Scratch size")?,
                workgroup_memory: value("LDS size")?,
                code: value("Code size")?,
                waves: value("Subgroups per SIMD")?,
            })
        }
    }
}

impl Drop for NullDevice {
    fn drop(&mut self) {
        // SAFETY: every child was destroyed in `compile`.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}
