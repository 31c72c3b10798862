//! A mesh made ready for the GPU: topology is found once, vertices may move afterwards.

use crate::Result;
use crate::gpu::Buffer;
use crate::light_view::MeshAndTree;
use crate::scene::adjacency::{Adjacency, Edge};
use crate::scene::mesh_tree::MeshTree;
use crate::scene::objects::object_boxes;
use crate::scene::{AlphaTested, Camera, Light, Mesh};
use crate::stages::cluster_bounds::{ClusterUses, cluster_uses};
use crate::stages::cluster_culling::{CLUSTER, ClusterBox, Clusters, cluster_boxes};
use crate::stages::sample_surfaces::SEVERAL;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, OnceLock};

/// Most objects that are told apart.
const MOST_OBJECTS: usize = 64;

/// A mesh in canonical order with its edges.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    pub(crate) mesh: Arc<Mesh>,
    /// Triangle of the given mesh for each triangle here.
    pub given: Vec<u32>,
    /// Its edges.
    pub edges: Vec<Edge>,
    /// Whether every edge joins two consistently wound triangles and every part is turned outward.
    pub closed: bool,
    /// Whether the connected part of the mesh around each triangle is closed and turned outward.
    pub bodies: Arc<Vec<bool>>,
    /// Lowest triangle of each triangle's surface: the edge-connected ones that lie in one plane, exactly.
    pub surfaces: Vec<u32>,
    /// Boxes of its clusters; none where one holds it all.
    pub(crate) clusters: Vec<ClusterBox>,
    /// Its triangles that are alpha-tested.
    pub(crate) alpha: Arc<AlphaTested>,
    pub(super) tree: Arc<OnceLock<MeshTree>>,
    pub(crate) known: KnownFacts,
}

/// Findings of proofs about the mesh, so that a frame like the one before asks little.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownFacts {
    /// Whether all vertices lie in one plane.
    pub in_one_plane: OnceLock<bool>,
    /// Boxes of its objects.
    pub objects: OnceLock<Vec<(DVec3, DVec3)>>,
    /// Its triangles that cast in no light.
    pub silent: OnceLock<BTreeSet<u32>>,
    /// The tree of the others; `None` where all cast.
    pub casting: OnceLock<Option<Arc<MeshTree>>>,
    /// A triangle that may show eye and light the same side.
    pub facing_both: Counterexample,
    /// One that may not.
    pub facing_one: Counterexample,
    /// One that may face the light.
    pub facing_light: Counterexample,
}

/// A triangle for which something did not hold, which is asked first.
#[derive(Debug, Default)]
pub(crate) struct Counterexample(AtomicUsize);

impl Clone for Counterexample {
    fn clone(&self) -> Self {
        Self(AtomicUsize::new(self.0.load(Relaxed)))
    }
}

impl Counterexample {
    /// Whether something holds for each of so many triangles.
    pub fn all(&self, triangles: usize, holds: impl Fn(usize) -> bool + Sync) -> bool {
        let last = self.0.load(Relaxed);
        if last < triangles && !holds(last) {
            return false;
        }
        let Some(found) = (0..triangles).into_par_iter().find_any(|&t| !holds(t)) else { return true };
        self.0.store(found, Relaxed);
        false
    }
}

impl Prepared {
    /// Prepares `mesh`.
    ///
    /// # Errors
    /// As [`Mesh::check`].
    pub fn new(mesh: &Mesh) -> Result<Self> {
        Self::with_alpha(mesh, &AlphaTested::default())
    }

