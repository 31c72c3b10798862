//! Definition of the stable sort of pairs by the low bits of their keys.

/// The pairs ordered by the lowest `key_bits` bits of their keys; pairs that agree in those keep their order.
/// Lists end where the shorter one does.
pub fn sort(keys: &[u32], values: &[u32], key_bits: u32) -> (Vec<u32>, Vec<u32>) {
    let mask = 1u64.checked_shl(key_bits.min(32)).map_or(0, |end| end - 1) as u32;
    let mut pairs: Vec<_> = keys.iter().copied().zip(values.iter().copied()).collect();
    pairs.sort_by_key(|(key, _)| key & mask);
    pairs.into_iter().unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_stable_and_sees_only_the_low_bits() {
        let (keys, values) = ([7, 4, 5, 3], [0, 1, 2, 3]);
        assert_eq!(sort(&keys, &values, 32), (vec![3, 4, 5, 7], vec![3, 1, 2, 0]));
        assert_eq!(sort(&keys, &values, 2), (vec![4, 5, 7, 3], vec![1, 2, 0, 3]));
        assert_eq!(sort(&keys, &values, 0), (keys.to_vec(), values.to_vec()));
    }
}
