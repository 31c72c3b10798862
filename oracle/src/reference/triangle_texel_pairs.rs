//! Which casters touch which texel that has facets.

use super::front_layer::Margin;
use super::triangle_setup::{Reach, Triangle};
use super::view::{MapEnds, centre};
use glam::DVec2;
use rayon::prelude::*;

/// The triangles (rising) that touch each texel of a map where `deepest` is some depth, and do not
/// lie behind that depth by more than the margin. One that goes on beyond one of the ends of the map is in every texel there.
pub fn pairs(triangles: &[Triangle], deepest: &[Option<f64>], map: MapEnds, margin: Margin) -> Vec<Vec<u32>> {
    let size = map.size;
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
                    _ if triangle.beyond && map.are_at(x, y as u32, size) => true,
                    Reach::Cut(cut) => {
                        cut.touches(at, reach) && cut.depth_range(at, reach, margin).0 <= deepest + margin.depth
                    }
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

/// A triangle in a tile of 2 × 2 texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TilePair {
    /// The triangle.
    pub triangle: u32,
    /// The cells that it touches: 4 × 4, half a texel a side, row by row.
    pub cells: u32,
    /// No depth of it over the tile is less.
    pub nearest: f64,
}

/// The triangles (rising) that touch each tile where `deepest` is some depth, and do not lie behind that depth by more than the
/// margin. Tiles row by row, as many as it takes to hold the map. One that goes on beyond one of the ends of the map is
/// in all cells of every tile there.
pub fn tile_pairs(triangles: &[Triangle], deepest: &[Option<f64>], map: MapEnds, margin: Margin) -> Vec<Vec<TilePair>> {
    let (size, across) = (map.size, map.size.div_ceil(2));
    let mut tiles = vec![Vec::new(); deepest.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        let Some([x0, y0, x1, y1]) = triangle.texels(size, margin.texels) else { continue };
        for (x, y) in (y0 / 2..=y1 / 2).flat_map(|y| (x0 / 2..=x1 / 2).map(move |x| (x, y))) {
            let tile = (y * across + x) as usize;
            let Some(deepest) = deepest[tile] else { continue };
            let corner = 2.0 * DVec2::new(f64::from(x), f64::from(y));
            let cells_of = |touches: &dyn Fn(DVec2, f64) -> bool| {
                let at = |cell: u32| 0.5 * DVec2::new(f64::from(cell % 4), f64::from(cell / 4)) + 0.25;
                let touched = |&cell: &u32| touches(corner + at(cell), 0.25 + margin.texels);
                (0..16).filter(touched).map(|cell| 1 << cell).sum()
            };
            let (cells, nearest) = match triangle.map {
                Reach::Nowhere => (0, 0.0),
                Reach::Everywhere => (0xffff, f64::NEG_INFINITY),
                _ if triangle.beyond && map.are_at(x, y, across) => (0xffff, f64::NEG_INFINITY),
                Reach::Cut(cut) => {
                    let nearest = cut.depth_range(corner + 1.0, 1.0 + margin.texels, margin).0;
                    (cells_of(&|at, reach| cut.touches(at, reach)), nearest)
                }
                Reach::Flat(flat) => {
                    let nearest = flat.depth_range(corner + 1.0, 1.0 + margin.texels, margin.depth).0;
                    (cells_of(&|at, reach| flat.touches(at, reach)), nearest)
                }
            };
            if cells != 0 && nearest <= deepest + margin.depth {
                tiles[tile].push(TilePair { triangle: t as u32, cells, nearest });
            }
        }
    }
    tiles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::view::Flat;

    /// A triangle does to a tile what it does to the tile's texels.
    #[test]
    fn a_tile_is_its_texels() {
        let corners = [[0.2, 0.3, 1.0], [4.9, 1.1, 2.0], [1.7, 4.6, 3.0]].map(glam::DVec3::from);
        let triangle = Triangle { map: Reach::Flat(Flat::new(corners)), ..Triangle::DROPPED };
        let (map, margin) = (MapEnds { size: 5, ..MapEnds::default() }, Margin::default());
        let texels = pairs(&[triangle], &[Some(9.0); 25], map, margin);
        let tiles = tile_pairs(&[triangle], &[Some(9.0); 9], map, margin);
        for (texel, set) in texels.iter().enumerate() {
            let (x, y) = (texel % 5, texel / 5);
            let block = 0x33 << (8 * (y % 2) + 2 * (x % 2));
            let touched = tiles[y / 2 * 3 + x / 2].iter().any(|p| p.cells & block != 0);
            assert_eq!(touched, !set.is_empty(), "texel {x}, {y}");
        }
        let cells: u32 = tiles.iter().flatten().map(|p| p.cells.count_ones()).sum();
        assert!((40..100).contains(&cells), "{cells} cells of 144");
        assert!(tiles[0][0].nearest >= 1.0 && tiles[0][0].nearest < 1.5, "{tiles:?}");
    }
}
