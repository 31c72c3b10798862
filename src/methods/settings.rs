//! What a frame is computed with.

use crate::light_view::LightView;
use crate::mask_table::MaskVariant;
use crate::samples::Samples;
use crate::{Error, Result};

/// How many facets a pixel has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FacetMode {
    /// One, for the surface at its centre (Pan 2009).
    #[default]
    One,
    /// One for each surface that its samples see. Their coverage replaces the validity mask.
    All,
}

/// What a frame is computed with.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Image width and height, pixels.
    pub size: [u32; 2],
    /// Light-view map, texels a side.
    pub map: u32,
    /// Sample pattern.
    pub samples: Samples,
    /// Facets of a pixel.
    pub facets: FacetMode,
    /// Keep the validity mask.
    pub validity: bool,
    /// Leave out casters that face away from the light, in closed meshes.
    pub cull_back: bool,
    /// How half-planes become masks.
    pub masks: MaskVariant,
    /// Settle facets before evaluation; without it all go the exact way.
    pub settle: bool,
}

impl Settings {
    /// Pixels of the image.
    pub fn pixels(&self) -> usize {
        self.size.iter().map(|&s| s as usize).product()
    }

    /// The settings of the paper for an image of `size` pixels and a map of `map` texels a side: validity masks, exact
    /// masks, every facet settled early that can be, no caster left out.
    pub fn new(size: [u32; 2], map: u32, samples: Samples) -> Self {
        Self {
            size,
            map,
            samples,
            facets: FacetMode::One,
            validity: true,
            cull_back: false,
            masks: MaskVariant::Exact,
            settle: true,
        }
    }

    /// Checks sizes against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let [w, h] = self.size;
        if w == 0 || h == 0 || w > 16384 || h > 16384 {
            return Err(Error::Config(format!("an image of {w}x{h} pixels; sides of 1 to 16384 are possible")));
        }
        if !(1..=LightView::LARGEST_MAP).contains(&self.map) {
            return Err(Error::Config(format!(
                "a map of {} texels a side; 1 to {} are possible",
                self.map,
                LightView::LARGEST_MAP
            )));
        }
        Ok(())
    }
}
