//! Recording one frame, or one strip of it: views, uniforms, the method, and the copies to where the application wants them.

use super::gbuffer_stage::With;
use super::judge::stamp_of;
use super::kept_maps::FrameMaps;
use super::light_lists::part_of;
use super::parts::PartSet;
use super::status::{Label, Staging};
use super::{GBuffer, Inputs, ShadowPass, Target};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::{Recorder, Uploads};
use crate::methods::facet_masks::{Extent, MapSource};
use crate::methods::strip_method::FrameOf;
use crate::methods::strips::Rows;
use crate::plan::{asks_for_most, extent_of};
use crate::stages::visibility_texture::PointShare;

/// The part of a frame that is recorded.
#[derive(Clone, Copy)]
pub(crate) struct FramePart {
    /// No more than this of the method.
    pub extent: Extent,
    /// One strip of rows; `None`: all.
    pub strip: Option<u32>,
    /// Its place among frames of one camera and several lights.
    pub surfaces: Surfaces,
    /// Which of several points of a light it is of, and how many they are: visibility is summed, after the last it is the mean.
    pub point: Option<[u32; 2]>,
}

/// Who finds what the camera sees.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Surfaces {
    /// The frame, for itself.
    Own,
    /// The frame, and keeps it for those of other lights that follow.
    Shared,
    /// The frame before.
    Kept,
}

impl ShadowPass {
    /// How much of a frame has to run, as far as that is proved: of casters that stand.
    pub(super) fn extent(&self, inputs: &Inputs) -> Extent {
        let known = matches!(inputs.gbuffer, GBuffer::None | GBuffer::TriangleIds(_) | GBuffer::SampleIds(_));
        if !self.proves || !known || !self.casters.are_known() || self.image.method.is_fixed() {
            return Extent::Everything;
        }
        match extent_of(&self.casters.prepared, inputs.camera, inputs.light, &self.settings).0 {
            // The G-buffer says what is seen.
            Extent::Nothing if !matches!(inputs.gbuffer, GBuffer::None) => Extent::Everything,
            extent => extent,
        }
    }

    /// As [`ShadowPass::record`], of a part. Strips after the first use the light maps of the one before.
    pub(crate) fn record_part(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        target: &Target,
        part: FramePart,
    ) -> Result<u64> {
        self.ledger.clone().within(|| self.record_into_ledger(encoder, inputs, target, part))
    }

