//! The words that options take.

use clap::ValueEnum;
use subpixel_shadows::methods::FacetMode;
use subpixel_shadows::samples::Pattern;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Encoding {
    Paper,
    #[default]
    Lines,
}

/// Where `spsm` searches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Search {
    Near,
    Wide,
    #[default]
    Along,
}

/// Samples that `ray-traced` follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RayChoice {
    /// All of pixels that face the light.
    #[default]
    All,
    /// Those of pixels that are not proved lit or shadowed.
    Silhouettes,
}

/// Where `smsr` draws lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Shape {
    /// From the corners of dark texels to the far ends of borders.
    Corners,
    /// Through the middles of the steps.
    #[default]
    Midpoints,
}

/// How the texels of a map lie over a slice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum WarpBy {
    /// Evenly, over the box around what is seen.
    Even,
    /// Over a trapezoid around it, 80 % of whose rows go to the first part.
    Trapezoid,
    /// As is best for a frustum and a light from the side.
    Lispsm,
    /// As makes texels the smallest beside pixels.
    #[default]
    Fitted,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum FacetsPerPixel {
    One,
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

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    #[default]
    On,
    Off,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MaskChoice {
    #[default]
    Exact,
    Table,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PairsBy {
    #[default]
    Tiled,
    Grouped,
    Sorted,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Projection {
    #[default]
    Pencil,
    TwoStep,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EngineName {
    Gpu,
    Cpu,
}

#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum PatternName {
    Grid,
    Rotated,
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
