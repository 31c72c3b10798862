//! Arguments of many dispatches at once: its cost is that of a dispatch.

use crate::harness::{Case, words};
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::DispatchArgs;
use subpixel_shadows::stages::dispatch_args::ArgsRequest;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let size = size >> 6;
    let stage = DispatchArgs::new(&gpu.device);
    let requests = (0..size).map(|i| ArgsRequest::new(i, 64, 1 << 24, i * 3)).collect::<Result<Vec<_>>>()?;
    let requests = DispatchArgs::requests(&gpu.device, &gpu.queue, &requests)?;
    let counts = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.counts", &words(size))?;
    let args = Buffer::indirect(&gpu.device, "bench.args", size * 3)?;
    Ok(vec![Case {
        name: "dispatch_args".to_owned(),
        size,
        bytes: size * 32,
        atomics: 0,
        flops: 0,
        record: Box::new(move |s| stage.record(s, &counts, &requests, &args)),
    }])
}
