//! The methods by name: one row each.

use super::settings::Settings;
use crate::light_view::{SplitPlan, Warp};

/// The methods by their names, the same in API, program, reports and files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MethodName {
    /// `facet-masks`: Pan 2009, and with several facets a pixel beyond it.
    #[default]
    FacetMasks,
    /// `spsm`: Lecocq 2013.
    Spsm,
    /// `reconstructable`: Dai, Yang, Feng 2008.
    Reconstructable,
    /// `shadow-map`: Williams 1978.
    ShadowMap,
    /// `pcf`: Reeves, Salesin, Cook 1987.
    Pcf,
    /// `smsr`: Bondarev 2014.
    Smsr,
    /// `silhouette-map`: Sen, Cammarano, Hanrahan 2003.
    SilhouetteMap,
    /// `variance`: Donnelly and Lauritzen 2006.
    Variance,
    /// `layered-variance`: Lauritzen and McCool 2008.
    LayeredVariance,
    /// `convolution`: Annen, Mertens, Bekaert, Seidel, Kautz 2007.
    Convolution,
    /// `exponential`: Annen, Mertens, Seidel, Flerackers, Kautz 2008.
    Exponential,
    /// `exponential-variance`: Lauritzen and McCool 2008.
    ExponentialVariance,
    /// `four-moments`: Peters and Klein 2015.
    FourMoments,
    /// `trapezoidal`: Martin and Tan 2004.
    Trapezoidal,
    /// `lispsm`: Wimmer, Scherzer, Purgathofer 2004.
    Lispsm,
    /// `perspective`: Stamminger, Drettakis 2002.
    Perspective,
    /// `parallel-split`: Zhang, Sun, Xu, Lun 2006.
    ParallelSplit,
    /// `remix`: Oliveira 2009.
    Remix,
    /// `ray-traced`: Whitted 1980, through the tree of Ylitie, Karras, Laine 2017.
    RayTraced,
    /// `supersampled`: Aila and Laine 2004; Johnson et al. 2005; Sintorn et al. 2008.
    Supersampled,
}

/// How a pixel asks the light's texels. It works in any views of the light, warped or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelQuery {
    /// Facets against the casters of their texels.
    Facets,
    /// Borders of the closest triangles around.
    Triangles,
    /// The triangles that are nearest at the centres of the texels around.
    Centres,
    /// Nearest depths, and between them points of the silhouette.
    Silhouettes,
    /// Nearest depths.
    Map(MapQuery),
    /// No texels: rays.
    Rays,
    /// Every sample, kept by its texel, against every caster there.
    Samples,
}

/// How a map of nearest depths is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapQuery {
    /// Every sample with its texel.
    Nearest,
    /// Every sample with a box of texels.
    Filtered,
    /// Every sample with its texel, whose borders are drawn anew.
    Revectorized,
    /// The pixel's footprint with mean and variance of the depths in it.
    Moments,
    /// The same in layers of depth.
    LayeredMoments,
    /// The same with the means of sines and cosines of them.
    Waves,
    /// The same with the mean of an exponential of them.
    Exponentials,
    /// The same with mean and variance of a rising and a falling exponential of them.
    ExponentialMoments,
    /// The same with the first four moments of them.
    FourMoments,
}

impl MapQuery {
    /// Whether single depths are compared, which may be others than the nearest ([`ShadowMapSettings::compared`](super::ShadowMapSettings::compared)).
    pub fn compares_depths(self) -> bool {
        matches!(self, Self::Nearest | Self::Filtered | Self::Revectorized)
    }
}

/// Description of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodRow {
    /// The method.
    pub method: MethodName,
    /// Its one name.
    pub name: &'static str,
    /// Where it is from.
    pub paper: &'static str,
    /// The section of that, or of a survey that describes it.
    pub section: &'static str,
    /// Its three parts: where the light's texels lie, what a texel keeps, how a pixel asks.
    pub parts: [&'static str; 3],
    /// The last of these, which says the second too.
    pub query: TexelQuery,
    /// Slices of what the camera sees and their warp, where [`Settings::partition`] tells none.
    pub partition: Option<SplitPlan>,
    /// The options of the program that it takes of those that not every method takes, in the order of [`METHOD_OPTIONS`].
    pub options: &'static [&'static str],
}

/// Slices and a warp of a method's own.
const fn own(splits: u32, warp: Warp) -> Option<SplitPlan> {
    Some(SplitPlan { splits, warp, focus: SplitPlan::FOCUS, weight: SplitPlan::WEIGHT })
}

