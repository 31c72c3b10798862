//! Surroundings of the library: scenes, errors against truth, reports, random worlds. The program `subpixel-shadows` is a thin layer over it.
//!
//! Dependencies run one way: `cli` → `report`, `fuzz`, `options` → `scene`.

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

pub mod arguments;
pub mod fuzz;
pub mod options;
pub mod report;
pub mod scene;
