//! The smallest and the largest that is rendered.

use super::*;

#[gpu_test]
fn tiny_images_obey_the_same() {
    let mut failures = Failures::default();
    for name in ["windmill", "spheres"] {
        let scene = scene(name);
        for size in [[1, 1], [3, 5]] {
            let settings = Settings { size, ..settings(false) };
            let first = render(&scene, &settings);
            assert_eq!(first.visibility.len(), (size[0] * size[1]) as usize);
            let label = |what: &str| format!("{name}, {size:?}, {what}");
            let mesh = disordered(&scene.mesh, 3);
            let other = render_with(&mesh, &scene.camera, &scene.light, &settings, Budget::default());
            failures.compare(&label("order"), &first, &other);
            failures.compare(&label("scale"), &first, &render(&scaled(&scene, 0.125), &settings));
            failures.compare(&label("map"), &first, &render(&scene, &Settings { map: 7, ..settings.clone() }));
            let small = Budget { start: Some(1), ..Budget::default() };
            let grown = render_with(&scene.mesh, &scene.camera, &scene.light, &settings, small);
            failures.compare(&label("lists begun at 1"), &first, &grown);
        }
    }
    failures.report();
}

#[gpu_test]
fn nothing_is_lit() {
    let scene = scene("plane");
    for mesh in [Mesh::default(), Mesh { positions: vec![[0.0; 3]; 4], triangles: Vec::new() }] {
        for settle in [true, false] {
            let output = render_with(&mesh, &scene.camera, &scene.light, &settings(settle), Budget::default());
            assert!(output.visibility.iter().all(|&v| v == 1.0), "an empty scene is lit");
            assert!(output.lit.iter().all(|&l| l == u32::MAX));
            assert_eq!(output.counts.pixel_texel_pairs + output.counts.triangle_texel_pairs, 0);
        }
    }
}

/// The largest map is rendered as any other, in parts where the device binds too little.
#[gpu_test]
fn the_largest_map_is_rendered() {
    let scene = scene("plane");
    let of = |map| Settings { map, ..settings(false) };
    let first = render(&scene, &of(64));
    assert_eq!(difference(&picture(&first), &picture(&render(&scene, &of(LightView::LARGEST_MAP)))), None);
    assert_eq!(difference(&picture(&first), &picture(&render(&scene, &of(64)))), None);
}

/// Settings that cannot be rendered are refused, and the same device renders the next frame.
#[gpu_test]
fn impossible_settings_are_errors() {
    let scene = scene("plane");
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    for (size, map) in [([0, 5], 64), ([80, 60], 0), ([80, 60], LightView::LARGEST_MAP + 1), ([16385, 1], 64)] {
        let bad = Settings { size, map, ..settings(true) };
        let result = Renderer::new(gpu(), &prepared, &bad, Budget::default()).map(|_| ());
        assert!(matches!(result, Err(Error::Config(_))), "{size:?} {map}");
    }
    let mut renderer = Renderer::new(gpu(), &prepared, &settings(true), Budget::default()).expect("a renderer");
    let nowhere = Light::Directional { direction: [0.0; 3] };
    assert!(matches!(renderer.render(&scene.camera, &nowhere), Err(Error::Scene(_))));
    assert!(renderer.render(&scene.camera, &scene.light).is_ok());
}
