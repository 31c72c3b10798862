//! Options of the program.

use super::rows::RowPart;
use clap::{Args, Parser, Subcommand};
use lab::options::{RenderOptions, method_name, size};
use lab::report::comparison::Scope;
use lab::report::experiments::{Experiment, experiment, experiments};
use lab::scene::BUILTIN_NAMES;
use std::path::PathBuf;
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::methods::facet_masks::Settings;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result};

/// Sub-pixel antialiased hard shadows, computed entirely in wgpu compute kernels.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Without a command: `render` of the default scene.
    #[command(flatten)]
    pub options: RenderOptions,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene; write pictures and frame.json
    Render {
        /// Built-in scene, or a .glb, .gltf, .obj, .ply or .toml file [default: windmill]
        scene: Option<String>,
        #[command(flatten)]
        options: RenderOptions,
    },
    /// Print the plan: each stage, needed or left out, and why
    Explain {
        /// Built-in scene, or a .glb, .gltf, .obj, .ply or .toml file [default: windmill]
        scene: Option<String>,
        #[command(flatten)]
        options: RenderOptions,
    },
    /// Error against run time: scenes x methods x settings, as tables and plots; or figures of the papers
    #[command(args_conflicts_with_subcommands = true)]
    Report {
        #[command(subcommand)]
        command: Option<ReportCommand>,
        #[command(flatten)]
        options: ReportOptions,
    },
    /// Stiff and extreme cases: error and time of each in each variant
    Stability {
        #[command(flatten)]
        options: StabilityOptions,
    },
    /// Random worlds, each against the CPU engine and both truths
    Fuzz {
        #[command(flatten)]
        options: FuzzOptions,
    },
    /// List the methods: name, paper, section, and the options that each takes
    Methods {
        /// As JSON: a list of objects; `options` holds the arguments of `render` that make it
        #[arg(long)]
        json: bool,
    },
    /// Write the joined WGSL of every kernel, one file each
    Kernels {
        /// Folder for the files
        #[arg(long, default_value = "out/kernels", value_name = "DIR")]
        out: PathBuf,
    },
    /// List what wgpu finds here: adapters, features, limits, and the path each would take
    Adapters {
        /// Only say by the exit status whether an adapter can be used: 0, or 3 if none
        #[arg(long)]
        check: bool,
    },
}

/// The other things that `report` does.
#[derive(Debug, Subcommand)]
pub enum ReportCommand {
    /// Measure experiments of the papers again: a page each, with the paper's figures beside ours
    Figure {
        #[command(flatten)]
        options: FigureOptions,
    },
    /// Everything that is measured: the whole report, the stability cases and all figures; goes on where it stopped
    Everything {
        #[command(flatten)]
        options: EverythingOptions,
    },
    /// Put the parts of a report or of figures together, and write their pages
    Merge {
        #[command(flatten)]
        options: MergeOptions,
    },
}

/// The options of every way to measure rows.
#[derive(Clone, Debug, Args)]
pub struct RowOptions {
    /// Measure a part of the rows, such as 3/8, and write no page: `report merge` makes them of all parts
    #[arg(long, value_name = "K/N")]
    pub part: Option<RowPart>,
    /// Pick an adapter whose name contains TEXT
    #[arg(long, value_name = "TEXT")]
    pub adapter: Option<String>,
    /// No progress, no notes
    #[arg(long)]
    pub quiet: bool,
}

/// The options of `report everything`.
#[derive(Debug, Args)]
pub struct EverythingOptions {
    /// Fewer rows of smaller pictures
    #[arg(long)]
    pub quick: bool,
    #[command(flatten)]
    pub rows: RowOptions,
    /// Folder for the files that are written: `comparison`, `stability`, and `figures` in it
    #[arg(long, default_value = "out/everything", value_name = "DIR")]
    pub out: PathBuf,
}

/// The options of `report merge`.
#[derive(Debug, Args)]
pub struct MergeOptions {
    /// Folders that parts were measured into
    #[arg(required = true, value_name = "DIR")]
    pub parts: Vec<PathBuf>,
    /// Folder for the files that are written
    #[arg(long, default_value = "out/merged", value_name = "DIR")]
    pub out: PathBuf,
    /// The scenes had a ground plane added
    #[arg(long)]
    pub ground: bool,
}

