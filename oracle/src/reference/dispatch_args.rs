//! Definition of the arguments of an indirect dispatch.

/// Most workgroups along one dimension at WebGPU's default limits.
pub const MAX_GROUPS: u32 = 65_535;

/// Workgroups in each dimension that handle `min(count, limit)` items but for the first `skip`, `per_group` each: one row while it fits, else
/// as few rows as can be, equally long. Spare workgroups are fewer than rows. No items a group means no groups.
pub fn fold(count: u32, per_group: u32, limit: u32, skip: u32) -> [u32; 3] {
    let groups = if per_group == 0 { 0 } else { count.min(limit).saturating_sub(skip).div_ceil(per_group) };
    let groups = groups.min(MAX_GROUPS * MAX_GROUPS);
    let rows = groups.div_ceil(MAX_GROUPS).max(1);
    [groups.div_ceil(rows), rows, 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_with_few_spare_groups() {
        let around = |n: u32| [n.wrapping_sub(1), n, n.saturating_add(1)];
        let counts = [1, 64, MAX_GROUPS, 2 * MAX_GROUPS, 1 << 17, 1 << 24, 1 << 31, MAX_GROUPS * MAX_GROUPS, u32::MAX];
        for count in counts.into_iter().flat_map(around) {
            for per_group in [1, 2, 64, 256, u32::MAX] {
                let [x, y, z] = fold(count, per_group, u32::MAX, 0);
                let groups = u64::from(count).div_ceil(u64::from(per_group)).min(u64::from(MAX_GROUPS).pow(2));
                let run = u64::from(x) * u64::from(y);
                assert!(x <= MAX_GROUPS && y <= MAX_GROUPS && z == 1);
                assert!(run >= groups && run < groups + u64::from(y), "{count} by {per_group}: {x} x {y}");
            }
        }
        assert_eq!(fold(u32::MAX, 1, 10, 0), [10, 1, 1]);
        assert_eq!(fold(5, 0, 10, 0), [0, 1, 1]);
        assert_eq!([9, 10, 11, 200].map(|n| fold(n, 64, 100, 10)[0]), [0, 0, 1, 2]);
    }
}
