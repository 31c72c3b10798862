//! The methods: each a page of calls to stages, in order.

pub mod any;
pub mod cpu;
pub mod every_surface;
pub mod facet_masks;
pub mod fixed;
pub mod geometry;
pub mod growth;
pub mod light_maps;
pub mod looks;
pub mod names;
pub mod options;
pub mod prepared;
pub mod ray_traced;
pub mod render;
pub mod settings;
pub mod settled;
pub mod shadow_map;
pub mod split_mapping;
pub mod spsm;
pub mod strips;
pub mod supersampled;
pub mod unshadowed;

pub use any::AnyRenderer;
pub use facet_masks::FacetMasks;
pub use looks::{Looks, MapLook, PixelClass};
pub use names::{METHODS, MethodName, MethodRow};
pub use options::{METHOD_OPTIONS, MethodOption};
pub use prepared::Prepared;
pub use settings::{
    FacetMode, PairVariant, ProjectionVariant, RayTracedSettings, Settings, ShadowMapSettings, SmsrSettings, SmsrShape,
    SplitSettings, SpsmEncoding, SpsmSettings,
};
