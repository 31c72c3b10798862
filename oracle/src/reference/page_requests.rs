//! Pages of the light's view that pixels ask for, and which of them are made.

use std::collections::BTreeSet;

/// A page: its level and its place there.
pub type TreePage = (u32, [u32; 2]);

/// Thirds of a level, by which all are made coarser.
pub const THIRDS: u32 = 3;

/// The level, in thirds, that a pixel asks for whose longer step on its receiver is `step` texels of level `base`, and whose samples lie in
/// a box of `extent` of them: the coarsest whose texels are no longer, and `finer` levels beyond it; no finer than the level `told` beyond `base`,
/// than makes the box a page long, and than `last`.
pub fn thirds(step: f64, extent: f64, told: i32, finer: u32, [base, last]: [u32; 2]) -> u32 {
    let matched = (THIRDS * (base + finer)) as i32 + (-3.0 * step.log2()).clamp(-99.0, 99.0).ceil() as i32;
    let boxed = 4 - extent.log2().floor().clamp(-64.0, 64.0) as i32;
    let most = (base as i32 + told.min(boxed)).min(last as i32);
    matched.min(THIRDS as i32 * most).max(0) as u32
}

/// The level that takes so many thirds.
pub fn level(thirds: u32) -> u32 {
    thirds.div_ceil(THIRDS)
}

/// A page that is asked for, and by how many thirds its level is finer than its pixels'.
pub type Asked = (TreePage, u32);

/// The finest level, in thirds, that is asked for of each cell, by rows of `side`, of what pixels ask of the cells that they touch: their level,
/// and the first and the last of them along either axis.
pub fn cells(pixels: impl IntoIterator<Item = (u32, [[u32; 2]; 2])>, side: u32) -> Vec<Option<u32>> {
    let mut cells = vec![None; (side * side) as usize];
    for (thirds, [first, last]) in pixels {
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let cell: &mut Option<u32> = &mut cells[(y * side + x) as usize];
                *cell = (*cell).max(Some(thirds));
            }
        }
    }
    cells
}

/// Times that a pixel near a silhouette counts in the weight of a cell.
pub const EDGE_WEIGHT: u32 = 8;

/// The levels of cells, which are the pages of level `of`, by their shares of `budget` pages by weight, where these are not finer than what pixels
/// ask for; `more`: thirds that the logarithm of a share may be off.
pub fn tiles(cells: &[Option<u32>], weights: &[u32], of: u32, budget: u32, more: f64) -> Vec<Option<u32>> {
    let all = f64::from(weights.iter().sum::<u32>());
    let of_share = |(cell, &weight): (&Option<u32>, &u32)| {
        let share = f64::from(budget) * f64::from(weight) / all;
        let thirds = (f64::from(THIRDS * of) + (1.5 * share.log2() + more).floor()).max(0.0) as u32;
        cell.map(|finest| finest.min(thirds))
    };
    cells.iter().zip(weights).map(of_share).collect()
}

/// All pages of cells, which are the pages of level `of`, at their levels; of a map of `map` texels a side, whose level is `base`.
pub fn of_cells(cells: &[Option<u32>], of: u32, base: u32, map: u32, page: u32) -> BTreeSet<Asked> {
    let mut asked = BTreeSet::new();
    for (k, thirds) in (0..).zip(cells) {
        let Some(thirds) = *thirds else { continue };
        let (cell, at) = ([k & ((1 << of) - 1), k >> of], level(thirds));
        let pages: Vec<[u32; 2]> = match at.checked_sub(of) {
            None => vec![cell.map(|c| c >> (of - at))],
            Some(finer) => {
                let within = |k: u32| (cell[0] << finer | k & ((1 << finer) - 1), cell[1] << finer | k >> finer);
                (0..1 << (2 * finer)).map(within).map(<[u32; 2]>::from).collect()
            }
        };
        let side = f64::from(map) * f64::from(at as i32 - base as i32).exp2();
        let there = |place: &[u32; 2]| place.iter().all(|&x| f64::from(x * page) < side);
        asked.extend(pages.into_iter().filter(there).map(|place| ((at, place), THIRDS * at - thirds)));
    }
    asked
}

/// Pages that are made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chosen {
    /// By how many thirds of a level all are coarser than asked for.
    pub coarser: u32,
    /// How many were asked for, with the coarsest.
    pub asked: usize,
    /// Them.
    pub pages: BTreeSet<TreePage>,
}

