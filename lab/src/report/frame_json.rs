//! `frame.json`: what a frame was computed from, with, and in what time.

use super::picture;
use super::{ConvergedErrors, FacetErrors, SceneErrors, SeenErrors};
use crate::scene::Scene;
use oracle::engine::{self, CpuTime};
use serde::Serialize;
use serde_json::{Map, Value};
use std::io::Write;
use std::path::Path;
use subpixel_shadows::gpu::BufferMemory;
use subpixel_shadows::methods::facet_masks::Settings;
use subpixel_shadows::methods::prepared::Prepared;
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Counts, ListUse, Output};
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{Camera, Ground, Light};
use subpixel_shadows::{Error, Result};

/// The contents of `frame.json`.
#[derive(Clone, Debug, Serialize)]
pub struct FrameReport<'a> {
    /// The program.
    pub program: ProgramReport,
    /// Where it was computed.
    pub adapter: AdapterReport<'a>,
    /// `gpu` or `cpu`.
    pub engine: &'a str,
    /// Name of the built-in scene, or the path of the file.
    pub scene: &'a str,
    /// The method.
    pub method: &'a str,
    /// Width and height.
    pub image_size: [u32; 2],
    /// Texels a side.
    pub map_size: u32,
    /// Offsets in the pixel; the first is the centre.
    pub samples: &'a Samples,
    /// The camera.
    pub camera: &'a Camera,
    /// The light.
    pub light: &'a Light,
    /// The mesh, ground included.
    pub mesh: MeshReport,
    /// The ground that was added.
    pub ground: Option<Ground>,
    /// Every stage, in order, then the parts that were left out.
    pub stages: Vec<StageReport<'a>>,
    /// Sum of the stages' time.
    pub gpu_ms: f64,
    /// From submission to the end.
    pub wall_ms: f64,
    /// Frames whose median time each time is, after one that is not timed; 0 where nothing ran.
    pub timed_frames: u32,
    /// From the mesh to the begin of the first frame that is timed: preparing it, opening the device, compiling, making memory, and one
    /// frame. In no other time.
    pub setup_ms: f64,
    /// Memory of the device.
    pub memory: MemoryReport<'a>,
    /// Counts.
    pub counts: &'a Counts,
    /// How the lists fared.
    pub lists: &'a [ListUse],
    /// Error against both truths.
    pub error: Option<ErrorReport>,
    /// Settings under the names of the program's options: those that the method takes.
    pub settings: &'a Map<String, Value>,
}

/// The program.
#[derive(Clone, Debug, Serialize)]
pub struct ProgramReport {
    /// Its version.
    pub version: &'static str,
}

/// Where a frame was computed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AdapterReport<'a> {
    /// Name the driver gives.
    pub name: &'a str,
    /// Graphics API; `none` for the CPU engine.
    pub backend: &'a str,
}

/// Size and kind of a mesh, as it was prepared: vertices welded.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MeshReport {
    /// Triangles.
    pub triangles: usize,
    /// Vertices of different positions.
    pub vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Whether it bounds solid bodies.
    pub closed: bool,
}

/// How one stage fared.
#[derive(Clone, Debug, Serialize)]
pub struct StageReport<'a> {
    /// The stage.
    pub name: &'a str,
    /// GPU time; 0 where it was left out, where the device has no time stamps, and on the CPU engine.
    pub gpu_ms: f64,
    /// Wall time on the CPU engine, else 0.
    pub cpu_ms: f64,
    /// Why it was left out.
    pub left_out: Option<&'a str>,
}

/// Error against both truths, as one flat object.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ErrorReport {
    /// Against facet truth, where facets could be had.
    #[serde(flatten)]
    pub facet: Option<FacetErrors>,
    /// Against seen truth.
    #[serde(flatten)]
    pub seen: SeenErrors,
    /// Against scene truth.
    #[serde(flatten)]
    pub scene: SceneErrors,
    /// Against 1024 rays a pixel, where that was asked for.
    #[serde(flatten)]
    pub converged: Option<ConvergedErrors>,
}

/// Inputs of a report.
#[derive(Clone, Copy, Debug)]
pub struct Sources<'a> {
    /// Where it was computed.
    pub adapter: AdapterReport<'a>,
    /// `gpu` or `cpu`.
    pub engine: &'a str,
    /// The method.
    pub method: &'a str,
    /// The scene.
    pub scene: &'a Scene,
    /// Its mesh, prepared.
    pub prepared: &'a Prepared,
    /// The settings it was rendered with.
    pub settings: &'a Settings,
    /// The plan.
    pub plan: &'a Plan,
    /// The frame.
    pub output: &'a Output,
    /// The stages that ran on the CPU engine; `None` on a GPU.
    pub cpu_stages: Option<&'a [CpuTime]>,
    /// Frames whose median time each time is; 0 where nothing ran.
    pub timed_frames: u32,
    /// Time before these, milliseconds.
    pub setup_ms: f64,
    /// Buffers that the frames took, the largest first.
    pub memory: &'a [BufferMemory],
    /// Its error, where truth was computed.
    pub error: Option<ErrorReport>,
    /// Settings under the names of the program's options.
    pub asked: &'a Map<String, Value>,
}

/// Buffers of the device that a frame took.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MemoryReport<'a> {
    /// Bytes of all.
    pub bytes: u64,
    /// Each of them, the largest first.
    pub buffers: &'a [BufferMemory],
}

impl<'a> FrameReport<'a> {
    /// The report of a frame.
    pub fn new(s: Sources<'a>) -> Self {
        let time = |name: &str| s.output.stages.iter().find(|t| t.name == name).map_or(0.0, |t| t.gpu_ms);
        let cpu_time = |name: &str| s.cpu_stages?.iter().find(|t| t.name == name).map(|t| t.ms);
        let merged = |name: &str| s.cpu_stages.and_then(|ran| engine::merged(name, ran));
        let stages = s.plan.steps.iter().filter(|step| step.left_out.is_some() || !step.name.contains('.'));
        Self {
            program: ProgramReport { version: env!("CARGO_PKG_VERSION") },
            adapter: s.adapter,
            engine: s.engine,
            scene: &s.scene.name,
            method: s.method,
            image_size: s.settings.size,
            map_size: s.settings.map,
            samples: &s.settings.samples,
            camera: &s.scene.camera,
            light: &s.scene.light,
            mesh: MeshReport {
                triangles: s.prepared.mesh().triangles.len(),
                vertices: s.prepared.mesh().positions.len(),
                edges: s.prepared.edges.len(),
                closed: s.prepared.closed,
            },
            ground: s.scene.ground,
            stages: stages
                .map(|step| StageReport {
                    name: step.name,
                    gpu_ms: time(step.name),
                    cpu_ms: cpu_time(step.name).unwrap_or(0.0),
                    left_out: step.left_out.as_deref().or(merged(step.name)),
                })
                .collect(),
            gpu_ms: s.output.stages.iter().map(|t| t.gpu_ms).sum::<f64>().max(0.0),
            wall_ms: s.output.wall_ms,
            timed_frames: s.timed_frames,
            setup_ms: s.setup_ms,
            memory: MemoryReport { bytes: s.memory.iter().map(|buffer| buffer.bytes).sum(), buffers: s.memory },
            counts: &s.output.counts,
            lists: &s.output.lists,
            error: s.error,
            settings: s.asked,
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`Error::File`] naming `path` if the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(|e| Error::file(path, e.to_string()))?;
        picture::write(path, |out| Ok(writeln!(out, "{text}")?))
    }
}
