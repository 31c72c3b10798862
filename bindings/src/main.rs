//! Writes `src/gpu/kernels.rs` of the repository.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let file = root.join(bindings::FILE);
    let written = bindings::generate(&root)
        .and_then(|text| std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display())));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
