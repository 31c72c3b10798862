//! Oliveira 2009: Analysis and Proposal of a Shadow Mapping Remix Approach.

use super::columns::{ACNE, BAND, LEAKS, MAP, METHOD, RMSE, SCENE, TIME, TIMES, of_paper, table};
use super::{CloseUp, Experiment, PLAIN, Place};

/// Parts that its experiments have in common.
const BASE: Experiment = Experiment { ..PLAIN };

/// The thesis's two scenes, made from its descriptions.
const SCENES: [Place; 2] = [Place::of("sparse-city"), Place::of("treeline")];

/// Light that runs along the walls of every building.
const ALONG: Place =
    Place { label: "light along walls", scene: "sparse-city", options: "--light directional=0.05,0.6,0.8" };

pub const ALL: [Experiment; 2] = [
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
