//! Passes that are being made: on a thread, or on a page, which has none, step by step between its frames.

use crate::half::Gpu;
use crate::job::Job;
use lab::options::RenderOptions;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use subpixel_shadows::gpu::KeptPrograms;
use subpixel_shadows::methods::Settings;
use subpixel_shadows::pass::{Casters, PassConfig, UploadedCasters};
use subpixel_shadows::{Result, ShadowPass};

/// Options of a pass: of a method, of its image, and whether its pixels are counted.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// Method, settings and size.
    pub options: RenderOptions,
    /// Whether its pixels are counted.
    pub counted: bool,
    /// The casters.
    pub casters: UploadedCasters,
}

impl Wanted {
    /// Hands over the configuration of the pass, whose pipelines are kept in `programs`.
    fn with<T>(&self, programs: &KeptPrograms, work: impl FnOnce(&PassConfig) -> Result<T>) -> Result<T> {
        let options = &self.options;
        let settings = Settings { settle: !options.force_all, count_pixels: self.counted, ..options.settings()? };
        work(&PassConfig {
            method: options.method,
            budget: options.budget(),
            timing: true,
            prove: !options.force_all,
            programs: Some(programs),
            ..PassConfig::new(settings, Casters::Uploaded(&self.casters))
        })
    }

    fn make(&self, gpu: &Gpu, programs: &KeptPrograms) -> Result<ShadowPass> {
        self.with(programs, |config| ShadowPass::new(&gpu.device, &gpu.queue, config))
    }
}

/// A pass that is being made.
pub struct Making {
    /// Pipelines that are compiled, and of how many.
    compiled: Arc<[AtomicUsize; 2]>,
    #[cfg(not(target_family = "wasm"))]
    made: Job<Result<ShadowPass>>,
    #[cfg(target_family = "wasm")]
    wanted: (Gpu, Wanted),
    #[cfg(target_family = "wasm")]
    made: Option<Job<Result<()>>>,
}

impl Making {
    /// Begins, on a page when it is first asked for.
    pub fn new(gpu: &Gpu, wanted: Wanted) -> Self {
        let compiled: Arc<[AtomicUsize; 2]> = Arc::default();
        #[cfg(target_family = "wasm")]
        return Self { compiled, wanted: (gpu.clone(), wanted), made: None };
        #[cfg(not(target_family = "wasm"))]
        {
            let (gpu, told) = (gpu.clone(), compiled.clone());
            let made = Job::new(&gpu.context.clone(), move || {
                let programs = gpu.programs.clone().telling(move |done, of| {
                    told[0].store(done, Ordering::Relaxed);
                    told[1].store(of, Ordering::Relaxed);
                });
                wanted.make(&gpu, &programs)
            });
            Self { compiled, made }
        }
    }

    /// Pipelines that are compiled, and of how many.
    pub fn progress(&self) -> [usize; 2] {
        [0, 1].map(|k| self.compiled[k].load(Ordering::Relaxed))
    }

    /// The pass, once.
    pub fn take(&mut self) -> Option<Result<ShadowPass>> {
        #[cfg(not(target_family = "wasm"))]
        return self.made.take();
        #[cfg(target_family = "wasm")]
        {
            let (gpu, wanted) = &self.wanted;
            let compile = || Job::of(&gpu.context, compile(gpu.clone(), wanted.clone(), self.compiled.clone()));
            Some(self.made.get_or_insert_with(compile).take()?.and_then(|()| wanted.make(gpu, &gpu.programs)))
        }
    }
}

/// Has the pipelines of a pass compiled: asks for a few at a time, and waits for those that the page compiles beside.
#[cfg(target_family = "wasm")]
async fn compile(gpu: Gpu, wanted: Wanted, told: Arc<[AtomicUsize; 2]>) -> Result<()> {
    let begin = |config: &PassConfig| ShadowPass::compile_in_steps(&gpu.device, &gpu.queue, config);
    let mut pipelines = wanted.with(&gpu.programs, begin)?;
    while !pipelines.advance(ASKED)? {
        // A page that cannot wait goes on at once.
        let _ = crate::web::pause().await;
    }
    let (_, of) = pipelines.progress();
    told[1].store(of, Ordering::Relaxed);
    let mut given = None;
    // Of a page that does not tell, the first frame waits for them.
    while let Ok(to_come) = crate::web::uncompiled(given).await {
        let left = to_come.length() as usize;
        told[0].store(of.saturating_sub(left), Ordering::Relaxed);
        if left == 0 {
            break;
        }
        gpu.context.request_repaint_after(PROGRESS);
        given = Some(to_come);
    }
    Ok(())
}

/// Pipelines that are asked for in one task.
#[cfg(target_family = "wasm")]
const ASKED: usize = 4;
/// Time after which progress is drawn.
#[cfg(target_family = "wasm")]
const PROGRESS: std::time::Duration = std::time::Duration::from_millis(1000);
