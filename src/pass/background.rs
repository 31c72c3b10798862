//! Pipelines that are made while the application goes on.

use super::checks::settled;
use super::{CasterMesh, CasterPart, Casters, PassConfig, ShadowPass};
use crate::gpu::kept::Uncompiled;
use crate::methods::{MethodName, Settings};
use crate::{Error, Result};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;

/// Pipelines of a pass that are being made ([`ShadowPass::compile`]). Dropped, it lets a thread that it has go on to its end.
#[derive(Debug)]
pub struct Compiling {
    work: Work,
    /// Pipelines that are made, and that there are to make.
    told: Arc<[AtomicUsize; 2]>,
}

#[derive(Debug)]
enum Work {
    Thread(JoinHandle<Result<()>>),
    Steps(Uncompiled),
    Done,
}

/// A triangle, in the place of casters.
const POSITIONS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
const TRIANGLES: [[u32; 3]; 1] = [[0, 1, 2]];

/// Runs `work` with a configuration that needs the same pipelines and next to no memory.
fn with_stand_in<T>(config: &PassConfig, work: impl FnOnce(&PassConfig) -> T) -> T {
    let (positions, triangles): (&[_], &[_]) = (&POSITIONS, &TRIANGLES);
    let meshes = [CasterMesh::new(positions, triangles)];
    let parts = [CasterPart::standing(meshes[0])];
    let kind = match &config.casters {
        Casters::AlphaTested { casters, .. } => casters,
        casters => casters,
    };
    let casters = match kind {
        Casters::Moving { .. } => Casters::Moving { rest: positions, triangles },
        Casters::Instanced { .. } => Casters::Instanced { meshes: &meshes, instances: &[0] },
        Casters::Parts { .. } => Casters::Parts { parts: &parts, room: 0 },
        _ => Casters::Static { positions, triangles },
    };
    let of = &config.settings;
    let map = if config.method == MethodName::FacetMasks { of.map.min(64) } else { of.map };
    let alpha_tested = of.alpha_tested || config.casters.are_tested();
    let settings = Settings { size: [8, 8], map, alpha_tested, ..of.clone() };
    work(&PassConfig { settings, casters, ..config.clone() })
}

impl ShadowPass {
    /// Begins to make the pipelines of a pass and keeps them in the configuration's store ([`PassConfig::programs`]): [`ShadowPass::new`] with it compiles
    /// nothing once they are all there. Casters and image size are not read, and may come later.
    ///
    /// A thread compiles them, on all cores; in a browser, which has none, [`Compiling::advance`] does.
    ///
    /// # Errors
    /// [`Error::Config`] without a store, and for settings that cannot be; in a browser as [`ShadowPass::new`].
    pub fn compile(device: &wgpu::Device, queue: &wgpu::Queue, config: &PassConfig) -> Result<Compiling> {
        if cfg!(target_family = "wasm") {
            return Self::compile_in_steps(device, queue, config);
        }
        let programs = store_of(config)?;
        let told: Arc<[AtomicUsize; 2]> = Arc::default();
        let hears = told.clone();
        let store = programs.also_telling(move |done, of| {
            hears[1].store(of, Ordering::Relaxed);
            hears[0].fetch_max(done, Ordering::Relaxed);
        });
        let (device, queue) = (device.clone(), queue.clone());
        // Casters stay here.
        let PassConfig { settings, method, receivers, keep_last, .. } = config.clone();
        let moving = kind_of(&config.casters);
        let alpha_tested = settings.alpha_tested || config.casters.are_tested();
        let settings = Settings { alpha_tested, ..settings };
        let work = move || {
            let config = PassConfig { method, receivers, keep_last, ..PassConfig::new(settings, moving) };
            let config = PassConfig { programs: Some(&store), ..config };
            with_stand_in(&config, |config| Self::new(&device, &queue, config)).map(drop)
        };
        let thread = std::thread::Builder::new().name("shadow pipelines".to_owned()).spawn(work);
        let thread = thread.map_err(|e| Error::Gpu(format!("no thread to compile pipelines: {e}")))?;
        Ok(Compiling { work: Work::Thread(thread), told })
    }

    /// The same without a thread: [`Compiling::advance`] compiles, as many at a time as it is told. Kernels are read at once.
    ///
    /// # Errors
    /// As [`ShadowPass::new`]; [`Error::Config`] without a store.
    pub fn compile_in_steps(device: &wgpu::Device, queue: &wgpu::Queue, config: &PassConfig) -> Result<Compiling> {
        let programs = store_of(config)?;
        let make = || {
            let stand_in = |config: &PassConfig| Self::new(device, queue, config).map(drop);
            with_stand_in(&PassConfig { programs: Some(&programs), ..config.clone() }, stand_in)
        };
        let (made, list) = Uncompiled::of(make);
        made?;
        let told = Arc::new([AtomicUsize::new(0), AtomicUsize::new(list.len())]);
        Ok(Compiling { work: Work::Steps(list), told })
    }
}

/// Casters of the same kind, without any.
fn kind_of(casters: &Casters) -> Casters<'static> {
    match casters {
        Casters::AlphaTested { casters, .. } => kind_of(casters),
        Casters::Moving { .. } => Casters::Moving { rest: &[], triangles: &[] },
        Casters::Instanced { .. } => Casters::Instanced { meshes: &[], instances: &[] },
        Casters::Parts { .. } => Casters::Parts { parts: &[], room: 0 },
        Casters::Static { .. } | Casters::Prepared(_) | Casters::Uploaded(_) => {
            Casters::Static { positions: &[], triangles: &[] }
        }
    }
}

fn store_of(config: &PassConfig) -> Result<crate::gpu::KeptPrograms> {
    settled(&config.settings, config.method).check()?;
    let none =
        || Error::Config("pipelines to come are kept in a store: the configuration has no `programs`".to_owned());
    config.programs.cloned().ok_or_else(none)
}

impl Compiling {
    /// Pipelines that are made, and of how many; of none before it is known.
    pub fn progress(&self) -> (usize, usize) {
        (self.told[0].load(Ordering::Relaxed), self.told[1].load(Ordering::Relaxed))
    }

    /// Whether all are made. Where no thread makes them, makes up to `most` of them first; else it takes no time.
    ///
    /// # Errors
    /// As [`ShadowPass::new`], once.
    pub fn advance(&mut self, most: usize) -> Result<bool> {
        match &mut self.work {
            Work::Steps(list) => {
                self.told[0].fetch_add(list.compile(most), Ordering::Relaxed);
                if list.is_empty() {
                    self.work = Work::Done;
                }
            }
            Work::Thread(thread) if thread.is_finished() => return self.join().map(|()| true),
            Work::Thread(_) | Work::Done => {}
        }
        Ok(matches!(self.work, Work::Done))
    }

    /// Waits for all of them.
    ///
    /// # Errors
    /// As [`Compiling::advance`].
    pub fn finish(mut self) -> Result<()> {
        self.advance(usize::MAX)?;
        self.join()
    }

    fn join(&mut self) -> Result<()> {
        let Work::Thread(thread) = std::mem::replace(&mut self.work, Work::Done) else { return Ok(()) };
        thread.join().unwrap_or_else(|_| Err(Error::Gpu("the thread that compiles pipelines has panicked".to_owned())))
    }
}
