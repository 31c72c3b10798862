//! Plan of a scene: which stages run, which are left out, and why.
//!
//! Each rule is a proof that the stage could change nothing, so the picture is the same with it and without
//! (`--force-all` runs everything, and a test compares). Rules look at the mesh, the camera, the light and the settings
//! only; lists that turn out empty in the frame cost an empty dispatch and are reported after it.

mod methods;
pub(crate) mod proofs;

use crate::Result;
use crate::light_view::Warp;
pub use crate::methods::facet_masks::Extent;
use crate::methods::facet_masks::{FacetMode, Settings};
use crate::methods::prepared::Prepared;
use crate::pixel_filter::PixelFilter;
use crate::scene::{Camera, Light};
use crate::stages::cluster_culling::CLUSTER;
pub(crate) use proofs::asks_for_most;
use proofs::{all_is_lit, back_faces_add_nothing, no_shadow, nothing_seen};

/// A stage, or a part of one that can be left out by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanStep {
    /// The stage; parts of it follow a dot.
    pub name: &'static str,
    /// Its purpose.
    pub purpose: &'static str,
    /// Why it is not needed; `None` where it runs.
    pub left_out: Option<String>,
}

/// Stages that run, or are left out, for one scene and one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// How much of the method runs.
    pub extent: Extent,
    /// Every stage of this number of facets a pixel in order, then the parts.
    pub steps: Vec<PlanStep>,
    /// The settings to render with.
    pub settings: Settings,
}

/// The stages in order, what each is for, and the least extent that needs it.
const STAGES: [(&str, &str, Extent); 19] = [
    (CULLING, "clusters of triangles outside the views of camera and light: left out unseen", Extent::Facing),
    ("triangle_setup", "projects vertices; where each triangle lies in both views", Extent::Facing),
    ("camera_visibility", "nearest triangle at every pixel centre", Extent::Facing),
    ("pixel_triangles", "triangles that the samples of each pixel may see", Extent::Facing),
    ("pixel_coverage", "the samples that each of them covers", Extent::Facing),
    ("sample_surfaces", "the surface each sample sees, a facet for each", Extent::Facing),
    (REQUESTS, "blocks of texels that facets ask for: nothing is made in others", Extent::Everything),
    ("light_layers", "two nearest layers at every texel centre", Extent::Everything),
    ("silhouette_mask", "texels that silhouette edges touch", Extent::Everything),
    ("front_layer", "proves which texels are covered by one sheet", Extent::Everything),
    ("summed_area", "counts of marked texels in any rectangle", Extent::Everything),
    ("facet_classify", "facets: dark, lit, shadowed or undecided", Extent::Facing),
    ("pixel_texel_pairs", "texels that undecided facets touch", Extent::Everything),
    ("triangle_texel_pairs", "casters that touch those texels", Extent::Everything),
    ("candidate_pairs", "facets and casters that are worth evaluating", Extent::Everything),
    ("visibility_masks", "occluded and invalid samples", Extent::Everything),
    ("visibility_refine", "the same with 46 bits, where 24 leave it open", Extent::Everything),
    ("resolve", "masks to visibility", Extent::Facing),
    (FILTER, "visibility weighted over the samples of a pixel and its neighbours", Extent::Facing),
];

/// The stage that weighs samples.
const FILTER: &str = "pixel_filter";

/// The stage that leaves casters out by clusters.
const CULLING: &str = "cluster_culling";

/// The stage that finds which part of the light's view the camera asks for.
const REQUESTS: &str = "requested_blocks";

/// The stage that tells between which depths pixels see casters.
const DEPTHS: (&str, &str) = ("seen_depths", "between which depths pixels see casters, for the slices");

/// Parts of stages that a setting or the scene may make needless.
const VALIDITY: (&str, &str) = ("visibility_masks.validity", "drops samples that see another surface than the centre");
const MERGE: (&str, &str) = ("sample_surfaces.merge", "takes neighbouring triangles of one plane as one surface");
const SETTLE: (&str, &str) = ("facet_classify.settle", "settles facets that need no evaluation");
const BACK_FACING: (&str, &str) =
    ("triangle_setup.back_facing", "casters of closed bodies that face away from the light");
const HIDDEN: (&str, &str) =
    ("triangle_setup.hidden_backs", "triangles of closed bodies that face away from the camera");
const PERSPECTIVE: (&str, &str) = ("vertex_project.divide", "perspective divide of the light view");

