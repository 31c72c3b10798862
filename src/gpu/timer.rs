//! GPU time of each stage, from time stamps at the begin and end of its compute passes.

use super::Gpu;
use crate::{Error, Result};
use serde::Serialize;

/// GPU time of one stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageTime {
    /// The stage.
    pub name: &'static str,
    /// Milliseconds, summed over its passes.
    pub gpu_ms: f64,
}

/// Collects time stamps of up to [`Timer::PASSES`] passes of one submission.
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    names: Vec<&'static str>,
    period_ns: f64,
}

impl Timer {
    /// Most passes of one submission; later ones go untimed.
    pub const PASSES: u32 = 256;

    /// A timer, or `None` where the device has no time stamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        use wgpu::BufferUsages as U;
        let size = u64::from(Self::PASSES) * 16;
        let buffer = |label, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timer"),
                ty: wgpu::QueryType::Timestamp,
                count: Self::PASSES * 2,
            }),
            resolved: buffer("timer.resolved", U::QUERY_RESOLVE | U::COPY_SRC),
            staging: buffer("timer.staging", U::COPY_DST | U::MAP_READ),
            names: Vec::new(),
            period_ns: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// Forgets the passes of the last submission.
    pub fn reset(&mut self) {
        self.names.clear();
    }

    /// The query set and the first of the two queries of a new pass.
    pub(super) fn begin(&mut self, name: &'static str) -> Option<(wgpu::QuerySet, u32)> {
        let first = self.names.len() as u32 * 2;
        if first + 1 >= Self::PASSES * 2 {
            return None;
        }
        self.names.push(name);
        Some((self.queries.clone(), first))
    }

    /// Appends the copy of the time stamps to the end of `encoder`.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let count = self.names.len() as u32 * 2;
        if count > 0 {
            encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, u64::from(count) * 8);
        }
    }

    /// The times of the submission, in order of first use of each name; waits for the GPU.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device fails.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<StageTime>> {
        let mut times: Vec<StageTime> = Vec::new();
        if self.names.is_empty() {
            return Ok(times);
        }
        self.staging.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu.wait(None)?;
        {
            let view =
                self.staging.get_mapped_range(..).map_err(|e| Error::Gpu(format!("reading time stamps: {e}")))?;
            let word = |i: usize| {
                let mut bytes = [0u8; 8];
                bytes.copy_from_slice(&view[i * 8..i * 8 + 8]);
                u64::from_le_bytes(bytes)
            };
            for (i, name) in self.names.iter().enumerate() {
                let ms = word(2 * i + 1).saturating_sub(word(2 * i)) as f64 * self.period_ns * 1e-6;
                match times.iter_mut().find(|t| t.name == *name) {
                    Some(t) => t.gpu_ms += ms,
                    None => times.push(StageTime { name, gpu_ms: ms }),
                }
            }
        }
        self.staging.unmap();
        Ok(times)
    }
}
