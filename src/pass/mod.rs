//! [`ShadowPass`]: shadows as a deferred pass inside an application's own frame, with its device, queue, encoder, G-buffer and vertex
//! buffers. The method is `facet-masks` if [`PassConfig::method`] names no other; what follows of facets, receivers and lists is of it.
//!
//! - [`ShadowPass::new`] builds every pipeline and all memory. [`ShadowPass::record`] appends a frame to the application's
//!   encoder: it never submits, waits or reads back. [`ShadowPass::status`] says afterwards how each frame came out.
//! - **Surfaces seen.** Without a G-buffer the pass finds them among the casters. With a texture of triangle numbers
//!   ([`GBuffer::TriangleIds`]) the stage `camera_visibility` is left out. Both give the same bits for the same triangles.
//!   With depths or positions ([`GBuffer::Surfaces`]), normals and triangle numbers if there are any, a pixel may also show what is
//!   no caster, such as a terrain that only receives: it gets a plane of its own. With triangle numbers of several samples a
//!   pixel ([`GBuffer::SampleIds`]) the search for every surface is left out.
//! - **Error.** With [`FacetMode::One`](crate::methods::FacetMode::One) the surface at the centre, found or given, represents the whole
//!   pixel: pixels that show several surfaces differ from scene truth: 0.4 to 14 % of all pixels of the scenes in `data/reports/truth.md`
//!   by more than one sample of 32.
//!   [`FacetMode::All`](crate::methods::FacetMode::All) has none of that error; of a G-buffer of several samples it misses what none of them shows, of depths or
//!   positions the outlines of what is no caster within a pixel: `data/reports/gbuffer.md` has figures.
//! - **Receivers.** What is no caster may lie anywhere, also outside the casters' box and behind the light. The light view is then
//!   fitted to all casters, as each may shadow something.
//! - **Parts.** Casters that stand, move and are instances may be one pass's ([`Casters::Parts`]), and come and go while it runs ([`ShadowPass::add_part`]).
//! - **Lights.** A light among the casters has a cube of up to six views, those in which the camera sees casters' shadows, which are
//!   recorded one after the other. All frames share the lists, whatever their number of views. A map whose texels are more than one
//!   binding holds is cut into parts, which are views of their own.
//! - **Large images.** Where a binding does not hold the facets of all pixels, the image is rendered in strips of rows, one after the
//!   other, with the same bits ([`PassConfig::strips`] asks for more of them, which takes less memory). Results are those of the whole
//!   image. The light maps are made once; with several views of the light, anew for each strip.
//! - **Overflow.** How long the lists must be is known only when a frame has run. A frame whose lists were too short lacks
//!   some shadows; its status says so, and the lists have grown by the next frame that is recorded after that is known. What
//!   the lists behind the one that overflowed will need is then a guess, so that rarely a third or fourth frame is the first
//!   whole one: each status says for itself whether its frame was complete. Lists of which more than seven eighths are needed grow
//!   before they overflow; with [`PassConfig::keep_last`] the last complete picture stands meanwhile.
//! - **Many small lights.** [`ShadowPass::record_light_lists`] lists by tiles of the image which lights reach it, and how visible they are.
//! - **Lights of some extent.** [`ShadowPass::record_area`] takes the mean over points of a light: soft shadows at the price of as many lights.
//! - **What stands is not made again.** While casters and light stand the light maps do, for any camera ([`PassConfig::keep_maps`]).
//! - **What a frame does not need.** Of casters that stand the pass proves, frame by frame, that none can be seen, or that none can shadow another,
//!   and leaves out what then changes nothing ([`PassConfig::prove`]).
//! - **Determinism.** Same inputs, same bits, in every frame that is complete, whatever the lengths of the lists.

mod background;
mod beside;
mod caster_upload;
mod casters;
mod checks;
mod depth_terms;
mod gbuffer;
mod gbuffer_stage;
mod held;
mod image_strips;
mod inputs;
pub(crate) mod judge;
mod kept_maps;
mod light_lists;
mod lights;
mod lit_masks;
mod mapped;
mod part_changes;
mod parts;
mod recording;
mod status;
mod textures;
mod views;

pub use crate::stages::caster_positions::Vertices;
pub use crate::stages::instance_positions::Transforms;
pub use background::Compiling;
pub use caster_upload::{CasterUpload, UploadedCasters};
pub use depth_terms::{DepthTerms, ImageTerms};
pub use gbuffer::{GBuffer, SampleTexture, SurfacePosition, SurfaceTextures, TriangleTexture};
pub use inputs::{
    CasterMesh, CasterPart, Casters, Inputs, LightReach, LightTarget, Moved, PartAt, PartKind, PartPlace, Placed,
    Target, TargetTexture,
};
pub use light_lists::{ListedTarget, light_list_bytes, light_lists_wgsl};
pub use lit_masks::lit_masks_wgsl;
pub use status::{Faults, FrameStatus};

