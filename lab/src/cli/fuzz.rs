//! `fuzz`: random worlds.

use super::args::FuzzOptions;
use super::output::OutFolder;
use super::progress::Console;
use super::table::{Report, grouped};
use lab::fuzz::{FuzzDevice, FuzzProgress, Run, run as run_cases};
use lab::report::comparison::Machine;
use lab::report::write_text;
use std::process::ExitCode;
use std::time::Duration;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;

/// Runs the cases, writes what fails, prints the table. Exit status 1 if anything failed.
pub fn run(options: &FuzzOptions) -> Result<ExitCode> {
    let console = Console::new(options.quiet);
    OutFolder::check(&options.out)?;
    let gpu = Gpu::open(options.adapter.as_deref())?;
    let machine = Machine::of(&gpu.adapter);
    let bench = FuzzDevice::new(&gpu);
    let patience = options.minutes.map(|m| Duration::from_secs_f64(60.0 * m));
    let endless = if patience.is_some() { u64::MAX } else { 1000 };
    let asked = Run {
        seed: options.seed,
        first: options.first,
        cases: options.cases.unwrap_or(endless),
        patience,
        out: Some(options.out.clone()),
        shrink: Duration::from_secs(options.shrink),
    };
    let start = std::time::Instant::now();
    let summary = {
        let task = console.task("fuzz");
        run_cases(&bench, &asked, &mut |progress| match progress {
            FuzzProgress::Done(done, of) if of == u64::MAX => {
                let share = patience.map_or(0.0, |p| start.elapsed().as_secs_f64() / p.as_secs_f64());
                task.at(((share * 1000.0) as usize).min(1000).max(usize::from(done > 0)), 1000);
            }
            FuzzProgress::Done(done, of) => task.at(done as usize, of as usize),
            FuzzProgress::Failed(failure) => {
                let [seed, number] = failure.case;
                let faults: Vec<String> =
                    failure.faults.iter().map(|(f, n, at)| format!("{}: {n}; {at}", f.name())).collect();
                let kind = failure.kind.name();
                console.note(&format!("case {number} of seed {seed} ({kind}) failed: {}", faults.join(", ")));
                if let Some((command, [triangles, pixels])) = &failure.repeat {
                    console.note(&format!("shrunk to {triangles} triangles and {pixels} pixels: {command}"));
                }
            }
        })?
    };
    let mut report = Report::default();
    report.line("adapter", &machine.line());
    report.table(&summary.rows(grouped), &[1, 2, 3, 4, 5, 6, 7, 8, 9]);
    report.text(&summary.line());
    for (reason, count) in &summary.refusals {
        report.text(&format!("refused {count} times: {reason}"));
    }
    for failure in &summary.failures {
        let [seed, number] = failure.case;
        let how = match &failure.repeat {
            Some((command, _)) => command.clone(),
            None => format!("subpixel-shadows fuzz --seed {seed} --first {number} --cases 1"),
        };
        report.text(&format!("failed: {how}"));
    }
    if let Some(page) = &options.page {
        let command = super::command_line();
        write_text(page, &summary.markdown(&command, &machine.line(), grouped))?;
        report.text(&format!("wrote {}", page.display()));
    }
    report.print()?;
    Ok(if summary.failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
