//! Status of recorded frames once the GPU is done with them: counters are copied to a buffer that maps itself when
//! the application's submission has run, and are read when they are asked for. Nothing waits.

use super::kept_maps::FrameMaps;
use crate::gpu::buffer::{allocate, not_mapped};
use crate::gpu::ledger::Held;
use crate::gpu::{Buffer, Recorder, StageTime, Timer};
use crate::methods::facet_masks::Capacities;
use crate::methods::output::{Counts, ListUse};
use crate::stages::{caster_positions, pixel_receivers, triangle_ids};
use crate::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Input of a frame that could not be used as it was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults {
    /// Vertices outside the given box, or without a number; they were moved into the box.
    pub outside: u32,
    /// Vertices that are not at the point which they shared in the pose at rest; the first of them stood for all.
    pub parted: u32,
    /// Texels that name no triangle; they count as seeing nothing.
    pub unknown_triangles: u32,
    /// Texels of depth, position or normal that are not finite, lie behind the eye, or more than 10^9 times as far away as the
    /// casters, or have no direction; they count as seeing nothing.
    pub unusable_surfaces: u32,
}

/// Words of the counters of [`Faults`].
pub(super) const FAULT_WORDS: usize = 4;

impl Faults {
    fn of(words: &[u32]) -> Self {
        Self {
            outside: words[caster_positions::FAULT_OUTSIDE as usize],
            parted: words[caster_positions::FAULT_PARTED as usize],
            unknown_triangles: words[triangle_ids::FAULT_UNKNOWN as usize],
            unusable_surfaces: words[pixel_receivers::FAULT_UNUSABLE as usize],
        }
    }
}

/// How a recorded frame came out.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct FrameStatus {
    /// Its number, as [`record`](super::ShadowPass::record) returned it.
    pub frame: u64,
    /// Whether its picture is whole and right: the GPU itself has written that it ran to its end, no list was too short, and all input
    /// could be used. If not, `overflowed`, `faults` or `error` says why.
    pub complete: bool,
    /// A list was too short: some shadows are missing. The lists grow before a later frame.
    pub overflowed: bool,
    /// Input that could not be used as it was.
    pub faults: Faults,
    /// Why no list can hold such a frame, or why nothing is known of it.
    pub error: Option<String>,
    /// Dispatches that were recorded for it.
    pub dispatches: u32,
    /// Whether it used the light maps of an earlier frame ([`PassConfig::keep_maps`](super::PassConfig::keep_maps)).
    pub maps_kept: bool,
    /// The least and the greatest view depth that pixel centres see, in world units, for the slices of the next frame
    /// ([`Inputs::depths`](super::Inputs::depths)): with slices by [seen depths](crate::light_view::PartBy::SeenDepth), of frames that found what
    /// pixels show themselves; `None` where no caster is seen.
    pub depths: Option<[f32; 2]>,
    /// Counts of the frame. Rows that strips share count in each strip.
    pub counts: Counts,
    /// Need of each list, in the strip that needed most, and its capacity. Where one list was too short, later ones may have needed more
    /// than they say.
    pub lists: Vec<ListUse>,
    /// Entries that the lists of lights which the light was put into need up to this light, and those that they have room for
    /// ([`Target::listed`](super::Target::listed)); `None` for a light in no lists. Where they have less, the frame counts as overflowed, and the buffer is to be
    /// longer ([`light_list_bytes`](super::light_list_bytes)); what it holds is right.
    pub light_lists: Option<ListUse>,
    /// GPU time of each stage, of the first [`Timer::PASSES`] passes of the frame (about 13 for each strip and view, and 7 for each
    /// further band); empty without time stamps.
    pub stages: Vec<StageTime>,
}

/// The counters of a finished frame.
pub(super) struct Finished {
    pub(super) label: Label,
    /// Counters of the method of all strips, faults, times, and entries that lists of lights need; or why they cannot be read.
    pub(super) read: Result<(Vec<u32>, Faults, Vec<StageTime>, u32)>,
}

const WAITING: u8 = 0;
const READY: u8 = 1;
const FAILED: u8 = 2;
const DROPPED: u8 = 3;

/// Says so when the mapping is given up without an answer, as with an encoder that is never submitted.
struct Signal(Arc<AtomicU8>);

impl Signal {
    fn set(&self, state: u8) {
        self.0.store(state, Ordering::Release);
    }
}

impl Drop for Signal {
    fn drop(&mut self) {
        let _ = self.0.compare_exchange(WAITING, DROPPED, Ordering::AcqRel, Ordering::Acquire);
    }
}

/// A frame in flight.
struct Slot {
    label: Label,
    staging: Held,
    status_bytes: u64,
    passes: Vec<&'static str>,
    state: Arc<AtomicU8>,
}

/// The frames in flight, and staging buffers to be used again.
#[derive(Default)]
pub(super) struct InFlight {
    slots: Vec<Slot>,
    free: Vec<Held>,
}

