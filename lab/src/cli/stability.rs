//! `stability`: stiff and extreme cases.

use super::args::{StabilityOptions, or_all};
use super::output::OutFolder;
use super::progress::Console;
use super::table::Report;
use lab::report::comparison::Machine;
use lab::report::stability::{Outcome, markdown, named, row, run as run_case, summary, variants};
use lab::report::write_text;
use std::time::Instant;
use subpixel_shadows::gpu::{Gpu, KeptPrograms};
use subpixel_shadows::{Error, Result};

/// Runs the cases, writes the page and the rows, prints what is not as it must be.
pub fn run(options: &StabilityOptions) -> Result<()> {
    let start = Instant::now();
    let console = Console::new(options.quiet);
    let settings = options.settings()?;
    let cases = named(&options.cases)?;
    let variants = variants(&settings, &or_all(&options.methods))?;
    OutFolder::check(&options.out)?;
    let gpu = Gpu::open(options.adapter.as_deref())?;
    let machine = Machine::of(&gpu.adapter);
    let kept = KeptPrograms::default();
    let mut outcomes: Vec<Outcome> = Vec::new();
    {
        let task = console.task("stability");
        for (k, case) in cases.iter().enumerate() {
            outcomes.extend(run_case(&gpu, &kept, case, &variants)?);
            task.at(k + 1, cases.len());
        }
    }
    let command = super::command_line();
    let json = serde_json::to_string_pretty(&serde_json::json!({ "machine": machine, "outcomes": outcomes }));
    let json = json.map_err(|e| Error::file(&options.out, e.to_string()))?;
    let files = OutFolder::fill(&options.out, |out| {
        write_text(&out.file("stability.md"), &markdown(&command, &machine.line(), &cases, &outcomes))?;
        write_text(&out.file("stability.json"), &json)
    })?;
    let mut report = Report::default();
    report.line("adapter", &machine.line());
    report.table(&summary(&outcomes), &[1, 2, 3, 4, 5, 6, 8, 9, 10]);
    let bad: Vec<Vec<String>> =
        outcomes.iter().filter(|o| !o.holds()).map(|o| [vec![o.case.to_owned()], row(o)].concat()).collect();
    if bad.is_empty() {
        report.text("\nall frames are as they must be: no wrong sample where none may be, shares from 0 to 1, the same bits where they must be");
    } else {
        report.text("\nnot as they must be:");
        report.table(&bad, &[]);
    }
    let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
    report.text(&format!("\nwrote {}\nin {:.0} s", names.join(", "), start.elapsed().as_secs_f64()));
    report.print()
}
