//! Widgets: options of a method, times of its stages.

use clap::ValueEnum;
use egui::{ComboBox, Id, Rect, Response, Slider, Ui};
use lab::options::{Compare, Encoding, FacetsPerPixel, OmniBy, PagesBy, PartitionBy, RenderOptions, WarpBy};
use subpixel_shadows::methods::{MethodName, ShadowMapSettings};
use subpixel_shadows::pass::FrameStatus;

fn id(name: &str) -> Id {
    Id::unique(("place", name))
}

/// Where a widget was drawn last.
pub fn place(context: &egui::Context, name: &str) -> Option<Rect> {
    context.data(|data| data.get_temp(id(name)))
}

/// Keeps where a widget is drawn: `[half, label]`, and the word in an open list.
pub fn keep(response: &Response, name: &[&str]) {
    response.ctx.data_mut(|data| data.insert_temp(id(&name.join(".")), response.rect));
}

/// A list of the words of an option. Whether another was picked.
fn words<T: ValueEnum + PartialEq>(ui: &mut Ui, half: &str, label: &str, value: &mut T) -> bool {
    let name = |value: &T| value.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
    let mut changed = false;
    let list = ComboBox::new((label, ui.scope_id()), label).selected_text(name(value)).show_ui(ui, |ui| {
        for one in T::value_variants() {
            let help = one.to_possible_value().and_then(|v| v.get_help().map(ToString::to_string));
            let mut response = ui.selectable_value(value, one.clone(), name(one));
            keep(&response, &[half, label, &name(one)]);
            if let Some(help) = help {
                response = response.on_hover_text(help);
            }
            changed |= response.changed();
        }
    });
    keep(&list.response, &[half, label]);
    changed
}

/// A list of numbers.
fn numbers(ui: &mut Ui, half: &str, label: &str, value: &mut u32, choices: &[u32]) -> bool {
    let mut changed = false;
    let list = ComboBox::new((label, ui.scope_id()), label).selected_text(value.to_string()).show_ui(ui, |ui| {
        for one in choices {
            let response = ui.selectable_value(value, *one, one.to_string());
            keep(&response, &[half, label, &one.to_string()]);
            changed |= response.changed();
        }
    });
    keep(&list.response, &[half, label]);
    changed
}

/// Numbers between two, as far as they are let go of.
fn slider<N: egui::emath::Numeric>(
    ui: &mut Ui,
    half: &str,
    label: &str,
    value: &mut N,
    range: std::ops::RangeInclusive<N>,
) -> bool {
    let response = ui.add(Slider::new(value, range).text(label));
    keep(&response, &[half, label]);
    response.drag_stopped() || (response.changed() && !response.dragged())
}

