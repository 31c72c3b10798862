//! Boxes of the objects of a mesh: its connected parts, brought together where there are many.

use super::Mesh;
use glam::{DVec3, Vec3};

/// Lowest and highest corner.
type Corners = (DVec3, DVec3);

fn joined(a: Corners, b: Corners) -> Corners {
    (a.0.min(b.0), a.1.max(b.1))
}

/// At most `most` boxes that together hold all triangles of a mesh whose vertices are welded: each is that of one connected part or of several that lie
/// beside each other. A part longer than half of the group it is in is no part of a group.
pub fn object_boxes(mesh: &Mesh, most: usize) -> Vec<Corners> {
    let parts = part_boxes(mesh);
    let mut groups: Vec<Vec<Corners>> = if parts.is_empty() { Vec::new() } else { vec![parts] };
    let box_of = |group: &[Corners]| group.iter().copied().reduce(joined).unwrap_or_default();
    while groups.len() < most {
        // The group that is longest.
        let length = |group: &Vec<Corners>| if group.len() > 1 { size(box_of(group)) } else { f64::NEG_INFINITY };
        let Some(k) = (0..groups.len()).max_by(|&a, &b| length(&groups[a]).total_cmp(&length(&groups[b]))) else {
            break;
        };
        if groups[k].len() < 2 {
            break;
        }
        let mut group = groups.swap_remove(k);
        let (low, high) = box_of(&group);
        let longest = (0..group.len()).max_by(|&a, &b| size(group[a]).total_cmp(&size(group[b]))).unwrap_or(0);
        if size(group[longest]) > 0.5 * (high - low).max_element() {
            let alone = group.swap_remove(longest);
            groups.extend([vec![alone], group]);
            continue;
        }
        let axis = (0..3).max_by(|&a, &b| (high - low)[a].total_cmp(&(high - low)[b])).unwrap_or(0);
        group.sort_by(|a, b| (a.0 + a.1)[axis].total_cmp(&(b.0 + b.1)[axis]));
        let rest = group.split_off(group.len() / 2);
        groups.extend([group, rest]);
    }
    groups.iter().map(|group| box_of(group)).collect()
}

fn size((low, high): Corners) -> f64 {
    (high - low).max_element()
}

/// The box of each part of a mesh that hangs together by vertices, in the order of their first triangles.
fn part_boxes(mesh: &Mesh) -> Vec<Corners> {
    let mut parent: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for &[a, b, c] in &mesh.triangles {
        let root = find(&mut parent, a);
        for v in [b, c] {
            let other = find(&mut parent, v);
            parent[other as usize] = root;
        }
    }
    let mut place = vec![u32::MAX; mesh.positions.len()];
    let mut boxes: Vec<Corners> = Vec::new();
    for triangle in &mesh.triangles {
        let root = find(&mut parent, triangle[0]) as usize;
        let corners = triangle.map(|v| Vec3::from(mesh.positions[v as usize]).as_dvec3());
        let own = corners.into_iter().map(|p| (p, p)).reduce(joined).unwrap_or_default();
        if place[root] == u32::MAX {
            place[root] = boxes.len() as u32;
            boxes.push(own);
        } else {
            let held = &mut boxes[place[root] as usize];
            *held = joined(*held, own);
        }
    }
    boxes
}

/// The root of a vertex; those passed on the way are brought nearer to it.
fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let above = parent[parent[v as usize] as usize];
        parent[v as usize] = above;
        v = above;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor, and `count` triangles in a row on it.
    fn row(count: u32) -> Mesh {
        let mut mesh = Mesh {
            positions: vec![[-50.0, 0.0, -50.0], [50.0, 0.0, -50.0], [50.0, 0.0, 50.0], [-50.0, 0.0, 50.0]],
            triangles: vec![[0, 2, 1], [0, 3, 2]],
        };
        for k in 0..count {
            let x = k as f32 - 0.5 * count as f32;
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([[x, 0.5, 0.0], [x + 0.5, 0.5, 0.0], [x, 1.5, 0.25]]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        mesh
    }

    fn holds((low, high): &Corners, p: [f32; 3]) -> bool {
        let p = Vec3::from(p).as_dvec3();
        p.cmpge(*low).all() && p.cmple(*high).all()
    }

    /// Every triangle lies in one of the boxes, the floor is alone in its own, and few boxes are each of neighbours.
    #[test]
    fn every_triangle_lies_in_a_box() {
        for (count, most) in [(0, 4), (1, 4), (3, 4), (20, 4), (20, 9), (20, 64)] {
            let mesh = row(count);
            let boxes = object_boxes(&mesh, most);
            assert_eq!(boxes.len(), most.min(count as usize + 1), "{count} in {most}");
            for triangle in &mesh.triangles {
                let corners = triangle.map(|v| mesh.positions[v as usize]);
                assert!(boxes.iter().any(|held| corners.iter().all(|&p| holds(held, p))), "{corners:?}");
            }
            if count > 0 {
                let wide = boxes.iter().filter(|held| size(**held) > 50.0).count();
                assert_eq!(wide, 1, "the floor is with others: {boxes:?}");
            }
            // Without one of them something is left over.
            for k in 0..boxes.len() {
                let out = |t: &[u32; 3]| {
                    !boxes
                        .iter()
                        .enumerate()
                        .any(|(j, held)| j != k && t.iter().all(|&v| holds(held, mesh.positions[v as usize])))
                };
                assert!(mesh.triangles.iter().any(out), "box {k} of {count} holds nothing of its own");
            }
        }
        assert!(object_boxes(&Mesh::default(), 4).is_empty());
    }
}
