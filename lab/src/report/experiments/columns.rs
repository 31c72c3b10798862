//! Columns, tables and plots of experiments.

use super::Table;
use crate::report::comparison::Row;
use crate::report::comparison::figures::scenes;
use crate::report::comparison::plots::{Axis, Plot, Series};
use crate::report::{or_dash, percent_or_dash};

/// A column: its name, and what a row has there, beside the first row of its scene, samples and map.
pub type Column = (&'static str, fn(&Row, &Row) -> String);

/// The scene.
pub const SCENE: Column = ("scene", |r, _| r.scene.clone());
/// Triangles of the scene.
pub const TRIANGLES: Column = ("triangles", |r, _| r.triangles.to_string());
/// Samples a pixel.
pub const SAMPLES: Column = ("samples", |r, _| r.samples.to_string());
/// Texels a side of the map.
pub const MAP: Column = ("map", |r, _| r.map.to_string());
/// Method and options.
pub const METHOD: Column = ("method", |r, _| r.series());
/// Milliseconds of all stages.
pub const TIME: Column = ("ms", |r, _| format!("{:.1}", r.time()));
/// Time over that of the first row, each over the reference of its round.
pub const TIMES: Column = ("times", |r, first| or_dash(times(r, first), 2));
/// Root of the mean squared difference over the image.
pub const RMSE: Column = ("RMSE", |r, _| format!("{:.4}", r.matched.scene_rmse));
/// The same in the silhouette band.
pub const BAND: Column = ("band RMSE", |r, _| or_dash(r.matched.scene_band_rmse, 4));
/// The same against 1024 rays a pixel.
pub const CONVERGED: Column = ("band RMSE, 1024 rays", |r, _| or_dash(r.converged.scene_band_rmse, 4));
/// Share of pixels within one sample.
pub const MATCH: Column = ("within 1/N", |r, _| percent_or_dash(r.matched.scene_pixel_match));
/// The same where all samples of a pixel see one plane.
pub const ONE_PLANE: Column = ("of one plane", |r, _| percent_or_dash(r.matched.scene_one_plane_match));
/// Pixels with light where there is none.
pub const LEAKS: Column = ("leaks", |r, _| r.matched.scene_leak_pixels.to_string());
/// Pixels that shadow themselves.
pub const ACNE: Column = ("acne", |r, _| r.matched.scene_acne_pixels.to_string());
/// Wrong pixels, with one sample a pixel.
pub const WRONG: Column = ("wrong pixels", |r, _| format!("{:.0}", wrong(r)));
/// Wrong pixels of the first row over those of this.
pub const FEWER: Column = ("times fewer", |r, first| or_dash((wrong(r) > 0.5).then(|| wrong(first) / wrong(r)), 1));
/// Flicker while the camera moves, in hundredths of a pixel's light.
pub const FLICKER: Column = ("flicker", |r, _| or_dash(r.flicker.map(|f| 100.0 * f.mean), 3));
/// Greatest change of the error from a frame to the next.
pub const JUMP: Column = ("jump", |r, _| or_dash(r.flicker.map(|f| f.jump), 4));
/// Share of pixels that are partly lit.
pub const PARTLY: Column = ("partly lit", |r, _| percent_or_dash(Some(r.partly_lit)));
/// MiB that the row took.
pub const MEMORY: Column =
    ("MiB", |r, _| r.memory.map_or("–".to_owned(), |m| format!("{:.0}", m as f64 / f64::from(1 << 20))));

/// Pixels that are wrong with one sample a pixel: each adds 1 to the sum of squares.
pub fn wrong(row: &Row) -> f64 {
    row.matched.scene_rmse.powi(2) * f64::from(row.size[0]) * f64::from(row.size[1])
}

/// Time over that of another row, each over the reference of its own round.
pub fn times(row: &Row, first: &Row) -> Option<f64> {
    (first.ratio > 0.0 && row.ratio > 0.0).then(|| row.ratio / first.ratio)
}

/// The first row of the scene, samples and map of a row.
pub fn first_like<'a>(rows: &[&'a Row], row: &Row) -> Option<&'a Row> {
    let like = |r: &&&Row| {
        (&r.scene, r.samples, r.map, r.tessellation) == (&row.scene, row.samples, row.map, row.tessellation)
    };
    rows.iter().find(like).copied()
}

/// A table of all rows.
pub fn table(title: &str, rows: &[&Row], columns: &[Column]) -> Table {
    let line = |r: &&Row| {
        let first = first_like(rows, r).unwrap_or(r);
        columns.iter().map(|(_, cell)| cell(r, first)).collect()
    };
    let head = columns.iter().map(|(name, _)| *name).collect();
    Table { title: title.to_owned(), head, lines: rows.iter().map(line).collect() }
}

/// Lines of a table of the paper's.
pub fn of_paper(title: &str, head: &[&'static str], lines: &[&[&str]]) -> Table {
    let lines = lines.iter().map(|line| line.iter().map(|cell| (*cell).to_owned()).collect()).collect();
    Table { title: title.to_owned(), head: head.to_vec(), lines }
}

/// One line a method and scene, over the samples, maps or whatever `x` says.
pub fn plot(title: &str, x: (Axis, fn(&Row) -> f64), y: (Axis, fn(&Row) -> Option<f64>), rows: &[&Row]) -> Plot {
    let many = scenes(rows).len() > 1;
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let name = if many { format!("{}, {}", row.series(), row.scene) } else { row.series() };
        let Some(value) = (y.1)(row) else { continue };
        let point = ((x.1)(row), value, String::new());
        match series.iter_mut().find(|s| s.name == name) {
            Some(known) => known.points.push(point),
            None => series.push(Series { name, points: vec![point], joined: true, guide: false }),
        }
    }
    series.iter_mut().for_each(|s| s.points.sort_by(|a, b| a.0.total_cmp(&b.0)));
    Plot { title: title.to_owned(), x: x.0, y: y.0, series }
}
