//! Pointer, keys and dropped files.

use super::{Drag, REACH, Viewer};
use crate::control::{fly, orbit, pan, turn_light, zoom};
use crate::level::Moment;
use crate::overlay::Overlay;
use egui::{Key, Pos2, Rect};
use glam::Vec3;
use std::path::Path;

impl Viewer {
    pub(super) fn take_pointer(&mut self, response: &egui::Response, rect: Rect, now: f64) {
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
                () if self.drags_light => Drag::Light,
                () => Drag::Orbit,
            });
        }
        let Moment { camera, light } = self.moment;
        let by = response.drag_delta() / rect.height().max(1.0);
        let touch = context.input(egui::InputState::multi_touch).filter(|_| response.dragged());
        if let Some(touch) = touch {
            // Two fingers; the first one alone drags no more.
            self.drag = None;
            let by = touch.translation_delta / rect.height().max(1.0);
            self.moment.camera = pan(&camera, self.extent, -by.x, by.y);
        }
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
                self.moment.camera = zoom(&self.moment.camera, self.extent, (scroll * 0.003).exp() * pinch);
            }
        }
        if self.moment != (Moment { camera, light }) {
            self.moved_at = now;
        }
    }

    pub(super) fn take_keys(&mut self, context: &egui::Context, now: f64) {
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
        const NUMBERS: [Key; 7] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7];
        if let Some((_, (overlay, _))) = NUMBERS.into_iter().zip(Overlay::ALL).find(|(key, _)| pressed(*key)) {
            self.view.overlay = overlay;
        }
        if pressed(Key::Z) {
            self.magnified = if self.magnified.is_some() { None } else { Some(12.0) };
        }
        if pressed(Key::P) {
            self.screenshot(context);
        }
        if pressed(Key::H) {
            self.panel = self.panel.map(|panel| !panel);
        }
        self.help ^= pressed(Key::F1);
        self.turns ^= pressed(Key::T);
        if self.moment != (Moment { camera, light }) {
            self.moved_at = now;
        }
    }

    pub(super) fn take_dropped(&mut self, context: &egui::Context) {
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        #[cfg(not(target_family = "wasm"))]
        if !dropped.is_empty() {
            let names = dropped.iter().map(|file| file.path().to_string_lossy().into_owned());
            self.open_first(names.collect());
        }
        #[cfg(target_family = "wasm")]
        {
            if !dropped.is_empty() {
                crate::web::read_dropped(context, dropped);
            }
            if let Some(read) = crate::web::take_dropped() {
                self.hold(read);
            }
        }
    }

    /// Opens the file that may name the others of these.
    fn open_first(&mut self, names: Vec<String>) {
        let rank = |name: &&String| {
            let extension = Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase();
            ["toml", "gltf", "glb", "obj", "ply"].iter().position(|known| *known == extension).unwrap_or(5)
        };
        if let Some(first) = names.iter().min_by_key(rank) {
            self.open(&first.clone());
        }
    }

    /// Holds files whose content is there, and opens one. A model takes the place of all that was held before.
    #[cfg(target_family = "wasm")]
    fn hold(&mut self, read: Vec<(String, Result<Vec<u8>, String>)>) {
        if read.iter().any(|(name, _)| !name.ends_with(".toml")) {
            self.files = Default::default();
        }
        let names = read.iter().map(|(name, _)| name.clone()).collect();
        for (name, bytes) in read {
            match bytes {
                Ok(bytes) => self.files.hold(name, bytes),
                Err(error) => {
                    self.message = Some(format!("{name}: {error}"));
                    return;
                }
            }
        }
        self.open_first(names);
    }
}
