//! Whether the adapters of this machine give the same samples, as a table:
//! `cargo run --release --example adapters_agree -- [--size WxH] [--samples N] [--map N] [--ground] [SCENE …]`
//!
//! Each scene is rendered on every adapter with 1, 32 and 128 samples, or N, with one facet a pixel and with all, and held
//! against the first adapter bit by bit. A sample that differs is *in the band* if facet truth says so of its facet on
//! either adapter (nearer than 1/256 pixel to an edge), *another surface* if the two see different triangles there, else
//! *wrong*. In each frame a sample is turned over first and must be found wrong. A wrong sample,
//! or less than two adapters, is exit status 1.

use lab::arguments::Arguments;
use lab::report::FacetSet;
use lab::scene::{Scene, SceneOptions};
use oracle::truth::{FacetInput, FacetTruth, Tracer};
use std::collections::HashMap;
use std::process::ExitCode;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared, Settings};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::stages::facet_classify::FacetState;
use subpixel_shadows::{Error, Result};

/// What one adapter made of a frame.
struct Frame {
    lit: Vec<u32>,
    set: FacetSet,
}

impl Frame {
    fn of(gpu: &Gpu, prepared: &Prepared, scene: &Scene, plan: &Plan) -> Result<Self> {
        let mut renderer = Renderer::new(gpu, prepared, &plan.settings, Budget::default())?;
        let (words, width) = (plan.settings.samples.words(), plan.settings.size[0]);
        let mut set = FacetSet::default();
        let output = renderer.render_and(&scene.camera, &scene.light, &mut |method, rows| {
            if rows.first == 0 {
                set = FacetSet::default();
            }
            set.add(gpu, method.facets(), words, width, rows)
        })?;
        Ok(Self { lit: output.lit, set })
    }

    /// The facets of the pixels that `wanted` holds, with their coverage.
    fn facets_of(&self, wanted: &HashMap<u32, u128>) -> HashMap<u32, Vec<FacetInput>> {
        let words = self.set.words as usize;
        let mut found: HashMap<u32, Vec<FacetInput>> = HashMap::new();
        for (f, facet) in self.set.facets.iter().enumerate() {
            if facet.state != FacetState::Empty as u32 && wanted.contains_key(&facet.pixel) {
                let mut coverage = [0; 4];
                coverage[..words].copy_from_slice(&self.set.masks[3 * f * words..][..words]);
                let input = FacetInput { pixel: facet.pixel, triangle: facet.triangle, coverage };
                found.entry(facet.pixel).or_default().push(input);
            }
        }
        found
    }
}

fn join(words: &[u32]) -> u128 {
    words.iter().rev().fold(0, |mask, &word| mask << 32 | u128::from(word))
}

/// Samples that differ: in the band, on another surface, wrong.
#[derive(Default)]
struct Difference {
    pixels: usize,
    band: u32,
    surface: u32,
    wrong: u32,
}

fn difference(first: &Frame, second: &Frame, truth: &FacetTruth) -> Result<Difference> {
    let words = first.set.words as usize;
    let pairs = first.lit.chunks(words).zip(second.lit.chunks(words)).enumerate();
    let differ: HashMap<u32, u128> =
        pairs.filter(|(_, (a, b))| a != b).map(|(pixel, (a, b))| (pixel as u32, join(a) ^ join(b))).collect();
    let mut found = Difference { pixels: differ.len(), ..Difference::default() };
    let [a, b] = [first.facets_of(&differ), second.facets_of(&differ)];
    for (pixel, &samples) in &differ {
        let (mut band, mut same) = (0, 0);
        let none = Vec::new();
        let [a, b] = [&a, &b].map(|facets| facets.get(pixel).unwrap_or(&none));
        for (facets, others) in [(a, b), (b, a)] {
            for (facet, result) in facets.iter().zip(truth.judge(facets, None)?) {
                band |= join(&result.ambiguous()) & join(&facet.coverage);
                let twins = others.iter().filter(|other| other.triangle == facet.triangle);
                same |= twins.fold(0, |mask, twin| mask | join(&twin.coverage) & join(&facet.coverage));
            }
        }
        found.band += (samples & band).count_ones();
        found.surface += (samples & !band & !same).count_ones();
        found.wrong += (samples & !band & same).count_ones();
    }
    Ok(found)
}

