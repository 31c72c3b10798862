//! Definition of placing the vertices of instances.

/// Positions of instances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacedVertices {
    /// A position a place.
    pub positions: Vec<[f64; 3]>,
    /// Places outside the box, or without a number.
    pub outside: u32,
}

/// Places `vertices` by `transforms` (three rows of a matrix whose fourth column is added): `sources` has the vertex and the instance of each
/// place. Positions end up in the box from `low` to `high`.
pub fn place(
    vertices: &[[f32; 3]],
    sources: &[[u32; 2]],
    transforms: &[[[f32; 4]; 3]],
    [low, high]: [[f32; 3]; 2],
) -> PlacedVertices {
    let mut out = PlacedVertices::default();
    for &[vertex, instance] in sources {
        let v = vertices[vertex as usize].map(f64::from);
        let moved = transforms[instance as usize].map(|row| {
            let row = row.map(f64::from);
            row[0] * v[0] + row[1] * v[1] + row[2] * v[2] + row[3]
        });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_moves_and_keeps_in_the_box() {
        let turned = [[0.0, -1.0, 0.0, 10.0], [1.0, 0.0, 0.0, 20.0], [0.0, 0.0, 2.0, 30.0]];
        let nowhere = [[f32::NAN; 4]; 3];
        let got = place(&[[1.0, 2.0, 3.0]], &[[0, 0], [0, 1]], &[turned, nowhere], [[0.0; 3], [35.0; 3]]);
        assert_eq!(got.positions, [[8.0, 21.0, 35.0], [0.0; 3]]);
        assert_eq!(got.outside, 2);
    }
}
