//! Definition of the boxes of clusters whose vertices move.

/// Elements of a cluster.
const CLUSTER: usize = 64;

/// Lowest and highest corner.
pub type Corners = [[f32; 3]; 2];

fn around(points: impl Iterator<Item = [f32; 3]>) -> Option<Corners> {
    points.fold(None, |found: Option<Corners>, p| {
        let [low, high] = found.unwrap_or([p; 2]);
        let each = |of: fn(f32, f32) -> f32, a: [f32; 3]| std::array::from_fn(|k| of(a[k], p[k]));
        Some([each(f32::min, low), each(f32::max, high)])
    })
}

/// The box of each 64 elements in a row, of which each uses the vertices of its list: around all clusters of vertices, 64 in a row, that one of
/// them is in; `None` where they use none.
pub fn boxes(positions: &[[f32; 3]], elements: &[Vec<u32>]) -> Vec<Option<Corners>> {
    let of_cluster = |v: u32| {
        let first = v as usize / CLUSTER * CLUSTER;
        &positions[first..(first + CLUSTER).min(positions.len())]
    };
    let of = |part: &[Vec<u32>]| around(part.iter().flatten().flat_map(|&v| of_cluster(v)).copied());
    elements.chunks(CLUSTER).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_what_has_near_numbers() {
        let positions: Vec<[f32; 3]> = (0..130u8).map(|k| [f32::from(k), 0.0, -f32::from(k)]).collect();
        let elements = [vec![vec![3, 70]; 64], vec![vec![]; 64], vec![vec![129]]].concat();
        let want =
            [Some([[0.0, 0.0, -127.0], [127.0, 0.0, 0.0]]), None, Some([[128.0, 0.0, -129.0], [129.0, 0.0, -128.0]])];
        assert_eq!(boxes(&positions, &elements), want);
    }
}
