//! Where a frame is computed: on an adapter, or on the CPU.

use super::progress::Console;
use super::repeat::timed;
use lab::options::{EngineName, FacetsPerPixel, RenderOptions};
use lab::report::FacetSet;
use lab::scene::Scene;
use oracle::engine::{self, CpuRays, CpuTime, RAYS};
use serde_json::{Map, Value};
use std::time::{Duration, Instant};
use subpixel_shadows::gpu::{BufferMemory, Gpu, KeptPrograms};
use subpixel_shadows::light_view::OmniMaps;
use subpixel_shadows::methods::strip_method::StripMethod;
use subpixel_shadows::methods::{DebugViews, MethodName, PixelClass, Prepared};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::{Output, Renderer, Rows};
use subpixel_shadows::scene::Light;
use subpixel_shadows::{Error, Result};

/// Where frames are computed.
pub enum Engine {
    Gpu(Box<Gpu>),
    Cpu,
}

/// A frame; its facets where the engine keeps them, and what there is to look at, if they were asked for.
pub struct Rendered {
    pub output: Output,
    pub facets: Option<FacetSet>,
    pub looks: Option<DebugViews>,
    /// The stages that ran on the CPU; `None` on a GPU.
    pub cpu_stages: Option<Vec<CpuTime>>,
    /// Buffers of the device that the frames took, the largest first; none on the CPU.
    pub memory: Vec<BufferMemory>,
    /// Frames whose median time each time is; 0 where nothing ran, or no time was asked for.
    pub timed_frames: u32,
    /// How long it took from the call to the begin of the first of these: memory, pipelines, and a frame that is not timed. Reading back
    /// `looks` is left out.
    pub setup: Duration,
}

impl Engine {
    /// The engine that is asked for; without an adapter, and if none was asked for, the CPU.
    pub fn open(options: &RenderOptions, console: Console) -> Result<Self> {
        if options.engine == Some(EngineName::Cpu) {
            return Ok(Self::Cpu);
        }
        match Gpu::open(options.adapter.as_deref()) {
            Ok(gpu) => Ok(Self::Gpu(Box::new(gpu))),
            Err(Error::NoAdapter(reason)) if options.engine.is_none() && options.adapter.is_none() => {
                console
                    .note(&format!("no adapter ({reason}): computing on the CPU; ./test.sh installs a software one"));
                Ok(Self::Cpu)
            }
            Err(error) => Err(error),
        }
    }

