//! Stages of methods other than `facet-masks`, and which of those a scene or setting makes needless.

use super::{CULLING, Extent, Plan, PlanStep};
use crate::Result;
use crate::light_view::{LightView, OmniMaps};
use crate::methods::facet_masks::{FacetMode, Settings};
use crate::methods::prepared::Prepared;
use crate::methods::{MapQuery, MethodName, PageRule, TexelQuery};
use crate::scene::{Camera, Light};
use glam::DVec3;

/// Stages of `spsm` after what the camera sees.
const SPSM_STAGES: [(&str, &str); 6] = [
    ("seen_texels", "texels that pixels fall into"),
    ("spsm_map", "closest triangle of a texel, in 128 bits"),
    ("spsm_classify", "pixels: dark, lit, or shadowed by their own texel's triangle"),
    ("spsm_map_around", "texels around the pixels that these do not settle"),
    ("spsm_settle", "lit by outlines, shadowed by what is around, or uncertain"),
    ("spsm_recover", "shadow borders of the uncertain pixels, sample by sample"),
];

/// Stages that make a shadow map.
const NEAREST: (&str, &str) = ("light_layers", "nearest depth at every texel centre");
/// The same of paraboloid views of it.
const CURVED: (&str, &str) = ("paraboloid_casters", "nearest depth at every texel centre, of the light's paraboloids");
const COMPARED: (&str, &str) = ("compared_depths", "the depth a texel is compared by, from its two nearest");

/// Stages of `reconstructable` after what the camera sees.
const CENTRE_STAGES: [(&str, &str); 3] = [
    NEAREST,
    ("light_triangles", "the triangle of that depth"),
    ("kept_triangles", "every sample against the triangles of the texels around it"),
];

/// Stages of `polygon-ids` after what the camera sees.
const POLYGON_STAGES: [(&str, &str); 3] = [
    NEAREST,
    ("light_triangles", "the triangle of that depth"),
    ("polygon_ids", "polygon of every sample against the map"),
];

/// Stages of the methods that compare samples with depths after what the camera sees.
const SHADOW_MAP_STAGES: [(&str, &str); 3] =
    [NEAREST, COMPARED, ("shadow_map", "depth of every sample against the map")];

/// Stages of `smsr` after what the camera sees.
const SMSR_STAGES: [(&str, &str); 3] =
    [NEAREST, COMPARED, ("smsr", "depth of every sample against the map, its borders drawn anew")];

/// Stages of `silhouette-map` after what the camera sees.
const SILHOUETTE_STAGES: [(&str, &str); 4] = [
    NEAREST,
    ("silhouette_mask", "silhouette edges"),
    ("silhouette_points", "a point of them between the centres of four texels"),
    ("silhouette_map", "every sample against the depth on its side of them"),
];

/// Stages of `deep` after what the camera sees.
const DEEP_STAGES: [(&str, &str); 3] = [
    ("light_layers", "nearest depth at every sub-texel centre"),
    ("deep_map", "light of every texel to each depth, in a few nodes"),
    ("deep_shadows", "every sample in the four texels around it"),
];

/// Stages of the methods that filter moments after what the camera sees.
const MOMENT_STAGES: [(&str, &str); 3] = [
    NEAREST,
    ("map_moments", "moments of ever larger squares of texels, of depths or exponentials"),
    ("moment_shadows", "the pixel's footprint against the map's moments"),
];

/// Stages of `resolution-matched` after what the camera sees.
const PAGE_STAGES: [(&str, &str); 3] = [
    ("page_requests", "pages of the light's view that pixels ask for, and those that are made"),
    ("page_casters", "nearest depth at every texel centre of these"),
    ("page_query", "depth of every sample against the page of its level"),
];

/// The stage that takes their place where pages are made by what they change.
const PAGE_ROUNDS: [(&str, &str); 1] =
    [("page_refinement", "levels of pages, one after the other, while they change pixels")];

