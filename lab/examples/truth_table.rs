//! `facet-masks` against both truths, with one facet a pixel and with all, from two views and under two lights, as a table:
//! `cargo run --release --example truth_table -- [--size WxH] [--samples N] [--map N] [--ground] [SCENE …] > table.md`
//!
//! The views are the scene's own and one from the other side; the lights are the scene's own and a spot from the same side.

use lab::arguments::Arguments;
use lab::report::{FacetErrors, FacetSet, SeenErrors, TracedScene, or_dash, percent_or_dash};
use lab::scene::{Scene, SceneOptions};
use oracle::truth::{SceneTruth, Tracer, TruthImage, join_mask};
use std::io::Write;
use std::time::Instant;
use subpixel_shadows::Result;
use subpixel_shadows::glam::{DQuat, DVec3, Vec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{FacetMode, MethodName, Settings};
use subpixel_shadows::plan::{Extent, Plan};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light};

/// The camera turned by 140 degrees around its target, up as it is.
fn other_side(camera: &Camera) -> Camera {
    let [eye, target, up] = [camera.eye, camera.target, camera.up].map(|v| Vec3::from(v).as_dvec3());
    let turned = DQuat::from_axis_angle(up.normalize(), 140f64.to_radians()) * (eye - target);
    Camera { eye: (target + turned).as_vec3().into(), ..*camera }
}

/// A spot light from where the light comes from, around all of the scene.
fn spot(light: &Light, (low, high): (DVec3, DVec3)) -> Light {
    let (middle, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
    let from = light.towards(middle).normalize_or(DVec3::Y);
    let position = (middle + from * radius * 2.5).as_vec3().into();
    Light::Spot { position, target: middle.as_vec3().into(), angle_degrees: 60.0 }
}

/// By how much a pixel's visibility is off without the samples that truth itself leaves open: within 1/256 pixel of an edge
/// of a shadow or of what is seen. Looked at only where the pixel is off by more than one sample.
fn sure_difference(scene: &SceneTruth, truth: &TruthImage, lit: &[u32], pixel: u32) -> f64 {
    let (p, words) = (pixel as usize, truth.samples.div_ceil(32) as usize);
    let mut ours = [0; 4];
    ours[..words].copy_from_slice(&lit[p * words..(p + 1) * words]);
    let (ours, of) = (join_mask(ours), &truth.pixels[p]);
    let (seen, theirs) = (join_mask(of.seen), join_mask(of.lit));
    if ((ours ^ theirs) & seen).count_ones() <= 1 && of.seen_count > 1 {
        return 0.0;
    }
    let sure = seen & !join_mask(scene.ambiguous_mask(pixel));
    let count = |mask: u128| f64::from(mask.count_ones());
    (count(ours & sure) - count(theirs & sure)).abs() / count(sure).max(1.0)
}

fn main() -> Result<()> {
    let arguments = Arguments::of(std::env::args().skip(1))?;
    let gpu = Gpu::open(None)?;
    let [w, h] = arguments.size;
    let samples = Samples::new(Pattern::default(), arguments.samples.unwrap_or(32))?;
    let given = std::env::args().skip(1).collect::<Vec<_>>().join(" ");
    println!("`cargo run --release --example truth_table -- {given}`\n");
    println!("{}; {w} x {h} pixels, {} samples, map {}.\n", gpu.adapter.name, samples.count(), arguments.map);
    println!("*Wrong* are samples that differ from facet truth farther than 1/256 pixel from every edge, *open* those");
    println!(
        "nearer. The other columns are of pixels against scene truth at the same samples: *largest* difference, and"
    );
    println!("without the samples that truth leaves open (*sure*); *band* is the silhouette band.\n");
    println!(
        "| scene | view | light | facets | samples | wrong | open | elsewhere | within 1/{} | largest | sure | band RMSE |",
        samples.count()
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    let start = Instant::now();
    for name in &arguments.scenes {
        let options = SceneOptions { ground: arguments.ground, ..SceneOptions::default() };
        let scene = Scene::open(name, &options)?;
        let prepared = scene.prepared()?;
        let tracer = Tracer::of(&prepared)?;
        let bounds = prepared.mesh().bounds().unwrap_or_default();
        for (view, camera) in [("own", scene.camera), ("other side", other_side(&scene.camera))] {
            for (kind, light) in [("own", scene.light), ("spot", spot(&scene.light, bounds))] {
                let wanted = Settings::new(arguments.size, arguments.map, samples.clone());
                let traced = TracedScene::new(&tracer, &camera, &light, &wanted, None)?;
                for (facets, label) in [(FacetMode::One, "one"), (FacetMode::All, "all")] {
                    let wanted = Settings { facets, cull_back: true, ..wanted.clone() };
                    let plan = Plan::of_method(MethodName::FacetMasks, &prepared, &camera, &light, &wanted, false)?;
                    if plan.extent != Extent::Everything {
                        println!(
                            "| {} | {view} | {kind} | {label} | nothing to compare: {:?} | | | | | | |",
                            scene.name, plan.extent
                        );
                        continue;
                    }
                    let settings = &plan.settings;
                    let mut renderer = Renderer::new(&gpu, &prepared, settings, Budget::default())?;
                    let mut set = FacetSet::default();
                    let frame = renderer.render_and(&camera, &light, &mut |method, rows| {
                        if rows.first == 0 {
                            set = FacetSet::default();
                        }
                        set.add(&gpu, method.facets(), samples.words(), arguments.size[0], rows)
                    })?;
                    let own = FacetErrors::of(&set, &tracer, &camera, &light, settings, None)?;
                    let seen = SeenErrors::of(&set, &tracer, &camera, settings, None)?;
                    let against = traced.errors(&frame.visibility)?;
                    let scene_truth = SceneTruth::new(&tracer, &camera, &light, &samples, w, h)?;
                    let sure = (0..w * h).map(|p| sure_difference(&scene_truth, &traced.image, &frame.lit, p));
                    println!(
                        "| {} | {view} | {kind} | {label} | {} | {} | {:.3} % | {} | {} | {:.3} | {:.3} | {} |",
                        scene.name,
                        own.facet_samples,
                        own.facet_wrong_outside_band,
                        100.0 * own.facet_ambiguous as f64 / own.facet_samples.max(1) as f64,
                        seen.seen_wrong,
                        percent_or_dash(against.scene_pixel_match),
                        against.scene_max,
                        sure.fold(0.0, f64::max),
                        or_dash(against.scene_band_rmse, 5),
                    );
                    let _ = std::io::stdout().flush();
                    eprintln!("{} {view} {kind} {label}: {:.0} s", scene.name, start.elapsed().as_secs_f64());
                }
            }
        }
    }
    Ok(())
}
