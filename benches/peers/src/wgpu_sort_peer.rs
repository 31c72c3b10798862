//! `wgpu_sort`: a radix sort of pairs on all 32 bits of their keys, on a wgpu of its own.

use crate::{Contestant, Made, Task, Told, milliseconds, text};
use futures::executor::block_on;
use std::num::NonZeroU32;
use std::time::Instant;
use wgpu_0_19 as wgpu;
use wgpu_sort::utils::{download_buffer, guess_workgroup_size, upload_to_buffer};
use wgpu_sort::{GPUSorter, SortBuffers};

/// The device of the other wgpu, or why there is none.
pub struct Device {
    made: Told<(wgpu::Device, wgpu::Queue, u32)>,
}

impl Device {
    pub fn open() -> Self {
        Self { made: block_on(Self::found()) }
    }

    async fn found() -> Told<(wgpu::Device, wgpu::Queue, u32)> {
        let descriptor = wgpu::InstanceDescriptor { backends: wgpu::Backends::VULKAN, ..Default::default() };
        let instance = wgpu::Instance::new(descriptor);
        let adapter = instance.request_adapter(&Default::default()).await.ok_or("no adapter")?;
        let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 27, ..wgpu::Limits::default() };
        let descriptor = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        let (device, queue) = adapter.request_device(&descriptor, None).await.map_err(text)?;
        let size = guess_workgroup_size(&device, &queue).await.ok_or("finds no subgroup size that works here")?;
        Ok((device, queue, size))
    }
}

struct Sort<'a> {
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    sorter: GPUSorter,
    buffers: SortBuffers,
    task: &'a Task,
}

impl Contestant for Sort<'_> {
    fn output(&mut self) -> Told<[Vec<u32>; 2]> {
        self.run()?;
        let read = |buffer: &wgpu::Buffer| {
            let mut words = block_on(download_buffer::<u32>(buffer, self.device, self.queue, ..));
            words.truncate(self.task.keys.len());
            words
        };
        Ok([read(self.buffers.keys()), read(self.buffers.values())])
    }

    fn run(&mut self) -> Told<f64> {
        // It sorts in place: the input is put back first, outside the time.
        let mut encoder = self.device.create_command_encoder(&Default::default());
        upload_to_buffer(&mut encoder, self.buffers.keys(), self.device, &self.task.keys);
        upload_to_buffer(&mut encoder, self.buffers.values(), self.device, &self.task.values);
        self.queue.submit([encoder.finish()]);
        self.device.poll(wgpu::Maintain::Wait);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.sorter.sort(&mut encoder, self.queue, &self.buffers, None);
        let start = Instant::now();
        self.queue.submit([encoder.finish()]);
        self.device.poll(wgpu::Maintain::Wait);
        Ok(milliseconds(start))
    }
}

pub fn sort<'a>(device: &'a Device, task: &'a Task) -> Made<'a> {
    let (device, queue, size) = match &device.made {
        Ok((device, queue, size)) => (device, queue, *size),
        Err(error) => return Err(error.clone()),
    };
    let count = NonZeroU32::new(task.keys.len() as u32).ok_or("nothing to sort")?;
    let sorter = GPUSorter::new(device, size);
    let buffers = sorter.create_sort_buffers(device, count);
    Ok(Box::new(Sort { device, queue, sorter, buffers, task }))
}
