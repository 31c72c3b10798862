//! A point of a silhouette edge in a cell of the dual grid, whose corners are the centres of texels (Sen, Cammarano, Hanrahan 2003).

use glam::{DVec2, DVec3};

/// Middle of a cell on the map: the first lies half a texel before it.
pub fn middle(cell: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(cell[0]), f64::from(cell[1]))
}

/// The point of an edge (texel x, y, depth of its ends) in a cell of half side `half` (0.5): an end that lies in it, the first before the
/// second; else the mean of where it crosses the cell's diagonals. `None` where it does not touch the cell.
pub fn point_in(cell: [u32; 2], [a, b]: [DVec3; 2], half: f64) -> Option<DVec3> {
    let (start, change) = (a.truncate() - middle(cell), (b - a).truncate());
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for k in 0..2 {
        if change[k] == 0.0 {
            if start[k].abs() > half {
                return None;
            }
            continue;
        }
        let [p, q] = [-half, half].map(|side| (side - start[k]) / change[k]);
        (first, last) = (first.max(p.min(q)), last.min(p.max(q)));
    }
    if first > last {
        return None;
    }
    let inside = |p: DVec3| (p.truncate() - middle(cell)).abs().max_element() <= half;
    if inside(a) {
        return Some(a);
    }
    if inside(b) {
        return Some(b);
    }
    let diagonals = [DVec2::new(1.0, -1.0), DVec2::new(1.0, 1.0)];
    let crossed: Vec<f64> = diagonals
        .iter()
        .map(|d| -d.dot(start) / d.dot(change))
        .filter(|share| (first..=last).contains(share))
        .collect();
    let mean = crossed.iter().sum::<f64>() / crossed.len() as f64;
    Some(a.lerp(b, if crossed.is_empty() { 0.5 * (first + last) } else { mean }))
}

/// Depth behind which all four corners of a cell hide what is there, of the nearest depths of `size` x `size` texels: infinite where one is
/// empty.
pub fn hides_from(cell: [u32; 2], depths: &[Option<f64>], size: u32) -> f64 {
    let corner = |k: u32| {
        let [x, y] = [cell[0] + k % 2, cell[1] + k / 2];
        let held = x > 0 && y > 0 && x <= size && y <= size;
        held.then(|| depths[((y - 1) * size + x - 1) as usize]).flatten().unwrap_or(f64::INFINITY)
    };
    (0..4).map(corner).fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_come_before_diagonals() {
        let edge = [DVec3::new(-3.0, 0.25, 0.0), DVec3::new(5.0, 0.25, 1.0)];
        // It crosses the diagonals at a quarter before and behind the middle.
        let at = point_in([1, 0], edge, 0.5).expect("a point");
        assert!((at - DVec3::new(1.0, 0.25, 0.5)).length() < 1e-12, "{at}");
        assert_eq!(point_in([5, 0], edge, 0.5), Some(edge[1]));
        assert_eq!(point_in([1, 1], edge, 0.5), None);
        assert_eq!(point_in([6, 0], edge, 0.5), None);
        // Across a corner it crosses one.
        let cut = [DVec3::new(0.8, 2.0, 0.0), DVec3::new(3.0, -0.2, 0.0)];
        let at = point_in([1, 1], cut, 0.5).expect("a point");
        assert!((at.truncate() - DVec2::new(1.4, 1.4)).length() < 1e-12, "{at}");
    }

    #[test]
    fn what_lies_behind_all_corners_is_hidden() {
        let depths = [Some(0.25), Some(0.5), Some(0.75), None];
        assert_eq!(hides_from([1, 1], &depths, 2), f64::INFINITY);
        assert_eq!(hides_from([0, 1], &depths, 2), f64::INFINITY);
        assert_eq!(hides_from([1, 1], &[Some(0.25); 4], 2), 0.25);
    }
}
