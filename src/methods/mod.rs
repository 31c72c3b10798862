//! The methods: each a page of calls to stages, in order.

mod axis_settings;
#[cfg(feature = "baselines")]
pub mod by_views;
#[cfg(feature = "baselines")]
pub mod debug_views;
#[cfg(feature = "baselines")]
pub mod deep_mapping;
#[cfg(feature = "baselines")]
pub mod early_out;
pub mod every_surface;
pub mod facet_masks;
#[cfg(feature = "baselines")]
pub mod fixed_memory;
pub mod geometry;
pub mod history;
pub mod light_maps;
pub mod list_sizing;
pub mod names;
pub mod output;
mod page_settings;
#[cfg(feature = "baselines")]
pub mod polygon_mapping;
pub mod prepared;
mod prepared_bytes;
#[cfg(feature = "baselines")]
pub mod ray_traced;
#[cfg(feature = "baselines")]
pub mod reconstructable;
#[cfg(feature = "baselines")]
pub mod rectilinear;
#[cfg(feature = "baselines")]
pub mod resolution_matched;
pub mod settings;
#[cfg(feature = "baselines")]
pub mod shadow_map;
#[cfg(feature = "baselines")]
pub mod silhouette_mapping;
#[cfg(feature = "baselines")]
pub mod spsm;
pub mod strip_method;
pub mod strips;
#[cfg(feature = "baselines")]
pub mod supersampled;
mod texel_query;
pub mod texel_settings;

pub use crate::pixel_filter::PixelFilter;
pub use crate::stages::page_requests::PageRule;
#[cfg(feature = "baselines")]
pub use debug_views::{DebugMap, DebugViews, PixelClass};
pub use facet_masks::FacetMasks;
pub use history::HistorySettings;
pub use names::{METHOD_OPTIONS, METHODS, MapQuery, MethodName, MethodRow, TexelQuery};
pub use prepared::Prepared;
pub use settings::{
    AxisSettings, DeepSettings, DensityRule, DiscFilter, FacetMode, MomentSettings, PageSettings, PairVariant,
    PolygonIdSettings, ProjectionVariant, RayTracedSettings, ReconstructableSettings, Settings, ShadowMapSettings,
    SmsrSettings, SmsrShape, SpsmEncoding, SpsmSettings,
};
