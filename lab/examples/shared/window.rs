//! A window that something is drawn into, frame after frame.

use std::sync::Arc;
use std::task::{Context, Poll, Waker};
use std::time::Instant;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::{Error, Result, wgpu};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};

/// Something that is drawn.
pub trait Drawn {
    /// Takes another size, pixels.
    fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<()>;
    /// Records the frame of a moment.
    fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        seconds: f32,
        to: &wgpu::TextureView,
    ) -> Result<()>;
}

/// An open window, its device, and the drawing in it.
struct Open<D> {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    drawn: D,
}

struct Frames<D, M> {
    title: String,
    size: [u32; 2],
    make: Option<M>,
    open: Option<Open<D>>,
    start: Instant,
    failed: Option<Error>,
    /// Frames after which the window closes by itself (`FRAMES` in the environment).
    left: Option<u32>,
}

/// Opens a window and draws into it what `make` makes, until it is closed.
///
/// # Errors
/// Those of the device, of the window system, and of what is drawn.
pub fn run<D: Drawn>(
    title: &str,
    size: [u32; 2],
    make: impl FnOnce(&Gpu, [u32; 2], wgpu::TextureFormat) -> Result<D>,
) -> Result<()> {
    let system = EventLoop::new().map_err(|e| Error::Gpu(format!("no window: {e}")))?;
    let left = std::env::var("FRAMES").ok().and_then(|count| count.parse().ok());
    let (title, start) = (title.to_owned(), Instant::now());
    let mut frames = Frames { title, size, make: Some(make), open: None, start, failed: None, left };
    system.run_app(&mut frames).map_err(|e| Error::Gpu(format!("the window: {e}")))?;
    frames.failed.map_or(Ok(()), Err)
}

/// The outcome of what natively is never waited for.
fn now<T>(future: impl Future<Output = T>) -> T {
    let mut future = std::pin::pin!(future);
    loop {
        if let Poll::Ready(value) = future.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return value;
        }
    }
}

impl<D: Drawn, M: FnOnce(&Gpu, [u32; 2], wgpu::TextureFormat) -> Result<D>> Frames<D, M> {
    fn opened(&mut self, system: &ActiveEventLoop) -> Result<Open<D>> {
        let failed = |what: &str, e: &dyn std::fmt::Display| Error::Gpu(format!("{what}: {e}"));
        let [width, height] = self.size;
        let attributes = Window::default_attributes()
            .with_title(self.title.clone())
            .with_inner_size(PhysicalSize::new(width, height));
        let window = Arc::new(system.create_window(attributes).map_err(|e| failed("no window", &e))?);
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        let surface = instance.create_surface(window.clone()).map_err(|e| failed("no surface", &e))?;
        let options = wgpu::RequestAdapterOptions { compatible_surface: Some(&surface), ..Default::default() };
        let adapter = now(instance.request_adapter(&options)).map_err(|e| failed("no adapter", &e))?;
        let gpu = Gpu::from_adapter(&adapter, None)?;
        let PhysicalSize { width, height } = window.inner_size();
        let config = surface.get_default_config(&adapter, width.max(1), height.max(1));
        let config = config.ok_or_else(|| Error::Gpu("the adapter does not draw into the window".to_owned()))?;
        surface.configure(&gpu.device, &config);
        let Some(make) = self.make.take() else { return Err(Error::Gpu("the window was opened twice".to_owned())) };
        let drawn = make(&gpu, [config.width, config.height], config.format)?;
        Ok(Open { window, surface, config, gpu, drawn })
    }
}

impl<D: Drawn> Open<D> {
    /// Takes the window's size, if it is another; whether there is anything to draw.
    fn fit(&mut self) -> Result<bool> {
        let PhysicalSize { width, height } = self.window.inner_size();
        if width == 0 || height == 0 {
            return Ok(false);
        }
        if [width, height] != [self.config.width, self.config.height] {
            (self.config.width, self.config.height) = (width, height);
            self.surface.configure(&self.gpu.device, &self.config);
            self.drawn.resize(&self.gpu, [width, height])?;
        }
        Ok(true)
    }

    fn draw(&mut self, seconds: f32) -> Result<()> {
        use wgpu::CurrentSurfaceTexture as Current;
        if !self.fit()? {
            return Ok(());
        }
        let frame = match self.surface.get_current_texture() {
            Current::Success(frame) => frame,
            Current::Suboptimal(_) | Current::Outdated => {
                self.surface.configure(&self.gpu.device, &self.config);
                return Ok(());
            }
            Current::Timeout | Current::Occluded => return Ok(()),
            Current::Lost | Current::Validation => return Err(Error::Gpu("the window's surface is lost".to_owned())),
        };
        let mut encoder = self.gpu.encoder();
        self.drawn.record(&self.gpu, &mut encoder, seconds, &frame.texture.create_view(&Default::default()))?;
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.queue.present(frame);
        self.gpu.check()
    }
}

impl<D: Drawn, M: FnOnce(&Gpu, [u32; 2], wgpu::TextureFormat) -> Result<D>> ApplicationHandler for Frames<D, M> {
    fn resumed(&mut self, system: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        match self.opened(system) {
            Ok(open) => {
                open.window.request_redraw();
                self.open = Some(open);
            }
            Err(error) => {
                self.failed = Some(error);
                system.exit();
            }
        }
    }

    fn window_event(&mut self, system: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        match event {
            WindowEvent::CloseRequested => system.exit(),
            WindowEvent::RedrawRequested => {
                if let Err(error) = open.draw(self.start.elapsed().as_secs_f32()) {
                    self.failed = Some(error);
                    system.exit();
                }
                self.left = self.left.map(|left| left.saturating_sub(1));
                if self.left == Some(0) {
                    println!("drew into a window of {}x{} pixels", open.config.width, open.config.height);
                    system.exit();
                }
                open.window.request_redraw();
            }
            _ => {}
        }
    }
}
