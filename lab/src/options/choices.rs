//! The words that options take.

use clap::ValueEnum;
use subpixel_shadows::light_view::{OmniMaps, PartBy};
use subpixel_shadows::methods::{DensityRule, FacetMode, PageRule};
use subpixel_shadows::pixel_filter::PixelFilter;
use subpixel_shadows::samples::Pattern;
use subpixel_shadows::stages::compared_depths::DepthRule;

/// How `spsm` packs a triangle into a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Encoding {
    /// Vertices over the map, as in the paper
    Paper,
    /// Edge lines relative to the texel
    #[default]
    Lines,
}

/// Where `spsm` searches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Search {
    /// 3 x 3 texels
    Near,
    /// 5 x 5 texels
    Wide,
    /// 3 x 3 texels, and two more to either side along the shadow's border
    #[default]
    Along,
}

/// Samples that `ray-traced` follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RayChoice {
    /// All of pixels that face the light
    #[default]
    All,
    /// Those of pixels that are not proved lit or shadowed
    Silhouettes,
}

/// The depth of a texel that samples are compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Compare {
    /// The nearest, moved by a bias
    #[default]
    Nearest,
    /// Half way to the second nearest
    Midpoint,
    /// The second nearest
    Second,
    /// Half way, but no more than a twentieth of the casters' extent beyond the nearest
    Dual,
}

impl From<Compare> for Option<DepthRule> {
    fn from(name: Compare) -> Self {
        match name {
            Compare::Nearest => None,
            Compare::Midpoint => Some(DepthRule::Midpoint),
            Compare::Second => Some(DepthRule::Second),
            Compare::Dual => Some(DepthRule::DUAL),
        }
    }
}

/// Rule by which pages of `resolution-matched` are asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PagesBy {
    /// Those that a pixel's samples touch, as fine as it is
    #[default]
    Matched,
    /// These where a silhouette is near in the map, elsewhere no finer ones than the map
    Edges,
    /// All of a cell of the view, as fine as the finest that is asked for in it
    Fitted,
    /// All of a cell of the view, as fine as its share of them by the pixels in it, those near silhouettes first
    Tiled,
    /// Finer and finer ones, as long as that changes what pixels see
    Queried,
}

impl From<PagesBy> for PageRule {
    fn from(name: PagesBy) -> Self {
        match name {
            PagesBy::Matched => Self::Matched,
            PagesBy::Edges => Self::Edges,
            PagesBy::Fitted => Self::Fitted,
            PagesBy::Tiled => Self::Tiled,
            PagesBy::Queried => Self::Queried,
        }
    }
}

/// Rule for the width of texels along an axis of `rectilinear`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DensityBy {
    /// The pixels: where one wants the most
    #[default]
    Requested,
    /// The distance from the eye, where any pixel wants texels
    Logarithmic,
}

impl From<DensityBy> for DensityRule {
    fn from(name: DensityBy) -> Self {
        match name {
            DensityBy::Requested => Self::Requested,
            DensityBy::Logarithmic => Self::Logarithmic,
        }
    }
}

/// Where `smsr` draws lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Shape {
    /// From the corners of dark texels to the far ends of borders
    Corners,
    /// Through the middles of the steps
    #[default]
    Midpoints,
}

/// Parts of what the camera sees that have a view of the light each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PartitionBy {
    /// Slices by depth
    #[default]
    Slices,
    /// Slices of the depths that pixels see
    SeenDepths,
    /// The faces of the view frustum that light passes
    FrustumFaces,
    /// Clusters of the objects that are seen
    ReceiverClusters,
}

impl From<PartitionBy> for PartBy {
    fn from(by: PartitionBy) -> Self {
        match by {
            PartitionBy::Slices => Self::Depth,
            PartitionBy::SeenDepths => Self::SeenDepth,
            PartitionBy::FrustumFaces => Self::FrustumFaces,
            PartitionBy::ReceiverClusters => Self::ReceiverClusters,
        }
    }
}

/// How the texels of a map lie over a slice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum WarpBy {
    /// Evenly, over the box around what is seen
    Even,
    /// Evenly, over a square that moves by whole texels as the camera moves
    Stable,
    /// Over a trapezoid around it, 80 % of whose rows go to the first part
    Trapezoid,
    /// As is best for a frustum and a light from the side
    Lispsm,
    /// The same from the eye itself
    Perspective,
    /// As makes texels the smallest beside pixels
    #[default]
    Fitted,
}

/// Maps of a light at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum OmniBy {
    /// On planes: one, or around a light among its casters those of a cube
    #[default]
    Planes,
    /// On one or two paraboloids
    Paraboloids,
}

impl From<OmniBy> for OmniMaps {
    fn from(by: OmniBy) -> Self {
        match by {
            OmniBy::Planes => Self::Planes,
            OmniBy::Paraboloids => Self::Paraboloids,
        }
    }
}

/// Facets of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FacetsPerPixel {
    /// One, as in the paper
    One,
    /// One for every surface that its samples see
    #[default]
    All,
}

impl From<FacetsPerPixel> for FacetMode {
    fn from(name: FacetsPerPixel) -> Self {
        match name {
            FacetsPerPixel::One => Self::One,
            FacetsPerPixel::All => Self::All,
        }
    }
}

/// On or off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// On
    #[default]
    On,
    /// Off
    Off,
}

/// How half-planes become masks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MaskChoice {
    /// Every sample is tested
    #[default]
    Exact,
    /// Looked up in a table of 256 directions and distances
    Table,
}

/// How pairs come together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PairsBy {
    /// By tiles of 2 x 2 texels, counted and written to their places
    #[default]
    Tiled,
    /// By texels, counted and written to their places
    Grouped,
    /// By texels, sorted, as in the paper
    Sorted,
}

/// How shadows become lines of the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Projection {
    /// Planes through the eye
    #[default]
    Pencil,
    /// The paper's two projections, which bound no rounding
    TwoStep,
}

/// How samples are weighted into a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum FilterBy {
    /// The pixel's own, all alike
    #[default]
    Box,
    /// Evenly falling over one pixel to either side
    Tent,
    /// A Gaussian of half a pixel, over one and a half to either side
    Gaussian,
    /// Mitchell and Netravali's cubic, over two pixels to either side
    Mitchell,
}

impl From<FilterBy> for PixelFilter {
    fn from(name: FilterBy) -> Self {
        match name {
            FilterBy::Box => Self::Box,
            FilterBy::Tent => Self::Tent,
            FilterBy::Gaussian => Self::Gaussian,
            FilterBy::Mitchell => Self::Mitchell,
        }
    }
}

/// Where a frame is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EngineName {
    /// On the adapter
    Gpu,
    /// On the CPU, in 64-bit numbers
    Cpu,
}

/// Where the samples of a pixel lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PatternName {
    /// On a grid
    Grid,
    /// On a rotated grid: no two in a row or column
    Rotated,
    /// As a low-discrepancy sequence has them
    #[default]
    LowDiscrepancy,
}

impl From<PatternName> for Pattern {
    fn from(name: PatternName) -> Self {
        match name {
            PatternName::Grid => Self::Grid,
            PatternName::Rotated => Self::Rotated,
            PatternName::LowDiscrepancy => Self::LowDiscrepancy,
        }
    }
}
