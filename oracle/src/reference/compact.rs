//! Definition of stream compaction.

/// The items whose flag is not 0, in order. Lists end where the shorter one does.
pub fn compact(items: &[u32], flags: &[u32]) -> Vec<u32> {
    items.iter().zip(flags).filter(|(_, flag)| **flag != 0).map(|(item, _)| *item).collect()
}

/// The indices of the flags that are not 0, in order.
pub fn indices(flags: &[u32]) -> Vec<u32> {
    (0..).zip(flags).filter(|(_, flag)| **flag != 0).map(|(index, _)| index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_order() {
        assert_eq!(compact(&[9, 8, 7, 6], &[1, 0, 5, u32::MAX]), [9, 7, 6]);
        assert_eq!(indices(&[1, 0, 5, u32::MAX]), [0, 2, 3]);
        assert_eq!(compact(&[], &[]), Vec::<u32>::new());
    }
}
