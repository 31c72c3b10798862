//! Classes of pixels and maps of texels that a method kept, read back for display.

use super::facet_masks::FacetMasks;
use super::spsm::Spsm;
use super::strip_method::StripMethod;
use super::strips::Rows;
use crate::Result;
use crate::gpu::{Buffer, Gpu};
use crate::stages::facet_classify::{FacetState, Facets};
use crate::stages::light_layers::Layers;
use crate::stages::spsm_query::Class;

/// State of a pixel before its samples were evaluated, in rising order of the method's work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum PixelClass {
    /// It sees nothing.
    #[default]
    Empty,
    /// Its surface faces away from the light.
    Dark,
    /// Settled: nothing lies before it.
    Lit,
    /// Settled: covered.
    Shadowed,
    /// Evaluated or recovered, sample by sample.
    Undecided,
}

impl PixelClass {
    /// All classes.
    pub const ALL: [Self; 5] = [Self::Empty, Self::Dark, Self::Lit, Self::Shadowed, Self::Undecided];

    fn of_state(state: u32) -> Self {
        const STATES: [FacetState; 5] = FacetState::ALL;
        let at = STATES.iter().position(|s| *s as u32 == state);
        at.map_or(Self::Undecided, |k| Self::ALL[k])
    }

    fn of_class(class: u32) -> Self {
        const CLASSES: [Class; 5] = [Class::Empty, Class::Dark, Class::Lit, Class::Shadowed, Class::Uncertain];
        let at = CLASSES.iter().position(|c| *c as u32 == class);
        at.map_or(Self::Undecided, |k| Self::ALL[k])
    }
}

/// A light-view map, texel by texel, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DebugMap {
    /// Texels a side.
    pub size: u32,
    /// Depth of the nearest caster: at the texel's centre, with `spsm` its least over the texel; not a number where there is
    /// none. Depth 1 is the extent of the casters along the light.
    pub depths: Vec<f32>,
    /// The triangle of the prepared mesh that the texel holds, `u32::MAX` for none (`spsm`); else empty.
    pub triangles: Vec<u32>,
    /// Whether the texel is marked: silhouettes, or layers that are not certain (`facet-masks`); else empty.
    pub marks: Vec<bool>,
}

/// Pictures of a frame's inside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DebugViews {
    /// Class of each pixel, row by row from the top; empty where the method has no classes.
    pub classes: Vec<PixelClass>,
    /// The map, where one was made; none where there are several views.
    pub map: Option<DebugMap>,
    /// The view of the light that each pixel asks, row by row from the top; empty where there is one, and where a pixel asks
    /// all that hold it.
    pub views: Vec<u32>,
}

impl DebugViews {
    /// Adds the strip of rows of an image `width` pixels wide that `method` rendered last; the class of a pixel is that of its
    /// most demanding facet. Row 0 begins anew.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device fails.
    pub fn add_rows(&mut self, gpu: &Gpu, method: &StripMethod, width: u32, rows: Rows) -> Result<()> {
        match method {
            StripMethod::FacetMasks(method) => self.add_rows_of_facets(gpu, method, width, rows),
            StripMethod::Fixed(method) => {
                *self = method.method().looks(gpu)?.unwrap_or_default();
                // Several views have no one map.
                self.map = self.map.take().filter(|_| method.views() == 1);
                self.views = method.asked_views(gpu)?;
                Ok(())
            }
        }
    }

    fn add_rows_of_facets(&mut self, gpu: &Gpu, method: &FacetMasks, width: u32, rows: Rows) -> Result<()> {
        if rows.first == 0 {
            // Several views have no one map, and one of a single texel tells nothing.
            let one = method.capacities().views == 1 && method.layers().nearest_keys.len() > 1;
            let map = one.then(|| DebugMap::of_layers(gpu, method.layers())).transpose()?;
            *self = Self { map, ..Self::default() };
        }
        self.add_classes(gpu, method.facets(), method.visibility().len(), width, rows)
    }

    fn add_classes(&mut self, gpu: &Gpu, facets: &Facets, pixels: usize, width: u32, rows: Rows) -> Result<()> {
        let known = (rows.known * width) as usize;
        let mut strip = vec![PixelClass::Empty; pixels];
        most_demanding(&mut strip, facets.list.read(gpu)?.iter().map(|f| (f.pixel as usize, f.state)));
        self.classes.extend_from_slice(&strip[known.min(pixels)..]);
        Ok(())
    }

