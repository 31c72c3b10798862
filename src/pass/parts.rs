//! Casters in parts: what stands, what moves and instances in one memory, of which any part is added and removed by itself.
//!
//! Each part has ranges of its own in the buffers. A range that no part has holds triangles and edges that are none, so the stages go through
//! all of them and find nothing there. What is added and removed is written by commands of the next frame, before it runs, and of each
//! frame after it until one is known to have run: a frame that is recorded already is not touched, and one that is dropped takes nothing with it.

mod part;
mod ranges;

use super::inputs::{CasterPart, PartAt, PartPlace};
use crate::gpu::{Buffer, Recorder, StagedUploads, Uploads};
use crate::methods::Prepared;
use crate::methods::prepared::{CasterBuffers, MeshBuffers, padded};
use crate::scene::adjacency::Edge;
use crate::scene::{Camera, Homography, Light, Mesh};
use crate::stages::caster_positions::CasterPositions;
use crate::stages::instance_positions::InstancePositions;
use crate::{Error, Result};
use glam::{DVec3, Vec3};
pub use part::NewPart;
use part::{Contents, EDGES, HeldPart, KINDS, NewMoves, PlaceSource, TRIANGLES, VERTICES};
use ranges::Ranges;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::ops::Range;
use std::sync::Arc;

/// The parts. A clone has the same ones and no edits that are still to be written.
pub struct PartSet {
    parts: BTreeMap<u32, Arc<HeldPart>>,
    next: u32,
    room: [Ranges; KINDS],
    /// Vertices that a part's first is a multiple of.
    align: usize,
    stage: Arc<InstancePositions>,
    edits: VecDeque<Edit>,
    /// Edits that are in memory for good.
    written: u64,
}

/// Commands that write a part, or clear where it was.
struct Edit {
    cleared: Vec<(wgpu::Buffer, Range<u64>)>,
    written: StagedUploads,
}

/// A triangle that a part had, of the numbers that an application gives: none.
const NO_NUMBER: u32 = u32::MAX;

const NO_EDGE: Edge = Edge { v0: 0, v1: 0, t0: 0, t1: 0 };

