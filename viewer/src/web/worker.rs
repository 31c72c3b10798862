//! The page's worker, a second instance of this module: it opens scenes, prepares and traces them, and so the page's own thread is never held up
//! by that. [`open`] and [`trace`] are asked on the page, [`Worker`] answers.

use crate::beside::{Opened, Opening, Rays, Traced, TracedScene, TracedView};
use lab::options::{camera_text, light_text};
use lab::scene::{
    AlphaTested, Base, Camera, CameraOverride, Files, Ground, Lens, Mesh, Scene, SceneOptions, light_from_text,
};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::task::{Context, Poll, ready};
use subpixel_shadows::methods::Prepared;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

thread_local! {
    /// Asks the worker: the name of one of its functions and what it is given; a promise of the answer.
    static ASK: RefCell<Option<js_sys::Function>> = const { RefCell::new(None) };
}

/// Takes the function that asks the worker.
pub fn set_ask(ask: js_sys::Function) {
    ASK.set(Some(ask));
}

/// A scene that the worker keeps as long as this lives.
#[derive(Debug)]
pub struct SceneInWorker(u32);

impl Drop for SceneInWorker {
    fn drop(&mut self) {
        // A worker that has ended has forgotten it.
        let _ = ask("forget", [self.0.into()]);
    }
}

fn line_of(error: JsValue) -> String {
    let message = js_sys::Reflect::get(&error, &"message".into()).ok().and_then(|message| message.as_string());
    error.as_string().or(message).unwrap_or_else(|| format!("{error:?}"))
}

fn ask<const N: usize>(name: &str, given: [JsValue; N]) -> Result<js_sys::Promise, JsValue> {
    let ask = ASK.with_borrow(Clone::clone).ok_or("no worker")?;
    let given: js_sys::Array = given.into_iter().collect();
    ask.call2(&JsValue::NULL, &name.into(), &given)?.dyn_into()
}

/// A camera as a text, and its depth range.
fn told_camera(camera: &Camera) -> [JsValue; 3] {
    [camera_text(camera).into(), camera.near.into(), camera.far.into()]
}

/// The camera that [`told_camera`] tells of.
fn camera_of(text: &str, near: f32, far: f32) -> Option<Camera> {
    let CameraOverride { eye, target, up, fov, shift, pixel_aspect, mirrored, near_plane } = text.parse().ok()?;
    let lens = Lens {
        shift: shift.unwrap_or(Lens::CENTRED.shift),
        pixel_aspect: pixel_aspect.unwrap_or(Lens::CENTRED.pixel_aspect),
        mirrored: mirrored.unwrap_or(Lens::CENTRED.mirrored),
    };
    Some(Camera { eye: eye?, target: target?, up: up?, vertical_fov_degrees: fov?, near, far, lens, near_plane })
}

/// Lets the page do something else in between.
///
/// # Errors
/// There is no window.
pub async fn pause() -> Result<(), JsValue> {
    let window = web_sys::window().ok_or("no window")?;
    let mut failed = None;
    let pause = js_sys::Promise::new(&mut |done, _| failed = window.set_timeout_with_callback(&done).err());
    match failed {
        None => JsFuture::from(pause).await.map(drop),
        Some(error) => Err(error),
    }
}

/// Bytes in the page's memory, which are read piece by piece.
struct Pieces {
    bytes: js_sys::Uint8Array,
    /// The next one.
    at: u32,
    /// Bytes of the piece that are left.
    left: u32,
    /// Between pieces.
    pause: Pin<Box<dyn Future<Output = Result<(), JsValue>>>>,
}

/// Bytes of a piece.
const PIECE: u32 = 8 << 20;

impl futures::AsyncRead for Pieces {
    fn poll_read(mut self: Pin<&mut Self>, with: &mut Context, into: &mut [u8]) -> Poll<std::io::Result<usize>> {
        if self.left == 0 {
            ready!(self.pause.as_mut().poll(with)).map_err(|e| std::io::Error::other(line_of(e)))?;
            (self.left, self.pause) = (PIECE, Box::pin(pause()));
        }
        let count = self.left.min(self.bytes.length() - self.at).min(into.len() as u32);
        self.bytes.subarray(self.at, self.at + count).copy_to(&mut into[..count as usize]);
        self.at += count;
        self.left -= count;
        Poll::Ready(Ok(count as usize))
    }
}

/// Has a scene opened in the worker.
pub async fn open(spec: String, options: SceneOptions, files: Files) -> Opening {
    opened(&spec, options, &files).await.map_err(line_of)
}

async fn opened(spec: &str, options: SceneOptions, files: &Files) -> Result<Opened, JsValue> {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let SceneOptions { ground, camera, light } = options;
    let (names, contents) = (js_sys::Array::new(), js_sys::Array::new());
    for (path, bytes) in files.held() {
        names.push(&path.to_string_lossy().as_ref().into());
        contents.push(&js_sys::Uint8Array::from(bytes));
    }
    let camera = camera.map(|camera| camera.to_string());
    let light = light.as_ref().map(light_text);
    let given = [number.into(), spec.into(), ground.into(), camera.into(), light.into(), names.into(), contents.into()];
    let told: js_sys::Array = JsFuture::from(ask("open", given)?).await?.dyn_into()?;
    let in_worker = Arc::new(SceneInWorker(number));
    let text = |at| told.get(at).as_string().unwrap_or_default();
    let number = |at| told.get(at).as_f64().unwrap_or_default() as f32;
    let camera = camera_of(&text(HEAD.camera), number(HEAD.camera + 1), number(HEAD.camera + 2)).ok_or("no camera")?;
    let light = light_from_text(&text(HEAD.light)).map_err(|e| e.to_string())?;
    let ground = told.get(HEAD.ground).dyn_into::<js_sys::Float32Array>().ok().map(|g| g.to_vec());
    let ground = ground.and_then(|g| {
        let [y, half_width, x, z] = g[..] else { return None };
        Some(Ground { y, half_width, center: [x, z] })
    });
    let bytes = told.get(HEAD.bytes).dyn_into::<js_sys::Uint8Array>()?;
    let length = bytes.length();
    let pieces = Pieces { bytes, at: 0, left: 0, pause: Box::pin(async { Ok(()) }) };
    let prepared = Prepared::read(pieces, length.into()).await.map_err(|e| e.to_string())?;
    let base = match told.get(HEAD.builtin).as_string() {
        Some(name) => Base::Builtin(name),
        None => Base::Mesh(text(HEAD.mesh)),
    };
    let (name, note) = (text(HEAD.name), told.get(HEAD.note).as_string());
    let (mesh, alpha) = (Mesh::default(), AlphaTested::default());
    let scene = Scene { name, base, mesh, alpha, camera, light, ground };
    Ok(Opened { scene: Arc::new(scene), prepared: Arc::new(prepared), note, rays: Rays { in_worker } })
}

