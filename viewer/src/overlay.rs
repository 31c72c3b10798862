//! Quantities that the picture may show, and the colours of those that are numbers.

use clap::ValueEnum;
use lab::report::looks::CLASS_COLOURS;
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::methods::names::TexelQuery;

/// Quantity that the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Overlay {
    /// The shaded scene.
    #[default]
    Shaded,
    /// Visibility alone, white where lit.
    Visibility,
    /// By how much the right half is brighter (orange) or darker (blue) than the left one.
    Difference,
    /// Class of each pixel before evaluation: dark, lit, shadowed, undecided.
    Classes,
    /// Facets of each pixel: surfaces that its samples see.
    Facets,
    /// Texels of the light's view that the undecided facets of each pixel touch.
    Texels,
    /// Pairs of facet and triangle that are evaluated for each pixel.
    Pairs,
}

/// Colours of numbers: 0, 1, 2, up to 4, 8, 16, 32, 64, 128, 256, and more.
pub const STEPS: [(&str, [u8; 3]); 11] = [
    ("0", [24, 26, 32]),
    ("1", [22, 11, 90]),
    ("2", [66, 10, 104]),
    ("4", [106, 23, 110]),
    ("8", [147, 38, 103]),
    ("16", [188, 55, 84]),
    ("32", [221, 81, 58]),
    ("64", [243, 120, 25]),
    ("128", [252, 165, 10]),
    ("256", [246, 215, 70]),
    ("more", [252, 255, 164]),
];

const CLASSES: [&str; 5] = ["empty", "dark", "lit", "shadowed", "undecided"];

impl Overlay {
    /// All of them, with a name.
    pub const ALL: [(Self, &'static str); 7] = [
        (Self::Shaded, "shaded"),
        (Self::Visibility, "visibility"),
        (Self::Difference, "difference"),
        (Self::Classes, "classes"),
        (Self::Facets, "facets"),
        (Self::Texels, "texels"),
        (Self::Pairs, "pairs"),
    ];

    /// Its name, as on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(overlay, _)| *overlay == self).map_or("", |(_, name)| name)
    }

    /// Which of a pixel's counts it shows, if it does.
    pub fn counted(self) -> Option<u32> {
        (self as u32).checked_sub(Self::Classes as u32)
    }

    /// Meaning of the colours.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Shaded => "the shaded scene",
            Self::Visibility => "visibility",
            Self::Difference => "right half brighter (orange), darker (blue)",
            Self::Classes => "class of a pixel before evaluation",
            Self::Facets => "facets of a pixel, up to",
            Self::Texels => "texels that its undecided facets touch, up to",
            Self::Pairs => "pairs of facet and triangle evaluated for it, up to",
        }
    }

    /// Colours of a count with their words; none where it shows none.
    pub fn legend(self) -> Vec<(&'static str, [u8; 3])> {
        match self.counted() {
            None => Vec::new(),
            Some(0) => CLASS_COLOURS.iter().zip(CLASSES).map(|((_, _, colour), word)| (word, *colour)).collect(),
            Some(_) => STEPS.to_vec(),
        }
    }

    /// Whether frames of a method tell it.
    pub fn is_of(self, method: MethodName) -> bool {
        let most = match method.row().query {
            TexelQuery::Facets => 3,
            TexelQuery::Rays | TexelQuery::Samples => 1,
            TexelQuery::Triangles => 0,
            TexelQuery::Map(_)
            | TexelQuery::Centres
            | TexelQuery::Polygons
            | TexelQuery::Silhouettes
            | TexelQuery::Deep
            | TexelQuery::Pages
            | TexelQuery::Axes => {
                return self.counted().is_none();
            }
        };
        self.counted().is_none_or(|which| which <= most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_overlay_has_its_name() {
        assert_eq!(Overlay::ALL.map(|(overlay, _)| overlay as usize), [0, 1, 2, 3, 4, 5, 6]);
        for (overlay, name) in Overlay::ALL {
            assert_eq!(Overlay::from_str(name, false), Ok(overlay));
            assert_eq!(overlay.legend().is_empty(), overlay.counted().is_none());
        }
        assert_eq!(Overlay::ALL.map(|(o, _)| o.is_of(MethodName::Spsm)), [true, true, true, true, false, false, false]);
        assert!(Overlay::ALL.iter().all(|(o, _)| o.is_of(MethodName::FacetMasks)));
    }
}
