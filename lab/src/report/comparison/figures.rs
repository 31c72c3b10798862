//! The plots of a report, made from its rows.

use super::measure::SceneCase;
use super::plots::{Axis, Plot, Series};
use super::row::Row;
use std::collections::{BTreeMap, BTreeSet};

/// Name of the file and the plot.
pub type Figure = (String, Plot);

/// Rows with figures, without those that only say what truth leaves.
pub fn measured(rows: &[Row]) -> Vec<&Row> {
    rows.iter().filter(|r| r.failed.is_none() && r.method != SceneCase::TRUTH).collect()
}

/// The rows that no other row beats in both time and error, from the fastest on, those without an error left out. Error: RMSE of
/// the silhouette band against converged truth.
pub fn pareto_front<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let mut sorted: Vec<(&Row, f64)> = rows.iter().filter_map(|r| Some((*r, error(r)?))).collect();
    sorted.sort_by(|(a, a_error), (b, b_error)| a.time().total_cmp(&b.time()).then(a_error.total_cmp(b_error)));
    let mut front: Vec<(&Row, f64)> = Vec::new();
    for (row, error) in sorted {
        if front.last().is_none_or(|(_, last)| error < *last) {
            front.push((row, error));
        }
    }
    front.into_iter().map(|(row, _)| row).collect()
}

/// The error that rows are ranked by; `None` where the silhouette band is empty.
pub fn error(row: &Row) -> Option<f64> {
    row.converged.scene_band_rmse
}

/// Scenes in the order in which they come.
pub fn scenes(rows: &[&Row]) -> Vec<String> {
    let mut seen = BTreeSet::new();
    rows.iter().map(|r| r.scene.clone()).filter(|s| seen.insert(s.clone())).collect()
}

/// A scene's name as part of a file name.
pub fn slug(name: &str) -> String {
    let stem = std::path::Path::new(name).file_stem().map_or(name.into(), |s| s.to_string_lossy());
    stem.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' }).collect()
}

/// All plots of these rows.
pub fn figures(rows: &[Row]) -> Vec<Figure> {
    let all = measured(rows);
    let plain: Vec<&Row> = all.iter().copied().filter(|r| r.tessellation == 0).collect();
    let mut found = Vec::new();
    for scene in scenes(&plain) {
        let of_scene: Vec<&Row> = plain.iter().copied().filter(|r| r.scene == scene).collect();
        found.push((format!("error-time-{}", slug(&scene)), error_time(&scene, &of_scene)));
    }
    found.push(("error-time".to_owned(), error_time_overall(&plain)));
    found.push(("time-samples".to_owned(), time_samples(&plain)));
    found.push(("time-triangles".to_owned(), time_triangles(&all)));
    found.push(("time-silhouettes".to_owned(), time_silhouettes(&plain)));
    found.push(("map-size".to_owned(), map_size(&plain)));
    found
}

/// Rows by method and setting.
fn by_series<'a>(rows: &[&'a Row]) -> BTreeMap<String, Vec<&'a Row>> {
    let mut found: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        found.entry(row.series()).or_default().push(row);
    }
    found
}

fn points(name: String, mut points: Vec<(f64, f64, String)>) -> Series {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Series { name, points, joined: true, guide: false }
}

const ERROR: &str = "RMSE of the silhouette band, against 1024 rays a pixel";
const TIME: &str = "time of all stages, ms";

/// Error against time on one scene, and the front. Points of the first map are a series over samples, those of other maps, which
/// have one number of samples, a series over maps, to which the first map belongs if it has only one, too.
fn error_time(scene: &str, rows: &[&Row]) -> Plot {
    let first_map = rows.first().map_or(0, |r| r.map);
    let mut series: Vec<Series> = Vec::new();
    for (name, rows) in by_series(rows) {
        let (first, others): (Vec<&Row>, Vec<&Row>) = rows.into_iter().partition(|r| r.map == first_map);
        let point = |r: &&Row, text: String| Some((r.time(), error(r)?, text));
        let by_map = |r: &&Row| point(r, format!("{}²", r.map));
        if first.len() == 1 && !others.is_empty() {
            series.push(points(name, first.iter().chain(&others).filter_map(by_map).collect()));
            continue;
        }
        let by_samples = |r: &&Row| point(r, r.samples.to_string());
        if !first.is_empty() {
            series.push(points(name.clone(), first.iter().filter_map(by_samples).collect()));
        }
        if !others.is_empty() {
            series.push(points(format!("{name}, other maps"), others.iter().filter_map(by_map).collect()));
        }
    }
    let front = pareto_front(rows);
    let steps = front.iter().filter_map(|r| Some((r.time(), error(r)?, String::new()))).collect();
    series.insert(0, Series { name: "Pareto front".to_owned(), points: steps, joined: true, guide: true });
    Plot { title: format!("{scene}: error against time"), x: Axis::log(TIME), y: Axis::log(ERROR), series }
}

