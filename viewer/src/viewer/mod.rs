//! The application: panels, the picture, and what the pointer and the keys do.

mod compute;
mod input;
mod paint;
mod panels;
mod plans;

use crate::beside::{Opened, Opening, Rays};
use crate::control::Extent;
use crate::half::Gpu;
use crate::job::Job;
use crate::level::{Level, Moment};
use crate::overlay::Overlay;
use crate::picture::{DrawnMesh, Shader, Shot};
use crate::trouble::Trouble;
use crate::view::View;
use crate::{fonts, panel, read};
use egui::{Color32, Rect, TextureId, Ui};
use egui_wgpu::RenderState;
use lab::options::DEFAULT_SCENE;
use lab::scene::{Base, Files, Light, Scene, SceneOptions};
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use subpixel_shadows::gpu::KeptPrograms;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::pass::CasterUpload;
use subpixel_shadows::wgpu;

/// Seconds without a move after which the whole resolution is computed.
const REST: f64 = 0.25;
/// Seconds of a frame above which moves are shown at less resolution.
const SLOW: f64 = 0.1;
/// Seconds after which traced pixels are drawn.
const DRAWN: f64 = 0.2;
/// Bytes of casters that are uploaded between two pictures of the window.
const UPLOADED: u64 = 16 << 20;
/// Pixels on either side of the wipe that drag it.
const REACH: f32 = 8.0;
/// Width of a window, points, below which the panel is opened by hand.
const NARROW: f32 = 600.0;
/// Time after which the window looks at what is computed. A page is woken when there is something to see: to draw it waits until a software adapter
/// is done.
const LOOK: Duration = Duration::from_millis(if cfg!(target_family = "wasm") { 1000 } else { 20 });
/// Columns of the graph of frame times.
const HISTORY: usize = 60;

/// Target of a drag that has begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drag {
    Orbit,
    Pan,
    Light,
    Wipe,
}

/// The viewer.
pub struct Viewer {
    context: egui::Context,
    trouble: Trouble,
    gpu: Gpu,
    render: RenderState,
    shader: Shader,
    view: View,
    scene: Arc<Scene>,
    prepared: Arc<Prepared>,
    home: Moment,
    extent: Extent,
    upload: CasterUpload,
    mesh: DrawnMesh,
    moment: Moment,
    full: Option<Level>,
    rough: Option<Level>,
    of_rough: bool,
    texture: Option<TextureId>,
    drawn: Option<Shot>,
    untold: bool,
    told_at: f64,
    magnified: Option<f32>,
    divisor: u32,
    moved_at: f64,
    size_at: (f64, [u32; 2]),
    turns: bool,
    light_turns: bool,
    /// Whether a plain drag is of the light: touch has no keys.
    drags_light: bool,
    drag: Option<Drag>,
    opening: Option<(String, Job<Opening>)>,
    rays: Rays,
    history: VecDeque<f64>,
    message: Option<String>,
    panel: Option<bool>,
    help: bool,
    line: String,
    path: String,
    image: Rect,
    shots: u32,
    /// The folder of screenshots.
    screenshots: PathBuf,
    /// A message of something that ends beside the window.
    told: Arc<Mutex<Option<String>>>,
    /// Files that were dropped on a page.
    files: Files,
    #[cfg(target_family = "wasm")]
    saved: u32,
}

impl Viewer {
    /// A viewer of `view`, whose scene is opened already, in a window that has drawn nothing yet.
    ///
    /// # Errors
    /// For a mesh that cannot be prepared or uploaded.
    pub fn new(
        context: &egui::Context,
        render: &RenderState,
        view: View,
        opened: Opened,
    ) -> subpixel_shadows::Result<Self> {
        let Opened { scene, prepared, note: message, rays } = opened;
        context.set_fonts(fonts());
        let gpu = Gpu {
            device: render.device.clone(),
            queue: render.queue.clone(),
            programs: KeptPrograms::default(),
            context: context.clone(),
        };
        let shader = Shader::new(&gpu.device);
        let upload = CasterUpload::new(&gpu.device, &gpu.queue, prepared.clone())?;
        let mesh = DrawnMesh::new(&gpu.device, &shader, upload.casters());
        let home = Moment { camera: scene.camera, light: scene.light };
        Ok(Self {
            context: context.clone(),
            trouble: Trouble::of(&gpu.device, context),
            extent: Extent::of(&prepared),
            gpu,
            render: render.clone(),
            shader,
            view,
            scene,
            prepared,
            home,
            upload,
            mesh,
            moment: home,
            full: None,
            rough: None,
            of_rough: false,
            texture: None,
            drawn: None,
            untold: false,
            told_at: f64::NEG_INFINITY,
            magnified: None,
            divisor: 1,
            moved_at: f64::NEG_INFINITY,
            size_at: (f64::NEG_INFINITY, [0; 2]),
            turns: false,
            light_turns: false,
            drags_light: false,
            drag: None,
            opening: None,
            rays,
            history: VecDeque::new(),
            message,
            panel: None,
            help: false,
            line: String::new(),
            path: String::new(),
            image: Rect::NOTHING,
            shots: 0,
            screenshots: PathBuf::new(),
            told: Arc::default(),
            files: Files::default(),
            #[cfg(target_family = "wasm")]
            saved: 0,
        })
    }

