//! Worlds in which a sample was wrong once: random worlds found them, and made them smaller (`subpixel-shadows fuzz`).

use lab::fuzz::{FuzzCase, FuzzDevice, How, Kind, World, judge};
use lab::scene::{CameraOverride, Scene, SceneOptions};
use std::path::Path;
use subpixel_shadows::methods::{FacetMode, MethodName, Settings};
use subpixel_shadows::render::Budget;
use subpixel_shadows::samples::{Pattern, Samples};
use test_support::gpu;
use test_support::gpu_test;

/// A world of `tests/found`, and how it was rendered.
struct Found {
    name: &'static str,
    method: MethodName,
    facets: FacetMode,
    size: [u32; 2],
    map: u32,
    samples: (Pattern, u32),
}

const ONE: FacetMode = FacetMode::One;
const ALL: FacetMode = FacetMode::All;
const LOW: Pattern = Pattern::LowDiscrepancy;

#[rustfmt::skip]
const FOUND: [Found; 27] = [
    // The view of a light held no caster nearer to it than a ten-thousandth of the farthest.
    Found { name: "caster-near-a-light", method: MethodName::FacetMasks, facets: ALL, size: [2, 35], map: 1, samples: (LOW, 16) },
    // A facet goes on beyond its surface and the view of the light, where what the view leaves out shadows or cuts it.
    Found { name: "valley-at-an-end", method: MethodName::FacetMasks, facets: ONE, size: [1, 5], map: 1, samples: (LOW, 8) },
    // Beside the light's view, but for the box around it, a facet is lit as a whole: truth drops and shadows a sample beneath its neighbour.
    Found { name: "beyond-the-lights-view", method: MethodName::FacetMasks, facets: ONE, size: [1, 6], map: 1, samples: (Pattern::Grid, 8) },
    // Of heights over a facet single precision knew the signs, but not the ratio by which a cut ends along an edge.
    Found { name: "ends-of-a-cut", method: MethodName::FacetMasks, facets: ONE, size: [26, 9], map: 1, samples: (LOW, 8) },
    Found { name: "end-of-a-view", method: MethodName::FacetMasks, facets: ONE, size: [1, 2], map: 8, samples: (LOW, 8) },
    Found { name: "plane-beyond-the-view", method: MethodName::Supersampled, facets: ONE, size: [15, 3], map: 16, samples: (LOW, 8) },
    // Heights over a facet left out how far its point may lie off its plane.
    Found { name: "light-along-a-large-facet", method: MethodName::FacetMasks, facets: ALL, size: [4, 24], map: 1, samples: (LOW, 1) },
    // Of two surfaces in one place truth takes the light of the one, the frame that of the other.
    Found { name: "stand-in", method: MethodName::FacetMasks, facets: ALL, size: [1, 3], map: 1, samples: (Pattern::Rotated, 16) },
    // Both sheets lie so near to the near distance that only 46 bits tell that they are seen.
    Found { name: "sheets-at-the-near-distance", method: MethodName::FacetMasks, facets: ONE, size: [20, 6], map: 1, samples: (LOW, 1) },
    // The samples of a texel were not held against what reaches behind the light.
    Found { name: "ground-behind-the-light", method: MethodName::Supersampled, facets: ONE, size: [1, 2], map: 1, samples: (LOW, 1) },
    // Rounding opens a gap between two surfaces, and what lies behind shows.
    Found { name: "gap-before-a-wall", method: MethodName::FacetMasks, facets: ALL, size: [9, 31], map: 1, samples: (LOW, 8) },
    // Two surfaces, one behind the other, end at one line of the image: rounding takes a sample off both, or off one.
    Found { name: "end-behind-an-end", method: MethodName::FacetMasks, facets: ALL, size: [18, 4], map: 1, samples: (Pattern::Grid, 8) },
    // A facet of several triangles in one plane names one of them, not that of the sample.
    Found { name: "rim-of-a-thin-plate", method: MethodName::FacetMasks, facets: ALL, size: [1, 1], map: 1, samples: (Pattern::Grid, 32) },
    // The view of the light left a sheet out that is 2^-38 of its size above another.
    Found { name: "sheet-under-a-sheet", method: MethodName::RayTraced, facets: ONE, size: [2, 6], map: 1, samples: (LOW, 8) },
    // The eye lies in the plane of a triangle as far as 46 bits tell: whether its lit side is seen is open.
    Found { name: "sliver-seen-edge-on", method: MethodName::FacetMasks, facets: ALL, size: [1, 6], map: 1, samples: (Pattern::Rotated, 8) },
    // Of three surfaces the first was as good as the second, a sliver, and that as the third, but the third not as the first.
    Found { name: "four-in-one-plane", method: MethodName::FacetMasks, facets: ALL, size: [8, 18], map: 1, samples: (LOW, 8) },
    // Single precision does not know on which side of a sliver's plane the eye is.
    Found { name: "sliver-through-the-eye", method: MethodName::FacetMasks, facets: ONE, size: [9, 6], map: 1, samples: (LOW, 1) },
    // The doubt of a depth was left out of what a plane's slopes, which share it, add to the inverse depth over a pixel.
    Found { name: "slopes-near-the-eye", method: MethodName::FacetMasks, facets: ALL, size: [1, 2], map: 1, samples: (LOW, 8) },
    // A ray that meets a triangle behind the eye lies inside the same edges.
    Found { name: "quad-behind-the-eye", method: MethodName::FacetMasks, facets: ALL, size: [2, 8], map: 1, samples: (LOW, 8) },
    // Rounding takes a sample off the edge of what hides another surface, to that.
    Found { name: "edge-on-between-two", method: MethodName::FacetMasks, facets: ONE, size: [13, 5], map: 1, samples: (LOW, 1) },
    // Of two surfaces at the near distance before a ground the nearer is told by how far each is from the other, not from the ground.
    Found { name: "two-at-the-near-distance", method: MethodName::FacetMasks, facets: ALL, size: [11, 8], map: 1, samples: (LOW, 8) },
    // Seen from afar the error of a shadow's line in `f64` is more than the band.
    Found { name: "grazing-from-afar", method: MethodName::RayTraced, facets: ONE, size: [1, 34], map: 1, samples: (Pattern::Rotated, 128) },
    // The CPU engine's lines in `f64` went through the eye, which is 460 times as far as the triangles, nearly one plane, are large.
    Found { name: "one-plane-from-afar", method: MethodName::FacetMasks, facets: ALL, size: [1, 11], map: 1, samples: (Pattern::Grid, 8) },
    // Facet, caster and light lie in one plane but for 10^-8: single precision looked for the caster's hole elsewhere on it.
    Found { name: "hole-in-one-plane", method: MethodName::FacetMasks, facets: ALL, size: [3, 1], map: 1, samples: (Pattern::Grid, 16) },
    Found { name: "hole-in-one-plane", method: MethodName::RayTraced, facets: ALL, size: [3, 1], map: 1, samples: (Pattern::Grid, 16) },
    Found { name: "hole-in-one-plane", method: MethodName::Supersampled, facets: ALL, size: [3, 1], map: 1, samples: (Pattern::Grid, 16) },
    // Truth took a sample for surely shadowed 10^-6 pixels from a crack of 10^-5 between the solid halves of two sheets.
    Found { name: "crack-between-sheets", method: MethodName::FacetMasks, facets: ALL, size: [64, 48], map: 188, samples: (LOW, 128) },
];

