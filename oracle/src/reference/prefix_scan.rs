//! Definition of the exclusive scan with saturating sums.

/// The result of [`exclusive`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scan {
    /// Element `i` is the sum of all values before `i`, at most `u32::MAX`.
    pub sums: Vec<u32>,
    /// The sum of all values, at most `u32::MAX`.
    pub total: u32,
    /// Whether the true sum is above `u32::MAX`.
    pub overflow: bool,
}

/// The exclusive scan of `values`.
pub fn exclusive(values: &[u32]) -> Scan {
    let sums = values
        .iter()
        .scan(0u32, |sum, &v| {
            let before = *sum;
            *sum = sum.saturating_add(v);
            Some(before)
        })
        .collect();
    let total: u64 = values.iter().map(|&v| u64::from(v)).sum();
    Scan { sums, total: u32::try_from(total).unwrap_or(u32::MAX), overflow: total > u64::from(u32::MAX) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saturates_and_says_so() {
        let max = exclusive(&[u32::MAX - 1, 1]);
        assert_eq!((max.sums, max.total, max.overflow), (vec![0, u32::MAX - 1], u32::MAX, false));
        let over = exclusive(&[u32::MAX, 1, 5]);
        assert_eq!((over.sums, over.total, over.overflow), (vec![0, u32::MAX, u32::MAX], u32::MAX, true));
        assert_eq!(exclusive(&[]), Scan { sums: vec![], total: 0, overflow: false });
    }
}
