//! Sub-pixel antialiased hard shadows, computed entirely in wgpu compute kernels.
//!
//! The flagship method is `facet-masks` (Pan, Wang, Chen, Zhou, Bao: *Fast, Sub-pixel Antialiased Shadow Maps*,
//! Pacific Graphics 2009): facets represent each pixel, blockers are projected onto them as half-planes, and
//! one bit per sample records what is occluded. Every stage is a WGSL compute kernel over GPU buffers, and is tested against a CPU definition
//! that knows nothing of the GPU (`oracle/`, a package of its own, as is the program, `lab/`).
//!
//! [`ShadowPass`] is what an engine takes; [`stages`] are public and usable alone; [`guide`] tells of both. Dependencies run one way:
//! `render` → `pass` → `plan` → `methods` → `stages` → `gpu`.

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

#[cfg(feature = "baselines")]
pub mod caster_tree;
pub mod error;
pub mod frame;
pub mod gpu;
pub mod guide;
pub mod light_view;
pub mod mask_table;
pub mod methods;
pub mod pass;
pub mod pixel_filter;
pub mod plan;
pub mod render;
pub mod samples;
pub mod scene;
pub mod spsm_code;
pub mod stages;
pub mod status;
pub mod tap_disc;
#[cfg(test)]
mod test_scenes;

pub use error::{Error, Result};
pub use glam;
pub use pass::ShadowPass;
pub use wgpu;

/// The example of the README, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