/// The options of `report figure`.
#[derive(Debug, Args)]
pub struct FigureOptions {
    /// Figures, by name, or `all` [default: list them]
    pub names: Vec<String>,
    /// Image size, pixels
    #[arg(long, default_value = "400x300", value_name = "WxH", value_parser = size)]
    pub size: [u32; 2],
    /// Frames of each row that count
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: u32,
    /// Seconds of frames after which a row has enough, fewer than N but one at the least
    #[arg(long, default_value_t = 10, value_name = "S", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub row_seconds: u32,
    /// Begin anew, without the rows that an earlier run left in the folder
    #[arg(long)]
    pub fresh: bool,
    #[command(flatten)]
    pub rows: RowOptions,
    /// Folder for the files that are written, one in it for each figure
    #[arg(long, default_value = "out/figures", value_name = "DIR")]
    pub out: PathBuf,
}

impl FigureOptions {
    /// The experiments that are asked for, each once; none to have them listed.
    pub fn experiments(&self) -> Result<Vec<&'static Experiment>> {
        let mut found: Vec<&Experiment> = Vec::new();
        for name in &self.names {
            let these = match name.as_str() {
                "all" => experiments().collect(),
                name => vec![experiment(name).map_err(Error::Config)?],
            };
            found.extend(
                these.into_iter().filter(|e| found.iter().all(|known| known.name != e.name)).collect::<Vec<_>>(),
            );
        }
        Ok(found)
    }
}

/// The options of `report`.
#[derive(Debug, Args)]
pub struct ReportOptions {
    /// Built-in scenes or files [default: every built-in scene]
    pub scenes: Vec<String>,
    /// Fewer rows of smaller pictures
    #[arg(long)]
    pub quick: bool,
    /// Methods, by name [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAMES", value_parser = method_name)]
    pub methods: Vec<MethodName>,
    /// Samples per pixel [default: 1,8,16,32,64,128; quick: 1,32]
    #[arg(long, value_delimiter = ',', value_name = "LIST")]
    pub samples: Vec<u32>,
    /// Light-view map sizes; the first is measured at every number of samples [default: 512,256,1024,2048; quick: 256]
    #[arg(long, value_delimiter = ',', value_name = "LIST")]
    pub maps: Vec<u32>,
    /// Image size, pixels [default: 800x600; quick: 240x180]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Frames of each row that count [default: 15; quick: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: Option<u32>,
    /// Seconds of frames after which a row has enough, fewer than N but one at the least [default: 20; quick: 1]
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub row_seconds: Option<u32>,
    /// Also split each triangle of the first scene into 4, 16, ... as often as this [default: 3; quick: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=6))]
    pub tessellate: Option<u32>,
    /// Add a ground plane under each scene
    #[arg(long)]
    pub ground: bool,
    /// Begin anew, without the rows that an earlier run left in the folder
    #[arg(long)]
    pub fresh: bool,
    #[command(flatten)]
    pub rows: RowOptions,
    /// Folder for the files that are written
    #[arg(long, default_value = "out/report", value_name = "DIR")]
    pub out: PathBuf,
}

/// The options of `stability`.
#[derive(Debug, Args)]
pub struct StabilityOptions {
    /// Cases, by name [default: all]
    pub cases: Vec<String>,
    /// Methods, by name [default: all]
    #[arg(long, value_delimiter = ',', value_name = "NAMES", value_parser = method_name)]
    pub methods: Vec<MethodName>,
    /// Samples per pixel
    #[arg(long, default_value_t = 32, value_name = "N")]
    pub samples: u32,
    /// Light-view map size, texels a side, where a case does not ask for another
    #[arg(long, default_value_t = 128, value_name = "N")]
    pub map: u32,
    /// Image size, pixels
    #[arg(long, default_value = "160x120", value_name = "WxH", value_parser = size)]
    pub size: [u32; 2],
    /// Pick an adapter whose name contains TEXT
    #[arg(long, value_name = "TEXT")]
    pub adapter: Option<String>,
    /// Folder for the files that are written
    #[arg(long, default_value = "out/stability", value_name = "DIR")]
    pub out: PathBuf,
    /// No progress, no notes
    #[arg(long)]
    pub quiet: bool,
}

