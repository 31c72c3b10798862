//! Lecocq, Marvie, Sourimant, Gautron 2013: Sub-Pixel Shadow Mapping.

use super::columns::{
    ACNE, FEWER, LEAKS, MAP, METHOD, SCENE, TIME, TIMES, TRIANGLES, WRONG, of_paper, plot, table, times, wrong,
};
use super::{CloseUp, Experiment, PLAIN, Place};
use crate::report::comparison::Row;
use crate::report::comparison::plots::Axis;
use crate::report::or_dash;

/// Parts that its experiments have in common.
const BASE: Experiment = Experiment {
    rows: &["shadow-map", "spsm encoding=paper search=near", "spsm"],
    samples: &[1],
    maps: &[512, 1024, 2048, 4096],
    ..PLAIN
};

pub const ALL: [Experiment; 6] = [
    Experiment {
        name: "lecocq-2",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, figure 2",
        title: "Without and with recovery of the silhouette",
        shows: "A shadow map of 1024 x 1024; sub-pixel shadow maps that only meet the triangles stored around a sample; and with the border recovered \
                from what those triangles leave.",
        differs: "Without recovery what no stored triangle covers is lit: holes where a texel has more triangles than the one it keeps, all over a shadow whose casters are finer than texels (`knot`, `windmill`), as in the paper's picture. Recovery closes them (`leaks`), so that fewer pixels are wrong than with a shadow map; on `windmill`, whose shadows lie closer than a texel, it closes some that are true.",
        places: &[Place::of("knot"), Place::of("spheres"), Place::of("windmill")],
        rows: &[
            "shadow-map",
            "spsm encoding=paper search=near recovery=off",
            "spsm encoding=paper search=near",
            "spsm",
        ],
        maps: &[1024],
        sheet: Some(CloseUp { part: [0.4, 0.5, 0.2, 0.2], zoom: 4, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, METHOD, WRONG, FEWER, LEAKS, TIME])],
        ..BASE
    },
    Experiment {
        name: "lecocq-5",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, figures 5 and 6",
        title: "Eight bits of slope: even steps of the angle, or a power of it",
        shows: "With a bias of 1e-5 and eight bits a slope, a shadow map shadows itself everywhere, even steps of the angle leave stripes, and steps by the \
                fifth power leave none.",
        differs: "As in the paper even steps shadow themselves most on a curved receiver (`bumpy`), and each higher power less; powers beyond the fifth are better still there. On closed bodies little is left of it, as a texel's code knows what it may be off and a caster must lie before a receiver by that, too. Edge lines with slopes of 16 bits trust their slopes more, and shadow a finely tessellated receiver more often.",
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
        differs: "A texel keeps one triangle. Where shadows lie closer together than a texel (`windmill` at 1024) there is nothing to recover and the shadow map is as good; elsewhere wrong pixels are 1.3 to 16 times fewer. The paper's ratio is reached at 2048 on `spheres`, `cage` and `bumpy` (by one of the two encodings), and missed on the others. Its scenes fill 1920 x 1080 pixels.",
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
        name: "lecocq-13",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, figure 13",
        title: "Reconstructable geometry beside sub-pixel shadow maps, few triangles and many",
        shows: "A map of 512 x 512: reconstructable geometry shadow maps, 5 x 5 look-ups, draw the shadows of few triangles sharply and fail for highly \
                tessellated objects, \"even with large kernel size\"; sub-pixel shadow maps, 3 x 3 look-ups, recover both.",
        differs: "As in the paper: nine times fewer wrong pixels than the shadow map's for 113 triangles, but more than its for 155,148, as no texel's centre meets the small \
                  ones; 7 x 7 look-ups do not mend that. What is wrong are leaks: a triangle that is asked shadows nothing that it does not cover. Sub-pixel maps keep \
                  what touches a texel anywhere and recover the rest, and are the better in all three. The paper's scenes are not told.",
        places: &[Place::of("plane"), Place::of("spheres"), Place::of("knot")],
        rows: &[
            "shadow-map",
            "reconstructable lookups=1",
            "reconstructable lookups=3",
            "reconstructable lookups=5",
            "reconstructable lookups=7",
            "spsm encoding=paper search=near",
        ],
        maps: &[512],
        sheet: Some(CloseUp { part: [0.4, 0.5, 0.2, 0.2], zoom: 4, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, TRIANGLES, METHOD, WRONG, FEWER, LEAKS, ACNE, TIME, TIMES])],
        ..BASE
    },
    Experiment {
        name: "lecocq-table-1",
        source: "Lecocq, Marvie, Sourimant, Gautron 2013, table 1",
        title: "Time of sub-pixel shadow maps beside shadow maps",
        shows: "Milliseconds on a GTX 580 at 1920 x 1080, both the map and the picture: an overhead of 26 to 56 %.",
        differs: "`spsm` makes only the texels that pixels ask for, `shadow-map` all of its map: at 2048 x 2048, with more texels than pixels ask for, that outweighs what 128 bits and conservative edges cost, and the overhead is negative. At 1024 it is as in the paper or less. No hardware rasterizes here.",
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
        differs: "The overhead falls with the size of the map as in the paper, and beyond: `spsm` makes only the texels that pixels ask for. `knot` has as many triangles as YeahRight.",
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