/// Geometric mean; `None` of nothing or of what is not positive.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    if values.is_empty() || values.iter().any(|v| *v <= 0.0) {
        return None;
    }
    Some((values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64).exp())
}

/// Error against time over all scenes, geometric means of the rows that every scene has.
fn error_time_overall(rows: &[&Row]) -> Plot {
    let count = scenes(rows).len();
    let mut groups: BTreeMap<(String, u32, u32), Vec<&Row>> = BTreeMap::new();
    for row in rows {
        groups.entry((row.series(), row.map, row.samples)).or_default().push(row);
    }
    let first_map = rows.first().map_or(0, |r| r.map);
    let mut series: BTreeMap<String, Vec<(f64, f64, String)>> = BTreeMap::new();
    for ((name, map, samples), rows) in groups.into_iter().filter(|(_, rows)| rows.len() == count) {
        let time = geometric_mean(&rows.iter().map(|r| r.time()).collect::<Vec<_>>());
        let errors = rows.iter().map(|r| error(r)).collect::<Option<Vec<_>>>().and_then(|all| geometric_mean(&all));
        if let (Some(time), Some(errors), true) = (time, errors, map == first_map) {
            series.entry(name).or_default().push((time, errors, samples.to_string()));
        }
    }
    Plot {
        title: format!("{count} scenes: error against time, geometric means"),
        x: Axis::log(TIME),
        y: Axis::log(ERROR),
        series: series.into_iter().map(|(name, p)| points(name, p)).collect(),
    }
}

/// Time against samples, relative to the fewest (Pan 2009, figure 10): geometric means over the scenes.
fn time_samples(rows: &[&Row]) -> Plot {
    let mut series = Vec::new();
    for (name, rows) in by_series(rows) {
        let mut at: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        let first_map = rows.first().map_or(0, |r| r.map);
        for scene in scenes(&rows) {
            let here: Vec<&Row> = rows.iter().copied().filter(|r| r.scene == scene && r.map == first_map).collect();
            let Some(least) = here.iter().min_by_key(|r| r.samples) else { continue };
            for row in &here {
                at.entry(row.samples).or_default().push(row.time() / least.time());
            }
        }
        let means = at.iter().filter_map(|(n, r)| Some((f64::from(*n), geometric_mean(r)?, String::new())));
        let means: Vec<_> = means.collect();
        if means.len() > 1 {
            series.push(points(name, means));
        }
    }
    Plot {
        title: "time against samples".to_owned(),
        x: Axis::linear("samples a pixel"),
        y: Axis::linear("time over that of the fewest samples, geometric mean over scenes"),
        series,
    }
}

/// Time against triangles where one surface is split finer and finer.
fn time_triangles(rows: &[&Row]) -> Plot {
    let split: BTreeSet<&str> = rows.iter().filter(|r| r.tessellation > 0).map(|r| r.scene.as_str()).collect();
    let mut series = Vec::new();
    for scene in split {
        let of_scene: Vec<&Row> = rows.iter().copied().filter(|r| r.scene == scene).collect();
        for rows in by_series(&of_scene).into_values() {
            // What was measured at every level.
            let levels: BTreeSet<u32> = of_scene.iter().map(|r| r.tessellation).collect();
            let finest: Vec<&&Row> = rows.iter().filter(|r| Some(&r.tessellation) == levels.last()).collect();
            let Some(like) = finest.first() else { continue };
            let same = rows.iter().filter(|r| (r.map, r.samples) == (like.map, like.samples));
            let shadow = |r: &Row| r.time() - r.camera_ms;
            let of = |f: &dyn Fn(&Row) -> f64| {
                same.clone().map(|r| (r.triangles as f64, f(r), String::new())).collect::<Vec<_>>()
            };
            series.push(points(format!("{scene} {}: all stages", like.setting), of(&|r| r.time())));
            series.push(points(format!("{scene} {}: shadow stages", like.setting), of(&shadow)));
        }
    }
    Plot {
        title: "time against triangles of one surface".to_owned(),
        x: Axis::log("triangles"),
        y: Axis::log("time, ms"),
        series,
    }
}

