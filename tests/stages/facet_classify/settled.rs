//! Settled facets of whole frames against traced rays.

use super::*;
use crate::support::POISON;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::kernels::facet_classify::{FACET_ALONE, STATE_MERGED};

/// Settled facets against rays from points of their own triangle: how many were looked at, and how many are wrong.
fn wrongly_settled(kind: u32, seed: u64, views: u32) -> (usize, usize, [usize; 5]) {
    let mut random = Random::new(seed);
    let mesh = random_scene(kind, &mut random);
    let prepared = Prepared::new(&mesh).expect("a sound mesh");
    let tracer = Tracer::new(prepared.mesh()).expect("a tracer");
    let samples = samples(32);
    let size = [40, 30];
    let settings = Settings { facets: FacetMode::One, validity: false, ..Settings::new(size, 96, samples.clone()) };
    let mut renderer = Renderer::new(gpu(), &prepared, &settings, Budget::default()).expect("a renderer");
    let (mut looked_at, mut wrong, mut states) = (0, 0, [0; 5]);
    for view in 0..views {
        let eye = vector(&mut random).normalize() * (1.5 + 2.0 * unit(&mut random));
        let camera = camera(eye, vector(&mut random) * 0.3, 50.0);
        let light = random_light(view % 2 == 0, &mut random);
        renderer.render(&camera, &light).expect("a frame");
        let facets = renderer.facets().expect("facets").list.read(gpu()).expect("readback");
        let rays = camera.rays(size[0], size[1]);
        for facet in facets {
            states[facet.state as usize] += 1;
            let shadowed = match STATES[facet.state as usize] {
                FacetState::Lit => false,
                FacetState::Shadowed => true,
                _ => continue,
            };
            let [a, b, c] = tracer.corners(facet.triangle).map(|p| p - rays.eye);
            let normal = (b - a).cross(c - a);
            let edges = [a.cross(b), b.cross(c), c.cross(a)];
            for o in samples.offsets() {
                let (x, y) = (facet.pixel % size[0], facet.pixel / size[0]);
                let ray = rays.direction(f64::from(x) + f64::from(o[0]), f64::from(y) + f64::from(o[1]));
                let at = edges.map(|e| e.dot(ray) / e.dot(rays.step_x).hypot(e.dot(rays.step_y)));
                let inside = at.iter().all(|&v| v > 0.01) || at.iter().all(|&v| v < -0.01);
                if !inside {
                    continue;
                }
                let point = rays.eye + ray * (normal.dot(a) / normal.dot(ray));
                let own = facet.triangle;
                let shade = tracer.shade(point, point.length() * 1e-12, light.homogeneous(), &|t| t == own);
                looked_at += 1;
                wrong += usize::from(!shade.touching && shade.occluded != shadowed);
            }
        }
    }
    (looked_at, wrong, states)
}

#[gpu_test]
fn settled_facets_are_never_wrong() {
    let mut total = 0;
    for kind in 0..4 {
        let (looked_at, wrong, states) = wrongly_settled(kind, 100 + u64::from(kind), 24);
        assert_eq!(wrong, 0, "kind {kind}: of {looked_at} points; states {states:?}");
        total += looked_at;
    }
    assert!(total > 100_000, "only {total} points of settled facets");
}

/// A facet is alone, its neighbours' lines unasked, where it is cut to its own triangle: not where it is merged of several, nor where samples
/// beyond it count.
#[gpu_test]
fn alone_are_facets_of_one_triangle() {
    let mut random = Random::new(77);
    for (flags, state, alone) in [
        (0, POISON, false),
        (Frame::CLAMP, 0, true),
        (Frame::CLAMP, STATE_MERGED, false),
        (Frame::CLAMP | Frame::BEYOND, 0, false),
    ] {
        let look = camera(DVec3::new(0.5, 1.2, 2.2), DVec3::ZERO, 50.0);
        let mesh = random_scene(1, &mut random);
        let light = Light::Directional { direction: [0.3, 1.0, 0.2] };
        let mut world = World::new(gpu(), &mesh, look, light, [32, 24], 16, samples(32));
        world.frame.flags |= flags;
        let facets = world.classify_of(&world.seen(), state, &[true; 256], &[Split::Marked; 256]);
        let got = read(gpu(), &facets);
        let undecided = got.facets.iter().zip(&got.undecided).filter(|(f, _)| f.state == FacetState::Undecided as u32);
        assert!(undecided.clone().count() > 50, "{flags}: {} undecided", undecided.count());
        for (facet, more) in undecided {
            assert_eq!(more.tilts & FACET_ALONE != 0, alone, "flags {flags}, state {state}: {facet:?}");
        }
    }
}
