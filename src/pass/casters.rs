//! The casters of a pass on the GPU.

use super::Casters;
use super::caster_upload::uploaded;
use super::inputs::{CasterMesh, Inputs};
use super::parts::PartSet;
use crate::gpu::{Buffer, Recorder};
use crate::methods::prepared::{CasterBuffers, MeshBuffers, Prepared, padded, surfaces};
use crate::scene::weld::{UNUSED, weld};
use crate::scene::{AlphaTested, Camera, Mesh, TestedTriangle};
use crate::stages::caster_positions::CasterPositions;
use crate::stages::cluster_bounds::{ClusterBounds, ClusterUses};
use crate::stages::cluster_culling::CLUSTER;
use crate::stages::instance_positions::InstancePositions;
use crate::{Error, Result};
use std::sync::Arc;

/// Source of the places of casters in a frame. A clone is the same memory.
#[derive(Clone)]
pub enum Moves {
    /// Vertices of the application: place and source of each.
    Vertices(Buffer<[u32; 2]>),
    /// Transforms of so many instances: vertex and instance of each place, the vertices of the meshes, and the stage.
    Transforms {
        instances: usize,
        sources: Buffer<[u32; 2]>,
        vertices: Buffer<[f32; 4]>,
        stage: Arc<InstancePositions>,
    },
}

/// The casters on the GPU.
pub struct CasterSet {
    /// The mesh in canonical order, of moving casters the pose at rest, of instances untransformed; and which triangles are of closed bodies:
    /// of casters that move none, for which way they will be turned is not known. The lists that are on the GPU are empty here.
    pub prepared: Arc<Prepared>,
    pub buffers: CasterBuffers,
    /// The number here of each triangle that was given.
    pub numbers: Buffer<u32>,
    /// Source of their places; `None` of casters that stand, and of those in parts.
    pub moves: Option<Moves>,
    /// Those that are in parts: `prepared` is then empty.
    pub parts: Option<PartSet>,
    /// Of casters that move: boxes of their clusters are made anew where they are at their places.
    pub bounds: Option<(ClusterUses, Arc<ClusterBounds>)>,
}

