//! Promises of methods for their samples.

use serde::Serialize;
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::{MethodName, ProjectionVariant, Settings};

/// The promise of a method for its samples, besides shares in `[0, 1]` and the same bits every time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Promise {
    /// Each is right where it is farther than 1/256 pixel from every edge.
    Exact,
    /// Each is asked, but the answer may be rounded: from a table of masks, by two projections.
    Rounded,
    /// None: the answer is of texels.
    Texels,
}

impl Promise {
    /// That of a method with these settings.
    pub fn of(method: MethodName, settings: &Settings) -> Self {
        let exact = settings.masks == MaskVariant::Exact && settings.projection == ProjectionVariant::Pencil;
        match method {
            MethodName::FacetMasks if !exact => Self::Rounded,
            MethodName::FacetMasks | MethodName::RayTraced | MethodName::Supersampled => Self::Exact,
            _ => Self::Texels,
        }
    }
}
