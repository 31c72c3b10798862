//! The application: panels, the picture, and what the pointer and the keys do.

use crate::control::{Extent, fly, orbit, pan, turn_light, zoom};
use crate::half::Gpu;
use crate::job::Job;
use crate::level::{Level, Moment};
use crate::panel;
use crate::picture::{DrawnMesh, Overlay, Shader, Shot};
use crate::truth;
use crate::view::{Against, View, plain};
use egui::{Color32, Key, Pos2, Rect, Sense, TextureId, Ui, pos2, vec2};
use egui_wgpu::RenderState;
use glam::Vec3;
use lab::scene::{BUILTIN_NAMES, Scene, SceneOptions, scene_file};
use oracle::truth::Tracer;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use subpixel_shadows::gpu::KeptPrograms;
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::{Result, wgpu};

/// Seconds without a move after which the whole resolution is computed.
const REST: f64 = 0.25;
/// Seconds of a frame above which moves are shown at less resolution.
const SLOW: f64 = 0.1;
/// Pixels on either side of the wipe that drag it.
const REACH: f32 = 8.0;
/// Columns of the graph of frame times.
const HISTORY: usize = 60;

type Opened = Result<(Scene, Option<String>)>;

/// What a drag that has begun moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Drag {
    Orbit,
    Pan,
    Light,
    Wipe,
}

/// The viewer.
pub struct Viewer {
    gpu: Gpu,
    render: RenderState,
    shader: Shader,
    view: View,
    scene: Arc<Scene>,
    home: Moment,
    extent: Extent,
    mesh: DrawnMesh,
    moment: Moment,
    full: Option<Level>,
    rough: Option<Level>,
    of_rough: bool,
    texture: Option<TextureId>,
    drawn: Option<Shot>,
    overlay: Overlay,
    magnified: Option<f32>,
    divisor: u32,
    moved_at: f64,
    size_at: (f64, [u32; 2]),
    turns: bool,
    light_turns: bool,
    drag: Option<Drag>,
    opening: Option<(String, Job<Opened>)>,
    tracer: Option<Arc<Tracer>>,
    tracing: Option<Job<Result<Arc<Tracer>>>>,
    history: VecDeque<f64>,
    message: Option<String>,
    panel: bool,
    help: bool,
    line: String,
    path: String,
    image: Rect,
    shots: u32,
}

impl Viewer {
    /// A viewer of `view`, whose scene is opened already.
    pub fn new(render: &RenderState, view: View, scene: Scene) -> Self {
        let gpu = Gpu { device: render.device.clone(), queue: render.queue.clone(), programs: KeptPrograms::default() };
        let shader = Shader::new(&gpu.device);
        let mesh = DrawnMesh::new(&gpu.device, &shader, &scene.mesh);
        let home = Moment { camera: scene.camera, light: scene.light };
        Self {
            extent: Extent::of(&scene.mesh),
            gpu,
            render: render.clone(),
            shader,
            view,
            scene: Arc::new(scene),
            home,
            mesh,
            moment: home,
            full: None,
            rough: None,
            of_rough: false,
            texture: None,
            drawn: None,
            overlay: Overlay::default(),
            magnified: None,
            divisor: 1,
            moved_at: f64::NEG_INFINITY,
            size_at: (f64::NEG_INFINITY, [0; 2]),
            turns: false,
            light_turns: false,
            drag: None,
            opening: None,
            tracer: None,
            tracing: None,
            history: VecDeque::new(),
            message: None,
            panel: true,
            help: false,
            line: String::new(),
            path: String::new(),
            image: Rect::NOTHING,
            shots: 0,
        }
    }

    /// Whether nothing is computed, and the picture is of what is looked at, or there is none.
    pub fn is_settled(&self) -> bool {
        let of_full =
            |level: &Level| !level.is_busy() && (level.is_of(&self.moment) || failed(level)) && !self.of_rough;
        self.opening.is_none() && self.tracing.is_none() && self.full.as_ref().is_some_and(of_full)
    }

