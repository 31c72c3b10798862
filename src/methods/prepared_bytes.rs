//! Prepared meshes as bytes: made once, kept in a file or sent to another process, and read without being prepared again.

use super::Prepared;
use super::prepared::KnownFacts;
use crate::plan::proofs::in_one_plane;
use crate::scene::Mesh;
use crate::scene::adjacency::{Edge, NO_TRIANGLE};
use crate::scene::alpha::{AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Roles, TestedTriangle};
use crate::scene::mesh_tree::MeshTree;
use crate::{Error, Result};
use bytemuck::{Pod, Zeroable, cast_slice, cast_slice_mut};
use std::sync::OnceLock;

/// First word of the bytes: their form. Another one for every change to it.
const FORM: u64 = u64::from_le_bytes(*b"spshad01");

/// Bytes that begin each part at a multiple of this.
const WORD: usize = 8;

/// A map of alpha but for its texels.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct MapHead {
    size: [u32; 2],
    cutoff: f32,
    filter: u32,
    wrap: [u32; 2],
}

/// A tested triangle.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Tested {
    triangle: u32,
    map: u32,
    uv: [[f32; 2]; 3],
    /// Layers it casts and receives in, and whether it is seen.
    roles: [u8; 4],
}

impl Prepared {
    /// All of it as bytes, the same for the same mesh on every machine of little-endian numbers: about 80 a triangle, without compression.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer(cast_slice(&[FORM, 0]).to_vec());
        out.part(&self.mesh.positions);
        out.part(&self.mesh.triangles);
        out.part(&self.given);
        out.part(&self.edges);
        out.part(&self.bodies.iter().map(|body| u8::from(*body)).collect::<Vec<_>>());
        out.part(&self.surfaces);
        out.part(&[self.closed, in_one_plane(self)].map(u8::from));
        for (order, boxes) in self.tree().parts_of_bytes() {
            out.part(order);
            out.part(&boxes);
        }
        let AlphaTested { maps, triangles } = &*self.alpha;
        let head = |map: &AlphaMap| {
            let filter = u32::from(map.filter == AlphaFilter::Bilinear);
            MapHead { size: map.size, cutoff: map.cutoff, filter, wrap: map.wrap.map(number_of_wrap) }
        };
        out.part(&maps.iter().map(head).collect::<Vec<_>>());
        maps.iter().for_each(|map| out.part(&map.alpha));
        let tested = |of: &TestedTriangle| {
            let Roles { casts, receives, seen } = of.roles;
            Tested { triangle: of.triangle, map: of.map, uv: of.uv, roles: [casts, receives, u8::from(seen), 0] }
        };
        out.part(&triangles.iter().map(tested).collect::<Vec<_>>());
        let sum = checksum(&out.0[2 * WORD..]);
        out.0[WORD..2 * WORD].copy_from_slice(&sum.to_le_bytes());
        out.0
    }

    /// The mesh of bytes that [`Prepared::to_bytes`] has made.
    ///
    /// # Errors
    /// [`Error::Mesh`] for bytes of another form, which other versions write, for ones that end early or have changed since (a checksum finds
    /// accidents, not intentions), and for numbers out of range.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let bad = |message: &str| Error::mesh("prepared bytes", message);
        let (head, rest) = bytes.split_at_checked(2 * WORD).ok_or_else(|| bad("no head of 16 bytes"))?;
        let [form, sum]: [u64; 2] = bytemuck::pod_read_unaligned(head);
        if form != FORM {
            return Err(bad("another form of bytes, or none: prepare the mesh again"));
        }
        if sum != checksum(rest) {
            return Err(bad(&format!("the checksum of {} bytes is another one", rest.len())));
        }
        let mut parts = Reader(rest);
        let mesh = Mesh { positions: parts.next()?, triangles: parts.next()? };
        let (given, edges): (Vec<u32>, Vec<Edge>) = (parts.next()?, parts.next()?);
        let bodies = parts.next::<u8>()?.into_iter().map(|body| body != 0).collect();
        let surfaces: Vec<u32> = parts.next()?;
        let [closed, flat] = parts.next::<u8>()?[..] else { return Err(bad("no facts of the whole mesh")) };
        let mut tree = || Ok::<_, Error>((parts.next()?, parts.next()?));
        let tree = [tree()?, tree()?];
        let heads: Vec<MapHead> = parts.next()?;
        let mut map = |head: &MapHead| {
            let filter = if head.filter == 1 { AlphaFilter::Bilinear } else { AlphaFilter::Nearest };
            let wrap = head.wrap.map(|number| WRAPS.get(number as usize).copied().unwrap_or_default());
            Ok(AlphaMap { size: head.size, alpha: parts.next()?, cutoff: head.cutoff, filter, wrap })
        };
        let maps = heads.iter().map(&mut map).collect::<Result<Vec<_>>>()?;
        let tested = |of: Tested| {
            let [casts, receives, seen, _] = of.roles;
            let roles = Roles { casts, receives, seen: seen != 0 };
            TestedTriangle { triangle: of.triangle, map: of.map, uv: of.uv, roles }
        };
        let alpha = AlphaTested { maps, triangles: parts.next()?.into_iter().map(tested).collect() };
        if !parts.0.is_empty() {
            return Err(bad(&format!("{} bytes too many", parts.0.len())));
        }
        mesh.check("prepared bytes")?;
        alpha.check(&mesh)?;
        let tree = MeshTree::of_bytes(tree, mesh.triangles.len()).ok_or_else(|| bad("a tree of another mesh"))?;
        let known = KnownFacts { in_one_plane: OnceLock::from(flat != 0), ..KnownFacts::default() };
        let (closed, alpha) = (closed != 0, alpha.into());
        let read = Self { mesh, given, edges, closed, bodies, surfaces, alpha, tree: OnceLock::from(tree), known };
        if !read.is_in_range() {
            return Err(bad("numbers of triangles or vertices out of range"));
        }
        Ok(read)
    }

    /// Whether every list has an element a triangle, and all numbers in them are of triangles and vertices of this mesh.
    fn is_in_range(&self) -> bool {
        let (vertices, triangles) = (self.mesh.positions.len(), self.mesh.triangles.len());
        let of = |count: usize, number: u32| (number as usize) < count;
        let edge = |e: &Edge| {
            [e.v0, e.v1].iter().all(|&v| of(vertices, v))
                && of(triangles, e.t0)
                && (e.t1 == NO_TRIANGLE || of(triangles, e.t1))
        };
        [self.given.len(), self.bodies.len(), self.surfaces.len()] == [triangles; 3]
            && self.given.iter().chain(&self.surfaces).all(|&t| of(triangles, t))
            && self.edges.iter().all(edge)
    }
}