/// Time against silhouette pixels over the scenes.
fn time_silhouettes(rows: &[&Row]) -> Plot {
    let mut series = Vec::new();
    for (name, rows) in by_series(rows).into_iter().filter(|(name, _)| name.starts_with("facet-masks")) {
        let (map, samples) = rows.first().map_or((0, 0), |r| (r.map, usual(&rows, r.map)));
        let same = rows.iter().filter(|r| r.map == map && r.samples == samples);
        let place = |r: &&Row| (r.counts.silhouette_pixels as f64, r.time() - r.camera_ms, slug(&r.scene));
        let mut one = points(format!("{name}, {samples} samples"), same.map(place).collect());
        one.joined = false;
        if one.points.len() > 1 {
            series.push(one);
        }
    }
    Plot {
        title: "time against undecided facets".to_owned(),
        x: Axis::log("undecided facets"),
        y: Axis::log("time without camera visibility, ms"),
        series,
    }
}

/// The samples nearest to 32 that a map size has.
fn usual(rows: &[&Row], map: u32) -> u32 {
    rows.iter().filter(|r| r.map == map).map(|r| r.samples).min_by_key(|n| n.abs_diff(32)).unwrap_or(0)
}

/// Time against map size, geometric means over the scenes.
fn map_size(rows: &[&Row]) -> Plot {
    let maps: BTreeSet<u32> = rows.iter().map(|r| r.map).collect();
    let mut series = Vec::new();
    for (name, rows) in by_series(rows).into_iter().filter(|_| maps.len() > 1) {
        let means = maps.iter().filter_map(|&map| {
            let samples = usual(&rows, map);
            let here: Vec<f64> =
                rows.iter().filter(|r| r.map == map && r.samples == samples).map(|r| r.time()).collect();
            Some((f64::from(map), geometric_mean(&here)?, String::new()))
        });
        let means: Vec<_> = means.collect();
        if means.len() > 1 {
            series.push(points(name, means));
        }
    }
    Plot {
        title: "time against map size".to_owned(),
        x: Axis::log("texels a side"),
        y: Axis::log("time of all stages, ms, geometric mean over scenes"),
        series,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::SceneErrors;
    use crate::report::comparison::Spread;

    fn row(scene: &str, setting: &str, samples: u32, time: f64, error: f64) -> Row {
        Row {
            scene: scene.to_owned(),
            method: "facet-masks".to_owned(),
            setting: setting.to_owned(),
            samples,
            gpu_ms: Spread { median: time, low: time, high: time },
            converged: SceneErrors { scene_band_rmse: Some(error), ..SceneErrors::default() },
            ..Row::default()
        }
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let rows = [
            row("a", "x", 1, 1.0, 0.5),
            row("a", "x", 8, 2.0, 0.6),
            row("a", "x", 32, 3.0, 0.1),
            row("a", "y", 1, 3.0, 0.2),
            row("a", "y", 8, 9.0, 0.1),
        ];
        let rows: Vec<&Row> = rows.iter().collect();
        let front: Vec<(f64, Option<f64>)> = pareto_front(&rows).iter().map(|r| (r.time(), error(r))).collect();
        assert_eq!(front, [(1.0, Some(0.5)), (3.0, Some(0.1))]);
    }

    /// The fastest row of all is on no front and in no plot of errors, if nothing is known of its error.
    #[test]
    fn what_has_no_error_beats_nothing() {
        let blank = Row { converged: SceneErrors::default(), ..row("a", "z", 1, 0.5, 0.0) };
        let rows = [row("a", "x", 1, 1.0, 0.5), blank];
        let front: Vec<f64> = pareto_front(&rows.iter().collect::<Vec<_>>()).iter().map(|r| r.time()).collect();
        assert_eq!(front, [1.0]);
        let found: BTreeMap<String, Plot> = figures(&rows).into_iter().collect();
        for name in ["error-time", "error-time-a"] {
            let times = found[name].series.iter().flat_map(|s| &s.points).map(|p| p.0);
            assert!(times.clone().all(|t| t == 1.0) && times.count() > 0, "{name}");
        }
    }

    #[test]
    fn means_are_over_what_every_scene_has() {
        let rows = [
            row("a", "x", 1, 1.0, 0.5),
            row("b", "x", 1, 4.0, 0.5),
            row("a", "x", 32, 2.0, 0.1),
            row("a", "y", 1, 2.0, 0.1),
            row("b", "y", 1, 2.0, 0.1),
        ];
        let found: BTreeMap<String, Plot> = figures(&rows).into_iter().collect();
        let series = &found["error-time"].series;
        assert_eq!(series.len(), 2);
        assert_eq!(series[0].points.len(), 1);
        assert!((series[0].points[0].0 - 2.0).abs() < 1e-12 && (series[0].points[0].1 - 0.5).abs() < 1e-12);
        assert!(found.contains_key("error-time-a") && found.contains_key("error-time-b"));
        assert!(found["time-triangles"].series.is_empty() && found["map-size"].series.is_empty());
        assert_eq!(geometric_mean(&[]), None);
    }
}
