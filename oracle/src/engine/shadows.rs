//! Layers that the light sees, and the masks of the facets that they leave undecided.

use super::{Clock, MARGIN, list};
use crate::reference::candidate_pairs::candidates;
use crate::reference::facet_classify::{FacetAtPixel, FacetState};
use crate::reference::front_layer::{self, Split};
use crate::reference::light_layers::{Layer, any_everywhere, layers};
use crate::reference::silhouette_mask::{self, silhouettes};
use crate::reference::triangle_setup::Triangle;
use crate::reference::vertex_project::Vertex;
use crate::reference::view::{MapEnds, View};
use crate::reference::{pixel_texel_pairs, triangle_texel_pairs, visibility_masks};
use crate::truth::{FacetResult, FacetTruth, Progress};
use subpixel_shadows::methods::output::{Counts, ListUse};
use subpixel_shadows::scene::adjacency::Edge;

/// Pairs of a part of the facets that are listed together, counted by rectangles; a facet may have more.
const PAIRS: u64 = 1 << 25;

/// State of the light's side.
pub(super) struct Known {
    /// The mask.
    pub marked: Vec<bool>,
    /// Split depth or state of each texel.
    pub splits: Vec<Split>,
    /// Depth of the nearest caster of each texel, not a number where there is none; empty unless it was asked for.
    pub depths: Vec<f32>,
    /// Edges that are silhouettes.
    pub silhouette_edges: u64,
}

impl Known {
    /// State of one texel in which nothing casts.
    pub fn nothing() -> Self {
        Self { marked: vec![false], splits: vec![Split::Uncovered], depths: Vec::new(), silhouette_edges: 0 }
    }

    /// State from the casters; the depths only if asked for.
    pub fn new(
        clock: &mut Clock,
        view: &View,
        edges: &[Edge],
        vertices: &[Vertex],
        triangles: &[Triangle],
        depths: bool,
    ) -> Self {
        let size = view.map.map_size;
        let layers = clock.time("light_layers", || layers(triangles, size, MARGIN.texels, 0.0));
        let (silhouette_edges, mut marked) = clock.time("silhouette_mask", || {
            let edges: Vec<_> = edges.iter().map(|e| [e.v0, e.v1, e.t0, e.t1]).collect();
            let silhouette = silhouettes(view, &edges, triangles, 1e-6);
            let marked = silhouette_mask::marks(&edges, &silhouette, vertices, &layers, size, MARGIN);
            (silhouette.iter().filter(|s| **s).count() as u64, marked)
        });
        let splits = clock.time("front_layer", || {
            let unproved = front_layer::marks(triangles, &layers, size, MARGIN);
            let behind = any_everywhere(triangles);
            for ((marked, unproved), layer) in marked.iter_mut().zip(unproved).zip(&layers) {
                *marked |= unproved || layer.open || layer.thin || behind;
            }
            front_layer::settle(&layers, &marked)
        });
        let depth = |l: &Layer| l.nearest.map_or(f32::NAN, |(depth, _)| depth as f32);
        let depths = if depths { layers.iter().map(depth).collect() } else { Vec::new() };
        Self { marked, splits, depths, silhouette_edges }
    }
}

/// Pairs that were needed: in all, and at most at a time.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    pixel_texel: [u64; 2],
    triangle_texel: [u64; 2],
    candidates: [u64; 2],
    tests: u64,
}

