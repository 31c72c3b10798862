//! Images in strips.

use super::*;

/// An image in strips of rows, which overlap where they do not divide it, is the image in one piece.
#[gpu_test]
fn strips_do_not_matter() {
    let mut failures = Failures::default();
    for (name, facets) in scenes().flat_map(|name| [(name, FacetMode::One), (name, FacetMode::All)]) {
        let scene = scene(name);
        let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
        let settings = Settings { facets, ..settings(true) };
        let pipelines = Arc::new(Pipelines::new(&gpu().device, &settings));
        let with = |strips| {
            let (budget, pipelines) = (Budget::default(), pipelines.clone());
            let mut renderer =
                Renderer::in_strips(gpu(), &prepared, &settings, budget, pipelines, strips).expect("a renderer");
            assert_eq!(renderer.strips(), strips);
            renderer.render(&scene.camera, &scene.light).expect("a frame")
        };
        let whole = with(1);
        assert!(whole.counts.visibility_evaluations > 0, "{name}: nothing was evaluated");
        for strips in [2, 7] {
            let cut = with(strips);
            failures.compare(&format!("{name}, {facets:?}, {strips} strips"), &whole, &cut);
            assert_eq!(cut.triangles, whole.triangles, "{name}");
            if SIZE[1].is_multiple_of(strips) {
                assert_eq!(cut.counts.facets, whole.counts.facets, "{name}");
            }
        }
    }
    failures.report();
}

/// A device that binds little renders in strips by itself, and cuts the light's map into parts.
#[gpu_test]
fn a_device_that_binds_little_renders_in_strips_and_parts() {
    let scene = scene("spheres");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let limits = Limits { max_storage_buffer_binding_size: 1 << 19, ..Limits::default() };
    let small = Gpu::open_with_limits(None, Some(limits)).expect("a GPU");
    let among = Light::Point { position: [0.8, 1.9, 0.9] };
    for (facets, light, map, across) in [
        (FacetMode::One, scene.light, 64, 1),
        (FacetMode::One, scene.light, 512, 2),
        (FacetMode::All, scene.light, 64, 1),
        (FacetMode::All, among, 512, 2),
    ] {
        let settings = Settings { facets, map, ..settings(true) };
        let mut renderer = Renderer::new(&small, &prepared, &settings, Budget::default()).expect("a renderer");
        let output = renderer.render(&scene.camera, &light).expect("a frame");
        assert!(renderer.strips() > 1, "{facets:?}: one binding was enough");
        assert_eq!(renderer.parts().across(), across, "{facets:?}, a map of {map}");
        let whole = render_with(&scene.mesh, &scene.camera, &light, &settings, Budget::default());
        // Of one facet a pixel, which samples see other surfaces is not looked at once it is settled as lit.
        let words = |output: &Output| match facets {
            FacetMode::One => output.visibility.iter().map(|v| v.to_bits()).collect(),
            FacetMode::All => picture(output),
        };
        assert_eq!(difference(&words(&whole), &words(&output)), None, "{facets:?} {light:?} {map}");
        assert_eq!(output.counts.silhouette_edges, whole.counts.silhouette_edges);
    }
}

/// Also where nothing casts a shadow.
#[gpu_test]
fn strips_do_not_matter_where_nothing_casts() {
    let scene = scene("spheres");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let limits = Limits { max_storage_buffer_binding_size: 1 << 19, ..Limits::default() };
    let small = Gpu::open_with_limits(None, Some(limits)).expect("a GPU");
    let settings = Settings { size: [131, 97], ..settings(true) };
    let render = |gpu: &Gpu| {
        let (mut looks, mut strips) = (DebugViews::default(), 0);
        let mut renderer = Renderer::facing(gpu, &prepared, &settings).expect("a renderer");
        let output = renderer.render_and(&scene.camera, &scene.light, &mut |made, rows| {
            strips = if rows.first == 0 { 1 } else { strips + 1 };
            looks.add_rows(gpu, made, settings.size[0], rows)
        });
        (output.expect("a frame"), looks, strips)
    };
    let ((whole, seen, one), (cut, seen_cut, several)) = (render(gpu()), render(&small));
    assert!(one == 1 && several > 2, "{one} and {several} strips");
    assert_eq!(difference(&picture(&whole), &picture(&cut)), None);
    assert!(whole.triangles == cut.triangles && seen == seen_cut);
    assert!(whole.counts.dark_facets > 100 && whole.counts.lit_facets > 100, "{:?}", whole.counts);
}
