//! Definitions and truth that the kernels of [`subpixel_shadows`] are held against; nothing here knows a GPU.
//!
//! - [`mod@reference`]: the definition of each stage, by its stem.
//! - [`truth`]: what rays see, decided in `f64`.
//! - [`engine`]: `facet-masks` on the CPU, made of those definitions.

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

pub mod engine;
pub mod reference;
pub mod truth;