    /// Whether nothing is computed, and the picture is of what is looked at, or there is none.
    pub fn is_settled(&self) -> bool {
        let settled = |level: &Level| {
            let whole = level.is_of(&self.moment) && !level.is_busy() && !self.of_rough;
            level.picture.size == self.size_at.1 && (whole || level.has_failed(&self.moment))
        };
        if self.lost().is_some() {
            return true;
        }
        self.opening.is_none() && self.full.as_ref().is_some_and(settled)
    }

    /// Halves that the picture shows, from the left: the left one alone where the right one's pass is still made.
    pub fn halves_shown(&self) -> usize {
        self.full.as_ref().map_or(0, |level| level.halves_shown)
    }

    /// The last error or note, as the window tells it.
    pub fn complaint(&self) -> Option<String> {
        let of_half = |level: &Level| level.halves.iter().find_map(|half| half.error.clone());
        self.lost().or_else(|| self.message.clone()).or_else(|| self.full.as_ref().and_then(of_half))
    }

    /// Why nothing can be drawn any more, where the device is gone.
    pub fn lost(&self) -> Option<String> {
        self.trouble.lost()
    }

    /// The view.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The scene, with the camera and the light of now; on a page without its mesh.
    pub fn scene_now(&self) -> Scene {
        Scene { camera: self.moment.camera, light: self.moment.light, ..(*self.scene).clone() }
    }

    /// The arguments that open what is looked at.
    pub fn command_line(&self) -> String {
        let Scene { name, ground, .. } = &*self.scene;
        let Moment { camera, light } = self.moment;
        let scene = Scene {
            name: name.clone(),
            base: Base::Mesh(name.clone()),
            mesh: Default::default(),
            alpha: Default::default(),
            camera,
            light,
            ground: *ground,
        };
        self.view.line(&scene)
    }

    /// Where the picture lies in the window, points.
    pub fn image(&self) -> Rect {
        self.image
    }

    /// The colours of the whole resolution, for those who read them back.
    pub fn colours(&self) -> Option<&wgpu::Texture> {
        self.full.as_ref().map(|level| &level.picture.colour)
    }

    /// Visibility of a half of the whole resolution: 0 the left one, 1 the right one.
    pub fn visibility(&self, half: usize) -> Option<&wgpu::Texture> {
        let level = self.full.as_ref()?;
        match (&level.tracing, half) {
            (Some(tracing), 1) => Some(&tracing.shown),
            _ => level.halves.get(half).map(|half| &half.shown),
        }
    }

    /// Counts of a half of the whole resolution, where an overlay shows some.
    pub fn counts(&self, half: usize) -> Option<&wgpu::Buffer> {
        self.full.as_ref()?.halves.get(half)?.as_shown().counts
    }

    /// [`Viewer::visibility`], read back with its width and height before it, row by row from the top.
    pub fn read_visibility(&self, half: usize) -> Option<impl Future<Output = Result<Vec<f32>, String>> + use<>> {
        let texture = self.visibility(half)?;
        let size = [texture.width() as f32, texture.height() as f32];
        let read = read::texture((&self.gpu.device, &self.gpu.queue), texture);
        Some(async move { Ok(size.into_iter().chain(bytemuck::pod_collect_to_vec(&read.await?)).collect()) })
    }

