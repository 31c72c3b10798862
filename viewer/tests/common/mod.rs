//! A window without a screen: events go in, pictures are read back.

use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect, pos2};
use egui_wgpu::{RenderState, RendererOptions, WgpuSetup};
use futures::executor::block_on;
use std::sync::Arc;
use std::time::{Duration, Instant};
use subpixel_shadows::wgpu;
use viewer::beside::Opened;
use viewer::{View, Viewer, configuration};

/// Width of the window, points and pixels.
pub const WIDE: u32 = 192;

/// Longest wait for a picture.
const PATIENCE: Duration = Duration::from_secs(300);

/// A dropped file.
#[derive(Debug)]
pub struct Dropped(pub std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

pub struct Window {
    context: egui::Context,
    render: RenderState,
    pub viewer: Viewer,
    size: [f32; 2],
    start: Instant,
    /// Texts of the last frame.
    pub texts: Vec<String>,
    /// Time after which the window asked for the next one.
    asks: Duration,
    /// Pictures of itself that it asked for.
    pub shots: Vec<egui::ScreenshotCallback>,
}

fn texts_of(shape: &egui::Shape, texts: &mut Vec<String>) {
    match shape {
        egui::Shape::Text(text) => texts.push(text.galley.text().to_owned()),
        egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| texts_of(shape, texts)),
        _ => {}
    }
}

impl Window {
    /// A window without its panel.
    pub fn new(line: &str) -> Self {
        Self::of(View::of_line(line).expect(line))
    }

    /// A window of a view, without its panel.
    pub fn of(view: View) -> Self {
        let configuration = configuration();
        let WgpuSetup::CreateNew(setup) = &configuration.wgpu_setup else { unreachable!("as the viewer asks") };
        let instance = block_on(WgpuSetup::CreateNew(setup.clone()).new_instance());
        let render = block_on(RenderState::create(&configuration, &instance, None, RendererOptions::default()));
        let render = render.expect("an adapter; SUBPIXEL_SHADOWS_NO_GPU=1 leaves these tests out");
        let (scene, _) = view.left.open(view.scene.as_deref()).expect("a scene");
        let opened = Opened::new(scene, None).expect("a mesh");
        let context = egui::Context::default();
        let viewer = Viewer::new(&context, &render, view, opened).expect("a viewer");
        let size = [WIDE as f32, 160.0];
        let mut window = Self {
            context,
            render,
            viewer,
            size,
            start: Instant::now(),
            texts: Vec::new(),
            asks: Duration::ZERO,
            shots: Vec::new(),
        };
        window.frame(vec![key(egui::Key::H, true), key(egui::Key::H, false)]);
        window
    }

    /// Sets the window's size, points.
    pub fn resize(&mut self, size: [f32; 2]) {
        self.size = size;
    }

