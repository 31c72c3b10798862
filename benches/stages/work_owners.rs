//! The table of so many items of owners that have two on the average.

use crate::harness::{Case, words};
use oracle::reference::prefix_scan::exclusive;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::WorkOwners;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    let owners = size / 2;
    let counts: Vec<u32> = words(owners).iter().map(|w| w % 5).collect();
    let scan = exclusive(&counts);
    let mut content = [scan.sums, vec![scan.total, 0]].concat();
    content.resize(WorkOwners::words(owners, 0), 0);
    let offsets = Buffer::from_slice(&gpu.device, &gpu.queue, "bench.offsets", &content)?;
    let stage = WorkOwners::new(&gpu.device);
    let steps = owners.max(2).ilog2() as usize;
    Ok(vec![Case {
        name: "work_owners".to_owned(),
        size,
        bytes: size / 8 * 4 * (steps + 2),
        atomics: 0,
        flops: 0,
        record: Box::new(move |s| stage.record(s, &offsets, owners)),
    }])
}
