//! Silhouette edges, and the texels they touch.

use super::front_layer::Margin;
use super::light_layers::Layer;
use super::triangle_setup::Triangle;
use super::vertex_project::Vertex;
use super::view::{View, centre, segment_touches};
use glam::DVec2;

/// An edge: its two vertices and its two triangles, the second `u32::MAX` where it has not exactly one neighbour that
/// winds as it should.
pub type Sides = [u32; 4];

/// Which edges are silhouettes: those of triangles that do not face the light alike. A triangle whose side is at most
/// `doubt` times [`super::triangle_setup::side_doubt`] faces either way. One vertex twice is no edge.
pub fn silhouettes(view: &View, edges: &[Sides], triangles: &[Triangle], doubt: f64) -> Vec<bool> {
    let facing = |t: u32| {
        let triangle = triangles.get(t as usize)?;
        let bound = doubt * super::triangle_setup::side_doubt(view, triangle.corners?);
        Some((triangle.side > -bound, triangle.side < bound))
    };
    let one = |&[v0, v1, first, second]: &Sides| {
        if v0 == v1 {
            return false;
        }
        let (Some((front0, back0)), Some((front1, back1))) = (facing(first), facing(second)) else { return true };
        (front0 && back1) || (back0 && front1)
    };
    edges.iter().map(one).collect()
}

/// Marks the texels that silhouettes touch, unless the edge lies there behind the split depth.
pub fn marks(
    edges: &[Sides],
    silhouette: &[bool],
    vertices: &[Vertex],
    layers: &[Layer],
    size: u32,
    margin: Margin,
) -> Vec<bool> {
    let mut marked = vec![false; layers.len()];
    let reach = 0.5 + margin.texels;
    for (&[v0, v1, ..], _) in edges.iter().zip(silhouette).filter(|(_, s)| **s) {
        let (Some(a), Some(b)) = (vertices[v0 as usize].map, vertices[v1 as usize].map) else { continue };
        let (p, q) = (a.truncate().truncate(), b.truncate().truncate());
        let limit = DVec2::splat(f64::from(size) - 1.0);
        let (lo, hi) = ((p.min(q) - reach - 1.0).max(DVec2::ZERO), (p.max(q) + reach + 1.0).min(limit));
        if !(lo.x <= hi.x && lo.y <= hi.y) {
            continue;
        }
        for y in lo.y as u32..=hi.y as u32 {
            for x in lo.x as u32..=hi.x as u32 {
                let at = centre(x, y);
                let texel = (y * size + x) as usize;
                if marked[texel] || !segment_touches(p, q, at, reach) {
                    continue;
                }
                let nearest = nearest_depth(p, q, a.z, b.z, at, reach) - margin.depth;
                marked[texel] = layers[texel].split().is_none_or(|split| nearest <= split);
            }
        }
    }
    marked
}

/// Least depth of the part of an edge that lies within `reach` of a texel along the edge's longer axis.
fn nearest_depth(p: DVec2, q: DVec2, from: f64, to: f64, at: DVec2, reach: f64) -> f64 {
    let d = q - p;
    let (length, middle) = if d.x.abs() >= d.y.abs() { (d.x, at.x - p.x) } else { (d.y, at.y - p.y) };
    if length == 0.0 {
        return from.min(to);
    }
    let ends = [(middle - reach) / length, (middle + reach) / length].map(|s| s.clamp(0.0, 1.0));
    (from + (to - from) * ends[0]).min(from + (to - from) * ends[1])
}
