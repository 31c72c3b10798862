//! Results of one method with one setting on one scene.

use crate::report::course::Flicker;
use crate::report::{Boundary, SceneErrors};
use serde::{Deserialize, Serialize};
use subpixel_shadows::gpu::{AdapterSummary, StageTime};
use subpixel_shadows::render::{Counts, ListUse};

/// Where rows were measured.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Name the driver gives.
    pub adapter: String,
    /// Driver and its version.
    pub driver: String,
    /// Graphics API.
    pub backend: String,
    /// Whether the adapter is software that runs on the CPU.
    pub software: bool,
    /// Threads of the CPU.
    pub threads: usize,
    /// Version of this program.
    pub version: String,
}

impl Machine {
    /// The machine that `adapter` belongs to.
    pub fn of(adapter: &AdapterSummary) -> Self {
        Self {
            adapter: adapter.name.clone(),
            driver: adapter.driver.clone(),
            backend: adapter.backend.clone(),
            software: adapter.software,
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// One line for people.
    pub fn line(&self) -> String {
        let kind = if self.software { "SOFTWARE: it computes on the CPU" } else { "hardware" };
        format!("{} ({}, {}; {kind}), {} CPU threads", self.adapter, self.backend, self.driver, self.threads)
    }
}

/// Median and quartiles of repeated figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The lower quartile.
    pub low: f64,
    /// The upper quartile.
    pub high: f64,
}

impl Spread {
    /// Spread of some figures; zeros without any. Figures between two ranks are interpolated.
    pub fn of(figures: &[f64]) -> Self {
        let mut sorted = figures.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * sorted.len().saturating_sub(1) as f64;
            let (below, above) = (place.floor() as usize, place.ceil() as usize);
            match (sorted.get(below), sorted.get(above)) {
                (Some(a), Some(b)) => a + (b - a) * place.fract(),
                _ => 0.0,
            }
        };
        Self { median: at(0.5), low: at(0.25), high: at(0.75) }
    }
}

/// The time of one stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageRow {
    /// The stage.
    pub name: String,
    /// Median over the repeats, milliseconds.
    pub gpu_ms: f64,
}

/// How a list fared, see [`ListUse`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListRow {
    /// The list.
    pub name: String,
    /// Elements it needed.
    pub needed: u64,
    /// Elements it could hold in the end.
    pub capacity: u64,
    /// Runs of the first frame until it fitted.
    pub runs: u32,
}

impl From<&ListUse> for ListRow {
    fn from(l: &ListUse) -> Self {
        Self { name: l.name.to_owned(), needed: l.needed, capacity: l.capacity, runs: l.runs }
    }
}

/// One method with one setting on one scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The scene: a built-in name or a path.
    pub scene: String,
    /// Options that the scene was opened with: ground, camera, light.
    #[serde(default)]
    pub view: String,
    /// How often its triangles were split into four.
    pub tessellation: u32,
    /// Triangles, ground included.
    pub triangles: u64,
    /// Image width and height.
    pub size: [u32; 2],
    /// Texels a side of the light-view map.
    pub map: u32,
    /// Name of the method.
    pub method: String,
    /// Settings of the method beyond samples and map, such as `facets=all`.
    pub setting: String,
    /// Samples a pixel.
    pub samples: u32,
    /// Why there are no figures, where there are none.
    pub failed: Option<String>,
    /// Repeats that the figures are of.
    pub repeats: u32,
    /// Sum of the stages' GPU time, milliseconds; zeros without time stamps.
    pub gpu_ms: Spread,
    /// Part of it in the stages before those of the light: projection, and what each pixel or sample sees.
    pub camera_ms: f64,
    /// From submission to the end, milliseconds.
    pub wall_ms: Spread,
    /// Time over that of the reference row in the same round, median.
    pub ratio: f64,
    /// Each stage, in order.
    pub stages: Vec<StageRow>,
    /// Bytes of GPU memory that making the row took, mesh included; `None` where the driver does not say.
    pub memory: Option<u64>,
    /// Counts.
    pub counts: Counts,
    /// The facets where a shadow ends; `None` without any, and of methods without facets.
    pub boundary: Option<Boundary>,
    /// The lists.
    pub lists: Vec<ListRow>,
    /// Views of the light; 0 of rows of versions that did not tell.
    #[serde(default)]
    pub views: u32,
    /// Share of pixels that are neither lit nor dark, by half a step of 8 bits or more.
    #[serde(default)]
    pub partly_lit: f64,
    /// Flicker while the camera moves, where it was made to.
    #[serde(default)]
    pub flicker: Option<Flicker>,
    /// Against rays through the same samples.
    pub matched: SceneErrors,
    /// Against 1024 rays a pixel.
    pub converged: SceneErrors,
}

