//! Sub-pixel antialiased hard shadows, computed entirely in wgpu compute kernels.
//!
//! The flagship method is `facet-masks` (Pan, Wang, Chen, Zhou, Bao: *Fast, Sub-pixel Antialiased Shadow Maps*,
//! Pacific Graphics 2009): facets represent each pixel, blockers are projected onto them as half-planes, and
//! one bit per sample records what is occluded. Every stage is a WGSL compute kernel over GPU buffers, and every stage
//! has a CPU definition in [`mod@reference`] that knows nothing of the GPU.
//!
//! Dependencies run one way: `cli` → `report` → `render` → `pass` → `plan` → `methods` → `stages` → `gpu`; `reference` and `truth` know no GPU.

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
#[cfg(feature = "report")]
pub mod fuzz;
pub mod gpu;
pub mod guide;
pub mod light_view;
pub mod mask_table;
pub mod methods;
pub mod pass;
pub mod plan;
#[cfg(feature = "oracle")]
pub mod reference;
pub mod render;
#[cfg(feature = "report")]
pub mod report;
pub mod samples;
pub mod scene;
pub mod spsm_code;
pub mod stages;
pub mod status;
#[cfg(feature = "oracle")]
pub mod truth;

pub use error::{Error, Result};
pub use glam;
pub use pass::ShadowPass;
pub use wgpu;

/// The example of the README, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
