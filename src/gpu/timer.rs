//! GPU time of each stage, from time stamps at the begin and end of its compute passes.

use super::Gpu;
use super::buffer::{allocate, not_mapped};
use super::ledger::Held;
use crate::Result;

/// GPU time of one stage.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StageTime {
    /// The stage.
    pub name: &'static str,
    /// Milliseconds, summed over its passes.
    pub gpu_ms: f64,
}

/// Collects time stamps of up to [`Timer::PASSES`] passes of one submission.
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: Held,
    staging: Held,
    names: Vec<&'static str>,
    period_ns: f64,
}

impl Timer {
    /// Most passes of one submission; later ones go untimed.
    pub const PASSES: u32 = 2048;
    /// Bytes that the time stamps of a submission take at most.
    pub const BYTES: u64 = Self::PASSES as u64 * 16;

    /// A timer, or `None` where the device has no time stamps.
    ///
    /// # Errors
    /// As [`allocate`].
    pub fn new(gpu: &Gpu) -> Result<Option<Self>> {
        Self::on(&gpu.device, &gpu.queue)
    }

    /// As [`Timer::new`], on a device of one's own.
    ///
    /// # Errors
    /// As [`Timer::new`].
    pub fn on(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Option<Self>> {
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        use wgpu::BufferUsages as U;
        let size = Self::BYTES;
        let buffer = |label, usage| allocate(device, label, size, usage, false);
        Ok(Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timer"),
                ty: wgpu::QueryType::Timestamp,
                count: Self::PASSES * 2,
            }),
            resolved: buffer("timer.resolved", U::QUERY_RESOLVE | U::COPY_SRC)?,
            staging: buffer("timer.staging", U::COPY_DST | U::MAP_READ)?,
            names: Vec::new(),
            period_ns: f64::from(queue.get_timestamp_period()),
        }))
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
        self.resolve_to(encoder, &self.staging, 0);
    }

    /// As [`Timer::resolve`], with the copy in a buffer of one's own, from byte `at`.
    pub fn resolve_to(&self, encoder: &mut wgpu::CommandEncoder, staging: &wgpu::Buffer, at: u64) {
        let count = self.names.len() as u32 * 2;
        if count > 0 {
            encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
            encoder.copy_buffer_to_buffer(&self.resolved, 0, staging, at, u64::from(count) * 8);
        }
    }

    /// The passes recorded since the last [`Timer::reset`].
    pub fn passes(&self) -> &[&'static str] {
        &self.names
    }

    /// The times of the submission, in order of first use of each name; waits for the GPU.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device fails.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<StageTime>> {
        if self.names.is_empty() {
            return Ok(Vec::new());
        }
        self.staging.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu.wait(None)?;
        let times = {
            let view = self.staging.get_mapped_range(..).map_err(|e| not_mapped("reading time stamps", &e))?;
            self.times(&self.names, &view)
        };
        self.staging.unmap();
        Ok(times)
    }

    /// The times of `passes`, in order of first use of each name, from the bytes that [`Timer::resolve_to`] wrote.
    pub fn times(&self, passes: &[&'static str], stamps: &[u8]) -> Vec<StageTime> {
        let mut times: Vec<StageTime> = Vec::new();
        let (stamps, _) = stamps.as_chunks::<8>();
        for (name, pass) in passes.iter().zip(stamps.chunks_exact(2)) {
            let [begin, end] = [pass[0], pass[1]].map(u64::from_le_bytes);
            let ms = end.saturating_sub(begin) as f64 * self.period_ns * 1e-6;
            match times.iter_mut().find(|t| t.name == *name) {
                Some(t) => t.gpu_ms += ms,
                None => times.push(StageTime { name, gpu_ms: ms }),
            }
        }
        times
    }
}
