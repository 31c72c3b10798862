//! `facet-masks`: the flagship (Pan, Wang, Chen, Zhou, Bao 2009), one page of calls to stages.

mod bands;
mod found;
mod frame_source;
mod memory;
mod pipelines;

use super::every_surface::{EverySurface, SurfacesBy};
use super::geometry::SetupOf;
use super::prepared::CasterBuffers;
pub use super::settings::{FacetMode, PairVariant, ProjectionVariant, Settings};
use crate::frame::Frame;
use crate::gpu::{Buffer, Groups, Recorder};
use crate::light_view::LightView;
use crate::scene::mesh::MAX_EXTENT;
use crate::scene::{Camera, Light};
use crate::stages::Count;
use crate::stages::camera_visibility::Blocks;
use crate::stages::facet_classify::{ClassifyInputs, Facets};
use crate::stages::light_layers::Layers;
use crate::stages::pixel_counts::PixelCounts;
use crate::stages::pixel_texel_pairs::{PairLists, TALLY_COUNTERS, TALLY_WORDS};
use crate::status::{Status, StatusBand};
use crate::{Error, Result};
use found::FoundFacets;
pub use frame_source::{Extent, FacetSource, MapSource, Strip};
use glam::{DVec3, Vec3};
pub use memory::Capacities;
use memory::{Arg, FacetMemory, Memory, PairMemory, frames, requests};
pub use pipelines::Pipelines;
use std::mem::offset_of;
use std::sync::Arc;

/// The pipelines with the memory of one mesh, image and map size.
pub struct FacetMasks {
    settings: Settings,
    with: Arc<Pipelines>,
    every_surface: Option<EverySurface>,
    memory: Memory,
    capacities: Capacities,
    found: Option<FoundFacets>,
    keeps_found: bool,
}

