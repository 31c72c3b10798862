//! Measuring: ceilings of the device, interleaved repeats, tables.

pub mod geometry;
pub mod shadow;

use serde::Serialize;
use std::fmt;
use subpixel_shadows::gpu::program::{Access, Binding};
use subpixel_shadows::gpu::{AdapterSummary, Buffer, Entry, Gpu, Groups, Program, Recorder, Stage, Timer};
use subpixel_shadows::{Error, Result, wgpu};

/// What the command line asks for.
pub struct Options {
    filter: String,
    quick: bool,
    json: Option<String>,
    logs: Vec<u32>,
    /// Rounds of each size.
    pub repeats: usize,
}

impl Options {
    /// Reads the command line; what cargo adds is ignored.
    pub fn from_args() -> Self {
        let mut options = Self { filter: String::new(), quick: false, json: None, logs: Vec::new(), repeats: 0 };
        let mut args = std::env::args().skip(1);
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--quick" => options.quick = true,
                "--json" => options.json = args.next(),
                "--log-sizes" => {
                    let list = args.next().unwrap_or_default();
                    options.logs = list.split(',').filter_map(|n| n.parse().ok()).filter(|&n| n <= 25).collect();
                }
                "--repeats" => options.repeats = args.next().and_then(|n| n.parse().ok()).unwrap_or(0),
                _ if arg.starts_with("--") => {}
                _ => options.filter = arg,
            }
        }
        if options.repeats == 0 {
            options.repeats = if options.quick { 5 } else { 15 };
        }
        options
    }

    /// Logarithms of the sizes.
    pub fn log_sizes(&self) -> Vec<u32> {
        match (self.logs.is_empty(), self.quick) {
            (false, _) => self.logs.clone(),
            (true, true) => vec![10, 14, 18],
            (true, false) => (10..=24).step_by(2).collect(),
        }
    }

    /// Whether a case is asked for.
    pub fn wants(&self, name: &str) -> bool {
        name.contains(&self.filter)
    }

    /// Writes the table as JSON, if asked for.
    pub fn save(&self, gpu: &Gpu, ceilings: &Ceilings, rows: &[Row]) -> Result<()> {
        #[derive(Serialize)]
        struct Table<'a> {
            adapter: &'a AdapterSummary,
            ceilings: &'a Ceilings,
            repeats: usize,
            rows: &'a [Row],
        }
        let Some(path) = &self.json else { return Ok(()) };
        let table = Table { adapter: &gpu.adapter, ceilings, repeats: self.repeats, rows };
        let text = serde_json::to_string_pretty(&table).map_err(|e| Error::file(path, e.to_string()))?;
        std::fs::write(path, text).map_err(|e| Error::file(path, e.to_string()))
    }
}

/// What records a case.
pub type Record<'a> = dyn Fn(&mut Stage) -> Result<()> + 'a;

/// One thing to time.
pub struct Case<'a> {
    /// Stage, and variant if there are several.
    pub name: String,
    /// Items, pairs or texels.
    pub size: usize,
    /// Bytes that it must move, read and written.
    pub bytes: usize,
    /// Atomics that it must do.
    pub atomics: usize,
    /// Records it.
    pub record: Box<Record<'a>>,
}

/// What the device does at best, measured in this run.
#[derive(Debug, Serialize)]
pub struct Ceilings {
    /// Bytes (read and written) of a copy by vec4.
    pub bytes_per_ms: f64,
    /// Atomics to 2^20 scattered words.
    pub atomics_per_ms: f64,
    /// One dispatch that depends on the one before.
    pub dispatch_ms: f64,
}

const PROBES: &str = "
@group(0) @binding(0) var<storage, read> source: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> target_quads: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read_write> words: array<atomic<u32>>;
@compute @workgroup_size(64) fn copy(@builtin(global_invocation_id) id: vec3<u32>) {
    target_quads[id.x] = source[id.x];
}
@compute @workgroup_size(64) fn scatter(@builtin(global_invocation_id) id: vec3<u32>) {
    atomicOr(&words[(id.x * 2654435769u) >> 12u], id.x);
}
@compute @workgroup_size(1) fn step() { atomicAdd(&words[0], 1u); }
";

fn probe(name: &'static str, bindings: &'static [Binding]) -> Entry {
    let size = if name == "step" { 1 } else { 64 };
    Entry { kernel: "probe", name, source: PROBES, workgroup: [size, 1, 1], bindings }
}

