//! Each request for memory refused once, in turn: of a renderer and of a pass that takes casters and sizes and whose lists grow.

use lab::scene::Scene;
use std::sync::Arc;
use std::time::{Duration, Instant};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::gpu::faults::{Refusal, asked_here, is_pending, refuse};
use subpixel_shadows::methods::facet_masks::Pipelines;
use subpixel_shadows::methods::{FacetMode, Prepared, Settings};
use subpixel_shadows::pass::{Casters, Inputs, PassConfig, Target};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result, ShadowPass, wgpu};

/// The two sizes that a pass goes through.
const SIZES: [[u32; 2]; 2] = [[24, 18], [32, 20]];

/// The outcome of one scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told {
    /// Requests of an untroubled run.
    pub asked: u64,
    /// Those that were refused, one in a run.
    pub refused: u64,
    /// Of these, those that the pass went around (by more strips of rows, or by lists that stay as they are), so that there was no error.
    pub absorbed: u64,
}

/// A run: words of its pictures, and the error there was, if any.
type Run = (Vec<u32>, Option<String>);

fn settings(facets: FacetMode) -> Result<Settings> {
    Ok(Settings { facets, ..Settings::new(SIZES[0], 16, Samples::new(Pattern::LowDiscrepancy, 8)?) })
}

/// Does `work`, once more if memory was refused to it, and keeps what was said then.
fn insisting<T>(said: &mut Option<String>, mut work: impl FnMut() -> Result<T>) -> Result<T> {
    match work() {
        Err(error @ (Error::Gpu(_) | Error::Memory { .. })) if said.is_none() => {
            *said = Some(error.to_string());
            work()
        }
        other => other,
    }
}

/// Refuses every `step`th request of a run, from `first` on, and compares with a run that is refused nothing. Says where it is every minute:
/// a run of a large scene takes seconds, and there are hundreds.
fn each(first: u64, step: u64, refusal: Refusal, mut run: impl FnMut() -> Result<Run>) -> Result<Told> {
    let wrong = |text: String| Err(Error::Config(text));
    // What pipelines keep is made in the first run alone.
    run()?;
    let before = asked_here();
    let (want, none) = run()?;
    let asked = asked_here() - before;
    if let Some(error) = none {
        return wrong(format!("an error without a cause: {error}"));
    }
    let mut told = Told { asked, ..Told::default() };
    let mut said_at = Instant::now();
    for n in (first..asked).step_by(step as usize) {
        if said_at.elapsed() > Duration::from_secs(60) {
            said_at = Instant::now();
            eprintln!("request {n} of {asked}, from {first} on: {} refused, {} absorbed", told.refused, told.absorbed);
        }
        refuse(n, Some(refusal));
        let ran = run();
        let pending = is_pending();
        refuse(0, None);
        let (got, said) = ran.map_err(|e| Error::Config(format!("request {n} of {asked}: a second error: {e}")))?;
        if pending {
            continue;
        }
        told.refused += 1;
        match &said {
            None => told.absorbed += 1,
            Some(text) if refusal == Refusal::Device && !text.contains("out of memory allocating '") => {
                return wrong(format!("request {n} of {asked} was refused, and the error is: {text}"));
            }
            Some(_) => {}
        }
        if got != want {
            return wrong(format!("request {n} of {asked} was refused ({said:?}), and the frame after it differs"));
        }
    }
    Ok(told)
}

/// A renderer and its first frame.
pub fn renderer(gpu: &Gpu, scene: &Scene, facets: FacetMode, first: u64, step: u64, refusal: Refusal) -> Result<Told> {
    let settings = settings(facets)?;
    let pipelines = Arc::new(Pipelines::new(&gpu.device, &settings));
    let prepared = Prepared::new(&scene.mesh)?;
    let budget = Budget { start: Some(500), ..Budget::default() };
    each(first, step, refusal, || {
        let mut said = None;
        let new = || Renderer::with_pipelines(gpu, &prepared, &settings, budget, pipelines.clone());
        let mut renderer = insisting(&mut said, new)?;
        let output = insisting(&mut said, || renderer.render(&scene.camera, &scene.light))?;
        let bits = output.visibility.iter().map(|v| v.to_bits());
        Ok((bits.chain(output.lit.iter().copied()).chain(output.triangles).collect(), said))
    })
}

