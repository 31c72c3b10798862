//! An image in strips of rows, for devices that cannot bind the facets of all of it at once.

use super::facet_masks::Strip;
use super::render::{Counts, ListUse, Output};

/// How an image is cut: into strips of equally many rows, of which the last may overlap the one before; all overlap by the rows in which
/// neighbours are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strips {
    image: [u32; 2],
    rows: u32,
    halo: u32,
}

/// One strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// Its first row.
    pub first: u32,
    /// Rows at its beginning that the strip before it holds already.
    pub known: u32,
    /// Rows behind them that are its own; what is left is shown better by the strip after it.
    pub own: u32,
}

impl Rows {
    /// Where a strip's own elements begin in it, where they belong in the image, and how many they are, `each` a row.
    pub(crate) fn own_words(self, each: u64) -> [u64; 3] {
        [self.known, self.first + self.known, self.own].map(|rows| u64::from(rows) * each)
    }
}

impl Strips {
    /// Fewest rows of a strip.
    pub const LEAST: u32 = 8;

    /// An image in about `count` strips: as many as it takes if all have the same rows, one at least.
    pub fn new(image: [u32; 2], count: u32) -> Self {
        Self::with_halo(image, count, 0)
    }

    /// As [`Strips::new`], of strips that hold `halo` rows of their neighbours on either side.
    pub fn with_halo(image: [u32; 2], count: u32, halo: u32) -> Self {
        let rows = image[1].div_ceil(count.max(1)).max(1);
        let rows = if rows < image[1] { rows.saturating_add(halo.saturating_mul(2)).min(image[1]) } else { rows };
        Self { image, rows, halo }
    }

    /// Half as many rows each of their own; `None` if they get too thin.
    pub fn more(self) -> Option<Self> {
        let own = if self.count() == 1 { self.rows } else { self.rows - 2 * self.halo };
        let rows = own.div_ceil(2) + 2 * self.halo;
        (own.div_ceil(2) >= Self::LEAST && rows < self.rows).then_some(Self { rows, ..self })
    }

    /// How many there are.
    pub fn count(self) -> u32 {
        self.rows().count() as u32
    }

    /// One of them as a frame takes it.
    pub fn strip(self, rows: Rows) -> Strip {
        let others = [rows.known, self.rows - rows.known - rows.own];
        Strip { image: self.image, first_row: rows.first, others }
    }

    /// Width and height of each.
    pub fn size(self) -> [u32; 2] {
        [self.image[0], self.rows]
    }

    /// Each of them, from the top.
    pub fn rows(self) -> impl Iterator<Item = Rows> {
        let height = self.image[1];
        let mut next = 0u32;
        std::iter::from_fn(move || {
            let first = next.saturating_sub(self.halo).min(height.saturating_sub(self.rows));
            let (known, end) = (next - first, first + self.rows);
            let own = if end >= height { height - next } else { end - self.halo - next };
            next += own;
            (own > 0).then_some(Rows { first, known, own })
        })
    }
}

impl Output {
    /// Adds the strip below. Facets, pairs, times and dispatches add up, those of rows that were known already too; of a list
    /// the largest need is kept.
    pub(super) fn add_rows(&mut self, below: Self, rows: Rows) {
        let width = self.visibility.len() / (rows.first + rows.known) as usize;
        let skip = rows.known as usize * width;
        // Strips that are read back show no neighbours: the rest is their own.
        self.visibility.extend_from_slice(&below.visibility[skip..]);
        self.lit.extend_from_slice(&below.lit[skip * self.words as usize..]);
        self.triangles.extend_from_slice(&below.triangles[skip..]);
        self.counts = self.counts.with_rows(below.counts);
        for (list, more) in self.lists.iter_mut().zip(below.lists) {
            list.add_rows(&more);
        }
        for more in below.stages {
            match self.stages.iter_mut().find(|stage| stage.name == more.name) {
                Some(stage) => stage.gpu_ms += more.gpu_ms,
                None => self.stages.push(more),
            }
        }
        self.wall_ms += below.wall_ms;
        self.dispatches += below.dispatches;
    }
}

impl ListUse {
    /// Takes in how the list fared for other rows: the largest need, and all runs.
    pub(crate) fn add_rows(&mut self, more: &Self) {
        self.needed = self.needed.max(more.needed);
        self.capacity = self.capacity.max(more.capacity);
        self.runs += more.runs;
    }
}

impl Counts {
    /// With the counts of other rows; what the light sees is the same for all, and is found for one of them at least.
    pub(crate) fn with_rows(self, o: Self) -> Self {
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
            for (count, halo) in [1, 2, 3, 5, 64].into_iter().flat_map(|c| [(c, 0), (c, 1), (c, 4)]) {
                let strips = Strips::with_halo([9, height], count, halo);
                let mut next = 0;
                for rows in strips.rows() {
                    let at = format!("{rows:?} of {height} in {count} strips and {halo} rows around");
                    let end = rows.first + strips.size()[1];
                    assert_eq!(rows.first + rows.known, next, "{at}");
                    next += rows.own;
                    assert!(end <= height && next <= end, "{at}");
                    // Every row that a neighbour may be in is there, but where the image ends.
                    assert!(rows.known >= halo || rows.first == 0, "{at}");
                    assert!(end - next >= halo || end == height, "{at}");
                    if halo == 0 {
                        assert_eq!(next, end, "{at}");
                    }
                }
                assert_eq!(next, height, "{count} strips");
                assert!(strips.count() <= count);
            }
        }
    }

    #[test]
    fn an_image_without_rows_has_no_strips() {
        assert_eq!(Strips::new([9, 0], 1).count(), 0);
        assert_eq!(Strips::with_halo([9, 0], 3, 2).count(), 0);
        assert_eq!(Strips::with_halo([9, 100], 3, u32::MAX).count(), 1);
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
        let mut strips = Strips::with_halo([9, 1081], 1, 4);
        while let Some(more) = strips.more() {
            assert!(more.count() > strips.count() && more.size()[1] < strips.size()[1], "{more:?}");
            strips = more;
        }
        assert_eq!(strips.size()[1], 9 + 8);
    }
}
