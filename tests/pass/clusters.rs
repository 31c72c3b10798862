//! Clusters of triangles that lie outside the views of camera and light are left out: less work, and the same bits.

use super::kept_maps::{certain, elsewhere};
use super::*;
use subpixel_shadows::light_view::{SplitPlan, Warp};
use subpixel_shadows::methods::MethodName;

/// A pass that leaves clusters out and one that looks at every triangle, of casters that stand.
fn passes(scene: &Scene, settings: &Settings, keep_maps: bool) -> [ShadowPass; 2] {
    [1, usize::MAX].map(|least_culled| {
        let settings = Settings { least_culled, ..settings.clone() };
        let config = PassConfig { keep_maps, ..PassConfig::new(settings, casters(&scene.mesh)) };
        ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
    })
}

/// Lists and counts of a frame, but for the triangles and edges that were looked at, and evaluations: how many there are depends on which comes first.
fn work(status: &FrameStatus) -> (Counts, Vec<(&'static str, u64)>) {
    let (evaluations, kept, silhouettes) = (0, 0, 0);
    let counts = Counts {
        kept_triangles: kept,
        silhouette_edges: silhouettes,
        visibility_evaluations: evaluations,
        refined_evaluations: evaluations,
        ..status.counts
    };
    let lists = status.lists.iter().filter(|list| list.name != "candidate_pairs");
    (counts, lists.map(|list| (list.name, list.needed)).collect())
}

/// Ways in which a frame is made, and whether maps are kept: else blocks may be requested.
fn ways(facets: FacetMode) -> [(&'static str, Settings, bool); 4] {
    let whole = settings(facets);
    let splits = SplitPlan { splits: 3, warp: Warp::Fitted, ..SplitPlan::default() };
    let slices = Settings { partition: Some(splits), ..whole.clone() };
    let plain = Settings { settle: false, cull_back: false, hide_backs: false, ..whole.clone() };
    [("kept", whole.clone(), true), ("requested", whole, false), ("slices", slices, true), ("backs, too", plain, false)]
}

#[gpu_test]
fn clusters_outside_the_views_change_no_bit() {
    let (mut frames, mut shadowed, mut left_out) = (0, 0, 0);
    for (name, lamps) in [
        ("windmill", [[0.4, 2.2, 0.3], [9.0, 6.0, 1.0]]),
        ("cage", [[0.5, 2.0, 0.8], [2.0, 9.0, 1.0]]),
        ("spheres", [[0.8, 1.9, 0.9], [6.0, 9.0, 4.0]]),
    ] {
        let scene = scene(name);
        let [among, above] = lamps.map(|position| Light::Point { position });
        for (facets, way) in [FacetMode::All, FacetMode::One].into_iter().flat_map(|f| ways(f).map(|way| (f, way))) {
            let [mut culled, mut all] = passes(&scene, &way.1, way.2);
            for (light, (factor, angle)) in
                [(scene.light, (0.5, 0.3)), (scene.light, (0.2, 2.6)), (among, (0.4, -0.6)), (above, (0.5, 2.2))]
            {
                let camera = Camera { vertical_fov_degrees: 30.0, ..elsewhere(&scene.camera, factor, angle) };
                let what = format!("{name}, {facets:?}, {}, {light:?}, camera {factor} {angle}", way.0);
                // The second frame may find the maps of the first in memory.
                for _ in 0..2 {
                    let [some, every] = [&mut culled, &mut all].map(|pass| {
                        let (picture, status) = complete_within(6, pass, &Inputs::new(&camera, &light));
                        (certain(facets, &picture), status)
                    });
                    let wrong = some.0.0.iter().zip(&every.0.0).filter(|(a, b)| a != b).count();
                    assert_eq!(wrong, 0, "{what}: {wrong} of {} words", every.0.0.len());
                    assert_eq!(some.1.maps_kept, every.1.maps_kept, "{what}");
                    assert_eq!(work(&some.1), work(&every.1), "{what}");
                    let looked_at = (some.1.counts.kept_triangles, every.1.counts.kept_triangles);
                    assert_eq!(looked_at.1, 0, "{what}");
                    let silhouettes = [&some.1, &every.1].map(|status| status.counts.silhouette_edges);
                    // Of those that are left out none has texels; in several views each is counted.
                    let most = u64::from(culled.capacities().views) * silhouettes[1];
                    assert!(silhouettes[0] <= most, "{what}: {silhouettes:?}");
                    let triangles = scene.mesh.triangles.len() as u64;
                    let views = u64::from(culled.capacities().views) + 1;
                    frames += 1;
                    left_out += usize::from(looked_at.0 * 4 < views * triangles * 3);
                    let pixels = &every.0.0[..(SIZE[0] * SIZE[1]) as usize];
                    shadowed += usize::from(pixels.contains(&0) && pixels.contains(&1.0f32.to_bits()));
                }
            }
        }
    }
    let what = format!("of {frames} frames {left_out} leave a quarter out, {shadowed} have light and shadow");
    assert!(left_out * 3 > frames && shadowed * 3 > frames, "{what}");
}

/// By every method, of one view of the light and of several.
#[gpu_test]
fn every_method_leaves_them_out() {
    let scene = scene("windmill");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let camera = Camera { vertical_fov_degrees: 30.0, ..elsewhere(&scene.camera, 0.3, 0.4) };
    let among = Light::Point { position: [0.4, 2.2, 0.3] };
    let samples = Samples::new(Pattern::LowDiscrepancy, 8).expect("8 samples");
    let splits = SplitPlan { splits: 2, ..SplitPlan::default() };
    let plain = Settings { facets: FacetMode::One, ..Settings::new(SIZE, 64, samples) };
    let sliced = Settings { partition: Some(splits), ..plain.clone() };
    let (mut frames, mut shadowed, mut left_out) = (0, 0, 0);
    for method in MethodName::ALL {
        for (settings, light) in [(&plain, scene.light), (&sliced, scene.light), (&plain, among)] {
            let [some, all] = [1, usize::MAX].map(|least_culled| {
                let settings = Settings { least_culled, ..settings.clone() };
                let made = Renderer::of_method(gpu(), &prepared, method, &settings, Budget::default());
                made.and_then(|mut renderer| renderer.render(&camera, &light)).expect("a frame")
            });
            let what = format!("{}, {light:?}, {:?}", method.name(), settings.partition);
            let bits = |of: &Output| of.visibility.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let wrong = bits(&some).iter().zip(&bits(&all)).filter(|(a, b)| a != b).count();
            assert_eq!((wrong, bits(&some).len()), (0, all.visibility.len()), "{what}");
            let (kept, triangles) = (some.counts.kept_triangles, scene.mesh.triangles.len() as u64);
            assert!(kept > 0 && all.counts.kept_triangles == 0, "{what}: {kept}");
            left_out += usize::from(kept * 10 < triangles * 19);
            frames += 1;
            shadowed += usize::from(all.visibility.contains(&0.0) && all.visibility.contains(&1.0));
        }
    }
    let what = format!("of {frames} frames {left_out} leave many out, {shadowed} have light and shadow");
    assert!(shadowed * 3 > 2 * frames && left_out * 4 > frames, "{what}");
}

/// Of casters that move boxes are made anew where they are.
#[gpu_test]
fn casters_that_move_are_left_out_where_they_are() {
    let (mut left_out, mut shadowed, mut frames) = (0, 0, 0);
    for name in ["windmill", "spheres"] {
        let scene = scene(name);
        let casters = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
        let [mut some, mut all] =
            [1, usize::MAX].map(|least_culled| pass(Settings { least_culled, ..settings(FacetMode::All) }, casters));
        let triangles = scene.mesh.triangles.len() as u64;
        let among = Light::Point { position: [0.5, 2.0, 0.8] };
        for (k, (light, angle)) in [(scene.light, 0.3), (among, 1.4), (scene.light, 2.6)].into_iter().enumerate() {
            // The upper half turns away from where it was.
            let turned = |&[x, y, z]: &[f32; 3]| {
                let (sin, cos) = (if y > 0.7 { 0.4 * k as f32 } else { 0.0 }).sin_cos();
                [cos * x - sin * z, y, sin * x + cos * z]
            };
            let mesh = Mesh { positions: scene.mesh.positions.iter().map(turned).collect(), ..scene.mesh.clone() };
            let buffer = vertex_buffer(&mesh.positions);
            let moved =
                Some(Moved { vertices: Vertices { buffer: &buffer, offset: 16, stride: 32 }, bounds: bounds(&mesh) });
            let camera = Camera { vertical_fov_degrees: 25.0, ..elsewhere(&scene.camera, 0.4, angle) };
            let inputs = Inputs { moved, ..Inputs::new(&camera, &light) };
            let [(got, status), (want, whole)] = [&mut some, &mut all].map(|pass| complete_within(6, pass, &inputs));
            assert_same(&format!("{name}, {light:?}, {angle}"), &got, &want);
            assert_eq!(work(&status), work(&whole), "{name}, {light:?}, {angle}");
            let kept = status.counts.kept_triangles;
            assert!(kept > 0 && whole.counts.kept_triangles == 0);
            let views = u64::from(some.capacities().views) + 1;
            frames += 1;
            left_out += usize::from(kept * 4 < views * triangles * 3);
            let pixels = &want.0[..(SIZE[0] * SIZE[1]) as usize];
            shadowed += usize::from(pixels.contains(&0) && pixels.contains(&1.0f32.to_bits()));
        }
    }
    assert!(left_out * 3 > frames && shadowed * 2 > frames, "{left_out} and {shadowed} of {frames}");
}
