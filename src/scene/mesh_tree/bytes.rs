//! Trees as lists of plain numbers.

use super::{Bounds, FAN, LEAF, MeshTree, Part};

/// Lowest and highest corner of a box, as bytes have it.
pub(crate) type Box3 = [[f32; 3]; 2];

impl MeshTree {
    /// Order and boxes of its two parts, from the lowest level of each.
    pub(crate) fn parts_of_bytes(&self) -> [(&[u32], Vec<Box3>); 2] {
        [&self.small, &self.large].map(|part| {
            let boxes = part.levels.iter().flatten().map(|b| [b.low.to_array(), b.high.to_array()]);
            (&part.order[..], boxes.collect())
        })
    }

    /// The tree of a mesh of so many triangles that [`MeshTree::parts_of_bytes`] tells of, if it can be one.
    pub(crate) fn of_bytes(parts: [(Vec<u32>, Vec<Box3>); 2], triangles: usize) -> Option<Self> {
        let [small, large] = parts.map(|(order, boxes)| Part::of_bytes(order, &boxes, triangles));
        let (small, large) = (small?, large?);
        (small.order.len() + large.order.len() == triangles).then_some(Self { small, large })
    }
}

impl Part {
    fn of_bytes(order: Vec<u32>, mut boxes: &[Box3], triangles: usize) -> Option<Self> {
        if !order.iter().all(|&t| (t as usize) < triangles) {
            return None;
        }
        let (mut levels, mut length) = (Vec::new(), order.len().div_ceil(LEAF));
        while length > 0 {
            let (level, above) = boxes.split_at_checked(length)?;
            levels.push(level.iter().map(|&[low, high]| Bounds { low: low.into(), high: high.into() }).collect());
            (boxes, length) = (above, if length == 1 { 0 } else { length.div_ceil(FAN) });
        }
        boxes.is_empty().then_some(Self { order, levels })
    }
}
