//! The program: a thin layer over the library.

#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::todo,
        clippy::unimplemented,
        clippy::unreachable
    )
)]

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
