//! Definition of reading an application's triangle numbers.

/// The casters' triangle of each texel, `None` where there is none, and how many texels name no triangle. `numbers` has the
/// casters' number of each triangle of the application, which counts from `first` and writes `none` for no triangle.
pub fn triangles(texels: &[u32], first: u32, none: u32, numbers: &[u32]) -> (Vec<Option<u32>>, u32) {
    let of = |id: u32| id.checked_sub(first).and_then(|n| numbers.get(n as usize)).copied();
    let seen = texels.iter().map(|&id| if id == none { None } else { of(id) }).collect();
    let unknown = texels.iter().filter(|&&id| id != none && of(id).is_none()).count();
    (seen, unknown as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_from_the_first_and_knows_none() {
        let (seen, unknown) = triangles(&[0, 1, 2, 3, 4, 9], 1, 0, &[7, 5, 6]);
        assert_eq!((seen, unknown), (vec![None, Some(7), Some(5), Some(6), None, None], 2));
        assert_eq!(triangles(&[u32::MAX, 0], 0, u32::MAX, &[3]), (vec![None, Some(3)], 0));
    }
}