    /// As [`Prepared::new`], where some of the triangles have holes.
    ///
    /// # Errors
    /// As [`Mesh::check`] and [`AlphaTested::check`].
    pub fn with_alpha(mesh: &Mesh, alpha: &AlphaTested) -> Result<Self> {
        mesh.check("mesh")?;
        alpha.check(mesh)?;
        let (canonical, given) = mesh.canonical();
        let alpha = if alpha.is_empty() { alpha.clone() } else { alpha.renumbered(mesh, &canonical, &given) };
        let alone: Vec<u32> = alpha.triangles.iter().map(|of| of.triangle).collect();
        let Adjacency { edges, closed, bodies, surfaces, .. } = Adjacency::but_for(&canonical, &alone);
        let prepared = Self {
            mesh: Arc::new(canonical),
            given,
            edges,
            closed,
            bodies: Arc::new(bodies),
            surfaces,
            clusters: Vec::new(),
            alpha: Arc::new(alpha),
            tree: Arc::default(),
            known: KnownFacts::default(),
        };
        Ok(prepared.in_clusters())
    }

    /// The same with boxes of its clusters, where it has several.
    pub(super) fn in_clusters(self) -> Self {
        let several = self.mesh.triangles.len() > CLUSTER;
        let clusters = if several { cluster_boxes(&self.mesh, &self.edges) } else { Vec::new() };
        Self { clusters, ..self }
    }

    /// Boxes that hold its connected parts, no more than 64 of one or several each: found once.
    pub fn objects(&self) -> &[(DVec3, DVec3)] {
        self.known.objects.get_or_init(|| object_boxes(&self.mesh, MOST_OBJECTS))
    }

    /// Its triangles that are alpha-tested, by their numbers here.
    pub fn alpha(&self) -> &AlphaTested {
        &self.alpha
    }

    /// Of prepared parts, of which nothing is known together: triangles that were given, edges, and which are alpha-tested.
    pub(crate) fn of_parts(mesh: Mesh, given: Vec<u32>, edges: Vec<Edge>, alpha: AlphaTested) -> Self {
        let triangles = mesh.triangles.len();
        Self {
            mesh: Arc::new(mesh),
            given,
            edges,
            closed: false,
            bodies: Arc::new(vec![false; triangles]),
            surfaces: (0..triangles as u32).collect(),
            clusters: Vec::new(),
            alpha: Arc::new(alpha),
            tree: Arc::default(),
            known: KnownFacts::default(),
        }
    }

    /// The same memory without the lists that only an upload asks for.
    pub(crate) fn geometry(&self) -> Self {
        let Self { mesh, closed, bodies, alpha, tree, known, .. } = self;
        let (mesh, bodies, alpha, tree) = (mesh.clone(), bodies.clone(), alpha.clone(), tree.clone());
        let (closed, known) = (*closed, known.clone());
        let (given, edges, surfaces, clusters) = Default::default();
        Self { mesh, closed, bodies, alpha, tree, known, given, edges, surfaces, clusters }
    }

    /// The same, of which it is not known which triangles are of closed bodies, as where they will move.
    pub(crate) fn without_bodies(self) -> Self {
        Self { bodies: Arc::new(vec![false; self.mesh.triangles.len()]), ..self }
    }

