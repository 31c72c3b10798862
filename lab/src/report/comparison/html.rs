//! The report as one HTML file that needs no other: a plot whose points tell their row, a table that sorts, pictures with a wipe, and the
//! command of every row.

use super::figures::{pareto_front, scenes};
use super::measure::SceneCase;
use super::page::{Page, pictured};
use super::pictures::{ACROSS, GAP, middle_of};
use super::row::Row;
use base64::Engine as _;
use serde_json::{Value, json};

/// The pictures of a scene as [`side_by_side`](super::pictures::side_by_side) wrote them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureSheet {
    /// The scene.
    pub scene: String,
    /// The PNG file.
    pub png: Vec<u8>,
}

/// The name of the last picture of a sheet.
pub const TRUTH: &str = "rays through the same samples";

/// The command that renders a row again; `None` of rays, and of scenes that were split finer.
pub fn command(row: &Row, ground: bool) -> Option<String> {
    if row.method == SceneCase::TRUTH || row.tessellation > 0 {
        return None;
    }
    let [w, h] = row.size;
    let scene = shlex::try_quote(&row.scene).ok()?;
    let mut line = format!("cargo run --release -- render {scene} --method {}", row.method);
    line += &format!(" --size {w}x{h} --samples {} --map {}", row.samples, row.map);
    for (option, value) in row.setting.split_whitespace().filter_map(|part| part.split_once('=')) {
        line += &format!(" --{option} {value}");
    }
    line += if ground { " --ground --truth" } else { " --truth" };
    Some(line)
}

/// The figures of a row, as the page reads them.
fn figures(row: &Row, front: bool, ground: bool) -> Value {
    let timed = row.method != SceneCase::TRUTH;
    json!({
        "scene": row.scene,
        "tessellation": row.tessellation,
        "series": row.series(),
        "samples": row.samples,
        "map": timed.then_some(row.map),
        "ms": timed.then(|| row.time()),
        "ratio": (timed && row.ratio > 0.0).then_some(row.ratio),
        "camera_ms": timed.then_some(row.camera_ms),
        "matched": row.matched.scene_band_rmse,
        "max": row.matched.scene_max,
        "match": row.matched.scene_pixel_match,
        "converged": row.converged.scene_band_rmse,
        "flip": row.converged.scene_flip,
        "leaks": row.matched.scene_leak_pixels,
        "acne": row.matched.scene_acne_pixels,
        "mib": row.memory.map(|bytes| bytes as f64 / f64::from(1 << 20)),
        "front": front,
        "failed": row.failed,
        "command": command(row, ground),
    })
}

/// The page. `ground`: the rows' scenes have one added.
pub fn html(page: &Page, rows: &[Row], sheets: &[PictureSheet], ground: bool) -> String {
    let plain: Vec<&Row> = rows.iter().filter(|r| r.tessellation == 0).collect();
    let timed = |scene: &str| -> Vec<&Row> {
        let own = plain.iter().copied().filter(|r| r.scene == scene);
        own.filter(|r| r.failed.is_none() && r.method != SceneCase::TRUTH).collect()
    };
    let mut found = Vec::new();
    for scene in scenes(&plain) {
        let front: Vec<String> = pareto_front(&timed(&scene)).iter().map(|r| r.key()).collect();
        let own = plain.iter().filter(|r| r.scene == scene);
        found.extend(own.map(|r| figures(r, r.method != SceneCase::TRUTH && front.contains(&r.key()), ground)));
    }
    let mut pictures = serde_json::Map::new();
    for PictureSheet { scene, png } in sheets {
        let timed = timed(scene);
        let Some(size) = timed.first().map(|r| r.size) else { continue };
        let shown = timed.iter().filter(|r| pictured(r, &timed)).map(|r| r.series());
        let names: Vec<String> = shown.chain([TRUTH.to_owned()]).collect();
        let [width, height] = middle_of(size);
        let sheet = json!({
            "png": base64::engine::general_purpose::STANDARD.encode(png),
            "width": width,
            "height": height,
            "gap": GAP,
            "across": names.len().min(ACROSS),
            "names": names,
        });
        pictures.insert(scene.clone(), sheet);
    }
    let report = json!({
        "command": page.command,
        "machine": page.machine.line(),
        "software": page.machine.software,
        "rows": found,
        "pictures": pictures,
    });
    // Nothing in it may end the script.
    let text = report.to_string().replace('<', "\\u003c");
    include_str!("index.html").replace("/*REPORT*/null", &text)
}

/// The report that a page holds.
///
/// # Errors
/// Why it is no page of a report.
pub fn data_of(html: &str) -> Result<Value, String> {
    let text = html.split_once("const REPORT = ").and_then(|(_, rest)| rest.split_once(";\n"));
    serde_json::from_str(text.ok_or("no report")?.0).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_holds_what_it_is_given() {
        let row = |method: &str, setting: &str, samples| Row {
            scene: "a </script> b".to_owned(),
            method: method.to_owned(),
            setting: setting.to_owned(),
            size: [9, 7],
            map: 64,
            samples,
            ..Row::default()
        };
        let rows = [
            row("facet-masks", "facets=all", 32),
            row("spsm", "encoding=lines search=wide", 32),
            row("pcf", "kernel=5", 8),
            row(SceneCase::TRUTH, "", 32),
        ];
        let sheet = PictureSheet { scene: rows[0].scene.clone(), png: vec![0, 255, 7] };
        let text = html(&Page::default(), &rows, &[sheet], true);
        assert_eq!(text.matches("</script>").count(), 1, "a name ends the script");
        let data = data_of(&text).unwrap();
        let commands: Vec<_> = data["rows"].as_array().unwrap().iter().map(|r| r["command"].as_str()).collect();
        assert_eq!(
            commands[1].unwrap(),
            "cargo run --release -- render 'a </script> b' --method spsm --size 9x7 --samples 32 --map 64 \
             --encoding lines --search wide --ground --truth"
        );
        assert!(commands[3].is_none() && commands.len() == 4);
        let picture = &data["pictures"]["a </script> b"];
        assert_eq!((&picture["png"], &picture["width"], &picture["height"]), (&json!("AP8H"), &json!(5), &json!(4)));
        assert_eq!(picture["names"], json!(["facet-masks facets=all", "spsm encoding=lines search=wide", TRUTH]));
        assert!(data_of(&text.replace("const REPORT", "const OTHER")).is_err());
    }
}
