//! Bondarev 2014: Shadow Map Silhouette Revectorization.

use super::columns::{BAND, MAP, METHOD, RMSE, SCENE, TIME, TIMES, plot, table};
use super::{CloseUp, Experiment, PLAIN, Place};
use crate::report::comparison::Row;
use crate::report::comparison::plots::Axis;

/// Parts that its experiments have in common.
const BASE: Experiment = Experiment {
    places: &[Place::of("windmill"), Place::of("knot")],
    rows: &["shadow-map", "smsr shape=corners reach=8", "smsr shape=midpoints"],
    maps: &[256],
    ..PLAIN
};

pub const ALL: [Experiment; 3] = [
    Experiment {
        name: "bondarev-6",
        source: "Bondarev 2014, figures 6 and 7",
        title: "A map of 256 x 256, its steps drawn anew",
        shows: "Pictures of shadows from a map of 256 x 256, stepped without and smooth with revectorization.",
        differs: "The paper draws lines from the corners of steps, on the dark side alone: where a step goes up and down again a shadow grows by half a step, and the error with it. Lines through the middles of steps, on both sides, err less than the map itself; both are here.",
        sheet: Some(CloseUp { part: [0.35, 0.5, 0.25, 0.25], zoom: 4, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, TIME, TIMES, RMSE, BAND])],
        ..BASE
    },
    Experiment {
        name: "bondarev-graph-1",
        places: &[Place::of("windmill"), Place::of("knot"), Place::of("plane")],
        source: "Bondarev 2014, graph 1 and figure 8",
        title: "Cost and quality over the search distance",
        shows: "Time of the two passes grows with the largest search distance, on a GTX 580 and a GT 650M; a short search leaves more jagged lines. Its \
                other timings are with a distance of 8: 2.57 ms at 1920 x 1200 on a GTX 580.",
        differs: "Time grows by a quarter over the shadow map's and hardly with the distance: only pixels next to a border follow it, and most borders end before the reach does. A reach of one or two texels does nearly all where shadows are thin or curved (`windmill`, `knot`); on long straight edges (`plane`) longer ones go on to pay.",
        rows: &[
            "shadow-map",
            "smsr reach=1",
            "smsr reach=2",
            "smsr reach=4",
            "smsr reach=8",
            "smsr reach=16",
            "smsr reach=32",
            "smsr reach=64",
        ],
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, TIME, TIMES, RMSE, BAND])],
        plots: |rows| {
            let reach = |r: &Row| r.setting.strip_prefix("reach=").and_then(|n| n.parse().ok()).unwrap_or(0.0);
            let one: Vec<Row> = rows
                .iter()
                .filter(|r| r.method == "smsr")
                .map(|r| Row { method: r.scene.clone(), setting: String::new(), map: reach(r) as u32, ..(*r).clone() })
                .collect();
            let one: Vec<&Row> = one.iter().collect();
            let x = || (Axis::log("search distance, texels"), (|r: &Row| f64::from(r.map)) as fn(&Row) -> f64);
            vec![
                (
                    "time-reach",
                    plot("time over the search distance", x(), (Axis::linear("ms"), |r| Some(r.time())), &one),
                ),
                (
                    "error-reach",
                    plot(
                        "error over the search distance",
                        x(),
                        (Axis::linear("RMSE of the silhouette band"), |r| r.matched.scene_band_rmse),
                        &one,
                    ),
                ),
            ]
        },
        ..BASE
    },
    Experiment {
        name: "bondarev-9",
        source: "Bondarev 2014, section 4.1 and figure 9",
        title: "Maps of 1024, 2048 and 4096, with and without",
        shows: "Revectorizing a small map costs less than a larger one and looks better: time and pictures of 1024, 2048 and 4096 with and without.",
        differs: "As in the paper, revectorizing costs a small part of a larger map: a map of twice the side takes 2 to 3 times as long, lines 1.0 to 1.3 times. But the larger map errs less: on thin shapes what a map lacks is not its steps.",
        maps: &[1024, 2048, 4096],
        tables: |rows| vec![table("", rows, &[SCENE, MAP, METHOD, TIME, TIMES, RMSE, BAND])],
        ..BASE
    },
];
