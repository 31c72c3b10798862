//! `lampshade`: scan, and sort of pairs that know how many bits of their keys count. It runs on our device.

use crate::{Contestant, Made, Task, Told, milliseconds, text};
use lampshade::{KeyValue, KeyValueSorter, Scanner};
use std::time::Instant;
use subpixel_shadows::gpu::{Buffer, Gpu};

enum Work {
    Scan(Scanner),
    Sort(KeyValueSorter, u32),
}

struct Lampshade<'a> {
    gpu: &'a Gpu,
    work: Work,
    input: Buffer<u32>,
    output: Buffer<u32>,
    count: u32,
}

impl Contestant for Lampshade<'_> {
    fn output(&mut self) -> Told<[Vec<u32>; 2]> {
        self.run()?;
        let words = self.output.read(self.gpu).map_err(text)?;
        Ok(match self.work {
            Work::Scan(_) => [words, Vec::new()],
            Work::Sort(..) => {
                [words.iter().step_by(2).copied().collect(), words.iter().skip(1).step_by(2).copied().collect()]
            }
        })
    }

    fn run(&mut self) -> Told<f64> {
        let mut encoder = self.gpu.encoder();
        let (input, output) = (self.input.raw(), self.output.raw());
        match &mut self.work {
            Work::Scan(scanner) => {
                scanner.record_exclusive_scan(&mut encoder, input, output, self.count).map_err(text)?
            }
            Work::Sort(sorter, bits) => {
                sorter.record_sort_with_key_bits(&mut encoder, input, output, self.count, *bits).map_err(text)?;
            }
        }
        let start = Instant::now();
        self.gpu.submit_and_wait(encoder).map_err(text)?;
        Ok(milliseconds(start))
    }
}

fn made<'a>(gpu: &'a Gpu, work: Work, input: &[u32], count: usize) -> Made<'a> {
    let (device, queue) = (&gpu.device, &gpu.queue);
    let output = Buffer::storage(device, "peers.output", input.len()).map_err(text)?;
    let input = Buffer::from_slice(device, queue, "peers.input", input).map_err(text)?;
    Ok(Box::new(Lampshade { gpu, work, input, output, count: count as u32 }))
}

pub fn scan<'a>(gpu: &'a Gpu, task: &Task) -> Made<'a> {
    made(gpu, Work::Scan(Scanner::new(&gpu.device, &gpu.queue)), &task.keys, task.keys.len())
}

pub fn sort<'a>(gpu: &'a Gpu, task: &Task) -> Made<'a> {
    let sorter = KeyValueSorter::new_for_adapter(&gpu.device, &gpu.queue, &gpu.device.adapter_info());
    let pairs: Vec<u32> = task
        .keys
        .iter()
        .zip(&task.values)
        .flat_map(|(&key, &value)| {
            let KeyValue { key, value } = KeyValue::new(key, value);
            [key, value]
        })
        .collect();
    made(gpu, Work::Sort(sorter, task.key_bits), &pairs, task.keys.len())
}