/// Stages that find what the camera sees.
const CAMERA_STAGES: [&str; 6] =
    ["cluster_culling", "triangle_setup", "camera_visibility", "pixel_triangles", "pixel_coverage", "sample_surfaces"];

impl Row {
    /// Key that tells rows apart.
    pub fn key(&self) -> String {
        let [w, h] = self.size;
        format!(
            "{}@{} {} {w}x{h} map {} {} [{}] {} samples",
            self.scene, self.tessellation, self.view, self.map, self.method, self.setting, self.samples
        )
    }

    /// Method and setting, such as `facet-masks facets=all`.
    pub fn series(&self) -> String {
        format!("{} {}", self.method, self.setting).trim_end().to_owned()
    }

    /// The time that rows are ranked by: GPU time, or wall time where there is none.
    pub fn time(&self) -> f64 {
        if self.gpu_ms.median > 0.0 { self.gpu_ms.median } else { self.wall_ms.median }
    }

    /// Takes in the frames of all rounds: stages, wall time, and time over the reference's.
    pub fn take_times(&mut self, frames: &[Timing], reference: &[Timing]) {
        let of = |f: fn(&Timing) -> f64| Spread::of(&frames.iter().map(f).collect::<Vec<_>>());
        self.repeats = frames.len() as u32;
        self.gpu_ms = of(Timing::gpu_ms);
        self.wall_ms = of(|t| t.wall_ms);
        let ratios: Vec<f64> = frames
            .iter()
            .zip(reference)
            .map(|(ours, theirs)| ours.ranked() / theirs.ranked())
            .filter(|r| r.is_finite())
            .collect();
        self.ratio = Spread::of(&ratios).median;
        let names: Vec<&'static str> = frames.first().map_or(Vec::new(), |f| f.stages.iter().map(|s| s.name).collect());
        let median = |name: &str| {
            let all: Vec<f64> =
                frames.iter().filter_map(|f| f.stages.iter().find(|s| s.name == name)).map(|s| s.gpu_ms).collect();
            Spread::of(&all).median
        };
        self.stages = names.iter().map(|n| StageRow { name: (*n).to_owned(), gpu_ms: median(n) }).collect();
        self.camera_ms =
            self.stages.iter().filter(|s| CAMERA_STAGES.contains(&s.name.as_str())).map(|s| s.gpu_ms).sum();
    }
}

/// The times of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timing {
    /// Each stage.
    pub stages: Vec<StageTime>,
    /// From submission to the end.
    pub wall_ms: f64,
}

impl Timing {
    fn gpu_ms(&self) -> f64 {
        self.stages.iter().map(|s| s.gpu_ms).sum()
    }

    fn ranked(&self) -> f64 {
        let gpu = self.gpu_ms();
        if gpu > 0.0 { gpu } else { self.wall_ms }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_are_medians_and_quartiles() {
        assert_eq!(Spread::of(&[]), Spread::default());
        assert_eq!(Spread::of(&[3.0]), Spread { median: 3.0, low: 3.0, high: 3.0 });
        assert_eq!(Spread::of(&[5.0, 1.0, 2.0, 4.0, 3.0]), Spread { median: 3.0, low: 2.0, high: 4.0 });
        assert_eq!(Spread::of(&[1.0, 2.0]).median, 1.5);
    }

    #[test]
    fn rows_of_another_view_are_others() {
        let row = Row { scene: "city".to_owned(), ..Row::default() };
        let lit = Row { view: "--light directional=0,1,0".to_owned(), ..row.clone() };
        assert_ne!(row.key(), lit.key());
        // Rows of earlier versions tell none.
        let mut old = serde_json::to_value(&row).unwrap();
        old.as_object_mut().unwrap().remove("view");
        assert_eq!(serde_json::from_value::<Row>(old).unwrap(), row);
    }

    #[test]
    fn ratios_are_taken_within_a_round() {
        let frame = |ms| Timing { stages: vec![StageTime { name: "camera_visibility", gpu_ms: ms }], wall_ms: 9.0 };
        let mut row = Row::default();
        row.take_times(&[frame(2.0), frame(20.0), frame(4.0)], &[frame(1.0), frame(10.0), frame(1.0)]);
        assert_eq!((row.repeats, row.gpu_ms.median, row.ratio, row.camera_ms), (3, 4.0, 2.0, 4.0));
        let wall = |ms| Timing { stages: Vec::new(), wall_ms: ms };
        row.take_times(&[wall(6.0)], &[wall(2.0)]);
        assert_eq!((row.gpu_ms.median, row.time(), row.ratio), (0.0, 6.0, 3.0));
    }
}
