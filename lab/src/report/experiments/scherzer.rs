//! Scherzer, Wimmer, Purgathofer 2011: A Survey of Real-Time Hard Shadow Mapping Methods.

use super::columns::{
    ACNE, BAND, FEWER, LEAKS, MAP, MEMORY, METHOD, RMSE, SAMPLES, SCENE, TIME, TIMES, WRONG, plot, table,
};
use super::{CloseUp, Experiment, PLAIN, Place};
use crate::report::comparison::Row;
use crate::report::comparison::plots::Axis;

/// Parts that its experiments have in common.
const BASE: Experiment = Experiment {
    places: &[OVERHEAD],
    tables: |rows| vec![table("", rows, &[SCENE, METHOD, TIME, TIMES, RMSE, BAND, LEAKS, ACNE])],
    ..PLAIN
};

/// A long view with the light overhead: what warps are made for.
const OVERHEAD: Place =
    Place { label: "light overhead", scene: "sparse-city", options: "--light directional=0.25,1,0.05" };
/// The same view with the light behind the eye, where no warp helps.
const BEHIND: Place = Place { label: "light behind", scene: "sparse-city", options: "--light directional=0.21,0.2,1" };

pub const ALL: [Experiment; 7] = [
    Experiment {
        name: "scherzer-11",
        source: "Scherzer, Wimmer, Purgathofer 2011, figure 11",
        title: "Uniform, perspective and light-space perspective maps",
        shows: "Shadows near the eye are coarse with a uniform map; perspective maps are fine near the eye and very coarse farther away; light-space \
                perspective maps are even. Each with a map of 1024 x 1024.",
        differs: "Both warps reach the bound that is put on them here, a factor of 11 between the largest and the least texel, and so are one. Errors are means over the image, in which far and near weigh alike.",
        rows: &["shadow-map warp=even", "perspective", "lispsm", "trapezoidal", "shadow-map warp=fitted"],
        maps: &[1024],
        sheet: Some(CloseUp { part: [0.0, 0.3, 0.5, 0.5], zoom: 2, gain: 1.0 }),
        ..BASE
    },
    Experiment {
        name: "scherzer-15",
        source: "Scherzer, Wimmer, Purgathofer 2011, figures 14 and 15",
        title: "The light behind the eye: warps against slices",
        shows: "With the light from behind a warp gives unsatisfactory results, while slices of the view work as well as anywhere.",
        differs: "As in the survey: camera and light look along one line, there is no direction to warp along, and every warp is the even map. Slices take a third of the error.",
        places: &[BEHIND],
        rows: &[
            "shadow-map warp=even",
            "perspective",
            "lispsm",
            "shadow-map splits=3 warp=even",
            "shadow-map splits=3 warp=lispsm",
            "shadow-map splits=3 warp=fitted",
        ],
        maps: &[1024],
        ..BASE
    },
    Experiment {
        name: "scherzer-17",
        source: "Scherzer, Wimmer, Purgathofer 2011, figure 17",
        title: "Three slices with and without a warp in each",
        shows: "Light-space perspective warps within slices of the view make the result of slices finer still, with the light overhead.",
        differs: "Within a slice near and far differ little, so that a warp moves little: with the light overhead and behind, errors of slices with and without are alike. What one map without slices errs is in `scherzer-18`.",
        places: &[OVERHEAD, BEHIND],
        rows: &[
            "shadow-map splits=3 warp=even",
            "shadow-map splits=3 warp=lispsm",
            "shadow-map splits=3 warp=perspective",
            "shadow-map splits=3 warp=fitted",
        ],
        sheet: Some(CloseUp { part: [0.0, 0.3, 0.5, 0.5], zoom: 2, gain: 1.0 }),
        ..BASE
    },
    Experiment {
        name: "scherzer-18",
        source: "Scherzer, Wimmer, Purgathofer 2011, figure 18",
        title: "Error over the number of maps, by scheme",
        shows: "The factor of texels that a scheme needs for one error, over the number of maps: slices need fewer and fewer, with a warp in each they begin \
                lower with the light overhead; with the light behind only slices help.",
        differs: "As there, slices need few maps with the light behind, where warps do nothing, and a warp is as good as two or three slices with the light overhead; what is left then is the edges of objects, which no map resolves. Here the maps' size is fixed and the error is that of the picture, not a bound of the worst texel. Frustum faces, two maps overhead and four behind, do no more than one warp overhead; with the light behind they have less error than four slices, where the survey has slices ahead: each side has a line to warp along, which the view has not. Without a warp faces are behind slices.",
        places: &[OVERHEAD, BEHIND],
        rows: &[
            "shadow-map splits=1 warp=even",
            "shadow-map splits=2 warp=even",
            "shadow-map splits=3 warp=even",
            "shadow-map splits=4 warp=even",
            "shadow-map splits=1 warp=lispsm",
            "shadow-map splits=2 warp=lispsm",
            "shadow-map splits=3 warp=lispsm",
            "shadow-map splits=4 warp=lispsm",
            "shadow-map splits=1 warp=fitted",
            "shadow-map splits=2 warp=fitted",
            "shadow-map splits=3 warp=fitted",
            "shadow-map splits=4 warp=fitted",
            "shadow-map partition=frustum-faces warp=even",
            "shadow-map partition=frustum-faces warp=lispsm",
            "shadow-map partition=frustum-faces warp=fitted",
        ],
        plots: |rows| {
            let word = |r: &Row, name: &str| {
                let of = |part: &str| part.strip_prefix(name).map(str::to_owned);
                r.setting.split_whitespace().find_map(of).unwrap_or_default()
            };
            let by_maps: Vec<Row> = rows
                .iter()
                .map(|r| {
                    let faces = r.setting.contains("partition=frustum-faces");
                    let kind = if faces { "faces, " } else { "slices, " };
                    let maps = if faces { r.views } else { word(r, "splits=").parse().unwrap_or(0) };
                    Row { setting: kind.to_owned() + &word(r, "warp="), map: maps, ..(*r).clone() }
                })
                .collect();
            let by_maps: Vec<&Row> = by_maps.iter().collect();
            let maps = (Axis::linear("maps"), (|r: &Row| f64::from(r.map)) as fn(&Row) -> f64);
            let error = (Axis::linear("RMSE"), (|r: &Row| Some(r.matched.scene_rmse)) as fn(&Row) -> Option<f64>);
            vec![("error-maps", plot("error over the number of maps", maps, error, &by_maps))]
        },
        ..BASE
    },
    Experiment {
        name: "scherzer-20",
        source: "Scherzer, Wimmer, Purgathofer 2011, figure 20 and section 4.6",
        title: "Temporal reprojection beside light-space perspective",
        shows: "Light-space perspective maps of 1024 x 1024 are good; frames of jittered maps, mixed by the confidence of each look-up, are better, as the \
                map's resolution does not bound them: visibility converges to that of every pixel.",
        differs: "As in the survey. Warped maps take half of the wrong pixels where the camera looks along the ground (light overhead), and none where it looks down upon one object; frames of jittered maps take half after 4 frames everywhere and two thirds to seven eighths after 64, and where a warp helps both together most. What is left is along edges, where the centres of texels have not yet come near enough to a pixel's point, around casters thinner than a texel, which leave a faint shadow over it, and of the bias. Wrong pixels count what partly lit ones lack. A frame costs one stage more, `history`.",
        places: &[OVERHEAD, Place::of("cage"), Place::of("knot")],
        rows: &[
            "shadow-map",
            "lispsm",
            "shadow-map history=4",
            "shadow-map history=16",
            "shadow-map history=64",
            "lispsm history=64",
            "shadow-map history=64 confidence-power=3",
            "shadow-map history=64 confidence-power=16",
        ],
        samples: &[1],
        sheet: Some(CloseUp { part: [0.3, 0.4, 0.3, 0.3], zoom: 3, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, WRONG, FEWER, RMSE])],
        ..BASE
    },
    Experiment {
        name: "scherzer-23",
        source: "Scherzer, Wimmer, Purgathofer 2011, figure 23",
        title: "Percentage-closer filtering",
        shows: "An undersampled map has hard jagged edges; a box of 2 x 2 results removes them.",
        differs: "On `windmill`, whose map of 256 is far too coarse, boxes of 2 and 3 have less error than none, and larger ones more: they are wider than its shadows. On `knot` every box has more: bars cast shadows narrower than it, and where surfaces meet it reaches from the one to the other. With eight samples a pixel part of the filtering is the pixel's own.",
        places: &[Place::of("windmill"), Place::of("knot")],
        rows: &["shadow-map", "pcf kernel=2", "pcf kernel=3", "pcf kernel=5", "pcf kernel=7"],
        samples: &[1, 8],
        maps: &[256],
        sheet: Some(CloseUp { part: [0.35, 0.5, 0.25, 0.25], zoom: 4, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, SAMPLES, METHOD, TIME, TIMES, RMSE, BAND])],
        ..BASE
    },
    Experiment {
        name: "scherzer-24",
        source: "Scherzer, Wimmer, Purgathofer 2011, figure 24 and section 6",
        title: "Light that leaks through filtered depths",
        shows: "Variance maps leak light where a footprint holds several depths; convolution maps do not, and cost 16 pairs of textures; layers of variance \
                remove most leaks.",
        differs: "Leaks are pixels that are dark in truth and lit by half a step of eight bits or more. Convolution has none where depths overlap, as the survey shows, but many near contacts: 16 terms take their step over a sixteenth of all depths, and what still rings counts, too. So it leaks no less than variance here, at three times the time. Four moments leak least of what is as it is published; light taken off (`bleeding`) leaves fewest, and darkens edges.",
        places: &[Place::of("windmill"), Place::of("plant"), Place::of("cage")],
        rows: &[
            "variance",
            "variance bleeding=0.2",
            "layered-variance layers=2",
            "layered-variance layers=4",
            "layered-variance layers=8",
            "convolution terms=4",
            "convolution terms=16",
            "exponential exponent=10",
            "exponential exponent=40",
            "exponential-variance exponent=40",
            "four-moments",
        ],
        tables: |rows| vec![table("", rows, &[SCENE, MAP, METHOD, LEAKS, ACNE, RMSE, BAND, TIME, TIMES, MEMORY])],
        sheet: Some(CloseUp { part: [0.35, 0.5, 0.25, 0.25], zoom: 3, gain: 1.0 }),
        ..BASE
    },
];
