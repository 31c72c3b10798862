//! The command line: `render`, `explain`, `report`, `stability`, `fuzz`, `adapters`.

mod adapters;
mod args;
mod choices;
mod engine;
mod explain;
mod fuzz;
mod output;
mod progress;
mod render;
mod repeat;
mod report;
mod stability;
mod table;

use args::{Cli, Command};
use clap::Parser;
use std::process::ExitCode;

/// Reads the command line and runs it. Exit status: 0 done, 1 bad input, 2 usage (by clap), 3 the GPU failed.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match cli.command {
        Some(Command::Fuzz { options }) => return finish(fuzz::run(&options)),
        Some(Command::Render { scene, options }) => render::run(scene.as_deref(), &options),
        Some(Command::Explain { scene, options }) => explain::run(scene.as_deref(), &options),
        Some(Command::Report { options }) => report::run(&options),
        Some(Command::Stability { options }) => stability::run(&options),
        Some(Command::Adapters { check }) => adapters::run(check),
        None => render::run(None, &cli.options),
    };
    finish(done.map(|()| ExitCode::SUCCESS))
}

fn finish(done: subpixel_shadows::Result<ExitCode>) -> ExitCode {
    match done {
        Ok(code) => code,
        Err(error) => {
            progress::complain(&error.to_string());
            ExitCode::from(if error.is_gpu() { 3 } else { 1 })
        }
    }
}
