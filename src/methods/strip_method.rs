//! A method with the memory of one strip of rows, as [`ShadowPass`](crate::ShadowPass) drives it.

use super::facet_masks::{Capacities, Extent, FacetMasks, FacetSource, MapSource, Pipelines, Settings, Strip};
#[cfg(feature = "baselines")]
use super::fixed_memory::{AskedViews, FixedMemory, MethodParts, StripOutcome};
use super::names::MethodName;
use super::prepared::{CasterBuffers, Prepared};
use crate::frame::Frame;
#[cfg(feature = "baselines")]
use crate::gpu::KeptPrograms;
use crate::gpu::{Buffer, Recorder, StagedUploads, Uploads};
use crate::light_view::{LightView, Margins};
use crate::scene::{Camera, Light};
use crate::stages::camera_visibility::Blocks;
use crate::stages::facet_classify::Facets;
use crate::stages::pixel_counts::PixelCounts;
use crate::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

/// Pipelines from which methods are made for any number of meshes and images.
#[derive(Clone, Debug)]
pub enum MethodPipelines {
    /// `facet-masks`.
    FacetMasks(Arc<Pipelines>),
    /// Another method, whose pipelines are kept as they are made.
    #[cfg(feature = "baselines")]
    Fixed(MethodName, KeptPrograms),
}

impl MethodPipelines {
    /// Those of a method; `receivers`: for frames with surfaces that are no casters, too.
    ///
    /// # Errors
    /// [`Error::Config`] for a method that this build lacks, and for receivers with one that knows none.
    pub fn new(device: &wgpu::Device, method: MethodName, settings: &Settings, receivers: bool) -> Result<Self> {
        if method == MethodName::FacetMasks {
            let build = if receivers { Pipelines::with_receivers } else { Pipelines::new };
            return Ok(Self::FacetMasks(Arc::new(build(device, settings))));
        }
        let name = method.name();
        if receivers {
            return Err(Error::Config(format!("{name}: no receivers that are no casters; facet-masks has them")));
        }
        #[cfg(feature = "baselines")]
        return Ok(Self::Fixed(method, KeptPrograms::in_use().silent()));
        #[cfg(not(feature = "baselines"))]
        return Err(Error::Config(format!("{name}: built without the feature baselines")));
    }

    /// The method.
    pub fn method(&self) -> MethodName {
        match self {
            Self::FacetMasks(_) => MethodName::FacetMasks,
            #[cfg(feature = "baselines")]
            Self::Fixed(method, _) => *method,
        }
    }

    /// Does `work` with the pipelines that are kept: none is made that was made before.
    pub fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        match self {
            Self::FacetMasks(_) => work(),
            #[cfg(feature = "baselines")]
            Self::Fixed(_, kept) => kept.within(work),
        }
    }

    /// Whether the method's memory is fixed: no list grows, and there is one strip.
    pub fn is_fixed(&self) -> bool {
        !matches!(self, Self::FacetMasks(_))
    }
}

/// The method.
pub enum StripMethod {
    /// `facet-masks`, whose lists may grow.
    FacetMasks(Box<FacetMasks>),
    /// Another one, of the whole image.
    #[cfg(feature = "baselines")]
    Fixed(Box<FixedMemory>),
}

/// Camera, light and views of one frame.
#[derive(Clone, Copy)]
pub struct FrameOf<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// The light.
    pub light: &'a Light,
    /// Its views of the casters.
    pub views: &'a [LightView],
    /// The box of the casters.
    pub bounds: (DVec3, DVec3),
    /// Stamp that the GPU leaves in the counters when it is done.
    pub stamp: u32,
    /// Number of its light maps; 0 if it needs none.
    pub maps: u32,
    /// Their margins, where they are wider than the frame's own.
    pub margins: Option<Margins>,
    /// Flags of [`Frame`] besides those that follow from settings and views.
    pub flags: u32,
    /// Where the image begins in the application's G-buffer, and in its target.
    pub origins: [[u32; 2]; 2],
}

