//! `facet-masks` on the CPU: the same stages by their definitions in `f64`, for machines without an adapter.

use super::facet_masks::{FacetMode, Settings};
use super::prepared::Prepared;
use super::render::{Counts, ListUse, Output};
use crate::light_view::LightView;
use crate::reference::camera_visibility::{Doubt, nearest};
use crate::reference::candidate_pairs::candidates;
use crate::reference::facet_classify::{State, Surroundings, classify};
use crate::reference::front_layer::{self, Margin, Split};
use crate::reference::light_layers::{any_everywhere, layers};
use crate::reference::resolve::{Masks, pixel};
use crate::reference::silhouette_mask::{self, silhouettes};
use crate::reference::triangle_setup::setup;
use crate::reference::vertex_project::project;
use crate::reference::view::View;
use crate::reference::{pixel_texel_pairs, triangle_texel_pairs, visibility_masks};
use crate::scene::{Camera, Light};
use crate::truth::{FacetTruth, Progress, Tracer, join_mask, split_mask};
use crate::{Error, Result};
use glam::DVec3;
use std::time::Instant;

/// How far conservative tests reach out: far above the rounding of `f64`, far below anything that costs time.
const MARGIN: Margin = Margin { texels: 1.0 / 1024.0, depth: 1e-7 };

/// Renders one frame. Progress counts the facets of the last and longest stage.
///
/// # Errors
/// [`crate::Error::Config`] for impossible settings, [`crate::Error::Scene`] for an impossible camera or light,
/// [`crate::Error::Mesh`] for a mesh
/// that has not passed its check.
pub fn render(
    prepared: &Prepared,
    settings: &Settings,
    camera: &Camera,
    light: &Light,
    progress: Progress,
) -> Result<Output> {
    let start = Instant::now();
    settings.check()?;
    if settings.facets == FacetMode::All {
        return Err(Error::Config("the stages on the CPU know one facet a pixel only".to_owned()));
    }
    camera.check()?;
    let mesh = &prepared.mesh;
    let map = LightView::fit(mesh, light, settings.map)?;
    map.check()?;
    let bounds = mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
    let cull_back = settings.cull_back && prepared.closed;
    let view = View::new(camera, light, &map, bounds, settings.size, cull_back);
    let samples = settings.samples.offsets();

    // What each view sees.
    let vertices = project(&view, &mesh.positions);
    let triangles = setup(&view, &vertices, &mesh.triangles);
    let seen: Vec<_> =
        nearest(&view, &triangles, Doubt { edge: 0.0, depth: 0.0 }).into_iter().map(|s| s.triangle).collect();
    let layers = layers(&triangles, settings.map, MARGIN.texels, 0.0);
    let edges: Vec<_> = prepared.edges.iter().map(|e| [e.v0, e.v1, e.t0, e.t1]).collect();
    let silhouette = silhouettes(&view, &edges, &triangles, 1e-6);
    let mut marked = silhouette_mask::marks(&edges, &silhouette, &vertices, &layers, settings.map, MARGIN);
    let unproved = front_layer::marks(&triangles, &layers, settings.map, MARGIN);
    let behind = any_everywhere(&triangles);
    for ((marked, unproved), layer) in marked.iter_mut().zip(unproved).zip(&layers) {
        *marked |= unproved || layer.open || behind;
    }
    let splits: Vec<Split> = front_layer::settle(&layers, &marked);

    // Facets, and what is not settled.
    let listed: Vec<_> = (0u32..).zip(seen.iter().copied()).collect();
    let around = Surroundings { triangles: &triangles, marked: &marked, splits: &splits, samples, casters: u32::MAX };
    let facets = classify(&view, &around, &listed, MARGIN, settings.settle);
    let validity = settings.validity && samples.len() > 1;
    let skip_front = settings.settle && !validity;
    let pixel_pairs = pixel_texel_pairs::pairs(&facets, &splits, settings.map, MARGIN, skip_front);
    let deepest = pixel_texel_pairs::deepest(&facets, &pixel_pairs);
    let triangle_pairs = triangle_texel_pairs::pairs(&triangles, &deepest, settings.map, MARGIN);
    let listed = candidates(&facets, &triangles, &pixel_pairs, &triangle_pairs, MARGIN);
    let tracer = Tracer::new(mesh)?;
    let truth = FacetTruth::new(&tracer, camera, light, &settings.samples, settings.size[0], settings.size[1])?;
    let truth = if validity { truth } else { truth.without_validity() };
    let results = visibility_masks::masks(&truth, &facets, &listed, progress);

    // Resolve.
    let words = settings.samples.words();
    let mut visibility = Vec::with_capacity(facets.len());
    let mut lit = Vec::with_capacity(facets.len() * words as usize);
    for (facet, result) in facets.iter().zip(&results) {
        let (occluded, invalid) = match result {
            Some(r) => (join_mask(r.occluded), if validity { !join_mask(r.valid) } else { 0 }),
            None => (0, 0),
        };
        let (share, mask) = pixel(&[Masks { state: facet.state, coverage: facet.coverage, occluded, invalid }]);
        visibility.push(share);
        lit.extend(&split_mask(mask)[..words as usize]);
    }
    let state = |s: State| facets.iter().filter(|f| f.state == s).count() as u64;
    let total = |lists: &[Vec<u32>]| lists.iter().map(|l| l.len() as u64).sum::<u64>();
    let tests = pixel_pairs.iter().zip(&triangle_pairs).map(|(p, t)| (p.len() * t.len()) as u64).sum();
    let counts = Counts {
        facets: facets.len() as u64,
        complex_pixels: 0,
        silhouette_edges: silhouette.iter().filter(|s| **s).count() as u64,
        silhouette_texels: marked.iter().filter(|m| **m).count() as u64,
        silhouette_pixels: state(State::Undecided),
        pixel_texel_pairs: total(&pixel_pairs),
        triangle_texel_pairs: total(&triangle_pairs),
        candidate_tests: tests,
        visibility_evaluations: total(&listed),
        refined_evaluations: 0,
        empty_facets: state(State::Empty),
        dark_facets: state(State::Dark),
        lit_facets: state(State::Lit),
        shadowed_facets: state(State::Shadowed),
    };
    let list = |name, needed| ListUse { name, needed, capacity: needed, runs: 1 };
    Ok(Output {
        visibility,
        lit,
        words,
        triangles: seen.into_iter().map(|t| t.unwrap_or(u32::MAX)).collect(),
        counts,
        lists: vec![
            list("pixel_texel_pairs", counts.pixel_texel_pairs),
            list("triangle_texel_pairs", counts.triangle_texel_pairs),
            list("candidate_pairs", counts.visibility_evaluations),
        ],
        stages: Vec::new(),
        wall_ms: start.elapsed().as_secs_f64() * 1e3,
        dispatches: 0,
    })
}