    /// The mesh: vertices welded and sorted, triangles rotated and sorted, so that nothing depends on the file's order. It has passed
    /// [`Mesh::check`].
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Lowest and highest corner of its triangles, world units; none without triangles.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.tree().bounds().map(|(low, high)| [low, high])
    }

    /// The tree of the mesh, made when it is first asked for: with it the light's views take no walk over all triangles.
    pub(crate) fn tree(&self) -> &MeshTree {
        self.tree.get_or_init(|| MeshTree::new(&self.mesh))
    }

    pub(crate) fn casters(&self) -> MeshAndTree<'_> {
        MeshAndTree { mesh: &self.mesh, tree: self.tree() }
    }

    /// Those of the triangles that cast in some light ([`Roles::casts`](crate::scene::Roles::casts)): in a tree of their own where others do not.
    pub(crate) fn casting(&self) -> MeshAndTree<'_> {
        let own = self.known.casting.get_or_init(|| {
            let silent = self.silent();
            (!silent.is_empty()).then(|| Arc::new(MeshTree::of(&self.mesh, |t| !silent.contains(&t))))
        });
        own.as_ref().map_or_else(|| self.casters(), |tree| MeshAndTree { mesh: &self.mesh, tree })
    }

    /// Those that do not.
    fn silent(&self) -> &BTreeSet<u32> {
        let of_alpha = || self.alpha.triangles.iter().filter(|of| of.roles.casts == 0).map(|of| of.triangle).collect();
        self.known.silent.get_or_init(of_alpha)
    }

    /// Whether no triangle casts in any light.
    pub(crate) fn none_cast(&self) -> bool {
        self.silent().len() == self.mesh.triangles.len()
    }

    /// Whether `light` is outside all closed bodies that are turned outward ([`Prepared::bodies`]), and there are any: what turns away
    /// from it of these adds nothing to the shadow. A light that is nearer than 10^-9 of the mesh's size to one counts as inside.
    pub(crate) fn backs_add_nothing(&self, light: &Light) -> bool {
        self.bodies.contains(&true) && (light.is_directional() || self.bodies_around(light) == Some(0))
    }

    /// Whether a camera sees no triangle that faces away from it of a closed body ([`Prepared::bodies`]), and there are any: each lies
    /// behind one that does not. Its eye is outside all of these, and none comes nearer to it than the near distance in any corner of
    /// an image of this size.
    pub(crate) fn hides_backs(&self, camera: &Camera, [width, height]: [u32; 2]) -> bool {
        // An oblique near plane may cut bodies open.
        if camera.near_plane.is_some() || !self.bodies.contains(&true) {
            return false;
        }
        let rays = camera.rays(width, height.max(1));
        self.around(rays.eye, 1.01 * rays.longest(width, height) * f64::from(camera.near)) == Some(0)
    }

    /// How many closed bodies are around a point, or `None` if one comes as near as `slack`, or 10^-9 of the mesh's size.
    fn around(&self, at: DVec3, slack: f64) -> Option<i64> {
        let (low, high) = self.tree().bounds()?;
        let of_body = |t: u32| self.bodies.get(t as usize) == Some(&true);
        self.tree().winding(&self.mesh, at, slack.max(1e-9 * (high - low).length()), of_body)
    }

    /// How many closed bodies a light that is not at infinity is in, or `None` where it is as good as on one.
    pub(crate) fn bodies_around(&self, light: &Light) -> Option<i64> {
        self.around(light.homogeneous().truncate(), 0.0)
    }

    /// Whether any two triangles are one surface.
    pub fn merges(&self) -> bool {
        (0..).zip(&self.surfaces).any(|(t, &surface)| t != surface)
    }

    /// Uploads it.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<CasterBuffers> {
        let (positions, triangles) = surfaces(device, queue, self, 0)?;
        Ok(CasterBuffers {
            positions,
            triangles,
            edges: Buffer::from_slice(device, queue, "casters.edges", &self.edges)?,
            surfaces: self
                .merges()
                .then(|| Buffer::from_slice(device, queue, "casters.surfaces", &marked_surfaces(&self.surfaces)))
                .transpose()?,
            clusters: self.clusters_on(device)?.inspect(|clusters| clusters.boxes.write(queue, &self.clusters)),
        })
    }

    /// Memory for the clusters of a mesh whose vertices move, which has no boxes of vertices.
    pub(crate) fn moving_clusters_on(&self, device: &wgpu::Device) -> Result<Clusters> {
        let elements = [self.mesh.triangles.len(), self.edges.len(), 0];
        let count = elements.iter().map(|n| n.div_ceil(CLUSTER)).sum();
        Ok(Clusters { boxes: Buffer::storage(device, "casters.clusters", count)?, elements })
    }

    /// Clusters of vertices that those of its triangles and edges use.
    pub(crate) fn cluster_uses_on(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<ClusterUses> {
        ClusterUses::new(device, queue, &cluster_uses(&self.mesh, &self.edges), self.mesh.positions.len())
    }

    /// Memory for its clusters.
    fn clusters_on(&self, device: &wgpu::Device) -> Result<Option<Clusters>> {
        if self.clusters.is_empty() {
            return Ok(None);
        }
        let elements = [self.mesh.triangles.len(), self.edges.len(), self.mesh.positions.len()];
        Ok(Some(Clusters { boxes: Buffer::storage(device, "casters.clusters", self.clusters.len())?, elements }))
    }
}

