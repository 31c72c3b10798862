//! `cargo bench --bench occupancy [-- --page FILE]`: what AMD's compiler makes of every pipeline, printed or written as a page.

use occupancy::families::{Job, compile, measure};
use occupancy::{limits, made, page};
use std::process::ExitCode;

fn run(args: &[&str]) -> Result<(), String> {
    let file = match args {
        ["compile"] => return compile(),
        [] => None,
        ["--page", file] => Some(*file),
        _ => return Err("usage: cargo bench --bench occupancy [-- --page FILE]".to_owned()),
    };
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let reports = measure(&program, &Job::of(made::pipelines()?))?;
    match file {
        Some(file) => std::fs::write(file, page::page(&reports)).map_err(|e| format!("{file}: {e}"))?,
        None => reports.iter().for_each(|report| println!("{}\n{}", report.driver, page::table(report))),
    }
    limits::faults(&reports, limits::EXCEPTIONS).iter().for_each(|fault| println!("{fault}"));
    Ok(())
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match run(&args.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("occupancy: {message}");
            ExitCode::FAILURE
        }
    }
}
