//! How many texels each part of the axes of the light's map takes, and where they lie.

use super::view::View;
use glam::DVec2;

/// Cells of an axis.
pub const CELLS: usize = 1024;
/// Density of one texel for one of the map.
pub const ONE: f64 = 128.0;
/// Greatest density of a cell.
pub const MOST: f64 = 131_072.0;
/// Cells to either side that have a part in the density of one.
const SPREAD: usize = 4;
/// Share of its longest step that a pixel's step along an axis counts at least.
const NARROWEST: f64 = 0.25;

/// Texels for one of the map that a pixel wants along either axis, whose place moves by these for a pixel to the right and down: as many as make
/// none longer than the longer of the two, nor than a quarter of its longest step.
pub fn wanted(right: DVec2, down: DVec2) -> DVec2 {
    let longest = right.length().max(down.length());
    right.abs().max(down.abs()).max(DVec2::splat(NARROWEST * longest)).recip()
}

/// The density of so many texels for one of the map.
pub fn density(texels: f64) -> u32 {
    (texels * ONE).clamp(1.0, MOST).ceil() as u32
}

/// Of each cell the greatest density within `SPREAD` cells.
fn spread(asked: &[u32]) -> Vec<u32> {
    let around = |cell: usize| &asked[cell.saturating_sub(SPREAD)..(cell + SPREAD + 1).min(asked.len())];
    (0..asked.len()).map(|cell| around(cell).iter().copied().max().unwrap_or(0)).collect()
}

/// Densities by what pixels ask for in each cell, 0 for nothing: the means, rounded up, over as many cells of the greatest around. No cell has less than
/// it asks for.
pub fn requested(asked: &[u32], stretch: u32) -> Vec<u32> {
    let spread = spread(asked);
    let at = |cell: usize| spread[cell.clamp(SPREAD, asked.len() - 1 + SPREAD) - SPREAD];
    let window = 2 * SPREAD + 1;
    let mean = |cell: usize| (cell..cell + window).map(at).sum::<u32>().div_ceil(window as u32);
    limited(&(0..asked.len()).map(mean).collect::<Vec<_>>(), stretch)
}

/// Densities by the distance of each cell's strip from the eye, where pixels ask for any within `SPREAD` cells, no receiver nearer than `near`.
pub fn logarithmic(view: &View, axis: usize, near: f64, asked: &[u32], stretch: u32) -> Vec<u32> {
    let of = |(cell, asked): (usize, u32)| if asked == 0 { 0.0 } else { strip(view, axis, cell, near) };
    let strips: Vec<f64> = spread(asked).into_iter().enumerate().map(of).collect();
    let most = strips.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    limited(&strips.iter().map(|s| (s / most * MOST).ceil() as u32).collect::<Vec<_>>(), stretch)
}

/// Texels for one of the map, but for a factor that all cells have, that a pixel wants as far from the eye as the nearest point of a cell's strip
/// is, where the map is as fine as it is anywhere so far away in that plane.
fn strip(view: &View, axis: usize, cell: usize, near: f64) -> f64 {
    let map = &view.map;
    let at = (cell as f64 + 0.5) * f64::from(map.map_size) / CELLS as f64;
    let plane = [map.u, map.v][axis] - at * map.w;
    let steep = plane.truncate().length();
    let apart = plane.w.abs() / steep;
    let foot = -plane.truncate() * plane.w / (steep * steep);
    let beside = (near * near - apart * apart).max(0.0).sqrt();
    let w = (map.w.dot(foot.extend(1.0)) + map.w.truncate().length() * beside).max(map.near);
    steep * if map.perspective { w } else { 1.0 } / apart.max(near)
}

/// Adds to all densities the least by which none is more than `stretch` times their mean.
fn limited(densities: &[u32], stretch: u32) -> Vec<u32> {
    let mean = densities.iter().map(|d| u64::from(*d)).sum::<u64>() / densities.len() as u64;
    let most = densities.iter().copied().max().unwrap_or(0);
    let even = u64::from(stretch) * mean;
    let more = u64::from(most).saturating_sub(even).div_ceil(u64::from(stretch) - 1) as u32;
    densities.iter().map(|d| (d + more).max(1)).collect()
}

