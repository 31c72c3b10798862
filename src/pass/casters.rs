//! The casters of a pass on the GPU.

use super::Casters;
use super::inputs::{CasterMesh, Inputs};
use crate::gpu::{Buffer, Recorder};
use crate::methods::prepared::{CasterBuffers, MeshBuffers, Prepared, padded};
use crate::scene::adjacency::{Edge, NO_TRIANGLE};
use crate::scene::weld::{UNUSED, weld};
use crate::scene::{AlphaTested, Mesh, TestedTriangle};
use crate::stages::caster_positions::CasterPositions;
use crate::stages::instance_positions::InstancePositions;
use crate::{Error, Result};

/// Source of the places of casters in a frame.
pub enum Moves {
    /// Vertices of the application: place and source of each.
    Vertices(Buffer<[u32; 2]>),
    /// Transforms of so many instances: vertex and instance of each place, the vertices of the meshes, and the stage.
    Transforms { instances: usize, sources: Buffer<[u32; 2]>, vertices: Buffer<[f32; 4]>, stage: InstancePositions },
}

/// The casters on the GPU.
pub struct CasterSet {
    /// The mesh in canonical order, of moving casters the pose at rest, of instances untransformed; and which triangles are of closed bodies:
    /// of casters that move none, for which way they will be turned is not known. The lists that are on the GPU are empty here.
    pub prepared: Prepared,
    pub buffers: CasterBuffers,
    /// The number here of each triangle that was given.
    pub numbers: Buffer<u32>,
    /// Source of their places; `None` of casters that stand.
    pub moves: Option<Moves>,
}

impl CasterSet {
    /// Checks, prepares and uploads them.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, casters: &Casters) -> Result<Self> {
        let slice = |label: &str, data: &[[u32; 2]]| Buffer::from_slice(device, queue, label, data);
        let whole = AlphaTested::default();
        let (casters, tested) = match *casters {
            Casters::Prepared(prepared) => return Self::of_prepared(device, queue, prepared),
            Casters::AlphaTested { casters, tested } => (casters, tested),
            _ => (casters, &whole),
        };
        let (mut prepared, moves) = match *casters {
            Casters::AlphaTested { .. } => {
                return Err(Error::Config("casters: alpha-tested ones among alpha-tested ones".to_owned()));
            }
            Casters::Prepared(_) => {
                return Err(Error::Config("casters: prepared ones are alpha-tested as they were prepared".to_owned()));
            }
            Casters::Instanced { .. } if !tested.is_empty() => {
                return Err(Error::Config(
                    "instances: which triangles are alpha-tested is said by their meshes".to_owned(),
                ));
            }
            Casters::Static { positions, triangles } => {
                (Prepared::with_alpha(&checked(positions, triangles)?, tested)?, None)
            }
            Casters::Moving { rest, triangles } => {
                let given = checked(rest, triangles)?;
                let moves = Moves::Vertices(slice("casters.places", &places(&given))?);
                (Prepared::with_alpha(&given, tested)?, Some(moves))
            }
            Casters::Instanced { meshes, instances } => {
                let Instances { prepared, sources, vertices } = Instances::new(meshes, instances)?;
                let moves = Moves::Transforms {
                    instances: instances.len(),
                    sources: slice("casters.sources", &sources)?,
                    vertices: Buffer::from_slice(device, queue, "casters.vertices", &padded(&vertices))?,
                    stage: InstancePositions::new(device),
                };
                (prepared, Some(moves))
            }
        };
        if moves.is_none() {
            prepared.tree(); // now, and not in the first frame
        } else {
            prepared.bodies.fill(false);
        }
        let mut buffers = prepared.upload(device, queue)?;
        if moves.is_some() {
            buffers.surfaces = None; // what lies in one plane at rest may not in motion
        }
        let numbers = Buffer::from_slice(device, queue, "casters.numbers", &numbers(&prepared.given))?;
        (prepared.given, prepared.edges, prepared.surfaces) = Default::default();
        Ok(Self { prepared, buffers, numbers, moves })
    }

    /// Uploads casters that stand and are prepared.
    pub fn of_prepared(device: &wgpu::Device, queue: &wgpu::Queue, prepared: &Prepared) -> Result<Self> {
        prepared.tree(); // of the original, so that all who use it have it
        let buffers = prepared.upload(device, queue)?;
        let numbers = Buffer::from_slice(device, queue, "casters.numbers", &numbers(&prepared.given))?;
        Ok(Self { prepared: prepared.geometry(), buffers, numbers, moves: None })
    }

    /// Brings those that move to their places.
    pub fn record_moves(
        &self,
        rec: &mut Recorder,
        gather: &CasterPositions,
        inputs: &Inputs,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        let positions = &self.buffers.positions;
        match (&self.moves, &inputs.moved, &inputs.placed) {
            (Some(Moves::Vertices(places)), Some(moved), _) => {
                let stage = &mut rec.stage("caster_positions");
                gather.record(stage, moved.vertices, places, moved.bounds, positions, faults)
            }
            (Some(Moves::Transforms { instances, sources, vertices, stage: with }), _, Some(placed)) => {
                let stage = &mut rec.stage("instance_positions");
                let transforms = (placed.transforms, *instances);
                with.record(stage, transforms, sources, vertices, placed.bounds, positions, faults)
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
fn numbers(given: &[u32]) -> Vec<u32> {
    let mut numbers = vec![0; given.len()];
    for (number, &triangle) in (0..).zip(given) {
        numbers[triangle as usize] = number;
    }
    numbers
}

/// Place of each vertex in the canonical mesh, and the first vertex with that place.
fn places(mesh: &Mesh) -> Vec<[u32; 2]> {
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

fn checked(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Mesh> {
    let mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec() };
    mesh.check("casters")?;
    Ok(mesh)
}

/// Meshes that are prepared, one copy after the other.
struct Instances {
    prepared: Prepared,
    /// Vertex of the meshes and instance of each place.
    sources: Vec<[u32; 2]>,
    vertices: Vec<[f32; 3]>,
}

impl Instances {
    fn new(meshes: &[CasterMesh], instances: &[u32]) -> Result<Self> {
        let of_mesh = |(k, given): (usize, &CasterMesh)| {
            let mesh = Mesh { positions: given.positions.to_vec(), triangles: given.triangles.to_vec() };
            mesh.check(&format!("mesh {k} of the casters"))?;
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
            edges.extend(mesh.edges.iter().map(|e| Edge {
                v0: e.v0 + vertex,
                v1: e.v1 + vertex,
                t0: e.t0 + triangle,
                t1: if e.t1 == NO_TRIANGLE { NO_TRIANGLE } else { e.t1 + triangle },
            }));
        }
        Ok(Self { prepared: Prepared::of_parts(all, given, edges, alpha), sources, vertices })
    }
}
