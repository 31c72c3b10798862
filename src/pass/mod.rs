//! [`ShadowPass`]: `facet-masks` as a deferred-shadowing pass inside an application's own frame, with its device, queue,
//! encoder, G-buffer and vertex buffers.
//!
//! - [`ShadowPass::new`] builds every pipeline and all memory. [`ShadowPass::record`] appends a frame to the application's
//!   encoder: it never submits, waits or reads back. [`ShadowPass::status`] says afterwards how each frame came out.
//! - **Surfaces seen.** Without a G-buffer the pass finds them among the casters. With a texture of triangle numbers
//!   ([`GBuffer::TriangleIds`]) the stage `camera_visibility` is left out. Both give the same bits for the same triangles.
//!   With depths or positions ([`GBuffer::Surfaces`]), normals and triangle numbers if there are any, a pixel may also show what is
//!   no caster, such as a terrain that only receives: it gets a plane of its own. With triangle numbers of several samples a
//!   pixel ([`GBuffer::SampleIds`]) the search for every surface is left out.
//! - **Error.** With [`FacetMode::One`] the surface at the centre stands for the whole pixel, found or given: pixels that show
//!   several surfaces differ from scene truth: 0.4 to 14 % of all pixels of the scenes in `data/reports/truth.md` by more than one
//!   sample of 32.
//!   [`FacetMode::All`] has none of that error; it needs every surface of a pixel, so it takes no G-buffer of one sample, and of
//!   one with several it misses what none of them shows: `data/reports/gbuffer.md` has figures.
//! - **Receivers.** What is no caster may lie anywhere, also outside the casters' box and behind the light. The light view is then
//!   fitted to all casters, as each may shadow something.
//! - **Lights.** A light among the casters has a cube of up to six views, which are recorded one after the other; of casters that
//!   move it has six. A frame with another number of views than the one before has lists made anew. A map whose texels are more than one
//!   binding holds is cut into parts, which are views of their own.
//! - **Overflow.** How long the lists must be is known only when a frame has run. A frame whose lists were too short lacks
//!   some shadows; its status says so, and the lists have grown by the next frame that is recorded after that is known. What
//!   the lists behind the one that overflowed will need is then a guess, so that rarely a third or fourth frame is the first
//!   whole one: each status says for itself whether its frame was complete.
//! - **Determinism.** Same inputs, same bits, in every frame that is complete, whatever the lengths of the lists.

mod casters;
mod gbuffer;
mod inputs;
mod seen;
mod status;
mod textures;
mod views;

pub use crate::stages::caster_positions::Vertices;
pub use gbuffer::{DepthTerms, GBuffer, Place, SampleTexture, SurfaceTextures, TriangleTexture};
pub use inputs::{Casters, Inputs, Moved, Target};
pub use status::{Faults, FrameStatus};

use crate::frame::Frame;
use crate::gpu::{Buffer, Gpu, Recorder, Timer};
use crate::light_view::Parts;
use crate::methods::facet_masks::{Capacities, FacetMasks, Pipelines, Strip};
use crate::methods::prepared::surfaces;
use crate::methods::render::{Budget, Counts};
use crate::methods::{FacetMode, Settings, growth};
use crate::stages::caster_positions::CasterPositions;
use crate::stages::visibility_texture::VisibilityTexture;
use crate::{Error, Result};
use casters::{CasterSet, checked_mesh};
use futures::executor::block_on;
use glam::{DVec3, Vec3};
use seen::Seen;
use status::{FAULT_WORDS, Finished, InFlight, Label};
use std::collections::VecDeque;
use std::sync::Arc;
use views::Views;

/// What a pass is made for.
#[derive(Clone, Debug)]
pub struct PassConfig<'a> {
    /// Image size, samples, map and facets. `cull_back` and the options of other methods are not looked at.
    pub settings: Settings,
    /// The triangles.
    pub casters: Casters<'a>,
    /// How long the lists are at first, and at most.
    pub budget: Budget,
    /// Let the lists grow by themselves; without it, [`ShadowPass::grow`] does.
    pub grow: bool,
    /// Make room for surfaces that receive shadows and cast none, which [`GBuffer::Surfaces`] needs: 52 bytes a pixel, 36 of
    /// them behind the casters' positions in one binding.
    pub receivers: bool,
    /// Take the time of each stage, where the device has [`wgpu::Features::TIMESTAMP_QUERY`].
    pub timing: bool,
}

