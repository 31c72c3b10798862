//! The viewer in a web page.

use crate::{View, Viewer, configuration};
use std::cell::RefCell;
use wasm_bindgen::prelude::*;
use web_sys::{Blob, HtmlAnchorElement, HtmlCanvasElement, Url};

thread_local! {
    static DROPPED: RefCell<Option<(String, Result<Vec<u8>, String>)>> = const { RefCell::new(None) };
}

/// Reads a dropped file beside the page; [`take_dropped`] gives it.
pub fn read_dropped(context: &egui::Context, file: egui::DroppedFileHandle) {
    let context = context.clone();
    wasm_bindgen_futures::spawn_local(async move {
        let name = file.path().to_string_lossy().into_owned();
        let bytes = file.bytes_async().await;
        DROPPED.set(Some((name, bytes)));
        context.request_repaint();
    });
}

/// A file that was dropped and has been read, once.
pub fn take_dropped() -> Option<(String, Result<Vec<u8>, String>)> {
    DROPPED.take()
}

/// Offers a PNG file to be kept.
///
/// # Errors
/// One line, if the browser refuses.
pub fn offer(name: &str, png: &[u8]) -> Result<(), String> {
    let offered = || -> Result<(), JsValue> {
        let document = web_sys::window().and_then(|w| w.document()).ok_or("no document")?;
        let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(png));
        let url = Url::create_object_url_with_blob(&Blob::new_with_u8_array_sequence(&parts)?)?;
        let link: HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
        link.set_href(&url);
        link.set_download(name);
        link.click();
        Url::revoke_object_url(&url)
    };
    offered().map_err(|e| format!("{name}: {e:?}"))
}

/// Opens the viewer on a canvas, with the view that a command line names (the page's address after `#`), or the one by default.
///
/// # Errors
/// One line: the view cannot be opened, or there is no adapter.
#[wasm_bindgen]
pub async fn start(canvas: HtmlCanvasElement, line: String) -> Result<(), JsValue> {
    console_error_panic_hook::set_once();
    eframe::WebLogger::init(log::LevelFilter::Warn).ok();
    let told = |error: &dyn std::fmt::Display| JsValue::from_str(&error.to_string());
    let view = if line.trim().is_empty() {
        View::first().map_err(|e| told(&e))?
    } else {
        View::of_line(&line).map_err(|e| told(&e))?
    };
    let (scene, _) = view.left.open(view.scene.as_deref()).map_err(|e| told(&e))?;
    let options = eframe::WebOptions { wgpu_options: configuration(), ..Default::default() };
    let create = move |created: &eframe::CreationContext<'_>| {
        let render = created.wgpu_render_state.as_ref().ok_or("no device")?;
        Ok(Box::new(Viewer::new(render, view, scene)) as Box<dyn eframe::App>)
    };
    eframe::WebRunner::new().start(canvas, options, Box::new(create)).await
}
