//! Bondarev 2014: Shadow Map Silhouette Revectorization.

use super::columns::{BAND, MAP, METHOD, RMSE, SCENE, TIME, TIMES, plot, table};
use super::{Experiment, PLAIN, Place, Sheet};
use crate::report::comparison::Row;
use crate::report::comparison::plots::Axis;

/// What its experiments have in common.
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
        differs: "The paper draws lines from the corners of steps, on the dark side alone. By that rule shadows shrink or grow by half a step, so lines \
                  through the middles of steps err less; both are here.",
        sheet: Some(Sheet { part: [0.35, 0.5, 0.25, 0.25], zoom: 4, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, TIME, TIMES, RMSE, BAND])],
        ..BASE
    },
    Experiment {
        name: "bondarev-graph-1",
        source: "Bondarev 2014, graph 1 and figure 8",
        title: "Cost and quality over the search distance",
        shows: "Time of the two passes grows with the largest search distance, on a GTX 580 and a GT 650M; a short search leaves more jagged lines. Its \
                other timings are with a distance of 8: 2.57 ms at 1920 x 1200 on a GTX 580.",
        differs: "Only pixels next to a border follow it, and most borders end before the reach does: time barely grows after 8. Error falls until the reach \
                  is as long as the steps of the scene's edges.",
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
        differs: "A map's cost here is that of the texels that pixels ask for, not of its fill rate: a larger map is cheaper beside it than in the paper, \
                  and halves the error, which revectorizing the smaller one does not on thin shapes.",
        maps: &[1024, 2048, 4096],
        tables: |rows| vec![table("", rows, &[SCENE, MAP, METHOD, TIME, TIMES, RMSE, BAND])],
        ..BASE
    },
];
