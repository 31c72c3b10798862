//! Damaged files: opened and rendered here, and some of them by the program.

#[path = "../../tests/shared/hostile.rs"]
mod hostile;

use super::process::{LIMIT, Program};
use super::{Arguments, Section};
use hostile::{Folder, Random, is_one_line_that_names, sound, write_companions};
use lab::scene::{Scene, SceneOptions};
use oracle::engine::{self, CpuRequest};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};
use subpixel_shadows::methods::Settings;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result};

/// The fate of a file.
enum Outcome {
    Read,
    Refused(String),
    Failed(String),
}

/// A thread that opens and renders files; one that hangs is left alone.
struct Worker {
    paths: Sender<PathBuf>,
    outcomes: Receiver<Outcome>,
}

impl Worker {
    fn start() -> Self {
        let (paths, inbox) = channel::<PathBuf>();
        let (outbox, outcomes) = channel();
        std::thread::spawn(move || {
            while let Ok(path) = inbox.recv() {
                let outcome = catch_unwind(AssertUnwindSafe(|| look(&path)));
                if outbox.send(outcome.unwrap_or_else(|_| Outcome::Failed("panics".to_owned()))).is_err() {
                    break;
                }
            }
        });
        Self { paths, outcomes }
    }

    fn outcome(&self, path: &Path) -> Option<Outcome> {
        self.paths.send(path.to_owned()).ok()?;
        self.outcomes.recv_timeout(LIMIT).ok()
    }
}

/// Opens a file and renders a small picture of it.
fn look(path: &Path) -> Outcome {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let done = || -> Result<bool> {
        let samples = Samples::new(Pattern::LowDiscrepancy, 8)?;
        let settings = Settings { cull_back: true, ..Settings::new([12, 9], 12, samples) };
        let scene = Scene::open(&path.to_string_lossy(), &SceneOptions::default())?;
        let prepared = scene.prepared()?;
        let frame = engine::render(&prepared, &settings, &scene.camera, &scene.light, CpuRequest::default())?;
        Ok(frame.output.visibility.iter().all(|v| (0.0..=1.0).contains(v)))
    };
    match done().map_err(|e| e.to_string()) {
        Ok(true) => Outcome::Read,
        Ok(false) => Outcome::Failed("has a visibility that is no share".to_owned()),
        Err(line) if is_one_line_that_names(&line, &name) => Outcome::Refused(line),
        Err(line) => Outcome::Failed(format!("is refused in other words than one line that names it: {line:?}")),
    }
}

/// Counts of one format.
#[derive(Clone, Default)]
struct Tally {
    cases: usize,
    read: usize,
    refused: usize,
    program: usize,
    gpu: usize,
    failed: usize,
    slowest: f64,
}

/// A message without the file and its numbers, so that those of one kind are the same.
fn kind(line: &str, name: &str) -> String {
    let after = line.split_once(name).map_or(line, |(_, after)| after).trim_start_matches(": ");
    let mut short = String::new();
    let mut quoted = false;
    for c in after.chars() {
        match c {
            '\'' | '`' => quoted = !quoted,
            _ if quoted => {}
            _ if c.is_ascii_digit() && short.ends_with('N') => {}
            _ if c.is_ascii_digit() => short.push('N'),
            _ => short.push(c),
        }
    }
    short.chars().take(60).collect()
}