impl FacetMasks {
    /// Makes all memory but that of the casters.
    ///
    /// # Errors
    /// [`Error::Config`] for impossible settings or pipelines made for others, [`Error::Memory`] and [`Error::Gpu`] if
    /// memory does not suffice.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: Arc<Pipelines>,
        casters: &CasterBuffers,
        settings: &Settings,
        capacities: Capacities,
    ) -> Result<Self> {
        settings.check()?;
        if !pipelines.serve(settings) {
            return Err(Error::Config(
                "the pipelines were made for other numbers of samples or facets, masks, pairs, filter or counts"
                    .to_owned(),
            ));
        }
        let every_surface = match settings.facets {
            FacetMode::One => None,
            FacetMode::All => {
                let casters = (casters.triangles.len(), pipelines.take_receivers());
                Some(EverySurface::new(device, queue, casters, settings, capacities)?)
            }
        };
        let memory = Memory::new(device, queue, casters, settings, &pipelines, capacities)?;
        let settings = settings.clone();
        Ok(Self { settings, with: pipelines, every_surface, memory, capacities, found: None, keeps_found: false })
    }

    /// Sizes anew what `capacities` change, keeping all else.
    ///
    /// # Errors
    /// As [`FacetMasks::new`]; all is then as before.
    pub fn resize(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, capacities: Capacities) -> Result<()> {
        let (m, now, c) = (&self.memory, self.capacities, capacities);
        // All of it is made before any of it takes its place.
        let pairs = |c: Capacities| (c.pixel_pairs, c.triangle_pairs, c.candidates);
        let lists = (pairs(c) != pairs(now)).then(|| PairMemory::new(device, &self.settings, c)).transpose()?;
        let facets = (c.facets != now.facets)
            .then(|| FacetMemory::new(device, &self.settings, m.scan_scratch.capacity(), c.facets));
        let facets = facets.transpose()?;
        let of_runs = || Ok((frames(device, c)?, Buffer::storage(device, "status", Status::words(c.all_bands()))?));
        // Those of the most views so far: a camera that turns sees another number of a cube's sides now and then.
        let of_runs = (!self.has_room_for(c)).then(of_runs).transpose()?;
        let totals = [m.visibility.len(), c.facets, m.geometry.facts.light_items.len()];
        let sizes = |c: Capacities| (pairs(c), c.facets);
        let requests = (sizes(c) != sizes(now)).then(|| requests(device, queue, totals, c)).transpose()?;
        if let Some(every_surface) = &mut self.every_surface {
            every_surface.resize(device, queue, &self.settings, (now, c))?;
        }
        let m = &mut self.memory;
        if let Some(PairMemory { lists, unsorted }) = lists {
            (m.lists, m.unsorted) = (lists, unsorted);
        }
        if let Some(FacetMemory { facets, offsets, scan_scratch }) = facets {
            (m.facets, m.facet_offsets, m.scan_scratch) = (facets, offsets, scan_scratch);
            self.found = None;
        }
        if let Some((frames, status)) = of_runs {
            (m.frames, m.status) = (frames, status);
        }
        if let Some(requests) = requests {
            m.requests = requests;
        }
        self.capacities = capacities;
        Ok(())
    }

    /// Whether there are uniforms and counters for as many views and bands.
    pub(crate) fn has_room_for(&self, capacities: Capacities) -> bool {
        capacities.all_bands() <= self.memory.frames.len()
    }

    /// Says whether frames from now on keep the facets that they find, for the frames of other lights ([`FacetSource::Kept`]).
    ///
    /// # Errors
    /// [`Error::Memory`] and [`Error::Gpu`] if there is no memory for them; all is then as before.
    pub fn keep_found(&mut self, device: &wgpu::Device, keeps: bool) -> Result<()> {
        if keeps && self.every_surface.is_some() && self.found.is_none() {
            self.found = Some(FoundFacets::new(device, self.memory.facets.list.len())?);
        }
        self.keeps_found = keeps;
        Ok(())
    }

    /// Writes what the next frame is computed from: camera, light and its views, as many as [`Capacities::views`], which rows
    /// of the image it is, and what its last stage is to write into [`StatusHead::finished`](crate::status::StatusHead::finished).
    ///
    /// # Errors
    /// [`Error::Scene`] if camera or light cannot be used, or coordinates are beyond 10^18; [`Error::Config`] for another number of views,
    /// or views of maps of another size.
    #[expect(clippy::too_many_arguments, reason = "one argument a thing it depends on")]
    pub fn prepare(
        &self,
        queue: &wgpu::Queue,
        casters: &CasterBuffers,
        camera: &Camera,
        light: &Light,
        views: &[LightView],
        bounds: (DVec3, DVec3),
        strip: Strip,
        stamp: u32,
    ) -> Result<()> {
        let mut frames = self.frames_for(casters, camera, light, views, bounds, strip)?;
        frames.iter_mut().for_each(|frame| frame.stamp = stamp);
        frames.iter().zip(&self.memory.frames).for_each(|(frame, buffer)| buffer.write(queue, &[*frame]));
        Ok(())
    }

    /// Frames that [`FacetMasks::prepare`] writes, one for each of [`FacetMasks::frames`].
    ///
    /// # Errors
    /// As [`FacetMasks::prepare`].
    pub fn frames_for(
        &self,
        casters: &CasterBuffers,
        camera: &Camera,
        light: &Light,
        views: &[LightView],
        bounds: (DVec3, DVec3),
        strip: Strip,
    ) -> Result<Vec<Frame>> {
        camera.check()?;
        light.check()?;
        let reach = |p: DVec3| p.abs().max_element();
        let far = reach(bounds.0).max(reach(bounds.1)).max(reach(Vec3::from(camera.eye).as_dvec3()));
        if far > MAX_EXTENT {
            return Err(Error::Scene(format!("casters or camera reach to {far}: 32-bit numbers do for {MAX_EXTENT}")));
        }
        let s = &self.settings;
        let have = self.capacities.views as usize;
        if views.len() != have {
            return Err(Error::Config(format!("{} views of the light in a frame made for {have}", views.len())));
        }
        if let Some(other) = views.iter().find(|view| view.map_size != s.map) {
            let (map, have) = (other.map_size, s.map);
            return Err(Error::Config(format!("a view of {map} texels a side in a frame made for {have}")));
        }
        let flag = |on: bool, bit: u32| if on { bit } else { 0 };
        let flags = flag(s.cull_back && views.iter().all(|view| view.outside), Frame::CULL_BACK)
            | flag(s.keeps_validity(), Frame::VALIDITY)
            | flag(s.facets == FacetMode::All, Frame::CLAMP)
            | flag(!s.settle, Frame::ALL_UNDECIDED);
        let mut frames = Vec::with_capacity(self.capacities.all_bands());
        for (k, view) in views.iter().enumerate() {
            let mut frame = Frame::new(camera, light, view, bounds, strip.image, &s.samples);
            (frame.image_size, frame.first_row) = (s.size, strip.first_row);
            [frame.rows_above, frame.rows_below] = strip.others;
            frame.flags |= flags | flag(k > 0, Frame::FURTHER_VIEW) | flag(k + 1 < have, Frame::MORE_VIEWS);
            frame.flags |= flag(have > 1, Frame::CUT_LAYERS);
            frame.vertex_count = casters.positions.len() as u32;
            frame.triangle_count = casters.triangles.len() as u32;
            frame.edge_count = casters.edges.len() as u32;
            frame.facets_total = self.memory.facets.list.len() as u32;
            frame.pixel_texel_capacity = self.capacities.pixel_pairs as u32;
            frame.triangle_texel_capacity = self.capacities.triangle_pairs as u32;
            frame.candidate_capacity = self.capacities.candidates as u32;
            frame.pixel_triangle_capacity = self.capacities.pixel_triangles as u32;
            frame.complex_capacity = self.capacities.complex_pixels as u32;
            let share = frame.facets_total.div_ceil(self.capacities.bands);
            for band in 0..self.capacities.bands {
                frame.first_facet = (band * share).min(frame.facets_total);
                frame.facet_count = share.min(frame.facets_total - frame.first_facet);
                frames.push(frame);
            }
        }
        Ok(frames)
    }

    /// Records the frame. The whole method, in order.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record(&self, rec: &mut Recorder, casters: &CasterBuffers) -> Result<()> {
        self.record_seen(rec, casters, FacetSource::Found, MapSource::Made, Extent::Everything)
    }

    /// As [`FacetMasks::record`], with what pixels show from elsewhere, or light maps that were made before, or no more than `extent`.
    /// Where nothing casts a shadow the frames must have [`Frame::NOTHING_CASTS`] set, and there is one view.
    ///
    /// # Errors
    /// As [`FacetMasks::record`], and those of `seen`.
    pub fn record_seen(
        &self,
        rec: &mut Recorder,
        casters: &CasterBuffers,
        seen: FacetSource,
        maps: MapSource,
        extent: Extent,
    ) -> Result<()> {
        let m = &self.memory;
        let frame = &m.frames[0];
        rec.clear(m.status.raw());
        m.counts.iter().for_each(|counts| rec.clear(counts.raw()));
        if extent == Extent::Nothing {
            rec.clear(m.geometry.id_keys.raw());
            rec.clear(m.facets.pixel_facets.raw());
            self.record_resolve(rec);
            return Ok(());
        }
        rec.clear_words(m.lists.candidates.raw(), 0, TALLY_WORDS as u64);

        let geometry = &m.geometry;
        let is_kept = matches!(seen, FacetSource::Kept);
        if !is_kept {
            geometry.record_setup(rec, &self.with.geometry, frame, (casters, &m.status), SetupOf::Camera)?;
        }
        let in_camera = geometry.in_camera(casters);
        match (self.every_surface.as_ref().zip(self.with.surfaces.as_ref()), seen) {
            (_, FacetSource::Kept) => self.found.iter().for_each(|found| found.record_restore(rec, m)),
            (None, FacetSource::Centres(write)) => write(rec, frame)?,
            (None, _) => geometry.record_camera(rec, &self.with.geometry, frame, casters)?,
            (Some((camera, with)), seen) => {
                let by = match seen {
                    FacetSource::Samples(given) => SurfacesBy::Samples(given),
                    FacetSource::Receivers(write, given) => {
                        write(rec, frame)?;
                        SurfacesBy::Receivers(given)
                    }
                    _ => SurfacesBy::Search,
                };
                rec.clear(geometry.id_keys.raw());
                let positions = &casters.positions;
                camera.record(
                    rec,
                    with,
                    frame,
                    &m.samples,
                    in_camera,
                    positions,
                    casters.surfaces.as_ref(),
                    &m.facets,
                    &geometry.id_keys,
                    &m.status,
                    by,
                )?;
            }
        }
        if self.keeps_found && !is_kept {
            self.found.iter().for_each(|found| found.record_keep(rec, m));
        }
        if self.every_surface.is_none() {
            let stage = &mut rec.stage("facet_classify");
            self.with.classify.record_one(stage, frame, &geometry.id_keys, &m.facets);
        }
        for view in 0..self.capacities.views {
            // Views share the memory of the maps: of several the last would be left.
            if extent == Extent::Everything {
                if maps != MapSource::Kept || self.capacities.views > 1 {
                    self.record_maps(rec, casters, maps, view)?;
                }
                let texels = self.capacities.status_band(view, 0) + offset_of!(StatusBand, marked_texels) / 4;
                m.maps.record_kept(rec, &m.status, texels);
            }
            self.record_view(rec, casters, view, extent)?;
        }
        if extent == Extent::Everything && !is_kept {
            geometry.record_depths(rec, &self.with.geometry, (frame, &m.samples), casters, &m.status);
        }
        self.record_resolve(rec);
        self.record_filter(rec);
        if let (Some(counted), Some(counts)) = (&self.with.counted, &m.counts) {
            counted.record_facets(&mut rec.stage("pixel_counts"), frame, &m.facets, counts);
        }
        Ok(())
    }

    fn record_resolve(&self, rec: &mut Recorder) {
        let m = &self.memory;
        let stage = &mut rec.stage("resolve");
        self.with.resolve.record(stage, &m.frames[0], &m.facets, &m.visibility, &m.lit, &m.status);
    }

    /// Weights samples of neighbours into the visibility, where a filter asks for that.
    fn record_filter(&self, rec: &mut Recorder) {
        let m = &self.memory;
        if let (Some(with), Some(memory)) = (&self.with.filter, &m.filter) {
            let stage = &mut rec.stage("pixel_filter");
            with.record(stage, &m.frames[0], &m.facets, &m.lit, &m.visibility, memory);
        }
    }

    /// Records the maps of one view of the light: casters set up in it, layers, silhouettes and their table.
    fn record_maps(&self, rec: &mut Recorder, casters: &CasterBuffers, maps: MapSource, view: u32) -> Result<()> {
        let (m, geometry) = (&self.memory, &self.memory.geometry);
        let frame = &m.frames[self.frame_at(view, 0)];
        if view > 0 {
            // A facet and a triangle that had nothing in common in the view before may have in this one.
            rec.clear_words(m.lists.candidates.raw(), TALLY_COUNTERS as u64, (TALLY_WORDS - TALLY_COUNTERS) as u64);
        }
        rec.clear(geometry.requested.raw());
        if maps == MapSource::Requested {
            let stage = &mut rec.stage("requested_blocks");
            let (triangles, positions) = (&casters.triangles, &casters.positions);
            self.args(stage, Arg::Listed, &m.facets.pixel_facets)?;
            let groups = Groups::Indirect(m.args.raw(), Arg::Listed.word());
            let (with, requested) = (&self.with.requests, &geometry.requested);
            with.record(stage, frame, triangles, positions, &m.facets.list, requested, groups);
        }
        geometry.record_setup(rec, &self.with.geometry, frame, (casters, &m.status), SetupOf::Light)?;
        // Around a light they reach behind each of its views.
        let cut = self.capacities.views > 1;
        m.maps.record(rec, &self.with.light_maps, frame, (casters, geometry), &m.status, cut)
    }

    /// Records the part of one view of the light in the facets and their masks.
    fn record_view(&self, rec: &mut Recorder, casters: &CasterBuffers, view: u32, extent: Extent) -> Result<()> {
        let (m, geometry) = (&self.memory, &self.memory.geometry);
        let frame = &m.frames[self.frame_at(view, 0)];
        let (triangles, in_light) = (&casters.triangles, geometry.in_light(casters));
        let count = m.facets.list.len();
        if self.every_surface.is_some() {
            // Those beyond the last are not classified.
            rec.clear_words(m.facets.items.raw(), 0, count as u64);
        }
        {
            let stage = &mut rec.stage("facet_classify");
            let around = ClassifyInputs {
                triangles,
                positions: &casters.positions,
                sat: &m.maps.sat,
                splits: &m.maps.layers.splits,
            };
            self.args(stage, Arg::Listed, &m.facets.pixel_facets)?;
            let groups = Groups::Indirect(m.args.raw(), Arg::Listed.word());
            self.with.classify.record_classify(stage, frame, &m.samples, around, &m.facets, groups);
            if extent != Extent::Everything {
                return Ok(());
            }
            self.list(stage, Arg::Facets, (&m.facets.items, count), &m.facet_offsets)?;
        }
        let Some(with) = &self.with.pairs else {
            return Err(Error::Config("the pipelines were made for frames in which nothing casts a shadow".to_owned()));
        };
        for band in 0..self.capacities.bands {
            self.record_band(rec, with, casters, in_light, (view, band))?;
        }
        Ok(())
    }

    /// Which of the frames is that of a view and band.
    fn frame_at(&self, view: u32, band: u32) -> usize {
        (view * self.capacities.bands + band) as usize
    }

    /// Records the stage `camera_visibility` alone, to be read by what takes its place; after `triangle_setup`, as in what
    /// [`FacetMasks::record_seen`] is given.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device has no memory for parameters.
    pub fn record_camera(&self, rec: &mut Recorder, casters: &CasterBuffers) -> Result<()> {
        self.memory.geometry.record_camera(rec, &self.with.geometry, &self.memory.frames[0], casters)
    }

    /// Lists the work that the first of `items`, so many, count, into `offsets`.
    fn list(
        &self,
        stage: &mut crate::gpu::Stage,
        arg: Arg,
        items: (&Buffer<u32>, usize),
        offsets: &Buffer<u32>,
    ) -> Result<()> {
        let m = &self.memory;
        self.with.work.record(stage, items, offsets, &m.scan_scratch, (&m.requests[arg as usize], &m.args))
    }

    /// Exclusive scan of `items` into `offsets`, whose last two words take the sum and the overflow flag.
    fn scan(
        &self,
        stage: &mut crate::gpu::Stage,
        items: &Buffer<u32>,
        offsets: &Buffer<u32>,
        count: usize,
    ) -> Result<()> {
        self.with.scan.record(stage, items, offsets, (offsets, count), &self.memory.scan_scratch, Count::Exactly(count))
    }

    /// Indirect arguments for as many items as the last but one word of `offsets` says.
    fn args(&self, stage: &mut crate::gpu::Stage, arg: Arg, offsets: &Buffer<u32>) -> Result<()> {
        let m = &self.memory;
        self.with.fold.record(stage, offsets, &m.requests[arg as usize], &m.args)
    }

    /// Blocks of pixels of the casters, after `triangle_setup`.
    pub fn in_camera<'a>(&'a self, casters: &'a CasterBuffers) -> Blocks<'a> {
        self.memory.geometry.in_camera(casters)
    }

    /// The uniform `frame` of each view and band, and of more where a frame before had more.
    pub fn frames(&self) -> &[Buffer<Frame>] {
        &self.memory.frames
    }

    /// How the lists are sized.
    pub fn capacities(&self) -> Capacities {
        self.capacities
    }

    /// Visibility of every pixel, row by row from the top.
    pub fn visibility(&self) -> &Buffer<f32> {
        &self.memory.visibility
    }

    /// Lit samples of every pixel.
    pub fn lit(&self) -> &Buffer<u32> {
        &self.memory.lit
    }

    /// Counts of every pixel, where [`Settings::count_pixels`] is set.
    pub fn counts(&self) -> Option<&Buffer<PixelCounts>> {
        self.memory.counts.as_ref()
    }

    /// Complement of the triangle at every pixel centre; 0 where there is none.
    pub fn id_keys(&self) -> &Buffer<u32> {
        &self.memory.geometry.id_keys
    }

    /// Facets and their masks.
    pub fn facets(&self) -> &Facets {
        &self.memory.facets
    }

    /// Pair lists of the last band.
    pub fn lists(&self) -> &PairLists {
        &self.memory.lists
    }

    /// Light layers, mask and splits.
    pub fn layers(&self) -> &Layers {
        &self.memory.maps.layers
    }

    /// Counters, see [`Status`].
    pub fn status(&self) -> &Buffer<u32> {
        &self.memory.status
    }
}