    fn record_into_ledger(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        target: &Target,
        FramePart { extent, strip, mut surfaces, point }: FramePart,
    ) -> Result<u64> {
        let bounds = self.check(inputs, target)?;
        let settings = self.image.method.view_settings(&self.settings);
        let views = self.views.of(inputs, &self.casters, &settings, bounds)?;
        let objects = self.objects_of(inputs, &settings);
        let one = self.image.method.asks_one();
        // These may show what lies beside the casters.
        let beyond = matches!(inputs.gbuffer, GBuffer::Surfaces(_) | GBuffer::SampleIds(_));
        let views = settings.in_slices(views, inputs.camera, bounds, (beyond, one), inputs.depths, &objects);
        let views = self.focused(views, inputs, bounds);
        let mut views = self.maker.parts.of(self.image.method.jittered(views));
        if extent != Extent::Everything {
            views.truncate(1);
        }
        if self.grows && surfaces != Surfaces::Kept {
            self.grow()?;
        } else {
            self.collect();
        }
        if self.image.strips.count() > 1 || self.image.method.is_fixed() {
            // Strips use one memory in turn; other methods keep no facets.
            surfaces = Surfaces::Own;
        }
        self.image.method.keep_found(&self.maker.device, surfaces == Surfaces::Shared)?;
        self.make_room_for(views.len() as u32)?;
        if point.is_some() {
            self.make_sums()?;
        }
        let part = self.image.strips.part(strip);
        let stands = self.casters.stand();
        // Of several lights each would find the maps of the one before.
        let keeps_maps = self.keeps_maps && stands && surfaces == Surfaces::Own;
        let mut maps = match (views.as_slice(), extent) {
            ([view], Extent::Everything) if !self.image.method.is_fixed() => {
                let keeps = keeps_maps || strip.is_some_and(|k| k > 0);
                self.kept_maps.for_frame(view, (inputs.camera, bounds), keeps, &self.in_flight)
            }
            (_, Extent::Everything) => {
                self.kept_maps.forget();
                FrameMaps::NONE
            }
            _ => FrameMaps::NONE,
        };
        // Other frames and strips may use what one view left in memory.
        let shared = views.len() == 1 && (keeps_maps || self.image.strips.count() > 1);
        let requests = self.settings.request_blocks && !shared && maps.source == MapSource::Made;
        let triangles = self.casters.buffers.triangles.len();
        if requests && asks_for_most(inputs.camera, self.settings.size, bounds, triangles).is_none() {
            maps.source = MapSource::Requested;
        }
        if self.image.make_packed(&self.maker.device, target)? {
            self.bind_groups.forget();
        }
        let (stamp, mut flags) = (stamp_of(self.frame + 1), 0);
        if matches!(inputs.gbuffer, GBuffer::SampleIds(_)) {
            flags |= Frame::BEYOND;
        }
        if self.settings.hide_backs && self.casters.hides_backs(inputs.camera, self.settings.size) {
            flags |= Frame::BACKS_HIDDEN;
        }
        if inputs.homography.is_some_and(|map| !map.is_none()) {
            flags |= Frame::MAPPED;
        }
        flags |= match extent {
            Extent::Everything => 0,
            Extent::Facing => Frame::NOTHING_CASTS,
            // A pixel without a facet counts as an empty one.
            Extent::Nothing => Frame::CLAMP,
        };
        flags |= u32::from(!inputs.layers) << Frame::NO_LAYERS;
        let of = FrameOf {
            camera: inputs.camera,
            light: inputs.light,
            views: &views,
            bounds,
            stamp,
            maps: maps.number,
            margins: maps.margins,
            flags,
            origins: [inputs.origin, target.visibility.and_then(|texture| texture.origin)]
                .map(Option::unwrap_or_default),
        };
        let (method, strips) = (&mut self.image.method, self.image.strips);
        let uploads = part.iter().map(|&(_, rows)| method.uploads(&self.casters.buffers, of, strips.strip(rows)));
        let uploads = uploads.collect::<Result<Vec<_>>>()?;
        let (strips, status) = (part.len() as u32, self.image.method.status());
        let staging = self.in_flight.staging(&self.maker.device, status.len() as u64 * u64::from(strips))?;
        // In no debug group: with two in one encoder Mesa 22.3's lavapipe crashes. The passes have labels.
        let recorded =
            self.record_checked(encoder, inputs, target, (maps, extent, surfaces, point), (&part, uploads), &staging);
        let dispatches = recorded?;
        self.frame += 1;
        let (generation, capacities) = (self.generation, self.image.method.capacities());
        let edits = self.casters.parts.as_ref().map_or(0, PartSet::edits);
        let listed = target.listed.map(|to| part_of(to, inputs.light, inputs.reach, self.settings.size).capacity);
        let label = Label { frame: self.frame, generation, capacities, strips, dispatches, maps, edits, listed };
        let need = self.lists.as_ref().map(|lists| &lists.memory.need);
        self.in_flight.push(encoder, label, staging, (&self.faults, need), self.timer.as_ref());
        Ok(self.frame)
    }

