//! Methods whose memory the settings alone decide: one run is the frame, unless what the method left out turns out to be needed, or, with a
//! facet for every surface, more facets than it had room for, which the next run has.

use super::by_views::{ByViews, Left};
use super::debug_views::DebugViews;
use super::deep_mapping::DeepMapping;
use super::facet_masks::{Capacities, FacetSource};
use super::geometry::{Geometry, GeometryPipelines, SetupOf, culled_views};
use super::history::MethodHistory;
use super::names::{MethodName, TexelQuery};
use super::output::Counts;
use super::polygon_mapping::PolygonMapping;
use super::prepared::{CasterBuffers, Prepared};
use super::ray_traced::RayTraced;
use super::reconstructable::Reconstructable;
use super::rectilinear::Rectilinear;
use super::resolution_matched::ResolutionMatched;
use super::settings::Settings;
use super::shadow_map::ShadowMapping;
use super::silhouette_mapping::SilhouetteMapping;
use super::spsm::Spsm;
use super::supersampled::Supersampled;
use crate::frame::{Frame, sample_words};
use crate::gpu::{Buffer, Gpu, Recorder, StagedUploads, Uploads};
use crate::light_view::{LightView, SplitPlan, unit_scale};
use crate::scene::{Camera, Light};
use crate::stages::PrimaryHits;
use crate::stages::facet_classify::Facets;
use crate::stages::pixel_counts::{CountedPixels, PixelCounts};
use crate::stages::pixel_views::LightViews;
use crate::status::{Status, StatusHead};
use crate::{Error, Result, status_word};
use glam::DVec3;
use std::mem::offset_of;

/// Inputs of a stage of such a method.
#[derive(Clone, Copy)]
pub struct StageInputs<'a> {
    /// The frame uniform.
    pub frame: &'a Buffer<Frame>,
    /// Sample offsets, see [`sample_words`].
    pub samples: &'a Buffer<[f32; 4]>,
    /// The mesh.
    pub casters: &'a CasterBuffers,
    /// Projected vertices and rectangles.
    pub geometry: &'a Geometry,
    /// Complement of the triangle at the centre of each pixel that asks this view of the light; 0 for all others.
    pub id_keys: &'a Buffer<u32>,
    /// Which of the light's views it is, and how many there are.
    pub view: [u32; 2],
    /// Counters, see [`Status`].
    pub status: &'a Buffer<u32>,
}

/// Device, mesh and settings that a method is made for.
#[derive(Clone, Copy)]
pub struct MethodParts<'a> {
    /// The device.
    pub device: &'a wgpu::Device,
    /// Its queue.
    pub queue: &'a wgpu::Queue,
    /// The mesh.
    pub prepared: &'a Prepared,
    /// The same on the GPU.
    pub casters: &'a CasterBuffers,
    /// Image, map, samples and options.
    pub settings: &'a Settings,
}

/// Camera, light view and box that a frame's uniforms follow from.
#[derive(Clone, Copy)]
pub struct FrameInputs<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// The light's view of the casters.
    pub view: &'a LightView,
    /// Whether there are others.
    pub several: bool,
    /// The box of the casters.
    pub bounds: (DVec3, DVec3),
    /// The frame uniform.
    pub frame: &'a Frame,
}

/// Words that a method may leave behind the counters of a frame.
pub const OUTCOME_WORDS: usize = 4;

/// Meaning of the words that a method left behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StripOutcome {
    /// Something that was left out was needed: the frame lacks it, and the next will not leave it out.
    pub left_out: bool,
    /// Evaluations, and those of them that needed 46 bits.
    pub evaluations: [u64; 2],
}

/// Which of several views of the light a pixel asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AskedViews {
    /// One that holds all of it and these many texels around.
    One(f32),
    /// All, one after the other: what they tell adds up in the method's memory.
    All,
    /// None: the first will do.
    None,
}

