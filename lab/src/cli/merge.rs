//! `report merge`: parts of a report or of figures, measured apart, put together.

use super::args::MergeOptions;
use super::held::FolderLock;
use super::table::Report;
use super::{command_line, figure, report};
use lab::report::comparison::{Journal, Machine, Row};
use lab::report::experiments::experiments;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;
use subpixel_shadows::{Error, Result};

/// How long a run waits for another one to leave a folder.
const PATIENCE: Duration = Duration::from_secs(2);
const JOURNAL: &str = "rows.jsonl";

/// Journals of some parts that hold rows of one page.
type Parts = BTreeMap<PathBuf, Vec<PathBuf>>;

/// Writes the journal and the page of every report and figure that the parts hold rows of.
pub fn run(options: &MergeOptions) -> Result<()> {
    FolderLock::check(&options.out)?;
    let mut parts = Parts::new();
    for folder in &options.parts {
        let found = journals(folder)?;
        if found.is_empty() {
            return Err(Error::file(folder, format!("holds no {JOURNAL}, of itself or of figures")));
        }
        for below in found {
            parts.entry(below.clone()).or_default().push(folder.join(below).join(JOURNAL));
        }
    }
    // All are read before anything is written.
    let read: Vec<(PathBuf, Machine, Vec<Row>)> = parts
        .into_iter()
        .map(|(below, files)| joined(&files).map(|(machine, rows)| (below, machine, rows)))
        .collect::<Result<_>>()?;
    let mut told = Report::default();
    for (below, machine, rows) in read {
        let out = options.out.join(&below);
        let _held = FolderLock::open(&out, PATIENCE)?;
        let mut journal = Journal::open(&out.join(JOURNAL), &machine)?;
        for row in rows.iter().filter(|row| !journal.has(&row.key())).collect::<Vec<_>>() {
            journal.add(row.clone())?;
        }
        let name = below.file_name().and_then(|name| name.to_str());
        match experiments().find(|e| Some(e.name) == name) {
            Some(experiment) => {
                let page = figure::write(experiment, &command_line(), &machine, &rows, &out)?;
                told.text(&format!("{}: {} rows, {}", experiment.name, rows.len(), page.display()));
            }
            None => {
                let written = report::write(&out, options.ground, &machine, &report::in_order(&rows)?)?;
                told.text(&format!("report: {} rows, {} files in {}", rows.len(), written.len(), out.display()));
            }
        }
    }
    told.text("pictures are drawn, and what is missing is measured, by the command of the parts without --part, into this folder");
    told.print()
}

/// Folders below one that hold a journal: itself, or some within it, two deep.
fn journals(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![(PathBuf::new(), 0)];
    while let Some((below, depth)) = open.pop() {
        let here = folder.join(&below);
        if here.join(JOURNAL).is_file() {
            found.push(below.clone());
        }
        if depth < 2 {
            let fault = |e: std::io::Error| Error::file(&here, e.to_string());
            for entry in std::fs::read_dir(&here).map_err(fault)? {
                let entry = entry.map_err(fault)?;
                if entry.file_type().map_err(fault)?.is_dir() {
                    open.push((below.join(entry.file_name()), depth + 1));
                }
            }
        }
    }
    Ok(found)
}

/// The rows of some journals, each once, and the machine, which must be the same.
fn joined(files: &[PathBuf]) -> Result<(Machine, Vec<Row>)> {
    let (mut machine, mut rows, mut keys) = (None, Vec::new(), BTreeSet::new());
    for file in files {
        let (own, found) = Journal::read_rows(file)?;
        if let Some(first) = machine.replace(own.clone())
            && first != own
        {
            let why = format!("rows of another machine ({}, of {} {})", own.line(), files[0].display(), first.line());
            return Err(Error::file(file, why));
        }
        rows.extend(found.into_iter().filter(|row| keys.insert(row.key())));
    }
    Ok((machine.unwrap_or_default(), rows))
}
