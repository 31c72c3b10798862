//! Facets in one view of the light, and how several views are put together.

use super::shadows::{Known, Pairs};
use super::{Clock, CpuRequest, MARGIN};
use crate::reference::facet_classify::{FacetState, MapAround, Part, classify_parts, marks_table};
use crate::reference::resolve::FacetBits;
use crate::reference::triangle_setup::{Triangle, mark_tested, setup};
use crate::reference::vertex_project::project;
use crate::reference::view::{MapEnds, View};
use crate::truth::{FacetTruth, Progress, join_mask};
use glam::DVec3;
use subpixel_shadows::light_view::LightView;
use subpixel_shadows::methods::output::Counts;
use subpixel_shadows::methods::prepared::Prepared;
use subpixel_shadows::methods::settings::Settings;
use subpixel_shadows::scene::{Camera, Light};

/// One view of the light.
pub(super) struct LightSide {
    pub view: View,
    pub triangles: Vec<Triangle>,
    pub known: Known,
    sat: Vec<u32>,
}

impl LightSide {
    pub fn new(
        clock: &mut Clock,
        prepared: &Prepared,
        settings: &Settings,
        camera: &Camera,
        light: &Light,
        map: &LightView,
        request: &CpuRequest,
    ) -> Self {
        let mesh = prepared.mesh();
        let bounds = mesh.bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
        let view = View::new(camera, light, map, bounds, settings.size, settings.leaves_backs_out() && map.outside);
        let (vertices, triangles) = clock.time("triangle_setup", || {
            let vertices = project(&view, &mesh.positions);
            let mut triangles = setup(&view, &vertices, &mesh.triangles, &prepared.bodies);
            mark_tested(&mut triangles, prepared.alpha());
            (vertices, triangles)
        });
        let known = if request.unshadowed {
            Known::nothing()
        } else {
            Known::new(clock, &view, &prepared.edges, &vertices, &triangles, request.looks)
        };
        let sat = clock.time("summed_area", || marks_table(&known.marked, map.map_size));
        Self { view, triangles, known, sat }
    }

    /// Counts of the view itself.
    pub fn add_counts(&self, counts: &mut Counts) {
        // The same in every view.
        counts.silhouette_edges = self.known.silhouette_edges;
        counts.silhouette_texels += self.known.marked.iter().filter(|m| **m).count() as u64;
    }

    /// State and masks of each facet as far as this view tells, and whether it is settled whatever others tell.
    #[expect(clippy::too_many_arguments, reason = "what all stages of a band read")]
    pub fn masks(
        &self,
        clock: &mut Clock,
        pairs: &mut Pairs,
        parts: &[Part],
        settings: &Settings,
        (truth, validity): (&FacetTruth, bool),
        unshadowed: bool,
        progress: Progress,
    ) -> Vec<(FacetBits, bool)> {
        let around = MapAround {
            triangles: &self.triangles,
            marked: &self.known.marked,
            splits: &self.known.splits,
            samples: settings.samples.offsets(),
            casters: u32::MAX,
        };
        let mut facets = clock
            .time("facet_classify", || classify_parts(&self.view, &around, &self.sat, parts, MARGIN, settings.settle));
        if unshadowed {
            facets.iter_mut().filter(|f| f.state == FacetState::Undecided).for_each(|f| f.state = FacetState::Lit);
        }
        let skip_front = settings.settle && !validity;
        let map = MapEnds::of(&self.view.map);
        let results = pairs.masks(clock, &self.known, truth, &facets, &self.triangles, map, skip_front, progress);
        let masks = facets.iter().zip(results).map(|(facet, result)| {
            let (occluded, invalid) = result
                .as_ref()
                .map_or((0, 0), |r| (join_mask(r.occluded), if validity { !join_mask(r.valid) } else { 0 }));
            (FacetBits { state: facet.state, coverage: facet.coverage, occluded, invalid }, facet.settled)
        });
        masks.collect()
    }
}

/// Adds what a further view tells: settled in one view a facet is so; to be evaluated in one, though there is nothing before it in
/// another.
pub(super) fn join((known, settled): &mut (FacetBits, bool), (further, settles): (FacetBits, bool)) {
    if *settled {
        return;
    }
    if settles || known.state == FacetState::Lit {
        known.state = further.state;
    }
    *settled = settles;
    known.occluded |= further.occluded;
    known.invalid |= further.invalid;
}
