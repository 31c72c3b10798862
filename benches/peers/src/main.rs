//! Scan and sort of this library beside those of others and of the CPU, on the same data, in one process and in turns.
//!
//! `cargo run --release --manifest-path benches/peers/Cargo.toml -- [--sizes LOG2,…] [--repeats N] [--adapter TEXT]`
//!
//! Time is wall time from submission to the end of the work, the same for all; nothing is read back within it. Every
//! contestant's output is held against the CPU's before it is timed; one whose output is wrong, or that does not run here,
//! stays in the table and says so.

mod lampshade_peer;
mod wgpu_sort_peer;

use std::time::Instant;
use subpixel_shadows::gpu::{Buffer, Gpu, Recorder};
use subpixel_shadows::stages::radix_sort::Pairs;
use subpixel_shadows::stages::{Count, PrefixScan, RadixSort};
use subpixel_shadows::{Error, Result};

/// What a contestant is given.
pub struct Task {
    pub keys: Vec<u32>,
    pub values: Vec<u32>,
    pub key_bits: u32,
}

/// Something that does a task: once for its output, then as often as wanted for its time.
pub trait Contestant {
    fn output(&mut self) -> Told<[Vec<u32>; 2]>;
    fn run(&mut self) -> Told<f64>;
}

fn words(count: usize, bits: u32) -> Vec<u32> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 16) as u32
    };
    (0..count).map(|_| next() >> (32 - bits)).collect()
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string().lines().next().unwrap_or_default().to_owned()
}

fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn scan_wanted(task: &Task) -> [Vec<u32>; 2] {
    let sums = task.keys.iter().scan(0u32, |sum, v| {
        let before = *sum;
        *sum = sum.wrapping_add(*v);
        Some(before)
    });
    [sums.collect(), Vec::new()]
}

fn sort_wanted(task: &Task) -> [Vec<u32>; 2] {
    let mut pairs: Vec<(u32, u32)> = task.keys.iter().copied().zip(task.values.iter().copied()).collect();
    pairs.sort_by_key(|p| p.0);
    pairs.into_iter().unzip::<u32, u32, Vec<_>, Vec<_>>().into()
}

/// The standard library on one thread.
struct Cpu<'a> {
    task: &'a Task,
    work: fn(&Task) -> [Vec<u32>; 2],
}

impl Contestant for Cpu<'_> {
    fn output(&mut self) -> Told<[Vec<u32>; 2]> {
        Ok((self.work)(self.task))
    }

    fn run(&mut self) -> Told<f64> {
        let start = Instant::now();
        std::hint::black_box((self.work)(self.task));
        Ok(milliseconds(start))
    }
}

/// Our scan or sort; the buffers stay as they are.
struct Ours<'a, R: Fn(&mut Recorder, &[Buffer<u32>]) -> Result<()>> {
    gpu: &'a Gpu,
    record: R,
    outputs: Vec<Buffer<u32>>,
    count: usize,
}

impl<R: Fn(&mut Recorder, &[Buffer<u32>]) -> Result<()>> Contestant for Ours<'_, R> {
    fn output(&mut self) -> Told<[Vec<u32>; 2]> {
        self.run()?;
        let read = |buffer: Option<&Buffer<u32>>| match buffer {
            Some(buffer) => buffer.read_first(self.gpu, self.count).map_err(text),
            None => Ok(Vec::new()),
        };
        Ok([read(self.outputs.first())?, read(self.outputs.get(1))?])
    }

    fn run(&mut self) -> Told<f64> {
        let mut encoder = self.gpu.encoder();
        (self.record)(&mut Recorder::new(&self.gpu.device, &mut encoder, None), &self.outputs).map_err(text)?;
        let start = Instant::now();
        self.gpu.submit_and_wait(encoder).map_err(text)?;
        Ok(milliseconds(start))
    }
}

fn our_scan<'a>(gpu: &'a Gpu, task: &Task) -> Result<Box<dyn Contestant + 'a>> {
    let (device, count) = (&gpu.device, task.keys.len());
    let input = Buffer::from_slice(device, &gpu.queue, "peers.input", &task.keys)?;
    let output = Buffer::<u32>::storage(device, "peers.output", count)?;
    let total = Buffer::<u32>::storage(device, "peers.total", 2)?;
    let scratch = PrefixScan::scratch(device, count)?;
    let stage = PrefixScan::new(device);
    let record = move |rec: &mut Recorder, outputs: &[Buffer<u32>]| {
        stage.record(&mut rec.stage("scan"), &input, &outputs[0], (&total, 0), &scratch, Count::Exactly(count))
    };
    Ok(Box::new(Ours { gpu, record, outputs: vec![output], count }))
}

