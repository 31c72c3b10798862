//! Typed bindings of the kernels: for each entry point a Rust struct with a field a binding, as naga finds them in WGSL.
//!
//! A kernel is `kernels/NAME.wgsl` with what it imports (`//@import NAME NAME`: files of the folders in `kernels/`). These say what they need
//! of the kernel (`//@needs var<storage, read> points: array<vec4<f32>>;`) and are parsed alone, too. Structs that the host shares with kernels
//! are found by their `shared_struct!` in `src/`.

mod alone;
mod kernel;
mod types;

pub use kernel::{Kernel, kernels};

use std::fmt::Write as _;
use std::path::Path;
use types::SharedStructs;

/// The file that [`generate`] makes, from the root of the repository.
pub const FILE: &str = "src/gpu/kernels.rs";

/// The text of [`FILE`], from the `kernels/` and `src/` of a repository.
///
/// # Errors
/// The first fault of a kernel, with its place.
pub fn generate(root: &Path) -> Result<String, String> {
    let structs = SharedStructs::read(&root.join("src"))?;
    let mut out = String::from(
        "//! Bindings, constants and texts of the kernels. Written by `cargo run -p subpixel-shadows-bindings`: change `kernels/` and run it again.\n\n",
    );
    let mut all = String::new();
    for kernel in kernels(&root.join("kernels"))? {
        let stem = &kernel.stem;
        kernel.write(&structs, &mut out).map_err(|e| format!("kernels/{stem}.wgsl: {e}"))?;
        let _ = writeln!(all, "    ({stem:?}, {stem}::SOURCE, {stem}::ENTRIES),");
    }
    let _ = writeln!(
        out,
        "/// Stem, text and entry points of every kernel.\npub const ALL: &[(&str, super::Source, &[super::program::Entry])] = &[\n{all}];"
    );
    Ok(out)
}