/// The options of `fuzz`.
#[derive(Debug, Args)]
pub struct FuzzOptions {
    /// Cases to run [default: 1000; with --minutes as many as there is time for]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub cases: Option<u64>,
    /// Seed of the random cases: the same seed, the same cases
    #[arg(long, default_value_t = 1, value_name = "S")]
    pub seed: u64,
    /// Minutes after which no further case is begun
    #[arg(long, value_name = "M", value_parser = minutes)]
    pub minutes: Option<f64>,
    /// The number of the first case
    #[arg(long, default_value_t = 0, value_name = "NUMBER")]
    pub first: u64,
    /// Seconds that a failing case may be shrunk for
    #[arg(long, default_value_t = 60, value_name = "S", value_parser = clap::value_parser!(u64).range(0..=3600))]
    pub shrink: u64,
    /// Pick an adapter whose name contains TEXT
    #[arg(long, value_name = "TEXT")]
    pub adapter: Option<String>,
    /// Folder for cases that fail
    #[arg(long, default_value = "out/fuzz", value_name = "DIR")]
    pub out: PathBuf,
    /// Also write the summary as a page of Markdown
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
    /// No progress, no notes
    #[arg(long)]
    pub quiet: bool,
}

fn minutes(text: &str) -> std::result::Result<f64, String> {
    let value: f64 = text.parse().map_err(|e| format!("{e}"))?;
    if value > 0.0 && value <= 10_000.0 { Ok(value) } else { Err("more than 0, up to 10000, are possible".to_owned()) }
}

/// All methods where none is named.
pub fn or_all(methods: &[MethodName]) -> Vec<MethodName> {
    if methods.is_empty() { MethodName::ALL.to_vec() } else { methods.to_vec() }
}

impl StabilityOptions {
    /// Settings of every frame.
    pub fn settings(&self) -> Result<Settings> {
        let samples = Samples::new(Pattern::LowDiscrepancy, self.samples)?;
        let settings = Settings { cull_back: true, ..Settings::new(self.size, self.map, samples) };
        settings.check()?;
        Ok(settings)
    }
}

impl ReportOptions {
    /// The scenes.
    pub fn scenes(&self) -> Vec<String> {
        if self.scenes.is_empty() { BUILTIN_NAMES.map(String::from).to_vec() } else { self.scenes.clone() }
    }

    /// Frames of each row.
    pub fn repeats(&self) -> u32 {
        self.repeats.unwrap_or(if self.quick { 2 } else { 15 })
    }

    /// Milliseconds after which a row has frames enough.
    pub fn row_ms(&self) -> f64 {
        1e3 * f64::from(self.row_seconds.unwrap_or(if self.quick { 1 } else { 20 }))
    }

    /// How often triangles of the first scene are split.
    pub fn tessellation(&self) -> u32 {
        self.tessellate.unwrap_or(if self.quick { 0 } else { 3 })
    }

    /// Variants to compare.
    pub fn scope(&self) -> Result<Scope> {
        let (samples, maps, size): (&[u32], &[u32], _) = match self.quick {
            true => (&[1, 32], &[256], [240, 180]),
            false => (&[1, 8, 16, 32, 64, 128], &[512, 256, 1024, 2048], [800, 600]),
        };
        let or = |given: &[u32], default: &[u32]| if given.is_empty() { default.to_vec() } else { given.to_vec() };
        let scope = Scope {
            methods: or_all(&self.methods),
            samples: or(&self.samples, samples),
            maps: or(&self.maps, maps),
            size: self.size.unwrap_or(size),
            all_settings: !self.quick,
        };
        scope.reference()?;
        Ok(scope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(arguments: &[&str]) -> RenderOptions {
        Cli::try_parse_from([&["subpixel-shadows"], arguments].concat()).unwrap().options
    }

    /// The plan leaves out what turns away from the light where that changes nothing; apart from it, library and program agree.
    #[test]
    fn the_library_begins_with_the_programs_settings() {
        let samples = Samples::new(Pattern::LowDiscrepancy, 32).unwrap();
        let library = Settings { cull_back: true, ..Settings::new([800, 600], 512, samples) };
        assert_eq!(of(&[]).settings().unwrap(), library);
        assert_ne!(of(&["--facets", "one"]).settings().unwrap(), library);
    }
}
