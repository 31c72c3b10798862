//! Panels of the window: options, the line, help, messages.

use super::Viewer;
use crate::overlay::Overlay;
use crate::panel;
use crate::view::Against;
use egui::{Key, Ui, vec2};
use lab::options::RenderOptions;
use lab::scene::{names, scene_file};
#[cfg(not(target_family = "wasm"))]
use std::path::PathBuf;
use subpixel_shadows::methods::MethodName;

impl Viewer {
    /// Options of both halves, and what was measured.
    pub(super) fn options(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        ui.add_space(4.0);
        let shown = self.opening.as_ref().map_or(self.scene.name.clone(), |(name, _)| name.clone());
        let mut picked = None;
        egui::ComboBox::new("scene", "scene").selected_text(&shown).height(300.0).show_ui(ui, |ui| {
            for name in names() {
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
                    self.open(&path);
                }
            });
        }
        if let Some(name) = picked {
            self.open(name);
        }
        if ui.checkbox(&mut self.view.left.ground, "ground plane").changed() {
            let name = self.scene.name.clone();
            self.open(&name);
        }
        ui.horizontal_wrapped(|ui| {
            for (overlay, name) in Overlay::ALL {
                let response = ui.selectable_value(&mut self.view.overlay, overlay, name);
                panel::keep(&response, &["show", name]);
                response.on_hover_text(overlay.meaning());
            }
        });
        let mut changed = false;
        ui.separator();
        ui.strong("left half");
        changed |= ui.push_id("left", |ui| panel::options(ui, "left", &mut self.view.left)).inner;
        ui.separator();
        ui.strong("right half");
        changed |= self.right_half(ui);
        if changed {
            self.forget_levels();
        }
        ui.separator();
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
        let drags =
            ui.checkbox(&mut self.drags_light, "drag the light").on_hover_text("a drag turns or moves the light");
        panel::keep(&drags, &["drag the light"]);
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
        self.plans(ui);
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
    pub(super) fn right_half(&mut self, ui: &mut Ui) -> bool {
        let mut truth = matches!(self.view.right, Against::Truth);
        let switched = ui.checkbox(&mut truth, "traced truth, 1024 rays a pixel").changed();
        if switched {
            self.view.right = match truth {
                true => Against::Truth,
                false => match RenderOptions::of_method(MethodName::FacetMasks) {
                    Ok(options) => Against::Method(Box::new(options)),
                    Err(_) => Against::Truth,
                },
            };
        }
        match &mut self.view.right {
            Against::Truth => switched,
            Against::Method(options) => {
                ui.push_id("right", |ui| panel::options(ui, "right", options)).inner || switched
            }
        }
    }

    /// The command line of what is looked at; another can be entered.
    pub(super) fn bottom(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        ui.horizontal(|ui| {
            if ui.button("options").on_hover_text("the panel of options (H)").clicked() {
                self.panel = self.panel.map(|panel| !panel);
            }
            if ui.button("copy").on_hover_text("the command line of this view").clicked() {
                context.copy_text(self.command_line());
            }
            let save = ui.button("save").on_hover_text("a scene file of this view");
            panel::keep(&save, &["save"]);
            if save.clicked() {
                self.save_scene();
            }
            let field = egui::TextEdit::singleline(&mut self.line).desired_width(f32::INFINITY);
            let response = ui.add(field);
            if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
                let line = self.line.clone();
                if let Err(error) = self.take_line(&line) {
                    self.message = Some(error.to_string());
                }
            } else if !response.has_focus() {
                self.line = self.command_line();
            }
        });
    }

    /// Offers a scene file to be kept.
    #[cfg(target_family = "wasm")]
    pub(super) fn save_scene(&mut self) {
        self.saved += 1;
        let text = scene_file(&self.scene_now());
        self.message = crate::web::offer(&format!("view-{}.toml", self.saved), text.as_bytes()).err();
    }

    /// Writes a scene file beside the model.
    #[cfg(not(target_family = "wasm"))]
    pub(super) fn save_scene(&mut self) {
        let text = scene_file(&self.scene_now());
        let folder = PathBuf::from(&self.scene.name).parent().map(PathBuf::from).unwrap_or_default();
        let free = (1..1000).map(|n| folder.join(format!("view-{n}.toml"))).find(|path| !path.exists());
        let path = free.unwrap_or_else(|| folder.join("view.toml"));
        self.message = Some(match std::fs::write(&path, text) {
            Ok(()) => format!("wrote {}", path.display()),
            Err(error) => format!("{}: {error}", path.display()),
        });
    }

    /// The message, over the picture, which keeps its size.
    pub(super) fn tell(&mut self, context: &egui::Context) {
        let Some(message) = self.lost().or_else(|| self.message.clone()) else { return };
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

    pub(super) fn help(&mut self, context: &egui::Context) {
        egui::Window::new("help").open(&mut self.help).resizable(false).show(context, |ui| {
            egui::Grid::new("keys").striped(true).show(ui, |ui| {
                for (what, does) in [
                    ("drag", "turn the camera around its target"),
                    ("drag the bright line", "move the wipe between the halves"),
                    ("drag with the right button, or shift", "move the camera"),
                    ("drag with ctrl, L or the middle button", "turn or move the light"),
                    ("wheel, pinch", "nearer, farther"),
                    ("drag with two fingers", "move the camera"),
                    ("W A S D, Q E", "fly"),
                    ("arrows", "turn or move the light"),
                    ("1 to 7", "shaded, visibility, difference, classes, facets, texels, pairs"),
                    ("Z", "lens"),
                    ("T", "turn by itself"),
                    ("R", "the scene's own camera and light"),
                    ("P", "screenshot"),
                    ("H", "hide the panel"),
                    ("F1", "this help"),
                    ("drop files", "open .glb .gltf .obj .ply .toml, with what they name beside them"),
                ] {
                    ui.label(what);
                    ui.label(does);
                    ui.end_row();
                }
            });
        });
    }
}
