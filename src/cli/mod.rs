//! The command line: `render`, `explain`, `report`, `stability`, `adapters`.

mod adapters;
mod args;
mod choices;
mod engine;
mod explain;
mod held;
mod output;
mod progress;
mod render;
mod repeat;
mod report;
mod stability;
mod table;

use args::{Cli, Command};
use clap::Parser;
use std::io::Write;
use std::process::ExitCode;
use subpixel_shadows::Result;

/// Reads the command line and runs it. Exit status: 0 done, 1 bad input, 2 usage (by clap), 3 the GPU failed.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(told) => return usage(&told),
    };
    let done = match cli.command {
        Some(Command::Render { scene, options }) => render::run(scene.as_deref(), &options),
        Some(Command::Explain { scene, options }) => explain::run(scene.as_deref(), &options),
        Some(Command::Report { options }) => report::run(&options),
        Some(Command::Stability { options }) => stability::run(&options),
        Some(Command::Adapters { check }) => adapters::run(check),
        None => render::run(None, &cli.options),
    };
    status(done)
}

/// The exit status, after a line about what failed.
fn status(done: Result<()>) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            progress::complain(&error.to_string());
            ExitCode::from(if error.is_gpu() { 3 } else { 1 })
        }
    }
}

/// Prints help, version or what is wrong with the command line.
fn usage(told: &clap::Error) -> ExitCode {
    let printed = told.print().and_then(|()| std::io::stdout().flush());
    if told.use_stderr() { ExitCode::from(2) } else { status(table::told(printed)) }
}
