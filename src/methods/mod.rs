//! The methods: each a page of calls to stages, in order.

pub mod cpu;
pub mod every_surface;
pub mod facet_masks;
pub mod prepared;
pub mod render;
pub mod unshadowed;

pub use facet_masks::{FacetMasks, Settings};
pub use prepared::Prepared;
