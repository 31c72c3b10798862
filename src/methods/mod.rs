//! The methods: each a page of calls to stages, in order.

#[cfg(feature = "baselines")]
pub mod any;
#[cfg(feature = "oracle")]
pub mod cpu;
pub mod every_surface;
pub mod facet_masks;
#[cfg(feature = "baselines")]
pub mod fixed;
pub mod geometry;
pub mod growth;
pub mod light_maps;
#[cfg(feature = "baselines")]
pub mod looks;
pub mod names;
pub mod options;
pub mod prepared;
#[cfg(feature = "baselines")]
pub mod ray_traced;
pub mod render;
pub mod settings;
#[cfg(feature = "baselines")]
pub mod settled;
#[cfg(feature = "baselines")]
pub mod shadow_map;
#[cfg(feature = "baselines")]
pub mod split_mapping;
#[cfg(feature = "baselines")]
pub mod spsm;
pub mod strips;
#[cfg(feature = "baselines")]
pub mod supersampled;
#[cfg(feature = "baselines")]
pub mod unshadowed;

#[cfg(feature = "baselines")]
pub use any::AnyRenderer;
pub use facet_masks::FacetMasks;
#[cfg(feature = "baselines")]
pub use looks::{Looks, MapLook, PixelClass};
pub use names::{METHODS, MethodName, MethodRow};
pub use options::{METHOD_OPTIONS, MethodOption};
pub use prepared::Prepared;
pub use settings::{
    FacetMode, PairVariant, ProjectionVariant, RayTracedSettings, Settings, ShadowMapSettings, SmsrSettings, SmsrShape,
    SplitSettings, SpsmEncoding, SpsmSettings,
};