impl Plan {
    /// Plan for rendering `prepared`. `wanted` says what is asked for: with `cull_back` the plan may leave out casters
    /// that face away from the light. `force_all` leaves out nothing and settles no facet before evaluation; what [`Settings::hide_backs`]
    /// says stays, as it is part of what a sample sees.
    ///
    /// # Errors
    /// [`crate::Error::Scene`] or [`crate::Error::Config`] if camera, light or settings cannot be used.
    pub fn of(prepared: &Prepared, camera: &Camera, light: &Light, wanted: &Settings, force_all: bool) -> Result<Self> {
        camera.check()?;
        light.check()?;
        wanted.check()?;
        let asked = wanted.facets;
        let everything = (Extent::Everything, String::new());
        let (extent, reason) = if force_all { everything } else { extent_of(prepared, camera, light, wanted) };
        // Where one facet says as much, the others are left out.
        let single = match extent {
            Extent::Everything => one_sample(wanted).filter(|_| !force_all),
            _ => Some(reason.clone()),
        };
        let wanted = &match (wanted.facets, &single) {
            (FacetMode::All, Some(_)) => Settings { facets: FacetMode::One, ..wanted.clone() },
            _ => wanted.clone(),
        };
        let asked_for_all = single.filter(|_| asked == FacetMode::All);
        let every_surface =
            |name: &str| asked_for_all.clone().filter(|_| finds_facets_of(name) == Some(FacetMode::All));
        let needs = |least: Extent| match extent {
            Extent::Nothing => false,
            Extent::Facing => least != Extent::Everything,
            Extent::Everything => true,
        };
        let all_blocks = all_blocks(prepared, camera, wanted, force_all);
        let no_culling = no_culling(prepared, wanted, force_all);
        let mut steps: Vec<PlanStep> = STAGES
            .iter()
            .filter(|(name, ..)| {
                finds_facets_of(name).is_none_or(|mode| mode == wanted.facets) || every_surface(name).is_some()
            })
            .map(|&(name, purpose, least)| {
                let left_out = every_surface(name).or_else(|| (!needs(least)).then(|| reason.clone()));
                let left_out = left_out.or_else(|| all_blocks.clone().filter(|_| name == REQUESTS));
                let left_out = left_out.or_else(|| no_culling.clone().filter(|_| name == CULLING));
                let left_out = left_out.or_else(|| by_itself(wanted).filter(|_| name == FILTER));
                PlanStep { name, purpose, left_out }
            })
            .collect();
        let mut settings = Settings { alpha_tested: !prepared.alpha().is_empty(), ..wanted.clone() };
        settings.request_blocks = all_blocks.is_none();
        settings.focus &= !force_all;
        if force_all {
            settings.least_culled = usize::MAX;
        }
        let mut part = |(name, purpose): (&'static str, &'static str), left_out: Option<String>| {
            let left_out = if needs(Extent::Everything) { left_out } else { Some(reason.clone()) };
            let runs = left_out.is_none();
            steps.push(PlanStep { name, purpose, left_out });
            runs
        };
        // With one sample the kernel keeps no validity mask, forced or not.
        let no_validity = no_validity(wanted);
        settings.validity = part(VALIDITY, no_validity);
        settings.settle = part(SETTLE, no_settling(wanted, settings.validity, force_all));
        let culled = (wanted.cull_back && !force_all).then(|| back_faces_add_nothing(prepared, light)).flatten();
        let culled = culled.map(|why| if settings.validity { why + "; those that may cut a facet stay" } else { why });
        settings.cull_back = culled.is_some();
        part(BACK_FACING, culled);
        let hidden = settings.hide_backs && !force_all && prepared.hides_backs(camera, wanted.size);
        part(
            HIDDEN,
            hidden.then(|| "closed bodies, camera outside: what faces away lies behind what does not".to_owned()),
        );
        if wanted.facets == FacetMode::All {
            part(MERGE, (!prepared.merges()).then(|| "no two neighbouring triangles are coplanar".to_owned()));
        }
        let affine = light.is_directional() && wanted.partition.is_none_or(|plan| plan.warp == Warp::Whole);
        part(PERSPECTIVE, affine.then(|| "directional light: its view is affine".to_owned()));
        if wanted.tells_depths() {
            let (name, purpose) = DEPTHS;
            let left_out = (!needs(Extent::Everything)).then(|| reason.clone());
            let last = steps.iter().position(|s| s.name == "resolve").unwrap_or(steps.len());
            steps.insert(last, PlanStep { name, purpose, left_out });
        }
        Ok(Self { extent, steps, settings })
    }