impl Pairs {
    /// The masks of each facet; `None` where it has no candidates.
    #[expect(clippy::too_many_arguments, reason = "what all stages of a part read")]
    pub fn masks(
        &mut self,
        clock: &mut Clock,
        known: &Known,
        truth: &FacetTruth,
        facets: &[FacetAtPixel],
        triangles: &[Triangle],
        map: MapEnds,
        skip_front: bool,
        progress: Progress,
    ) -> Vec<Option<FacetResult>> {
        let mut results = Vec::with_capacity(facets.len());
        for part in parts(facets) {
            let done = results.len();
            let part = &facets[part];
            if !part.iter().any(|f| f.state == FacetState::Undecided) {
                results.resize(done + part.len(), None);
                continue;
            }
            let pixel_pairs = clock
                .time("pixel_texel_pairs", || pixel_texel_pairs::pairs(part, &known.splits, map, MARGIN, skip_front));
            let triangle_pairs = clock.time("triangle_texel_pairs", || {
                let deepest = pixel_texel_pairs::deepest(part, &pixel_pairs);
                triangle_texel_pairs::pairs(triangles, &deepest, map, MARGIN)
            });
            let listed =
                clock.time("candidate_pairs", || candidates(part, triangles, &pixel_pairs, &triangle_pairs, MARGIN));
            let total = |lists: &[Vec<u32>]| lists.iter().map(|l| l.len() as u64).sum::<u64>();
            let note = |counts: &mut [u64; 2], n: u64| *counts = [counts[0] + n, counts[1].max(n)];
            note(&mut self.pixel_texel, total(&pixel_pairs));
            note(&mut self.triangle_texel, total(&triangle_pairs));
            note(&mut self.candidates, total(&listed));
            let tests = pixel_pairs.iter().zip(&triangle_pairs).map(|(p, t)| (p.len() * t.len()) as u64);
            self.tests += tests.sum::<u64>();
            let report = |k: usize, _: usize| {
                if let Some(progress) = progress {
                    progress(done + k, facets.len());
                }
            };
            results.extend(
                clock.time("visibility_masks", || visibility_masks::masks(truth, part, &listed, Some(&report))),
            );
        }
        results
    }

    /// Adds the counts, and says how the lists fared.
    pub fn lists(&self, counts: &mut Counts) -> Vec<ListUse> {
        counts.pixel_texel_pairs = self.pixel_texel[0];
        counts.triangle_texel_pairs = self.triangle_texel[0];
        counts.candidate_tests = self.tests;
        counts.visibility_evaluations = self.candidates[0];
        vec![
            list("pixel_texel_pairs", self.pixel_texel[1]),
            list("triangle_texel_pairs", self.triangle_texel[1]),
            list("candidate_pairs", self.candidates[1]),
        ]
    }
}

/// Facets in parts whose rectangles hold at most [`PAIRS`] texels, or one facet.
fn parts(facets: &[FacetAtPixel]) -> Vec<std::ops::Range<usize>> {
    let (mut parts, mut first, mut texels) = (Vec::new(), 0, 0u64);
    for (f, facet) in facets.iter().enumerate() {
        let [x0, y0, x1, y1] = facet.rect.unwrap_or([1, 1, 0, 0]).map(u64::from);
        let own = (x1 + 1 - x0) * (y1 + 1 - y0);
        if texels + own > PAIRS && f > first {
            parts.push(first..f);
            (first, texels) = (f, 0);
        }
        texels += own;
    }
    parts.push(first..facets.len());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::facet_classify::Outline;
    use glam::DVec4;

    #[test]
    fn parts_hold_what_fits() {
        let facet = |rect| FacetAtPixel {
            pixel: 0,
            triangle: None,
            plane: DVec4::ZERO,
            state: FacetState::Undecided,
            rect,
            outline: Outline::default(),
            coverage: 1,
            open_coverage: 0,
            open: false,
            open_side: false,
            settled: false,
        };
        let (none, half) = (facet(None), facet(Some([0, 0, 4095, 4095])));
        let whole = facet(Some([0, 0, 8191, 8191]));
        let list = [none.clone(), half.clone(), half.clone(), none.clone(), half, whole.clone(), whole, none];
        assert_eq!(parts(&list), [0..4, 4..5, 5..6, 6..7, 7..8]);
        let only = |list: &[FacetAtPixel]| (parts(list).len(), parts(list)[0].clone());
        assert_eq!((only(&list[..1]), only(&[])), ((1, 0..1), (1, 0..0)));
    }
}
