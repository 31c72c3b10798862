//! The picture in the window, with the wipe, the lens and the progress over it.

use super::Viewer;
use crate::control::{orbit, turn_light};
use crate::view::Against;
use egui::{Color32, Pos2, Rect, Sense, Ui, pos2, vec2};

impl Viewer {
    /// The picture, as large as there is room.
    pub(super) fn central(&mut self, ui: &mut Ui, now: f64) {
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
        match self.lost() {
            None => self.compute(size, now),
            Some(_lost) => {
                #[cfg(target_family = "wasm")]
                crate::web::tell_lost(&_lost);
            }
        }
        if let Some(texture) = self.texture {
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            ui.painter_at(rect).image(texture, rect, whole, Color32::WHITE);
            self.draw_over(ui, rect);
        }
        self.draw_progress(ui, rect);
    }

    /// The wipe, what the halves are, and the lens.
    pub(super) fn draw_over(&self, ui: &Ui, rect: Rect) {
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
        self.draw_legend(&painter, rect);
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

    /// Height of the legend, points.
    fn legend_height(&self) -> f32 {
        if self.view.overlay.counted().is_some() { 56.0 } else { 0.0 }
    }

    /// Colours of an overlay of numbers with their words, and which half has none, along the lower end of the picture.
    fn draw_legend(&self, painter: &egui::Painter, rect: Rect) {
        let (overlay, legend) = (self.view.overlay, self.view.overlay.legend());
        if legend.is_empty() {
            return;
        }
        let width = ((rect.width() - 16.0) / legend.len() as f32).min(if legend.len() > 5 { 34.0 } else { 68.0 });
        let at = rect.left_bottom() + vec2(8.0, -self.legend_height());
        let mut text = overlay.meaning().to_owned();
        let right = match &self.view.right {
            Against::Method(options) => Some(options.method),
            Against::Truth => None,
        };
        for (name, method) in [("left", Some(self.view.left.method)), ("right", right)] {
            let has = method.is_some_and(|method| overlay.is_of(method));
            if !has {
                let method = method.map_or("rays", |method| method.name());
                text += &format!("; {name}: {method}, none");
            }
        }
        let all = egui::Rect::from_min_size(at, vec2(width * legend.len() as f32, self.legend_height() - 6.0));
        let font = egui::FontId::proportional(12.0);
        let title = painter.layout(text, font.clone(), Color32::WHITE, rect.width() - 16.0);
        painter.rect_filled(
            all.union(Rect::from_min_size(at, title.size())).expand(4.0),
            3.0,
            Color32::from_black_alpha(170),
        );
        painter.galley(at, title, Color32::WHITE);
        for (k, (word, [r, g, b])) in legend.into_iter().enumerate() {
            let cell = Rect::from_min_size(at + vec2(k as f32 * width, 18.0), vec2(width - 2.0, 14.0));
            painter.rect_filled(cell, 0.0, Color32::from_rgb(r, g, b));
            painter.text(cell.center_bottom(), egui::Align2::CENTER_TOP, word, font.clone(), Color32::WHITE);
        }
    }

    /// Progress of work that the window waits for, or the error of a half.
    pub(super) fn draw_progress(&self, ui: &Ui, rect: Rect) {
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
            if let Some(error) = level.halves.iter().find_map(|half| half.error.as_ref()) {
                return Some(error.clone());
            }
            if level.shown.is_none() {
                return Some("first frame: the driver compiles".to_owned());
            }
            let share = level.tracing.as_ref().map(|tracing| tracing.share()).filter(|share| *share < 1.0)?;
            Some(match share {
                0.0 => "building a tree for rays".to_owned(),
                _ => format!("tracing 1024 rays a pixel: {:.0} %", 100.0 * share),
            })
        };
        let Some(text) = waits() else { return };
        let painter = ui.painter_at(rect);
        let at = rect.center_bottom() - vec2(0.0, 14.0 + self.legend_height());
        let galley = painter.layout(text, egui::FontId::proportional(14.0), Color32::WHITE, rect.width() * 0.8);
        let place = egui::Align2::CENTER_BOTTOM.anchor_size(at, galley.size());
        painter.rect_filled(place.expand(5.0), 4.0, Color32::from_black_alpha(170));
        painter.galley(place.min, galley, Color32::WHITE);
    }

    /// Takes the picture, and writes it beside the program or offers it to be kept.
    pub(super) fn screenshot(&mut self, context: &egui::Context) {
        // Of no earlier one a file is lost.
        let name = |number: u32| self.screenshots.join(format!("shadows-{number}.png")).display().to_string();
        let taken = |number: u32| !cfg!(target_family = "wasm") && std::path::Path::new(&name(number)).exists();
        let number = (self.shots + 1..).find(|&number| !taken(number)).unwrap_or(u32::MAX);
        let (rect, name, scale) = (self.image, name(number), context.pixels_per_point());
        self.shots = number;
        let (told, wakes) = (self.told.clone(), context.clone());
        // It is no picture of the message.
        self.message = None;
        context.request_screenshot(move |image| {
            let saved = crate::save_png(&name, &image.region(&rect, Some(scale)));
            let text = match saved {
                Ok(()) if cfg!(target_family = "wasm") => return,
                Ok(()) => format!("wrote {name}"),
                Err(error) => error,
            };
            if let Ok(mut told) = told.lock() {
                *told = Some(text);
            }
            wakes.request_repaint();
        });
    }
}
