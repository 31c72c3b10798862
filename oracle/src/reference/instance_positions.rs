//! Definition of placing the vertices of instances.

use subpixel_shadows::scene::Homography;

/// Positions of instances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacedVertices {
    /// A position a place.
    pub positions: Vec<[f64; 3]>,
    /// Places outside the box, or without a number.
    pub outside: u32,
}

/// Places `vertices` by `transforms` (three rows of a matrix whose fourth column is added): `sources` has the vertex and the instance of each
/// place. Positions are mapped, and end up in the box from `low` to `high`.
pub fn place(
    vertices: &[[f32; 3]],
    sources: &[[u32; 2]],
    transforms: &[[[f32; 4]; 3]],
    ([low, high], homography): ([[f32; 3]; 2], &Homography),
) -> PlacedVertices {
    let mut out = PlacedVertices::default();
    for &[vertex, instance] in sources {
        let v = vertices[vertex as usize].map(f64::from);
        let turned = transforms[instance as usize].map(|row| {
            let row = row.map(f64::from);
            row[0] * v[0] + row[1] * v[1] + row[2] * v[2] + row[3]
        });
        let moved = mapped(homography, turned);
        let inside = |k: usize| {
            let [low, high] = [low[k], high[k]].map(f64::from);
            if moved[k].is_finite() { moved[k].clamp(low, high) } else { low }
        };
        let kept = [0, 1, 2].map(inside);
        out.outside += u32::from(kept != moved);
        out.positions.push(kept);
    }
    out
}

/// Where a place comes to: `(right · q, up · q, -depth) / (divisor · q)` with `q = (place - origin, 1)`; there it is where the depth is 0.
pub fn mapped(by: &Homography, place: [f64; 3]) -> [f64; 3] {
    let depth = f64::from(by.origin[3]);
    if depth == 0.0 {
        return place;
    }
    let row = |row: [f32; 4]| {
        (0..3).map(|k| f64::from(row[k]) * (place[k] - f64::from(by.origin[k]))).sum::<f64>() + f64::from(row[3])
    };
    let divisor = row(by.divisor);
    [row(by.right) / divisor, row(by.up) / divisor, -depth / divisor]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_moves_and_keeps_in_the_box() {
        let turned = [[0.0, -1.0, 0.0, 10.0], [1.0, 0.0, 0.0, 20.0], [0.0, 0.0, 2.0, 30.0]];
        let nowhere = [[f32::NAN; 4]; 3];
        let got = place(
            &[[1.0, 2.0, 3.0]],
            &[[0, 0], [0, 1]],
            &[turned, nowhere],
            ([[0.0; 3], [35.0; 3]], &Homography::default()),
        );
        assert_eq!(got.positions, [[8.0, 21.0, 35.0], [0.0; 3]]);
        assert_eq!(got.outside, 2);
    }

    #[test]
    fn divides_by_the_divisor() {
        let by = Homography {
            origin: [1.0, 2.0, 3.0, 6.0],
            right: [1.0, 0.0, 0.0, 4.0],
            up: [0.0, 0.0, 2.0, 0.0],
            divisor: [0.0, 1.0, 0.0, 1.0],
        };
        assert_eq!(mapped(&by, [2.0, 3.0, 5.0]), [2.5, 2.0, -3.0]);
        assert_eq!(mapped(&Homography::default(), [2.0, 3.0, 5.0]), [2.0, 3.0, 5.0]);
    }
}
