//! Definition of pairs brought together by sorting.

/// `(texel, item)` pairs ordered by texel, those of one texel in their old order, and the pairs of each of `texels`.
pub fn sort(pairs: &[(u32, u32)], texels: usize) -> (Vec<(u32, u32)>, Vec<u32>) {
    let mut sorted = pairs.to_vec();
    sorted.sort_by_key(|pair| pair.0);
    let mut counts = vec![0; texels];
    for (texel, _) in pairs {
        counts[*texel as usize] += 1;
    }
    (sorted, counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorts_and_counts() {
        let (sorted, counts) = sort(&[(2, 9), (0, 7), (2, 1), (0, 8)], 4);
        assert_eq!(sorted, [(0, 7), (0, 8), (2, 9), (2, 1)]);
        assert_eq!(counts, [2, 0, 2, 0]);
    }
}
