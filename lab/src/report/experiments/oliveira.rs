//! Oliveira 2009: Analysis and Proposal of a Shadow Mapping Remix Approach.

use super::columns::{ACNE, BAND, LEAKS, MAP, METHOD, RMSE, SCENE, TIME, TIMES, of_paper, table};
use super::{Experiment, PLAIN, Place, Sheet};

/// What its experiments have in common.
const BASE: Experiment = Experiment { ..PLAIN };

/// Among the houses, and over them.
const CITY: [Place; 2] = [
    Place { label: "city, street", scene: "city", options: "--camera eye=43.5,2,200;target=43.5,8,-200;fov=60" },
    Place { label: "city", scene: "city", options: "" },
];

pub const ALL: [Experiment; 2] = [
    Experiment {
        name: "oliveira-46",
        source: "Oliveira 2009, figure 46 and section 4.2.2",
        title: "Where light grazes: half of it taken as lit",
        shows: "Black stripes on walls along the light, which a shadow map cannot resolve, before; a solid shade after, where the light stands less than five \
                degrees over a surface.",
        differs: "The rule hides stripes and does not find the shadow: it makes half-shade of what is all lit or all dark, which the error counts. In the \
                  scenes here, where few walls lie along the light, it costs more than it gains.",
        places: &[CITY[1], Place::of("windmill"), Place::of("bumpy")],
        rows: &["variance", "variance grazing=5", "remix warp=trapezoid", "remix warp=trapezoid grazing=5", "remix"],
        sheet: Some(Sheet { part: [0.35, 0.45, 0.25, 0.25], zoom: 3, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, RMSE, BAND, LEAKS, ACNE])],
        ..BASE
    },
    Experiment {
        name: "oliveira-table-2",
        source: "Oliveira 2009, table 2",
        title: "Speed of the remix and of what it is made of",
        shows: "Frames a second, by scene and map. The remix is the slowest but for PSSM on TreeLine, and acceptable.",
        differs: "TreeLine and SparseCity are not to be had; `city` stands for both, among its houses and over them. The paper's methods draw the scene with \
                  hardware; here a map costs what its asked texels cost, so the size of the map says less and the number of maps more.",
        places: &CITY,
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
