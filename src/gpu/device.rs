//! Finding an adapter and opening a device for the program and the tests. A library user brings their own.

use crate::{Error, Result};
use futures::executor::block_on;
use std::sync::{Arc, Mutex, OnceLock};
use std::time::Duration;

/// Summary of an adapter in tables and files.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AdapterSummary {
    /// Name the driver gives.
    pub name: String,
    /// Graphics API.
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// Whether it is a software renderer on the CPU.
    pub software: bool,
}

impl AdapterSummary {
    /// The summary of `info`.
    pub fn of(info: &wgpu::AdapterInfo) -> Self {
        Self {
            name: info.name.clone(),
            backend: info.backend.to_string(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            software: info.device_type == wgpu::DeviceType::Cpu,
        }
    }
}

/// A device, its queue, and where its errors are kept.
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// The adapter.
    pub adapter: AdapterSummary,
    fault: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Longest wait for a submission, after which the GPU counts as hung.
    pub const PATIENCE: Duration = Duration::from_secs(300);

    /// Features that atomic operations on 64 bits need.
    pub const WIDE_ATOMICS: wgpu::Features =
        wgpu::Features::SHADER_INT64.union(wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS);

    /// Features used where the adapter has them; none is required.
    pub fn optional_features() -> wgpu::Features {
        wgpu::Features::TIMESTAMP_QUERY | Self::WIDE_ATOMICS
    }

    /// Every adapter of this machine, of the one instance that a process has here: wgpu takes devices of two instances for the same.
    pub fn adapters() -> Vec<wgpu::Adapter> {
        static INSTANCE: OnceLock<wgpu::Instance> = OnceLock::new();
        let instance = INSTANCE
            .get_or_init(|| wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env()));
        let backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY);
        block_on(instance.enumerate_adapters(backends))
    }

    /// Opens the adapter whose name contains `name` (case does not matter), else the best one: hardware before
    /// software. The environment variables `WGPU_ADAPTER_NAME` and `WGPU_BACKEND` are honoured.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] naming what was looked for and what is there; [`Error::Gpu`] if the device cannot be opened.
    pub fn open(name: Option<&str>) -> Result<Self> {
        Self::open_with_limits(name, None)
    }

    /// As [`Gpu::open`], with these limits instead of the adapter's own for storage (tests use small ones).
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn open_with_limits(name: Option<&str>, limits: Option<wgpu::Limits>) -> Result<Self> {
        let wanted = name.map(str::to_owned).or_else(|| std::env::var("WGPU_ADAPTER_NAME").ok());
        let mut all = Self::adapters();
        let names: Vec<_> = all.iter().map(|a| a.get_info().name).collect();
        if let Some(text) = &wanted {
            let text = text.to_lowercase();
            all.retain(|a| a.get_info().name.to_lowercase().contains(&text));
        }
        all.sort_by_key(|a| match a.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        });
        let adapter = all.into_iter().next().ok_or_else(|| {
            let found =
                if names.is_empty() { "none was found".to_owned() } else { format!("found: {}", names.join(", ")) };
            Error::NoAdapter(wanted.map_or(found.clone(), |w| format!("no name contains '{w}'; {found}")))
        })?;
        Self::from_adapter(&adapter, limits)
    }

    /// Opens a device on `adapter` with the storage limits it offers.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device cannot be opened.
    pub fn from_adapter(adapter: &wgpu::Adapter, limits: Option<wgpu::Limits>) -> Result<Self> {
        let offered = adapter.limits();
        let limits = limits.unwrap_or(wgpu::Limits {
            max_buffer_size: offered.max_buffer_size,
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            ..wgpu::Limits::default()
        });
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("subpixel-shadows"),
            required_features: adapter.features() & Self::optional_features(),
            required_limits: limits,
            ..Default::default()
        };
        let (device, queue) = block_on(adapter.request_device(&descriptor)).map_err(|e| Error::Gpu(e.to_string()))?;
        let fault = Arc::new(Mutex::new(None));
        let keep = |fault: &Arc<Mutex<Option<String>>>, text: String| {
            if let Ok(mut slot) = fault.lock() {
                slot.get_or_insert(text);
            }
        };
        let on_error = fault.clone();
        device.on_uncaptured_error(Arc::new(move |e| keep(&on_error, e.to_string().replace('\n', " "))));
        let on_lost = fault.clone();
        device.set_device_lost_callback(move |reason, text| keep(&on_lost, format!("device lost ({reason:?}) {text}")));
        Ok(Self { device, queue, adapter: AdapterSummary::of(&adapter.get_info()), fault })
    }

    /// The first error the device has reported since the last call, if any.
    ///
    /// # Errors
    /// [`Error::Gpu`] with the device's own text.
    pub fn check(&self) -> Result<()> {
        match self.fault.lock().map(|mut f| f.take()) {
            Ok(Some(text)) => Err(Error::Gpu(text)),
            _ => Ok(()),
        }
    }

    /// Submits `encoder` and waits until the GPU is done.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device reports an error or gives no answer within [`Gpu::PATIENCE`].
    pub fn submit_and_wait(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        let index = self.queue.submit([encoder.finish()]);
        self.wait(Some(index))
    }

    /// Waits for a submission, or for the newest.
    ///
    /// # Errors
    /// As [`Gpu::submit_and_wait`].
    pub fn wait(&self, index: Option<wgpu::SubmissionIndex>) -> Result<()> {
        let poll = wgpu::PollType::Wait { submission_index: index, timeout: Some(Self::PATIENCE) };
        let polled = self.device.poll(poll);
        self.check()?;
        polled.map(|_| ()).map_err(|e| Error::Gpu(format!("no result within {} s ({e})", Self::PATIENCE.as_secs())))
    }

    /// A fresh encoder.
    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("subpixel-shadows") })
    }
}