impl StripMethod {
    /// Makes the memory.
    ///
    /// # Errors
    /// As [`FacetMasks::new`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        with: &MethodPipelines,
        (prepared, casters): (&Prepared, &CasterBuffers),
        settings: &Settings,
        capacities: Capacities,
    ) -> Result<Self> {
        #[cfg(not(feature = "baselines"))]
        let _ = prepared;
        match with {
            MethodPipelines::FacetMasks(with) => {
                let method = FacetMasks::new(device, queue, with.clone(), casters, settings, capacities)?;
                Ok(Self::FacetMasks(Box::new(method)))
            }
            #[cfg(feature = "baselines")]
            MethodPipelines::Fixed(method, kept) => {
                let parts = MethodParts { device, queue, prepared, casters, settings };
                kept.within(|| FixedMemory::new(*method, parts)).map(|made| Self::Fixed(Box::new(made)))
            }
        }
    }

    /// Contents of uniforms for a frame; of a method that takes the light's views one by one, those of the first, then of each further one.
    ///
    /// # Errors
    /// As [`FacetMasks::frames_for`].
    pub fn uploads(&mut self, casters: &CasterBuffers, of: FrameOf, strip: Strip) -> Result<Vec<Uploads>> {
        let FrameOf { camera, light, views, bounds, stamp, maps, margins, flags, origins } = of;
        match self {
            Self::FacetMasks(method) => {
                let mut uploads = Uploads::default();
                let frames = method.frames_for(casters, camera, light, views, bounds, strip)?;
                for (mut frame, buffer) in frames.into_iter().zip(method.frames()) {
                    (frame.stamp, frame.maps, frame.flags) = (stamp, maps, frame.flags | flags);
                    [frame.given_origin, frame.target_origin] = origins;
                    if let Some(Margins { texels, depth }) = margins {
                        frame.map_margin = frame.map_margin.max(texels as f32);
                        frame.depth_margin = frame.depth_margin.max(depth as f32);
                    }
                    uploads.write(buffer, &[frame]);
                }
                Ok(vec![uploads])
            }
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.uploads(casters, (camera, light), views, bounds, (stamp, flags, origins)),
        }
    }

    /// Says whether frames keep what the camera sees for the frames of other lights: `facet-masks` alone can.
    ///
    /// # Errors
    /// As [`FacetMasks::keep_found`].
    pub fn keep_found(&mut self, device: &wgpu::Device, keeps: bool) -> Result<()> {
        match self {
            Self::FacetMasks(method) => method.keep_found(device, keeps),
            #[cfg(feature = "baselines")]
            Self::Fixed(_) => Ok(()),
        }
    }

    /// Records the frame, of which the uniforms are written, but for those of `further` views.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters, and those of `source`.
    pub fn record(
        &self,
        rec: &mut Recorder,
        casters: &CasterBuffers,
        source: FacetSource,
        (maps, extent): (MapSource, Extent),
        further: &[StagedUploads],
    ) -> Result<()> {
        #[cfg(not(feature = "baselines"))]
        let _ = further;
        match self {
            Self::FacetMasks(method) => method.record_seen(rec, casters, source, maps, extent),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.record(rec, casters, source, further),
        }
    }

    /// Makes room for a frame with so many views of the light; lists serve all views.
    ///
    /// # Errors
    /// As [`FacetMasks::resize`]; all is then as before.
    pub fn make_room_for(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, views: u32) -> Result<()> {
        match self {
            Self::FacetMasks(method) => method.resize(device, queue, Capacities { views, ..method.capacities() }),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.make_room_for(device, views as usize),
        }
    }

    /// Whether that takes no other memory.
    pub fn has_room_for(&self, views: u32) -> bool {
        match self {
            Self::FacetMasks(method) => method.has_room_for(Capacities { views, ..method.capacities() }),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.views() as u32 == views,
        }
    }

    /// Views of the light in the last frame.
    pub fn views(&self) -> u32 {
        match self {
            Self::FacetMasks(method) => method.capacities().views,
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.views() as u32,
        }
    }

    /// Blocks of pixels of the casters, of `facet-masks`.
    pub fn in_camera<'a>(&'a self, casters: &'a CasterBuffers) -> Option<Blocks<'a>> {
        match self {
            Self::FacetMasks(method) => Some(method.in_camera(casters)),
            #[cfg(feature = "baselines")]
            Self::Fixed(_) => None,
        }
    }

    /// Records the stage `camera_visibility` alone, to be read by what takes its place; after `triangle_setup`.
    ///
    /// # Errors
    /// [`Error::Gpu`] if the device has no memory for parameters.
    pub fn record_camera(&self, rec: &mut Recorder, casters: &CasterBuffers) -> Result<()> {
        match self {
            Self::FacetMasks(method) => method.record_camera(rec, casters),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.record_camera(rec, casters),
        }
    }

    /// Sizes anew what `capacities` change, keeping all else.
    ///
    /// # Errors
    /// As [`FacetMasks::resize`]; all is then as before.
    pub fn resize(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, capacities: Capacities) -> Result<()> {
        match self {
            Self::FacetMasks(method) => method.resize(device, queue, capacities),
            #[cfg(feature = "baselines")]
            Self::Fixed(_) => Ok(()),
        }
    }

    /// How the lists are sized; without lists one band and round.
    pub fn capacities(&self) -> Capacities {
        match self {
            Self::FacetMasks(method) => method.capacities(),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.method().capacities(),
        }
    }

    /// Whether its memory is fixed.
    pub fn is_fixed(&self) -> bool {
        self.facet_masks().is_none()
    }

    /// `facet-masks`, if it is that.
    pub fn facet_masks(&self) -> Option<&FacetMasks> {
        match self {
            Self::FacetMasks(method) => Some(method),
            #[cfg(feature = "baselines")]
            Self::Fixed(_) => None,
        }
    }

    /// The other method, if it is one.
    #[cfg(feature = "baselines")]
    pub fn fixed(&self) -> Option<&FixedMemory> {
        match self {
            Self::FacetMasks(_) => None,
            Self::Fixed(method) => Some(method),
        }
    }

    /// Takes in the counters of a frame of another method than `facet-masks`.
    ///
    /// # Errors
    /// As [`FixedMethod::outcome`](super::fixed_memory::FixedMethod::outcome).
    #[cfg(feature = "baselines")]
    pub fn outcome(&mut self, status: &[u32]) -> Result<StripOutcome> {
        match self {
            Self::FacetMasks(_) => Ok(StripOutcome::default()),
            Self::Fixed(method) => method.outcome(status),
        }
    }

    /// Whether a pixel asks one of several views of the light.
    pub fn asks_one(&self) -> bool {
        match self {
            Self::FacetMasks(_) => false,
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => matches!(method.method().asks(), AskedViews::One(_)),
        }
    }

    /// The views of the next frame, moved by shares of a texel where [frames before](Settings::history) are kept.
    pub fn jittered(&self, views: Vec<LightView>) -> Vec<LightView> {
        match self {
            Self::FacetMasks(_) => views,
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.jittered(views),
        }
    }

    /// Whether frames before are kept, of one light.
    pub fn keeps_history(&self) -> bool {
        match self {
            Self::FacetMasks(_) => false,
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.keeps_history(),
        }
    }

    /// Forgets the frames before.
    pub fn forget_history(&mut self) {
        match self {
            Self::FacetMasks(_) => {}
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.forget_history(),
        }
    }

    /// The settings that the light's views are fitted by.
    pub fn view_settings<'a>(&self, settings: &'a Settings) -> std::borrow::Cow<'a, Settings> {
        match self {
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => {
                let facets = if method.method().beyond() { settings.facets } else { super::FacetMode::All };
                std::borrow::Cow::Owned(Settings { facets, partition: method.partition(), ..settings.clone() })
            }
            Self::FacetMasks(_) => std::borrow::Cow::Borrowed(settings),
        }
    }

    /// The frame uniform, of the first view and band.
    pub fn frame(&self) -> &Buffer<Frame> {
        match self {
            Self::FacetMasks(method) => &method.frames()[0],
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.frame(),
        }
    }

    /// Complement of the triangle at every pixel centre; 0 where there is none.
    pub fn id_keys(&self) -> &Buffer<u32> {
        match self {
            Self::FacetMasks(method) => method.id_keys(),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.id_keys(),
        }
    }

    /// Visibility of every pixel, row by row from the top.
    pub fn visibility(&self) -> &Buffer<f32> {
        match self {
            Self::FacetMasks(method) => method.visibility(),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.method().visibility(),
        }
    }

    /// Lit samples of every pixel, where the method keeps them.
    pub fn lit(&self) -> Option<&Buffer<u32>> {
        match self {
            Self::FacetMasks(method) => Some(method.lit()),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.method().lit(),
        }
    }

    /// Facets and their masks, where the method has them.
    pub fn facets(&self) -> Option<&Facets> {
        match self {
            Self::FacetMasks(method) => Some(method.facets()),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.method().facets(),
        }
    }

    /// Counts of every pixel, where they are kept.
    pub fn counts(&self) -> Option<&Buffer<PixelCounts>> {
        match self {
            Self::FacetMasks(method) => method.counts(),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.counts(),
        }
    }

    /// Counters, see [`Status`](crate::status::Status).
    pub fn status(&self) -> &Buffer<u32> {
        match self {
            Self::FacetMasks(method) => method.status(),
            #[cfg(feature = "baselines")]
            Self::Fixed(method) => method.status(),
        }
    }
}
