//! What the kernels of [`subpixel_shadows`] are held against, none of which knows a GPU.
//!
//! - [`mod@reference`]: the definition of each stage, by its stem.
//! - [`truth`]: what rays see, decided in `f64`.
//! - [`engine`]: `facet-masks` on the CPU, made of those definitions.

pub mod engine;
pub mod reference;
pub mod truth;
