//! The command line: `render`, `explain`, `report`, `stability`, `fuzz`, `methods`, `kernels`, `adapters`.

mod adapters;
mod args;
mod engine;
mod everything;
mod explain;
mod figure;
mod fuzz;
mod given;
mod held;
mod kernels;
mod merge;
mod methods;
mod output;
mod progress;
mod render;
mod repeat;
mod report;
mod rows;
mod stability;
mod table;

use args::{Cli, Command, ReportCommand};
use clap::{ArgMatches, CommandFactory, FromArgMatches};
use given::given;
use lab::options::RenderOptions;
use lab::scene::Scene;
use std::io::Write;
use std::process::ExitCode;
use subpixel_shadows::Result;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::scene::Light;

/// Reads the command line and runs it. Exit status: 0 done, 1 bad input, 2 usage (by clap), 3 the GPU failed.
pub fn main() -> ExitCode {
    let parsed = Cli::command().try_get_matches();
    let (matches, cli) = match parsed.and_then(|matches| Cli::from_arg_matches(&matches).map(|cli| (matches, cli))) {
        Ok(parsed) => parsed,
        Err(told) => return usage(&told),
    };
    let matches = matches.subcommand().map_or(&matches, |(_, of_command)| of_command);
    let done = match cli.command {
        Some(Command::Fuzz { options }) => return finish(fuzz::run(&options)),
        Some(Command::Render { scene, options }) => with(matches, scene, options, render::run),
        Some(Command::Explain { scene, options }) => with(matches, scene, options, explain::run),
        Some(Command::Report { command, options }) => match command {
            Some(ReportCommand::Figure { options }) => figure::run(&options),
            Some(ReportCommand::Everything { options }) => everything::run(&options),
            Some(ReportCommand::Merge { options }) => merge::run(&options),
            None => report::run(&options),
        },
        Some(Command::Stability { options }) => stability::run(&options),
        Some(Command::Methods { json }) => methods::run(json),
        Some(Command::Kernels { out }) => kernels::run(&out),
        Some(Command::Adapters { check }) => adapters::run(check),
        None => with(matches, None, cli.options, render::run),
    };
    finish(done.map(|()| ExitCode::SUCCESS))
}

/// The command that runs, as a page tells it.
fn command_line() -> String {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    format!("cargo run --release -- {}", arguments.join(" "))
}

/// The exit status, after a line about what failed.
fn status(done: Result<()>) -> ExitCode {
    finish(done.map(|()| ExitCode::SUCCESS))
}

fn finish(done: Result<ExitCode>) -> ExitCode {
    match done {
        Ok(code) => code,
        Err(error) => {
            progress::complain(&error.to_string());
            ExitCode::from(if error.is_gpu() { 3 } else { 1 })
        }
    }
}

/// The scene that was asked for, after a note on what its file holds that is not read.
fn opened(options: &RenderOptions, scene: Option<&str>, console: progress::Console) -> Result<Scene> {
    let (scene, note) = options.open(scene)?;
    note.iter().for_each(|note| console.note(note));
    Ok(scene)
}

/// The points of the light, and a plan that holds for all of them: that of the first that shadows anything, or of the first.
fn planned(options: &RenderOptions, scene: &Scene, prepared: &Prepared) -> Result<(Vec<Light>, Plan)> {
    let points = options.points(&scene.light, prepared.mesh())?;
    let settings = options.settings()?;
    let of = |light| Plan::of_method(options.method, prepared, &scene.camera, light, &settings, options.force_all);
    let mut plan = of(&points[0])?;
    for light in &points[1..] {
        if plan.extent != Extent::Facing {
            break;
        }
        plan = of(light)?;
    }
    Ok((points, plan))
}

/// Runs `command` with what was given.
fn with(
    matches: &ArgMatches,
    scene: Option<String>,
    options: RenderOptions,
    command: impl FnOnce(Option<&str>, &RenderOptions) -> Result<()>,
) -> Result<()> {
    let (scene, options) = given(matches, scene, options)?;
    command(scene.as_deref(), &options)
}

/// Prints help, version or what is wrong with the command line.
fn usage(told: &clap::Error) -> ExitCode {
    let printed = told.print().and_then(|()| std::io::stdout().flush());
    if told.use_stderr() { ExitCode::from(2) } else { status(table::told(printed)) }
}
