//! Ranges of a buffer.

use std::ops::Range;

/// Elements of a buffer of which ranges are taken and given back.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    /// Those that are free, in order, no two beside each other.
    free: Vec<Range<usize>>,
    /// Elements, free or not.
    pub len: usize,
}

impl Ranges {
    /// Whether there is a free range of so many.
    pub fn fits(&self, count: usize) -> bool {
        count == 0 || self.free.iter().any(|range| range.len() >= count)
    }

    /// The first elements of the least free range that holds so many, of which there is one.
    pub fn take(&mut self, count: usize) -> Range<usize> {
        let holds = |(_, range): &(usize, &Range<usize>)| range.len() >= count;
        let least = self.free.iter().enumerate().filter(holds).min_by_key(|(_, range)| range.len());
        let (Some((k, range)), true) = (least, count > 0) else { return 0..0 };
        let taken = range.start..range.start + count;
        if range.len() == count {
            self.free.remove(k);
        } else {
            self.free[k].start = taken.end;
        }
        taken
    }

    /// Takes a range back.
    pub fn give(&mut self, range: Range<usize>) {
        if range.is_empty() {
            return;
        }
        let at = self.free.partition_point(|free| free.start < range.start);
        self.free.insert(at, range);
        if at + 1 < self.free.len() && self.free[at].end == self.free[at + 1].start {
            self.free[at].end = self.free.remove(at + 1).end;
        }
        if at > 0 && self.free[at - 1].end == self.free[at].start {
            self.free[at - 1].end = self.free.remove(at).end;
        }
    }

    /// Goes on up to `len` elements, free ones.
    pub fn extend(&mut self, len: usize) {
        let more = self.len..len;
        self.len = len;
        self.give(more);
    }
}

#[cfg(test)]
mod tests {
    use super::Ranges;

    #[test]
    fn ranges_are_taken_and_given_back() {
        let mut ranges = Ranges::default();
        assert!(ranges.fits(0) && !ranges.fits(1));
        ranges.extend(10);
        let [a, b, c] = [3, 4, 3].map(|n| ranges.take(n));
        assert_eq!((a.clone(), b.clone(), c.clone()), (0..3, 3..7, 7..10));
        assert!(!ranges.fits(1) && ranges.take(0).is_empty());
        ranges.give(a.clone());
        ranges.give(c);
        assert!(ranges.fits(3) && !ranges.fits(4));
        ranges.give(b);
        assert!(matches!(&ranges.free[..], [all] if *all == (0..10)), "{:?}", ranges.free);
        assert_eq!(ranges.take(8), 0..8);
        ranges.extend(14);
        // The least that holds them.
        ranges.give(0..1);
        assert_eq!((ranges.take(1), ranges.take(6)), (0..1, 8..14));
        assert!(!ranges.fits(1) && ranges.free.is_empty());
    }
}
