//! The triangles of a glTF mesh, before its nodes place them.

use super::super::{Beside, Parsed, quoted, without_name};
use super::accessor::Source;
use super::alpha::{Materials, Tested};
use super::json::{Attributes, Primitive};
use subpixel_shadows::scene::{Mesh, Roles, TestedTriangle};

/// Limit of decoding in all, so that many primitives that name the same data cannot multiply it without end.
pub(super) struct Budget {
    vertices: u64,
}

impl Budget {
    /// As many vertices as the largest mesh can use.
    pub(super) fn new() -> Self {
        Self { vertices: 3 * Mesh::MAX_TRIANGLES as u64 }
    }
}

/// How corners form triangles.
#[derive(Clone, Copy)]
enum Mode {
    List,
    Strip,
    Fan,
}

impl Mode {
    fn triangles(self, corners: u64) -> u64 {
        match self {
            Self::List => corners / 3,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// The corners of triangle `t`, wound as the first is.
    fn corners(self, t: usize) -> [usize; 3] {
        match self {
            Self::List => [3 * t, 3 * t + 1, 3 * t + 2],
            Self::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Self::Fan => [0, t + 1, t + 2],
        }
    }
}

/// The mode of a primitive; `None` for points and lines, which throw no shadow.
fn mode(primitive: &Primitive) -> Parsed<Option<Mode>> {
    match primitive.mode.unwrap_or(4) {
        0..=3 => Ok(None),
        4 => Ok(Some(Mode::List)),
        5 => Ok(Some(Mode::Strip)),
        6 => Ok(Some(Mode::Fan)),
        other => Err(format!("glTF: primitive mode {other}, modes are 0 to 6")),
    }
}

impl Source<'_> {
    fn name(&self, mesh: usize) -> String {
        match self.root.meshes.get(mesh).and_then(|m| m.name.as_deref()) {
            Some(name) => format!("glTF: mesh {}", quoted(name)),
            None => format!("glTF: mesh {mesh}"),
        }
    }

    fn primitives(&self, mesh: usize) -> Parsed<&[Primitive]> {
        let meshes = &self.root.meshes;
        let found = meshes.get(mesh).ok_or_else(|| format!("glTF: mesh {mesh} is used, there are {}", meshes.len()))?;
        Ok(&found.primitives)
    }

    /// How many triangles a mesh declares.
    pub(super) fn triangle_count(&self, mesh: usize) -> Parsed<u64> {
        let mut count = 0u64;
        for primitive in self.primitives(mesh)? {
            if let (Some(mode), Some(position)) = (mode(primitive)?, primitive.attributes.position) {
                let corners = self.accessor(primitive.indices.unwrap_or(position))?.count;
                count = count.saturating_add(mode.triangles(corners));
            }
        }
        Ok(count)
    }

    /// The triangles of a mesh, with no more vertices than they use, and those that have holes.
    pub(super) fn decode(
        &self,
        mesh: usize,
        budget: &mut Budget,
        (materials, beside): (&mut Materials, Beside),
    ) -> Parsed<(Mesh, Vec<TestedTriangle>)> {
        let (mut all, mut holes) = (Mesh::default(), Vec::new());
        for primitive in self.primitives(mesh)? {
            if let (Some(mode), Some(position)) = (mode(primitive)?, primitive.attributes.position) {
                let part = self.decode_primitive(primitive, mode, position, budget)?;
                part.check("").map_err(|e| format!("{}: {}", self.name(mesh), without_name(&e)))?;
                let first = all.triangles.len() as u32;
                append_used(&mut all, &part);
                let tested = match primitive.material {
                    Some(material) => materials.tested(self, beside, material)?,
                    None => None,
                };
                if let Some(tested) = tested {
                    let uv = self.uv_of(primitive, &tested, part.positions.len())?;
                    holes.extend((first..).zip(&part.triangles).map(|(triangle, corners)| TestedTriangle {
                        triangle,
                        map: tested.map,
                        uv: corners.map(|v| tested.moved(uv[v as usize])),
                        roles: Roles::ALL,
                    }));
                }
            }
        }
        Ok((all, holes))
    }

    /// Texture coordinates of the vertices of a primitive with holes; without any they are 0.
    fn uv_of(&self, primitive: &Primitive, tested: &Tested, vertices: usize) -> Parsed<Vec<[f32; 2]>> {
        let Attributes { first_uv, second_uv, .. } = &primitive.attributes;
        let accessor = match tested.set {
            0 => *first_uv,
            1 => *second_uv,
            set => return Err(format!("glTF: set {set} of texture coordinates is used, sets 0 and 1 are read")),
        };
        let Some(accessor) = accessor else { return Ok(vec![[0.0; 2]; vertices]) };
        let uv = self.texture_coordinates(accessor)?;
        match uv.len() == vertices {
            true => Ok(uv),
            false => {
                Err(format!("glTF: accessor {accessor} has {} texture coordinates for {vertices} vertices", uv.len()))
            }
        }
    }

    fn decode_primitive(
        &self,
        primitive: &Primitive,
        mode: Mode,
        position: usize,
        budget: &mut Budget,
    ) -> Parsed<Mesh> {
        let positions = self.positions(position)?;
        let declared = positions.len() as u64;
        budget.vertices = budget.vertices.checked_sub(declared).ok_or_else(|| {
            format!(
                "glTF: accessor {position} of {declared} vertices is used too often, at most {} may be read in all",
                3 * Mesh::MAX_TRIANGLES
            )
        })?;
        let indices = match primitive.indices {
            Some(accessor) => Some(self.indices(accessor)?),
            None => None,
        };
        let corners = indices.as_ref().map_or(positions.len(), Vec::len);
        let triangles = (0..mode.triangles(corners as u64) as usize)
            .map(|t| mode.corners(t).map(|corner| indices.as_ref().map_or(corner as u32, |i| i[corner])))
            .collect();
        Ok(Mesh { positions, triangles })
    }
}

/// Appends the triangles of `part` and the vertices that they use.
fn append_used(all: &mut Mesh, part: &Mesh) {
    let mut place = vec![u32::MAX; part.positions.len()];
    for tri in &part.triangles {
        let moved = tri.map(|v| {
            let place = &mut place[v as usize];
            if *place == u32::MAX {
                *place = all.positions.len() as u32;
                all.positions.push(part.positions[v as usize]);
            }
            *place
        });
        all.triangles.push(moved);
    }
}

#[cfg(test)]
mod tests {
    use super::Mode;

    #[test]
    fn strips_keep_their_winding() {
        assert_eq!([0, 1, 2].map(|t| Mode::Strip.corners(t)), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!([0, 1].map(|t| Mode::Fan.corners(t)), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!([0, 2, 3, 5].map(|n| Mode::Strip.triangles(n)), [0, 0, 1, 3]);
    }
}
