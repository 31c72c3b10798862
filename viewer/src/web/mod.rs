//! The viewer in a web page.

mod worker;

use crate::{View, Viewer, configuration};
use lab::options::DEFAULT_SCENE;
use lab::scene::Files;
use std::cell::RefCell;
use wasm_bindgen::Clamped;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, CanvasRenderingContext2d, Document, HtmlAnchorElement, HtmlCanvasElement, ImageData, Url};
pub use worker::{SceneInWorker, open, pause, trace};

/// Names of files, and their contents or why there is none.
type Read = Vec<(String, Result<Vec<u8>, String>)>;

thread_local! {
    static LISTENER: RefCell<Option<js_sys::Function>> = const { RefCell::new(None) };
    static DROPPED: RefCell<Option<Read>> = const { RefCell::new(None) };
    /// Promises, when one of the given pipelines is compiled, those to come still.
    static COMPILED: RefCell<Option<js_sys::Function>> = const { RefCell::new(None) };
}

/// Waits for one of the pipelines that the page compiles, of `given`, which it told before, or of all that it was asked for: those to come still.
///
/// # Errors
/// The page does not tell.
pub async fn uncompiled(given: Option<js_sys::Array>) -> Result<js_sys::Array, JsValue> {
    let compiled = COMPILED.with_borrow(Clone::clone).ok_or("the page does not tell")?;
    let given = given.map_or(JsValue::UNDEFINED, JsValue::from);
    let promise: js_sys::Promise = compiled.call1(&JsValue::NULL, &given)?.dyn_into()?;
    wasm_bindgen_futures::JsFuture::from(promise).await?.dyn_into()
}

/// Tells the page, once, that nothing can be drawn any more.
pub fn tell_lost(why: &str) {
    if let Some(listener) = LISTENER.take() {
        // Nobody is left to hear of an error of this.
        let _ = listener.call1(&JsValue::NULL, &JsValue::from_str(why));
    }
}

/// Reads dropped files beside the page; [`take_dropped`] gives them.
pub fn read_dropped(context: &egui::Context, files: Vec<egui::DroppedFileHandle>) {
    let context = context.clone();
    wasm_bindgen_futures::spawn_local(async move {
        let mut read = Read::new();
        for file in files {
            read.push((file.path().to_string_lossy().into_owned(), file.bytes_async().await));
        }
        DROPPED.set(Some(read));
        context.request_repaint();
    });
}

/// Files that were dropped together and have been read, once.
pub fn take_dropped() -> Option<Read> {
    DROPPED.take()
}

/// Offers a file to be kept.
///
/// # Errors
/// One line, if the browser refuses.
pub fn offer(name: &str, bytes: &[u8]) -> Result<(), String> {
    let offered = || -> Result<(), JsValue> {
        let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
        let url = Url::create_object_url_with_blob(&Blob::new_with_u8_array_sequence(&parts)?)?;
        download(name, &url)?;
        Url::revoke_object_url(&url)
    };
    offered().map_err(|e| format!("{name}: {e:?}"))
}

/// Offers an image of 4 bytes a pixel to be kept as a PNG file, which the browser makes.
///
/// # Errors
/// As [`offer`].
pub fn offer_png(name: &str, [width, height]: [u32; 2], pixels: &[u8]) -> Result<(), String> {
    let offered = || -> Result<(), JsValue> {
        let canvas: HtmlCanvasElement = document()?.create_element("canvas")?.dyn_into()?;
        canvas.set_width(width);
        canvas.set_height(height);
        let drawing = canvas.get_context("2d")?.ok_or("no canvas")?.dyn_into::<CanvasRenderingContext2d>()?;
        let image = ImageData::new_with_u8_clamped_array_and_sh(Clamped(pixels), width, height)?;
        drawing.put_image_data(&image, 0.0, 0.0)?;
        download(name, &canvas.to_data_url()?)
    };
    offered().map_err(|e| format!("{name}: {e:?}"))
}

fn document() -> Result<Document, JsValue> {
    Ok(web_sys::window().and_then(|w| w.document()).ok_or("no document")?)
}

fn download(name: &str, url: &str) -> Result<(), JsValue> {
    let link: HtmlAnchorElement = document()?.create_element("a")?.dyn_into()?;
    link.set_href(url);
    link.set_download(name);
    link.click();
    Ok(())
}

/// The viewer on a page, for its scripts.
#[derive(Clone)]
#[wasm_bindgen]
pub struct Page(eframe::WebRunner);