    /// What went wrong last, as the window tells it.
    pub fn complaint(&self) -> Option<String> {
        let of_half = |level: &Level| level.halves.iter().find_map(|half| half.error.clone());
        self.message.clone().or_else(|| self.full.as_ref().and_then(of_half))
    }

    /// What is looked at.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The scene, with the camera and the light of now.
    pub fn scene_now(&self) -> Scene {
        Scene { camera: self.moment.camera, light: self.moment.light, ..(*self.scene).clone() }
    }

    /// The arguments that open what is looked at.
    pub fn command_line(&self) -> String {
        let Scene { name, ground, .. } = &*self.scene;
        let Moment { camera, light } = self.moment;
        let scene = Scene { name: name.clone(), mesh: Default::default(), camera, light, ground: *ground };
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

    /// Opens a built-in scene or a file beside the window; what is shown stays until it is there.
    pub fn open(&mut self, context: &egui::Context, name: &str) {
        let (spec, ground) = (name.to_owned(), self.view.left.ground);
        let options = SceneOptions { ground, ..SceneOptions::default() };
        let job = Job::new(context, move || Scene::open_and_note(&spec, &options));
        self.opening = Some((name.to_owned(), job));
        self.message = None;
    }

    /// Opens a file of which the content is there.
    pub fn open_bytes(&mut self, context: &egui::Context, name: &str, bytes: Vec<u8>) {
        let (spec, ground) = (name.to_owned(), self.view.left.ground);
        let options = SceneOptions { ground, ..SceneOptions::default() };
        let job = Job::new(context, move || Scene::of_bytes(&spec, &bytes, &options));
        self.opening = Some((name.to_owned(), job));
        self.message = None;
    }

    /// Takes another view, of the same window.
    ///
    /// # Errors
    /// As [`View::of_line`]; the view is then as before.
    pub fn take_line(&mut self, context: &egui::Context, line: &str) -> Result<()> {
        let view = View::of_line(line)?;
        let options = view.left.of_scene()?;
        let spec = view.scene.clone().unwrap_or_else(|| "windmill".to_owned());
        self.view = view;
        self.opening = Some((spec.clone(), Job::new(context, move || Scene::open_and_note(&spec, &options))));
        self.forget_levels();
        Ok(())
    }

    fn take_opened(&mut self) {
        let Some((name, job)) = &self.opening else { return };
        let Some(opened) = job.take() else { return };
        match opened {
            Ok((scene, note)) => {
                self.view.scene = Some(name.clone());
                self.home = Moment { camera: scene.camera, light: scene.light };
                self.moment = self.home;
                self.extent = Extent::of(&scene.mesh);
                self.mesh = DrawnMesh::new(&self.gpu.device, &self.shader, &scene.mesh);
                self.scene = Arc::new(scene);
                self.tracer = None;
                self.tracing = None;
                self.message = note;
                self.forget_levels();
            }
            Err(error) => self.message = Some(error.to_string()),
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
        self.take_opened();
        self.take_dropped(&context);
        if !context.egui_wants_keyboard_input() {
            self.take_keys(&context, now);
        }
        if self.panel {
            egui::Panel::left("options").default_size(250.0).show(ui, |ui| {
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
            context.request_repaint_after(Duration::from_millis(20));
        }
    }

    /// Options of both halves, and what was measured.
    fn options(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        ui.add_space(4.0);
        let shown = self.opening.as_ref().map_or(self.scene.name.clone(), |(name, _)| name.clone());
        let mut picked = None;
        egui::ComboBox::new("scene", "scene").selected_text(&shown).height(300.0).show_ui(ui, |ui| {
            for name in BUILTIN_NAMES {
                if ui.selectable_label(name == shown, name).clicked() {
                    picked = Some(name);
                }
            }
        });
        if !cfg!(target_family = "wasm") {
            ui.horizontal(|ui| {
                let field = egui::TextEdit::singleline(&mut self.path).hint_text("or drop a file, or its path");
                let entered = ui.add(field).lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if entered && !self.path.is_empty() {
                    let path = self.path.clone();
                    self.open(&context, &path);
                }
            });
        }
        if let Some(name) = picked {
            self.open(&context, name);
        }
        if ui.checkbox(&mut self.view.left.ground, "ground plane").changed() {
            let name = self.scene.name.clone();
            self.open(&context, &name);
        }
        let mut changed = false;
        ui.separator();
        ui.strong("left half");
        changed |= ui.push_id("left", |ui| panel::options(ui, &mut self.view.left)).inner;
        ui.separator();
        ui.strong("right half");
        changed |= self.right_half(ui);
        if changed {
            self.forget_levels();
        }
        ui.separator();
        ui.horizontal_wrapped(|ui| {
            for (overlay, name) in Overlay::ALL {
                ui.selectable_value(&mut self.overlay, overlay, name);
            }
        });
        ui.horizontal(|ui| {
            ui.label("pixels");
            for divisor in [1, 2, 4] {
                let text = if divisor == 1 { "1:1".to_owned() } else { format!("{divisor} x {divisor}") };
                ui.selectable_value(&mut self.divisor, divisor, text);
            }
        });
        let mut on = self.magnified.is_some();
        if ui.checkbox(&mut on, "lens").changed() {
            self.magnified = on.then_some(12.0);
        }
        if let Some(factor) = &mut self.magnified {
            ui.add(egui::Slider::new(factor, 4.0..=32.0).step_by(1.0).text("times"));
        }
        ui.horizontal(|ui| {
            ui.checkbox(&mut self.turns, "turn camera");
            ui.checkbox(&mut self.light_turns, "turn light");
        });
        ui.horizontal(|ui| {
            if ui.button("reset").clicked() {
                self.moment = self.home;
            }
            if ui.button("screenshot").clicked() {
                self.screenshot(&context);
            }
            if ui.button("help").clicked() {
                self.help = !self.help;
            }
        });
        ui.separator();
        let seconds: Vec<f64> = self.history.iter().copied().collect();
        if !seconds.is_empty() {
            panel::history(ui, &seconds);
        }
        let level = if self.of_rough { &self.rough } else { &self.full };
        for (half, name) in level.iter().flat_map(|level| &level.halves).zip(["left", "right"]) {
            if let Some(status) = &half.status {
                ui.strong(name);
                panel::stages(ui, status, half.bytes);
            }
        }
    }

    /// Whether the right half changed.
    fn right_half(&mut self, ui: &mut Ui) -> bool {
        let mut truth = matches!(self.view.right, Against::Truth);
        let switched = ui.checkbox(&mut truth, "traced truth, 1024 rays a pixel").changed();
        if switched {
            self.view.right = match truth {
                true => Against::Truth,
                false => Against::Method(Box::new(plain(MethodName::FacetMasks))),
            };
        }
        match &mut self.view.right {
            Against::Truth => switched,
            Against::Method(options) => ui.push_id("right", |ui| panel::options(ui, options)).inner || switched,
        }
    }

    /// The command line of what is looked at; another can be entered.
    fn bottom(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        ui.horizontal(|ui| {
            if ui.button("copy").on_hover_text("the command line of this view").clicked() {
                context.copy_text(self.command_line());
            }
            if !cfg!(target_family = "wasm") && ui.button("save").on_hover_text("a scene file of this view").clicked() {
                self.save_scene();
            }
            let field = egui::TextEdit::singleline(&mut self.line).desired_width(f32::INFINITY);
            let response = ui.add(field);
            if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
                let line = self.line.clone();
                if let Err(error) = self.take_line(&context, &line) {
                    self.message = Some(error.to_string());
                }
            } else if !response.has_focus() {
                self.line = self.command_line();
            }
        });
    }

    fn save_scene(&mut self) {
        let text = scene_file(&self.scene_now());
        let folder = PathBuf::from(&self.scene.name).parent().map(PathBuf::from).unwrap_or_default();
        let free = (1..1000).map(|n| folder.join(format!("view-{n}.toml"))).find(|path| !path.exists());
        let path = free.unwrap_or_else(|| folder.join("view.toml"));
        self.message = Some(match std::fs::write(&path, text) {
            Ok(()) => format!("wrote {}", path.display()),
            Err(error) => format!("{}: {error}", path.display()),
        });
    }

    /// The picture, as large as there is room.
    fn central(&mut self, ui: &mut Ui, now: f64) {
        let context = ui.ctx().clone();
        let rect = ui.available_rect_before_wrap();
        self.image = rect;
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        self.take_pointer(&response, rect, now);
        let turned = context.input(|input| input.stable_dt).min(0.1);
        if self.turns {
            self.moment.camera = orbit(&self.moment.camera, self.extent, 0.5 * turned, 0.0);
        }
        if self.light_turns {
            self.moment.light = turn_light(&self.moment.light, &self.moment.camera, self.extent, 0.5 * turned, 0.0);
        }
        if self.turns || self.light_turns {
            self.moved_at = now;
        }
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        let side = |points: f32| (points * context.pixels_per_point() / self.divisor as f32).round() as u32;
        let size = [side(rect.width()), side(rect.height())].map(|side| side.min(most));
        if size[0] < 8 || size[1] < 8 {
            return;
        }
        self.compute(&context, size, now);
        if let Some(texture) = self.texture {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            ui.painter_at(rect).image(texture, rect, whole, Color32::WHITE);
            self.draw_over(ui, rect);
        }
        self.draw_progress(ui, rect);
    }

    /// Goes on with what is computed, and draws what has come.
    fn compute(&mut self, context: &egui::Context, size: [u32; 2], now: f64) {
        // What another thread waits for.
        let _ = self.gpu.device.poll(wgpu::PollType::Poll);
        if self.size_at.1 != size {
            self.size_at = (now, size);
        }
        let grown = self.full.as_ref().is_none_or(|level| level.picture.size != size);
        // A window that is being dragged is not followed step by step.
        if grown && (self.full.is_none() || now - self.size_at.0 > REST) {
            self.full = Some(Level::new(&self.gpu, &self.scene, &self.view, size, context));
            self.rough = None;
            self.of_rough = false;
        }
        let Some(full) = &mut self.full else { return };
        let seconds = full.seconds.unwrap_or(0.0);
        let moves = now - self.moved_at < REST && seconds > SLOW;
        if moves && self.rough.is_none() {
            let factor = (seconds / SLOW).sqrt().ceil().min(6.0) as u32;
            let less = full.picture.size.map(|side| (side / factor).max(8));
            self.rough = Some(Level::new(&self.gpu, &self.scene, &self.view, less, context));
        }
        let level = match &mut self.rough {
            Some(rough) if moves => rough,
            _ => full,
        };
        let mut new = level.advance(&self.gpu, &self.moment, now);
        if new {
            self.of_rough = moves && self.rough.is_some();
            let seconds = if self.of_rough { &self.rough } else { &self.full }.as_ref().and_then(|level| level.seconds);
            self.history.extend(seconds);
            if self.history.len() > HISTORY {
                self.history.pop_front();
            }
        }
        new |= !self.of_rough && self.trace(context, now);
        let level = if self.of_rough { &self.rough } else { &self.full };
        let Some((level, shown)) = level.as_ref().and_then(|level| Some((level, level.shown?))) else { return };
        let shot = Shot { camera: shown.camera, light: shown.light, wipe: self.view.wipe, overlay: self.overlay };
        if !new && self.drawn == Some(shot) {
            return;
        }
        if let Err(error) = level.draw(&self.gpu, &self.shader, &self.mesh, &self.view, &shot) {
            self.message = Some(error.to_string());
            return;
        }
        self.drawn = Some(shot);
        let (view, filter) = (level.picture.encoded(), wgpu::FilterMode::Nearest);
        let mut renderer = self.render.renderer.write();
        match self.texture {
            Some(id) => renderer.update_egui_texture_from_wgpu_texture(&self.gpu.device, &view, filter, id),
            None => self.texture = Some(renderer.register_native_texture(&self.gpu.device, &view, filter)),
        }
    }

    /// Traces some rows, where the right half is truth and nothing moves. Whether there is something new.
    fn trace(&mut self, context: &egui::Context, now: f64) -> bool {
        let rests = now - self.moved_at >= REST;
        let Some(full) = self.full.as_mut().filter(|level| rests && level.shown == Some(self.moment)) else {
            return false;
        };
        if !matches!(self.view.right, Against::Truth) {
            return false;
        }
        let Some(tracer) = &self.tracer else {
            let scene = self.scene.clone();
            let job = self.tracing.get_or_insert_with(|| Job::new(context, move || truth::tracer(&scene)));
            if let Some(made) = job.take() {
                self.tracing = None;
                match made {
                    Ok(tracer) => self.tracer = Some(tracer),
                    Err(error) => self.message = Some(error.to_string()),
                }
            }
            return false;
        };
        let start = web_time::Instant::now();
        let traced = full.trace(&self.gpu, tracer, || start.elapsed() > Duration::from_millis(40));
        traced.unwrap_or_else(|error| {
            self.message = Some(error.to_string());
            false
        })
    }

    /// The wipe, what the halves are, and the lens.
    fn draw_over(&self, ui: &Ui, rect: Rect) {
        let painter = ui.painter_at(rect);
        let x = rect.left() + self.view.wipe * rect.width();
        let line = egui::Stroke::new(1.5, Color32::from_white_alpha(200));
        painter.vline(x, rect.y_range(), line);
        painter.circle(pos2(x, rect.center().y), 6.0, Color32::from_black_alpha(120), line);
        let name =
            |options: &lab::options::RenderOptions| format!("{}, {} samples", options.method.name(), options.samples);
        let right = match &self.view.right {
            Against::Truth => "1024 rays".to_owned(),
            Against::Method(options) => name(options),
        };
        let tag = |at: Pos2, align: egui::Align2, text: String| {
            let font = egui::FontId::proportional(13.0);
            let galley = painter.layout_no_wrap(text, font, Color32::WHITE);
            let place = align.anchor_size(at, galley.size());
            painter.rect_filled(place.expand(3.0), 3.0, Color32::from_black_alpha(140));
            painter.galley(place.min, galley, Color32::WHITE);
        };
        tag(pos2(rect.left() + 8.0, rect.top() + 8.0), egui::Align2::LEFT_TOP, name(&self.view.left));
        tag(pos2(rect.right() - 8.0, rect.top() + 8.0), egui::Align2::RIGHT_TOP, right);
        let pointer = ui.input(|input| input.pointer.hover_pos()).filter(|at| rect.contains(*at));
        if let (Some(factor), Some(at), Some(texture)) = (self.magnified, pointer, self.texture) {
            let side = 240.0f32.min(rect.width()).min(rect.height());
            let corner = pos2(
                (at.x - side / 2.0).clamp(rect.left(), rect.right() - side),
                (at.y - side / 2.0).clamp(rect.top(), rect.bottom() - side),
            );
            let lens = Rect::from_min_size(corner, vec2(side, side));
            let share = (at - rect.min) / rect.size();
            let half = vec2(side, side) / rect.size() / factor / 2.0;
            let seen = Rect::from_min_max((share - half).to_pos2(), (share + half).to_pos2());
            painter.image(texture, lens, seen, Color32::WHITE);
            painter.rect_stroke(lens, 2.0, line, egui::StrokeKind::Outside);
        }
    }

    /// What the window waits for, and what is wrong.
    fn draw_progress(&self, ui: &Ui, rect: Rect) {
        let waits = || {
            if let Some((name, _)) = &self.opening {
                return Some(format!("opening {name}"));
            }
            let level = self.full.as_ref()?;
            if let Some([done, of]) = level.halves.iter().find_map(|half| half.progress()) {
                return Some(if of == 0 {
                    "preparing".to_owned()
                } else {
                    format!("compiling kernels: {done} of {of}")
                });
            }
            if self.tracing.is_some() {
                return Some("building a tree for rays".to_owned());
            }
            if let Some(error) = level.halves.iter().find_map(|half| half.error.as_ref()) {
                return Some(error.clone());
            }
            if level.shown.is_none() {
                return Some("first frame: the driver compiles".to_owned());
            }
            let share = level.tracing.as_ref().map(|tracing| tracing.share()).filter(|share| *share < 1.0)?;
            Some(format!("tracing 1024 rays a pixel: {:.0} %", 100.0 * share))
        };
        let Some(text) = waits() else { return };
        let painter = ui.painter_at(rect);
        let at = rect.center_bottom() - vec2(0.0, 14.0);
        let galley = painter.layout(text, egui::FontId::proportional(14.0), Color32::WHITE, rect.width() * 0.8);
        let place = egui::Align2::CENTER_BOTTOM.anchor_size(at, galley.size());
        painter.rect_filled(place.expand(5.0), 4.0, Color32::from_black_alpha(170));
        painter.galley(place.min, galley, Color32::WHITE);
    }

    fn take_pointer(&mut self, response: &egui::Response, rect: Rect, now: f64) {
        let context = &response.ctx;
        let wipe = rect.left() + self.view.wipe * rect.width();
        let near_wipe = |at: Pos2| (at.x - wipe).abs() <= REACH;
        if response.hover_pos().is_some_and(near_wipe) {
            context.set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
        }
        if response.drag_started() {
            let (keys, light) = context.input(|input| (input.modifiers, input.key_down(Key::L)));
            let began = context.input(|input| input.pointer.press_origin());
            self.drag = Some(match () {
                () if response.dragged_by(egui::PointerButton::Middle) || keys.ctrl || light => Drag::Light,
                () if response.dragged_by(egui::PointerButton::Secondary) || keys.shift => Drag::Pan,
                () if began.is_some_and(near_wipe) => Drag::Wipe,
                () => Drag::Orbit,
            });
        }
        let Moment { camera, light } = self.moment;
        let by = response.drag_delta() / rect.height().max(1.0);
        if let (Some(drag), true) = (self.drag, response.dragged()) {
            match drag {
                Drag::Orbit => self.moment.camera = orbit(&camera, self.extent, 4.0 * by.x, 4.0 * by.y),
                Drag::Pan => self.moment.camera = pan(&camera, self.extent, -by.x, by.y),
                Drag::Light => self.moment.light = turn_light(&light, &camera, self.extent, 3.0 * by.x, -3.0 * by.y),
                Drag::Wipe => {
                    let at = response.interact_pointer_pos().map_or(wipe, |at| at.x);
                    self.view.wipe = ((at - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0);
                }
            }
        }
        if response.drag_stopped() {
            self.drag = None;
        }
        if response.hovered() {
            let (scroll, pinch) = context.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            if scroll != 0.0 || pinch != 1.0 {
                self.moment.camera = zoom(&camera, self.extent, (scroll * 0.003).exp() * pinch);
            }
        }
        if self.moment != (Moment { camera, light }) {
            self.moved_at = now;
        }
    }

    fn take_keys(&mut self, context: &egui::Context, now: f64) {
        let Moment { camera, light } = self.moment;
        let step = context.input(|input| input.stable_dt).min(0.1);
        let held = |key| f32::from(u8::from(context.input(|input| input.key_down(key))));
        let along = |more, less| (held(more) - held(less)) * step;
        let by = Vec3::new(along(Key::D, Key::A), along(Key::E, Key::Q), along(Key::W, Key::S)) * 0.7;
        if by != Vec3::ZERO {
            self.moment.camera = fly(&camera, self.extent, by);
        }
        let turn = [along(Key::ArrowRight, Key::ArrowLeft), along(Key::ArrowUp, Key::ArrowDown)];
        if turn != [0.0; 2] {
            self.moment.light = turn_light(&light, &camera, self.extent, turn[0], turn[1]);
        }
        if by != Vec3::ZERO || turn != [0.0; 2] {
            context.request_repaint();
        }
        let pressed = |key| context.input(|input| input.key_pressed(key));
        if pressed(Key::R) {
            self.moment = self.home;
        }
        if pressed(Key::Z) {
            self.magnified = if self.magnified.is_some() { None } else { Some(12.0) };
        }
        if pressed(Key::P) {
            self.screenshot(context);
        }
        self.panel ^= pressed(Key::H);
        self.help ^= pressed(Key::F1);
        self.turns ^= pressed(Key::T);
        if self.moment != (Moment { camera, light }) {
            self.moved_at = now;
        }
    }

    fn take_dropped(&mut self, context: &egui::Context) {
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        if dropped.len() > 1 {
            self.message = Some(format!("{} files were dropped; the first is opened", dropped.len()));
        }
        #[cfg(not(target_family = "wasm"))]
        if let Some(file) = dropped.first() {
            let path = file.path().to_string_lossy().into_owned();
            self.open(context, &path);
        }
        #[cfg(target_family = "wasm")]
        if let Some(file) = dropped.first().cloned() {
            crate::web::read_dropped(context, file);
        }
        #[cfg(target_family = "wasm")]
        if let Some((name, bytes)) = crate::web::take_dropped() {
            match bytes {
                Ok(bytes) => self.open_bytes(context, &name, bytes),
                Err(error) => self.message = Some(format!("{name}: {error}")),
            }
        }
    }

    /// Takes the picture, and writes it beside the program or offers it to be kept.
    fn screenshot(&mut self, context: &egui::Context) {
        self.shots += 1;
        let (rect, number, scale) = (self.image, self.shots, context.pixels_per_point());
        context.request_screenshot(move |image| {
            let picture = image.region(&rect, Some(scale));
            if let Err(error) = crate::save_png(&format!("shadows-{number}.png"), &picture) {
                log::error!("{error}");
            }
        });
        if !cfg!(target_family = "wasm") {
            self.message = Some(format!("shadows-{number}.png"));
        }
    }

    /// The message, over the picture, which keeps its size.
    fn tell(&mut self, context: &egui::Context) {
        let Some(message) = &self.message else { return };
        let at = self.image.left_top() + vec2(12.0, 36.0);
        let mut read = false;
        egui::Area::new(egui::Id::unique("message")).fixed_pos(at).show(context, |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(self.image.width() * 0.7);
                ui.horizontal_wrapped(|ui| {
                    read = ui.small_button("x").clicked();
                    ui.label(message);
                });
            });
        });
        if read {
            self.message = None;
        }
    }

    fn help(&mut self, context: &egui::Context) {
        egui::Window::new("help").open(&mut self.help).resizable(false).show(context, |ui| {
            egui::Grid::new("keys").striped(true).show(ui, |ui| {
                for (what, does) in [
                    ("drag", "turn the camera around its target"),
                    ("drag the bright line", "move the wipe between the halves"),
                    ("drag with the right button, or shift", "move the camera"),
                    ("drag with ctrl, L or the middle button", "turn or move the light"),
                    ("wheel, pinch", "nearer, farther"),
                    ("W A S D, Q E", "fly"),
                    ("arrows", "turn or move the light"),
                    ("Z", "lens"),
                    ("T", "turn by itself"),
                    ("R", "the scene's own camera and light"),
                    ("P", "screenshot"),
                    ("H", "hide the panel"),
                    ("F1", "this help"),
                    ("drop a file", "open .glb .gltf .obj .ply .toml"),
                ] {
                    ui.label(what);
                    ui.label(does);
                    ui.end_row();
                }
            });
        });
    }
}

/// Whether a half of it shows nothing because something is wrong.
fn failed(level: &Level) -> bool {
    level.halves.iter().any(|half| half.error.is_some())
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.show(ui);
    }
}