impl Ceilings {
    /// Measures them, best of several.
    pub fn measure(gpu: &Gpu) -> Result<Self> {
        const WORDS: &[Binding] = &[Binding { index: 2, name: "words", access: Access::ReadWrite }];
        const COPY: &[Binding] = &[
            Binding { index: 0, name: "source", access: Access::Read },
            Binding { index: 1, name: "target_quads", access: Access::ReadWrite },
        ];
        const STEPS: usize = 64;
        let quads = 1usize << 22;
        let device = &gpu.device;
        let source = Buffer::<[u32; 4]>::storage(device, "probe.source", quads)?;
        let target = Buffer::<[u32; 4]>::storage(device, "probe.target", quads)?;
        let words = Buffer::<u32>::storage(device, "probe.words", 1 << 20)?;
        let copy = Program::new(device, probe("copy", COPY), &[]);
        let scatter = Program::new(device, probe("scatter", WORDS), &[]);
        let step = Program::new(device, probe("step", WORDS), &[]);
        let best = |record: &Record| -> Result<f64> {
            let times = (0..7).map(|_| time(gpu, record)).collect::<Result<Vec<_>>>()?;
            Ok(times.into_iter().fold(f64::MAX, f64::min))
        };
        let buffers = [("source", source.raw()), ("target_quads", target.raw()), ("words", words.raw())];
        let copy_ms = best(&|s| s.run(&copy, &buffers, Groups::Items(quads as u64)))?;
        let scatter_ms = best(&|s| s.run(&scatter, &buffers, Groups::Items(1 << 20)))?;
        let step_ms = best(&|s| (0..STEPS).try_for_each(|_| s.run(&step, &buffers, Groups::Workgroups(1))))?;
        Ok(Self {
            bytes_per_ms: (quads * 32) as f64 / copy_ms,
            atomics_per_ms: (1 << 20) as f64 / scatter_ms,
            dispatch_ms: step_ms / STEPS as f64,
        })
    }

    /// The least time that work can take.
    fn limit_ms(&self, case: &Case, dispatches: u32) -> f64 {
        let work = (case.bytes as f64 / self.bytes_per_ms).max(case.atomics as f64 / self.atomics_per_ms);
        work + f64::from(dispatches) * self.dispatch_ms
    }
}

/// GPU time of one recording, in milliseconds.
fn time(gpu: &Gpu, record: &Record) -> Result<f64> {
    Ok(time_and_count(gpu, record)?.0)
}

/// GPU time of one recording in milliseconds, and its dispatches.
fn time_and_count(gpu: &Gpu, record: &Record) -> Result<(f64, u32)> {
    let mut timer = Timer::new(gpu).ok_or_else(|| Error::NoAdapter("the device has no time stamps".to_owned()))?;
    let mut encoder = gpu.encoder();
    let mut recorder = Recorder::new(&gpu.device, &mut encoder, Some(&mut timer));
    record(&mut recorder.stage("case"))?;
    let dispatches = recorder.dispatches();
    timer.resolve(&mut encoder);
    gpu.submit_and_wait(encoder)?;
    Ok((timer.read(gpu)?.iter().map(|t| t.gpu_ms).sum(), dispatches))
}

/// One line of the table.
#[derive(Debug, Serialize)]
pub struct Row {
    name: String,
    size: usize,
    dispatches: u32,
    median_ms: f64,
    min_ms: f64,
    p90_ms: f64,
    limit_ms: f64,
}

impl Row {
    /// What the columns hold.
    pub const HEAD: &'static str = "case                            size  disp.   median ms      min ms      p90 ms    limit ms  median/limit  M items/s";
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{:<26}{:>10}  {:>5}  {:>10.4}  {:>10.4}  {:>10.4}  {:>10.4}  {:>12.1}  {:>9.1}",
            self.name,
            self.size,
            self.dispatches,
            self.median_ms,
            self.min_ms,
            self.p90_ms,
            self.limit_ms,
            self.median_ms / self.limit_ms,
            self.size as f64 / self.median_ms * 1e-3
        )
    }
}

/// Times all cases in turn, round after round, after three rounds that do not count.
pub fn measure(gpu: &Gpu, ceilings: &Ceilings, cases: &[Case], repeats: usize) -> Result<Vec<Row>> {
    let mut times = vec![Vec::with_capacity(repeats); cases.len()];
    let mut dispatches = vec![0; cases.len()];
    for round in 0..repeats + 3 {
        for (i, case) in cases.iter().enumerate() {
            let (ms, count) = time_and_count(gpu, &case.record)?;
            dispatches[i] = count;
            if round >= 3 {
                times[i].push(ms);
            }
        }
    }
    let row = |((case, mut times), dispatches): ((&Case, Vec<f64>), u32)| {
        times.sort_by(f64::total_cmp);
        Row {
            name: case.name.clone(),
            size: case.size,
            dispatches,
            median_ms: times[times.len() / 2],
            min_ms: times[0],
            p90_ms: times[times.len() * 9 / 10],
            limit_ms: ceilings.limit_ms(case, dispatches),
        }
    };
    Ok(cases.iter().zip(times).zip(dispatches).map(row).collect())
}

/// A view of a texture of about `size` texels, and its sides: four texels wide in proportion to one high. `None` where the
/// device has none so wide.
pub fn texture(
    gpu: &Gpu,
    size: usize,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> Option<(wgpu::TextureView, [u32; 2])> {
    let width = (2.0 * (size as f64).sqrt()) as u32;
    let height = (size as u32 / width).max(1);
    if width > gpu.device.limits().max_texture_dimension_2d {
        return None;
    }
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("bench.texture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    Some((texture.create_view(&Default::default()), [width, height]))
}

/// Well mixed words, the same on every machine.
pub fn words(len: usize) -> Vec<u32> {
    (0..len as u32)
        .map(|i| {
            let mut z = i.wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
            z = (z ^ (z >> 16)).wrapping_mul(0x21f0_aaad);
            z = (z ^ (z >> 15)).wrapping_mul(0x735a_2d97);
            z ^ (z >> 15)
        })
        .collect()
}