/// The options of `render` and `explain` that not every method takes; all others are of all methods.
pub const METHOD_OPTIONS: [&str; 30] = [
    "facets",
    "validity",
    "masks",
    "pairs",
    "projection",
    "filter",
    "memory-limit",
    "list-start",
    "encoding",
    "search",
    "recovery",
    "slope-power",
    "lookups",
    "rays",
    "kernel",
    "compare",
    "shape",
    "reach",
    "splits",
    "split-weight",
    "warp",
    "focus",
    "bleeding",
    "grazing",
    "exponent",
    "layers",
    "terms",
    "history",
    "confidence-power",
    "looks",
];

/// Where texels lie of most methods.
const VIEWS: &str = "over casters and receivers; slices, warps; a cube";

/// All methods, in the order of [`MethodName::ALL`].
pub const METHODS: [MethodRow; 20] = [
    MethodRow {
        method: MethodName::FacetMasks,
        name: "facet-masks",
        paper: "Pan, Wang, Chen, Zhou, Bao 2009: Fast, Sub-pixel Antialiased Shadow Maps",
        section: "3",
        parts: [
            "over casters and receivers; slices, warps; a cube; tiles",
            "two nearest depths, silhouettes, the split between sheets",
            "facets against casters of their texels, half-planes into masks",
        ],
        query: TexelQuery::Facets,
        partition: None,
        options: &[
            "facets",
            "validity",
            "masks",
            "pairs",
            "projection",
            "filter",
            "memory-limit",
            "list-start",
            "splits",
            "split-weight",
            "warp",
            "focus",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::Spsm,
        name: "spsm",
        paper: "Lecocq, Marvie, Sourimant, Gautron 2013: Sub-Pixel Shadow Mapping",
        section: "3 and 4",
        parts: [VIEWS, "closest triangle, 128 bits", "reconstruct borders of triangles around the sample"],
        query: TexelQuery::Triangles,
        partition: None,
        options: &["encoding", "search", "recovery", "slope-power", "splits", "split-weight", "warp", "focus", "looks"],
    },
    MethodRow {
        method: MethodName::Reconstructable,
        name: "reconstructable",
        paper: "Dai, Yang, Feng 2008: Reconstructable Geometry Shadow Maps",
        section: "Lecocq 2013: 2, figure 13",
        parts: [
            VIEWS,
            "the triangle that is nearest at its centre",
            "every sample to the light, past the triangles of the texels around it",
        ],
        query: TexelQuery::Centres,
        partition: None,
        options: &["lookups", "splits", "split-weight", "warp", "focus", "looks"],
    },
    MethodRow {
        method: MethodName::ShadowMap,
        name: "shadow-map",
        paper: "Williams 1978: Casting Curved Shadows on Curved Surfaces",
        section: "Scherzer 2011: 2",
        parts: [VIEWS, "nearest depth", "compare every sample"],
        query: TexelQuery::Map(MapQuery::Nearest),
        partition: None,
        options: &["compare", "splits", "split-weight", "warp", "focus", "history", "confidence-power", "looks"],
    },
    MethodRow {
        method: MethodName::Pcf,
        name: "pcf",
        paper: "Reeves, Salesin, Cook 1987: Rendering Antialiased Shadows with Depth Maps",
        section: "Scherzer 2011: 6",
        parts: [VIEWS, "nearest depth", "compare every sample with a box of texels on the receiver's plane"],
        query: TexelQuery::Map(MapQuery::Filtered),
        partition: None,
        options: &[
            "kernel",
            "compare",
            "splits",
            "split-weight",
            "warp",
            "focus",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::Smsr,
        name: "smsr",
        paper: "Bondarev 2014: Shadow Map Silhouette Revectorization",
        section: "2",
        parts: [VIEWS, "nearest depth", "compare, and draw stepped borders anew"],
        query: TexelQuery::Map(MapQuery::Revectorized),
        partition: None,
        options: &[
            "compare",
            "shape",
            "reach",
            "splits",
            "split-weight",
            "warp",
            "focus",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::SilhouetteMap,
        name: "silhouette-map",
        paper: "Sen, Cammarano, Hanrahan 2003: Shadow Silhouette Maps",
        section: "Scherzer 2011: 6",
        parts: [VIEWS, "nearest depth, silhouette between", "compare with the depth on its side"],
        query: TexelQuery::Silhouettes,
        partition: None,
        options: &["splits", "split-weight", "warp", "focus", "looks"],
    },
    MethodRow {
        method: MethodName::Variance,
        name: "variance",
        paper: "Donnelly, Lauritzen 2006: Variance Shadow Maps",
        section: "Oliveira 2009: 3.4",
        parts: [VIEWS, "mean and variance of depth", "bound the lit share of the pixel's footprint"],
        query: TexelQuery::Map(MapQuery::Moments),
        partition: None,
        options: &[
            "splits",
            "split-weight",
            "warp",
            "focus",
            "bleeding",
            "grazing",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::LayeredVariance,
        name: "layered-variance",
        paper: "Lauritzen, McCool 2008: Layered Variance Shadow Maps",
        section: "4; Scherzer 2011: 6",
        parts: [
            VIEWS,
            "mean and variance of depth in layers of it",
            "bound the lit share of the pixel's footprint in the receiver's layer",
        ],
        query: TexelQuery::Map(MapQuery::LayeredMoments),
        partition: None,
        options: &[
            "splits",
            "split-weight",
            "warp",
            "focus",
            "bleeding",
            "grazing",
            "layers",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::Convolution,
        name: "convolution",
        paper: "Annen, Mertens, Bekaert, Seidel, Kautz 2007: Convolution Shadow Maps",
        section: "Scherzer 2011: 6",
        parts: [
            VIEWS,
            "mean sine and cosine of depth, of up to 16 frequencies",
            "the Fourier series of the comparison over the pixel's footprint",
        ],
        query: TexelQuery::Map(MapQuery::Waves),
        partition: None,
        options: &[
            "splits",
            "split-weight",
            "warp",
            "focus",
            "bleeding",
            "grazing",
            "terms",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::Exponential,
        name: "exponential",
        paper: "Annen, Mertens, Seidel, Flerackers, Kautz 2008: Exponential Shadow Maps",
        section: "Scherzer 2011: 6",
        parts: [VIEWS, "mean of an exponential of depth", "its ratio to the receiver's over the pixel's footprint"],
        query: TexelQuery::Map(MapQuery::Exponentials),
        partition: None,
        options: &[
            "splits",
            "split-weight",
            "warp",
            "focus",
            "bleeding",
            "grazing",
            "exponent",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::ExponentialVariance,
        name: "exponential-variance",
        paper: "Lauritzen, McCool 2008: Layered Variance Shadow Maps",
        section: "exponential warps",
        parts: [
            VIEWS,
            "mean and variance of two exponentials of depth",
            "the less of two bounds of the lit share of the pixel's footprint",
        ],
        query: TexelQuery::Map(MapQuery::ExponentialMoments),
        partition: None,
        options: &[
            "splits",
            "split-weight",
            "warp",
            "focus",
            "bleeding",
            "grazing",
            "exponent",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::FourMoments,
        name: "four-moments",
        paper: "Peters, Klein 2015: Moment Shadow Mapping",
        section: "Hamburger's problem of four moments",
        parts: [
            VIEWS,
            "mean, variance, third and fourth central moment of depth",
            "bound the lit share of the pixel's footprint",
        ],
        query: TexelQuery::Map(MapQuery::FourMoments),
        partition: None,
        options: &[
            "splits",
            "split-weight",
            "warp",
            "focus",
            "bleeding",
            "grazing",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::Trapezoidal,
        name: "trapezoidal",
        paper: "Martin, Tan 2004: Anti-aliasing and Continuity with Trapezoidal Shadow Maps",
        section: "Oliveira 2009: 3.2",
        parts: ["over what is seen, trapezoid by focus; a cube", "nearest depth", "compare every sample"],
        query: TexelQuery::Map(MapQuery::Nearest),
        partition: own(1, Warp::Trapezoid),
        options: &["compare", "focus", "history", "confidence-power", "looks"],
    },
    MethodRow {
        method: MethodName::Lispsm,
        name: "lispsm",
        paper: "Wimmer, Scherzer, Purgathofer 2004: Light Space Perspective Shadow Maps",
        section: "Scherzer 2011: 4.2",
        parts: ["over what is seen, trapezoid by angle; a cube", "nearest depth", "compare every sample"],
        query: TexelQuery::Map(MapQuery::Nearest),
        partition: own(1, Warp::LightSpace),
        options: &["compare", "history", "confidence-power", "looks"],
    },
    MethodRow {
        method: MethodName::Perspective,
        name: "perspective",
        paper: "Stamminger, Drettakis 2002: Perspective Shadow Maps",
        section: "Scherzer 2011: 4.2",
        parts: ["over what is seen, trapezoid from the eye; a cube", "nearest depth", "compare every sample"],
        query: TexelQuery::Map(MapQuery::Nearest),
        partition: own(1, Warp::Perspective),
        options: &["compare", "history", "confidence-power", "looks"],
    },
    MethodRow {
        method: MethodName::ParallelSplit,
        name: "parallel-split",
        paper: "Zhang, Sun, Xu, Lun 2006: Parallel-Split Shadow Maps for Large-scale Virtual Environments",
        section: "Oliveira 2009: 3.3",
        parts: ["over what is seen of each slice; a cube", "nearest depth", "compare every sample"],
        query: TexelQuery::Map(MapQuery::Nearest),
        partition: own(3, Warp::Box),
        options: &["compare", "splits", "split-weight", "history", "confidence-power", "looks"],
    },
    MethodRow {
        method: MethodName::Remix,
        name: "remix",
        paper: "Oliveira 2009: Analysis and Proposal of a Shadow Mapping Remix Approach",
        section: "4.2",
        parts: [
            "over what is seen of each slice, warps; a cube",
            "mean and variance of depth",
            "bound the lit share of the pixel's footprint",
        ],
        query: TexelQuery::Map(MapQuery::Moments),
        partition: own(3, Warp::Fitted),
        options: &[
            "splits",
            "split-weight",
            "warp",
            "focus",
            "bleeding",
            "grazing",
            "history",
            "confidence-power",
            "looks",
        ],
    },
    MethodRow {
        method: MethodName::RayTraced,
        name: "ray-traced",
        paper: "Whitted 1980: An Improved Illumination Model for Shaded Display",
        section: "Pan 2009: 5",
        parts: ["none; to settle early as facet-masks", "none", "a ray through a tree of casters from every sample"],
        query: TexelQuery::Rays,
        partition: None,
        options: &["facets", "validity", "rays"],
    },
    MethodRow {
        method: MethodName::Supersampled,
        name: "supersampled",
        paper: "Aila, Laine 2004: Alias-Free Shadow Maps",
        section: "Scherzer 2011: 4.5",
        parts: [VIEWS, "the samples that project to it", "every sample against every caster of its texel"],
        query: TexelQuery::Samples,
        partition: None,
        options: &["facets", "validity", "splits", "split-weight", "warp", "focus"],
    },
];

impl MethodName {
    /// All of them.
    pub const ALL: [Self; METHODS.len()] = {
        let mut all = [Self::FacetMasks; METHODS.len()];
        let mut k = 0;
        while k < METHODS.len() {
            all[k] = METHODS[k].method;
            k += 1;
        }
        all
    };

    /// Its description.
    pub fn row(self) -> &'static MethodRow {
        // In the order of the enum: a test holds that.
        &METHODS[self as usize]
    }

    /// The one name of the method.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Slices of what the camera sees that it takes with these settings; `None`: one view of the light for all, or none at all.
    pub fn partition(self, settings: &Settings) -> Option<SplitPlan> {
        match (settings.partition, self.row().partition) {
            // A ray asks no view.
            _ if self == Self::RayTraced => None,
            (Some(told), Some(own)) => Some(SplitPlan {
                splits: if self.takes("splits") { told.splits } else { own.splits },
                warp: if self.takes("warp") { told.warp } else { own.warp },
                focus: told.focus,
                weight: told.weight,
            }),
            (told, own) => told.or(own),
        }
    }

    /// Whether its frames keep classes of pixels, and whether they keep a light-view map ([`DebugViews`](super::DebugViews)).
    pub fn keeps(self) -> [bool; 2] {
        match self.row().query {
            TexelQuery::Facets | TexelQuery::Triangles => [true, true],
            TexelQuery::Map(_) | TexelQuery::Centres | TexelQuery::Silhouettes => [false, true],
            TexelQuery::Rays | TexelQuery::Samples => [false, false],
        }
    }

    /// Whether it asks a map by moments of its depths.
    pub(crate) fn filters_moments(self) -> bool {
        matches!(self.row().query, TexelQuery::Map(query) if !query.compares_depths())
    }

    /// Whether it takes an option; one that is not among [`METHOD_OPTIONS`] is of all methods.
    pub fn takes(self, option: &str) -> bool {
        !METHOD_OPTIONS.contains(&option) || self.row().options.contains(&option)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_its_row_and_a_name_of_its_own() {
        for (k, row) in METHODS.iter().enumerate() {
            assert!(row.method as usize == k && row.method.row() == row, "{}", row.name);
            assert!(METHODS[..k].iter().all(|other| other.name != row.name), "{} twice", row.name);
            assert!(row.name.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", row.name);
            assert!(row.paper.contains(':') && !row.section.is_empty(), "{}", row.name);
        }
    }

    #[test]
    fn every_option_is_there_once_and_is_of_some_methods() {
        for (k, option) in METHOD_OPTIONS.iter().enumerate() {
            assert!(!METHOD_OPTIONS[..k].contains(option), "{option} twice");
            let takes = METHODS.iter().filter(|row| row.method.takes(option)).count();
            assert!((1..METHODS.len()).contains(&takes), "{option}");
        }
        for row in &METHODS {
            let place = |option| METHOD_OPTIONS.iter().position(|o| o == option);
            let places: Vec<_> = row.options.iter().map(place).collect();
            assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{}: {places:?}", row.name);
            // A method has slices of its own, or takes all options of them, or asks no view.
            let all = ["splits", "warp", "focus"].iter().all(|option| row.method.takes(option));
            assert!(row.partition.is_some() || all || row.query == TexelQuery::Rays, "{}", row.name);
            assert!(row.method.takes("samples") && row.method.takes("looks") == (row.method.keeps() != [false; 2]));
        }
    }
}