pub fn run(arguments: &Arguments, program: &Program, gpu: usize) -> Result<Section> {
    let fault = |e: std::io::Error| Error::file("hostile", e.to_string());
    let folder = Folder::new("files").map_err(fault)?;
    write_companions(&folder.0).map_err(fault)?;
    let (sound, mut random) = (sound(), Random::new(arguments.seed));
    let mut tallies = vec![Tally::default(); sound.len()];
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    let mut failures = Vec::new();
    let mut worker = Worker::start();
    let (start, mut told, mut on_gpu) = (Instant::now(), Instant::now(), 0);
    // A share of the cases, spread evenly over all.
    let due = |case: usize, share: usize| case * share / arguments.cases != (case + 1) * share / arguments.cases;
    for case in 0..arguments.cases {
        let (which, bytes) = hostile::hostile(&sound, &mut random);
        let name = format!("{case}.{}", sound[which].extension);
        let path = folder.0.join(&name);
        std::fs::write(&path, &bytes).map_err(fault)?;
        let began = Instant::now();
        let outcome = worker.outcome(&path).unwrap_or_else(|| {
            worker = Worker::start();
            Outcome::Failed(format!("takes longer than {} s", LIMIT.as_secs()))
        });
        let tally = &mut tallies[which];
        tally.cases += 1;
        tally.slowest = tally.slowest.max(began.elapsed().as_secs_f64());
        let mut failed = None;
        match &outcome {
            Outcome::Read => tally.read += 1,
            Outcome::Refused(line) => {
                tally.refused += 1;
                *kinds.entry(kind(line, &name)).or_default() += 1;
            }
            Outcome::Failed(why) => failed = Some(why.clone()),
        }
        let expected = if matches!(outcome, Outcome::Read) { 0 } else { 1 };
        let small = ["--size", "12x9", "--map", "12", "--samples", "8", "--frames", "1", "--quiet", "--engine"];
        let through = |engine: &str| -> Result<Option<String>> {
            let mut words = vec!["render".to_owned(), path.to_string_lossy().into_owned()];
            words.extend(small.iter().chain([&engine]).map(|w| (*w).to_owned()));
            let ended = program.run(&words, &[expected])?;
            let named = expected == 0 || ended.line.contains(&name);
            let fault = ended.fault.or((!named).then(|| format!("is not named: {}", ended.line)));
            Ok(fault.map(|f| format!("{f} (program, {engine})")))
        };
        if failed.is_none() && due(case, arguments.program) {
            tally.program += 1;
            failed = through("cpu")?;
        }
        // Those that can be read are about a quarter; as soon as their turn has come.
        if failed.is_none() && expected == 0 && on_gpu < gpu && case * gpu >= on_gpu * arguments.cases {
            on_gpu += 1;
            tally.gpu += 1;
            failed = through("gpu")?;
        }
        if let Some(why) = failed {
            std::fs::create_dir_all(&arguments.keep).map_err(|e| Error::file(&arguments.keep, e.to_string()))?;
            let kept = arguments.keep.join(format!("{}-{name}", arguments.seed));
            std::fs::copy(&path, &kept).map_err(|e| Error::file(&kept, e.to_string()))?;
            tally.failed += 1;
            failures.push(format!("{}: {why}", kept.display()));
        }
        std::fs::remove_file(&path).map_err(fault)?;
        if told.elapsed() > Duration::from_secs(10) {
            told = Instant::now();
            eprintln!("hostile: {case} of {} files, {} failed", arguments.cases, failures.len());
        }
    }
    let text = page(arguments, &tallies, &sound.iter().map(|s| s.format).collect::<Vec<_>>(), &kinds, &failures, start);
    Ok(Section { text, failures: failures.len() })
}

fn page(
    arguments: &Arguments,
    tallies: &[Tally],
    formats: &[&str],
    kinds: &BTreeMap<String, usize>,
    failures: &[String],
    start: Instant,
) -> String {
    let mut text = format!(
        "## Files\n\n{} files, each made in code and damaged in 1 to 4 places (bits, bytes, numbers, words, lines,\n\
         pieces of other files, cuts; of half of them only numbers; every 16th is left sound), seed {}. Each is\n\
         opened and, if it can be read, rendered by the CPU engine at 12 x 9; some also go through the program.\n\
         {} failed. {:.0} s.\n\n",
        arguments.cases,
        arguments.seed,
        failures.len(),
        start.elapsed().as_secs_f64()
    );
    text += "| format | files | read | refused in one line | program, CPU | program, GPU | failed | slowest, ms |\n";
    text += "|---|---|---|---|---|---|---|---|\n";
    let mut all = Tally::default();
    let mut row = |name: &str, t: &Tally| {
        text += &format!(
            "| {name} | {} | {} | {} | {} | {} | {} | {:.0} |\n",
            t.cases,
            t.read,
            t.refused,
            t.program,
            t.gpu,
            t.failed,
            1e3 * t.slowest
        );
    };
    for (name, t) in formats.iter().zip(tallies) {
        row(name, t);
        all.cases += t.cases;
        all.read += t.read;
        all.refused += t.refused;
        all.program += t.program;
        all.gpu += t.gpu;
        all.failed += t.failed;
        all.slowest = all.slowest.max(t.slowest);
    }
    row("all", &all);
    let mut common: Vec<(&String, &usize)> = kinds.iter().collect();
    common.sort_by_key(|(_, n)| std::cmp::Reverse(**n));
    text += &format!("\n{} kinds of refusals (numbers and names taken out); the 25 most common:\n\n", kinds.len());
    for (line, n) in common.into_iter().take(25) {
        text += &format!("- {n} times `{}`\n", line.replace('`', "'"));
    }
    failures.iter().for_each(|f| text += &format!("\nFAILED: {f}\n"));
    text.push('\n');
    text
}
