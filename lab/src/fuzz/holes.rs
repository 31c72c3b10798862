//! Alpha-tested triangles of random worlds.

use super::random::Random;
use subpixel_shadows::scene::{AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Mesh, Roles, TestedTriangle};

/// Holes in some of a mesh's triangles: small maps of any filter, wrap and cutoff, at coordinates that may repeat them often, turn them over
/// or lay a whole triangle on one point of them.
pub fn holes(r: &mut Random, mesh: &Mesh) -> AlphaTested {
    let maps: Vec<AlphaMap> = (0..r.whole(1, 3)).map(|_| map(r)).collect();
    let share = r.pick([0.1, 0.5, 1.0]);
    let scale = r.by_size(0.3, 12.0);
    let mut triangles = Vec::new();
    for triangle in 0..mesh.triangles.len() as u32 {
        if r.chance(share) {
            let map = r.whole(0, maps.len() as u32 - 1);
            triangles.push(TestedTriangle { triangle, map, uv: coordinates(r, scale), roles: Roles::ALL });
        }
    }
    AlphaTested { maps, triangles }
}

fn map(r: &mut Random) -> AlphaMap {
    let size = [0, 1].map(|_| r.pick([1, 2, 3, 4, 7, 8, 16]));
    let kind = r.whole(0, 4);
    let [width, height] = size;
    let texel = |k: u32, r: &mut Random| match kind {
        0 | 1 => r.whole(0, 255) as u8,
        2 => r.pick([0, 255]),
        // A ramp, whose border between texel centres is a line or a hyperbola.
        3 => (255 * (k % width + k / width) / (width + height - 1).max(1)) as u8,
        _ => r.pick([0, 127, 128, 255, 255, 255]),
    };
    let alpha = (0..width * height).map(|k| texel(k, r)).collect();
    let cutoff = r.pick([0.5, 0.5, 0.25, 1.0, 0.0, f64::NAN]);
    let cutoff = if cutoff.is_nan() { r.unit() } else { cutoff } as f32;
    let wrap = [0, 1].map(|_| r.pick([AlphaWrap::Repeat, AlphaWrap::Mirror, AlphaWrap::Clamp]));
    AlphaMap { size, alpha, cutoff, filter: r.pick([AlphaFilter::Nearest, AlphaFilter::Bilinear]), wrap }
}

fn coordinates(r: &mut Random, scale: f64) -> [[f32; 2]; 3] {
    match r.whole(0, 9) {
        // The map's corners, exactly.
        0..=3 => [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
        // One point, or a line, of the map for all of the triangle.
        4 => [[r.unit() as f32, r.unit() as f32]; 3],
        5 => [0.0, 1.0, 2.0].map(|t| [t * scale as f32, 0.25]),
        _ => [0, 1, 2].map(|_| [0, 1].map(|_| (r.between(-1.0, 2.0) * scale) as f32)),
    }
}