/// The method and the options that it takes. Whether one was changed.
pub fn options(ui: &mut Ui, half: &str, options: &mut RenderOptions) -> bool {
    let mut changed = false;
    let list = ComboBox::new(("method", ui.scope_id()), "method").selected_text(options.method.name()).height(420.0);
    let list = list.show_ui(ui, |ui| {
        for method in MethodName::ALL {
            let row = method.row();
            let response = ui.selectable_value(&mut options.method, method, row.name);
            keep(&response, &[half, "method", row.name]);
            changed |= response.on_hover_text(format!("{}, {}", row.paper, row.section)).changed();
        }
    });
    keep(&list.response, &[half, "method"]);
    changed |= numbers(ui, half, "samples", &mut options.samples, &[1, 8, 16, 32, 64, 128]);
    changed |= words(ui, half, "pattern", &mut options.pattern);
    changed |= numbers(ui, half, "map", &mut options.map, &[64, 128, 256, 512, 1024, 2048, 4096]);
    let method = options.method;
    if method.takes("omni") {
        changed |= words(ui, half, "omni", &mut options.omni);
    }
    let curved = method.takes("omni") && options.omni == OmniBy::Paraboloids;
    if curved {
        // These are of maps on planes.
        (options.partition, options.splits, options.warp) = (PartitionBy::default(), None, None);
        (options.compare, options.history) = (Compare::Nearest, 1);
    }
    let of_planes = ["compare", "partition", "splits", "warp", "focus", "history"];
    let takes = |name| method.takes(name) && !(curved && of_planes.contains(&name));
    if takes("facets") {
        changed |= words(ui, half, "facets", &mut options.facets);
        if matches!(options.facets, FacetsPerPixel::One) {
            changed |= words(ui, half, "validity", &mut options.validity);
        }
    }
    if takes("masks") {
        changed |= words(ui, half, "masks", &mut options.masks);
        changed |= words(ui, half, "pairs", &mut options.pairs);
        changed |= words(ui, half, "projection", &mut options.projection);
        changed |= words(ui, half, "filter", &mut options.filter);
    }
    if takes("encoding") {
        changed |= words(ui, half, "encoding", &mut options.encoding);
        changed |= words(ui, half, "search", &mut options.search);
        changed |= words(ui, half, "recovery", &mut options.recovery);
        if matches!(options.encoding, Encoding::Paper) {
            changed |= numbers(ui, half, "slope-power", &mut options.slope_power, &[1, 3, 5, 7, 9]);
        }
    }
    if takes("lookups") {
        let mut lookups = options.asked_texels();
        changed |= numbers(ui, half, "lookups", &mut lookups, &[1, 3, 5, 7]);
        options.lookups = Some(lookups).filter(|lookups| *lookups != options.asked_by_default());
    }
    if takes("rays") {
        changed |= words(ui, half, "rays", &mut options.rays);
    }
    if takes("kernel") {
        changed |= slider(ui, half, "taps", &mut options.taps, 0..=64);
        if options.taps > 0 {
            changed |= slider(ui, half, "radius", &mut options.radius, 0.0..=16.0);
            changed |= words(ui, half, "turned", &mut options.turned);
        } else {
            changed |= numbers(ui, half, "kernel", &mut options.kernel, &[2, 3, 5, 7]);
        }
    }
    let usual = ShadowMapSettings::default();
    if takes("compare") {
        changed |= words(ui, half, "compare", &mut options.compare);
        if options.compare != Compare::Nearest {
            (options.bias, options.slope_bias) = (usual.constant, usual.slope);
        }
    }
    let biased = !takes("compare") || options.compare == Compare::Nearest;
    if takes("bias") && biased {
        changed |= slider(ui, half, "bias", &mut options.bias, 0.0..=0.01);
    }
    if takes("slope-bias") && biased {
        changed |= slider(ui, half, "slope-bias", &mut options.slope_bias, 0.0..=8.0);
    }
    if takes("sub-texels") {
        changed |= numbers(ui, half, "sub-texels", &mut options.sub_texels, &[2, 4, 8]);
        changed |= slider(ui, half, "nodes", &mut options.nodes, 3..=15);
        changed |= slider(ui, half, "error", &mut options.error, 0.0..=0.5);
    }
    if takes("shape") {
        changed |= words(ui, half, "shape", &mut options.shape);
        changed |= slider(ui, half, "reach", &mut options.reach, 1..=64);
    }
    if takes("partition") {
        changed |= words(ui, half, "partition", &mut options.partition);
    }
    let other = [PartitionBy::FrustumFaces, PartitionBy::ReceiverClusters];
    let faces = takes("partition") && other.contains(&options.partition);
    if faces {
        options.splits = None;
        options.warp = options.warp.filter(|warp| *warp != WarpBy::Stable);
    }
    if takes("splits") && !faces {
        let own = method.row().partition.map_or(0, |plan| plan.splits);
        let mut splits = options.splits.unwrap_or(own);
        changed |= slider(ui, half, "splits", &mut splits, u32::from(own > 0)..=4);
        options.splits = Some(splits).filter(|splits| *splits != own && *splits > 0);
        if splits > 1 {
            changed |= slider(ui, half, "split-weight", &mut options.split_weight, 0.0..=1.0);
        }
    }
    if takes("warp") && (faces || options.splits.is_some() || method.row().partition.is_some()) {
        let mut warp = options.warp.unwrap_or_default();
        changed |= words(ui, half, "warp", &mut warp);
        options.warp = Some(warp).filter(|warp| *warp != Default::default() || options.warp.is_some());
    }
    if takes("focus") && (options.warp == Some(WarpBy::Trapezoid) || method == MethodName::Trapezoidal) {
        changed |= slider(ui, half, "focus", &mut options.focus, 0.05..=0.95);
    }
    if takes("bleeding") {
        changed |= slider(ui, half, "bleeding", &mut options.bleeding, 0.0..=0.9);
        changed |= slider(ui, half, "grazing", &mut options.grazing, 0.0..=30.0);
    }
    if takes("layers") {
        changed |= slider(ui, half, "layers", &mut options.layers, 2..=8);
    }
    if takes("terms") {
        changed |= slider(ui, half, "terms", &mut options.terms, 1..=16);
    }
    if takes("history") {
        changed |= slider(ui, half, "history", &mut options.history, 1..=64);
        if options.history > 1 {
            changed |= slider(ui, half, "confidence-power", &mut options.confidence_power, 1..=32);
        }
    }
    if takes("pages") {
        let mut pages = options.pages.unwrap_or_default();
        changed |= slider(ui, half, "pages", &mut pages, 0..=4096);
        options.pages = Some(pages).filter(|pages| *pages > 0);
        changed |= slider(ui, half, "finer", &mut options.finer, 0..=4);
        changed |= words(ui, half, "page-rule", &mut options.page_rule);
        if options.page_rule == PagesBy::Queried {
            changed |= slider(ui, half, "changed", &mut options.changed, 1..=256);
        }
    }
    if takes("density") {
        changed |= words(ui, half, "density", &mut options.density);
        changed |= slider(ui, half, "stretch", &mut options.stretch, 2..=256);
    }
    if takes("exponent") {
        changed |= slider(ui, half, "exponent", &mut options.exponent, 1.0..=42.0);
    }
    changed |= slider(ui, half, "light-radius", &mut options.light_radius, 0.0..=5.0);
    if options.light_radius > 0.0 {
        changed |= numbers(ui, half, "light-points", &mut options.light_points, &[4, 8, 16, 32, 64]);
    }
    changed
}

