//! Which casters touch which texel that has facets.

use super::front_layer::Margin;
use super::triangle_setup::{Reach, Triangle};
use super::view::centre;
use rayon::prelude::*;

/// The triangles (rising) that touch each texel of a map of `size` texels a side where `deepest` is some depth, and do not
/// lie behind that depth by more than the margin.
pub fn pairs(triangles: &[Triangle], deepest: &[Option<f64>], size: u32, margin: Margin) -> Vec<Vec<u32>> {
    let reach = 0.5 + margin.texels;
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); size as usize];
    for (t, triangle) in triangles.iter().enumerate() {
        if let Some([_, y0, _, y1]) = triangle.texels(size, margin.texels) {
            (y0..=y1).for_each(|y| rows[y as usize].push(t as u32));
        }
    }
    let row = |(y, list): (usize, &Vec<u32>)| {
        let mut texels = vec![Vec::new(); size as usize];
        for &t in list {
            let triangle = &triangles[t as usize];
            let Some([x0, _, x1, _]) = triangle.texels(size, margin.texels) else { continue };
            for x in x0..=x1 {
                let Some(deepest) = deepest[y * size as usize + x as usize] else { continue };
                let at = centre(x, y as u32);
                let listed = match triangle.map {
                    Reach::Nowhere => false,
                    Reach::Everywhere => true,
                    Reach::Flat(flat) => {
                        flat.touches(at, reach) && flat.depth_range(at, reach, margin.depth).0 <= deepest + margin.depth
                    }
                };
                if listed {
                    texels[x as usize].push(t);
                }
            }
        }
        texels
    };
    rows.par_iter().enumerate().flat_map_iter(row).collect()
}