    /// The stages and parts that are left out, each with the reason.
    pub fn left_out(&self) -> impl Iterator<Item = (&'static str, &str)> {
        self.steps.iter().filter_map(|s| s.left_out.as_deref().map(|reason| (s.name, reason)))
    }
}

/// How much of a frame has to run, and why no more. A frame like the one before asks little: a few triangles, and the mesh's tree.
pub(crate) fn extent_of(prepared: &Prepared, camera: &Camera, light: &Light, wanted: &Settings) -> (Extent, String) {
    if let Some(reason) = nothing_seen(prepared, camera, wanted.size) {
        return (Extent::Nothing, reason);
    }
    let none = match wanted.facets {
        FacetMode::One => no_shadow(prepared, camera, light, wanted.keeps_validity() || wanted.samples.count() == 1),
        FacetMode::All => all_is_lit(prepared, camera, light),
    };
    none.map_or((Extent::Everything, String::new()), |reason| (Extent::Facing, reason))
}

/// The facets a pixel (one or all) for which a stage finds what pixels see; for the other mode, other stages do.
fn finds_facets_of(stage: &str) -> Option<FacetMode> {
    match stage {
        "pixel_triangles" | "pixel_coverage" | "sample_surfaces" => Some(FacetMode::All),
        "camera_visibility" => Some(FacetMode::One),
        _ => None,
    }
}

/// Why the surface at the pixel centre is all that a pixel's samples see.
fn one_sample(wanted: &Settings) -> Option<String> {
    (wanted.samples.count() == 1).then(|| "one sample: it sees what the pixel centre sees".to_owned())
}

/// Why the validity mask cannot change anything or is not wanted.
fn no_validity(wanted: &Settings) -> Option<String> {
    if wanted.facets == FacetMode::All {
        Some("every sample lies in the facet of the surface it sees".to_owned())
    } else if wanted.samples.count() == 1 {
        Some("one sample: the pixel centre is always valid".to_owned())
    } else {
        (!wanted.validity).then(|| "switched off".to_owned())
    }
}

/// Why every triangle is looked at.
fn no_culling(prepared: &Prepared, wanted: &Settings, force_all: bool) -> Option<String> {
    let triangles = prepared.mesh.triangles.len();
    let few = triangles < wanted.least_culled.max(CLUSTER + 1);
    if force_all {
        Some("forced: every triangle is looked at".to_owned())
    } else {
        few.then(|| format!("{triangles} triangles are few"))
    }
}

/// Why the light's maps are made whole.
fn all_blocks(prepared: &Prepared, camera: &Camera, wanted: &Settings, force_all: bool) -> Option<String> {
    if force_all {
        Some("forced: every block is made".to_owned())
    } else if !wanted.request_blocks {
        Some("switched off".to_owned())
    } else {
        let of = |bounds| asks_for_most(camera, wanted.size, bounds, prepared.mesh.triangles.len());
        prepared.tree().bounds().and_then(of)
    }
}

/// Why no samples but its own count for a pixel.
fn by_itself(wanted: &Settings) -> Option<String> {
    (wanted.filter == PixelFilter::Box).then(|| "a box: a pixel is the mean of its own samples".to_owned())
}

