//! A shadow map that is made finer page by page where that changes what pixels see.

use super::page_requests::TreePage;
use std::collections::{BTreeMap, BTreeSet};

/// Classes of numbers of changed pixels.
pub const CLASSES: u32 = 128;

/// The class of a number of changed pixels, at least 1: four even parts of each double.
pub fn class(changed: u32) -> u32 {
    let double = changed.ilog2();
    let part = (f64::from(changed) / f64::from(double).exp2() * 4.0) as u32 - 4;
    (4 * double + part).min(CLASSES - 1)
}

/// Whether a pixel goes on to a level, of which it would ask for the finest one, where as many pixels changed as `most` in one of its pages of the
/// level before.
pub fn goes_on(to: u32, finest: u32, most: u32, changed: u32) -> bool {
    to <= finest && most >= changed
}

/// How many pages are of each class and above.
pub fn counted(asked: &BTreeMap<TreePage, u32>) -> Vec<u32> {
    let above = |class: u32| asked.values().filter(|&&of| of >= class).count() as u32;
    (0..CLASSES).map(above).collect()
}

/// Pages that are made of those asked for, whose classes are given: all of the highest classes, as many of these as are no more than `budget`.
pub fn chosen(asked: &BTreeMap<TreePage, u32>, budget: u32) -> BTreeSet<TreePage> {
    let least = counted(asked).iter().position(|&pages| pages <= budget).map_or(CLASSES, |class| class as u32);
    asked.iter().filter(|(_, class)| **class >= least).map(|(&page, _)| page).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_quarters_of_doubles() {
        let of = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16, u32::MAX].map(class);
        assert_eq!(of, [0, 4, 6, 8, 9, 10, 11, 12, 12, 13, 14, 15, 16, 127]);
        assert!((1..5000).all(|n| class(n) <= class(n + 1)));
    }

    #[test]
    fn pixels_go_on_where_many_change() {
        assert_eq!(
            [(3, 3, 5), (3, 2, 5), (3, 4, 4)].map(|(to, finest, most)| goes_on(to, finest, most, 5)),
            [true, false, false]
        );
    }

    #[test]
    fn the_highest_classes_that_fit_are_made() {
        let page = |x: u32| (3, [x, 0]);
        let asked = BTreeMap::from([(page(0), 4), (page(1), 9), (page(2), 4), (page(3), 7)]);
        let made = |budget| chosen(&asked, budget).into_iter().map(|(_, [x, _])| x).collect::<Vec<_>>();
        assert_eq!([4, 3, 2, 1, 0].map(made), [vec![0, 1, 2, 3], vec![1, 3], vec![1, 3], vec![1], vec![]]);
        assert_eq!(counted(&asked)[..10], [4, 4, 4, 4, 4, 2, 2, 2, 1, 1]);
    }
}