/// Times of the stages, as bars, and what is held.
pub fn stages(ui: &mut Ui, status: &FrameStatus, bytes: u64) {
    let all: f64 = status.stages.iter().map(|stage| stage.gpu_ms).sum();
    let memory = bytes as f64 / f64::from(1 << 20);
    ui.label(format!("{all:.1} ms on the GPU, {} dispatches, {memory:.0} MiB", status.dispatches));
    let mut most: Vec<_> = status.stages.iter().filter(|stage| stage.gpu_ms > 0.005 * all).collect();
    most.sort_by(|a, b| b.gpu_ms.total_cmp(&a.gpu_ms));
    for stage in most.iter().take(8) {
        let share = (stage.gpu_ms / all.max(1e-9)) as f32;
        let text = format!("{} {:.1}", stage.name, stage.gpu_ms);
        ui.add(egui::ProgressBar::new(share).text(text).desired_height(14.0).corner_radius(2.0));
    }
    let counts = &status.counts;
    // Of methods with facets.
    if counts.visibility_evaluations > 0 {
        ui.label(format!(
            "{} facets, {} undecided, {} evaluations",
            counts.facets, counts.silhouette_pixels, counts.visibility_evaluations
        ));
    }
}

/// Times of the last frames as a line, newest to the right, seconds.
pub fn history(ui: &mut Ui, seconds: &[f64]) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(ui.available_width(), 36.0), egui::Sense::hover());
    let most = seconds.iter().copied().fold(1e-3, f64::max);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let step = rect.width() / 60.0;
    let at = |(k, s): (usize, &f64)| {
        let x = rect.right() - (seconds.len() - 1 - k) as f32 * step;
        egui::pos2(x, rect.bottom() - 2.0 - (s / most) as f32 * (rect.height() - 4.0))
    };
    let points: Vec<_> = seconds.iter().enumerate().map(at).collect();
    painter.line(points, egui::Stroke::new(1.5, ui.visuals().hyperlink_color));
    let text = format!("longest frame {:.0} ms", 1e3 * most);
    painter.text(
        rect.left_top() + egui::vec2(4.0, 2.0),
        egui::Align2::LEFT_TOP,
        text,
        egui::FontId::proportional(11.0),
        ui.visuals().weak_text_color(),
    );
}