    fn record_checked(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        target: &Target,
        (maps, extent, surfaces, point): (FrameMaps, Extent, Surfaces, Option<[u32; 2]>),
        (part, uploads): (&[(u32, Rows)], Vec<Vec<Uploads>>),
        staging: &Staging,
    ) -> Result<u32> {
        if let Some(timer) = &mut self.timer {
            timer.reset();
        }
        let (image, casters, faults) = (&self.image, &self.casters, &self.faults);
        let method = &image.method;
        // Written by the encoder and not by the queue: a second frame of the same submission must not change the first.
        let stage = |uploads: Uploads| uploads.stage(&self.maker.device);
        let of_views = |uploads: Vec<Uploads>| uploads.into_iter().map(stage).collect::<Result<Vec<_>>>();
        let staged = uploads.into_iter().map(of_views).collect::<Result<Vec<_>>>()?;
        let rec = Recorder::new(&self.maker.device, encoder, self.timer.as_mut());
        let rec = &mut rec.keeping(&mut self.bind_groups);
        let listed = target.listed.zip(self.lists.as_ref());
        if let Some((to, lists)) = listed.filter(|(to, _)| to.begin) {
            lists.record_begin(rec, to.lists, self.settings.size)?;
        }
        let listed = listed.map(|(to, lists)| (part_of(to, inputs.light, inputs.reach, self.settings.size), to, lists));
        let kept = surfaces == Surfaces::Kept;
        if !kept {
            rec.clear(faults.raw());
            if let Some(parts) = &casters.parts {
                parts.record_edits(rec);
            }
        }
        if let Some((_, held)) = &self.last {
            held.record_begin(rec);
        }
        for ((k, &(strip, rows)), staged) in (0..).zip(part).zip(&staged) {
            let (first, further) = staged.split_at(1);
            first.iter().for_each(|uploads| uploads.record(rec));
            if strip == 0 && !kept {
                casters.record_moves(rec, &self.gather, inputs, faults)?;
            }
            let maps = maps.source_of(strip);
            let offsets = self.settings.samples.offsets();
            let with = With { method, size: self.settings.size, casters, faults, maps, extent, kept, further };
            self.seen.record(rec, &inputs.gbuffer, offsets, with)?;
            if let (Some([point, points]), Some(sums)) = (point, &self.sums) {
                // Strips share rows: each has sums of its own.
                let pixels = method.visibility().len();
                let share = PointShare { offset: strip * pixels as u32, point, points, ..PointShare::default() };
                let stage = &mut rec.stage("visibility_texture");
                self.store.mean.record(stage, method.frame(), method.visibility(), pixels, sums, share)?;
            }
            if let Some((light, _, lists)) = &listed {
                lists.record_share(rec, method, &casters.buffers, image.strips.size(), *light)?;
            }
            match &self.last {
                Some((with, held)) => {
                    held.record_judge(rec, with, image, faults)?;
                    image.record_copies(rec, rows, [None, target.counts]);
                }
                None => {
                    image.record_store(rec, &self.store, rows, target)?;
                    image.record_copies(rec, rows, [target.lit, target.counts]);
                }
            }
            staging.record(rec, method.status(), k);
        }
        if let Some((light, to, lists)) = listed {
            lists.record_append(rec, to.lists, light)?;
        }
        let Some((with, held)) = &self.last else { return Ok(rec.dispatches()) };
        held.record_hold(rec, with, image);
        for (&(_, rows), staged) in part.iter().zip(&staged) {
            staged.iter().take(1).for_each(|uploads| uploads.record(rec));
            let (width, pixels) = (u64::from(self.settings.size[0]), method.visibility().len() as u64);
            let (from, to) = (held.visibility.raw(), method.visibility().raw());
            rec.copy_words(from, u64::from(rows.first) * width, to, 0, pixels);
            image.record_store(rec, &self.store, rows, target)?;
        }
        if let Some((lit, held)) = target.lit.zip(held.lit.as_ref()) {
            rec.copy(held.raw(), lit, held.len() as u64 * 4);
        }
        Ok(rec.dispatches())
    }

    /// Makes room for a frame with another number of views than the one before.
    fn make_room_for(&mut self, views: u32) -> Result<()> {
        let (maker, method) = (&self.maker, &mut self.image.method);
        if !method.has_room_for(views) {
            self.bind_groups.forget();
        }
        maker.pipelines.within(|| method.make_room_for(&maker.device, &maker.queue, views))
    }
}
