//! The viewer in a window.

#[cfg(not(target_family = "wasm"))]
mod window;

#[cfg(not(target_family = "wasm"))]
fn main() -> std::process::ExitCode {
    window::main()
}

/// The page begins in the library.
#[cfg(target_family = "wasm")]
fn main() {}
