//! Depth comparison at the centres of texels, and between them by the side of the silhouette (Sen, Cammarano, Hanrahan 2003).

use super::silhouette_points::middle;
use glam::{DVec2, DVec3};

/// A map and how it is asked.
#[derive(Clone, Copy, Debug)]
pub struct SilhouetteLookup<'a> {
    /// Nearest depth of each texel, row by row; `None` where there is no caster.
    pub depths: &'a [Option<f64>],
    /// Texels a side.
    pub size: u32,
    /// Of each cell, one more a side, the place of its point in it, 0 to 1; `None`: it has none.
    pub points: &'a [Option<[f64; 2]>],
    /// Depth that a receiver is moved towards the light.
    pub constant: f64,
    /// Times the steeper slope of the receiver per texel: what it is moved besides.
    pub slope: f64,
}

impl SilhouetteLookup<'_> {
    fn lit(&self, [x, y]: [i64; 2], at: DVec3, slope: DVec2) -> bool {
        let size = i64::from(self.size);
        let held = (0..size).contains(&x) && (0..size).contains(&y);
        let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let bias = self.constant + self.slope * slope.abs().max_element();
        let depth = at.z - bias + slope.dot(centre - at.truncate());
        let nearest = held.then(|| self.depths[(y * size + x) as usize]).flatten();
        nearest.is_none_or(|d| d >= depth)
    }

    /// The point of a cell: its middle where it has none.
    pub fn point(&self, [x, y]: [i64; 2]) -> DVec2 {
        let side = i64::from(self.size) + 1;
        let held = (0..side).contains(&x) && (0..side).contains(&y);
        let [across, down] = held.then(|| self.points[(y * side + x) as usize]).flatten().unwrap_or([0.5; 2]);
        DVec2::new(x as f64, y as f64) + DVec2::new(across, down) - 0.5
    }

    /// The cell of a place.
    pub fn cell(at: DVec2) -> [i64; 2] {
        let low = (at + 0.5).floor();
        [low.x as i64, low.y as i64]
    }

    /// Whether a place (texel x, y, depth) of a receiver with this slope (depth per texel) is lit.
    pub fn is_lit(&self, at: DVec3, slope: DVec2) -> bool {
        let [x, y] = Self::cell(at.truncate());
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[dx, dy]| self.lit([x - 1 + dx, y - 1 + dy], at, slope));
        if corners.iter().all(|lit| *lit == corners[0]) {
            return corners[0];
        }
        let point = self.point([x, y]);
        let p = at.truncate() - point;
        // Left, above, right, below: clockwise, as are the corners.
        let beside = [[-1, 0], [0, -1], [1, 0], [0, 1]].map(|[dx, dy]| self.point([x + dx, y + dy]) - point);
        let beyond = beside.map(|way| way.perp_dot(p) > 0.0);
        let part = (0..4).find(|&k| beyond[k] && !beyond[(k + 1) % 4]);
        corners[part.unwrap_or(match (p.x > 0.0, p.y > 0.0) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, true) => 3,
        })]
    }

    /// The point of the cell that holds a place, as a place on the map.
    pub fn point_at(&self, at: DVec2) -> DVec2 {
        self.point(Self::cell(at))
    }
}

/// Middle of the map's cell number `k`, row by row.
pub fn middle_of(k: usize, size: u32) -> DVec2 {
    let side = size as usize + 1;
    middle([(k % side) as u32, (k / side) as u32])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One corner of four is dark: its part ends at lines from the point to those beside.
    #[test]
    fn a_corner_tells_up_to_the_lines_of_points() {
        let depths = [Some(0.1), None, None, None];
        let mut points = vec![None; 9];
        let lit = |points: &[Option<[f64; 2]>], x: f64, y: f64| {
            let lookup = SilhouetteLookup { depths: &depths, size: 2, points, constant: 0.0, slope: 0.0 };
            lookup.is_lit(DVec3::new(x, y, 0.5), DVec2::ZERO)
        };
        assert!(!lit(&points, 0.9, 0.9) && lit(&points, 1.1, 0.9) && lit(&points, 0.9, 1.1));
        points[4] = Some([0.75, 0.75]);
        assert!(!lit(&points, 1.1, 1.1) && lit(&points, 1.3, 1.1));
        assert_eq!(middle_of(4, 2), DVec2::ONE);
    }
}
