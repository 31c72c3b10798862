//! Lecocq, Marvie, Sourimant, Gautron 2013: Sub-Pixel Shadow Mapping.

use super::columns::{
    ACNE, FEWER, LEAKS, MAP, METHOD, SCENE, TIME, TRIANGLES, WRONG, of_paper, plot, table, times, wrong,
};
use super::{Experiment, PLAIN, Place, Sheet};
use crate::report::comparison::Row;
use crate::report::comparison::plots::Axis;
use crate::report::or_dash;

/// What its experiments have in common.
const BASE: Experiment = Experiment {
    rows: &["shadow-map", "spsm encoding=paper search=near", "spsm"],
    samples: &[1],
    maps: &[512, 1024, 2048, 4096],
    ..PLAIN
};

pub const ALL: [Experiment; 5] = [
    Experiment {
        name: "lecocq-2",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, figure 2",
        title: "Without and with recovery of the silhouette",
        shows: "A shadow map of 1024 x 1024; sub-pixel shadow maps that only meet the triangles stored around a sample; and with the border recovered \
                from what those triangles leave.",
        differs: "Without recovery what no stored triangle covers is lit: holes along the border, where a texel has more triangles than the one that it \
                  keeps. They are the `leaks` that recovery closes; what it draws beyond the true border is why fewer pixels are not as few as holes.",
        places: &[Place::of("knot"), Place::of("spheres"), Place::of("windmill")],
        rows: &[
            "shadow-map",
            "spsm encoding=paper search=near recovery=off",
            "spsm encoding=paper search=near",
            "spsm",
        ],
        maps: &[1024],
        sheet: Some(Sheet { part: [0.4, 0.5, 0.2, 0.2], zoom: 4, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, WRONG, FEWER, LEAKS, TIME])],
        ..BASE
    },
    Experiment {
        name: "lecocq-5",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, figures 5 and 6",
        title: "Eight bits of slope: even steps of the angle, or a power of it",
        shows: "With a bias of 1e-5 and eight bits a slope, a shadow map shadows itself everywhere, even steps of the angle leave stripes, and steps by the \
                fifth power leave none.",
        differs: "Here a texel's code knows what it may be off, and a caster must lie before a receiver by that, too. So a coarse code costs no stripes \
                  but shadows that begin too late, which is light where there is none. The paper's power has the fewest.",
        places: &[Place::of("knot"), Place::of("spheres"), Place::of("bumpy")],
        rows: &[
            "spsm encoding=paper search=near slope-power=1",
            "spsm encoding=paper search=near slope-power=3",
            "spsm encoding=paper search=near slope-power=5",
            "spsm encoding=paper search=near slope-power=7",
            "spsm encoding=paper search=near slope-power=9",
            "spsm encoding=lines search=near",
        ],
        maps: &[512],
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, WRONG, FEWER, LEAKS, ACNE])],
        ..BASE
    },
    Experiment {
        name: "lecocq-12",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, figure 12 and section 6.2",
        title: "Pixels as traced, of shadow maps and sub-pixel shadow maps",
        shows: "At 2048 x 2048 99.63 % of the pixels are as traced, of the shadow map 97.93 %: 5.6 times fewer wrong pixels. \"In every scene, the SPSM \
                outperforms the standard shadow mapping\".",
        differs: "The gain depends on the scene. A texel keeps one triangle, so where triangles are smaller than texels (`city`, `plant`) or shadows lie \
                  closer than a texel (`windmill`, `cage`) there is little to recover; on closed bodies with large triangles the paper's ratio is passed.",
        places: &[
            Place::of("spheres"),
            Place::of("knot"),
            Place::of("city"),
            Place::of("windmill"),
            Place::of("cage"),
            Place::of("bicycle"),
            Place::of("plant"),
            Place::of("bumpy"),
        ],
        maps: &[1024, 2048],
        tables: |rows| {
            let title = "Ratio of wrong pixels in the paper at 2048: 5.6.";
            vec![table(title, rows, &[SCENE, TRIANGLES, MAP, METHOD, AS_TRACED, WRONG, FEWER])]
        },
        ..BASE
    },
    Experiment {
        name: "lecocq-table-1",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, table 1",
        title: "Time of sub-pixel shadow maps beside shadow maps",
        shows: "Milliseconds on a GTX 580 at 1920 x 1080, both the map and the picture: an overhead of 26 to 56 %.",
        differs: "Here both methods make only the texels that pixels ask for, and no hardware rasterizes: what the paper's map costs beyond a shadow map, \
                  conservative edges and 128 bits, is a larger part of the frame.",
        places: &[Place::of("spheres"), Place::of("knot"), Place::of("city")],
        maps: &[1024, 2048],
        tables: |rows| {
            let paper: [&[&str]; 3] = [
                &["Spheres", "12 000", "5.0", "6.8", "6.8", "8.6", "36 %, 26 %"],
                &["YeahRight", "155 000", "5.8", "7.4", "9.1", "10.7", "57 %, 45 %"],
                &["City", "2 300 000", "31.2", "32.2", "40", "41.6", "28 %, 29 %"],
            ];
            let head = ["scene", "triangles", "map 1024", "map 2048", "spsm 1024", "spsm 2048", "overhead"];
            vec![
                table("Measured:", rows, &[SCENE, TRIANGLES, MAP, METHOD, TIME, OVERHEAD]),
                of_paper("The paper's:", &head, &paper),
            ]
        },
        ..BASE
    },
    Experiment {
        name: "lecocq-table-2",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, table 2",
        title: "Overhead over the size of the map",
        shows: "On YeahRight the overhead of sub-pixel shadow maps falls as the map grows: fewer pixels need a border recovered.",
        differs: "The overhead falls here, too. `knot` has as many triangles as YeahRight.",
        places: &[Place::of("knot")],
        tables: |rows| {
            let paper: [&[&str]; 4] = [
                &["512", "5.5", "10.0", "81 %"],
                &["1024", "5.8", "9.1", "56 %"],
                &["2048", "7.4", "10.7", "44 %"],
                &["4096", "14.2", "18.1", "27 %"],
            ];
            vec![
                table("Measured:", rows, &[MAP, METHOD, TIME, OVERHEAD, UNCERTAIN]),
                of_paper("The paper's:", &["map", "shadow map ms", "spsm ms", "overhead"], &paper),
            ]
        },
        plots: |rows| {
            let map = (Axis::log("texels a side"), (|r: &Row| f64::from(r.map)) as fn(&Row) -> f64);
            vec![(
                "time-map",
                plot("time over the size of the map", map, (Axis::linear("ms"), |r| Some(r.time())), rows),
            )]
        },
        ..BASE
    },
];

type Column = super::columns::Column;
/// Share of the pixels that are as traced, with one sample a pixel.
const AS_TRACED: Column = ("as traced", |r, _| {
    let pixels = f64::from(r.size[0]) * f64::from(r.size[1]);
    format!("{:.3} %", 100.0 * (1.0 - wrong(r) / pixels))
});
/// Time beyond the shadow map's.
const OVERHEAD: Column =
    ("overhead", |r, first| or_dash(times(r, first).map(|t| 100.0 * (t - 1.0)), 0).replace('–', "") + " %");
/// Share of the pixels whose border is recovered.
const UNCERTAIN: Column = ("recovered", |r, _| {
    let pixels = f64::from(r.size[0]) * f64::from(r.size[1]);
    format!("{:.2} %", 100.0 * r.counts.silhouette_pixels as f64 / pixels)
});
