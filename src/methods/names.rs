//! The methods by name: one row each.

mod options;
mod rows;

pub use options::METHOD_OPTIONS;
pub use rows::METHODS;

use super::settings::Settings;
pub use super::texel_query::{MapQuery, TexelQuery};
use crate::light_view::{LightView, OmniMaps, SplitPlan};
use crate::{Error, Result};

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
    /// `polygon-ids`: Hourcade, Nicolas 1985.
    PolygonIds,
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
    /// `deep`: Lokovic, Veach 2000.
    Deep,
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
    /// `resolution-matched`: Lefohn, Sengupta, Owens 2007.
    ResolutionMatched,
    /// `rectilinear`: Rosen 2012; Lloyd et al. 2008.
    Rectilinear,
    /// `ray-traced`: Whitted 1980, through the tree of Ylitie, Karras, Laine 2017.
    RayTraced,
    /// `supersampled`: Aila and Laine 2004; Johnson et al. 2005; Sintorn et al. 2008.
    Supersampled,
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
                by: if self.takes("partition") { told.by } else { own.by },
                // Of other parts than it takes, how many there are says nothing.
                splits: if self.takes("splits") && (told.by == own.by || self.takes("partition")) {
                    told.splits
                } else {
                    own.splits
                },
                warp: if self.takes("warp") { told.warp } else { own.warp },
                focus: told.focus,
                weight: told.weight,
            }),
            (told, own) => told.or(own),
        }
    }

    /// Maps of a light at a point that it takes with these settings.
    pub fn omni(self, settings: &Settings) -> OmniMaps {
        if self.takes("omni") { settings.omni } else { OmniMaps::default() }
    }

    /// The settings with the map as it is made for the method: of `deep` with every sub-texel.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers, for a map that is larger than any can be.
    pub(crate) fn with_whole_map(self, settings: Settings) -> Result<Settings> {
        if self.row().query != TexelQuery::Deep {
            return Ok(settings);
        }
        let (map, sub, most) = (settings.map, settings.deep.sub_texels, LightView::LARGEST_MAP);
        match map.checked_mul(sub).filter(|side| *side <= most) {
            Some(side) => Ok(Settings { map: side, ..settings }),
            None => Err(Error::Config(format!(
                "{}: a map of {map} texels a side, {sub} x {sub} sub-texels each; {most} sub-texels a side are possible",
                self.name()
            ))),
        }
    }

    /// Whether its frames keep classes of pixels, and whether they keep a light-view map ([`DebugViews`](super::DebugViews)).
    pub fn keeps(self) -> [bool; 2] {
        match self.row().query {
            TexelQuery::Facets | TexelQuery::Triangles => [true, true],
            TexelQuery::Map(_)
            | TexelQuery::Centres
            | TexelQuery::Polygons
            | TexelQuery::Silhouettes
            | TexelQuery::Deep
            | TexelQuery::Axes => [false, true],
            TexelQuery::Pages | TexelQuery::Rays | TexelQuery::Samples => [false, false],
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
