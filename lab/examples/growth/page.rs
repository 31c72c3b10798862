//! The page: a table and a plot for each axis, with slopes.

use crate::axes::Axis;
use crate::row::{COLUMNS, Figure, Row, slope};
use lab::report::comparison::plots::{Axis as PlotAxis, Plot, Series};
use lab::report::write_text;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::{Error, Result};

const HEAD: &str = "# What a frame grows with

`cargo run --release --example growth` made this page. Frames are of `facet-masks` with a facet for every surface, 400 x 300 pixels, 32 samples
and a map of 512 x 512 texels where nothing else is said; times are medians of three frames after one that is not timed, from submission to the
end, and what the stages took: *surfaces* finds what each sample sees, *light* is set-up and maps, *shadows* the rest. *Prepare* is what the
CPU does to a mesh once, *first* all from there to the end of the first frame. *MiB* is the device's memory in use. The last row of a table
is the slope: the exponent of a power law through the points (1: in proportion, 0: not at all).
";

/// Writes the page and its plots.
pub fn write(out: &Path, gpu: &Gpu, axes: &[&Axis], rows: &BTreeMap<String, Row>) -> Result<()> {
    let mut page = format!("{HEAD}\nAdapter: {}, {}.\n", gpu.adapter.name, gpu.adapter.driver);
    for axis in axes {
        let rows: Vec<&Row> = axis
            .points
            .iter()
            .filter_map(|point| {
                rows.get(&Row { axis: axis.name.to_owned(), label: point.label.clone(), ..Row::default() }.key())
            })
            .collect();
        page += &section(out, axis, &rows)?;
    }
    write_text(&out.join("growth.md"), &page)
}

fn section(out: &Path, axis: &Axis, rows: &[&Row]) -> Result<String> {
    let mut text = String::new();
    let fault = |_| Error::Config("a page that cannot be written".to_owned());
    let held = if axis.held.is_empty() { String::new() } else { format!("Of {}.\n\n", axis.held) };
    write!(text, "\n## {}\n\n{held}", capital(axis.name)).map_err(fault)?;
    if axis.sloped {
        let file = format!("{}.svg", axis.name);
        plot(axis, rows).write(&out.join(&file))?;
        write!(text, "![{}]({file})\n\n", axis.name).map_err(fault)?;
    }
    let names: Vec<&str> = COLUMNS.iter().map(|(name, _)| *name).collect();
    let unit = if axis.unit.is_empty() { "view" } else { axis.unit };
    writeln!(text, "| {unit} | {} |\n|{}", names.join(" | "), "---|".repeat(1 + COLUMNS.len())).map_err(fault)?;
    for row in rows {
        let cells: Vec<String> = COLUMNS.iter().map(|(_, value)| short(value(row))).collect();
        writeln!(text, "| {} | {} |", row.label, cells.join(" | ")).map_err(fault)?;
    }
    if axis.sloped {
        let of = |value: Figure| slope(rows.iter().map(|row| (row.x, value(row))));
        let cells = COLUMNS.map(|(_, value)| of(value).map_or(String::new(), |s| format!("**{s:.2}**")));
        writeln!(text, "| slope | {} |", cells.join(" | ")).map_err(fault)?;
    }
    Ok(text)
}

fn plot(axis: &Axis, rows: &[&Row]) -> Plot {
    let series = |k: usize| {
        let (name, value) = COLUMNS[k];
        let points = rows.iter().map(|row| (row.x, value(row), String::new())).collect();
        Series { name: name.to_owned(), points, joined: true, guide: false }
    };
    Plot {
        title: format!("A frame over {}", axis.unit),
        x: PlotAxis::log(axis.unit),
        y: PlotAxis::log("ms"),
        series: (0..4).map(series).collect(),
    }
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Four digits at the most, and thousands apart.
fn short(v: f64) -> String {
    if v < 100.0 && v.fract() != 0.0 {
        return format!("{v:.1}");
    }
    let digits = format!("{v:.0}");
    let from_end =
        |(k, c): (usize, char)| if k > 0 && (digits.len() - k) % 3 == 0 { format!(",{c}") } else { c.to_string() };
    digits.chars().enumerate().map(from_end).collect()
}