impl Page {
    fn viewer<T>(&self, ask: impl FnOnce(&mut Viewer) -> T) -> Result<T, JsValue> {
        let mut viewer = self.0.app_mut::<Viewer>().ok_or("the viewer has ended")?;
        Ok(ask(&mut viewer))
    }
}

#[wasm_bindgen]
impl Page {
    /// Whether the picture is complete, or there is none.
    ///
    /// # Errors
    /// The viewer has ended.
    pub fn settled(&self) -> Result<bool, JsValue> {
        self.viewer(|viewer| viewer.is_settled())
    }

    /// The last error or note, as the page tells it.
    ///
    /// # Errors
    /// The viewer has ended.
    pub fn complaint(&self) -> Result<Option<String>, JsValue> {
        self.viewer(|viewer| viewer.complaint())
    }

    /// The arguments that open what is looked at.
    ///
    /// # Errors
    /// The viewer has ended.
    pub fn line(&self) -> Result<String, JsValue> {
        self.viewer(|viewer| viewer.command_line())
    }

    /// Takes another view.
    ///
    /// # Errors
    /// One line: why there is no such view; the view is then as before. The viewer has ended.
    pub fn open(&self, line: &str) -> Result<(), JsValue> {
        let opened = self.viewer(|viewer| viewer.take_line(line))?;
        opened.map_err(|e| JsValue::from_str(&e.to_string()))
    }

    /// Halves that the picture shows, from the left.
    ///
    /// # Errors
    /// The viewer has ended.
    pub fn halves_shown(&self) -> Result<usize, JsValue> {
        self.viewer(|viewer| viewer.halves_shown())
    }

    /// Left, top, width and height of a widget by its label ("left.samples"), or of the "picture", in points of the page; nothing where there is none.
    ///
    /// # Errors
    /// The viewer has ended.
    pub fn place(&self, name: &str) -> Result<Option<Vec<f32>>, JsValue> {
        let rect = self.viewer(|viewer| viewer.place(name))?;
        Ok(rect.map(|rect| vec![rect.left(), rect.top(), rect.width(), rect.height()]))
    }

    /// Width and height of the picture in pixels, then the visibility of each of them by a half (0 the left one, 1 the right one), row by row
    /// from the top: 0 dark to 1 lit, below 0 where nothing was computed.
    ///
    /// # Errors
    /// There is no such half yet; the device is lost; the viewer has ended.
    pub fn visibility(&self, half: usize) -> Result<js_sys::Promise, JsValue> {
        let read = self.viewer(|viewer| viewer.read_visibility(half))?.ok_or("no such half, or no picture yet")?;
        Ok(wasm_bindgen_futures::future_to_promise(async move {
            let numbers = read.await.map_err(|e| JsValue::from_str(&e))?;
            Ok(js_sys::Float32Array::from(numbers.as_slice()).into())
        }))
    }
}

/// Opens the viewer on a canvas, with the view that a command line names (the page's address after `#`), or the one by default. `told` is
/// called with one line where nothing can be drawn any more; `ask` asks the worker; `compiled` promises,
/// when one of the given pipelines is compiled, those to come still.
///
/// # Errors
/// One line: the view cannot be opened, or there is no adapter.
#[wasm_bindgen]
pub async fn start(
    canvas: HtmlCanvasElement,
    line: String,
    told: js_sys::Function,
    ask: js_sys::Function,
    compiled: js_sys::Function,
) -> Result<Page, JsValue> {
    worker::set_ask(ask);
    COMPILED.set(Some(compiled));
    console_error_panic_hook::set_once();
    let said = |error: &dyn std::fmt::Display| JsValue::from_str(&error.to_string());
    let view = if line.trim().is_empty() {
        View::first().map_err(|e| said(&e))?
    } else {
        View::of_line(&line).map_err(|e| said(&e))?
    };
    let (name, options) = (view.scene.as_deref().unwrap_or(DEFAULT_SCENE), view.left.of_scene().map_err(|e| said(&e))?);
    let opened = open(name.to_owned(), options, Files::default()).await.map_err(|e| said(&e))?;
    let options = eframe::WebOptions { wgpu_options: configuration(), ..Default::default() };
    let create = move |created: &eframe::CreationContext<'_>| {
        let render = created.wgpu_render_state.as_ref().ok_or("no device")?;
        LISTENER.set(Some(told));
        Ok(Box::new(Viewer::new(&created.egui_ctx, render, view, opened)?) as Box<dyn eframe::App>)
    };
    let runner = eframe::WebRunner::new();
    runner.start(canvas, options, Box::new(create)).await?;
    Ok(Page(runner))
}