    fn input(&self, events: Vec<Event>) -> RawInput {
        let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, self.size.into()));
        RawInput { screen_rect, time: Some(self.start.elapsed().as_secs_f64()), events, ..Default::default() }
    }

    /// One frame of the window.
    pub fn frame(&mut self, events: Vec<Event>) {
        let input = self.input(events);
        self.run(input);
    }

    /// A frame in which files are dropped.
    pub fn drop_files(&mut self, paths: &[&str]) {
        let dropped = |path: &&str| -> egui::DroppedFileHandle { Arc::new(Dropped((*path).into())) };
        let dropped_files = paths.iter().map(dropped).collect();
        let input = RawInput { dropped_files, ..self.input(Vec::new()) };
        self.run(input);
    }

    fn run(&mut self, input: RawInput) {
        let mut output = self.context.run_ui(input, |ui| self.viewer.show(ui));
        // Nobody paints.
        output.textures_delta.clear();
        self.asks = Duration::MAX;
        for of in output.viewport_output.into_values() {
            self.asks = self.asks.min(of.repaint_delay);
            let shot = |command| if let egui::ViewportCommand::Screenshot(shot) = command { Some(shot) } else { None };
            self.shots.extend(of.commands.into_iter().filter_map(shot));
        }
        self.texts.clear();
        output.shapes.iter().for_each(|shape| texts_of(&shape.shape, &mut self.texts));
    }

    /// Clicks on the middle of a widget.
    pub fn click(&mut self, name: &str) {
        let pos = self.viewer.place(name).unwrap_or_else(|| panic!("no {name}")).center();
        let press =
            |pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
        self.frame(vec![Event::PointerMoved(pos)]);
        self.frame(vec![press(true)]);
        self.frame(vec![press(false)]);
        self.frame(Vec::new());
    }

    /// Frames until nothing is computed.
    pub fn settle(&mut self) {
        let start = Instant::now();
        self.frame(Vec::new());
        // The whole resolution follows a move after a rest.
        std::thread::sleep(Duration::from_millis(300));
        self.frame(Vec::new());
        while !self.viewer.is_settled() {
            assert!(start.elapsed() < PATIENCE, "not settled: {:?}", self.viewer.complaint());
            std::thread::sleep(Duration::from_millis(5));
            self.frame(Vec::new());
        }
    }

    /// Frames that the window itself asks for, as a desktop or a browser draws them where nobody touches anything.
    pub fn rest(&mut self) {
        let start = Instant::now();
        while self.asks < PATIENCE {
            assert!(start.elapsed() < PATIENCE, "it asks for frames without end: {:?}", self.texts);
            std::thread::sleep(self.asks);
            self.frame(Vec::new());
        }
    }

    /// Drags from one place to another, shares of the picture.
    pub fn drag(&mut self, button: PointerButton, from: [f32; 2], to: [f32; 2]) {
        let image = self.viewer.image();
        let at = |share: [f32; 2]| image.min + image.size() * egui::Vec2::from(share);
        let press = |pos: Pos2, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
        let (first, last) = (at(from), at(to));
        self.frame(vec![Event::PointerMoved(first)]);
        self.frame(vec![press(first, true)]);
        for step in 1..=4 {
            self.frame(vec![Event::PointerMoved(first + (last - first) * (step as f32 / 4.0))]);
        }
        self.frame(vec![press(last, false)]);
        self.frame(vec![Event::PointerMoved(pos2(-1.0, -1.0)), Event::PointerGone]);
    }

    /// The picture, 4 bytes a pixel.
    pub fn colours(&self) -> Vec<[u8; 4]> {
        bytemuck::cast_slice(&self.read(self.viewer.colours().expect("a picture"))).to_vec()
    }

    /// Visibility of a half, bits.
    pub fn visibility(&self, half: usize) -> Vec<u32> {
        bytemuck::pod_collect_to_vec(&self.read(self.viewer.visibility(half).expect("a half")))
    }

    /// Counts of a half's pixels.
    pub fn counts(&self, half: usize) -> Vec<[u32; 4]> {
        let counts = self.viewer.counts(half).expect("counts");
        let (device, queue) = (&self.render.device, &self.render.queue);
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: None, size: counts.size(), usage, mapped_at_creation: false };
        let staging = device.create_buffer(&descriptor);
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(counts, 0, &staging, 0, counts.size());
        queue.submit([encoder.finish()]);
        staging.map_async(wgpu::MapMode::Read, .., |_| {});
        device.poll(wgpu::PollType::wait_indefinitely()).expect("polled");
        bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).expect("mapped"))
    }

    /// Width and height of the picture.
    pub fn picture(&self) -> [u32; 2] {
        let size = self.viewer.colours().expect("a picture").size();
        [size.width, size.height]
    }

    fn read(&self, texture: &wgpu::Texture) -> Vec<u8> {
        let read = viewer::read::texture((&self.render.device, &self.render.queue), texture);
        self.render.device.poll(wgpu::PollType::wait_indefinitely()).expect("polled");
        block_on(read).expect("read")
    }

    /// Loses the GPU.
    pub fn lose(&self) {
        self.render.device.destroy();
        let _ = self.render.device.poll(wgpu::PollType::Poll);
    }
}

/// A key that is pressed or let go of.
pub fn key(key: egui::Key, pressed: bool) -> Event {
    Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE }
}