impl<'a> PassConfig<'a> {
    /// Default budget, lists that grow, no room for receivers that are no casters, no times.
    pub fn new(settings: Settings, casters: Casters<'a>) -> Self {
        Self { settings, casters, budget: Budget::default(), grow: true, receivers: false, timing: false }
    }
}

/// Shadows as a pass of an application's frame: see the [module](self).
pub struct ShadowPass {
    device: wgpu::Device,
    queue: wgpu::Queue,
    settings: Settings,
    budget: Budget,
    grows: bool,
    pipelines: Arc<Pipelines>,
    gather: CasterPositions,
    seen: Seen,
    receivers: bool,
    store: VisibilityTexture,
    casters: CasterSet,
    method: FacetMasks,
    faults: Buffer<u32>,
    timer: Option<Timer>,
    in_flight: InFlight,
    known: VecDeque<FrameStatus>,
    wanted: Option<Capacities>,
    views: Views,
    parts: Parts,
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

    /// Limits that a device must have: WebGPU's defaults. Large images and meshes need larger buffers and bindings.
    pub fn required_limits() -> wgpu::Limits {
        wgpu::Limits::default()
    }

    /// Builds every pipeline and all memory, and uploads the casters. Nothing is submitted: uploads go with the
    /// application's next submission to `queue`.
    ///
    /// # Errors
    /// [`Error::Config`] for impossible settings or a device below [`ShadowPass::required_limits`]; [`Error::Mesh`] for
    /// casters that are no geometry; [`Error::Memory`] and [`Error::Gpu`] if memory does not suffice or the device refuses.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, config: &PassConfig) -> Result<Self> {
        check_limits(&device.limits())?;
        let settings = settled(&config.settings);
        settings.check()?;
        let mesh = checked_mesh(&config.casters)?;
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = (|| {
            let build = if config.receivers { Pipelines::with_receivers } else { Pipelines::new };
            let (pipelines, pixels) = (Arc::new(build(device, &settings)), settings.pixels());
            let casters = CasterSet::new(device, queue, &config.casters, mesh, room(config.receivers, &settings))?;
            let parts = Parts::within(settings.map, &device.limits());
            let of_part = settings.of_part(parts);
            let first = growth::first_for(&of_part, config.budget, casters.buffers.triangles.len());
            let method = FacetMasks::new(device, queue, pipelines.clone(), &casters.buffers, &of_part, first)?;
            let seen = Seen::new(device, &settings, config.receivers.then_some(pixels))?;
            Ok(Self {
                device: device.clone(),
                queue: queue.clone(),
                settings,
                budget: config.budget,
                grows: config.grow,
                pipelines,
                gather: CasterPositions::new(device),
                seen,
                receivers: config.receivers,
                store: VisibilityTexture::new(device),
                casters,
                method,
                faults: Buffer::storage(device, "shadow_pass.faults", FAULT_WORDS)?,
                timer: if config.timing { Timer::on(device, queue) } else { None },
                in_flight: InFlight::default(),
                known: VecDeque::new(),
                wanted: None,
                views: Views::default(),
                parts,
                frame: 0,
                generation: 0,
            })
        })();
        match block_on(scope.pop()) {
            Some(error) => Err(Error::Gpu(error.to_string().replace('\n', " "))),
            None => made,
        }
    }

    /// Takes other casters. Pipelines stay; memory is made anew, so frames that are recorded already are not touched.
    ///
    /// # Errors
    /// As [`ShadowPass::new`]; the pass is then as before.
    pub fn set_casters(&mut self, casters: &Casters) -> Result<()> {
        let set = self.caster_set(casters)?;
        self.rebuild(self.settings.clone(), Some(set))
    }

    /// Takes another image size, pixels. As [`ShadowPass::set_casters`].
    ///
    /// # Errors
    /// As [`ShadowPass::new`]; the pass is then as before.
    pub fn set_size(&mut self, size: [u32; 2]) -> Result<()> {
        let settings = Settings { size, ..self.settings.clone() };
        settings.check()?;
        self.rebuild(settings, None)
    }

    fn caster_set(&self, casters: &Casters) -> Result<CasterSet> {
        let room = room(self.receivers, &self.settings);
        CasterSet::new(&self.device, &self.queue, casters, checked_mesh(casters)?, room)
    }

    fn rebuild(&mut self, settings: Settings, casters: Option<CasterSet>) -> Result<()> {
        let buffers = casters.as_ref().map_or(&self.casters.buffers, |c| &c.buffers);
        let of_part = settings.of_part(self.parts);
        let first = growth::first_for(&of_part, self.budget, buffers.triangles.len());
        let pipelines = self.pipelines.clone();
        let resized = settings.size != self.settings.size && self.receivers;
        let (device, queue) = (&self.device, &self.queue);
        let keys = self.seen.resized(device, settings.pixels())?;
        let mesh = &self.casters.mesh;
        let moved = resized.then(|| surfaces(device, queue, mesh, settings.pixels())).transpose()?;
        self.method = FacetMasks::new(&self.device, &self.queue, pipelines, buffers, &of_part, first)?;
        self.settings = settings;
        self.seen.take(keys);
        if let Some(surfaces) = moved {
            (self.casters.buffers.positions, self.casters.buffers.triangles) = surfaces;
        }
        if let Some(casters) = casters {
            self.casters = casters;
        }
        (self.wanted, self.views) = (None, Views::default());
        self.generation += 1;
        Ok(())
    }

    /// Appends one frame to `encoder` and returns its number: 1 for the first. Frames run in the order of their submission;
    /// several may be recorded into one encoder, and each has its own camera, light and target.
    ///
    /// Apart from the growth of lists that overflowed, one small staging buffer is made for the frame, and bind groups.
    ///
    /// # Errors
    /// [`Error::Scene`] for a camera or light that cannot be used; [`Error::Config`] for textures
    /// and buffers of a wrong format, size or usage, and for inputs that do not go with the settings; [`Error::Memory`] and
    /// [`Error::Gpu`] if there is no memory for larger lists. Nothing is recorded then.
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, inputs: &Inputs, target: &Target) -> Result<u64> {
        inputs.camera.check()?;
        inputs.light.check()?;
        target.check(self.settings.size, self.method.lit().len() as u64 * 4)?;
        self.check_gbuffer(&inputs.gbuffer)?;
        let bounds = self.check_moved(inputs.moved.as_ref())?;
        let views = self.parts.of(self.views.of(inputs, &self.casters, &self.settings, bounds)?);
        if self.grows {
            self.grow()?;
        }
        self.make_room_for(views.len() as u32)?;
        let mut frames = {
            let strip = Strip::whole(self.settings.size);
            self.method.frames_for(&self.casters.buffers, inputs.camera, inputs.light, &views, bounds, strip)?
        };
        if matches!(inputs.gbuffer, GBuffer::SampleIds(_)) {
            frames.iter_mut().for_each(|frame| frame.flags |= Frame::BEYOND);
        }
        encoder.push_debug_group("shadow_pass");
        let recorded = self.record_checked(encoder, inputs, target, &frames);
        encoder.pop_debug_group();
        recorded?;
        self.frame += 1;
        let label = Label { frame: self.frame, generation: self.generation, capacities: self.method.capacities() };
        let (status, timer) = (self.method.status(), self.timer.as_ref());
        self.in_flight.push(&self.device, encoder, label, status, &self.faults, timer);
        Ok(self.frame)
    }

    fn record_checked(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        target: &Target,
        frames: &[Frame],
    ) -> Result<()> {
        // Written by the encoder and not by the queue: a second frame of the same submission must not change the first.
        let staged = self.stage(frames);
        for (k, buffer) in self.method.frames().iter().enumerate().take(frames.len()) {
            let size = size_of::<Frame>() as u64;
            encoder.copy_buffer_to_buffer(&staged, k as u64 * size, buffer.raw(), 0, size);
        }
        if let Some(timer) = &mut self.timer {
            timer.reset();
        }
        let (method, casters, faults) = (&self.method, &self.casters, &self.faults);
        let rec = &mut Recorder::new(&self.device, encoder, self.timer.as_mut());
        rec.clear(faults.raw());
        if let (Some(moved), Some(places)) = (&inputs.moved, &casters.places) {
            let stage = &mut rec.stage("caster_positions");
            self.gather.record(stage, moved.vertices, places, moved.bounds, &casters.buffers.positions, faults)?;
        }
        self.seen.record(rec, &inputs.gbuffer, self.settings.samples.offsets(), method, casters, faults)?;
        if let Some(texture) = target.visibility {
            let view = textures::first_level(texture);
            let frame = method.frames()[0].raw();
            self.store.record(&mut rec.stage("visibility_texture"), frame, method.visibility(), &view)?;
        }
        if let Some(lit) = target.lit {
            rec.copy(method.lit().raw(), lit, method.lit().len() as u64 * 4);
        }
        Ok(())
    }

    /// A buffer that holds `frames`.
    fn stage(&self, frames: &[Frame]) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(frames);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow_pass.frames"),
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: true,
        });
        if let Ok(mut view) = buffer.get_mapped_range_mut(..) {
            view.copy_from_slice(bytes);
        }
        buffer.unmap();
        buffer
    }

    fn check_gbuffer(&self, gbuffer: &GBuffer) -> Result<()> {
        let refuse = |text: &str| Err(Error::Config(text.to_owned()));
        let size = self.settings.size;
        match gbuffer {
            GBuffer::None => Ok(()),
            GBuffer::SampleIds(_) if self.settings.facets == FacetMode::One => refuse(
                "a G-buffer of several samples shows several surfaces a pixel; they need a facet for every surface",
            ),
            GBuffer::SampleIds(given) => given.check(size, self.settings.samples.offsets()),
            _ if self.settings.facets == FacetMode::All => refuse(
                "a G-buffer of one sample shows one surface a pixel; with a facet for every surface the pass finds them",
            ),
            GBuffer::TriangleIds(given) => given.check(size),
            GBuffer::Surfaces(_) if !self.receivers => {
                refuse("surfaces in a G-buffer need a pass that was made with room for receivers")
            }
            GBuffer::Surfaces(given) => given.check(size),
        }
    }

    /// The box of the casters.
    fn check_moved(&self, moved: Option<&Moved>) -> Result<(DVec3, DVec3)> {
        match (&self.casters.places, moved) {
            (None, None) => Ok(self.casters.mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE))),
            (Some(places), Some(moved)) => {
                let [low, high] = moved.bounds;
                if !(0..3).all(|k| low[k].is_finite() && high[k].is_finite() && low[k] <= high[k]) {
                    return Err(Error::Config(format!("moved casters: no box from {low:?} to {high:?}")));
                }
                moved.vertices.check(places.len(), &self.device.limits())?;
                Ok((Vec3::from(low).as_dvec3(), Vec3::from(high).as_dvec3()))
            }
            (None, Some(_)) => Err(Error::Config("static casters: they are not moved by a vertex buffer".to_owned())),
            (Some(_), None) => Err(Error::Config("moving casters: the frame has no vertex buffer".to_owned())),
        }
    }

    /// Makes the lists anew if the frame has another number of views than the one before.
    fn make_room_for(&mut self, views: u32) -> Result<()> {
        let now = self.method.capacities();
        if now.views == views {
            return Ok(());
        }
        self.method.resize(&self.device, &self.queue, Capacities { views, ..now })
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

    /// Lets the lists grow to what the frames known so far needed, and returns whether they did. Frames recorded from now on
    /// use the larger lists. [`ShadowPass::record`] does this by itself unless [`PassConfig::grow`] is off.
    ///
    /// # Errors
    /// [`Error::Memory`] and [`Error::Gpu`] if there is no memory for them; the lists are then as before.
    pub fn grow(&mut self) -> Result<bool> {
        self.collect();
        let Some(wanted) = self.wanted.take() else { return Ok(false) };
        let now = self.method.capacities();
        let grown = self.method.resize(&self.device, &self.queue, wanted);
        if grown.is_err() {
            // What grew before there was no more memory shrinks again.
            self.method.resize(&self.device, &self.queue, now)?;
        }
        grown.map(|()| true)
    }

    /// Takes in what is known by now.
    fn collect(&mut self) {
        for finished in self.in_flight.finished(self.timer.as_ref()) {
            let status = self.judge(finished);
            if self.known.len() == Self::KEPT {
                self.known.pop_front();
            }
            self.known.push_back(status);
        }
    }

    fn judge(&mut self, finished: Finished) -> FrameStatus {
        let Finished { frame, generation, capacities, read } = finished;
        let mut status = FrameStatus {
            frame,
            complete: false,
            overflowed: false,
            faults: Faults::default(),
            error: None,
            counts: Counts::default(),
            lists: Vec::new(),
            stages: Vec::new(),
        };
        let (words, faults, stages) = match read {
            Ok(read) => read,
            Err(error) => {
                status.error = Some(error.to_string());
                return status;
            }
        };
        let (facets, limits) = (self.settings.facets, self.device.limits());
        (status.faults, status.stages) = (faults, stages);
        status.counts = growth::counts(&words, capacities);
        status.lists = growth::lists(&words, capacities, facets, 1);
        match growth::wanted(&words, capacities, &self.settings, &limits, self.budget.bytes) {
            Ok(None) => status.complete = faults == Faults::default(),
            Ok(Some(wanted)) => {
                status.overflowed = true;
                // A frame with other lists than those in use says nothing of these.
                if generation == self.generation && capacities == self.method.capacities() {
                    let ahead = growth::ahead(&words, capacities, wanted, &self.settings, &limits, self.budget.bytes);
                    self.wanted = Some(self.wanted.map_or(ahead, |other| growth::larger(other, ahead)));
                }
            }
            Err(error) => (status.overflowed, status.error) = (true, Some(error.to_string())),
        }
        status
    }

    /// The visibility of the last frame, an `f32` a pixel, row by row from the top; usage `STORAGE` and `COPY_SRC`. Another
    /// buffer after [`ShadowPass::set_size`] and [`ShadowPass::set_casters`].
    pub fn visibility(&self) -> &wgpu::Buffer {
        self.method.visibility().raw()
    }

    /// The lit samples of the last frame, as [`Target::lit`] describes them; else as [`ShadowPass::visibility`].
    pub fn lit(&self) -> &wgpu::Buffer {
        self.method.lit().raw()
    }

    /// What the pass computes with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// How long the lists are.
    pub fn capacities(&self) -> Capacities {
        self.method.capacities()
    }
}