    /// Where a widget lies in the window, by its label ("left.samples"; "left.samples.8" in an open list), or the "picture"; points.
    pub fn place(&self, name: &str) -> Option<Rect> {
        if name == "picture" { Some(self.image) } else { panel::place(&self.context, name) }
    }

    /// Looks under another light, of numbers; of one that no pass takes it is told why.
    pub fn set_light(&mut self, light: Light) {
        self.moment.light = light;
    }

    /// Writes screenshots into another folder than the one the program runs in.
    pub fn keep_screenshots_in(&mut self, folder: impl Into<PathBuf>) {
        self.screenshots = folder.into();
    }

    /// Shows another quantity.
    pub fn set_overlay(&mut self, overlay: Overlay) {
        self.view.overlay = overlay;
    }

    /// Opens a built-in scene or a file beside the window; what is shown stays until it is there.
    pub fn open(&mut self, name: &str) {
        self.begin(name.to_owned(), SceneOptions { ground: self.view.left.ground, ..SceneOptions::default() });
    }

    fn begin(&mut self, name: String, options: SceneOptions) {
        let job = Opened::begin(&self.context, &name, &options, &self.files);
        self.opening = Some((name, job));
        self.message = None;
    }

    /// Takes another view, of the same window.
    ///
    /// # Errors
    /// As [`View::of_line`]; the view is then as before.
    pub fn take_line(&mut self, line: &str) -> subpixel_shadows::Result<()> {
        let view = View::of_line(line)?;
        let options = view.left.of_scene()?;
        let spec = view.scene.clone().unwrap_or_else(|| DEFAULT_SCENE.to_owned());
        self.view = view;
        self.begin(spec, options);
        self.forget_levels();
        Ok(())
    }

    fn take_opened(&mut self) {
        let Some((name, job)) = &self.opening else { return };
        let Some(opened) = job.take() else { return };
        let Gpu { device, queue, .. } = &self.gpu;
        let upload = |prepared: &Arc<Prepared>| CasterUpload::new(device, queue, prepared.clone());
        let opened = opened.and_then(|opened| Ok((upload(&opened.prepared).map_err(|e| e.to_string())?, opened)));
        match opened {
            Ok((upload, Opened { scene, prepared, note, rays })) => {
                self.view.scene = Some(name.clone());
                self.home = Moment { camera: scene.camera, light: scene.light };
                self.moment = self.home;
                self.extent = Extent::of(&prepared);
                self.mesh = DrawnMesh::new(device, &self.shader, upload.casters());
                self.upload = upload;
                self.prepared = prepared;
                self.scene = scene;
                self.rays = rays;
                self.message = note;
                self.forget_levels();
            }
            Err(error) => self.message = Some(error),
        }
        self.opening = None;
    }

    fn forget_levels(&mut self) {
        self.full = None;
        self.rough = None;
        self.of_rough = false;
        self.drawn = None;
        self.history.clear();
    }

    /// The window.
    pub fn show(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        let now = context.input(|input| input.time);
        if let Some(error) = self.trouble.take_error() {
            self.message = Some(error);
        }
        if let Some(told) = self.told.lock().ok().and_then(|mut told| told.take()) {
            self.message = Some(told);
        }
        self.take_opened();
        self.take_dropped(&context);
        if !context.egui_wants_keyboard_input() {
            self.take_keys(&context, now);
        }
        // A phone shows the picture first, and its options above it.
        let [width, height] = context.content_rect().size().into();
        let narrow = width < NARROW;
        if *self.panel.get_or_insert(!narrow) {
            let side = if narrow { egui::Panel::top("options above") } else { egui::Panel::left("options") };
            side.default_size(if narrow { 0.45 * height } else { 250.0 }).show(ui, |ui| {
                egui::ScrollArea::vertical().show(ui, |ui| self.options(ui));
            });
        }
        egui::Panel::bottom("line").show(ui, |ui| self.bottom(ui));
        let none = egui::Frame::NONE.fill(Color32::from_gray(20));
        egui::CentralPanel::default().frame(none).show(ui, |ui| self.central(ui, now));
        self.help(&context);
        self.tell(&context);
        let busy = |level: &Option<Level>| level.as_ref().is_some_and(Level::is_busy);
        if self.turns || self.light_turns {
            context.request_repaint();
        } else if !self.is_settled() || busy(&self.rough) {
            context.request_repaint_after(LOOK);
        }
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }

    #[cfg(target_family = "wasm")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}