    pub(super) fn of_spsm(gpu: &Gpu, method: &Spsm) -> Result<Self> {
        let texels = method.texels();
        let closest = texels.closest(gpu)?;
        let map = DebugMap {
            size: side(closest.len()),
            depths: closest.iter().map(|c| c.map_or(f32::NAN, |(_, depth)| depth)).collect(),
            triangles: closest.iter().map(|c| c.map_or(u32::MAX, |(triangle, _)| triangle)).collect(),
            marks: Vec::new(),
        };
        let classes = method.pixels().classes(gpu)?.into_iter().map(PixelClass::of_class).collect();
        Ok(Self { classes, map: Some(map), ..Self::default() })
    }

    /// Of a map whose second keys are complements of triangles.
    pub(super) fn of_triangles(gpu: &Gpu, map: &Layers) -> Result<Self> {
        // The complement of none is none.
        let triangles = map.second_keys.read(gpu)?.into_iter().map(|key| !key).collect();
        let map = DebugMap { triangles, ..DebugMap::nearest(gpu, map)? };
        Ok(Self { map: Some(map), ..Self::default() })
    }

    pub(super) fn of_depths(gpu: &Gpu, map: &Layers) -> Result<Self> {
        Self::of_keys(gpu, &map.nearest_keys)
    }

    /// Of complements of the bits of depths.
    pub(super) fn of_keys(gpu: &Gpu, keys: &Buffer<u32>) -> Result<Self> {
        Ok(Self { map: Some(DebugMap::of_keys(gpu, keys)?), ..Self::default() })
    }
}

impl DebugMap {
    fn nearest(gpu: &Gpu, layers: &Layers) -> Result<Self> {
        Self::of_keys(gpu, &layers.nearest_keys)
    }

    fn of_keys(gpu: &Gpu, keys: &Buffer<u32>) -> Result<Self> {
        let keys = keys.read(gpu)?;
        let depths = keys.iter().map(|&key| if key == 0 { f32::NAN } else { f32::from_bits(!key) }).collect();
        Ok(Self { size: side(keys.len()), depths, ..Self::default() })
    }

    fn of_layers(gpu: &Gpu, layers: &Layers) -> Result<Self> {
        let mut look = Self::nearest(gpu, layers)?;
        let (words, size) = (layers.mask.read(gpu)?, look.size as usize);
        let row = size.div_ceil(32);
        let marked = |texel: usize| words[texel / size * row + texel % size / 32] >> (texel % size % 32) & 1 == 1;
        look.marks = (0..size * size).map(marked).collect();
        Ok(look)
    }
}

/// Raises the class of each pixel to that of its facets, given as pixel and [`FacetState`].
fn most_demanding(classes: &mut [PixelClass], facets: impl Iterator<Item = (usize, u32)>) {
    for (pixel, state) in facets {
        // Places of the list that hold no facet are empty.
        if let (true, Some(class)) = (state != FacetState::Empty as u32, classes.get_mut(pixel)) {
            *class = (*class).max(PixelClass::of_state(state));
        }
    }
}

fn side(texels: usize) -> u32 {
    texels.isqrt() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_has_the_class_of_its_most_demanding_facet() {
        let of = |facets: &[(usize, FacetState)]| {
            let mut classes = vec![PixelClass::Empty; 3];
            most_demanding(&mut classes, facets.iter().map(|&(p, s)| (p, s as u32)));
            classes
        };
        let facets = [
            (0, FacetState::Lit),
            (2, FacetState::Dark),
            (0, FacetState::Undecided),
            (0, FacetState::Dark),
            (2, FacetState::Lit),
        ];
        assert_eq!(of(&facets), [PixelClass::Undecided, PixelClass::Empty, PixelClass::Lit]);
        assert_ne!(of(&facets[..2]), of(&facets));
        // Places that hold no facet name any pixel.
        assert_eq!(of(&[(1, FacetState::Empty), (7, FacetState::Lit)]), [PixelClass::Empty; 3]);
    }
}