/// A method of fixed memory: stages after `triangle_setup` and `camera_visibility`, made for one mesh and setting.
pub trait FixedMethod: Send + Sync {
    /// Whether samples on the plane of a pixel's facet count beyond the surface, too: the light's view is wider then.
    fn beyond(&self) -> bool {
        false
    }

    /// Whether it finds what the camera sees by itself, and not at the centres of pixels.
    fn finds_surfaces(&self) -> bool {
        false
    }

    /// Whether casters are brought into the light's view before it, as points of a plane.
    fn projects_casters(&self) -> bool {
        true
    }

    /// How long its lists are.
    fn capacities(&self) -> Capacities {
        Capacities::NONE
    }

    /// Which views of the light a pixel asks.
    fn asks(&self) -> AskedViews {
        AskedViews::One(1.0)
    }

    /// Adds what changes from frame to frame and view to view.
    ///
    /// # Errors
    /// [`Error::Scene`] for a camera or light it cannot serve.
    fn upload(&self, _: &mut Uploads, _: FrameInputs) -> Result<()> {
        Ok(())
    }

    /// Records its stages for one view of the light.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters.
    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()>;

    /// Records the copy of [`OUTCOME_WORDS`] words or fewer to `to`, from word `at` on.
    fn record_outcome(&self, _rec: &mut Recorder, _to: &Buffer<u32>, _at: u64) {}

    /// Takes in these words, and the frame's counters.
    ///
    /// # Errors
    /// [`Error::Limit`] if something was left out for want of steps or of room, [`Error::Memory`] if there is none for more.
    fn outcome(&mut self, _: [u32; OUTCOME_WORDS], _: &StatusHead) -> Result<StripOutcome> {
        Ok(StripOutcome::default())
    }

    /// Visibility of every pixel, row by row from the top; 1 where nothing is seen.
    fn visibility(&self) -> &Buffer<f32>;

    /// Lit samples of every pixel, where the method keeps them.
    fn lit(&self) -> Option<&Buffer<u32>> {
        None
    }

    /// Classes of pixels, where it keeps them, behind as many other words.
    fn classes(&self) -> Option<&Buffer<u32>> {
        None
    }

    /// The facets of the last frame, where it has facets.
    fn facets(&self) -> Option<&Facets> {
        None
    }

    /// Counts that have to be read back, in place of those of the frame's counters.
    ///
    /// # Errors
    /// [`Error::Gpu`].
    fn counts(&self, _: &Gpu) -> Result<Option<Counts>> {
        Ok(None)
    }

    /// Reads back what there is to look at; `None` where the method keeps neither classes nor a map.
    ///
    /// # Errors
    /// [`Error::Gpu`].
    fn looks(&self, _: &Gpu) -> Result<Option<DebugViews>> {
        Ok(None)
    }
}

/// Such a method with the memory that all of them have: what the camera sees, the frame's uniform, counters.
pub struct FixedMemory {
    settings: Settings,
    with: GeometryPipelines,
    geometry: Geometry,
    frame: Buffer<Frame>,
    samples: Buffer<[f32; 4]>,
    status: Buffer<u32>,
    method: Box<dyn FixedMethod>,
    /// Where pixels are counted.
    counted: Option<(CountedPixels, Buffer<PixelCounts>)>,
    by_views: Option<ByViews>,
    history: Option<MethodHistory>,
    views: usize,
}

impl FixedMemory {
    /// Most views of the light.
    pub const MOST_VIEWS: usize = LightViews::MOST;