impl PartSet {
    /// Prepares parts, whose numbers are those of their order, with room for `room` more triangles, as many vertices and twice as many edges.
    ///
    /// # Errors
    /// As [`NewPart::new`]; [`Error::Mesh`] for more triangles than can be used.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, parts: &[CasterPart], room: usize) -> Result<Self> {
        let align = (device.limits().min_storage_buffer_offset_alignment as usize / size_of::<[f32; 4]>()).max(1);
        let mut set = Self {
            parts: BTreeMap::new(),
            next: 0,
            room: Default::default(),
            align,
            stage: Arc::new(InstancePositions::new(device)),
            edits: VecDeque::new(),
            written: 0,
        };
        let prepare = |(k, part)| NewPart::new(part, &format!("part {k} of the casters"));
        let new = parts.par_iter().enumerate().map(prepare).collect::<Result<Vec<_>>>()?;
        let mut needs = [room.next_multiple_of(align), room, 2 * room, 0];
        for part in &new {
            (0..KINDS).for_each(|kind| needs[kind] += part.needs(align)[kind]);
        }
        set.extend(needs, 1)?;
        for part in new {
            set.insert(device, queue, part)?;
        }
        Ok(set)
    }

    /// The same parts, all of which are to be uploaded.
    pub fn successor(&self) -> Self {
        Self {
            parts: self.parts.clone(),
            next: self.next,
            room: self.room.clone(),
            align: self.align,
            stage: self.stage.clone(),
            edits: VecDeque::new(),
            written: self.edits(),
        }
    }

    /// Whether there is room for a part.
    pub fn fits(&self, part: &NewPart) -> bool {
        self.room.iter().zip(part.needs(self.align)).all(|(room, need)| room.fits(need))
    }

    /// Makes room for a part, and for at least `factor` times what there is now.
    ///
    /// # Errors
    /// [`Error::Mesh`] for more triangles than can be used.
    pub fn extend_for(&mut self, part: &NewPart, factor: usize) -> Result<()> {
        self.extend(part.needs(self.align), factor)
    }

    fn extend(&mut self, needs: [usize; KINDS], factor: usize) -> Result<()> {
        for (room, need) in self.room.iter_mut().zip(needs).filter(|(room, need)| !room.fits(*need)) {
            room.extend((room.len + need).max(room.len * factor));
        }
        let (most, count) = (Mesh::MAX_TRIANGLES, self.room[TRIANGLES].len);
        let message = format!("parts with room for {count} triangles, at most {most} may be used");
        if count > most { Err(Error::Mesh { name: "casters".to_owned(), message }) } else { Ok(()) }
    }

    /// Takes a part in, for which there is room, and returns its number.
    ///
    /// # Errors
    /// As [`Buffer::storage`]; all is then as before.
    pub fn insert(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, new: NewPart) -> Result<u32> {
        let needs = new.needs(self.align);
        let mut room = self.room.clone();
        let at: [Range<usize>; KINDS] = std::array::from_fn(|kind| room[kind].take(needs[kind]));
        let slice = |label: &str, data: &[[u32; 2]]| Buffer::from_slice(device, queue, label, data);
        let source = match new.moves {
            NewMoves::Not => PlaceSource::Standing,
            NewMoves::Vertices(mut places) => {
                let first = at[VERTICES].start as u32;
                places.iter_mut().filter(|[place, _]| *place != u32::MAX).for_each(|[place, _]| *place += first);
                PlaceSource::Vertices(slice("casters.places", &places)?)
            }
            NewMoves::Transforms { instances, sources, vertices } => PlaceSource::Transforms {
                instances,
                sources: slice("casters.sources", &sources)?,
                vertices: Buffer::from_slice(device, queue, "casters.vertices", &padded(&vertices))?,
            },
        };
        let has_bodies = new.prepared.bodies.contains(&true);
        let number = self.next;
        self.parts.insert(number, Arc::new(HeldPart { prepared: new.prepared, source, at, has_bodies }));
        (self.room, self.next) = (room, number + 1);
        Ok(number)
    }

    /// Makes the edit that writes a part into memory, where alpha-tested triangles are told of from element `first` on.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for it; the part is then gone.
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        number: u32,
        (buffers, numbers): (&CasterBuffers, &Buffer<u32>),
        first: usize,
    ) -> Result<()> {
        let Some(part) = self.parts.get(&number) else { return Ok(()) };
        let Contents { positions, triangles, edges, surfaces, numbers: given, elements } = part.contents(first);
        let [v, t, e, x] = part.at.each_ref().map(|range| range.start);
        let mut uploads = Uploads::default();
        uploads.write_at(&buffers.positions, v, &positions);
        uploads.write_at(&buffers.triangles, t, &triangles);
        uploads.write_at(&buffers.triangles, first + x, &elements);
        uploads.write_at(&buffers.edges, e, &edges);
        uploads.write_at(numbers, t, &given);
        if let Some(to) = &buffers.surfaces {
            uploads.write_at(to, t, &surfaces);
        }
        match uploads.stage(device) {
            Ok(written) => {
                self.edits.push_back(Edit { cleared: Vec::new(), written });
                Ok(())
            }
            Err(error) => {
                self.forget(number);
                Err(error)
            }
        }
    }

    /// Takes a part out, and makes the edit that clears where it was.
    ///
    /// # Errors
    /// [`Error::Config`] if there is no such part; [`Error::Gpu`] if the device has no memory for the edit. All is then as before.
    pub fn remove(
        &mut self,
        device: &wgpu::Device,
        number: u32,
        (buffers, numbers): (&CasterBuffers, &Buffer<u32>),
    ) -> Result<()> {
        let Some(part) = self.parts.get(&number) else { return Err(no_part(number)) };
        let words = |range: &Range<usize>| 4 * range.start as u64..4 * range.end as u64;
        let cleared = vec![
            (buffers.triangles.raw().clone(), words(&part.at[TRIANGLES])),
            (buffers.edges.raw().clone(), words(&part.at[EDGES])),
        ];
        let mut uploads = Uploads::default();
        uploads.write_at(numbers, part.at[TRIANGLES].start, &vec![NO_NUMBER; part.at[TRIANGLES].len()]);
        let written = uploads.stage(device)?;
        self.edits.push_back(Edit { cleared, written });
        self.forget(number);
        Ok(())
    }

    fn forget(&mut self, number: u32) {
        let Some(part) = self.parts.remove(&number) else { return };
        for (room, range) in self.room.iter_mut().zip(&part.at) {
            room.give(range.clone());
        }
    }

    /// Edits that were ever made.
    pub fn edits(&self) -> u64 {
        self.written + self.edits.len() as u64
    }

    /// Takes in that a frame has run that was recorded when so many edits had been made.
    pub fn have_run(&mut self, edits: u64) {
        while self.written < edits && self.edits.pop_front().is_some() {
            self.written += 1;
        }
    }

    /// Records the edits that no frame is known to have run with.
    pub fn record_edits(&self, rec: &mut Recorder) {
        for Edit { cleared, written } in &self.edits {
            for (buffer, words) in cleared {
                rec.clear_words(buffer, words.start, words.end - words.start);
            }
            written.record(rec);
        }
    }

    /// Triangle numbers of a part.
    pub fn triangles(&self, number: u32) -> Option<Range<u32>> {
        let at = &self.parts.get(&number)?.at[TRIANGLES];
        Some(at.start as u32..at.end as u32)
    }

    /// Whether all parts stand.
    pub fn stand(&self) -> bool {
        self.parts.values().all(|part| matches!(part.source, PlaceSource::Standing))
    }

    /// Whether some part stands.
    pub fn any_stands(&self) -> bool {
        self.parts.values().any(|part| matches!(part.source, PlaceSource::Standing))
    }

    /// Whether some triangles are alpha-tested.
    pub fn are_tested(&self) -> bool {
        self.parts.values().any(|part| !part.prepared.alpha().is_empty())
    }

    /// Whether the light is outside all closed bodies that stand, and there are any: what turns away from it of these adds nothing to the
    /// shadow, whatever moves.
    pub fn backs_add_nothing(&self, light: &Light) -> bool {
        self.of_bodies(|prepared| prepared.backs_add_nothing(light))
    }

    /// Whether a camera sees no triangle of these that faces away from it.
    pub fn hides_backs(&self, camera: &Camera, size: [u32; 2]) -> bool {
        self.of_bodies(|prepared| prepared.hides_backs(camera, size))
    }

    fn of_bodies(&self, holds: impl Fn(&Prepared) -> bool) -> bool {
        let mut with_bodies = self.parts.values().filter(|part| part.has_bodies).peekable();
        with_bodies.peek().is_some() && with_bodies.all(|part| holds(&part.prepared))
    }

    /// Checks where a frame says that parts are.
    ///
    /// # Errors
    /// [`Error::Config`], with the number of the part.
    pub fn check(&self, places: &[PartPlace], limits: &wgpu::Limits) -> Result<()> {
        let mut told = BTreeSet::new();
        for place in places {
            let number = place.part;
            let refuse = |text: &str| Err(Error::Config(format!("part {number}: {text}")));
            let of_part = |e: Error| match e {
                Error::Config(text) => Error::Config(format!("part {number}: {text}")),
                e => e,
            };
            let Some(part) = self.parts.get(&number) else { return Err(no_part(number)) };
            let [low, high] = match (&part.source, &place.at) {
                (PlaceSource::Vertices(places), PartAt::Moved(moved)) => {
                    moved.vertices.check(places.len(), limits).map_err(of_part)?;
                    moved.bounds
                }
                (PlaceSource::Transforms { instances, .. }, PartAt::Placed(placed)) => {
                    placed.transforms.check(*instances, limits).map_err(of_part)?;
                    placed.bounds
                }
                (PlaceSource::Standing, _) => return refuse("it stands, and the frame says where it is"),
                (PlaceSource::Vertices(_), _) => return refuse("a vertex buffer moves it, and not transforms"),
                (PlaceSource::Transforms { .. }, _) => return refuse("transforms place it, and not a vertex buffer"),
            };
            if !(0..3).all(|k| low[k].is_finite() && high[k].is_finite() && low[k] <= high[k]) {
                return refuse(&format!("no box from {low:?} to {high:?}"));
            }
            if !told.insert(number) {
                return refuse("the frame says twice where it is");
            }
        }
        let untold = |(number, part): &(&u32, &Arc<HeldPart>)| {
            !matches!(part.source, PlaceSource::Standing) && !told.contains(*number)
        };
        match self.parts.iter().find(untold) {
            Some((number, _)) => {
                Err(Error::Config(format!("part {number} moves, and the frame does not say where it is")))
            }
            None => Ok(()),
        }
    }

    /// The boxes of parts that have triangles, of which those that move are where a frame says, which has been checked. `casting`: of what casts in
    /// some light.
    pub fn boxes(&self, places: &[PartPlace], casting: bool) -> Vec<(DVec3, DVec3)> {
        let told: BTreeMap<u32, [[f32; 3]; 2]> = places.iter().map(|place| (place.part, place.at.bounds())).collect();
        let of_part = |(number, part): (&u32, &Arc<HeldPart>)| match (&part.source, told.get(number)) {
            (PlaceSource::Standing, _) if casting => part.prepared.casting().tree.bounds(),
            (PlaceSource::Standing, _) => part.prepared.tree().bounds(),
            _ if part.at[TRIANGLES].is_empty() || (casting && part.prepared.none_cast()) => None,
            (_, told) => told.map(|ends| ends.map(|p| Vec3::from(p).as_dvec3())).map(|[low, high]| (low, high)),
        };
        self.parts.iter().filter_map(of_part).collect()
    }

    /// Brings what moves to its places, which have been checked.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_moves(
        &self,
        rec: &mut Recorder,
        gather: &CasterPositions,
        (places, homography): (&[PartPlace], Homography),
        positions: &Buffer<[f32; 4]>,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        let sources =
            |place: &PartPlace| self.parts.get(&place.part).map(|part| (&part.source, part.at[VERTICES].start));
        let any = |is: fn(&PartAt) -> bool| places.iter().any(|place| is(&place.at));
        if any(|at| matches!(at, PartAt::Moved(_))) {
            let stage = &mut rec.stage("caster_positions");
            for place in places {
                if let (Some((PlaceSource::Vertices(of), _)), PartAt::Moved(moved)) = (sources(place), &place.at) {
                    gather.record(stage, moved.vertices, of, (moved.bounds, homography), positions, faults)?;
                }
            }
        }
        if any(|at| matches!(at, PartAt::Placed(_))) {
            let stage = &mut rec.stage("instance_positions");
            for place in places {
                if let (
                    Some((PlaceSource::Transforms { instances, sources, vertices }, first)),
                    PartAt::Placed(placed),
                ) = (sources(place), &place.at)
                {
                    let transforms = (placed.transforms, *instances);
                    let to = (positions, first);
                    self.stage.record(stage, transforms, sources, vertices, (placed.bounds, homography), to, faults)?;
                }
            }
        }
        Ok(())
    }

    /// Uploads all parts: buffers, and the number of each triangle that was given.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn upload(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<(CasterBuffers, Buffer<u32>)> {
        let (positions, triangles) = self.surfaces(device, queue, 0)?;
        let count = self.room[TRIANGLES].len;
        let mut edges = vec![NO_EDGE; self.room[EDGES].len];
        let (mut surfaces, mut numbers) = ((0..count as u32).collect::<Vec<_>>(), vec![NO_NUMBER; count]);
        for part in self.parts.values() {
            let [_, t, e, _] = part.at.clone();
            edges[e].copy_from_slice(&part.edges());
            surfaces[t.clone()].copy_from_slice(&part.surfaces());
            numbers[t].copy_from_slice(&part.numbers());
        }
        let buffers = CasterBuffers {
            positions,
            triangles,
            edges: Buffer::from_slice(device, queue, "casters.edges", &edges)?,
            surfaces: Some(Buffer::from_slice(device, queue, "casters.surfaces", &surfaces)?),
            clusters: None,
        };
        Ok((buffers, Buffer::from_slice(device, queue, "casters.numbers", &numbers)?))
    }

    /// Uploads positions and triangles, with room behind them for `room` triangles with vertices of their own.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn surfaces(&self, device: &wgpu::Device, queue: &wgpu::Queue, room: usize) -> Result<MeshBuffers> {
        let [vertices, count, _, tested] = self.room.each_ref().map(|room| room.len);
        let (first, mut elements) = (count + room, vec![[0; 4]; tested]);
        let (mut positions, mut triangles) = (vec![[0.0; 4]; vertices], vec![[0; 4]; count]);
        for part in self.parts.values() {
            let [v, t, _, x] = part.at.clone();
            positions[v.start..v.start + part.prepared.mesh().positions.len()].copy_from_slice(&part.positions());
            triangles[t].copy_from_slice(&part.triangles(first));
            elements[x].copy_from_slice(&part.elements(first));
        }
        let positions = Buffer::with_room(device, queue, "casters.positions", &positions, 3 * room)?;
        let triangles = Buffer::with_room(device, queue, "casters.triangles", &triangles, room + tested)?;
        triangles.write_from(queue, first, &elements);
        Ok((positions, triangles))
    }
}

fn no_part(number: u32) -> Error {
    Error::Config(format!("part {number}: the casters have none of that number"))
}
