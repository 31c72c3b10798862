//! Work beside the window: scenes are opened and rays are traced on threads, or on a page, which has none, in its worker.

use crate::job::Job;
use lab::scene::{Camera, Files, Light, Scene, SceneOptions};
use oracle::truth::{SceneTruth, Tracer};
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};
use subpixel_shadows::Result;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::samples::{Pattern, Samples};

/// A scene, prepared for passes and rays.
#[derive(Debug)]
pub struct Opened {
    /// The scene. On a page its mesh stays in the worker: here it is empty.
    pub scene: Arc<Scene>,
    /// Its mesh as passes take it.
    pub prepared: Arc<Prepared>,
    /// One line on what of its file is not read.
    pub note: Option<String>,
    /// Traces it.
    pub rays: Rays,
}

/// The end of an opening: a scene, or one line on why there is none.
pub type Opening = std::result::Result<Opened, String>;

impl Opened {
    /// Prepares a scene that is open.
    ///
    /// # Errors
    /// As [`Scene::prepared`].
    #[cfg(not(target_family = "wasm"))]
    pub fn new(scene: Scene, note: Option<String>) -> Result<Self> {
        let prepared = Arc::new(scene.prepared()?);
        let scene = Arc::new(scene);
        Ok(Self { rays: Rays::of(&scene), scene, prepared, note })
    }

    /// Opens a scene beside the window: a built-in one or a file, also one of `files`.
    pub fn begin(context: &egui::Context, spec: &str, options: &SceneOptions, files: &Files) -> Job<Opening> {
        #[cfg(target_family = "wasm")]
        return Job::of(context, crate::web::open(spec.to_owned(), options.clone(), files.clone()));
        #[cfg(not(target_family = "wasm"))]
        {
            let (spec, options, files) = (spec.to_owned(), options.clone(), files.clone());
            Job::new(context, move || {
                let opened = Scene::open_among(&spec, &options, &files);
                opened.and_then(|(scene, note)| Self::new(scene, note)).map_err(|e| e.to_string())
            })
        }
    }
}

/// A view that is traced.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedView {
    /// The camera.
    pub camera: Camera,
    /// Points of the light.
    pub points: Vec<Light>,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// A mesh and, once rays were asked for, its tree.
#[derive(Clone, Debug)]
pub struct Rays {
    #[cfg(not(target_family = "wasm"))]
    here: Arc<TracedScene>,
    #[cfg(target_family = "wasm")]
    pub(crate) in_worker: Arc<crate::web::SceneInWorker>,
}

impl Rays {
    #[cfg(not(target_family = "wasm"))]
    fn of(scene: &Arc<Scene>) -> Self {
        Self { here: Arc::new(TracedScene::new(scene.clone())) }
    }

    /// Traces some pixels of a view beside the window, in rows from the top, beginning with pixel `first`: their visibility.
    pub fn trace(&self, context: &egui::Context, view: &TracedView, first: u32) -> Job<Traced> {
        #[cfg(target_family = "wasm")]
        return Job::of(context, crate::web::trace(self.in_worker.clone(), view.clone(), first));
        #[cfg(not(target_family = "wasm"))]
        {
            let (here, view) = (self.here.clone(), view.clone());
            Job::new(context, move || here.trace(&view, first))
        }
    }
}

/// Visibility of a run of pixels, or one line on why there is none.
pub type Traced = std::result::Result<Vec<f32>, String>;

/// A scene and the tree that its rays are traced in, where they are traced.
#[derive(Debug)]
pub struct TracedScene {
    scene: Arc<Scene>,
    tracer: OnceLock<std::result::Result<Tracer, String>>,
}

/// Longest that rays are traced before a run of pixels is told, milliseconds.
const SLICE: u128 = 100;
/// Pixels that are traced before the clock is looked at.
const RUN: u32 = if cfg!(target_family = "wasm") { 4 } else { 32 };

impl TracedScene {
    /// A scene without a tree.
    pub fn new(scene: Arc<Scene>) -> Self {
        Self { scene, tracer: OnceLock::new() }
    }

    /// Visibility by 1024 rays a pixel to each point of the light, of the pixels that could be traced in a tenth of a second, at least of some. The
    /// first call builds the tree.
    ///
    /// # Errors
    /// As [`Tracer::with_alpha`] and [`SceneTruth::new`], in one line.
    pub fn trace(&self, view: &TracedView, first: u32) -> Traced {
        let tree = || Tracer::with_alpha(&self.scene.mesh, &self.scene.alpha).map_err(|e| e.to_string());
        let tracer = self.tracer.get_or_init(tree).as_ref().map_err(Clone::clone)?;
        let TracedView { camera, points, size: [width, height] } = view;
        let one = Samples::new(Pattern::LowDiscrepancy, 1).map_err(|e| e.to_string())?;
        let truth = |light| SceneTruth::new(tracer, camera, light, &one, *width, *height);
        let truths = points.iter().map(truth).collect::<Result<Vec<_>>>().map_err(|e| e.to_string())?;
        let (share, run) = (1.0 / truths.len() as f32, (RUN / truths.len() as u32).max(1));
        let visible = |pixel| truths.iter().map(|truth| truth.converged_pixel(pixel).0 * share).sum::<f32>();
        let (start, all) = (web_time::Instant::now(), width * height);
        let mut traced: Vec<f32> = Vec::new();
        while first + (traced.len() as u32) < all {
            let at = first + traced.len() as u32;
            traced.par_extend((at..all.min(at + run)).into_par_iter().map(visible));
            if start.elapsed().as_millis() > SLICE {
                break;
            }
        }
        Ok(traced)
    }
}