/// A pass that takes the scene's casters, another size and its first one again, with lists that begin at one element each time.
pub fn pass(gpu: &Gpu, scene: &Scene, facets: FacetMode, first: u64, step: u64, refusal: Refusal) -> Result<Told> {
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let budget = Budget { start: Some(1), ..Budget::default() };
    let none = Casters::Static { positions: &[], triangles: &[] };
    let config = PassConfig { budget, keep_last: true, ..PassConfig::new(settings(facets)?, none) };
    let mut pass = ShadowPass::new(&gpu.device, &gpu.queue, &config)?;
    let inputs = Inputs::new(&scene.camera, &scene.light);
    each(first, step, refusal, || {
        let (mut said, mut seen) = (None, Vec::new());
        insisting(&mut said, || pass.set_casters(&casters))?;
        for size in SIZES.iter().rev() {
            insisting(&mut said, || pass.set_size(*size))?;
            // The first whole one, wherever it is.
            let whole = (0..12)
                .map(|_| insisting(&mut said, || frame(gpu, &mut pass, &inputs)))
                .find(|w| !matches!(w, Ok(false)));
            if !whole.unwrap_or(Ok(false))? {
                return Err(Error::Config("no complete frame of 12".to_owned()));
            }
            seen.extend(words(gpu, pass.visibility(), pass.lit())?);
        }
        Ok((seen, said))
    })
}

/// A pass as it is made, and its first frames: each time with pipelines of its own, which takes seconds.
pub fn new_pass(gpu: &Gpu, scene: &Scene, facets: FacetMode, first: u64, step: u64, refusal: Refusal) -> Result<Told> {
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let config = PassConfig { keep_last: true, timing: true, ..PassConfig::new(settings(facets)?, casters) };
    let inputs = Inputs::new(&scene.camera, &scene.light);
    each(first, step, refusal, || {
        let mut said = None;
        let mut pass = insisting(&mut said, || ShadowPass::new(&gpu.device, &gpu.queue, &config))?;
        for _ in 0..6 {
            if insisting(&mut said, || frame(gpu, &mut pass, &inputs))? {
                return Ok((words(gpu, pass.visibility(), pass.lit())?, said));
            }
        }
        Err(Error::Config("no complete frame of 6".to_owned()))
    })
}

/// One frame, and whether it was complete.
fn frame(gpu: &Gpu, pass: &mut ShadowPass, inputs: &Inputs) -> Result<bool> {
    let mut encoder = gpu.encoder();
    let number = pass.record(&mut encoder, inputs, &Target::default())?;
    gpu.submit_and_wait(encoder)?;
    for _ in 0..5000 {
        match pass.status() {
            Some(status) if status.frame == number => return Ok(status.complete),
            Some(_) => {}
            None => std::thread::sleep(std::time::Duration::from_millis(1)),
        }
    }
    Err(Error::Config(format!("nothing is known of frame {number}")))
}

/// Words of two buffers.
pub fn words(gpu: &Gpu, visibility: &wgpu::Buffer, lit: Option<&wgpu::Buffer>) -> Result<Vec<u32>> {
    let lit = lit.ok_or_else(|| Error::Config("no lit masks".to_owned()))?;
    let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: visibility.size() + lit.size(),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.encoder();
    encoder.copy_buffer_to_buffer(visibility, 0, &staging, 0, visibility.size());
    encoder.copy_buffer_to_buffer(lit, 0, &staging, visibility.size(), lit.size());
    gpu.queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait(None)?;
    let view = staging.get_mapped_range(..).map_err(|e| Error::Gpu(e.to_string()))?;
    Ok(bytemuck::pod_collect_to_vec(&view))
}