fn our_sort<'a>(gpu: &'a Gpu, task: &Task) -> Result<Box<dyn Contestant + 'a>> {
    let (device, count, key_bits) = (&gpu.device, task.keys.len(), task.key_bits);
    let keys = Buffer::from_slice(device, &gpu.queue, "peers.keys", &task.keys)?;
    let values = Buffer::from_slice(device, &gpu.queue, "peers.values", &task.values)?;
    let [sorted_keys, sorted_values] = [
        Buffer::<u32>::storage(device, "peers.sorted", count)?,
        Buffer::<u32>::storage(device, "peers.sorted", count)?,
    ];
    let scratch = RadixSort::scratch(device, count)?;
    let stage = RadixSort::new(device, &PrefixScan::new(device));
    let outputs = vec![sorted_keys, sorted_values];
    let record = move |rec: &mut Recorder, outputs: &[Buffer<u32>]| {
        let from = Pairs { keys: &keys, values: &values };
        let to = Pairs { keys: &outputs[0], values: &outputs[1] };
        stage.record(&mut rec.stage("sort"), from, to, &scratch, key_bits, Count::Exactly(count))
    };
    Ok(Box::new(Ours { gpu, record, outputs, count }))
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Runs everybody in turns and prints their rows.
fn compare(what: &str, size: usize, wanted: &[Vec<u32>; 2], contestants: Vec<(&str, Made)>, repeats: usize) {
    let mut ready: Vec<(&str, Told<Box<dyn Contestant + '_>>, Vec<f64>)> = Vec::new();
    for (name, made) in contestants {
        let checked = made.and_then(|mut c| match c.output() {
            Ok(output) if output == *wanted => Ok(c),
            Ok(_) => Err("wrong output".to_owned()),
            Err(error) => Err(error),
        });
        ready.push((name, checked, Vec::new()));
    }
    for _ in 0..repeats {
        for (_, made, times) in &mut ready {
            if let Ok(contestant) = made {
                match contestant.run() {
                    Ok(time) => times.push(time),
                    Err(error) => *made = Err(error),
                }
            }
        }
    }
    let ours = median(&mut ready[0].2.clone());
    for (name, made, mut times) in ready {
        match made {
            Ok(_) => {
                let time = median(&mut times);
                println!("| {what} | {size} | {name} | {time:.3} | {:.2} |", time / ours);
            }
            Err(error) => println!("| {what} | {size} | {name} | {error} | |"),
        }
    }
}

/// A contestant, or why there is none.
type Made<'a> = Told<Box<dyn Contestant + 'a>>;

/// What somebody else's code says if it fails.
type Told<T> = std::result::Result<T, String>;

fn main() -> Result<()> {
    let (mut sizes, mut repeats, mut adapter) = (vec![10, 12, 14, 16, 18, 20, 22], 15, None);
    let mut arguments = std::env::args().skip(1);
    let bad = |text: &str| Error::Config(format!("'{text}' is no number"));
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or_else(|| Error::Config(format!("{argument} needs a value")))?;
        match argument.as_str() {
            "--sizes" => sizes = value.split(',').map(|t| t.parse().map_err(|_| bad(t))).collect::<Result<_>>()?,
            "--repeats" => repeats = value.parse::<usize>().map_err(|_| bad(&value))?.max(1),
            "--adapter" => adapter = Some(value),
            _ => return Err(Error::Config(format!("{argument}: --sizes, --repeats and --adapter are known"))),
        }
    }
    let gpu = Gpu::open(adapter.as_deref())?;
    println!("{} ({}), {} threads of the CPU for it\n", gpu.adapter.name, gpu.adapter.driver, threads());
    println!("| task | elements | who | ms | / ours |");
    println!("|---|---|---|---|---|");
    let outside = wgpu_sort_peer::Device::open();
    for log in sizes {
        let size = 1usize << log;
        let task = Task { keys: words(size, 8), values: Vec::new(), key_bits: 32 };
        let contestants = vec![
            ("ours", our_scan(&gpu, &task).map_err(text)),
            ("lampshade 0.13", lampshade_peer::scan(&gpu, &task)),
            ("CPU, one thread", Ok(Box::new(Cpu { task: &task, work: scan_wanted }) as Box<dyn Contestant>)),
        ];
        compare("exclusive scan", size, &scan_wanted(&task), contestants, repeats);
        for key_bits in [18, 32] {
            let task = Task { keys: words(size, key_bits), values: words(size, 32), key_bits };
            let contestants = vec![
                ("ours", our_sort(&gpu, &task).map_err(text)),
                ("lampshade 0.13", lampshade_peer::sort(&gpu, &task)),
                ("wgpu_sort 0.1", wgpu_sort_peer::sort(&outside, &task)),
                ("CPU, one thread", Ok(Box::new(Cpu { task: &task, work: sort_wanted }) as Box<dyn Contestant>)),
            ];
            compare(&format!("sort of pairs, {key_bits}-bit keys"), size, &sort_wanted(&task), contestants, repeats);
        }
    }
    Ok(())
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