    /// `gpu` or `cpu`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Gpu(_) => "gpu",
            Self::Cpu => "cpu",
        }
    }

    /// Name and graphics API of the adapter.
    pub fn adapter(&self) -> (String, String) {
        match self {
            Self::Gpu(gpu) => (gpu.adapter.name.clone(), gpu.adapter.backend.clone()),
            Self::Cpu => (format!("CPU, {} threads", rayon::current_num_threads()), "none".to_owned()),
        }
    }

    /// The settings of a frame that was made here, as its frame.json records them.
    pub fn recorded(&self, options: &RenderOptions, scene: &Scene) -> Map<String, Value> {
        options.recorded(scene, self.name(), matches!(self, Self::Gpu(_)).then(|| self.adapter().0).into())
    }

    /// The adapter as the table shows it.
    pub fn describe(&self) -> String {
        let (name, backend) = self.adapter();
        match self {
            Self::Gpu(gpu) if gpu.adapter.software => format!("{name}, {backend}, software: it runs on the CPU"),
            Self::Gpu(_) => format!("{name}, {backend}"),
            Self::Cpu => format!("{name}: CPU engine, no GPU is used"),
        }
    }

    /// Renders a frame as planned, and as many more as are to be timed.
    pub fn render(
        &self,
        options: &RenderOptions,
        frames: u32,
        plan: &Plan,
        (scene, points): (&Scene, &[Light]),
        prepared: &Prepared,
        console: Console,
    ) -> Result<Rendered> {
        let several = points.len() > 1;
        let (start, mut aside) = (Instant::now(), Duration::ZERO);
        let settings = &plan.settings;
        let words = settings.samples.words();
        let [classes, _] = options.method.keeps();
        match (plan.extent, self) {
            (Extent::Nothing, _) => {
                let looks = DebugViews { classes: vec![PixelClass::Empty; settings.pixels()], ..DebugViews::default() };
                Ok(Rendered {
                    output: Output::nothing_seen(settings),
                    facets: Some(FacetSet { words, ..FacetSet::default() }),
                    looks: (options.looks && classes).then_some(looks),
                    cpu_stages: matches!(self, Self::Cpu).then(Vec::new),
                    memory: Vec::new(),
                    timed_frames: 0,
                    setup: start.elapsed(),
                })
            }
            (_, Self::Gpu(gpu)) => {
                let (camera, width) = (&scene.camera, settings.size[0]);
                let mut renderer = {
                    let task = console.task("compiling");
                    let programs = KeptPrograms::default().telling(move |done, of| task.at(done, of));
                    programs.within(|| Renderer::of_plan(gpu, prepared, options.method, plan, options.budget()))?
                };
                let of_facets = plan.extent == Extent::Facing || options.method == MethodName::FacetMasks;
                let looked = options.looks && (classes || plan.extent == Extent::Everything);
                let (mut facets, mut looks) = (None, looked.then(DebugViews::default));
                let mut look = |method: &StripMethod, rows: Rows| {
                    let start = Instant::now();
                    if rows.first == 0 {
                        facets = (options.truth && method.facets().is_some()).then(FacetSet::default);
                    }
                    looks.as_mut().map_or(Ok(()), |looks| looks.add_rows(gpu, method, width, rows))?;
                    facets.as_mut().map_or(Ok(()), |set| match of_facets {
                        true => set.add(gpu, method.facets(), words, width, rows),
                        false => FacetSet::read(gpu, method.facets(), words).map(|read| *set = read),
                    })?;
                    aside += start.elapsed();
                    Ok(())
                };
                let output = match points {
                    [light] => renderer.render_and(camera, light, &mut look)?,
                    _ => renderer.render_mean(camera, points)?,
                };
                let setup = start.elapsed().saturating_sub(aside);
                let (parts, views) = (renderer.parts(), renderer.views());
                if parts.across() > 1 {
                    console.note(&format!(
                        "the light's map in {0} x {0} parts of {1} x {1} texels, as one binding holds no more",
                        parts.across(),
                        parts.texels()
                    ));
                }
                if views > 1 {
                    let why = match settings.partition {
                        _ if settings.omni == OmniMaps::Paraboloids => "paraboloids around the light",
                        Some(_) => "in slices of what the camera sees, or around a light among its casters",
                        None => "the light stands among its casters",
                    };
                    console.note(&format!("{why}: {views} views of the light, one after the other"));
                }
                if renderer.strips() > 1 {
                    console.note(&format!(
                        "rendered in {} strips of rows, as one binding holds no more",
                        renderer.strips()
                    ));
                }
                let looks = looks.filter(|looks| *looks != DebugViews::default());
                let (output, timed_frames) = timed(output, frames, || renderer.render_mean(camera, points))?;
                let memory = renderer.memory();
                Ok(Rendered { output, facets, looks, cpu_stages: None, memory, timed_frames, setup })
            }
            (_, Self::Cpu) if options.method == MethodName::RayTraced && options.facets == FacetsPerPixel::One => {
                let text = "ray-traced on the CPU engine: every sample has the surface that it sees (--facets all)";
                Err(Error::Config(text.to_owned()))
            }
            (_, Self::Cpu) if options.method == MethodName::RayTraced => {
                let rays = CpuRays::new(prepared)?;
                let task = console.task("CPU rays");
                let progress = |done, total| task.at(done, total);
                let render = || mean(points, |light| rays.render(settings, &scene.camera, light, Some(&progress)));
                let first = render()?;
                let setup = start.elapsed();
                let (output, timed_frames) = timed(first, frames, render)?;
                let cpu_stages = Some(vec![CpuTime { name: RAYS, ms: output.wall_ms }]);
                Ok(Rendered { output, facets: None, looks: None, cpu_stages, memory: Vec::new(), timed_frames, setup })
            }
            (_, Self::Cpu) if options.method != MethodName::FacetMasks => {
                let name = options.method.name();
                Err(Error::Config(format!("method {name} on the CPU engine, which has facet-masks and ray-traced")))
            }
            (_, Self::Cpu) => {
                // Nothing is compiled here, but the first view of all makes the tree of the mesh.
                settings.light_view(prepared, &points[0])?;
                let setup = start.elapsed();
                let task = console.task("CPU engine");
                let progress = |done, total| task.at(done, total);
                let request = engine::CpuRequest {
                    unshadowed: plan.extent == Extent::Facing,
                    facets: options.truth && !several,
                    looks: options.looks,
                    progress: Some(&progress),
                };
                let (mut last, mut stages) = (None, Vec::<CpuTime>::new());
                let output = mean(points, |light| {
                    let mut frame = engine::render(prepared, settings, &scene.camera, light, request)?;
                    for more in std::mem::take(&mut frame.stages) {
                        match stages.iter_mut().find(|stage| stage.name == more.name) {
                            Some(stage) => stage.ms += more.ms,
                            None => stages.push(more),
                        }
                    }
                    let output = frame.output.clone();
                    last = Some(frame);
                    Ok(output)
                })?;
                let (facets, looks) = last.map_or_else(Default::default, |frame| (frame.facets, frame.looks));
                let facets = (options.truth && !several).then(|| FacetSet::of_cpu(&facets, words));
                let cpu_stages = Some(stages);
                Ok(Rendered { output, facets, looks, cpu_stages, memory: Vec::new(), timed_frames: 1, setup })
            }
        }
    }
}

/// The mean over points of a light: its visibility. Times add up, the rest is of the last.
fn mean(points: &[Light], mut render: impl FnMut(&Light) -> Result<Output>) -> Result<Output> {
    let mut all: Option<Output> = None;
    for light in points {
        let mut own = render(light)?;
        if let Some(before) = all {
            own.visibility.iter_mut().zip(&before.visibility).for_each(|(sum, more)| *sum += more);
            own.wall_ms += before.wall_ms;
        }
        all = Some(own);
    }
    let mut all = all.ok_or_else(|| Error::Config("a light without points".to_owned()))?;
    all.visibility.iter_mut().for_each(|sum| *sum /= points.len() as f32);
    Ok(all)
}
