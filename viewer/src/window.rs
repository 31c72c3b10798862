//! The window, and its command line.

use clap::Parser;
use lab::options::parsed;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex};
use subpixel_shadows::{Error, Result};
use viewer::beside::Opened;
use viewer::{View, ViewArguments, Viewer, configuration, save_png};

/// Arguments of the window.
#[derive(Debug, Parser)]
#[command(name = "viewer", version, about = "Looks at a scene by any two methods, or by one and traced truth")]
struct Arguments {
    #[command(flatten)]
    view: ViewArguments,
    /// Size of the window, points
    #[arg(long, default_value = "1280x800", value_name = "WxH", value_parser = lab::options::size)]
    window: [u32; 2],
    /// Write the window to this PNG file when its picture is complete, and end
    #[arg(long, value_name = "FILE")]
    screenshot: Option<String>,
    /// Folder of the screenshots that are taken by hand [default: where the program runs]
    #[arg(long, value_name = "DIR")]
    screenshots: Option<PathBuf>,
}

/// A window that ends when the GPU is lost.
struct Lasting {
    viewer: Viewer,
    lost: Arc<Mutex<Option<String>>>,
}

impl eframe::App for Lasting {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.viewer.show(ui);
        if let (Some(why), Ok(mut lost)) = (self.viewer.lost(), self.lost.lock()) {
            *lost = Some(format!("{why}; go on with: viewer {}", self.viewer.command_line()));
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

/// A window that ends with a picture of itself.
struct Once {
    viewer: Viewer,
    file: String,
    asked: bool,
    /// 0 not yet, 1 written, 2 failed.
    outcome: Arc<AtomicU8>,
}

impl eframe::App for Once {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.viewer.show(ui);
        let context = ui.ctx().clone();
        // One more frame shows what has just been drawn.
        if self.viewer.is_settled() && !std::mem::replace(&mut self.asked, self.viewer.is_settled()) {
            context.request_repaint();
            let (file, outcome, asked) = (self.file.clone(), self.outcome.clone(), context.clone());
            context.request_screenshot(move |image| {
                let written = save_png(&file, &image).inspect_err(|error| eprintln!("error: {error}"));
                outcome.store(if written.is_ok() { 1 } else { 2 }, Ordering::SeqCst);
                asked.request_repaint();
            });
        }
        if self.outcome.load(Ordering::SeqCst) != 0 {
            if let Some(complaint) = self.viewer.complaint() {
                eprintln!("error: {complaint}");
                self.outcome.store(2, Ordering::SeqCst);
            }
            context.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

/// Opens the window. Exit status as that of the program: 1 bad input, 2 usage, 3 no window or no adapter.
pub fn main() -> ExitCode {
    let given = parsed(std::env::args_os(), |given: &Arguments| given.view.frame.options.method);
    match run(given.unwrap_or_else(|e| e.exit())) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(if error.is_gpu() { 3 } else { 1 })
        }
    }
}

fn run(arguments: Arguments) -> Result<ExitCode> {
    let given = std::env::args().len() > 1;
    let bare = arguments.view.frame.scene.is_none() && arguments.view.against.is_none();
    let view = if given && !bare {
        View::new(arguments.view)?
    } else {
        View { wipe: arguments.view.wipe, overlay: arguments.view.show, ..View::first()? }
    };
    let (scene, note) = view.left.open(view.scene.as_deref())?;
    note.iter().for_each(|note| eprintln!("note: {note}"));
    let opened = Opened::new(scene, note)?;
    if arguments.window.iter().any(|side| !(1..=16384).contains(side)) {
        let [width, height] = arguments.window;
        return Err(Error::Config(format!("a window of {width} x {height} points; 1 to 16384 a side are possible")));
    }
    let [width, height] = arguments.window.map(|side| side as f32);
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("subpixel-shadows")
            .with_inner_size([width, height])
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        wgpu_options: configuration(),
        ..Default::default()
    };
    let outcome = Arc::new(AtomicU8::new(0));
    let (file, told) = (arguments.screenshot.clone(), outcome.clone());
    let lost = Arc::new(Mutex::new(None));
    let of_window = lost.clone();
    let ran = eframe::run_native(
        "subpixel-shadows",
        options,
        Box::new(move |created| {
            let render = created.wgpu_render_state.as_ref().ok_or("no device")?;
            let mut viewer = Viewer::new(&created.egui_ctx, render, view, opened)?;
            viewer.keep_screenshots_in(arguments.screenshots.unwrap_or_default());
            Ok(match file {
                Some(file) => Box::new(Once { viewer, file, asked: false, outcome: told }),
                None => Box::new(Lasting { viewer, lost: of_window }),
            })
        }),
    );
    ran.map_err(|error| match error {
        // Of the scene, not of the window.
        eframe::Error::AppCreation(why) => why.downcast().map_or_else(|e| Error::NoAdapter(e.to_string()), |e| *e),
        other => Error::NoAdapter(format!("no window: {other}")),
    })?;
    if let Some(why) = lost.lock().ok().and_then(|mut lost| lost.take()) {
        return Err(Error::Gpu(why));
    }
    Ok(match (arguments.screenshot, outcome.load(Ordering::SeqCst)) {
        (None, _) | (_, 1) => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    })
}
