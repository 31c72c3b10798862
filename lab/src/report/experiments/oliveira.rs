//! Oliveira 2009: Analysis and Proposal of a Shadow Mapping Remix Approach.

use super::columns::{
    ACNE, BAND, FLICKER, JUMP, LEAKS, MAP, METHOD, PARTLY, RMSE, SAMPLES, SCENE, TIME, TIMES, of_paper, table,
};
use super::{CloseUp, Experiment, PLAIN, Place, Table};
use crate::report::comparison::Row;

/// Parts that its experiments have in common.
const BASE: Experiment = Experiment { ..PLAIN };

/// The thesis's two scenes, made from its descriptions.
const SCENES: [Place; 2] = [Place::of("sparse-city"), Place::of("treeline")];

/// Light that runs along the walls of every building.
const ALONG: Place =
    Place { label: "light along walls", scene: "sparse-city", options: "--light directional=0.05,0.6,0.8" };

/// Light from behind the eye, where no warp helps and only texels do.
const BEHIND: Place = Place { label: "light behind", scene: "sparse-city", options: "--light directional=0.21,0.2,1" };

/// A problem of table 1: its name, what is measured of a row, with how many samples a pixel, where, and whether a method
/// with such a figure solves it beside what the plain shadow map has.
struct Problem {
    name: &'static str,
    value: fn(&Row) -> f64,
    samples: u32,
    place: &'static str,
    solved: fn(f64, f64) -> bool,
    digits: usize,
}

/// From far above, so that near and far are one, in light that runs along the ground.
const FLAT: Place = Place {
    label: "light along the ground",
    scene: "bumpy",
    options: "--camera eye=0,60,0.1;target=0,0,0;fov=6 --light directional=1,0.12,0.3",
};

/// An error counts as solved where less than three quarters of the shadow map's are left.
const PROBLEMS: [Problem; 6] = {
    const ERROR: Problem = Problem {
        name: "perspective aliasing",
        value: |r| r.matched.scene_rmse,
        samples: 8,
        place: SCENES[0].label,
        solved: |own, plain| own < 0.75 * plain,
        digits: 3,
    };
    [
        ERROR,
        Problem { name: "projection aliasing", place: FLAT.label, ..ERROR },
        Problem { name: "texture resolution", place: BEHIND.label, ..ERROR },
        Problem {
            name: "self-shadowing",
            value: |r| 100.0 * r.matched.scene_acne_pixels as f64 / r.matched.scene_pixels.max(1) as f64,
            place: "spheres",
            solved: |own, _| own < 0.01,
            ..ERROR
        },
        Problem {
            name: "continuity",
            value: |r| r.flicker.map_or(f64::NAN, |f| f.jump),
            // Texels of one map for all stand.
            solved: |own, plain| own <= 1.25 * plain,
            digits: 4,
            ..ERROR
        },
        Problem {
            name: "binary status",
            value: |r| 100.0 * r.partly_lit,
            samples: 1,
            solved: |own, _| own > 0.0,
            digits: 1,
            ..ERROR
        },
    ]
};

/// The thesis's marks, and the row that stands for each of its techniques; of its own it gives none.
const MARKS: [(&str, &str, [&str; 6]); 7] = [
    ("SSM", "shadow-map", ["✗", "✗", "✗", "✗", "(N.A.)", "✗"]),
    ("PSM", "perspective", ["✓", "✗", "✗", "✗", "✗", "✗"]),
    ("TSM", "trapezoidal", ["✓", "✗", "✗", "✓", "✓", "✗"]),
    ("PSSM", "parallel-split splits=3", ["✗", "✗", "✓", "✓", "✗", "✗"]),
    ("VSM", "variance", ["✗", "✗", "✗", "✓", "✓", "✓"]),
    ("SMRA", "remix warp=trapezoid grazing=5", [""; 6]),
    ("", "facet-masks facets=all", [""; 6]),
];