impl CasterSet {
    /// Checks, prepares and uploads them; those that move in clusters where there are `least_culled` triangles at least.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, casters: &Casters, least_culled: usize) -> Result<Self> {
        let slice = |label: &str, data: &[[u32; 2]]| Buffer::from_slice(device, queue, label, data);
        let whole = AlphaTested::default();
        let (casters, tested) = match *casters {
            Casters::Parts { parts, room } => {
                return Self::of_parts(device, queue, PartSet::new(device, queue, parts, room)?);
            }
            Casters::Prepared(prepared) => return Self::of_prepared(device, queue, prepared),
            Casters::Uploaded(uploaded) => return Ok(uploaded.set()),
            Casters::AlphaTested { casters, tested } => (casters, tested),
            _ => (casters, &whole),
        };
        let (mut prepared, moves) = match *casters {
            Casters::AlphaTested { .. } => {
                return Err(Error::Config("casters: alpha-tested ones among alpha-tested ones".to_owned()));
            }
            Casters::Prepared(_) | Casters::Uploaded(_) => {
                return Err(Error::Config("casters: prepared ones are alpha-tested as they were prepared".to_owned()));
            }
            Casters::Parts { .. } => {
                return Err(Error::Config(
                    "parts: which triangles are alpha-tested is said by their meshes".to_owned(),
                ));
            }
            Casters::Instanced { .. } if !tested.is_empty() => {
                return Err(Error::Config(
                    "instances: which triangles are alpha-tested is said by their meshes".to_owned(),
                ));
            }
            Casters::Static { positions, triangles } => {
                (Prepared::with_alpha(&checked(positions, triangles, "casters")?, tested)?, None)
            }
            Casters::Moving { rest, triangles } => {
                let given = checked(rest, triangles, "casters")?;
                let moves = Moves::Vertices(slice("casters.places", &places(&given))?);
                (Prepared::with_alpha(&given, tested)?, Some(moves))
            }
            Casters::Instanced { meshes, instances } => {
                let Instances { prepared, sources, vertices } = Instances::new(meshes, instances)?;
                let moves = Moves::Transforms {
                    instances: instances.len(),
                    sources: slice("casters.sources", &sources)?,
                    vertices: Buffer::from_slice(device, queue, "casters.vertices", &padded(&vertices))?,
                    stage: Arc::new(InstancePositions::new(device)),
                };
                (prepared, Some(moves))
            }
        };
        if moves.is_none() {
            prepared.tree(); // now, and not in the first frame
        } else {
            prepared = prepared.without_bodies();
        }
        let mut buffers = prepared.upload(device, queue)?;
        let mut bounds = None;
        if moves.is_some() {
            buffers.surfaces = None; // what lies in one plane at rest may not in motion
            buffers.clusters = None;
            if prepared.mesh.triangles.len() >= least_culled.max(CLUSTER + 1) {
                bounds = Some((prepared.cluster_uses_on(device, queue)?, Arc::new(ClusterBounds::new(device))));
                buffers.clusters = Some(prepared.moving_clusters_on(device)?);
            }
        }
        let numbers = Buffer::from_slice(device, queue, "casters.numbers", &numbers(&prepared.given))?;
        (prepared.given, prepared.edges, prepared.surfaces, prepared.clusters) = Default::default();
        Ok(Self { prepared: Arc::new(prepared), buffers, numbers, moves, parts: None, bounds })
    }

    /// Uploads casters that stand and are prepared.
    pub fn of_prepared(device: &wgpu::Device, queue: &wgpu::Queue, prepared: &Prepared) -> Result<Self> {
        Ok(uploaded(device, queue, prepared)?.set())
    }

    /// Uploads casters in parts.
    pub fn of_parts(device: &wgpu::Device, queue: &wgpu::Queue, parts: PartSet) -> Result<Self> {
        let (buffers, numbers) = parts.upload(device, queue)?;
        Ok(Self { prepared: Arc::default(), buffers, numbers, moves: None, parts: Some(parts), bounds: None })
    }

    /// The same casters in the same memory.
    ///
    /// # Errors
    /// [`Error::Config`] for casters in parts, which come and go.
    pub fn share(&self) -> Result<Self> {
        if self.parts.is_some() {
            return Err(Error::Config("casters in parts are those of one pass: another is given its own".to_owned()));
        }
        let Self { prepared, buffers, numbers, moves, bounds, .. } = self;
        let (prepared, buffers, numbers) = (prepared.clone(), buffers.clone(), numbers.clone());
        Ok(Self { prepared, buffers, numbers, moves: moves.clone(), parts: None, bounds: bounds.clone() })
    }

    /// Whether all of them stand, so that what is made of them does.
    pub fn stand(&self) -> bool {
        self.moves.is_none() && self.parts.as_ref().is_none_or(PartSet::stand)
    }

    /// Whether their mesh is known as one that stands.
    pub fn are_known(&self) -> bool {
        self.moves.is_none() && self.parts.is_none()
    }

    /// Whether some triangles are alpha-tested.
    pub fn are_tested(&self) -> bool {
        self.parts.as_ref().map_or(!self.prepared.alpha().is_empty(), PartSet::are_tested)
    }

    /// Whether a camera sees no triangle that faces away from it of a closed body that stands, and there are any.
    pub fn hides_backs(&self, camera: &Camera, size: [u32; 2]) -> bool {
        match &self.parts {
            Some(parts) => parts.hides_backs(camera, size),
            None => self.moves.is_none() && self.prepared.hides_backs(camera, size),
        }
    }

    /// Uploads positions and triangles, with room behind them for `room` triangles with vertices of their own.
    pub fn surfaces(&self, device: &wgpu::Device, queue: &wgpu::Queue, room: usize) -> Result<MeshBuffers> {
        match &self.parts {
            Some(parts) => parts.surfaces(device, queue, room),
            None => surfaces(device, queue, &self.prepared, room),
        }
    }

    /// The element behind all triangles and the room from which on alpha-tested ones are told of.
    pub fn first_element(&self) -> usize {
        let CasterBuffers { positions, triangles, .. } = &self.buffers;
        let room = positions.bytes() as usize / size_of::<[f32; 4]>() - positions.len();
        triangles.len() + room / 3
    }

    /// Brings those that move to their places.
    pub fn record_moves(
        &self,
        rec: &mut Recorder,
        gather: &CasterPositions,
        inputs: &Inputs,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        let (positions, homography) = (&self.buffers.positions, inputs.map_of_places());
        if let Some(parts) = &self.parts {
            return parts.record_moves(rec, gather, (inputs.parts, homography), positions, faults);
        }
        match (&self.moves, &inputs.moved, &inputs.placed) {
            (Some(Moves::Vertices(places)), Some(moved), _) => {
                let stage = &mut rec.stage("caster_positions");
                gather.record(stage, moved.vertices, places, (moved.bounds, homography), positions, faults)?;
            }
            (Some(Moves::Transforms { instances, sources, vertices, stage: with }), _, Some(placed)) => {
                let stage = &mut rec.stage("instance_positions");
                let transforms = (placed.transforms, *instances);
                let to = (placed.bounds, homography);
                with.record(stage, transforms, sources, vertices, to, (positions, 0), faults)?;
            }
            _ => return Ok(()),
        }
        match (&self.bounds, &self.buffers.clusters) {
            (Some((uses, with)), Some(clusters)) => {
                with.record(&mut rec.stage("cluster_bounds"), positions, uses, &clusters.boxes)
            }
            _ => Ok(()),
        }
    }

    /// Uses other memory for positions and triangles from now on.
    pub fn take(&mut self, surfaces: Option<MeshBuffers>) {
        if let Some(surfaces) = surfaces {
            (self.buffers.positions, self.buffers.triangles) = surfaces;
        }
    }
}