fn case(found: &Found) -> FuzzCase {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/found").join(found.name);
    let open = |file: &str| {
        let path = folder.join(file);
        Scene::open(&path.to_string_lossy(), &SceneOptions::default()).expect("a scene")
    };
    let given = ["mesh.ply", "mesh.gltf"].into_iter().find(|file| folder.join(file).exists());
    let (scene, bare) = (open("scene.toml"), open(given.expect("a mesh")));
    let camera = CameraOverride::from(scene.camera);
    let (pattern, count) = found.samples;
    let samples = Samples::new(pattern, count).expect("samples");
    let settings = Settings { facets: found.facets, ..Settings::new(found.size, found.map, samples) };
    let how = How {
        method: found.method,
        setting: String::new(),
        pattern,
        settings,
        budget: Budget::default(),
        force_all: false,
        both: found.method == MethodName::FacetMasks,
    };
    let world =
        World { mesh: bare.mesh, alpha: bare.alpha, ground: scene.ground.is_some(), camera, light: scene.light };
    assert_eq!(world.scene().expect("a scene").camera, scene.camera, "{}", found.name);
    FuzzCase { seed: 0, number: 0, kind: Kind::ALL[0], world, how }
}

#[gpu_test]
fn what_was_wrong_once_is_right() {
    let bench = FuzzDevice::new(gpu());
    for found in &FOUND {
        let case = case(found);
        let shot = bench.render(&case).expect("a frame");
        let verdict = judge(&case, &shot).expect("a judgement");
        assert!(verdict.figures.compared > 0, "{}", found.name);
        assert!(!verdict.fails(), "{}: {:?}", found.name, verdict.faults);
    }
}
