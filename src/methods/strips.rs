//! An image in strips of rows, for devices that cannot bind the facets of all of it at once.

use super::facet_masks::Strip;
use super::render::{Counts, Output};

/// How an image is cut: into strips of equally many rows, of which the last may overlap the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strips {
    image: [u32; 2],
    rows: u32,
}

/// One strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// Its first row.
    pub first: u32,
    /// Rows at its beginning that the strip before it holds already.
    pub known: u32,
}

impl Rows {
    /// The strip as a frame takes it.
    pub fn strip(self, image: [u32; 2]) -> Strip {
        Strip { image, first_row: self.first }
    }
}

impl Strips {
    /// Fewest rows of a strip.
    pub const LEAST: u32 = 8;

    /// An image in `count` strips, as far as it has rows.
    pub fn new(image: [u32; 2], count: u32) -> Self {
        Self { image, rows: image[1].div_ceil(count.max(1)).max(1) }
    }

    /// Twice as many strips; `None` if they get too thin.
    pub fn more(self) -> Option<Self> {
        let rows = self.rows.div_ceil(2);
        (rows >= Self::LEAST && rows < self.rows).then_some(Self { rows, ..self })
    }

    /// How many there are.
    pub fn count(self) -> u32 {
        self.image[1].div_ceil(self.rows)
    }

    /// Width and height of each.
    pub fn size(self) -> [u32; 2] {
        [self.image[0], self.rows]
    }

    /// Each of them, from the top.
    pub fn rows(self) -> impl Iterator<Item = Rows> {
        (0..self.count()).map(move |k| {
            let first = (k * self.rows).min(self.image[1] - self.rows);
            Rows { first, known: k * self.rows - first }
        })
    }
}

impl Output {
    /// Adds the strip below. Facets, pairs, times and dispatches add up, those of rows that were known already too; of a list
    /// the largest need is kept.
    pub(super) fn add_rows(&mut self, below: Self, rows: Rows) {
        let width = self.visibility.len() / (rows.first + rows.known) as usize;
        let skip = rows.known as usize * width;
        self.visibility.extend_from_slice(&below.visibility[skip..]);
        self.lit.extend_from_slice(&below.lit[skip * self.words as usize..]);
        self.triangles.extend_from_slice(&below.triangles[skip..]);
        self.counts = self.counts.with_rows(below.counts);
        for (list, more) in self.lists.iter_mut().zip(below.lists) {
            list.needed = list.needed.max(more.needed);
            list.capacity = list.capacity.max(more.capacity);
            list.runs += more.runs;
        }
        for (stage, more) in self.stages.iter_mut().zip(below.stages) {
            stage.gpu_ms += more.gpu_ms;
        }
        self.wall_ms += below.wall_ms;
        self.dispatches += below.dispatches;
    }
}

impl Counts {
    /// With the counts of other rows; what the light sees is the same for all.
    fn with_rows(self, o: Self) -> Self {
        Self {
            silhouette_edges: self.silhouette_edges.max(o.silhouette_edges),
            silhouette_texels: self.silhouette_texels.max(o.silhouette_texels),
            silhouette_pixels: self.silhouette_pixels + o.silhouette_pixels,
            pixel_texel_pairs: self.pixel_texel_pairs + o.pixel_texel_pairs,
            triangle_texel_pairs: self.triangle_texel_pairs + o.triangle_texel_pairs,
            candidate_tests: self.candidate_tests + o.candidate_tests,
            visibility_evaluations: self.visibility_evaluations + o.visibility_evaluations,
            refined_evaluations: self.refined_evaluations + o.refined_evaluations,
            facets: self.facets + o.facets,
            complex_pixels: self.complex_pixels + o.complex_pixels,
            empty_facets: self.empty_facets + o.empty_facets,
            dark_facets: self.dark_facets + o.dark_facets,
            lit_facets: self.lit_facets + o.lit_facets,
            shadowed_facets: self.shadowed_facets + o.shadowed_facets,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_cover_an_image_once() {
        for height in [1, 7, 8, 16, 100, 1080, 1081] {
            for count in [1, 2, 3, 5, 64] {
                let strips = Strips::new([9, height], count);
                let mut next = 0;
                for rows in strips.rows() {
                    assert_eq!(rows.first + rows.known, next, "{height} rows, {count} strips");
                    next = rows.first + strips.size()[1];
                }
                assert_eq!(next, height, "{count} strips");
            }
        }
    }

    #[test]
    fn strips_get_thinner_to_an_end() {
        let mut strips = Strips::new([9, 1081], 1);
        let mut steps = 0;
        while let Some(more) = strips.more() {
            assert!(more.count() > strips.count());
            strips = more;
            steps += 1;
        }
        assert_eq!((steps, strips.size()[1]), (7, 9));
        assert_eq!(Strips::new([9, 10], 1).more(), None);
    }
}
