//! Families of GPUs, each compiled for in a process of its own.

use crate::radv::NullDevice;
use crate::spirv::Kernel;
use crate::{Measured, Pipeline};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use subpixel_shadows::gpu::{Profile, kernels};

/// The families, as RADV names them: RDNA 2, which a desktop card has, and GCN 5, the oldest that many have.
pub const FAMILIES: [&str; 2] = ["navi21", "vega10"];

/// The pipelines that a process compiles.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Job {
    /// WGSL by kernel.
    pub texts: BTreeMap<String, String>,
    /// The pipelines.
    pub pipelines: Vec<Pipeline>,
}

impl Job {
    /// Pipelines of the library's kernels, as they are for a GPU.
    pub fn of(pipelines: Vec<Pipeline>) -> Self {
        let texts = kernels::ALL.iter().map(|(stem, text, _)| {
            let text = text.text();
            let text = Profile::Gpu.text(&text);
            ((*stem).to_owned(), text.into_owned())
        });
        Self { texts: texts.collect(), pipelines }
    }
}

/// The figures that a process found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The device.
    pub device: String,
    /// The driver and its version.
    pub driver: String,
    /// Pipelines whose SPIR-V differs, in the order of the job.
    pub rows: Vec<Measured>,
}

/// Compiles a job for each of [`FAMILIES`], at once. `program` is this package's.
///
/// # Errors
/// Where there is no driver, what to install; what the driver says.
pub fn measure(program: &Path, job: &Job) -> Result<Vec<Report>, String> {
    let job = serde_json::to_string(job).map_err(|e| e.to_string())?;
    let started: Vec<_> = FAMILIES.iter().map(|family| start(program, family, &job)).collect();
    started.into_iter().map(|child| finish(child?)).collect()
}

fn start(program: &Path, family: &str, job: &str) -> Result<Child, String> {
    let mut child = Command::new(program)
        .arg("compile")
        .env("RADV_FORCE_FAMILY", family)
        // A pipeline from the cache has no figures.
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("{}: {e}", program.display()))?;
    // It reads all before it writes. If it ended before that, its message says more than this.
    let _ = child.stdin.take().map(|mut input| input.write_all(job.as_bytes()));
    Ok(child)
}

fn finish(child: Child) -> Result<Report, String> {
    let done = child.wait_with_output().map_err(|e| e.to_string())?;
    if !done.status.success() {
        let told = String::from_utf8_lossy(&done.stderr);
        let last = told.trim().lines().last().unwrap_or_default();
        return Err(if last.is_empty() { done.status.to_string() } else { last.to_owned() });
    }
    serde_json::from_slice(&done.stdout).map_err(|e| e.to_string())
}

/// The other side of [`measure`]: a job from standard input, for the family of this process, its report to standard output.
///
/// # Errors
/// As [`measure`].
pub fn compile() -> Result<(), String> {
    let mut job = String::new();
    std::io::stdin().read_to_string(&mut job).map_err(|e| e.to_string())?;
    let job: Job = serde_json::from_str(&job).map_err(|e| e.to_string())?;
    let device = NullDevice::open()?;
    let mut kernels = HashMap::new();
    for (stem, text) in &job.texts {
        kernels.insert(stem.as_str(), Kernel::read(text).map_err(|e| format!("{stem}: {e}"))?);
    }
    let mut known: HashMap<Vec<u32>, usize> = HashMap::new();
    let mut rows: Vec<Measured> = Vec::new();
    for pipeline in job.pipelines {
        let kernel = kernels.get(pipeline.0.as_str()).ok_or_else(|| format!("{}: no such kernel", pipeline.name()))?;
        let spirv = kernel.spirv(&pipeline)?;
        if let Some(row) = known.get(&spirv) {
            rows[*row].alike += 1;
            continue;
        }
        let figures =
            device.compile(&spirv, &pipeline.1, &kernel.bindings()).map_err(|e| format!("{}: {e}", pipeline.name()))?;
        known.insert(spirv, rows.len());
        rows.push(Measured { pipeline, alike: 1, figures });
    }
    let report = Report { device: device.name.clone(), driver: format!("RADV, {}", device.driver), rows };
    println!("{}", serde_json::to_string(&report).map_err(|e| e.to_string())?);
    Ok(())
}