/// The number in canonical order of each triangle, where `given` is the triangle of each number.
pub fn numbers(given: &[u32]) -> Vec<u32> {
    let mut numbers = vec![0; given.len()];
    for (number, &triangle) in (0..).zip(given) {
        numbers[triangle as usize] = number;
    }
    numbers
}

/// Place of each vertex in the canonical mesh, and the first vertex with that place.
pub fn places(mesh: &Mesh) -> Vec<[u32; 2]> {
    let welded = weld(&mesh.positions, &mesh.triangles);
    let mut first = vec![UNUSED; welded.positions.len()];
    for (v, &place) in (0..).zip(&welded.place) {
        if place != UNUSED && first[place as usize] == UNUSED {
            first[place as usize] = v;
        }
    }
    let of = |&place: &u32| [place, if place == UNUSED { UNUSED } else { first[place as usize] }];
    welded.place.iter().map(of).collect()
}

/// A mesh that has passed [`Mesh::check`].
pub fn checked(positions: &[[f32; 3]], triangles: &[[u32; 3]], name: &str) -> Result<Mesh> {
    let mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec() };
    mesh.check(name)?;
    Ok(mesh)
}

/// Meshes that are prepared, one copy after the other.
pub struct Instances {
    pub prepared: Prepared,
    /// Vertex of the meshes and instance of each place.
    pub sources: Vec<[u32; 2]>,
    pub vertices: Vec<[f32; 3]>,
}

impl Instances {
    pub fn new(meshes: &[CasterMesh], instances: &[u32]) -> Result<Self> {
        let of_mesh = |(k, given): (usize, &CasterMesh)| {
            let mesh = checked(given.positions, given.triangles, &format!("mesh {k} of the casters"))?;
            Prepared::with_alpha(&mesh, given.alpha.unwrap_or(&AlphaTested::default()))
        };
        let meshes = meshes.iter().enumerate().map(of_mesh).collect::<Result<Vec<_>>>()?;
        let vertices: Vec<[f32; 3]> = meshes.iter().flat_map(|m| m.mesh().positions.iter().copied()).collect();
        let firsts: Vec<u32> = meshes
            .iter()
            .scan(0, |next, m| Some(std::mem::replace(next, *next + m.mesh().positions.len() as u32)))
            .collect();
        let mut alpha = AlphaTested::default();
        let mut maps = Vec::with_capacity(meshes.len());
        for mesh in &meshes {
            maps.push(alpha.maps.len() as u32);
            alpha.maps.extend_from_slice(&mesh.alpha().maps);
        }
        let refuse = |message| Err(Error::Mesh { name: "casters".to_owned(), message });
        let mut all = Mesh::default();
        let (mut sources, mut given, mut edges) = (Vec::new(), Vec::new(), Vec::new());
        for (instance, &of) in (0..).zip(instances) {
            let Some(((mesh, first), map)) =
                meshes.get(of as usize).zip(firsts.get(of as usize)).zip(maps.get(of as usize))
            else {
                let have = meshes.len();
                return refuse(format!("instance {instance} is of mesh {of}, there are {have}"));
            };
            let (vertex, triangle) = (all.positions.len() as u32, all.triangles.len() as u32);
            let positions = &mesh.mesh().positions;
            if all.triangles.len() + mesh.mesh().triangles.len() > Mesh::MAX_TRIANGLES {
                let most = Mesh::MAX_TRIANGLES;
                return refuse(format!("up to instance {instance} more than {most} triangles"));
            }
            all.positions.extend_from_slice(positions);
            all.triangles.extend(mesh.mesh().triangles.iter().map(|t| t.map(|v| v + vertex)));
            sources.extend((0..positions.len() as u32).map(|v| [first + v, instance]));
            alpha.triangles.extend(mesh.alpha().triangles.iter().map(|of| TestedTriangle {
                triangle: of.triangle + triangle,
                map: of.map + map,
                ..*of
            }));
            given.extend(mesh.given.iter().map(|t| t + triangle));
            edges.extend(mesh.edges.iter().map(|e| e.moved(vertex, triangle)));
        }
        Ok(Self { prepared: Prepared::of_parts(all, given, edges, alpha), sources, vertices })
    }
}
