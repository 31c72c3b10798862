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
use futures::{AsyncRead, AsyncReadExt, FutureExt};
use std::sync::{Arc, OnceLock};

/// First word of the bytes: their form. Another one for every change to it.
const FORM: u64 = u64::from_le_bytes(*b"spshad02");

/// Bytes that begin each part at a multiple of this.
const WORD: usize = 8;

/// Bytes that are read at once.
const PIECE: usize = 1 << 16;

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
        let mut sum = Checksum::default();
        sum.add(&out.0[2 * WORD..]);
        out.0[WORD..2 * WORD].copy_from_slice(&sum.of_all().to_le_bytes());
        out.0
    }

    /// The mesh of bytes that [`Prepared::to_bytes`] has made.
    ///
    /// # Errors
    /// [`Error::Mesh`] for bytes of another form, which other versions write, for ones that end early or have changed since (a checksum finds
    /// accidents, not intentions), and for numbers out of range.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        // Bytes that are there are read without waiting.
        Self::read(bytes, bytes.len() as u64).now_or_never().unwrap_or_else(|| Err(bad("bytes to wait for")))
    }

    /// The same of so many bytes that arrive bit by bit, as of a file or of a page's worker. Little is held beside what is made of them.
    ///
    /// # Errors
    /// As [`Prepared::from_bytes`], and [`Error::Mesh`] where they cannot be read.
    pub async fn read(from: impl AsyncRead + Unpin, bytes: u64) -> Result<Self> {
        let mut parts = Reader { from, left: bytes, sum: Checksum::default() };
        let mut head = [0u64; 2];
        if bytes < 2 * WORD as u64 {
            return Err(bad("no head of 16 bytes"));
        }
        parts.take(cast_slice_mut(&mut head)).await?;
        let [form, sum] = head;
        if form != FORM {
            return Err(bad("another form of bytes, or none: prepare the mesh again"));
        }
        parts.sum = Checksum::default();
        let (mut mesh, mut given, mut edges, mut bodies) = (Mesh::default(), Vec::new(), Vec::new(), Vec::<u8>::new());
        let (mut surfaces, mut facts) = (Vec::new(), Vec::<u8>::new());
        let mut tree: [(Vec<u32>, Vec<_>); 2] = Default::default();
        let (mut heads, mut alpha) = (Vec::<MapHead>::new(), AlphaTested::default());
        let lists: [&mut dyn Part; 7] =
            [&mut mesh.positions, &mut mesh.triangles, &mut given, &mut edges, &mut bodies, &mut surfaces, &mut facts];
        for list in lists {
            parts.next(list).await?;
        }
        for (order, boxes) in &mut tree {
            parts.next(order).await?;
            parts.next(boxes).await?;
        }
        parts.next(&mut heads).await?;
        for MapHead { size, cutoff, filter, wrap } in heads {
            let filter = if filter == 1 { AlphaFilter::Bilinear } else { AlphaFilter::Nearest };
            let wrap = wrap.map(|number| WRAPS.get(number as usize).copied().unwrap_or_default());
            let mut map = AlphaMap { size, alpha: Vec::new(), cutoff, filter, wrap };
            parts.next(&mut map.alpha).await?;
            alpha.maps.push(map);
        }
        let mut tested = Vec::<Tested>::new();
        parts.next(&mut tested).await?;
        let of_tested = |of: Tested| {
            let [casts, receives, seen, _] = of.roles;
            let roles = Roles { casts, receives, seen: seen != 0 };
            TestedTriangle { triangle: of.triangle, map: of.map, uv: of.uv, roles }
        };
        alpha.triangles.extend(tested.into_iter().map(of_tested));
        if parts.left > 0 {
            return Err(bad(&format!("{} bytes too many", parts.left)));
        }
        if sum != parts.sum.of_all() {
            return Err(bad(&format!("the checksum of {bytes} bytes is another one")));
        }
        let [closed, flat] = facts[..] else { return Err(bad("no facts of the whole mesh")) };
        mesh.check("prepared bytes")?;
        alpha.check(&mesh)?;
        let tree = MeshTree::of_bytes(tree, mesh.triangles.len()).ok_or_else(|| bad("a tree of another mesh"))?;
        let known = KnownFacts { in_one_plane: OnceLock::from(flat != 0), ..KnownFacts::default() };
        let bodies = bodies.into_iter().map(|body| body != 0).collect::<Vec<_>>();
        let (mesh, bodies, alpha) = (mesh.into(), bodies.into(), alpha.into());
        let tree = Arc::new(OnceLock::from(tree));
        let (closed, clusters) = (closed != 0, Vec::new());
        let read = Self { mesh, given, edges, closed, bodies, surfaces, clusters, alpha, tree, known };
        if !read.is_in_range() {
            return Err(bad("numbers of triangles or vertices out of range"));
        }
        Ok(read.in_clusters())
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

fn bad(message: &str) -> Error {
    Error::mesh("prepared bytes", message)
}

/// Four sums of every fourth word, each multiplied on its way, so that order counts.
struct Checksum {
    sums: [u64; 4],
    /// Words that were added.
    words: usize,
}

impl Default for Checksum {
    fn default() -> Self {
        Self { sums: [1, 2, 3, 4], words: 0 }
    }
}

impl Checksum {
    const ODD: u64 = 0x9E37_79B9_7F4A_7C15;

    fn mixed(sum: u64, word: u64) -> u64 {
        (sum ^ word).wrapping_mul(Self::ODD).rotate_left(29)
    }

    /// Adds bytes; what lacks to a whole word counts as 0.
    fn add(&mut self, bytes: &[u8]) {
        // Four at a time, where the first one has its turn.
        let first = bytes.len().min(self.words.wrapping_neg() % 4 * WORD);
        let (before, bytes) = bytes.split_at(first);
        self.add_words(before);
        let (runs, rest) = bytes.as_chunks::<{ 4 * WORD }>();
        for run in runs {
            let words: [u64; 4] = bytemuck::pod_read_unaligned(run);
            for (sum, word) in self.sums.iter_mut().zip(words) {
                *sum = Self::mixed(*sum, word);
            }
        }
        self.words += 4 * runs.len();
        self.add_words(rest);
    }

    fn add_words(&mut self, bytes: &[u8]) {
        for bytes in bytes.chunks(WORD) {
            let word = bytes.iter().rev().fold(0u64, |word, byte| word << 8 | u64::from(*byte));
            let sum = &mut self.sums[self.words % 4];
            *sum = Self::mixed(*sum, word);
            self.words += 1;
        }
    }

    fn of_all(&self) -> u64 {
        self.sums.into_iter().chain([self.words as u64]).fold(0, Self::mixed)
    }
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
struct Reader<R> {
    from: R,
    /// Bytes to come.
    left: u64,
    /// Of the bytes that were read.
    sum: Checksum,
}

impl<R: AsyncRead + Unpin> Reader<R> {
    /// Reads bytes, a multiple of [`WORD`] but for the last ones of a part.
    async fn take(&mut self, into: &mut [u8]) -> Result<()> {
        // As they arrive, while they are in the cache.
        for piece in into.chunks_mut(PIECE) {
            self.from.read_exact(piece).await.map_err(|e| bad(&format!("{} bytes are left: {e}", self.left)))?;
            self.sum.add(piece);
            self.left -= piece.len() as u64;
        }
        Ok(())
    }

    async fn next(&mut self, part: &mut dyn Part) -> Result<()> {
        let more = |left| bad(&format!("{left} bytes are left, and there is more to come"));
        let left = self.left.checked_sub(WORD as u64).ok_or_else(|| more(self.left))?;
        let mut bytes = [0u64];
        self.take(cast_slice_mut(&mut bytes)).await?;
        let [bytes] = bytes;
        let end = bytes.checked_next_multiple_of(WORD as u64).filter(|&end| end <= left).ok_or_else(|| more(left))?;
        self.take(part.of_bytes(bytes).ok_or_else(|| more(left))?).await?;
        let mut padding = [0; WORD];
        let padding = &mut padding[..(end - bytes) as usize];
        self.from.read_exact(padding).await.map_err(|e| bad(&format!("{} bytes are left: {e}", self.left)))?;
        self.left -= padding.len() as u64;
        if padding.iter().any(|&byte| byte != 0) {
            return Err(bad("no zeros between its parts"));
        }
        Ok(())
    }
}

/// A list that is read.
trait Part {
    /// Makes it as long as so many bytes: these.
    fn of_bytes(&mut self, bytes: u64) -> Option<&mut [u8]>;
}

impl<T: Pod> Part for Vec<T> {
    fn of_bytes(&mut self, bytes: u64) -> Option<&mut [u8]> {
        let size = size_of::<T>() as u64;
        let count = usize::try_from(bytes / size).ok().filter(|_| bytes.is_multiple_of(size))?;
        *self = vec![T::zeroed(); count];
        Some(cast_slice_mut(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Light;
    use crate::test_scenes::builtin;
    use futures::executor::block_on;
    use std::pin::Pin;
    use std::task::{Context, Poll};

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

    /// Bytes that arrive a few at a time, or that cannot be read.
    #[test]
    fn bytes_may_arrive_in_pieces() {
        struct Few<'a>(&'a [u8], bool);
        impl AsyncRead for Few<'_> {
            fn poll_read(
                mut self: Pin<&mut Self>,
                with: &mut Context,
                into: &mut [u8],
            ) -> Poll<std::io::Result<usize>> {
                self.1 = !self.1;
                if self.1 {
                    with.waker().wake_by_ref();
                    return Poll::Pending;
                }
                let few = into.len().min(977);
                Pin::new(&mut self.0).poll_read(with, &mut into[..few])
            }
        }
        let prepared = tested(&builtin("knot").mesh);
        let bytes = prepared.to_bytes();
        let read = |bytes: &[u8], told: usize| block_on(Prepared::read(Few(bytes, false), told as u64));
        assert_eq!(all_of(&read(&bytes, bytes.len()).unwrap()), all_of(&prepared));
        let error = read(&bytes[..bytes.len() / 2], bytes.len()).map(drop).unwrap_err().to_string();
        assert!(error.contains("unexpected end of file") && error.contains("bytes are left"), "{error}");
    }

    /// Any byte that is another one, and any end that is missing, is told of.
    #[test]
    fn damage_is_an_error() {
        let bytes = tested(&builtin("spheres").mesh).to_bytes();
        let told = |bytes: &[u8]| Prepared::from_bytes(bytes).map(drop).unwrap_err().to_string();
        let mut checked = 0;
        for at in (0..bytes.len()).step_by(bytes.len() / 61).chain([0, 8, 16, bytes.len() - 1]) {
            let mut other = bytes.clone();
            other[at] ^= 4;
            let told = told(&other);
            let expected: &[&str] = match at {
                ..WORD => &["another form"],
                // Of a length or of what lies behind a part it is told before all is read.
                _ => &["checksum", "more to come", "too many", "no zeros"],
            };
            assert!(expected.iter().any(|text| told.contains(text)), "byte {at}: {told}");
            checked += usize::from(told.contains("checksum"));
            assert!(Prepared::from_bytes(&bytes[..at]).is_err());
        }
        assert!(checked > 50, "{checked}");
        assert!(told(&bytes[..10]).contains("16 bytes"));
        // With the right sum: the form itself.
        let summed = |mut bytes: Vec<u8>| {
            let mut sum = Checksum::default();
            sum.add(&bytes[2 * WORD..]);
            bytes[WORD..2 * WORD].copy_from_slice(&sum.of_all().to_le_bytes());
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
            (&|p| _ = Arc::make_mut(&mut p.bodies).pop(), "out of range"),
            (&|p| Arc::make_mut(&mut p.mesh).positions[2][1] = f32::NAN, "not finite"),
            (&|p| p.tree = Arc::new(OnceLock::from(MeshTree::new(&builtin("knot").mesh))), "tree of another mesh"),
        ];
        for (k, (change, expected)) in changes.into_iter().enumerate() {
            let told = told(change).unwrap_err();
            assert!(told.contains(expected), "{k}: {told}");
        }
    }
}
