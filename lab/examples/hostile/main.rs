//! Damaged files of every format and extremes of every option against the loaders, the CPU engine and the built
//! program:
//! `cargo build --release && cargo run --release --example hostile -- [--cases N] [--seed S] [--program N] [--gpu N]
//! [--limit SECONDS] [--options on|off] [--keep DIR] [--page FILE]`
//!
//! Of `--cases` files each is opened and rendered in this process; `--program` of them also go through the program on
//! the CPU engine, and `--gpu` of those that can be read on the GPU. No case may panic, take longer than `--limit`,
//! end with another status than is documented, say more or less than one line, or leave anything half-written. Files
//! that do are kept in `--keep`. Exit status 1 if there are any.

mod files;
mod options;
mod process;

use process::Program;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;
use subpixel_shadows::{Error, Result};

/// What is asked for.
struct Arguments {
    cases: usize,
    seed: u64,
    program: usize,
    gpu: usize,
    limit: u64,
    options: bool,
    keep: PathBuf,
    page: Option<PathBuf>,
}

impl Arguments {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self> {
        let mut found = Self {
            cases: 10_000,
            seed: 1,
            program: 1000,
            gpu: 50,
            limit: process::LIMIT.as_secs(),
            options: true,
            keep: PathBuf::from("target/hostile"),
            page: None,
        };
        while let Some(word) = words.next() {
            let value = words.next().ok_or_else(|| Error::Config(format!("{word} needs a value")))?;
            let number = || value.parse::<u64>().map_err(|e| Error::Config(format!("'{value}': {e}")));
            match word.as_str() {
                "--cases" => found.cases = number()? as usize,
                "--seed" => found.seed = number()?,
                "--program" => found.program = number()? as usize,
                "--gpu" => found.gpu = number()? as usize,
                "--limit" => found.limit = number()?,
                "--options" => found.options = value == "on",
                "--keep" => found.keep = value.into(),
                "--page" => found.page = Some(value.into()),
                _ => return Err(Error::Config(format!("no option {word}"))),
            }
        }
        Ok(found)
    }
}

fn run() -> Result<bool> {
    let arguments = Arguments::read(std::env::args().skip(1))?;
    let program = Program::find(Duration::from_secs(arguments.limit))?;
    let adapter = program.adapter();
    let given = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    let mut page = format!(
        "# Hostile files and options\n\n`cargo build --release && cargo run --release --example hostile -- {given}`\n\n\
         {}\n\n",
        match &adapter {
            Some(name) => format!("GPU cases on {name}."),
            None => "No adapter: no GPU cases.".to_owned(),
        }
    );
    let gpu = if adapter.is_some() { arguments.gpu } else { 0 };
    let files = files::run(&arguments, &program, gpu)?;
    page += &files.text;
    let mut failures = files.failures;
    if arguments.options {
        let options = options::run(&program, adapter.is_some())?;
        page += &options.text;
        failures += options.failures;
    }
    page += &load();
    println!("{page}");
    if let Some(path) = &arguments.page {
        lab::report::write_text(path, &page)?;
    }
    Ok(failures == 0)
}

/// Other work of the machine, where the system tells: times are longer for it.
fn load() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    text.split(' ').next().filter(|l| !l.is_empty()).map_or(String::new(), |l| {
        format!("\nAt the end {l} programs at a time wanted the machine's {threads} threads.\n")
    })
}

/// A part of the page, and how many of its cases failed.
struct Section {
    text: String,
    failures: usize,
}

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("hostile: {error}");
            ExitCode::from(1)
        }
    }
}