/// Stages of `rectilinear` after what the camera sees.
const AXIS_STAGES: [(&str, &str); 3] = [
    ("axis_density", "how wide the texels of either axis of the map are, by what pixels ask"),
    ("warped_casters", "nearest depth at every texel centre of it"),
    ("warped_query", "depth of every sample against its texel"),
];

/// Stages of `ray-traced` between facets and picture.
const RAY_STAGES: [(&str, &str); 3] = [
    ("shadow_rays", "a ray from every sample to the light"),
    ("shadow_rays_refine", "the same with 46 bits, where 24 leave it open"),
    ("shadow_rays_cut", "drops samples that see another surface than the centre"),
];

/// Stages of `supersampled` between facets and picture.
const BIN_STAGES: [(&str, &str); 4] = [
    ("sample_bins", "sorts every sample into the texel it projects to"),
    ("sample_tests", "every caster against the samples of the texels it touches"),
    ("sample_tests_refine", "the same with 46 bits, where 24 leave it open"),
    ("shadow_rays_cut", "drops samples that see another surface than the centre"),
];

/// Stages that prove facets lit or shadowed, by silhouettes that they find.
const PROOF: [&str; 4] = ["light_layers", "silhouette_mask", "front_layer", "summed_area"];

/// Stage of the methods of one receiver a pixel where the light has several views.
const CHOICE: (&str, &str) = ("pixel_views", "which view of the light each pixel asks, and its answer");

/// Parts of stages that a setting makes needless.
const EVERY_SAMPLE: (&str, &str) = ("moment_shadows.samples", "every sample by itself");
pub(super) const UNSEEN: (&str, &str) = ("spsm_map.unseen", "texels that no pixel asks for");