pub use crate::gpu::BufferMemory;
use crate::gpu::{BindGroups, Buffer, Gpu, KeptPrograms, Ledger, Timer};
use crate::light_view::MapTiles;
use crate::methods::facet_masks::Capacities;
use crate::methods::list_sizing::{self, Together, Wanted};
use crate::methods::output::Budget;
use crate::methods::strip_method::{MethodPipelines, StripMethod};
pub use crate::methods::strips::Strips;
use crate::methods::{MethodName, Prepared, Settings};
use crate::stages::caster_positions::CasterPositions;
use crate::stages::visibility_texture::LastPicture;
use crate::{Error, Result};
use casters::CasterSet;
use checks::{check_moving, check_tested};
use gbuffer_stage::GbufferStage;
use held::HeldPicture;
use image_strips::{ImageStrips, NewStrips, Stores, StripMaker};
use kept_maps::KeptMaps;
use light_lists::PassLists;
pub(crate) use recording::{FramePart, Surfaces};
use status::{FAULT_WORDS, InFlight};
use std::collections::VecDeque;
use std::num::NonZeroU32;
use views::Views;

/// Configuration of a pass.
#[derive(Clone, Debug)]
pub struct PassConfig<'a> {
    /// The method. All but `facet-masks` need the feature `baselines`, and take one surface a pixel and no receivers that are no casters.
    pub method: MethodName,
    /// Image size, samples, map and facets. Not read are `cull_back` (casters of closed bodies that turn away from the light are
    /// left out wherever that changes nothing) and, but that they must be possible ([`Settings::check`]), the options of other methods.
    pub settings: Settings,
    /// The triangles.
    pub casters: Casters<'a>,
    /// How long the lists are at first, and how much those of pairs may take at most.
    pub budget: Budget,
    /// Let the lists grow by themselves; without it, [`ShadowPass::grow`] does.
    pub grow: bool,
    /// Make room for surfaces that receive shadows and cast none, which [`GBuffer::Surfaces`] needs: 72 bytes a pixel of a strip, with a facet for every
    /// surface 124, 48 of them behind the casters' positions in one binding.
    pub receivers: bool,
    /// Make room for lists of lights ([`ShadowPass::record_light_lists`], [`Target::listed`]): a byte a pixel and 8 a tile of 64, of any number of lights.
    pub light_lists: bool,
    /// About so many strips of rows in which the image is rendered, of as many rows each; more where the device's bindings do not hold
    /// those (down to [`Strips::LEAST`] rows). Of several, memory is that of one, and of the results.
    pub strips: u32,
    /// Show the last complete picture until there is another: a frame that is not [`complete`](FrameStatus::complete) changes neither its
    /// targets' picture from that of the last one that was, nor [`ShadowPass::visibility`] and [`ShadowPass::lit`]. Before the first all is
    /// lit. A fault, such as a texel that is no place, makes a frame incomplete. The GPU decides it by its counters; it takes the memory of a picture more, and a copy.
    pub keep_last: bool,
    /// Take the time of each stage, where the device has [`wgpu::Features::TIMESTAMP_QUERY`].
    pub timing: bool,
    /// Leave out what is proved to change nothing of a frame of casters that stand ([`Plan`](crate::plan::Plan)): all of it where no caster
    /// can be seen, all tests where none can shadow another. Of `facet-masks`.
    pub prove: bool,
    /// Keep the light maps while casters stand and the light's view of them does, whatever the camera: of `facet-masks`, with one view of the light (no
    /// slices or warps, which follow the camera), with the casters' places in it. A frame uses those of an earlier one that is known to have run.
    /// Visibility is the same to the bit, and with a facet for every surface all lit masks; maps made from another camera may settle
    /// other facets early, and with one facet a pixel the lit mask of such a one counts the samples beside it, too.
    pub keep_maps: bool,
    /// Pipelines that passes share: what another pass of the store has compiled is not compiled again. It may have a pipeline cache, and
    /// tell of its progress. `None`: the pass's own.
    pub programs: Option<&'a KeptPrograms>,
}

