//! Definition of grouping by key.

/// The values of `(key, value)` pairs brought together by key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grouped {
    /// Group `k` is `grouped[offsets[k]..offsets[k + 1]]`; one offset more than there are groups.
    pub offsets: Vec<u32>,
    /// The values, group after group. The order inside a group means nothing; here it is ascending.
    pub grouped: Vec<u32>,
}

/// Groups the pairs by key; those whose key is not below `groups` are left out.
pub fn group(keys: &[u32], values: &[u32], groups: usize) -> Grouped {
    let mut sets = vec![Vec::new(); groups];
    for (&key, &value) in keys.iter().zip(values) {
        if let Some(set) = sets.get_mut(key as usize) {
            set.push(value);
        }
    }
    let mut out = Grouped { offsets: vec![0], grouped: Vec::new() };
    for mut set in sets {
        set.sort_unstable();
        out.grouped.append(&mut set);
        out.offsets.push(out.grouped.len() as u32);
    }
    out
}

/// A grouping with each group in ascending order: equal for every order that means the same.
///
/// `None` if the offsets do not begin at 0, fall, or end elsewhere than the values do.
pub fn canonical(offsets: &[u32], grouped: &[u32]) -> Option<Grouped> {
    let mut grouped = grouped.to_vec();
    if offsets.first() != Some(&0) || offsets.last().map(|&end| end as usize) != Some(grouped.len()) {
        return None;
    }
    for pair in offsets.windows(2) {
        grouped.get_mut(pair[0] as usize..pair[1] as usize)?.sort_unstable();
    }
    Some(Grouped { offsets: offsets.to_vec(), grouped })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_sets() {
        let groups = group(&[2, 0, 2, 9, 0], &[5, 4, 3, 2, 1], 3);
        assert_eq!(groups, Grouped { offsets: vec![0, 2, 2, 4], grouped: vec![1, 4, 3, 5] });
        assert_eq!(canonical(&[0, 2, 2, 4], &[4, 1, 5, 3]), Some(groups));
        assert_eq!(canonical(&[0, 3, 2, 4], &[4, 1, 5, 3]), None);
        assert_eq!(canonical(&[0, 2, 2, 3], &[4, 1, 5, 3]), None);
    }
}