/// The settings as the pass can use them for any camera and light: no caster is left out, and without validity masks no facet
/// is settled (see [`crate::plan`]).
fn settled(wanted: &Settings) -> Settings {
    let proved = wanted.validity || wanted.samples.count() == 1 || wanted.facets == FacetMode::All;
    Settings { cull_back: false, settle: wanted.settle && proved, ..wanted.clone() }
}

/// Triangles of surfaces that are no casters.
fn room(receivers: bool, settings: &Settings) -> usize {
    if receivers { settings.pixels() } else { 0 }
}

fn check_limits(have: &wgpu::Limits) -> Result<()> {
    let need = ShadowPass::required_limits();
    let pairs = [
        (
            "storage buffers a stage",
            need.max_storage_buffers_per_shader_stage,
            have.max_storage_buffers_per_shader_stage,
        ),
        ("storage textures a stage", 1, have.max_storage_textures_per_shader_stage),
        ("sampled textures a stage", 3, have.max_sampled_textures_per_shader_stage),
        (
            "invocations a workgroup",
            need.max_compute_invocations_per_workgroup,
            have.max_compute_invocations_per_workgroup,
        ),
        ("invocations along a workgroup", need.max_compute_workgroup_size_x, have.max_compute_workgroup_size_x),
        ("bytes of workgroup memory", need.max_compute_workgroup_storage_size, have.max_compute_workgroup_storage_size),
    ];
    match pairs.into_iter().find(|(_, need, have)| have < need) {
        Some((what, need, have)) => Err(Error::Config(format!("the device allows {have} {what}, {need} are needed"))),
        None => Ok(()),
    }
}
