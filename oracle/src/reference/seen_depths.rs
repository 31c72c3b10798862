//! Between which view depths pixels see triangles.

use glam::DVec3;

/// View depth at which a ray of view depth 1 meets the plane of a triangle, between the depths of its corners, and by how much the roundings of
/// single precision may move it; `None` where it is edge-on. `forward`: the view direction.
pub fn depth(corners: [DVec3; 3], ray: DVec3, forward: DVec3) -> Option<(f64, f64)> {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a);
    let over = normal.dot(ray);
    let depths = corners.map(|p| p.dot(forward));
    let (near, far) = (depths[0].min(depths[1]).min(depths[2]), depths[0].max(depths[1]).max(depths[2]));
    let reach = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let sides = (b - a).length() * (c - a).length();
    let moved = 4e-6 * reach * (sides * ray.length() / over.abs() + 1.0);
    (over != 0.0).then(|| ((normal.dot(a) / over).clamp(near, far), moved.min(far - near) + 1e-6 * reach))
}

/// The least and the greatest of some depths, each with its doubt: of either the bounds between which it lies; `None` without any.
pub fn range(depths: impl IntoIterator<Item = (f64, f64)>) -> Option<[[f64; 2]; 2]> {
    let none = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let [near, far] = depths.into_iter().fold(none, |[near, far], (depth, doubt)| {
        let ends = [depth - doubt, depth + doubt];
        [[0, 1].map(|k| ends[k].min(near[k])), [0, 1].map(|k| ends[k].max(far[k]))]
    });
    near[0].is_finite().then_some([near, far])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slanted_triangle_is_met_between_its_corners() {
        let corners = [DVec3::new(-1.0, -1.0, 1.0), DVec3::new(3.0, -1.0, 1.0), DVec3::new(-1.0, 3.0, 3.0)];
        let at = |x: f64, y: f64| depth(corners, DVec3::new(x, y, 1.0), DVec3::Z).map(|(depth, _)| depth);
        // z = 1.5 + y / 2, so that the ray (x, y, 1) is there at 1.5 / (1 - y / 2).
        assert_eq!(at(0.0, 0.0), Some(1.5));
        assert_eq!(at(0.25, 0.5), Some(2.0));
        // Beyond the triangle no farther than its corners.
        assert_eq!([at(0.0, 1.5), at(0.0, -4.0)], [Some(3.0), Some(1.0)]);
        assert_eq!(depth(corners.map(|p| p * DVec3::new(0.0, 1.0, 1.0)), DVec3::Z, DVec3::Z), None);
    }

    #[test]
    fn the_range_holds_the_ends_with_their_doubts() {
        assert_eq!(range([]), None);
        let found = range([(2.0, 0.5), (1.75, 0.0), (4.0, 1.0), (4.5, 0.25)]);
        assert_eq!(found, Some([[1.5, 1.75], [4.25, 5.0]]));
    }
}