/// Table 1: of each technique and problem our figure and mark, behind them the thesis's.
fn problems(rows: &[&Row]) -> Table {
    let value = |series: &str, problem: &Problem| {
        let own =
            rows.iter().filter(|r| r.series() == series && r.samples == problem.samples && r.scene == problem.place);
        own.map(|r| (problem.value)(r)).next()
    };
    let cell = |series: &str, (problem, mark): (&Problem, &&str)| {
        let (Some(own), Some(plain)) = (value(series, problem), value("shadow-map", problem)) else {
            return "–".to_owned();
        };
        let ours = if (problem.solved)(own, plain) { "✓" } else { "✗" };
        let theirs = if mark.is_empty() { String::new() } else { format!(" / {mark}") };
        format!("{own:.*} {ours}{theirs}", problem.digits)
    };
    let line = |(name, series, marks): &(&str, &str, [&str; 6])| {
        let cells = PROBLEMS.iter().zip(marks).map(|pair| cell(series, pair));
        [(*name).to_owned(), (*series).to_owned()].into_iter().chain(cells).collect()
    };
    let title = "Figure and mark here, behind the stroke the thesis's mark. Perspective aliasing: RMSE on `sparse-city`; projection aliasing: RMSE on `bumpy` from far \
                 above, in light along the ground; texture resolution: RMSE with the light behind; self-shadowing: per cent of pixels of `spheres`; continuity: the greatest change \
                 of RMSE on `sparse-city` from a frame to the next, while the camera goes aside by a pixel a frame; binary status: per cent of pixels \
                 that are partly lit with one sample.";
    Table {
        title: title.to_owned(),
        head: ["thesis", "here"].into_iter().chain(PROBLEMS.iter().map(|p| p.name)).collect(),
        lines: MARKS.iter().map(line).collect(),
    }
}