impl CasterBuffers {
    /// Memory for a mesh, into which nothing is written.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn of(device: &wgpu::Device, prepared: &Prepared) -> Result<Self> {
        let (mesh, room) = (prepared.mesh(), prepared.alpha.elements());
        let surfaces = || Buffer::storage(device, "casters.surfaces", prepared.surfaces.len());
        Ok(Self {
            positions: Buffer::storage(device, "casters.positions", mesh.positions.len())?,
            triangles: Buffer::storage_with_room(device, "casters.triangles", mesh.triangles.len(), room)?,
            edges: Buffer::storage(device, "casters.edges", prepared.edges.len())?,
            surfaces: prepared.merges().then(surfaces).transpose()?,
            clusters: prepared.clusters_on(device)?,
        })
    }
}

/// Surfaces of triangles, those of more than one marked.
pub fn marked_surfaces(surfaces: &[u32]) -> Vec<u32> {
    let mut marked = surfaces.to_vec();
    for (t, &surface) in surfaces.iter().enumerate().filter(|(t, s)| *t as u32 != **s) {
        marked[t] |= SEVERAL;
        marked[surface as usize] |= SEVERAL;
    }
    marked
}

/// Positions and triangles of a mesh, uploaded.
pub type MeshBuffers = (Buffer<[f32; 4]>, Buffer<[u32; 4]>);

/// As kernels read them, 16 bytes each: an adapter that goes through lanes one by one pays by load, not by word.
pub fn padded<T: Copy + Default>(elements: &[[T; 3]]) -> Vec<[T; 4]> {
    elements.iter().map(|&[x, y, z]| [x, y, z, T::default()]).collect()
}

/// All triangles as [`marked_triangles_in`] gives a range of them.
pub fn marked_triangles(prepared: &Prepared, first: usize) -> Vec<[u32; 4]> {
    marked_triangles_in(prepared, first, 0..prepared.mesh.triangles.len())
}

/// A range of triangles as kernels read them; the fourth word is 1 for one of a closed body, one more than the number of the element where an
/// alpha-tested one is told of, of which `first` is the first, and 0 for others.
pub fn marked_triangles_in(prepared: &Prepared, first: usize, range: Range<usize>) -> Vec<[u32; 4]> {
    let of_body = prepared.bodies.iter().skip(range.start).copied().chain(std::iter::repeat(false));
    let triangles = &prepared.mesh.triangles[range.clone()];
    let marked = triangles.iter().zip(of_body).map(|(&[a, b, c], body)| [a, b, c, u32::from(body)]);
    let mut marked: Vec<[u32; 4]> = marked.collect();
    for (k, of) in prepared.alpha.triangles.iter().enumerate() {
        if let Some(marked) = (of.triangle as usize).checked_sub(range.start).and_then(|t| marked.get_mut(t)) {
            marked[3] = (first + 2 * k + 1) as u32;
        }
    }
    marked
}

/// Uploads positions and triangles, with room behind them for `room` triangles with vertices of their own, and behind that what kernels know
/// of alpha-tested triangles.
///
/// # Errors
/// As [`Buffer::storage`].
pub fn surfaces(device: &wgpu::Device, queue: &wgpu::Queue, prepared: &Prepared, room: usize) -> Result<MeshBuffers> {
    let Prepared { mesh, alpha, .. } = prepared;
    let first = mesh.triangles.len() + room;
    let (positions, marked) = (padded(&mesh.positions), marked_triangles(prepared, first));
    let positions = Buffer::with_room(device, queue, "casters.positions", &positions, 3 * room)?;
    let triangles = Buffer::with_room(device, queue, "casters.triangles", &marked, room + alpha.elements())?;
    if !alpha.is_empty() {
        triangles.write_from(queue, first, &alpha.packed(first as u32));
    }
    Ok((positions, triangles))
}