/// Has some pixels traced in the worker.
pub async fn trace(of: Arc<SceneInWorker>, view: TracedView, first: u32) -> Traced {
    let TracedView { camera, points, size: [width, height] } = view;
    let lights: js_sys::Array = points.iter().map(|light| JsValue::from(light_text(light))).collect();
    let [camera, near, far] = told_camera(&camera);
    let given = [of.0.into(), camera, near, far, lights.into(), width.into(), height.into(), first.into()];
    let traced = || Ok::<_, JsValue>(JsFuture::from(ask("trace", given)?));
    let told = match traced() {
        Ok(told) => told.await,
        Err(error) => Err(error),
    };
    let told = told.and_then(|told| Ok(told.dyn_into::<js_sys::Float32Array>()?.to_vec()));
    told.map_err(line_of)
}

/// Scenes in the worker.
#[wasm_bindgen]
#[derive(Default)]
pub struct Worker(BTreeMap<u32, TracedScene>);

#[wasm_bindgen]
impl Worker {
    /// A worker without scenes.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self::default()
    }

    /// Opens a scene and keeps it under a number: all but its mesh, as [`HEAD`] says, and its prepared mesh as bytes.
    ///
    /// # Errors
    /// One line: why it cannot be opened.
    #[expect(clippy::too_many_arguments, reason = "what a message can hold")]
    pub fn open(
        &mut self,
        number: u32,
        spec: &str,
        ground: bool,
        camera: Option<String>,
        light: Option<String>,
        names: Vec<String>,
        contents: Vec<js_sys::Uint8Array>,
    ) -> Result<js_sys::Array, JsValue> {
        let said = |error: subpixel_shadows::Error| JsValue::from(error.to_string());
        let mut files = Files::default();
        for (name, bytes) in names.into_iter().zip(contents) {
            files.hold(name, bytes.to_vec());
        }
        let camera = camera.map(|text| text.parse()).transpose().map_err(said)?;
        let light = light.as_deref().map(light_from_text).transpose().map_err(said)?;
        let options = SceneOptions { ground, camera, light };
        let (scene, note) = Scene::open_among(spec, &options, &files).map_err(said)?;
        let prepared = scene.prepared().map_err(said)?;
        let bytes = js_sys::Uint8Array::from(&prepared.to_bytes()[..]);
        let (builtin, mesh) = match &scene.base {
            Base::Builtin(name) => (JsValue::from(name), JsValue::NULL),
            Base::Mesh(path) => (JsValue::NULL, JsValue::from(path)),
        };
        let [camera, near, far] = told_camera(&scene.camera);
        let (name, light) = (JsValue::from(&scene.name), JsValue::from(light_text(&scene.light)));
        let ground = scene.ground.map_or(JsValue::NULL, |Ground { y, half_width, center: [x, z] }| {
            js_sys::Float32Array::from(&[y, half_width, x, z][..]).into()
        });
        let head = [name, builtin, mesh, camera, near, far, light, ground, note.into(), bytes.into()];
        self.0.insert(number, TracedScene::new(Arc::new(scene)));
        Ok(head.into_iter().collect())
    }

    /// Traces some pixels of a view: their visibility.
    ///
    /// # Errors
    /// One line: why they cannot be traced.
    #[expect(clippy::too_many_arguments, reason = "what a message can hold")]
    pub fn trace(
        &self,
        number: u32,
        camera: &str,
        near: f32,
        far: f32,
        lights: Vec<String>,
        width: u32,
        height: u32,
        first: u32,
    ) -> Result<js_sys::Float32Array, JsValue> {
        let scene = self.0.get(&number).ok_or("the worker has ended: open the scene again")?;
        let camera = camera_of(camera, near, far).ok_or("no camera")?;
        let points = lights.iter().map(|light| light_from_text(light)).collect::<subpixel_shadows::Result<_>>();
        let points = points.map_err(|e| e.to_string())?;
        let traced = scene.trace(&TracedView { camera, points, size: [width, height] }, first)?;
        Ok(js_sys::Float32Array::from(&traced[..]))
    }

    /// Forgets a scene.
    pub fn forget(&mut self, number: u32) {
        self.0.remove(&number);
    }
}

/// Places in what [`Worker::open`] answers.
struct Head {
    name: u32,
    builtin: u32,
    mesh: u32,
    /// Its text, near and far.
    camera: u32,
    light: u32,
    ground: u32,
    note: u32,
    bytes: u32,
}

const HEAD: Head = Head { name: 0, builtin: 1, mesh: 2, camera: 3, light: 6, ground: 7, note: 8, bytes: 9 };