pub const ALL: [Experiment; 4] = [
    Experiment {
        name: "oliveira-1",
        source: "Oliveira 2009, table 1",
        title: "Which technique solves which problem",
        shows: "Perspective and trapezoidal maps solve perspective aliasing; nothing solves projection aliasing; slices alone solve that texels are few; trapezoids, slices and variance \
                shadow themselves no more; trapezoids and variance are continuous, perspective maps and slices are not; variance alone is not binary. The remix shall \
                join what trapezoids, slices and variance solve.",
        differs: "Marks are ours where a figure says so: an error is solved where less than three quarters of the plain map's are left, self-shadowing where less than a pixel in ten \
                  thousand has it, continuity where the error jumps at most a quarter more than that of the plain map, whose texels stand. **Perspective aliasing**: slices have \
                  it solved as well as any warp, as each has a map for what is near; the thesis counts them for resolution alone. **Projection aliasing**: none, as in the thesis; \
                  variance is nearest by blur. **Texture resolution**: as in the thesis; with the light behind no warp can help. **Self-shadowing**: the thesis's plain map has a \
                  constant bias; here every method compares with the receiver's plane, so that all have it solved but the remix, whose half light on grazed surfaces is such a \
                  shadow by intent. **Continuity**: as in the thesis but for trapezoids, which jump most: here each is fitted to what is seen of the scene's box, not to the frustum, \
                  and so is the remix's. **Binary status**: as in the thesis; `facet-masks` is binary with one sample and has as many steps as samples with more.",
        places: &[SCENES[0], FLAT, BEHIND, Place::of("spheres")],
        rows: &[
            "shadow-map",
            "perspective",
            "trapezoidal",
            "parallel-split splits=3",
            "variance",
            "remix warp=trapezoid grazing=5",
            "facet-masks facets=all",
        ],
        samples: &[1, 8],
        moves: Some(("sparse-city", 12)),
        sheet: Some(CloseUp { part: [0.2, 0.3, 0.35, 0.35], zoom: 1, gain: 1.0 }),
        tables: |rows| {
            vec![
                problems(rows),
                table("All rows:", rows, &[SCENE, SAMPLES, METHOD, RMSE, LEAKS, ACNE, FLICKER, JUMP, PARTLY, TIME]),
            ]
        },
        ..BASE
    },
    Experiment {
        name: "oliveira-46",
        source: "Oliveira 2009, figure 46 and section 4.2.2",
        title: "Where light grazes: half of it taken as lit",
        shows: "Black stripes on walls along the light, which a shadow map cannot resolve, before; a solid shade after, where the light stands less than five \
                degrees over a surface.",
        differs: "The rule hides stripes and does not find the shadow: walls that are wholly lit or dark become half so. Where light runs along walls it doubles the error of one map and quadruples that of three; elsewhere hardly a surface that is seen lies so, and nothing changes. There are few stripes to hide here, as depths are compared with the receiver's plane.",
        places: &[ALONG, SCENES[0], SCENES[1]],
        rows: &["variance", "variance grazing=5", "remix warp=trapezoid", "remix warp=trapezoid grazing=5", "remix"],
        sheet: Some(CloseUp { part: [0.0, 0.0, 0.55, 0.55], zoom: 2, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, RMSE, BAND, LEAKS, ACNE])],
        ..BASE
    },
    Experiment {
        name: "oliveira-52",
        source: "Oliveira 2009, figures 52 to 54",
        title: "Three slices, as seen from the camera",
        shows: "Three slices one behind the other by the practical scheme, in red, green and blue; the nearest is a small part of the depth and the greater part of the image. \
                Slices solve that texels are few, trapezoids within them that the near ones are.",
        differs: "Scenes and cameras are made from the thesis's descriptions. On `sparse-city` the nearest slice takes most of the image, as there. `treeline` has its trees at one depth: \
                  two slices share them, and no scheme helps. Around what can be in shadow lies ground that no map holds, which asks the slice it is least far out of and is lit. A trapezoid within each slice \
                  errs about as much as none on `sparse-city` and more on `treeline`. Two maps of frustum faces err as three slices do.",
        places: &SCENES,
        rows: &[
            "shadow-map",
            "trapezoidal",
            "parallel-split splits=3",
            "shadow-map splits=3 warp=trapezoid",
            "shadow-map partition=frustum-faces",
        ],
        views: true,
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, RMSE, BAND, LEAKS, TIME, TIMES])],
        ..BASE
    },
    Experiment {
        name: "oliveira-table-2",
        source: "Oliveira 2009, table 2",
        title: "Speed of the remix and of what it is made of",
        shows: "Frames a second, by scene and map. The remix is the slowest but for PSSM on TreeLine, and acceptable.",
        differs: "The scenes are made from the thesis's descriptions. The order is nearly its own: trapezoids cost nothing, moments a little, three maps about twice, the remix most. With a map of 2048 the remix falls further behind than there: no hardware fills a map here, so that its moments cost as many texels as it has. The thesis does not measure errors: three slices have the least, the remix leaks on `treeline`.",
        places: &SCENES,
        rows: &[
            "shadow-map",
            "trapezoidal",
            "parallel-split splits=3",
            "variance",
            "remix warp=trapezoid grazing=5",
            "remix",
        ],
        samples: &[1],
        maps: &[512, 1024, 2048],
        tables: |rows| {
            let paper: [&[&str]; 6] = [
                &["SparseCity", "512", "102", "88", "85", "98", "79"],
                &["SparseCity", "1024", "98", "84", "78", "96", "64"],
                &["SparseCity", "2048", "97", "70", "63", "88", "49"],
                &["TreeLine", "512", "78", "56", "27", "77", "40"],
                &["TreeLine", "1024", "74", "54", "26", "74", "38"],
                &["TreeLine", "2048", "72", "52", "24", "68", "36"],
            ];
            let head = ["scene", "map", "SSM", "TSM", "PSSM", "VSM", "SMRA"];
            vec![
                table("Measured, milliseconds a frame:", rows, &[SCENE, MAP, METHOD, TIME, TIMES, RMSE]),
                of_paper("The paper's, frames a second:", &head, &paper),
            ]
        },
        ..BASE
    },
];