/// A mesh on the GPU. A clone is the same memory.
#[derive(Clone, Debug)]
pub struct CasterBuffers {
    /// Positions, world units, and 0.
    pub positions: Buffer<[f32; 4]>,
    /// Vertex indices of each triangle, and 1 where it is of a closed body ([`Prepared::bodies`]), else 0; or where among the elements behind
    /// the last triangle an alpha-tested one is told of.
    pub triangles: Buffer<[u32; 4]>,
    /// Edges with their two triangles.
    pub edges: Buffer<Edge>,
    /// Lowest triangle of each triangle's surface, with [`SEVERAL`] where that has more than one; none if all have one.
    pub surfaces: Option<Buffer<u32>>,
    /// Clusters of casters that stand.
    pub clusters: Option<Clusters>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light_view::{LightView, Receivers};
    use crate::samples::{Pattern, Samples};
    use crate::scene::Roles;

    #[test]
    fn a_mesh_built_by_hand_that_cannot_be_used_is_an_error() {
        let positions = vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 1.0]];
        let sound = Mesh { positions, triangles: vec![[0, 1, 2]] };
        let no_vertex = Mesh { triangles: vec![[0, 1, 2], [0, 1, 3]], ..sound.clone() };
        let mut not_finite = sound.clone();
        not_finite.positions[1][2] = f32::NAN;
        let light = Light::Directional { direction: [0.3, 1.0, 0.2] };
        for (mesh, expected) in [
            (&sound, None),
            (&no_vertex, Some("triangle 1 uses vertex 3, the mesh has 3")),
            (&not_finite, Some("vertex 1 (1, 1, NaN) is not finite")),
        ] {
            let views = [Receivers::Outsides, Receivers::Surfaces, Receivers::Planes, Receivers::Anything];
            let views = views.map(|receivers| LightView::fit_for(mesh, &light, 64, receivers).map(drop));
            for got in std::iter::once(Prepared::new(mesh).map(drop)).chain(views) {
                let message = got.err().map(|e| e.to_string());
                match expected {
                    None => assert_eq!(message, None),
                    Some(text) => assert!(message.as_ref().is_some_and(|m| m.contains(text)), "{message:?}"),
                }
            }
        }
    }

    #[test]
    fn what_casts_nothing_does_not_widen_the_light_view() {
        // Balls without their slab.
        let mut scene = crate::test_scenes::builtin("spheres");
        scene.mesh.triangles.drain(..12);
        let (mut mesh, casters) = (scene.mesh.clone(), scene.mesh.triangles.len() as u32);
        // A terrain of small triangles.
        const SIDE: u32 = 80;
        let first = mesh.positions.len() as u32;
        let place = |k: u32| 0.5 * (k as f32 - 0.5 * SIDE as f32);
        mesh.positions.extend((0..=SIDE * (SIDE + 2)).map(|k| [place(k % (SIDE + 1)), -3.0, place(k / (SIDE + 1))]));
        for k in (0..SIDE * (SIDE + 1)).filter(|k| k % (SIDE + 1) < SIDE) {
            let corner = first + k;
            mesh.triangles.push([corner, corner + SIDE + 1, corner + 1]);
        }
        let mut silent = AlphaTested::default();
        silent.set_roles(casters..mesh.triangles.len() as u32, Roles::RECEIVE_ONLY);
        let settings = crate::methods::Settings::new([64, 48], 256, Samples::new(Pattern::LowDiscrepancy, 8).unwrap());
        for light in [scene.light, Light::Point { position: [2.0, 9.0, 1.0] }] {
            let view = |mesh: &Mesh, alpha: &AlphaTested| {
                settings.light_view(&Prepared::with_alpha(mesh, alpha).unwrap(), &light).unwrap()
            };
            let fine = |view: &LightView| view.texels_across().element_product();
            let [alone, all] = [&scene.mesh, &mesh].map(|mesh| view(mesh, &AlphaTested::default()));
            let told = view(&mesh, &silent);
            assert!(told.complete && fine(&told) > 0.3 * fine(&alone), "{} of {}", fine(&told), fine(&alone));
            assert!(fine(&told) > 5.0 * fine(&all), "{} of {}", fine(&told), fine(&all));
            for p in (0..casters as usize).flat_map(|t| scene.mesh.corners(t)) {
                let at = told.project(p).unwrap().truncate();
                assert!(at.min_element() >= 0.0 && at.max_element() <= 256.0, "{p:?} at {at}");
            }
        }
        // Where nothing casts there is a view all the same.
        silent.set_roles(0..casters, Roles::NEITHER);
        let none = Prepared::with_alpha(&mesh, &silent).unwrap();
        assert!(none.none_cast() && settings.light_view(&none, &scene.light).unwrap().complete);
    }

    #[test]
    fn a_light_is_in_a_body_or_outside() {
        let prepared = Prepared::new(&crate::test_scenes::builtin("knot").mesh).unwrap();
        let mesh = &prepared.mesh;
        let at = |position| prepared.backs_add_nothing(&Light::Point { position });
        // Above, in the slab, in the hole of the knot, beneath the slab.
        assert!(at([0.0, 9.0, 0.0]) && !at([0.0, -0.2, 0.0]) && at([0.0, 1.9, 0.0]) && at([0.0, -0.6, 0.0]));
        assert!(prepared.backs_add_nothing(&Light::Directional { direction: [0.0, 1.0, 0.0] }));
        let mut found = [0, 0];
        for p in mesh.positions.iter().skip(8).step_by(97) {
            // The centre line of a tube is inside it.
            let inwards = |share: f32| at([p[0] * share, p[1], p[2] * share]);
            found[usize::from(inwards(1.001))] += 1;
            found[usize::from(inwards(0.999))] += 1;
        }
        assert!(found[0] > 100 && found[1] > 100, "{found:?}");
    }

    /// A camera above the slab sees no back, one in it or so near to it that the near distance reaches into it does, and of an open
    /// mesh every triangle counts.
    #[test]
    fn a_camera_outside_bodies_sees_no_backs() {
        let mesh = crate::test_scenes::builtin("knot").mesh;
        let prepared = Prepared::new(&mesh).unwrap();
        let at = |eye, near| {
            let camera = Camera { eye, near, target: [0.1, 1.0, 0.2], ..crate::test_scenes::builtin("knot").camera };
            prepared.hides_backs(&camera, [64, 48])
        };
        assert!(at([0.0, 9.0, 0.0], 0.01) && !at([0.0, -0.2, 0.0], 0.01) && at([0.0, 1.9, 0.0], 0.01));
        assert!(at([9.0, 0.5, 9.0], 0.01) && !at([9.0, 0.5, 9.0], 20.0), "the near distance reaches to the slab");
        let open = Mesh { triangles: mesh.triangles[1..].to_vec(), ..mesh };
        let camera = crate::test_scenes::builtin("knot").camera;
        assert!(prepared.hides_backs(&camera, [64, 48]));
        let part = Prepared::new(&open).unwrap();
        assert!(part.bodies.contains(&false) && part.bodies.contains(&true), "one body is open");
        assert!(
            !Prepared::new(&Mesh { triangles: vec![open.triangles[0]], ..open })
                .unwrap()
                .hides_backs(&camera, [64, 48])
        );
    }
}
