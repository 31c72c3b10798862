//! The report as Markdown and CSV.

use super::figures::{error, measured, pareto_front, scenes, slug};
use super::measure::SceneCase;
use super::row::{Machine, Row};
use crate::report::{or_dash, percent_or_dash};
use std::fmt::Write;

/// Text of a page beside its rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// The command that made it.
    pub command: String,
    /// Where it was measured.
    pub machine: Machine,
    /// File names of the plots that were written.
    pub plots: Vec<String>,
    /// Scenes whose pictures were written.
    pub pictured: Vec<String>,
}

/// Columns of the CSV file, and what each shows.
type Column = (&'static str, fn(&Row) -> String);

const COLUMNS: [Column; 49] = [
    ("scene", |r| quoted(&r.scene)),
    ("tessellation", |r| r.tessellation.to_string()),
    ("triangles", |r| r.triangles.to_string()),
    ("width", |r| r.size[0].to_string()),
    ("height", |r| r.size[1].to_string()),
    ("map", |r| r.map.to_string()),
    ("method", |r| r.method.clone()),
    ("setting", |r| quoted(&r.setting)),
    ("samples", |r| r.samples.to_string()),
    ("failed", |r| quoted(r.failed.as_deref().unwrap_or(""))),
    ("repeats", |r| r.repeats.to_string()),
    ("gpu_ms", |r| r.gpu_ms.median.to_string()),
    ("gpu_ms_low", |r| r.gpu_ms.low.to_string()),
    ("gpu_ms_high", |r| r.gpu_ms.high.to_string()),
    ("camera_ms", |r| r.camera_ms.to_string()),
    ("wall_ms", |r| r.wall_ms.median.to_string()),
    ("wall_ms_low", |r| r.wall_ms.low.to_string()),
    ("wall_ms_high", |r| r.wall_ms.high.to_string()),
    ("ratio", |r| r.ratio.to_string()),
    ("memory", |r| r.memory.map_or(String::new(), |m| m.to_string())),
    ("silhouette_edges", |r| r.counts.silhouette_edges.to_string()),
    ("silhouette_texels", |r| r.counts.silhouette_texels.to_string()),
    ("silhouette_pixels", |r| r.counts.silhouette_pixels.to_string()),
    ("pixel_texel_pairs", |r| r.counts.pixel_texel_pairs.to_string()),
    ("triangle_texel_pairs", |r| r.counts.triangle_texel_pairs.to_string()),
    ("candidate_tests", |r| r.counts.candidate_tests.to_string()),
    ("visibility_evaluations", |r| r.counts.visibility_evaluations.to_string()),
    ("refined_evaluations", |r| r.counts.refined_evaluations.to_string()),
    ("facets", |r| r.counts.facets.to_string()),
    ("complex_pixels", |r| r.counts.complex_pixels.to_string()),
    ("matched_rmse", |r| r.matched.scene_rmse.to_string()),
    ("matched_mean", |r| r.matched.scene_mean.to_string()),
    ("matched_max", |r| r.matched.scene_max.to_string()),
    ("matched_pixel_match", |r| or_empty(r.matched.scene_pixel_match)),
    ("matched_band_pixels", |r| r.matched.scene_band_pixels.to_string()),
    ("matched_band_rmse", |r| or_empty(r.matched.scene_band_rmse)),
    ("matched_band_mean", |r| or_empty(r.matched.scene_band_mean)),
    ("matched_band_max", |r| or_empty(r.matched.scene_band_max)),
    ("matched_band_pixel_match", |r| or_empty(r.matched.scene_band_pixel_match)),
    ("matched_acne_pixels", |r| r.matched.scene_acne_pixels.to_string()),
    ("matched_leak_pixels", |r| r.matched.scene_leak_pixels.to_string()),
    ("matched_flip", |r| r.matched.scene_flip.to_string()),
    ("matched_one_plane_match", |r| or_empty(r.matched.scene_one_plane_match)),
    ("converged_rmse", |r| r.converged.scene_rmse.to_string()),
    ("converged_max", |r| r.converged.scene_max.to_string()),
    ("converged_band_rmse", |r| or_empty(r.converged.scene_band_rmse)),
    ("converged_band_mean", |r| or_empty(r.converged.scene_band_mean)),
    ("converged_leak_pixels", |r| r.converged.scene_leak_pixels.to_string()),
    ("converged_flip", |r| r.converged.scene_flip.to_string()),
];

/// A figure that there may not be, in the CSV file.
fn or_empty(value: Option<f64>) -> String {
    value.map_or(String::new(), |v| v.to_string())
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// All rows as comma-separated values, a line of names first.
pub fn csv(rows: &[Row]) -> String {
    let mut out = COLUMNS.map(|(name, _)| name).join(",");
    out.push('\n');
    for row in rows {
        out += &COLUMNS.map(|(_, value)| value(row)).join(",");
        out.push('\n');
    }
    out
}

/// A Markdown table.
fn table(out: &mut String, head: &[&str], rows: impl Iterator<Item = Vec<String>>) {
    let _ = writeln!(out, "| {} |", head.join(" | "));
    let _ = writeln!(out, "|{}|", vec!["---"; head.len()].join("|"));
    for row in rows {
        let _ = writeln!(out, "| {} |", row.join(" | "));
    }
    out.push('\n');
}

/// The report as a page of Markdown; plots and pictures are linked by their names.
pub fn markdown(page: &Page, rows: &[Row]) -> String {
    let all = measured(rows);
    let plain: Vec<&Row> = all.iter().copied().filter(|r| r.tessellation == 0).collect();
    let mut out = String::from("# Error against run time\n\n");
    let _ = writeln!(out, "`{}`\n\n{}.\n", page.command, page.machine.line());
    if page.machine.software {
        out += "**The adapter is software: the times are those of a CPU that runs the kernels, not of a GPU.**\n\n";
    }
    let least = plain.iter().map(|r| r.repeats).min().unwrap_or(0);
    let most = plain.iter().map(|r| r.repeats).max().unwrap_or(0);
    let repeats = if least == most {
        format!("{most} frames")
    } else {
        format!("{most} frames, of fewer where they take long ({least} at the least)")
    };
    let _ = writeln!(
        out,
        "Each time is the median of {repeats}, after one that is not timed, the rows of a scene in turns, with the quartiles in \
         the CSV file. It is the GPU time of all stages, reading back left out. *Ratio* is over `facet-masks facets=one` of the same round. Errors \
         are of visibility: *matched* against rays through the same samples, *converged* against 1024 rays a pixel; *band* is \
         the silhouette band, the pixels that are neither all lit nor all dark, grown by one.\n"
    );
    for plot in page.plots.iter().filter(|p| !p.starts_with("error-time-")) {
        let _ = writeln!(out, "![{plot}]({plot}.svg)\n");
    }
    for scene in scenes(&plain) {
        scene_section(&mut out, page, &scene, rows);
    }
    on_the_front(&mut out, &plain);
    stage_table(&mut out, &plain);
    tessellation_table(&mut out, &all);
    failures(&mut out, rows);
    out
}

fn scene_section(out: &mut String, page: &Page, scene: &str, rows: &[Row]) {
    let of_scene: Vec<&Row> = rows.iter().filter(|r| r.scene == scene && r.tessellation == 0).collect();
    let shown: Vec<&Row> = of_scene.iter().copied().filter(|r| r.failed.is_none()).collect();
    let timed: Vec<&Row> = shown.iter().copied().filter(|r| r.method != SceneCase::TRUTH).collect();
    let front = pareto_front(&timed);
    let triangles = shown.first().map_or(0, |r| r.triangles);
    let _ = writeln!(out, "## {scene}\n\n{triangles} triangles.\n");
    let plot = format!("error-time-{}", slug(scene));
    if page.plots.contains(&plot) {
        let _ = writeln!(out, "![{plot}]({plot}.svg)\n");
    }
    if page.pictured.iter().any(|p| p == scene) {
        let _ = writeln!(
            out,
            "![pictures](pictures-{0}.png)\n\nVisibility, four methods in a row: {1}; at last rays. Below each, the difference from rays through \
             the same samples: red is too bright, blue too dark.\n",
            slug(scene),
            timed.iter().filter(|r| pictured(r, &timed)).map(|r| r.series()).collect::<Vec<_>>().join("; ")
        );
    }
    let head = [
        "method",
        "samples",
        "map",
        "ms",
        "ratio",
        "camera ms",
        "band RMSE matched",
        "max",
        "within 1/N",
        "band RMSE \
         converged",
        "FLIP",
        "leaks",
        "MiB",
        "front",
    ];
    table(
        out,
        &head,
        shown.iter().map(|r| {
            let timed = r.method != SceneCase::TRUTH;
            let if_timed = |text: String| if timed { text } else { "–".to_owned() };
            vec![
                r.series(),
                r.samples.to_string(),
                if_timed(r.map.to_string()),
                if_timed(format!("{:.2}", r.time())),
                or_dash((timed && r.ratio > 0.0).then_some(r.ratio), 2),
                if_timed(format!("{:.2}", r.camera_ms)),
                or_dash(r.matched.scene_band_rmse, 5),
                format!("{:.3}", r.matched.scene_max),
                percent_or_dash(r.matched.scene_pixel_match),
                or_dash(r.converged.scene_band_rmse, 5),
                format!("{:.5}", r.converged.scene_flip),
                r.matched.scene_leak_pixels.to_string(),
                r.memory.map_or("–".to_owned(), |m| format!("{:.0}", m as f64 / f64::from(1 << 20))),
                if front.iter().any(|f| f.key() == r.key()) { "yes".to_owned() } else { String::new() },
            ]
        }),
    );
}

/// Whether a row's picture is shown: the rows at the samples and the map of the first.
pub fn pictured(row: &Row, rows: &[&Row]) -> bool {
    rows.first().is_some_and(|first| first.samples == row.samples && first.map == row.map)
}

/// Which methods are on the front of which scene.
fn on_the_front(out: &mut String, rows: &[&Row]) {
    let _ = writeln!(out, "## Pareto front\n");
    let mut lines = Vec::new();
    for scene in scenes(rows) {
        let of_scene: Vec<&Row> = rows.iter().copied().filter(|r| r.scene == scene).collect();
        let front = pareto_front(&of_scene);
        let first_map = of_scene.first().map_or(0, |r| r.map);
        let text = |r: &&Row| {
            let map = if r.map == first_map { String::new() } else { format!(", map {}", r.map) };
            format!("{} ({}{map}: {:.1} ms, {})", r.series(), r.samples, r.time(), or_dash(error(r), 4))
        };
        let ours = front.iter().any(|r| r.method == "facet-masks");
        lines.push(vec![
            scene,
            if front.is_empty() { "–: no silhouette band" } else { if ours { "yes" } else { "**no**" } }.to_owned(),
            front.iter().map(text).collect::<Vec<_>>().join("; "),
        ]);
    }
    table(
        out,
        &["scene", "facet-masks on it", "the front: method (samples: time, band RMSE converged)"],
        lines.into_iter(),
    );
}

/// Table 1 of Pan 2009 with its own figures.
const PAPER: [(&str, [&str; 8]); 7] = [
    ("figure 1(c) (paper)", ["40712", "9365", "36113", "1295363", "32", "2.3", "6.5", "13.2"]),
    ("figure 8(a), bunny (paper)", ["69473", "3254", "18523", "609901", "32", "2.1", "6.3", "6.8"]),
    ("pterosaur (paper)", ["10000", "1828", "12991", "329740", "32", "1.6", "4.7", "4.3"]),
    ("cage (paper)", ["59780", "37646", "53576", "2915995", "128", "4.2", "10.0", "18.9"]),
    ("bicycle (paper)", ["30922", "4277", "40954", "2996154", "32", "2.1", "6.6", "15.3"]),
    ("horse (paper)", ["77500", "4317", "26202", "2138740", "32", "2.3", "6.5", "17.3"]),
    ("plant (paper)", ["20926", "15263", "59692", "1446287", "32", "2.1", "6.2", "10.8"]),
];

/// Stages of the three steps that Pan 2009 times: mask map, pairs, shadows.
pub const STEPS: [&[&str]; 3] = [
    &["requested_blocks", "light_layers", "silhouette_mask", "front_layer", "summed_area"],
    &["facet_classify", "pixel_texel_pairs", "triangle_texel_pairs"],
    &["candidate_pairs", "visibility_masks", "visibility_refine", "resolve"],
];

/// Milliseconds of some stages of a row.
pub fn step_ms(row: &Row, names: &[&str]) -> f64 {
    row.stages.iter().filter(|s| names.contains(&s.name.as_str())).map(|s| s.gpu_ms).sum()
}

fn stage_table(out: &mut String, rows: &[&Row]) {
    let usual = rows.first().map_or((0, 0), |r| (r.samples, r.map));
    let ours = rows.iter().filter(|r| r.series() == "facet-masks facets=one" && (r.samples, r.map) == usual);
    let lines = ours.map(|r| {
        let c = &r.counts;
        let counts = [r.triangles, c.silhouette_texels, c.silhouette_pixels, c.visibility_evaluations];
        let mut line = vec![r.scene.clone()];
        line.extend(counts.iter().map(u64::to_string));
        line.push(r.samples.to_string());
        line.extend(STEPS.map(|names| format!("{:.1}", step_ms(r, names))));
        line
    });
    let paper = PAPER.iter().map(|(name, cells)| {
        std::iter::once((*name).to_owned()).chain(cells.iter().map(|c| (*c).to_owned())).collect()
    });
    let lines: Vec<Vec<String>> = lines.chain(paper).collect();
    let _ = writeln!(
        out,
        "## Stages beside the paper's\n\nTable 1 of Pan 2009 (GTX 280, 800 × 600, map of 512²), column by column. Our evaluations are \
         of what the test in the light view keeps; our texels include those whose front layer is not proved.\n"
    );
    let head = [
        "scene",
        "triangles",
        "silhouette texels",
        "silhouette pixels",
        "evaluations",
        "samples",
        "mask map ms",
        "pairs ms",
        "shadow ms",
    ];
    table(out, &head, lines.into_iter());
    let _ = writeln!(out, "Every stage of `facet-masks`, ms:\n");
    let shown: Vec<&&Row> = rows.iter().filter(|r| r.method == "facet-masks" && (r.samples, r.map) == usual).collect();
    let mut names: Vec<&str> = Vec::new();
    for stage in shown.iter().flat_map(|r| &r.stages) {
        if !names.contains(&stage.name.as_str()) {
            names.push(&stage.name);
        }
    }
    let mut head = vec!["scene", "setting"];
    head.extend(&names);
    let time = |r: &Row, name: &str| {
        r.stages.iter().find(|s| s.name == name).map_or("–".to_owned(), |s| format!("{:.2}", s.gpu_ms))
    };
    table(
        out,
        &head,
        shown.iter().map(|r| {
            let mut line = vec![r.scene.clone(), r.setting.clone()];
            line.extend(names.iter().map(|n| time(r, n)));
            line
        }),
    );
}

fn tessellation_table(out: &mut String, rows: &[&Row]) {
    if rows.iter().all(|r| r.tessellation == 0) {
        return;
    }
    let split: Vec<&&Row> =
        rows.iter().filter(|r| rows.iter().any(|o| o.tessellation > 0 && o.scene == r.scene)).collect();
    let like = split.iter().find(|r| r.tessellation > 0).map_or((0, 0), |r| (r.samples, r.map));
    let _ = writeln!(out, "## One surface in more triangles\n");
    let head =
        ["scene", "setting", "triangles", "ms", "camera ms", "silhouette edges", "undecided facets", "evaluations"];
    let mut same: Vec<&&Row> = split.into_iter().filter(|r| (r.samples, r.map) == like).collect();
    same.retain(|r| rows.iter().any(|o| o.tessellation > 0 && o.series() == r.series()));
    same.sort_by_key(|r| (r.scene.clone(), r.series(), r.tessellation));
    table(
        out,
        &head,
        same.iter().map(|r| {
            let c = &r.counts;
            vec![
                r.scene.clone(),
                r.series(),
                r.triangles.to_string(),
                format!("{:.2}", r.time()),
                format!("{:.2}", r.camera_ms),
                c.silhouette_edges.to_string(),
                c.silhouette_pixels.to_string(),
                c.visibility_evaluations.to_string(),
            ]
        }),
    );
}

fn failures(out: &mut String, rows: &[Row]) {
    let failed: Vec<&Row> = rows.iter().filter(|r| r.failed.is_some()).collect();
    if failed.is_empty() {
        return;
    }
    let _ = writeln!(out, "## Without figures\n");
    table(out, &["row", "why"], failed.iter().map(|r| vec![r.key(), r.failed.clone().unwrap_or_default()]));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_there_and_failures_are_named() {
        let row = |scene: &str, n| Row {
            scene: scene.to_owned(),
            method: "facet-masks".to_owned(),
            setting: "facets=one".to_owned(),
            samples: n,
            ..Row::default()
        };
        let failed = Row { failed: Some("memory: 'x', too small".to_owned()), ..row("b", 128) };
        let rows = [row("a", 32), row("a, \"b\"", 32), failed];
        let text = csv(&rows);
        assert_eq!(text.lines().count(), 4);
        assert!(text.contains("\"a, \"\"b\"\"\"") && text.contains("\"memory: 'x', too small\""));
        let columns = text.lines().next().unwrap().split(',').count();
        assert_eq!(text.lines().nth(1).unwrap().split(',').count(), columns);
        let page = Page { command: "report".to_owned(), ..Page::default() };
        let text = markdown(&page, &rows);
        assert!(text.contains("## a\n") && text.contains("too small") && text.contains("`report`"));
        assert!(!text.contains("The adapter is software"));
        // Nothing is known of the errors in their bands.
        let lines = csv(&rows[..1]);
        let [names, values] = [0, 1].map(|n| lines.lines().nth(n).unwrap().split(',').collect::<Vec<_>>());
        let empty = names.iter().zip(values).filter(|(_, v)| v.is_empty()).map(|(name, _)| *name);
        assert!(empty.clone().filter(|n| n.contains("_band_")).count() == 6, "{:?}", empty.collect::<Vec<_>>());
        assert!(text.contains("| – | 0.000 | – | – |") && text.contains("–: no silhouette band"), "{text}");
        let soft = Page { machine: Machine { software: true, ..Machine::default() }, ..page };
        assert!(markdown(&soft, &rows).contains("The adapter is software"));
    }
}