    /// Builds pipelines and memory of `method`, which is not `facet-masks`.
    ///
    /// # Errors
    /// [`Error::Config`] for impossible settings and for `facet-masks`, [`Error::Memory`] and [`Error::Gpu`] if memory does not suffice.
    pub fn new(method: MethodName, parts: MethodParts) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        settings.check()?;
        let samples = Buffer::uniform(device, "samples", 64)?;
        samples.write(queue, &sample_words(&settings.samples));
        let status = Buffer::storage(device, "status", Self::outcome_at(Self::MOST_VIEWS))?;
        let settings = Settings { partition: method.partition(settings), ..settings.clone() };
        let query = method.row().query;
        let (asks_map, culls) = (matches!(query, TexelQuery::Map(_)), culled_views(casters, &settings, query));
        let method: Box<dyn FixedMethod> = match query {
            TexelQuery::Facets => {
                return Err(Error::Config(format!("{}: its lists are not known before a frame", method.name())));
            }
            TexelQuery::Triangles => Box::new(Spsm::new(parts)?),
            TexelQuery::Centres => Box::new(Reconstructable::new(parts)?),
            TexelQuery::Polygons => Box::new(PolygonMapping::new(parts)?),
            TexelQuery::Deep => Box::new(DeepMapping::new(parts)?),
            TexelQuery::Silhouettes => Box::new(SilhouetteMapping::new(parts)?),
            TexelQuery::Map(query) => Box::new(ShadowMapping::new(parts, query)?),
            TexelQuery::Pages => Box::new(ResolutionMatched::new(parts)?),
            TexelQuery::Axes => Box::new(Rectilinear::new(parts)?),
            TexelQuery::Rays => Box::new(RayTraced::new(parts)?),
            TexelQuery::Samples => Box::new(Supersampled::new(parts)?),
        };
        let history = match (method.asks(), settings.history) {
            (AskedViews::One(reach), Some(history)) if asks_map => {
                Some(MethodHistory::new(device, reach, history, settings.pixels())?)
            }
            _ => None,
        };
        let counts = settings.count_pixels && (method.facets().is_some() || method.classes().is_some());
        let of_pixels = || Buffer::storage(device, "pixel_counts.counts", settings.pixels());
        let counted = || of_pixels().map(|counts| (CountedPixels::new(device), counts));
        Ok(Self {
            counted: counts.then(counted).transpose()?,
            with: GeometryPipelines::new(device, settings.alpha_tested, settings.tells_depths()),
            geometry: Geometry::new(device, queue, (casters, 0), settings.pixels(), settings.map as usize, culls)?,
            settings,
            frame: Buffer::uniform(device, "frame", 1)?,
            samples,
            status,
            method,
            by_views: None,
            history,
            views: 1,
        })
    }

    /// Where the outcome of a view begins in the counters.
    fn outcome_at(view: usize) -> usize {
        Status::words(1) + view * OUTCOME_WORDS
    }

    /// Makes room for so many views of the light, of [`FixedMemory::MOST_VIEWS`].
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn make_room_for(&mut self, device: &wgpu::Device, views: usize) -> Result<()> {
        if let (AskedViews::One(reach), true, None) = (self.method.asks(), views > 1, &self.by_views) {
            self.by_views = Some(ByViews::new(device, reach, self.left())?);
        }
        self.views = views;
        Ok(())
    }

    /// Slices of what the camera sees, each with a view of the light.
    pub fn partition(&self) -> Option<SplitPlan> {
        self.settings.partition
    }

    /// Views of the light in the last frame.
    pub fn views(&self) -> usize {
        self.views
    }

    /// The view that each pixel asked in the last frame, row by row; empty where there was one, or pixels ask all that hold them.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] if the device fails.
    pub fn asked_views(&self, gpu: &Gpu) -> Result<Vec<u32>> {
        let by = self.by_views.as_ref().filter(|_| self.views > 1);
        by.map_or(Ok(Vec::new()), |by| by.choice().view_of.read(gpu))
    }

    /// The views of the next frame, whose texels lie otherwise than those of the last where frames before are kept.
    pub fn jittered(&self, views: Vec<LightView>) -> Vec<LightView> {
        self.history.as_ref().map_or(views.clone(), |history| history.jittered(&views))
    }

    /// Whether frames before are kept.
    pub fn keeps_history(&self) -> bool {
        self.history.is_some()
    }

    /// Forgets the frames before.
    pub fn forget_history(&mut self) {
        self.history.iter_mut().for_each(MethodHistory::forget);
    }

    fn left(&self) -> Left<'_> {
        let method = &self.method;
        Left { visibility: method.visibility(), lit: method.lit(), classes: method.classes() }
    }

    /// Contents of uniforms for a frame with these views of the light, which is to leave `stamp` in its counters: those of the first, then
    /// of each further one.
    ///
    /// # Errors
    /// [`Error::Scene`] if camera or light cannot be used, [`Error::Config`] for too many views.
    pub fn uploads(
        &mut self,
        casters: &CasterBuffers,
        (camera, light): (&Camera, &Light),
        views: &[LightView],
        bounds: (DVec3, DVec3),
        (stamp, flags, origins): (u32, u32, [[u32; 2]; 2]),
    ) -> Result<Vec<Uploads>> {
        camera.check()?;
        light.check()?;
        let (count, most) = (views.len(), Self::MOST_VIEWS);
        if !(1..=most).contains(&count) {
            return Err(Error::Config(format!("{count} views of the light, 1 to {most} are possible")));
        }
        let asked = if self.method.asks() == AskedViews::None { &views[..1] } else { views };
        let of_view = |view: &LightView| {
            let mut frame = Frame::new(camera, light, view, bounds, self.settings.size, &self.settings.samples);
            frame.vertex_count = casters.positions.len() as u32;
            frame.triangle_count = casters.triangles.len() as u32;
            frame.edge_count = casters.edges.len() as u32;
            frame.facets_total = self.settings.pixels() as u32;
            frame.facet_count = frame.facets_total;
            frame.stamp = stamp;
            // Of the flags of facets those that follow from the method are its own.
            frame.flags |= flags & Frame::MAPPED;
            frame.flags |= flags >> Frame::NO_LAYERS << Frame::NO_LAYERS;
            if self.method.finds_surfaces() {
                let c = self.method.capacities();
                frame.flags |= Frame::CLAMP;
                [frame.facets_total, frame.facet_count] = [c.facets as u32; 2];
                frame.pixel_triangle_capacity = c.pixel_triangles as u32;
                frame.complex_capacity = c.complex_pixels as u32;
            }
            [frame.given_origin, frame.target_origin] = origins;
            if let AskedViews::One(_) = self.method.asks() {
                frame.light_low[3] = view.nearest_of_maps(camera.rays(1, 1).eye, bounds);
            }
            let mut uploads = Uploads::default();
            uploads.write(&self.frame, &[frame]);
            let several = count > 1;
            self.method.upload(&mut uploads, FrameInputs { camera, view, several, bounds, frame: &frame })?;
            Ok(uploads)
        };
        let mut uploads = asked.iter().map(of_view).collect::<Result<Vec<_>>>()?;
        let [w, h] = self.settings.size;
        let rays = camera.rays(w, h);
        let scale = unit_scale(rays.eye, bounds);
        // In front of a view is what its run takes to be there.
        let relative = |view: &LightView| {
            let near = f64::from(view.nearest_of_maps(rays.eye, bounds));
            LightView { near, ..view.relative_to(rays.eye, scale) }
        };
        let relative: Vec<LightView> = asked.iter().map(relative).collect();
        if let (Some(by_views), [first, _, ..]) = (&self.by_views, &mut uploads[..]) {
            first.write(&by_views.choice().views, &[LightViews::new(&relative)]);
        }
        if let (Some(history), Some(first)) = (&mut self.history, uploads.first_mut()) {
            history.upload(first, (rays, scale), light, &relative);
        }
        Ok(uploads)
    }

    /// Records the frame, with the triangle at each pixel's centre from elsewhere where `source` says so. Before each view of the light but the
    /// first its uniforms are written.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters, and those of `source`.
    pub fn record(
        &self,
        rec: &mut Recorder,
        casters: &CasterBuffers,
        source: FacetSource,
        further: &[StagedUploads],
    ) -> Result<()> {
        let Self { with, geometry, frame, samples, status, method, .. } = self;
        rec.clear(status.raw());
        let count = 1 + further.len() as u32;
        let by_views = self.by_views.as_ref().filter(|_| count > 1);
        for view in 0..count {
            if let Some(uploads) = view.checked_sub(1).and_then(|k| further.get(k as usize)) {
                uploads.record(rec);
            }
            let of = match (view, method.projects_casters()) {
                (0, true) => Some(SetupOf::Both),
                (0, false) => Some(SetupOf::Camera),
                (_, projects) => projects.then_some(SetupOf::Light),
            };
            of.map_or(Ok(()), |of| geometry.record_setup(rec, with, frame, (casters, status), of))?;
            match source {
                _ if view > 0 => {}
                _ if method.finds_surfaces() => {}
                FacetSource::Centres(write) => write(rec, frame)?,
                _ => geometry.record_camera(rec, with, frame, casters)?,
            }
            let id_keys = match by_views {
                Some(by) => by.record_keep(rec, view, (frame, samples), casters, geometry)?,
                None => &geometry.id_keys,
            };
            method
                .record(rec, StageInputs { frame, samples, casters, geometry, id_keys, view: [view, count], status })?;
            method.record_outcome(rec, status, Self::outcome_at(view as usize) as u64);
            if let Some(by) = by_views {
                by.record_take(rec, view, frame, self.left())?;
            }
        }
        by_views.iter().for_each(|by| by.record_put(rec, self.left()));
        geometry.record_depths(rec, with, (frame, samples), casters, status);
        if let Some(history) = &self.history {
            let (id_keys, triangles, points) = (&geometry.id_keys, &casters.triangles, &geometry.points);
            history.record(rec, frame, PrimaryHits { samples, id_keys, triangles, points }, method.visibility());
        }
        if let Some((counted, counts)) = &self.counted {
            rec.clear(counts.raw());
            let stage = &mut rec.stage("pixel_counts");
            method.facets().iter().for_each(|facets| counted.record_facets(stage, frame, facets, counts));
            method.classes().iter().for_each(|classes| counted.record_classes(stage, frame, classes, counts));
        }
        // After all else.
        let (stamp, finished) = (offset_of!(Frame, stamp) as u64 / 4, status_word!(finished) as u64);
        rec.copy_words(frame.raw(), stamp, status.raw(), finished, 1);
        Ok(())
    }

    /// Records the stage `camera_visibility` alone.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_camera(&self, rec: &mut Recorder, casters: &CasterBuffers) -> Result<()> {
        self.geometry.record_camera(rec, &self.with, &self.frame, casters)
    }

    /// Takes in the counters of a frame.
    ///
    /// # Errors
    /// As [`FixedMethod::outcome`].
    pub fn outcome(&mut self, status: &[u32]) -> Result<StripOutcome> {
        let mut all = StripOutcome::default();
        let head = Status::of(status).head;
        for left in status.get(Self::outcome_at(0)..).unwrap_or_default().chunks_exact(OUTCOME_WORDS) {
            let mut words = [0; OUTCOME_WORDS];
            words.copy_from_slice(left);
            let StripOutcome { left_out, evaluations: [some, refined] } = self.method.outcome(words, &head)?;
            all.left_out |= left_out;
            all.evaluations = [all.evaluations[0] + some, all.evaluations[1] + refined];
        }
        Ok(all)
    }

    /// The frame uniform.
    pub fn frame(&self) -> &Buffer<Frame> {
        &self.frame
    }

    /// Counters, see [`Status`]; behind them the method's own words.
    pub fn status(&self) -> &Buffer<u32> {
        &self.status
    }

    /// Complement of the triangle at every pixel centre; 0 where there is none.
    pub fn id_keys(&self) -> &Buffer<u32> {
        &self.geometry.id_keys
    }

    /// Counts of every pixel, where they are asked for and there is something to count.
    pub fn counts(&self) -> Option<&Buffer<PixelCounts>> {
        self.counted.as_ref().map(|(_, counts)| counts)
    }

    /// The method.
    pub fn method(&self) -> &dyn FixedMethod {
        &*self.method
    }
}