/// Wraps in the order of their numbers.
const WRAPS: [AlphaWrap; 3] = [AlphaWrap::Repeat, AlphaWrap::Mirror, AlphaWrap::Clamp];

fn number_of_wrap(wrap: AlphaWrap) -> u32 {
    match wrap {
        AlphaWrap::Repeat => 0,
        AlphaWrap::Mirror => 1,
        AlphaWrap::Clamp => 2,
    }
}

/// Four sums of every fourth word, each multiplied on its way, so that order counts; bytes are a multiple of a word.
fn checksum(bytes: &[u8]) -> u64 {
    const ODD: u64 = 0x9E37_79B9_7F4A_7C15;
    let word = |bytes: &[u8]| bytes.iter().rev().fold(0u64, |word, byte| word << 8 | u64::from(*byte));
    let mut sums = [1u64, 2, 3, 4];
    let (runs, rest) = bytes.as_chunks::<{ 4 * WORD }>();
    for run in runs {
        let words: [u64; 4] = bytemuck::pod_read_unaligned(run);
        for (sum, word) in sums.iter_mut().zip(words) {
            *sum = (*sum ^ word).wrapping_mul(ODD).rotate_left(29);
        }
    }
    let rest = rest.chunks(WORD).map(word);
    let all = sums.into_iter().chain(rest).chain([bytes.len() as u64]);
    all.fold(0, |sum, word| (sum ^ word).wrapping_mul(ODD).rotate_left(29))
}

/// Parts, each behind the number of its bytes.
struct Writer(Vec<u8>);

impl Writer {
    fn part<T: Pod>(&mut self, part: &[T]) {
        let bytes: &[u8] = cast_slice(part);
        self.0.extend((bytes.len() as u64).to_le_bytes());
        self.0.extend(bytes);
        self.0.resize(self.0.len().next_multiple_of(WORD), 0);
    }
}

