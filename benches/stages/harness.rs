//! Measuring: ceilings of the device, interleaved repeats, tables.

pub mod geometry;
pub mod shadow;

use serde::Serialize;
use std::fmt;
use subpixel_shadows::entry_point;
use subpixel_shadows::gpu::bindings::{Read, Write};
use subpixel_shadows::gpu::{AdapterSummary, Buffer, Gpu, Groups, Recorder, Source, Stage, Timer};
use subpixel_shadows::{Error, Result, wgpu};

/// What the command line asks for.
pub struct Options {
    filter: String,
    quick: bool,
    json: Option<String>,
    baseline: Option<String>,
    logs: Vec<u32>,
    /// Rounds of each size.
    pub repeats: usize,
}

impl Options {
    /// Reads the command line; what cargo adds is ignored.
    pub fn from_args() -> Self {
        let mut options =
            Self { filter: String::new(), quick: false, json: None, baseline: None, logs: Vec::new(), repeats: 0 };
        let mut args = std::env::args().skip(1);
        while let Some(arg) = args.next() {
            match arg.as_str() {
                "--quick" => options.quick = true,
                "--json" => options.json = args.next(),
                "--baseline" => options.baseline = args.next(),
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

    /// Whether a case is asked for: its name contains one of the filters, which commas part.
    pub fn wants(&self, name: &str) -> bool {
        self.filter.split(',').any(|part| name.contains(part))
    }

    /// The medians of the table that an earlier run wrote with `--json`, by name and size.
    pub fn baseline(&self) -> Result<Baseline> {
        #[derive(serde::Deserialize)]
        struct Old {
            name: String,
            size: usize,
            median_ms: f64,
        }
        #[derive(serde::Deserialize)]
        struct Table {
            rows: Vec<Old>,
        }
        let Some(path) = &self.baseline else { return Ok(Baseline::default()) };
        let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e.to_string()))?;
        let table: Table = serde_json::from_str(&text).map_err(|e| Error::file(path, e.to_string()))?;
        Ok(Baseline(table.rows.into_iter().map(|row| ((row.name, row.size), row.median_ms)).collect()))
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

/// Medians of an earlier run.
#[derive(Default)]
pub struct Baseline(std::collections::HashMap<(String, usize), f64>);

impl Baseline {
    /// Notes in `row` what it took before.
    pub fn note(&self, row: &mut Row) {
        row.baseline_ms = self.0.get(&(row.name.clone(), row.size)).copied();
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
    /// Additions and multiplications of `f32` that its definition asks for; 0 where they do not matter.
    pub flops: usize,
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
    /// Additions and multiplications of `f32`, in four independent chains an invocation.
    pub flops_per_ms: f64,
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
@compute @workgroup_size(64) fn multiply(@builtin(global_invocation_id) id: vec3<u32>) {
    let x = f32(id.x & 255u) * 0.001;
    var a = vec4(x); var b = vec4(x + 1.0); var c = vec4(x + 2.0); var d = vec4(x + 3.0);
    for (var k = 0u; k < 256u; k++) {
        a = a * 0.999 + 0.001; b = b * 0.998 + 0.002; c = c * 0.997 + 0.003; d = d * 0.996 + 0.004;
    }
    let sum = a + b + c + d;
    if sum.x + sum.y + sum.z + sum.w == 0.1234 { atomicAdd(&words[0], 1u); }
}
@compute @workgroup_size(1) fn step() { atomicAdd(&words[0], 1u); }
";

entry_point! { "probe", "copy", [64, 1, 1], Source(&[PROBES]), () => Copying, CopyingProgram {
    0 source: Read<'a, [u32; 4]>,
    1 target_quads: Write<'a, [u32; 4]>,
} }

entry_point! { "probe", "scatter", [64, 1, 1], Source(&[PROBES]), () => Scatter, ScatterProgram {
    2 words: Write<'a, u32>,
} }

entry_point! { "probe", "multiply", [64, 1, 1], Source(&[PROBES]), () => Multiply, MultiplyProgram {
    2 words: Write<'a, u32>,
} }

entry_point! { "probe", "step", [1, 1, 1], Source(&[PROBES]), () => Step, StepProgram {
    2 words: Write<'a, u32>,
} }

impl Ceilings {
    /// Measures them, best of several.
    pub fn measure(gpu: &Gpu) -> Result<Self> {
        const STEPS: usize = 64;
        let quads = 1usize << 22;
        let device = &gpu.device;
        let source = Buffer::<[u32; 4]>::storage(device, "probe.source", quads)?;
        let target = Buffer::<[u32; 4]>::storage(device, "probe.target", quads)?;
        let words = Buffer::<u32>::storage(device, "probe.words", 1 << 20)?;
        let copy = CopyingProgram::new(device, ());
        let scatter = ScatterProgram::new(device, ());
        let multiply = MultiplyProgram::new(device, ());
        let step = StepProgram::new(device, ());
        let best = |record: &Record| -> Result<f64> {
            let times = (0..7).map(|_| time(gpu, record)).collect::<Result<Vec<_>>>()?;
            Ok(times.into_iter().fold(f64::MAX, f64::min))
        };
        let copied = Copying { source: source.as_read(), target_quads: target.as_write() };
        let words = words.as_write();
        let copy_ms = best(&|s| {
            s.run(&copy, copied, Groups::Items(quads as u64));
            Ok(())
        })?;
        let scatter_ms = best(&|s| {
            s.run(&scatter, Scatter { words }, Groups::Items(1 << 20));
            Ok(())
        })?;
        let multiply_ms = best(&|s| {
            s.run(&multiply, Multiply { words }, Groups::Items(1 << 16));
            Ok(())
        })?;
        let step_ms = best(&|s| {
            (0..STEPS).for_each(|_| s.run(&step, Step { words }, Groups::Workgroups(1)));
            Ok(())
        })?;
        Ok(Self {
            bytes_per_ms: (quads * 32) as f64 / copy_ms,
            atomics_per_ms: (1 << 20) as f64 / scatter_ms,
            // 256 turns of four times four lanes, a product and a sum each.
            flops_per_ms: ((1u64 << 16) * 256 * 4 * 4 * 2) as f64 / multiply_ms,
            dispatch_ms: step_ms / STEPS as f64,
        })
    }

    /// The least time that a case can take, and what most of that is.
    fn limit_ms(&self, case: &Case, dispatches: u32) -> (f64, &'static str) {
        let parts = [
            (case.bytes as f64 / self.bytes_per_ms, "bytes"),
            (case.atomics as f64 / self.atomics_per_ms, "atomics"),
            (case.flops as f64 / self.flops_per_ms, "arithmetic"),
        ];
        let work = parts.into_iter().fold((0.0, "bytes"), |most, part| if part.0 > most.0 { part } else { most });
        let latency = f64::from(dispatches) * self.dispatch_ms;
        (work.0 + latency, if latency > work.0 { "dispatches" } else { work.1 })
    }
}

/// GPU time of one recording, in milliseconds.
fn time(gpu: &Gpu, record: &Record) -> Result<f64> {
    Ok(time_and_count(gpu, record)?.0)
}

/// GPU time of one recording in milliseconds, and its dispatches.
fn time_and_count(gpu: &Gpu, record: &Record) -> Result<(f64, u32)> {
    let mut timer = Timer::new(gpu)?.ok_or_else(|| Error::NoAdapter("the device has no time stamps".to_owned()))?;
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
    bound: &'static str,
    /// Median of the baseline, if there is one.
    baseline_ms: Option<f64>,
}

impl Row {
    /// What the columns hold.
    pub const HEAD: &'static str = "case                            size  disp.   median ms      min ms      p90 ms    limit ms  median/limit  of what      M items/s  to baseline";
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "{:<26}{:>10}  {:>5}  {:>10.4}  {:>10.4}  {:>10.4}  {:>10.4}  {:>12.1}  {:<10}{:>11.1}",
            self.name,
            self.size,
            self.dispatches,
            self.median_ms,
            self.min_ms,
            self.p90_ms,
            self.limit_ms,
            self.median_ms / self.limit_ms,
            self.bound,
            self.size as f64 / self.median_ms * 1e-3
        )?;
        self.baseline_ms.map_or(Ok(()), |before| write!(f, "  {:>11.2}", self.median_ms / before))
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
        let (limit_ms, bound) = ceilings.limit_ms(case, dispatches);
        Row {
            name: case.name.clone(),
            size: case.size,
            dispatches,
            median_ms: times[times.len() / 2],
            min_ms: times[0],
            p90_ms: times[times.len() * 9 / 10],
            limit_ms,
            bound,
            baseline_ms: None,
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
