//! Very many frames of one `ShadowPass`, whose camera, light and casters move and whose size changes: memory stays, and the last
//! frame is that of a fresh pass. `cargo run --release --example soak [-- --frames N] [--facets one|all] [--page FILE]`
//!
//! 20,000 frames with a facet for every surface, unless told otherwise; the page is written only where one is named. The exit status is
//! 1 if memory grew after the first 1,000 frames or the last frame differs.

use std::fmt::Write as _;
use std::path::PathBuf;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::FacetMode;
use subpixel_shadows::{Error, Result};
use test_support::soak::{LEGS, Row, Soak, soak as run};

/// Frames with the same size and casters.
const LEG: u64 = 20;
/// Frames between two rows of the table.
const EVERY: u64 = 500;
/// Frames after which memory must not grow: all that there is was there.
const SETTLED: u64 = 1000;
/// Bytes that an allocator may move to and fro.
const SLACK: u64 = 4 << 20;
/// Bytes by which the second half may exceed the first.
const STILL: u64 = 1 << 18;

fn main() {
    match started() {
        Ok(true) => {}
        Ok(false) => std::process::exit(1),
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(if error.is_gpu() { 3 } else { 2 });
        }
    }
}

fn started() -> Result<bool> {
    let (mut frames, mut facets, mut page) = (20_000, FacetMode::All, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| Error::Config(format!("{word} needs a value")))?;
        match (word.as_str(), value.as_str()) {
            ("--frames", n) => frames = n.parse().map_err(|e| Error::Config(format!("'{n}': {e}")))?,
            ("--facets", "one") => facets = FacetMode::One,
            ("--facets", "all") => facets = FacetMode::All,
            ("--page", file) => page = Some(PathBuf::from(file)),
            _ => return Err(Error::Config(format!("no option {word} {value}"))),
        }
    }
    let gpu = Gpu::open(None)?;
    let soak = run(&gpu, facets, frames, LEG, EVERY, &mut |row| println!("{}", line(row)))?;
    let verdict = verdict(&soak, frames);
    for text in &verdict.1 {
        println!("{text}");
    }
    if let Some(path) = page {
        let text = text(&gpu, &soak, facets, frames, &verdict.1);
        std::fs::write(&path, text).map_err(|e| Error::file(path, e.to_string()))?;
    }
    Ok(verdict.0)
}

fn line(row: &Row) -> String {
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    format!("| {} | {:.1} | {:.2} | {:.1} |", row.frame, mib(row.resident), mib(row.device), row.ms)
}

/// Whether all is well, and why.
fn verdict(soak: &Soak, frames: u64) -> (bool, Vec<String>) {
    let most = |of: fn(&Row) -> u64, late: bool| {
        let rows = soak.rows.iter().filter(|row| (row.frame > SETTLED) == late);
        rows.map(of).max().unwrap_or(0)
    };
    let mut well = true;
    let mut told = Vec::new();
    for (what, of) in [("the process", (|row| row.resident) as fn(&Row) -> u64), ("the device", |row| row.device)] {
        let (early, late) = (most(of, false), most(of, true));
        well &= late <= early + SLACK;
        told.push(format!("Most bytes of {what} up to frame {SETTLED}: {early}; after it: {late}."));
        // A leak grows to the end.
        let half = |late: bool| {
            let rows = soak.rows.iter().filter(|row| row.frame > SETTLED && (row.frame > frames / 2) == late);
            rows.map(of).max().unwrap_or(0)
        };
        if frames >= 4 * SETTLED {
            let (first, second) = (half(false), half(true));
            well &= second <= first + STILL;
            told.push(format!("Of these in the first half of all frames: {first}; in the second: {second}."));
        }
    }
    let [last, fresh] = &soak.last;
    let differ = last.iter().zip(fresh).filter(|(a, b)| a != b).count() + last.len().abs_diff(fresh.len());
    well &= differ == 0 && !last.is_empty();
    told.push(format!("The last frame differs from that of a fresh pass in {differ} of {} words.", fresh.len()));
    told.push(format!("Complete: {} of {frames} frames.", soak.complete));
    (well, told)
}

fn text(gpu: &Gpu, soak: &Soak, facets: FacetMode, frames: u64, told: &[String]) -> String {
    let mut out = String::new();
    let name = if facets == FacetMode::All { "all" } else { "one" };
    let _ = writeln!(out, "# {frames} frames of one pass\n");
    let _ = writeln!(
        out,
        "`cargo run --release --example soak -- --frames {frames} --facets {name} --page FILE`, {} ({}).\n",
        gpu.adapter.name, gpu.adapter.driver
    );
    let again = LEG * LEGS;
    let _ = writeln!(
        out,
        "One `ShadowPass`, 8 samples, map 32, `keep_last`: camera and light move every frame, moving casters too; every {LEG} frames there are\n\
         other casters (by turns standing and moving ones, 36 to 72 triangles) and another of five sizes, and every third time the light\n\
         stands among its casters, with up to six views. After {again} frames all comes again. Read every {EVERY} frames: what the process has in memory, all resources of the\n\
         device, and the mean time of a frame on a busy machine, with the changes of casters and size in it.\n"
    );
    for text in told {
        let _ = writeln!(out, "- {text}");
    }
    let _ = writeln!(out, "\n| frame | process, MiB | device, MiB | ms a frame |\n|---|---|---|---|");
    for row in &soak.rows {
        let _ = writeln!(out, "{}", line(row));
    }
    out
}