/// Turns one sample of `frame` over in a copy, in one pixel after the other, until one is found wrong: shows that a wrong
/// sample would be seen.
fn check_that_faults_are_seen(frame: &Frame, truth: &FacetTruth) -> Result<()> {
    let words = frame.set.words as usize;
    for facet in frame.set.facets.iter().filter(|f| f.state != FacetState::Empty as u32).step_by(997).take(100) {
        let mut spoilt = Frame { lit: frame.lit.clone(), set: frame.set.clone() };
        spoilt.lit[facet.pixel as usize * words] ^= 1;
        if difference(frame, &spoilt, truth)?.wrong == 1 {
            return Ok(());
        }
    }
    Err(Error::Config("a sample that was turned over is not found wrong".to_owned()))
}

fn main() -> Result<ExitCode> {
    let arguments = Arguments::of(std::env::args().skip(1))?;
    let gpus: Vec<Gpu> = Gpu::adapters().iter().map(|a| Gpu::from_adapter(a, None)).collect::<Result<_>>()?;
    let given = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    let [w, h] = arguments.size;
    println!("`cargo run --release --example adapters_agree -- {given}`: {w} x {h} pixels, map {}.\n", arguments.map);
    for (k, gpu) in gpus.iter().enumerate() {
        println!("{}. {}, {}", k + 1, gpu.adapter.name, gpu.adapter.driver);
    }
    let [first, others @ ..] = gpus.as_slice() else { return Err(Error::NoAdapter("no adapter".to_owned())) };
    println!(
        "\n| scene | samples | facets | adapter | pixels that differ | samples in the band | another surface | wrong |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    if others.is_empty() {
        return Err(Error::Config(format!("only one adapter here: {}", first.adapter.name)));
    }
    let counts = arguments.samples.map_or(vec![1, 32, 128], |n| vec![n]);
    let mut wrong = 0;
    for name in &arguments.scenes {
        let options = SceneOptions { ground: arguments.ground, ..SceneOptions::default() };
        let scene = Scene::open(name, &options)?;
        let prepared = scene.prepared()?;
        let tracer = Tracer::of(&prepared)?;
        for (count, facets, label) in
            counts.iter().flat_map(|&n| [(n, FacetMode::One, "one"), (n, FacetMode::All, "all")])
        {
            let samples = Samples::new(Pattern::default(), count)?;
            let wanted = Settings { facets, cull_back: true, ..Settings::new(arguments.size, arguments.map, samples) };
            let plan = Plan::of_method(MethodName::FacetMasks, &prepared, &scene.camera, &scene.light, &wanted, false)?;
            if plan.extent != Extent::Everything {
                println!("| {name} | {count} | {label} | | nothing to compare: {:?} | | | |", plan.extent);
                continue;
            }
            // With one sample the plan makes one facet of it whatever is asked for.
            if plan.settings.facets != facets {
                continue;
            }
            let mut truth = FacetTruth::new(&tracer, &scene.camera, &scene.light, &plan.settings.samples, w, h)?;
            if !(plan.settings.validity && count > 1 && facets == FacetMode::One) {
                truth = truth.without_validity();
            }
            let frame = Frame::of(first, &prepared, &scene, &plan)?;
            check_that_faults_are_seen(&frame, &truth)?;
            for (k, gpu) in others.iter().enumerate() {
                let d = difference(&frame, &Frame::of(gpu, &prepared, &scene, &plan)?, &truth)?;
                println!(
                    "| {name} | {count} | {label} | {} | {} | {} | {} | {} |",
                    k + 2,
                    d.pixels,
                    d.band,
                    d.surface,
                    d.wrong
                );
                wrong += d.wrong;
            }
        }
    }
    Ok(if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