impl<'a> PassConfig<'a> {
    /// Default budget, lists that grow, no room for receivers that are no casters and for lists of lights, no more strips than it takes, no last picture, no times, proofs and light maps
    /// that are kept.
    pub fn new(settings: Settings, casters: Casters<'a>) -> Self {
        Self {
            method: MethodName::FacetMasks,
            settings,
            casters,
            budget: Budget::default(),
            grow: true,
            receivers: false,
            light_lists: false,
            strips: 1,
            keep_last: false,
            timing: false,
            prove: true,
            keep_maps: true,
            programs: None,
        }
    }
}

/// Shadows as a pass of an application's frame: see the [module](self).
pub struct ShadowPass {
    settings: Settings,
    ledger: Ledger,
    maker: StripMaker,
    grows: bool,
    proves: bool,
    gather: CasterPositions,
    seen: GbufferStage,
    store: Stores,
    casters: CasterSet,
    image: ImageStrips,
    last: Option<(LastPicture, HeldPicture)>,
    /// Sums of the visibility of points of a light, strip by strip.
    sums: Option<Buffer<f32>>,
    lists: Option<PassLists>,
    faults: Buffer<u32>,
    timer: Option<Timer>,
    in_flight: InFlight,
    known: VecDeque<FrameStatus>,
    /// Why the last frame that no list can hold is one.
    failure: Option<Error>,
    together: Together,
    wanted: Option<Wanted>,
    views: Views,
    keeps_maps: bool,
    kept_maps: KeptMaps,
    bind_groups: BindGroups,
    frame: u64,
    generation: u64,
}

impl ShadowPass {
    /// Statuses that are kept until they are asked for; beyond it the oldest is dropped.
    pub const KEPT: usize = 256;

    /// Features that a device must have: none.
    pub fn required_features() -> wgpu::Features {
        wgpu::Features::empty()
    }

    /// Features that are used where a device has them: time stamps, and atomic operations on 64 bits.
    pub fn optional_features() -> wgpu::Features {
        Gpu::optional_features()
    }

    /// Limits that a device must have: WebGPU's defaults. Large meshes need larger buffers and bindings, and so do the results of images of
    /// more than 64 million words of lit masks.
    pub fn required_limits() -> wgpu::Limits {
        wgpu::Limits::default()
    }

