//! The page of an experiment.

use super::{Experiment, Place, Table};
use crate::report::comparison::figures::slug;
use crate::report::comparison::pictures::ACROSS;
use crate::report::comparison::{Machine, Row};
use std::fmt::Write;

/// The command that renders a row of an experiment again.
pub fn command_of(place: &Place, row: &Row) -> String {
    let [w, h] = row.size;
    let mut line = format!("cargo run --release -- render {}", place.scene);
    if !place.options.is_empty() {
        line += &format!(" {}", place.options);
    }
    line += &format!(" --method {} --size {w}x{h} --samples {} --map {}", row.method, row.samples, row.map);
    for (option, value) in row.setting.split_whitespace().filter_map(|part| part.split_once('=')) {
        line += &format!(" --{option} {value}");
    }
    line + " --truth"
}

/// The page: what the paper shows, what was measured, why they differ, and the command of each row. `plots` are those that were written,
/// `pictured` the scenes whose sheets were, with the rows on them, `tinted` pictures of views, each file with its row.
pub fn markdown(
    experiment: &Experiment,
    command: &str,
    machine: &Machine,
    rows: &[Row],
    plots: &[&str],
    pictured: &[(&str, Vec<String>)],
    tinted: &[(String, String)],
) -> String {
    let mut out = format!("# {}\n\n{}.\n\n`{command}`\n\n{}.", experiment.title, experiment.source, machine.line());
    if machine.software {
        out += " **Times are those of a CPU that runs the kernels, not of a GPU.**";
    }
    let measured: Vec<&Row> = rows.iter().filter(|r| r.failed.is_none()).collect();
    let least = measured.iter().map(|r| r.repeats).min().unwrap_or(0);
    let most = measured.iter().map(|r| r.repeats).max().unwrap_or(0);
    let size = measured.first().map_or([0; 2], |r| r.size);
    let _ = write!(
        out,
        " Images of {} x {}; times are GPU times of all stages, medians of {least} to {most} frames, the rows in turns; *times* are over the first \
         row of their kind. Errors are against rays through the same samples unless said.\n\n## The paper\n\n{}\n\n## Here\n\n",
        size[0], size[1], experiment.shows
    );
    for table in (experiment.tables)(&measured) {
        if !table.title.is_empty() {
            let _ = writeln!(out, "{}\n", table.title);
        }
        write_table(&mut out, &table);
    }
    for plot in plots {
        let _ = writeln!(out, "![{plot}]({plot}.svg)\n");
    }
    for (scene, names) in pictured {
        let gain = experiment.sheet.map_or(1.0, |sheet| sheet.gain);
        let _ = writeln!(
            out,
            "![{scene}](pictures-{}.png)\n\n{scene}, {ACROSS} in a row, from left to right: {}. Below each, the difference from rays through the \
             same samples{}: red is too bright, blue too dark.\n",
            slug(scene),
            names.join("; "),
            if gain == 1.0 { String::new() } else { format!(", times {gain}") }
        );
    }
    for (file, row) in tinted {
        let _ = writeln!(
            out,
            "![{row}]({file})\n\n{row}: tinted by the view of the light that each pixel asks, red the first, green, blue.\n"
        );
    }
    let _ = writeln!(out, "## Why they differ\n\n{}\n", experiment.differs);
    let failed: Vec<&Row> = rows.iter().filter(|r| r.failed.is_some()).collect();
    if !failed.is_empty() {
        let _ = writeln!(out, "## Without figures\n");
        let line = |r: &&Row| vec![r.key(), r.failed.clone().unwrap_or_default()];
        let lines = failed.iter().map(line).collect();
        write_table(&mut out, &Table { title: String::new(), head: vec!["row", "why"], lines });
    }
    out += "## Commands\n\n";
    for place in experiment.places {
        for row in rows.iter().filter(|r| r.scene == place.label && r.tessellation == 0) {
            let _ = writeln!(out, "- `{}`", command_of(place, row));
        }
    }
    out
}

fn write_table(out: &mut String, table: &Table) {
    let _ = writeln!(out, "| {} |", table.head.join(" | "));
    let _ = writeln!(out, "|{}|", vec!["---"; table.head.len()].join("|"));
    for line in &table.lines {
        let _ = writeln!(out, "| {} |", line.join(" | "));
    }
    out.push('\n');
}
