//! Definition of the clusters that a view keeps.

use super::view::{MapEnds, View};
use glam::{DVec2, DVec3};

/// Words before the list.
const HEAD: usize = 8;

/// Box of a cluster, as points of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extents {
    /// Lowest corner.
    pub low: DVec3,
    /// Highest corner.
    pub high: DVec3,
}

impl Extents {
    /// The point at these shares of its sides.
    pub fn at(&self, share: DVec3) -> DVec3 {
        self.low + (self.high - self.low) * share
    }

    /// Its corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|k| self.at(DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64)))
    }
}

/// Whether a pixel may see something at a point.
pub fn is_seen(view: &View, point: DVec3) -> bool {
    let size = DVec2::from(view.image.map(f64::from));
    point.dot(view.rays.forward) >= view.near && is_within(view.on_image(point), size)
}

/// Whether something at a point has a texel.
pub fn is_mapped(view: &View, point: DVec3) -> bool {
    view.on_map(point).is_some_and(|p| is_within(p.truncate().truncate(), DVec2::splat(f64::from(view.map.map_size))))
}

fn is_within(at: DVec2, size: DVec2) -> bool {
    at.cmpge(DVec2::ZERO).all() && at.cmple(size).all()
}

/// Whether a box surely shows no pixel anything: all of it lies behind the eye, or beyond one side of the image by so many pixels.
pub fn is_out_of_sight(view: &View, of: &Extents, pixels: f64) -> bool {
    let corners = of.corners();
    let depth = |p: &DVec3| p.dot(view.rays.forward);
    if corners.iter().all(|p| depth(p) < -1e-3 * p.abs().max_element()) {
        return true;
    }
    let size = DVec2::from(view.image.map(f64::from));
    corners.iter().all(|p| depth(p) > 2.0 * view.near) && is_beyond(corners.map(|p| view.on_image(p)), size, pixels)
}

/// Whether a box surely touches no texel: all of it is in front of the light and beyond one side of the map by so many texels, those at its farthest.
/// A box beyond an end of the map ([`LightView::ends`](subpixel_shadows::light_view::LightView::ends)) may touch any.
pub fn is_off_the_map(view: &View, of: &Extents, texels: f64) -> bool {
    // Far enough that rounding does not put it behind the light.
    let clear = |p: &DVec3| view.map.near + 1e-4 * (1.0 + p.abs().max_element());
    let place = |p: &DVec3| view.on_map(*p).filter(|at| !view.map.perspective || at.w > clear(p));
    let Some(places) = of.corners().iter().map(place).collect::<Option<Vec<_>>>() else { return false };
    let divisors = places.iter().map(|p| p.w);
    let (least, most) = divisors.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), w| (a.min(w), b.max(w)));
    let at = |k: usize| places[k].truncate().truncate();
    let low = (0..8).map(at).fold(DVec2::INFINITY, DVec2::min);
    let high = (0..8).map(at).fold(DVec2::NEG_INFINITY, DVec2::max);
    let by = (texels + 1e-4 * low.abs().max(high.abs()).max_element()) * most / least;
    let passes = MapEnds::of(&view.map).are_passed(low - by, high + by);
    !passes && is_beyond(std::array::from_fn(at), DVec2::splat(f64::from(view.map.map_size)), by)
}

/// Beyond one side.
fn is_beyond(places: [DVec2; 8], size: DVec2, by: f64) -> bool {
    let out = |p: DVec2| [-p.x, p.x - size.x, -p.y, p.y - size.y];
    (0..4).any(|side| places.iter().all(|&p| out(p)[side] > by))
}

/// The list of which clusters of triangles, edges and vertices are kept, of so many elements each, 64 a cluster: a head and their numbers.
pub fn list(kept: [&[bool]; 3], elements: [usize; 3]) -> Vec<u32> {
    let numbers = kept.map(|kept| (0..).zip(kept).filter(|(_, kept)| **kept).map(|(k, _)| k).collect::<Vec<u32>>());
    let counts = numbers.each_ref().map(|of| of.len() as u32);
    let held = |part: usize| numbers[part].iter().map(|&k| (elements[part] as u32 - 64 * k).min(64)).sum::<u32>();
    let head: [u32; HEAD] = [counts[0], counts[1], counts[2], 0, counts[0], counts[0] + counts[1], held(0), held(1)];
    [head.to_vec(), numbers.concat()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_a_head_and_numbers_in_order() {
        let kept: [&[bool]; 3] = [&[true, false, true], &[], &[false, true]];
        assert_eq!(list(kept, [130, 0, 128]), [2, 0, 1, 0, 2, 2, 66, 0, 0, 2, 1]);
        assert_eq!(list([&[], &[], &[]], [0; 3]), [0; 8]);
    }
}
