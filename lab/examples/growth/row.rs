//! A frame that was measured.

use serde::{Deserialize, Serialize};
use subpixel_shadows::render::Counts;

/// Times, memory and counters of a frame.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Row {
    /// The axis.
    pub axis: String,
    /// Value along it.
    pub x: f64,
    /// The value in words.
    pub label: String,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Preparing the mesh, ms.
    pub prepare_ms: f64,
    /// From there to the end of the first frame, ms: upload, pipelines that are new, memory, growing lists.
    pub first_ms: f64,
    /// A frame, from submission to the end, ms.
    pub frame_ms: f64,
    /// Finding surfaces: the stages of the camera's view, ms.
    pub surfaces_ms: f64,
    /// Light maps: the stages of the light's view, ms.
    pub light_ms: f64,
    /// Classification, pairs and masks, ms.
    pub shadow_ms: f64,
    /// Bytes of GPU memory in use; 0 where the device does not tell.
    pub memory: u64,
    /// Silhouette edges.
    pub silhouettes: u64,
    /// Marked texels.
    pub marked: u64,
    /// Facets.
    pub facets: u64,
    /// Facets to be evaluated.
    pub undecided: u64,
    /// Pairs of facets and texels, and of casters and texels.
    pub pairs: u64,
    /// Casters tested against facets.
    pub tests: u64,
    /// Casters evaluated against facets.
    pub evaluations: u64,
}

/// A figure of a row.
pub type Figure = fn(&Row) -> f64;

/// Columns of tables, by name.
pub const COLUMNS: [(&str, Figure); 14] = [
    ("frame ms", |r| r.frame_ms),
    ("surfaces ms", |r| r.surfaces_ms),
    ("light ms", |r| r.light_ms),
    ("shadows ms", |r| r.shadow_ms),
    ("prepare ms", |r| r.prepare_ms),
    ("first ms", |r| r.first_ms),
    ("MiB", |r| r.memory as f64 / f64::from(1 << 20)),
    ("triangles", |r| r.triangles as f64),
    ("silhouettes", |r| r.silhouettes as f64),
    ("marked", |r| r.marked as f64),
    ("facets", |r| r.facets as f64),
    ("pairs", |r| r.pairs as f64),
    ("tests", |r| r.tests as f64),
    ("evaluations", |r| r.evaluations as f64),
];

impl Row {
    /// A frame's counters, at `x` of an axis; without times and memory.
    pub fn counted(axis: &str, x: f64, label: &str, triangles: usize, c: &Counts) -> Self {
        Self {
            axis: axis.to_owned(),
            x,
            label: label.to_owned(),
            triangles: triangles as u64,
            silhouettes: c.silhouette_edges,
            marked: c.silhouette_texels,
            facets: c.facets,
            undecided: c.silhouette_pixels,
            pairs: c.pixel_texel_pairs + c.triangle_texel_pairs,
            tests: c.candidate_tests,
            evaluations: c.visibility_evaluations,
            ..Self::default()
        }
    }

    /// Key of the row among others.
    pub fn key(&self) -> String {
        format!("{} {}", self.axis, self.label)
    }
}

/// Slope of a line through the logarithms of points, least squares; `None` of fewer than two with both above 0.
pub fn slope(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> =
        points.filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.log10(), y.log10())).collect();
    let n = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (above, below) = logs.iter().fold((0.0, 0.0), |(a, b), p| (a + (p.0 - x) * (p.1 - y), b + (p.0 - x).powi(2)));
    (logs.len() > 1 && below > 0.0).then(|| above / below)
}