/// Key of a frame.
#[derive(Clone, Copy)]
pub(super) struct Label {
    pub(super) frame: u64,
    pub(super) generation: u64,
    pub(super) capacities: Capacities,
    /// Strips of rows that it was rendered in, each with counters of its own.
    pub(super) strips: u32,
    pub(super) dispatches: u32,
    pub(super) maps: FrameMaps,
    /// Edits of the casters that it has written.
    pub(super) edits: u64,
    /// Entries that the lists of lights have room for, if the light is in such.
    pub(super) listed: Option<u32>,
}

/// A buffer that the counters of a frame are copied to.
pub(super) struct Staging {
    buffer: Held,
    words: u64,
}

impl Staging {
    /// Appends the copy of the counters of strip `k`, of as many words as those of all others.
    pub(super) fn record(&self, rec: &mut Recorder, status: &Buffer<u32>, k: u64) {
        let words = status.len() as u64;
        rec.copy_words(status.raw(), 0, &self.buffer, k * words, words);
    }
}

impl InFlight {
    /// Most staging buffers that are kept for later frames.
    const KEPT: usize = 8;

    /// A buffer for `words` counters of a frame.
    pub(super) fn staging(&mut self, device: &wgpu::Device, words: u64) -> Result<Staging> {
        let size = stamps_at(words * 4) + Timer::BYTES;
        let buffer = match self.free.iter().position(|b| b.size() == size) {
            Some(k) => self.free.swap_remove(k),
            None => {
                let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
                allocate(device, "shadow_pass.status", size, usage, false)?
            }
        };
        Ok(Staging { buffer, words })
    }

    /// Appends the copy of the faults and time stamps of a frame to `encoder`, whose counters are copied to `staging` already.
    pub(super) fn push(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        label: Label,
        staging: Staging,
        (faults, listed): (&Buffer<u32>, Option<&Buffer<u32>>),
        timer: Option<&Timer>,
    ) {
        let Staging { buffer: staging, words } = staging;
        let status_bytes = words * 4;
        let faults_bytes = FAULT_WORDS as u64 * 4;
        encoder.copy_buffer_to_buffer(faults.raw(), 0, &staging, status_bytes, faults_bytes);
        if let Some(listed) = listed {
            encoder.copy_buffer_to_buffer(listed.raw(), 0, &staging, status_bytes + faults_bytes, 4);
        }
        if let Some(timer) = timer {
            timer.resolve_to(encoder, &staging, stamps_at(status_bytes));
        }
        let state = Arc::new(AtomicU8::new(WAITING));
        let signal = Signal(state.clone());
        encoder.map_buffer_on_submit(&staging, wgpu::MapMode::Read, .., move |mapped| {
            signal.set(if mapped.is_ok() { READY } else { FAILED });
        });
        let passes = timer.map_or(Vec::new(), |t| t.passes().to_vec());
        self.slots.push(Slot { label, staging, status_bytes, passes, state });
    }

    /// The frames that the GPU is done with, oldest first. Those that were never submitted are forgotten.
    pub(super) fn finished(&mut self, timer: Option<&Timer>) -> Vec<Finished> {
        let mut finished = Vec::new();
        let mut waiting = Vec::new();
        for slot in self.slots.drain(..) {
            let state = slot.state.load(Ordering::Acquire);
            if state == WAITING {
                waiting.push(slot);
                continue;
            }
            let label = slot.label;
            let read = match state {
                READY => slot.read(timer),
                FAILED => {
                    let of = label.frame;
                    Err(Error::Gpu(format!(
                        "the counters of frame {of} cannot be read: the device was lost or destroyed before it was done"
                    )))
                }
                _ => continue,
            };
            if read.is_ok() && self.free.len() < Self::KEPT {
                self.free.push(slot.staging);
            }
            finished.push(Finished { label, read });
        }
        self.slots = waiting;
        finished
    }

    /// Keys of the frames that the GPU is not known to be done with.
    pub(super) fn labels(&self) -> impl Iterator<Item = &Label> {
        self.slots.iter().map(|slot| &slot.label)
    }

    /// Frames that the GPU is not known to be done with.
    pub(super) fn len(&self) -> usize {
        self.slots.len()
    }
}

/// Where the time stamps stand behind so many bytes of counters, the faults, and the need of lists of lights.
fn stamps_at(status_bytes: u64) -> u64 {
    (status_bytes + FAULT_WORDS as u64 * 4 + 4).next_multiple_of(8)
}

impl Slot {
    fn read(&self, timer: Option<&Timer>) -> Result<(Vec<u32>, Faults, Vec<StageTime>, u32)> {
        let out = {
            let view = self
                .staging
                .get_mapped_range(..)
                .map_err(|e| not_mapped(&format!("reading the counters of frame {}", self.label.frame), &e))?;
            let at = self.status_bytes as usize;
            let faults_end = at + FAULT_WORDS * 4;
            let words = |bytes: &[u8]| bytemuck::pod_collect_to_vec::<u8, u32>(bytes);
            let faults = Faults::of(&words(&view[at..faults_end]));
            let stamps = stamps_at(self.status_bytes) as usize;
            let stages = timer.map_or(Vec::new(), |t| t.times(&self.passes, &view[stamps..]));
            let needed = words(&view[faults_end..faults_end + 4])[0];
            (words(&view[..at]), faults, stages, needed)
        };
        self.staging.unmap();
        Ok(out)
    }
}
