//! Where a frame is computed: on an adapter, or on the CPU.

use super::args::{EngineName, Options};
use super::progress::Console;
use rayon::prelude::*;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::facet_masks::FacetMode;
use subpixel_shadows::methods::render::{Counts, Output, Renderer};
use subpixel_shadows::methods::{AnyRenderer, Looks, MethodName, PixelClass, Prepared, unshadowed};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::report::FacetSet;
use subpixel_shadows::scene::Scene;
use subpixel_shadows::truth::{FacetInput, FacetTruth, SceneTruth, Tracer, full_mask, join_mask, split_mask};
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
    pub looks: Option<Looks>,
}

impl Engine {
    /// The engine that is asked for; without an adapter, and if none was asked for, the CPU.
    pub fn open(options: &Options, console: Console) -> Result<Self> {
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

    /// Why the engine runs none of the stages, if so.
    pub fn no_stages(&self) -> Option<&'static str> {
        match self {
            Self::Gpu(_) => None,
            Self::Cpu => Some("CPU engine: each facet is held against the casters directly, in f64"),
        }
    }

    /// Name and graphics API of the adapter.
    pub fn adapter(&self) -> (String, String) {
        match self {
            Self::Gpu(gpu) => (gpu.adapter.name.clone(), gpu.adapter.backend.clone()),
            Self::Cpu => (format!("CPU, {} threads", rayon::current_num_threads()), "none".to_owned()),
        }
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

    /// Renders one frame as planned.
    pub fn render(
        &self,
        options: &Options,
        plan: &Plan,
        scene: &Scene,
        prepared: &Prepared,
        console: Console,
    ) -> Result<Rendered> {
        let settings = &plan.settings;
        let words = settings.samples.words();
        let [classes, _] = options.method.keeps();
        match (plan.extent, self) {
            (Extent::Nothing, _) => {
                let looks = Looks { classes: vec![PixelClass::Empty; settings.pixels()], map: None };
                Ok(Rendered {
                    output: unshadowed::nothing_seen(settings),
                    facets: Some(FacetSet { words, ..FacetSet::default() }),
                    looks: (options.looks && classes).then_some(looks),
                })
            }
            (Extent::Facing, Self::Gpu(gpu)) => {
                let (output, facets) = unshadowed::render(gpu, prepared, settings, &scene.camera, &scene.light)?;
                let looks = || Looks::of_unshadowed(gpu, &facets, settings.pixels());
                let looks = (options.looks && classes).then(looks).transpose()?;
                let facets = options.truth.then(|| FacetSet::read(gpu, &facets, words)).transpose()?;
                Ok(Rendered { output, facets, looks })
            }
            (Extent::Everything, Self::Gpu(gpu)) if options.method != MethodName::FacetMasks => {
                let mut renderer = AnyRenderer::new(gpu, prepared, options.method, settings, options.budget())?;
                let (output, looks) = if options.looks {
                    renderer.render_and_look(&scene.camera, &scene.light)?
                } else {
                    (renderer.render(&scene.camera, &scene.light)?, None)
                };
                Ok(Rendered { output, facets: None, looks })
            }
            (Extent::Everything, Self::Gpu(gpu)) => {
                let mut renderer = Renderer::new(gpu, prepared, settings, options.budget())?;
                let (mut facets, mut looks) = (None, options.looks.then(Looks::default));
                let width = settings.size[0];
                let output = renderer.render_and(&scene.camera, &scene.light, &mut |method, rows| {
                    if rows.first == 0 {
                        facets = options.truth.then(FacetSet::default);
                    }
                    looks.as_mut().map_or(Ok(()), |looks| looks.add_rows(gpu, method, width, rows))?;
                    facets.as_mut().map_or(Ok(()), |set| set.add(gpu, method.facets(), words, width, rows))
                })?;
                if renderer.strips() > 1 {
                    console.note(&format!(
                        "rendered in {} strips of rows, as one binding holds no more",
                        renderer.strips()
                    ));
                }
                Ok(Rendered { output, facets, looks })
            }
            (_, Self::Cpu) if options.method != MethodName::FacetMasks => {
                let name = options.method.name();
                Err(Error::Config(format!("method {name} on the CPU engine, which has facet-masks only")))
            }
            (_, Self::Cpu) => {
                let output = on_the_cpu(plan, scene, prepared, console)?;
                Ok(Rendered { output, facets: None, looks: None })
            }
        }
    }
}

/// The model of the method from its definition in `f64`: one facet with a full mask for the triangle at each centre.
fn on_the_cpu(plan: &Plan, scene: &Scene, prepared: &Prepared, console: Console) -> Result<Output> {
    let start = std::time::Instant::now();
    let settings = &plan.settings;
    let ([w, h], samples) = (settings.size, &settings.samples);
    let tracer = Tracer::new(&prepared.mesh)?;
    let rays = scene.camera.rays(w, h);
    let near = f64::from(scene.camera.near);
    let triangles: Vec<u32> = (0..w * h)
        .into_par_iter()
        .map(|p| {
            let r = rays.direction(f64::from(p % w) + 0.5, f64::from(p / w) + 0.5);
            tracer.closest(rays.eye, r, near).map_or(u32::MAX, |hit| hit.triangle)
        })
        .collect();
    let coverage = split_mask(full_mask(samples.count()));
    let facets: Vec<FacetInput> = match settings.facets {
        FacetMode::One => (0..w * h)
            .zip(&triangles)
            .filter(|(_, t)| **t != u32::MAX)
            .map(|(pixel, &triangle)| FacetInput { pixel, triangle, coverage })
            .collect(),
        FacetMode::All => {
            let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, samples, w, h)?;
            let of = |pixel| {
                let surfaces = truth.surfaces(pixel).into_iter();
                surfaces.map(move |(triangle, coverage)| FacetInput { pixel, triangle, coverage })
            };
            (0..w * h).into_par_iter().flat_map_iter(of).collect()
        }
    };
    let mut truth = FacetTruth::new(&tracer, &scene.camera, &scene.light, samples, w, h)?;
    if !settings.validity {
        truth = truth.without_validity();
    }
    let task = console.task("CPU engine");
    let judged = truth.judge(&facets, Some(&|done, total| task.at(done, total)))?;
    drop(task);
    let words = samples.words() as usize;
    let mut output = unshadowed::nothing_seen(settings);
    let mut seen_of = vec![(0u32, 0u128); triangles.len()];
    for (facet, result) in facets.iter().zip(&judged) {
        let (valid, occluded) = (join_mask(result.valid), join_mask(result.occluded));
        let (seen, lit) = (valid.count_ones(), valid & !occluded);
        let p = facet.pixel as usize;
        let all = &mut seen_of[p];
        *all = (all.0 + seen, all.1 | lit);
        if all.0 > 0 {
            output.visibility[p] = all.1.count_ones() as f32 / all.0 as f32;
            output.lit[p * words..(p + 1) * words].copy_from_slice(&split_mask(all.1)[..words]);
        }
    }
    let seen = facets.len() as u64;
    let counts = Counts {
        silhouette_pixels: seen,
        empty_facets: triangles.iter().filter(|&&t| t == u32::MAX).count() as u64,
        ..Counts::default()
    };
    Ok(Output { triangles, counts, wall_ms: start.elapsed().as_secs_f64() * 1e3, ..output })
}
