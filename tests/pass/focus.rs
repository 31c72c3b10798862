//! Views of the light that are cut to what the camera may see in shadow: less work, and the same bits.

use super::kept_maps::{certain, elsewhere};
use super::*;
use glam::{DVec3, Vec3};

/// Work of a pass in its frame: views, pairs of facets and texels, and of casters and texels.
fn work(pass: &ShadowPass, status: &FrameStatus) -> [u64; 3] {
    let of = |list: &str| status.lists.iter().find(|l| l.name == list).map_or(0, |l| l.needed);
    [u64::from(pass.capacities().views), of("pixel_texel_pairs"), of("triangle_texel_pairs")]
}

/// A pass that cuts its views and one that does not, of casters in a vertex buffer.
fn passes(scene: &Scene, facets: FacetMode) -> [ShadowPass; 2] {
    let moving = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    [true, false].map(|focus| pass(Settings { focus, ..settings(facets) }, moving))
}

#[gpu_test]
fn views_cut_to_what_is_seen_change_no_bit() {
    let (mut frames, mut other, mut fewer, mut shadowed) = (0, 0, 0, 0);
    for (name, lamps) in [
        ("windmill", [[0.4, 2.2, 0.3], [9.0, 6.0, 1.0]]),
        ("cage", [[0.5, 2.0, 0.8], [2.0, 9.0, 1.0]]),
        ("spheres", [[0.8, 1.9, 0.9], [6.0, 9.0, 4.0]]),
    ] {
        let scene = scene(name);
        let buffer = vertex_buffer(&scene.mesh.positions);
        let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
        let moved = Some(Moved { vertices, bounds: bounds(&scene.mesh) });
        for facets in [FacetMode::All, FacetMode::One] {
            let mut both = passes(&scene, facets);
            let [among, above] = lamps.map(|position| Light::Point { position });
            for (light, (factor, angle)) in
                [(scene.light, (0.5, 0.3)), (among, (0.4, -0.6)), (among, (3.0, 1.9)), (above, (0.5, 2.2))]
            {
                let camera = Camera { vertical_fov_degrees: 25.0, ..elsewhere(&scene.camera, factor, angle) };
                let inputs = Inputs { moved, ..Inputs::new(&camera, &light) };
                let [cut, whole] = both.each_mut().map(|pass| {
                    let (picture, status) = complete_within(6, pass, &inputs);
                    (certain(facets, &picture), work(pass, &status))
                });
                let what = format!("{name}, {facets:?}, {light:?}, camera {factor} {angle}");
                let wrong = cut.0.0.iter().zip(&whole.0.0).filter(|(a, b)| a != b).count();
                assert_eq!(wrong, 0, "{what}: {wrong} of {} words", whole.0.0.len());
                let views = (cut.1[0], whole.1[0]);
                assert!(views.0 <= views.1, "{what}: {views:?} views");
                (frames, other) = (frames + 1, other + usize::from(cut.1 != whole.1));
                fewer += usize::from(views.0 < views.1);
                let pixels = &whole.0.0[..(SIZE[0] * SIZE[1]) as usize];
                shadowed += usize::from(pixels.contains(&0) && pixels.contains(&1.0f32.to_bits()));
            }
        }
    }
    // The comparison says little where nothing is cut.
    let what = format!("of {frames} frames {other} are cut, {fewer} to fewer views, {shadowed} with light and shadow");
    assert!(other * 2 > frames && fewer > 3 && shadowed * 3 > frames, "{what}");
}

#[gpu_test]
fn casters_that_stand_are_cut_where_little_of_them_is_seen() {
    let scene = scene("windmill");
    let [mut cut, mut whole] =
        [true, false].map(|focus| pass(Settings { focus, ..settings(FacetMode::All) }, casters(&scene.mesh)));
    // Above where the shadow of what it looks at lies on the ground.
    let (towards, aim) = (scene.light.towards(DVec3::ZERO).as_vec3(), Vec3::from(scene.camera.target));
    let ground = aim - towards * (aim.y / towards.y);
    let above =
        Camera { eye: (ground + 0.5 * aim.y * Vec3::new(0.0, 1.0, 0.1)).into(), target: ground.into(), ..scene.camera };
    let mut other = [0, 0];
    for (k, camera) in [scene.camera, above].into_iter().enumerate() {
        let inputs = Inputs::new(&camera, &scene.light);
        for step in 0..2 {
            let [one, two] = [&mut cut, &mut whole].map(|pass| {
                let (picture, status) = complete_within(6, pass, &inputs);
                (picture, work(pass, &status), status.maps_kept)
            });
            assert_same(&format!("camera {k}"), &one.0, &two.0);
            assert!(one.2 || step == 0, "a view that is cut stands, too, with camera and light");
            other[k] = usize::from(one.1 != two.1);
        }
    }
    assert_eq!(other, [0, 1], "all of it is seen from afar, little from near");
}

/// A camera that turns sees another number of a cube's sides: once there was room for the most, no buffer is made.
#[gpu_test]
fn a_turning_camera_makes_no_memory() {
    let scene = scene("cage");
    let mut pass = pass(settings(FacetMode::All), casters(&scene.mesh));
    let light = Light::Point { position: [0.5, 2.0, 0.8] };
    let mut counts = Vec::new();
    let mut laps = [Vec::new(), Vec::new()];
    for lap in &mut laps {
        for step in 0..8u8 {
            let (sin, cos) = (f32::from(step) * 0.8).sin_cos();
            let [x, y, z] = [0.9, 2.1, 0.4];
            let camera = Camera { eye: [x, y, z], target: [x + cos, y - 0.3, z + sin], ..scene.camera };
            let (picture, _) = complete_within(6, &mut pass, &Inputs::new(&camera, &light));
            counts.push(pass.capacities().views);
            lap.push((picture, pass.memory()));
        }
    }
    let [first, second] = laps;
    for (k, (before, now)) in first.iter().zip(&second).enumerate() {
        assert!(before.0 == now.0, "step {k}: another picture");
        assert_eq!(now.1, second[0].1, "step {k}: other buffers");
    }
    assert!(first.windows(2).any(|two| two[0].0 != two[1].0), "a camera that sees the same");
    let (least, most) = (counts.iter().min(), counts.iter().max());
    assert!(least < most, "{counts:?} views");
}