impl Plan {
    /// Plan of `method`. The proofs that no surface is seen, or none is in shadow, hold for all methods; the other rules differ by method.
    ///
    /// # Errors
    /// As [`Plan::of`].
    pub fn of_method(
        method: MethodName,
        prepared: &Prepared,
        camera: &Camera,
        light: &Light,
        wanted: &Settings,
        force_all: bool,
    ) -> Result<Self> {
        let query = method.row().query;
        let wanted = &Settings { omni: method.omni(wanted), ..wanted.clone() };
        let own: &[(&str, &str)] = match query {
            TexelQuery::Facets => return Self::of(prepared, camera, light, wanted, force_all),
            TexelQuery::Triangles => &SPSM_STAGES,
            TexelQuery::Centres => &CENTRE_STAGES,
            TexelQuery::Polygons => &POLYGON_STAGES,
            TexelQuery::Deep => &DEEP_STAGES,
            TexelQuery::Silhouettes => &SILHOUETTE_STAGES,
            TexelQuery::Map(MapQuery::Nearest | MapQuery::Filtered) => &SHADOW_MAP_STAGES,
            TexelQuery::Map(MapQuery::Revectorized) => &SMSR_STAGES,
            TexelQuery::Map(_) => &MOMENT_STAGES,
            TexelQuery::Pages if wanted.pages.rule == PageRule::Queried => &PAGE_ROUNDS,
            TexelQuery::Pages => &PAGE_STAGES,
            TexelQuery::Axes => &AXIS_STAGES,
            TexelQuery::Rays => &RAY_STAGES,
            TexelQuery::Samples => &BIN_STAGES,
        };
        let of_facets = matches!(query, TexelQuery::Rays | TexelQuery::Samples);
        // Surfaces off the pixel centre are no concern of most methods.
        let partition = method.partition(wanted);
        let facets = if method.takes("facets") { wanted.facets } else { FacetMode::One };
        let one = Settings { facets, partition, ..wanted.clone() };
        let Self { extent, steps, mut settings } = Self::of(prepared, camera, light, &one, force_all)?;
        let every_texel = every_texel(wanted, force_all);
        settings.spsm.seen_only = every_texel.is_none();
        let shadowless: Vec<PlanStep> = steps.iter().filter(|s| !s.name.contains('.')).cloned().collect();
        let reason = shadowless.iter().find(|s| s.name == "light_layers").and_then(|s| s.left_out.clone());
        let left_out = |name| match name {
            "seen_texels" | "spsm_map_around" => reason.clone().or_else(|| every_texel.clone()),
            name if name == COMPARED.0 => {
                let biased = || "the nearest depth is compared, with a bias: no second is kept".to_owned();
                reason.clone().or_else(|| wanted.shadow_map.compared.is_none().then(biased))
            }
            "shadow_rays_cut" => {
                let every = || "every sample lies in the facet of the surface it sees".to_owned();
                reason.clone().or_else(|| (settings.facets == FacetMode::All).then(every))
            }
            _ => reason.clone(),
        };
        let curved = wanted.omni == OmniMaps::Paraboloids;
        let own = own.iter().map(|&step| if curved && step == NEAREST { CURVED } else { step });
        let own = own.map(|(name, purpose)| PlanStep { name, purpose, left_out: left_out(name) });
        let by_edges = matches!(wanted.pages.rule, PageRule::Edges | PageRule::Tiled);
        let of_edges = query == TexelQuery::Pages && by_edges;
        let kept = |s: &PlanStep| match s.name {
            CULLING | "triangle_setup" | "camera_visibility" | "pixel_triangles" | "pixel_coverage"
            | "sample_surfaces" | "seen_depths" => true,
            "facet_classify" | "resolve" => of_facets || extent == Extent::Facing,
            name => {
                let of_rays = query == TexelQuery::Rays && settings.ray_traced.silhouettes && settings.settle;
                (of_rays || of_edges) && PROOF.contains(&name)
            }
        };
        let mut steps: Vec<PlanStep> = shadowless.into_iter().filter(kept).collect();
        let at = if of_facets { steps.len() - 1 } else { 3 };
        let proved = if of_edges { steps.iter().filter(|s| PROOF.contains(&s.name)).count() } else { 0 };
        steps.splice(at + proved..at + proved, own);
        if !of_facets {
            let (name, purpose) = CHOICE;
            let several = if curved {
                let bounds = prepared.tree().bounds().unwrap_or((DVec3::ZERO, DVec3::ONE));
                LightView::paraboloids(bounds, light, wanted.map, false)?.len() > 1
            } else {
                partition.is_some_and(|plan| plan.is_several()) || !settings.light_view(prepared, light)?.complete
            };
            let one = (!several).then(|| "one view of the light holds all".to_owned());
            steps.insert(at, PlanStep { name, purpose, left_out: reason.clone().or(one) });
        }
        if method.filters_moments() {
            let (name, purpose) = EVERY_SAMPLE;
            let once = "one lookup in the moments of the pixel's footprint stands for all".to_owned();
            steps.push(PlanStep { name, purpose, left_out: reason.clone().or(Some(once)) });
        }
        if query == TexelQuery::Triangles {
            let few = (every_texel.is_none() && reason.is_none()).then(|| {
                let share = wanted.texels() as f64 / wanted.pixels() as f64;
                format!("one sample a pixel and {share:.1} texels: most are never asked for")
            });
            let (name, purpose) = UNSEEN;
            steps.push(PlanStep { name, purpose, left_out: reason.clone().or(few) });
        }
        Ok(Self { extent, steps, settings })
    }
}

/// Texels a pixel from which on `spsm` looks for those that are asked for before it makes any. Below, and with several samples,
/// looking costs more than the texels (data/reports/spsm.md).
const TEXELS_A_PIXEL: usize = 4;

/// Why `spsm` makes every texel of its map.
fn every_texel(wanted: &Settings, force_all: bool) -> Option<String> {
    if force_all {
        Some("forced: every texel is made".to_owned())
    } else if !wanted.spsm.seen_only {
        Some("switched off: every texel is made".to_owned())
    } else if wanted.samples.count() > 1 {
        Some("several samples a pixel: nearly every texel is asked for".to_owned())
    } else {
        let few = wanted.texels() < TEXELS_A_PIXEL * wanted.pixels();
        few.then(|| format!("fewer than {TEXELS_A_PIXEL} texels a pixel: nearly all are asked for"))
    }
}