/// Where each of `map` texels begins, and the last ends, of an axis whose cells have these densities; in texels of an even map.
pub fn borders(densities: &[u32], map: u32) -> Vec<f64> {
    let all: u64 = densities.iter().map(|d| u64::from(*d)).sum();
    let (mut cell, mut before) = (0, 0);
    let of = |texel: u64| {
        // As parts of `map`, so that all is whole.
        let wanted = texel * all;
        while cell + 1 < densities.len() && (before + u64::from(densities[cell])) * u64::from(map) <= wanted {
            before += u64::from(densities[cell]);
            cell += 1;
        }
        let part = (wanted - before * u64::from(map)) as f64 / f64::from(map) / f64::from(densities[cell]);
        (cell as f64 + part) * f64::from(map) / densities.len() as f64
    };
    (0..=u64::from(map)).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Light, Mesh};

    #[test]
    fn no_cell_has_less_than_it_asks_for() {
        let mut asked = vec![0; CELLS];
        asked[300..310].fill(900);
        asked[305] = 5000;
        let found = requested(&asked, 256);
        assert!(found.iter().zip(&asked).all(|(found, asked)| found >= asked));
        assert!(found[305] == 5000 && found[300] < 5000 && found[290] < 100, "{:?}", &found[285..320]);
        assert_eq!(wanted(DVec2::new(0.5, 0.01), DVec2::new(-0.1, 0.02)).as_ivec2().to_array(), [2, 7]);
        assert_eq!([0.001, 1.0, 1.001, 1e9].map(density), [1, 128, 129, 131_072]);
    }

    #[test]
    fn no_texel_is_stretched_beyond_the_limit() {
        let mut asked = vec![0; CELLS];
        asked[512] = 100_000;
        for stretch in [2, 16, 256] {
            let found = requested(&asked, stretch);
            let borders = borders(&found, 512);
            let widths = borders.windows(2).map(|w| w[1] - w[0]);
            let [least, most] = widths.fold([f64::MAX, 0.0], |[a, b], w| [w.min(a), w.max(b)]);
            // Within a texel of the even map where the densities change.
            assert!(least * f64::from(stretch) > 0.99, "{stretch}: {least}");
            assert!(most > 1.005 && borders[512] == 512.0 && borders[0] == 0.0, "{stretch}: {most}");
        }
    }

    #[test]
    fn texels_grow_with_the_distance_from_the_eye() {
        // A floor seen along z, the light above: strips of y of the map or of x.
        let mesh = Mesh {
            positions: vec![[-8.0, 0.0, -8.0], [8.0, 0.0, -8.0], [8.0, 0.0, 8.0], [-8.0, 0.0, 8.0]],
            triangles: vec![[0, 2, 1], [0, 3, 2]],
        };
        let light = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let map = LightView::fit(&mesh, &light, 64).unwrap();
        let camera = Camera::look_at([0.0, 0.5, 7.5], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 40.0, 0.1);
        let view = View::new(&camera, &light, &map, mesh.bounds().unwrap(), [4, 4], false);
        let near = 0.5 * view.scale;
        for axis in 0..2 {
            let found = logarithmic(&view, axis, near, &[1; CELLS], 256);
            let eye = [view.map.u, view.map.v][axis].w.clamp(0.0, 63.9) * CELLS as f64 / 64.0;
            let most = (0..CELLS).max_by_key(|&cell| found[cell]).unwrap();
            assert!((most as f64 - eye).abs() < 40.0, "{most}, {eye}");
            let far = |cell: usize| (cell as f64 + 0.5 - eye).abs();
            let [a, b] = if eye > 512.0 { [100, 300] } else { [900, 700] };
            let ratio = f64::from(found[b]) / f64::from(found[a]);
            assert!((ratio - far(a) / far(b)).abs() < 0.02 * ratio, "{ratio}, {}", far(a) / far(b));
        }
        assert_eq!(view.point([0.0, 0.5, 7.5]), DVec3::ZERO);
    }
}