/// Parts that are left.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn next<T: Pod>(&mut self) -> Result<Vec<T>> {
        let bad =
            || Error::mesh("prepared bytes", format!("{} bytes are left, and there is more to come", self.0.len()));
        let (head, rest) = self.0.split_at_checked(WORD).ok_or_else(bad)?;
        let bytes = usize::try_from(bytemuck::pod_read_unaligned::<u64>(head)).map_err(|_| bad())?;
        let end = bytes.checked_next_multiple_of(WORD).ok_or_else(bad)?;
        let (part, rest) = rest.split_at_checked(end).ok_or_else(bad)?;
        let mut elements = vec![T::zeroed(); bytes / size_of::<T>()];
        let whole = size_of_val(&elements[..]);
        if whole != bytes {
            return Err(bad());
        }
        cast_slice_mut(&mut elements).copy_from_slice(&part[..bytes]);
        self.0 = rest;
        Ok(elements)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Light;
    use crate::test_scenes::builtin;

    fn all_of(p: &Prepared) -> String {
        let Prepared { mesh, given, edges, closed, bodies, surfaces, alpha, .. } = p;
        format!(
            "{mesh:?} {given:?} {edges:?} {closed} {bodies:?} {surfaces:?} {alpha:?} {:?} {}",
            p.tree(),
            in_one_plane(p)
        )
    }

    fn tested(mesh: &Mesh) -> Prepared {
        let map =
            |wrap, filter| AlphaMap { size: [3, 1], alpha: vec![9, 0, 255], cutoff: 0.3, filter, wrap: [wrap; 2] };
        let maps = WRAPS.map(|wrap| map(wrap, AlphaFilter::Nearest)).into_iter().chain([AlphaMap::whole()]);
        let of = |k: u32| {
            let roles = [Roles::ALL, Roles::CAST_ONLY, Roles::UNSEEN][k as usize % 3];
            TestedTriangle { triangle: 3 * k, map: k % 4, uv: [[0.5, k as f32]; 3], roles }
        };
        Prepared::with_alpha(mesh, &AlphaTested { maps: maps.collect(), triangles: (0..9).map(of).collect() }).unwrap()
    }

    #[test]
    fn bytes_hold_all_of_it() {
        let knot = builtin("knot").mesh;
        let nothing = Prepared::new(&Mesh::default()).unwrap();
        let few = Prepared::new(&builtin("plane").mesh).unwrap();
        for prepared in [nothing, few, Prepared::new(&knot).unwrap(), tested(&knot)] {
            let bytes = prepared.to_bytes();
            let read = Prepared::from_bytes(&bytes).unwrap();
            assert_eq!(all_of(&read), all_of(&prepared));
            assert_eq!(read.to_bytes(), bytes);
            // They may lie anywhere.
            let moved = [&[7][..], &bytes].concat();
            assert_eq!(all_of(&Prepared::from_bytes(&moved[1..]).unwrap()), all_of(&prepared));
        }
        let read = Prepared::from_bytes(&Prepared::new(&knot).unwrap().to_bytes()).unwrap();
        assert!(read.backs_add_nothing(&Light::Point { position: [0.0, 9.0, 0.0] }));
    }

    /// Any byte that is another one, and any end that is missing, is told of.
    #[test]
    fn damage_is_an_error() {
        let bytes = tested(&builtin("spheres").mesh).to_bytes();
        let told = |bytes: &[u8]| Prepared::from_bytes(bytes).map(drop).unwrap_err().to_string();
        for at in (0..bytes.len()).step_by(bytes.len() / 61).chain([0, 8, 16, bytes.len() - 1]) {
            let mut other = bytes.clone();
            other[at] ^= 4;
            let told = told(&other);
            assert!(told.contains(if at < WORD { "another form" } else { "checksum" }), "byte {at}: {told}");
            assert!(Prepared::from_bytes(&bytes[..at]).is_err());
        }
        assert!(told(&bytes[..10]).contains("16 bytes"));
        // With the right sum: the form itself.
        let summed = |mut bytes: Vec<u8>| {
            let sum = checksum(&bytes[2 * WORD..]);
            bytes[WORD..2 * WORD].copy_from_slice(&sum.to_le_bytes());
            told(&bytes)
        };
        assert!(summed([&bytes[..], &[0; 8]].concat()).contains("8 bytes too many"));
        assert!(summed(bytes[..bytes.len() - WORD].to_vec()).contains("more to come"));
    }

    #[test]
    fn numbers_out_of_range_are_an_error() {
        let sound = Prepared::new(&builtin("spheres").mesh).unwrap();
        let triangles = sound.mesh.triangles.len() as u32;
        let told = |change: &dyn Fn(&mut Prepared)| {
            let mut other = sound.clone();
            sound.tree();
            change(&mut other);
            Prepared::from_bytes(&other.to_bytes()).map(drop).map_err(|e| e.to_string())
        };
        assert_eq!(told(&|_| ()), Ok(()));
        type Change<'a> = (&'a dyn Fn(&mut Prepared), &'a str);
        let changes: [Change; 7] = [
            (&|p| p.edges[5].v1 = u32::MAX, "out of range"),
            (&|p| p.edges[5].t0 = NO_TRIANGLE, "out of range"),
            (&|p| p.given[3] = triangles, "out of range"),
            (&|p| p.surfaces[3] = triangles, "out of range"),
            (&|p| _ = p.bodies.pop(), "out of range"),
            (&|p| p.mesh.positions[2][1] = f32::NAN, "not finite"),
            (&|p| p.tree = OnceLock::from(MeshTree::new(&builtin("knot").mesh)), "tree of another mesh"),
        ];
        for (k, (change, expected)) in changes.into_iter().enumerate() {
            let told = told(change).unwrap_err();
            assert!(told.contains(expected), "{k}: {told}");
        }
    }
}
