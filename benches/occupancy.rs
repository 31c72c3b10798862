//! `cargo bench --bench occupancy [-- --page FILE]` runs the package `benches/occupancy`: it calls Vulkan itself, which needs unsafe code, and
//! what it needs of naga is not for the library's own builds.

use std::process::{Command, ExitCode};

fn main() -> ExitCode {
    let run = ["run", "--release", "--quiet", "-p", "subpixel-shadows-occupancy", "--"];
    // `cargo bench` gives `--bench` to every benchmark.
    let args = std::env::args().skip(1).filter(|arg| arg != "--bench");
    match Command::new(env!("CARGO")).args(run).args(args).current_dir(env!("CARGO_MANIFEST_DIR")).status() {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("cargo: {e}");
            ExitCode::FAILURE
        }
    }
}