/// Why every facet is evaluated. That one is lit or shadowed is proved of its surface alone; samples of its plane that lie
/// off the surface count only where no validity mask drops them.
fn no_settling(wanted: &Settings, validity: bool, force_all: bool) -> Option<String> {
    if force_all {
        Some("forced: every facet is evaluated".to_owned())
    } else if !wanted.settle {
        Some("switched off".to_owned())
    } else {
        (!validity && wanted.samples.count() > 1 && wanted.facets == FacetMode::One)
            .then(|| "without validity masks samples off the surface count, of which nothing is proved".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::methods::UNSEEN;
    use super::*;
    use crate::light_view::SplitPlan;
    use crate::methods::MethodName;
    use crate::samples::{Pattern, Samples};
    use crate::scene::Mesh;
    use crate::test_scenes::{builtin, of_mesh};

    fn settings(samples: u32, validity: bool) -> Settings {
        let samples = Samples::new(Pattern::default(), samples).unwrap();
        Settings { facets: FacetMode::One, validity, cull_back: true, ..Settings::new([64, 48], 64, samples) }
    }

    fn triangles(corners: &[[f32; 3]]) -> Mesh {
        let triangles = (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh { positions: corners.to_vec(), triangles }
    }

    const A: [f32; 3] = [0.0, 0.0, 0.0];
    const B: [f32; 3] = [1.0, 0.0, 0.0];
    const C: [f32; 3] = [0.0, 0.0, 1.0];
    const D: [f32; 3] = [0.3, 1.0, 0.3];

    fn body() -> Mesh {
        triangles(&[A, B, C, A, D, B, B, D, C, C, D, A])
    }

    fn sun(y: f32) -> Light {
        Light::Directional { direction: [0.1, y, 0.2] }
    }

    fn plan(mesh: Mesh, light: Light, settings: &Settings, force: bool) -> Plan {
        let scene = of_mesh(mesh);
        Plan::of(&Prepared::new(&scene.mesh).unwrap(), &scene.camera, &light, settings, force).unwrap()
    }

    fn reason<'a>(plan: &'a Plan, step: &str) -> Option<&'a str> {
        plan.left_out().find(|(name, _)| *name == step).map(|(_, reason)| reason)
    }

    #[test]
    fn an_empty_mesh_needs_nothing() {
        let plan = plan(Mesh::default(), sun(1.0), &settings(32, true), false);
        assert_eq!(plan.extent, Extent::Nothing);
        assert!(plan.steps.iter().all(|s| s.left_out.is_some()), "{plan:?}");
    }

    #[test]
    fn one_plane_casts_nothing_and_two_do() {
        let flat = triangles(&[A, B, C, [2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 0.0, 1.0]]);
        let found = plan(flat.clone(), sun(1.0), &settings(32, true), false);
        assert_eq!(found.extent, Extent::Facing);
        assert_eq!(reason(&found, "camera_visibility"), None);
        assert!(reason(&found, "visibility_masks").unwrap().contains("one plane"));
        let mut bent = flat.clone();
        bent.positions[5][1] = 1e-6;
        assert_eq!(plan(bent, sun(1.0), &settings(32, true), false).extent, Extent::Everything);
        // A plane of any direction, with coordinates that are exact.
        let tilted = Mesh { positions: flat.positions.iter().map(|[x, _, z]| [*x, x + 2.0 * z, *z]).collect(), ..flat };
        assert_eq!(plan(tilted, sun(1.0), &settings(32, true), false).extent, Extent::Facing);
    }

    #[test]
    fn sides_that_are_seen_and_hidden_from_the_light_are_dark() {
        let sheets = || triangles(&[A, C, B, [0.0, 0.5, 0.0], [0.0, 0.5, 1.0], [1.0, 0.5, 0.0]]);
        assert!(
            reason(&plan(sheets(), sun(-1.0), &settings(32, true), false), "light_layers").unwrap().contains("dark")
        );
        assert_eq!(plan(sheets(), sun(1.0), &settings(32, true), false).extent, Extent::Everything);
        assert_eq!(plan(body(), sun(-1.0), &settings(32, true), false).extent, Extent::Everything);
    }

    #[test]
    fn a_mesh_outside_the_view_is_not_looked_at() {
        let mesh = body();
        let mut scene = of_mesh(mesh);
        let prepared = Prepared::new(&scene.mesh).unwrap();
        let of = |camera: &Camera| Plan::of(&prepared, camera, &sun(1.0), &settings(32, true), false).unwrap().extent;
        assert_eq!(of(&scene.camera), Extent::Everything);
        let (eye, target) = (scene.camera.eye, scene.camera.target);
        // Away from the mesh, and to either side of it.
        scene.camera.target = [0, 1, 2].map(|k| 2.0 * eye[k] - target[k]);
        assert_eq!(of(&scene.camera), Extent::Nothing);
        for side in [-30.0, 30.0] {
            scene.camera.target = [target[0] + side, target[1], target[2] - side];
            assert_eq!(of(&scene.camera), Extent::Nothing);
        }
        for up in [-30.0, 30.0] {
            scene.camera.target = [target[0], target[1] + up, target[2]];
            assert_eq!(of(&scene.camera), Extent::Nothing);
        }
    }

    #[test]
    fn a_light_in_a_body_reaches_all_of_it_and_in_two_does_not() {
        let inside = Light::Point { position: [0.3, 0.2, 0.3] };
        let found = plan(body(), inside, &settings(32, true), false);
        assert!(reason(&found, "light_layers").unwrap().contains("meets it once"), "{found:?}");
        let mut nested = body();
        let larger: Vec<[f32; 3]> =
            nested.positions.iter().map(|p| [p[0] * 9.0 - 2.0, p[1] * 9.0 - 2.0, p[2] * 9.0 - 2.0]).collect();
        nested.positions.extend(larger);
        nested.triangles.extend((4..8u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]));
        assert_eq!(plan(nested, inside, &settings(32, true), false).extent, Extent::Everything);
        let outside = Light::Point { position: [0.3, 5.0, 0.3] };
        assert_eq!(plan(body(), outside, &settings(32, true), false).extent, Extent::Everything);
    }

    #[test]
    fn parts_follow_settings_mesh_and_light() {
        let spot = Light::Spot { position: [3.0, 6.0, 2.0], target: [0.0; 3], angle_degrees: 40.0 };
        let of = |light, samples, validity| plan(body(), light, &settings(samples, validity), false);
        let one = of(sun(1.0), 1, true);
        assert!(reason(&one, VALIDITY.0).unwrap().contains("one sample"));
        assert!(reason(&one, PERSPECTIVE.0).unwrap().contains("directional"));
        let warped = SplitPlan { splits: 1, warp: Warp::Fitted, focus: 0.6, ..SplitPlan::default() };
        let warped = Settings { partition: Some(warped), ..settings(1, true) };
        assert_eq!(reason(&plan(body(), sun(1.0), &warped, false), PERSPECTIVE.0), None, "a warp divides");
        assert!(one.settings.cull_back && one.settings.settle && !one.settings.validity);
        let many = of(spot, 32, true);
        assert_eq!(many.left_out().count(), 5, "{many:?}");
        assert!(reason(&many, CULLING).unwrap().contains("4 triangles are few"));
        let few = Settings { least_culled: 1, ..settings(32, true) };
        assert!(reason(&plan(body(), spot, &few, false), CULLING).is_some(), "one cluster");
        assert!(reason(&many, FILTER).unwrap().contains("box"));
        let wide = Settings { filter: PixelFilter::Tent, ..settings(32, true) };
        assert_eq!(reason(&plan(body(), spot, &wide, false), FILTER), None);
        assert!(reason(&many, HIDDEN.0).unwrap().contains("camera outside"));
        assert!(reason(&many, BACK_FACING.0).unwrap().contains("may cut a facet stay"));
        assert!(many.settings.cull_back && many.settings.settle && many.settings.validity);
        let off = of(spot, 32, false);
        assert!(off.settings.cull_back && !off.settings.settle && !off.settings.validity);
        let inside = of(Light::Point { position: [0.3, 0.2, 0.3] }, 1, true);
        assert!(!inside.settings.cull_back, "the shell around a light is all back faces");
        let open = plan(triangles(&[A, B, C, A, D, B]), spot, &settings(1, true), false);
        assert!(!open.settings.cull_back && reason(&open, HIDDEN.0).is_none());
        // A body beside a sheet: its triangles are two thirds. The light has to be outside the body, wherever the sheet is.
        let mut beside = body();
        beside.positions.extend(triangles(&[[-9.0, -9.0, -9.0], [9.0, -9.0, -9.0], [0.0, 9.0, 9.0]]).positions);
        beside.positions.extend(triangles(&[[-9.0, 9.0, 9.0], [9.0, -9.0, 9.0], [0.0, 9.0, -9.0]]).positions);
        beside.triangles.extend([[12, 13, 14], [15, 16, 17]]);
        for (position, outside) in [([3.0, 6.0, 2.0], true), ([0.3, 0.2, 0.3], false), ([0.3, 1.2, 0.3], true)] {
            let plan = plan(beside.clone(), Light::Point { position }, &settings(1, true), false);
            assert_eq!(plan.settings.cull_back, outside, "{position:?}");
            assert_eq!(reason(&plan, BACK_FACING.0).is_some_and(|why| why.contains("66 %")), outside, "{plan:?}");
        }
    }

    #[test]
    fn blocks_are_requested_where_the_camera_sees_a_part() {
        let scene = builtin("windmill");
        let prepared = Prepared::new(&scene.mesh).unwrap();
        let of = |camera: &Camera, wanted: &Settings| Plan::of(&prepared, camera, &sun(1.0), wanted, false).unwrap();
        let wanted = settings(32, true);
        let (low, high) = prepared.mesh().bounds().unwrap();
        let all = of(&Camera::framing(low, high), &wanted);
        assert!(reason(&all, REQUESTS).unwrap().contains("% of the scene"), "{all:?}");
        let near = Camera { eye: [0.3, 0.4, 0.3], target: [1.0, 0.4, 0.3], near: 1e-3, ..scene.camera };
        let part = of(&near, &wanted);
        assert!(reason(&part, REQUESTS).is_none() && part.settings.request_blocks, "{part:?}");
        let off = of(&near, &Settings { request_blocks: false, ..wanted.clone() });
        assert!(reason(&off, REQUESTS).unwrap().contains("switched off") && !off.settings.request_blocks);
        let large = of(&near, &Settings { size: [4000, 3000], ..wanted });
        assert!(reason(&large, REQUESTS).unwrap().contains("few beside 12000000 pixels"), "{large:?}");
    }

    #[test]
    fn few_texels_are_made_where_few_are_asked_for() {
        let scene = of_mesh(body());
        let prepared = Prepared::new(&scene.mesh).unwrap();
        let of = |samples: u32, map: u32, force: bool| {
            let wanted = Settings { map, ..settings(samples, true) };
            Plan::of_method(MethodName::Spsm, &prepared, &scene.camera, &sun(1.0), &wanted, force).unwrap()
        };
        // 64 x 48 pixels: 111 x 111 texels are four a pixel.
        let few = of(1, 111, false);
        assert!(few.settings.spsm.seen_only);
        assert!(reason(&few, UNSEEN.0).unwrap().contains("4.0 texels"), "{few:?}");
        assert!(reason(&few, "seen_texels").is_none() && reason(&few, "spsm_map_around").is_none());
        for (all, why) in [
            (of(1, 110, false), "fewer than 4 texels"),
            (of(8, 111, false), "several samples"),
            (of(1, 111, true), "forced"),
        ] {
            assert!(!all.settings.spsm.seen_only && reason(&all, UNSEEN.0).is_none());
            assert!(reason(&all, "seen_texels").unwrap().contains(why), "{all:?}");
            assert!(reason(&all, "spsm_map").is_none());
        }
    }

    #[test]
    fn forced_runs_every_stage() {
        for mesh in [Mesh::default(), triangles(&[A, B, C]), body()] {
            let forced = plan(mesh, sun(1.0), &settings(32, true), true);
            assert_eq!(forced.extent, Extent::Everything);
            // The searches for blocks and clusters that may be left out, and a filter that is not asked for.
            let other = [CULLING, REQUESTS, FILTER];
            let needed = STAGES.iter().map(|(name, ..)| *name).filter(|name| !other.contains(name));
            assert!(needed.into_iter().all(|name| reason(&forced, name).is_none()), "{forced:?}");
            assert!(reason(&forced, REQUESTS).unwrap().contains("forced") && !forced.settings.request_blocks);
            assert!(reason(&forced, CULLING).unwrap().contains("forced"));
            assert_eq!(forced.settings.least_culled, usize::MAX);
            assert!(forced.settings.validity && !forced.settings.cull_back && !forced.settings.settle);
        }
    }

    #[test]
    fn every_surface_has_stages_of_its_own() {
        let prepared = Prepared::new(&builtin("plane").mesh).unwrap();
        let scene = builtin("plane");
        let wanted = Settings { facets: FacetMode::All, ..settings(32, true) };
        let plan = Plan::of(&prepared, &scene.camera, &scene.light, &wanted, false).unwrap();
        let names: Vec<_> = plan.steps.iter().map(|s| s.name).collect();
        assert!(names.contains(&"pixel_triangles") && names.contains(&"sample_surfaces"), "{names:?}");
        assert!(!names.contains(&"camera_visibility"), "{names:?}");
        assert!(!plan.settings.validity && plan.settings.settle, "coverage replaces validity");
        assert_eq!(reason(&plan, MERGE.0), None);
        let curved = Prepared::new(&body()).unwrap();
        let plan = Plan::of(&curved, &scene.camera, &scene.light, &wanted, false).unwrap();
        assert!(reason(&plan, MERGE.0).unwrap().contains("coplanar"), "{plan:?}");
    }

    #[test]
    fn what_cannot_be_used_is_an_error() {
        let scene = of_mesh(body());
        let prepared = Prepared::new(&scene.mesh).unwrap();
        let no_map = Settings { map: 0, ..settings(1, true) };
        assert!(Plan::of(&prepared, &scene.camera, &sun(1.0), &no_map, false).is_err());
        let dark = Light::Directional { direction: [0.0; 3] };
        assert!(Plan::of(&prepared, &scene.camera, &dark, &settings(1, true), false).is_err());
    }
}