    /// Builds every pipeline, on all cores, and all memory, and uploads the casters. Nothing is submitted: uploads go with the
    /// application's next submission to `queue`. A pass may be made on one thread and used on another.
    ///
    /// # Errors
    /// [`Error::Config`] for impossible settings or a device below [`ShadowPass::required_limits`] in what the pass uses; [`Error::Mesh`] for
    /// casters that are no geometry; [`Error::Memory`] and [`Error::Gpu`] if memory does not suffice or the device refuses.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, config: &PassConfig) -> Result<Self> {
        check_moving(&config.casters, config.method)?;
        let casters = || CasterSet::new(device, queue, &config.casters, config.settings.least_culled);
        Self::with(device, queue, config, config.casters.are_tested(), casters)
    }

    /// A pass of casters that stand, with pipelines that exist already, the settings as they are and no proofs of its own: for frames that
    /// are read back. Its lists grow when [`ShadowPass::grow`] is called.
    pub(crate) fn of_prepared(
        gpu: &Gpu,
        prepared: &Prepared,
        settings: &Settings,
        pipelines: MethodPipelines,
        budget: Budget,
        strips: u32,
    ) -> Result<Self> {
        settings.check()?;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let none = Casters::Static { positions: &[], triangles: &[] };
        let config = PassConfig {
            budget,
            grow: false,
            strips,
            timing: true,
            prove: false,
            keep_maps: false,
            ..PassConfig::new(settings.clone(), none)
        };
        let ledger = Ledger::default();
        let made = ledger.within(|| {
            let casters = CasterSet::of_prepared(device, queue, prepared)?;
            Self::made(device, queue, settings.clone(), pipelines, casters, &config)
        })?;
        gpu.check()?;
        Ok(Self { ledger, ..made })
    }

    fn made(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        settings: Settings,
        pipelines: MethodPipelines,
        mut casters: CasterSet,
        config: &PassConfig,
    ) -> Result<Self> {
        check_tested(casters.are_tested(), &settings, pipelines.method())?;
        let settings = pipelines.method().with_whole_map(settings)?;
        let limits = device.limits();
        let parts = match pipelines.is_fixed() {
            true => MapTiles::new(settings.map, NonZeroU32::MIN),
            false => MapTiles::within(settings.map, &limits),
        };
        let maker = StripMaker {
            device: device.clone(),
            queue: queue.clone(),
            pipelines,
            parts,
            budget: config.budget,
            receivers: config.receivers,
            strips: config.strips,
        };
        let made = maker.make(&settings, &casters, maker.first_strips(&settings), None)?;
        casters.take(made.surfaces);
        let held =
            || Ok::<_, Error>((LastPicture::new(device), HeldPicture::new(device, queue, &settings, &made.image)?));
        Ok(Self {
            last: config.keep_last.then(held).transpose()?,
            sums: None,
            lists: config.light_lists.then(|| PassLists::new(device, queue, &settings)).transpose()?,
            seen: GbufferStage::new(device, &settings, made.keys)?,
            settings,
            ledger: Ledger::default(),
            maker,
            grows: config.grow,
            proves: config.prove,
            gather: CasterPositions::new(device),
            store: Stores::new(device),
            casters,
            image: made.image,
            faults: Buffer::storage(device, "shadow_pass.faults", FAULT_WORDS)?,
            timer: if config.timing { Timer::on(device, queue)? } else { None },
            in_flight: InFlight::default(),
            known: VecDeque::new(),
            failure: None,
            together: Together::default(),
            wanted: None,
            views: Views::default(),
            keeps_maps: config.keep_maps,
            kept_maps: KeptMaps::default(),
            bind_groups: BindGroups::default(),
            frame: 0,
            generation: 0,
        })
    }

    /// Takes other casters. Pipelines stay; memory is made anew, so frames that are recorded already are not touched.
    ///
    /// # Errors
    /// As [`ShadowPass::new`]; the pass is then as before.
    pub fn set_casters(&mut self, casters: &Casters) -> Result<()> {
        self.ledger.clone().within(|| {
            let set = self.caster_set(casters)?;
            self.rebuild(self.settings.clone(), Some(set), None)
        })
    }

    /// Takes another image size, pixels. As [`ShadowPass::set_casters`].
    ///
    /// # Errors
    /// As [`ShadowPass::new`]; the pass is then as before.
    pub fn set_size(&mut self, size: [u32; 2]) -> Result<()> {
        let settings = Settings { size, ..self.settings.clone() };
        settings.check()?;
        self.ledger.clone().within(|| self.rebuild(settings, None, None))
    }

    fn caster_set(&self, casters: &Casters) -> Result<CasterSet> {
        let method = self.maker.pipelines.method();
        check_moving(casters, method)?;
        check_tested(casters.are_tested(), &self.settings, method)?;
        CasterSet::new(&self.maker.device, &self.maker.queue, casters, self.settings.least_culled)
    }

    /// Makes memory anew; with `before`, lists as long, and as many strips.
    fn rebuild(&mut self, settings: Settings, casters: Option<CasterSet>, before: Option<Capacities>) -> Result<()> {
        let strips = before.map_or_else(|| self.maker.first_strips(&settings), |_| self.image.strips);
        let before = before.map(|capacities| (&self.image, capacities));
        let made = self.maker.make(&settings, casters.as_ref().unwrap_or(&self.casters), strips, before)?;
        if let Some((_, held)) = &mut self.last
            && settings.size != self.settings.size
        {
            *held = HeldPicture::new(&self.maker.device, &self.maker.queue, &settings, &made.image)?;
        }
        if let Some(lists) = &mut self.lists
            && settings.size != self.settings.size
        {
            lists.resize(&self.maker.device, settings.size)?;
        }
        self.settings = settings;
        if let Some(casters) = casters {
            self.casters = casters;
        }
        self.take(made);
        self.views = Views::default();
        Ok(())
    }

    /// Uses other memory from now on. What frames in flight will say of their lists no longer matters.
    fn take(&mut self, made: NewStrips) {
        self.bind_groups.forget();
        self.casters.take(made.surfaces);
        self.seen.take(made.keys);
        self.image = made.image;
        (self.together, self.wanted) = (Together::default(), None);
        self.kept_maps.forget();
        self.generation += 1;
    }

    /// Appends one frame to `encoder` and returns its number: 1 for the first. Frames run in the order of their submission;
    /// several may be recorded into one encoder, and each has its own camera, light and target.
    ///
    /// Apart from the growth of lists that overflowed, one small staging buffer is made for the frame, and bind groups of textures; counters
    /// are made anew where the light has more views than in any frame before.
    ///
    /// # Errors
    /// [`Error::Scene`] for a camera or light that cannot be used; [`Error::Config`] for textures
    /// and buffers of a wrong format, size or usage, and for inputs that do not go with the settings; [`Error::Memory`] and
    /// [`Error::Gpu`] if there is no memory for larger lists. Nothing is recorded then, but for memory that runs out in the middle of
    /// recording, for a buffer of some words: the encoder then holds a part of a frame that has no status, and is to be dropped. A later
    /// frame is as if there had been no error.
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, inputs: &Inputs, target: &Target) -> Result<u64> {
        let mapped = self.mapped(inputs, target)?;
        let extent = self.extent(&mapped.get());
        let part = FramePart { extent, strip: None, surfaces: Surfaces::Own, point: None };
        self.record_part(encoder, &mapped.get(), target, part)
    }

    /// How the oldest frame came out that the GPU is done with and that was not asked for yet; `None` if there is none. Does
    /// not wait: a frame is known some time after its submission has run, when the application has polled the device or
    /// submitted again. Frames that were recorded but never submitted have no status.
    pub fn status(&mut self) -> Option<FrameStatus> {
        self.collect();
        self.known.pop_front()
    }

    /// Recorded frames of which nothing is known yet.
    pub fn frames_in_flight(&self) -> usize {
        self.in_flight.len()
    }

    /// Lets the lists grow to what the frames known so far needed, with room for more where a list is nearly full, and returns whether
    /// they did. Frames recorded from now on use the larger lists. [`ShadowPass::record`] does this by itself unless [`PassConfig::grow`] is off.
    ///
    /// # Errors
    /// [`Error::Memory`] and [`Error::Gpu`] if there is no memory for them; the lists are then as before.
    pub fn grow(&mut self) -> Result<bool> {
        self.ledger.clone().within(|| self.grow_lists())
    }

    fn grow_lists(&mut self) -> Result<bool> {
        self.collect();
        let Some(Wanted { capacities: wanted, must }) = self.wanted.take() else { return Ok(false) };
        self.bind_groups.forget();
        let (device, queue, method) = (&self.maker.device, &self.maker.queue, &mut self.image.method);
        let wanted = Capacities { views: method.capacities().views, ..wanted };
        let Err(error) = method.resize(device, queue, wanted) else { return Ok(true) };
        if !must {
            self.together.cramp();
            return Ok(false);
        }
        // Another time there may be memory.
        let again = Some(Wanted { capacities: wanted, must });
        // Strips of fewer rows have shorter lists.
        let (Error::Memory { .. }, Some(more)) = (&error, self.image.strips.more()) else {
            self.wanted = again;
            return Err(error);
        };
        let made = self.maker.make(&self.settings, &self.casters, more, Some((&self.image, wanted)));
        match made {
            Ok(made) => self.take(made),
            Err(error) => {
                self.wanted = again;
                return Err(error);
            }
        }
        Ok(true)
    }

    /// The visibility of the last frame, an `f32` a pixel, row by row from the top; usage `STORAGE` and `COPY_SRC`. Another
    /// buffer after [`ShadowPass::set_size`] and [`ShadowPass::set_casters`].
    pub fn visibility(&self) -> &wgpu::Buffer {
        self.last.as_ref().map_or(self.image.visibility(), |(_, held)| &held.visibility).raw()
    }

    /// The lit samples of the last frame, as [`Target::lit`] describes them; else as [`ShadowPass::visibility`]. `None` where the method keeps none.
    pub fn lit(&self) -> Option<&wgpu::Buffer> {
        self.last.as_ref().map_or(self.image.lit(), |(_, held)| held.lit.as_ref()).map(Buffer::raw)
    }

    /// The method as the last strip left it.
    pub(crate) fn method(&self) -> &StripMethod {
        &self.image.method
    }

    /// How the light's map is cut.
    pub(crate) fn map_tiles(&self) -> MapTiles {
        self.maker.parts
    }

    /// How the image is cut.
    pub(crate) fn image_strips(&self) -> Strips {
        self.image.strips
    }

    /// Takes the error of the last frame that no list can hold.
    pub(crate) fn take_failure(&mut self) -> Option<Error> {
        self.failure.take()
    }

    /// Settings of the pass; the map of `deep` is that of its sub-texels.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// How long the lists are, those of one strip.
    pub fn capacities(&self) -> Capacities {
        self.image.method.capacities()
    }

    /// Every buffer that the pass holds, the largest first: casters, results, maps, lists, counters. Memory that it has given up, and that frames in
    /// flight may still use, is not among them, nor are pipelines.
    pub fn memory(&self) -> Vec<BufferMemory> {
        self.ledger.held()
    }

    /// Strips of rows in which the image is rendered, one after the other.
    pub fn strips(&self) -> u32 {
        self.image.strips.count()
    }
}
