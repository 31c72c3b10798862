//! Every request for memory of every built-in scene refused once, in turn: `cargo run --release --example refused_memory [-- [--step N] [--from ROW [--first N]] SCENE...]`
//!
//! For a renderer and its first frame, for a pass that takes casters and sizes and whose lists grow from one element, and for `plane`
//! for a pass as it is made; both facet modes, and both ways to refuse. Each time there must be one clear error, or none where the
//! library goes around it, and the frame after it must be that of an untroubled run, bit for bit. The exit status is 1 if not.
//! `--from ROW` begins at that row of the table (0 is its first), `--first N` at that request of it, for a
//! run that was cut off; where a row is, standard error says every minute.

use lab::scene::{BUILTIN_NAMES, Scene, builtin};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::gpu::faults::Refusal;
use subpixel_shadows::methods::FacetMode;
use subpixel_shadows::{Error, Result};
use test_support::refused::{self, Told};

/// What is refused: a device, a scene, one or all facets a pixel, the first request and how many there are between two, and by whom.
type Work = fn(&Gpu, &Scene, FacetMode, u64, u64, Refusal) -> Result<Told>;

fn main() {
    if let Err(error) = run() {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

fn run() -> Result<()> {
    let mut asked: Vec<String> = std::env::args().skip(1).collect();
    let step = number(&mut asked, "--step", 1)?;
    let from = number(&mut asked, "--from", 0)?;
    let mut first = number(&mut asked, "--first", 0)?;
    let mut row = 0;
    let names: Vec<&str> =
        if asked.is_empty() { BUILTIN_NAMES.to_vec() } else { asked.iter().map(String::as_str).collect() };
    let gpu = Gpu::open(None)?;
    println!(
        "| scene | facets | of | refused by | requests | refused | without an error |\n|---|---|---|---|---|---|---|"
    );
    for name in names {
        let scene = builtin(name).ok_or_else(|| Error::Config(format!("no built-in scene {name}")))?;
        for facets in [FacetMode::One, FacetMode::All] {
            for (what, work) in [
                ("renderer", refused::renderer as Work),
                ("pass", refused::pass as Work),
                ("new pass", refused::new_pass as Work),
            ] {
                // Pipelines are made anew for each request.
                if what == "new pass" && name != "plane" {
                    continue;
                }
                for refusal in [Refusal::Device, Refusal::Limit] {
                    row += 1;
                    if row <= from {
                        continue;
                    }
                    let told = work(&gpu, &scene, facets, std::mem::take(&mut first), step, refusal)
                        .map_err(|e| Error::Config(format!("{name}, {facets:?}, {what}, {refusal:?}: {e}")))?;
                    let Told { asked, refused, absorbed } = told;
                    println!("| {name} | {facets:?} | {what} | {refusal:?} | {asked} | {refused} | {absorbed} |");
                }
            }
        }
    }
    Ok(())
}

/// Takes `option NUMBER` out of the words; `least` without it.
fn number(words: &mut Vec<String>, option: &str, least: u64) -> Result<u64> {
    let Some(at) = words.iter().position(|word| word == option) else { return Ok(least) };
    let number = words.get(at + 1).and_then(|text| text.parse().ok()).filter(|&n| n >= least);
    let number = number.ok_or_else(|| Error::Config(format!("{option} needs a number from {least} on")))?;
    words.drain(at..at + 2);
    Ok(number)
}