/// The pages asked for and the coarsest of all, by the least number of thirds coarser by which they are no more than `budget`.
pub fn chosen(asked: &[Asked], last: u32, budget: usize) -> Chosen {
    let of = |coarser: u32| -> BTreeSet<TreePage> {
        let moved = asked.iter().map(|&((level, page), more)| {
            let by = ((more + coarser) / THIRDS).min(level);
            (level - by, page.map(|at| at >> by))
        });
        moved.chain([(0, [0, 0])]).collect()
    };
    let most = THIRDS * last;
    let coarser = (0..=most).find(|&coarser| of(coarser).len() <= budget).unwrap_or(most);
    Chosen { coarser, asked: of(0).len(), pages: of(coarser) }
}

/// Levels of which a page is made that holds a page or lies in it, a bit each.
pub fn levels_around(pages: &BTreeSet<TreePage>, (level, at): TreePage) -> u32 {
    let meets = |&&(other, place): &&TreePage| {
        let (up, down) = (level.saturating_sub(other), other.saturating_sub(level));
        at.map(|x| x >> up) == place.map(|x| x >> down)
    };
    pages.iter().filter(meets).fold(0, |mask, (level, _)| mask | 1 << level)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_no_longer_than_the_steps_of_pixels() {
        let of = |square: f64| thirds(square.sqrt(), 0.01, 20, 0, [3, 8]);
        assert_eq!([1.0, 1.5, 0.99, 0.25, 0.24, 4.0, 0.0].map(of), [9, 9, 10, 12, 13, 6, 24]);
        assert_eq!([9, 10, 12, 13].map(level), [3, 4, 4, 5]);
        assert_eq!(thirds(1.0, 0.5, 20, 2, [3, 8]), 15);
        assert_eq!(thirds(0.001, 0.5, 1, 0, [3, 8]), 12, "what single precision tells");
        assert_eq!(thirds(0.001, 16.5, 20, 0, [3, 8]), 9, "a long box");
    }

    #[test]
    fn cells_ask_for_all_of_their_pages() {
        let of = cells([(3, [[0, 0], [1, 0]]), (8, [[1, 0], [1, 0]]), (2, [[1, 1], [1, 1]])], 2);
        assert_eq!(of, [Some(3), Some(8), None, Some(2)]);
        let asked = |map: u32| of_cells(&of, 1, 1, map, 32).into_iter().collect::<Vec<_>>();
        let all: Vec<_> = (4..8).flat_map(|x| (0..4).map(move |y| ((3, [x, y]), 1))).collect();
        assert_eq!(asked(64), [vec![((1, [0, 0]), 0), ((1, [1, 1]), 1)], all.clone()].concat());
        // The map ends in the second cell.
        let some: Vec<_> = all.into_iter().filter(|((_, [x, _]), _)| *x < 6).collect();
        assert_eq!(asked(48), [vec![((1, [0, 0]), 0), ((1, [1, 1]), 1)], some].concat());
        assert_eq!(of_cells(&[Some(0)], 0, 1, 64, 32).into_iter().collect::<Vec<_>>(), [((0, [0, 0]), 0)]);
        assert_eq!(of_cells(&of, 1, 1, 64, 32).len(), 18);
    }

    #[test]
    fn tiles_share_the_budget() {
        let cells = [Some(20), Some(7), None, Some(20)];
        // 8, 4, and 4 of 16 pages: one and a half levels, and one, beyond that of the cells.
        assert_eq!(tiles(&cells, &[2, 1, 0, 1], 2, 16, 1e-6), [Some(10), Some(7), None, Some(9)]);
        assert_eq!(tiles(&cells, &[0, 1, 0, 1023], 2, 1, 1e-6), [Some(0), Some(0), None, Some(5)]);
    }

    #[test]
    fn pages_fit_the_budget() {
        let asked = [((2, [0, 0]), 0), ((2, [1, 0]), 0), ((2, [3, 3]), 2), ((1, [1, 1]), 0)];
        let of = |budget| chosen(&asked, 2, budget);
        assert_eq!((of(5).coarser, of(5).pages.len(), of(5).asked), (0, 5, 5));
        // The page that is finer than its pixel by two thirds gives way first, to one that is there.
        assert_eq!((of(4).coarser, of(4).pages.len()), (1, 4));
        assert_eq!((of(3).coarser, of(3).pages.len()), (3, 3));
        assert_eq!((of(2).coarser, of(2).pages.len()), (4, 2));
        assert_eq!((of(1).coarser, of(1).pages.len()), (6, 1));
        assert_eq!(levels_around(&of(5).pages, (2, [3, 3])), 0b111);
        assert_eq!(levels_around(&of(5).pages, (1, [0, 0])), 0b101);
    }
}
