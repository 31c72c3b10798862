//! Memory that is refused, and devices that are lost: a clear error, and then the right picture.

#[path = "shared/frames.rs"]
mod frames;
#[path = "../examples/shared/refused.rs"]
mod refused;

use refused::Told;
use subpixel_shadows::Error;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::gpu::faults::Refusal;
use subpixel_shadows::methods::FacetMode;
use subpixel_shadows::scene::{Scene, builtin};

fn scene(name: &str) -> Scene {
    builtin(name).expect("a built-in scene")
}

/// Of the smallest scene many requests, with both ways to refuse and both facet modes; of each other scene some of a renderer's.
/// `cargo run --release --example refused_memory` refuses each of all scenes.
#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn a_refused_request_is_an_error_and_no_more() {
    let gpu = Gpu::open(None).expect("a GPU");
    let mut all = [0, 0];
    let mut take = |name: &str, facets, refusal, told: Result<Told, Error>| {
        let told = told.unwrap_or_else(|e| panic!("{name}, {facets:?}, {refusal:?}: {e}"));
        assert!(told.asked > 60, "{name}, {facets:?}: {} requests: not all are counted", told.asked);
        // What the device refuses is always said, unless it was for lists that suffice as they are.
        let silent = told.absorbed > 1 + told.refused / 8;
        assert!(refusal == Refusal::Limit || !silent, "{name}, {facets:?}: {told:?}");
        all = [all[0] + told.refused, all[1] + told.absorbed];
    };
    let plane = scene("plane");
    for facets in [FacetMode::One, FacetMode::All] {
        for (refusal, step) in [(Refusal::Device, 5), (Refusal::Limit, 17)] {
            take("plane", facets, refusal, refused::renderer(&gpu, &plane, facets, 1, step, refusal));
            take("plane", facets, refusal, refused::pass(&gpu, &plane, facets, 2, step, refusal));
        }
    }
    for (k, name) in (0..).zip(["spheres", "plant", "bicycle", "windmill", "cage", "knot", "bumpy", "city"]) {
        let (facets, refusal) = (FacetMode::All, Refusal::Device);
        take(name, facets, refusal, refused::renderer(&gpu, &scene(name), facets, 7 + 5 * k, 53, refusal));
    }
    assert!(all[0] > 150 && all[1] < all[0], "{all:?}");
}

/// Some of the requests of a pass as it is made, with pipelines of its own.
#[test]
#[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]
fn a_pass_that_cannot_be_made_is_an_error() {
    let gpu = Gpu::open(None).expect("a GPU");
    for (facets, first, step) in [(FacetMode::One, 3, 41), (FacetMode::All, 5, 47)] {
        let told =
            refused::new_pass(&gpu, &scene("plane"), facets, first, step, Refusal::Device).expect("one error each");
        assert!(told.refused >= 2 && told.absorbed == 0, "{facets:?}: {told:?}");
    }
}
