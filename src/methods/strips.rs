//! An image in strips of rows, for devices that cannot bind the facets of all of it at once.

use super::facet_masks::Strip;

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

    /// One of them with its number, or each of them.
    pub(crate) fn part(self, strip: Option<u32>) -> Vec<(u32, Rows)> {
        (0..).zip(self.rows()).filter(|(k, _)| strip.is_none_or(|strip| strip == *k)).collect()
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
