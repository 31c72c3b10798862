//! Pan, Wang, Chen, Zhou, Bao 2009: Fast, Sub-pixel Antialiased Shadow Maps.

use super::columns::{
    BAND, CONVERGED, MATCH, METHOD, ONE_PLANE, RMSE, SAMPLES, SCENE, TIME, TRIANGLES, of_paper, plot, table,
};
use super::{CloseUp, Experiment, PLAIN, Place, Table};
use crate::report::comparison::Row;
use crate::report::comparison::page::{STEPS, step_ms};
use crate::report::comparison::plots::Axis;
use crate::report::or_dash;

/// Parts that its experiments have in common.
const BASE: Experiment = Experiment { rows: &["facet-masks facets=one"], samples: &[32], ..PLAIN };

pub const ALL: [Experiment; 6] = [
    Experiment {
        name: "pan-table-1",
        source: "Pan, Wang, Chen, Zhou, Bao 2009, table 1",
        title: "Statistics and time of the stages",
        shows: "On a GTX 280 at 800 x 600 with a map of 512 x 512: silhouette texels and pixels, evaluations of visibility, and the time of the \
                mask map, of the lists of pairs, and of the shadows.",
        differs: "The paper marks the texels of visible silhouette edges. Here every texel is marked that is not proved to hold one sheet of the \
                  surface, which needs no bias and costs some of what it settles; evaluations are of what the test in the light's view keeps. The scenes \
                  are made in the spirit of the paper's, which are not to be had.",
        places: &[
            Place::of("windmill"),
            Place::of("cage"),
            Place::of("bicycle"),
            Place::of("plant"),
            Place::of("bumpy"),
        ],
        samples: &[32, 128],
        tables: table_1,
        ..BASE
    },
    Experiment {
        name: "pan-8",
        source: "Pan, Wang, Chen, Zhou, Bao 2009, figure 8",
        title: "Error of one facet a pixel",
        shows: "Shadows of a bunny (69,473 triangles) at 32 samples beside a traced reference, and their difference tenfold: small, and only where a \
                pixel covers geometry of several depths; on a plane there is none.",
        differs: "The figure of the paper is a picture. The column of pixels that see one plane is its sentence as a number: there one facet a pixel is \
                  the whole truth. With a facet for every surface that a pixel's samples see the rest of the error is gone, too.",
        places: &[
            Place { label: "knot", scene: "knot", options: "--ground" },
            Place { label: "spheres", scene: "spheres", options: "" },
        ],
        rows: &["facet-masks facets=one", "facet-masks facets=all"],
        sheet: Some(CloseUp { part: [0.35, 0.4, 0.3, 0.3], zoom: 3, gain: 10.0 }),
        tables: |rows| vec![table("", rows, &[SCENE, TRIANGLES, METHOD, RMSE, BAND, MATCH, ONE_PLANE])],
        ..BASE
    },
    Experiment {
        name: "pan-9",
        source: "Pan, Wang, Chen, Zhou, Bao 2009, figure 9",
        title: "Valid samples of a pixel on a bumpy receiver",
        shows: "On a receiver made from heights, most of whose triangles are smaller than a pixel, 18.5 of 32 samples of a pixel on the shadow's \
                boundary are valid on average: the validity mask drops those that another surface covers. On a finer concave surface the method \
                becomes point sampling.",
        differs: "The receiver here has folds of its own making; more of its samples are valid. The second line splits every triangle into four: the shape stays and the facets get smaller, so that more samples see another one, and the share falls towards point sampling as the paper says. Pixels on the boundary are those with valid samples that are lit and others that are not.",
        places: &[Place::of("bumpy")],
        tessellation: 1,
        tables: valid_samples,
        ..BASE
    },
    Experiment {
        name: "pan-10",
        source: "Pan, Wang, Chen, Zhou, Bao 2009, figure 10",
        title: "Time over samples, beside true supersampling",
        shows: "Alias-free shadow maps with supersampling take time in proportion to the samples, up to 350 ms at 64 on the pterosaur, and cannot do 128; \
                the method stays below 50 ms: an order of magnitude. Its windmill takes 49 frames a second alias-free and 41 at 32 samples: 1.2 times.",
        differs: "As in the paper, time grows far less than the samples do, and supersampling at equal error takes an order of magnitude more from 32 samples on. Only rows of like error are peers: `supersampled facets=all` and rays of `facets=all`, `supersampled facets=one` of `facets=one`. With one sample rays take less time; no light view pays for one sample. Alias-free maps cost more than a sample's share here at first: their lists of samples and casters are made whatever the samples.",
        places: &[Place::of("windmill")],
        rows: &[
            "facet-masks facets=one",
            "facet-masks facets=all",
            "supersampled facets=one",
            "supersampled facets=all",
            "ray-traced facets=all rays=all",
        ],
        samples: &[1, 8, 16, 32, 64, 128],
        tables: |rows| vec![over_samples(rows), table("", rows, &[SAMPLES, METHOD, TIME, RMSE])],
        plots: |rows| {
            let samples = (Axis::linear("samples a pixel"), (|r: &Row| f64::from(r.samples)) as fn(&Row) -> f64);
            vec![("time-samples", plot("time over samples", samples, (Axis::log("ms"), |r| Some(r.time())), rows))]
        },
        ..BASE
    },
    Experiment {
        name: "pan-11",
        source: "Pan, Wang, Chen, Zhou, Bao 2009, figure 11",
        title: "A cage at 1, 8, 32 and 128 samples",
        shows: "Shadows of the cage's lines are missed even at 8 samples, almost all are there at 32, and 128 are smoother still, in real time.",
        differs: "The paper shows pictures; the error against 1024 rays a pixel says the same. It is that of the samples: against rays through the same samples there is none but for samples whose rays pass within 1/256 pixel of an edge.",
        places: &[Place::of("cage")],
        rows: &["facet-masks facets=all"],
        samples: &[1, 8, 32, 128],
        converged: true,
        sheet: Some(CloseUp { part: [0.3, 0.5, 0.2, 0.2], zoom: 4, gain: 1.0 }),
        tables: |rows| vec![table("", rows, &[SAMPLES, METHOD, TIME, RMSE, CONVERGED])],
        ..BASE
    },
    Experiment {
        name: "pan-silhouettes",
        source: "Pan, Wang, Chen, Zhou, Bao 2009, section 5.1",
        title: "Time over triangles whose silhouettes stay",
        shows: "The method grows linearly with the triangles on the silhouette rather than with all triangles of the scene.",
        differs: "Splitting every triangle in four changes no shadow and doubles the edges of a silhouette, a little more where rounding makes flat parts uneven. Time follows these edges, not the triangles, of which there are 64 times as many in the last line.",
        places: &[Place::of("windmill")],
        rows: &["facet-masks facets=one", "facet-masks facets=all"],
        tessellation: 3,
        tables: silhouettes,
        ..BASE
    },
];

/// Table 1 of the paper, line by line.
const TABLE_1: [&[&str]; 7] = [
    &["figure 1(c)", "32", "40712", "9365", "36113", "1295363", "2.3", "6.5", "13.2"],
    &["figure 8(a), bunny", "32", "69473", "3254", "18523", "609901", "2.1", "6.3", "6.8"],
    &["pterosaur", "32", "10000", "1828", "12991", "329740", "1.6", "4.7", "4.3"],
    &["cage", "128", "59780", "37646", "53576", "2915995", "4.2", "10.0", "18.9"],
    &["bicycle", "32", "30922", "4277", "40954", "2996154", "2.1", "6.6", "15.3"],
    &["horse", "32", "77500", "4317", "26202", "2138740", "2.3", "6.5", "17.3"],
    &["plant", "32", "20926", "15263", "59692", "1446287", "2.1", "6.2", "10.8"],
];

fn table_1(rows: &[&Row]) -> Vec<Table> {
    let head = [
        "scene",
        "samples",
        "triangles",
        "silhouette texels",
        "silhouette pixels",
        "evaluations",
        "mask map ms",
        "pairs ms",
        "shadow ms",
    ];
    let line = |r: &&Row| {
        let c = &r.counts;
        let counts =
            [u64::from(r.samples), r.triangles, c.silhouette_texels, c.silhouette_pixels, c.visibility_evaluations];
        let mut line = vec![r.scene.clone()];
        line.extend(counts.map(|count| count.to_string()));
        line.extend(STEPS.map(|names| format!("{:.1}", step_ms(r, names))));
        line
    };
    let ours = Table { title: "Measured:".to_owned(), head: head.to_vec(), lines: rows.iter().map(line).collect() };
    vec![ours, of_paper("The paper's:", &head, &TABLE_1)]
}

fn valid_samples(rows: &[&Row]) -> Vec<Table> {
    let line = |r: &&Row| {
        let valid = or_dash(r.boundary.map(|b| b.valid_samples), 1);
        let facets = r.boundary.map_or(0, |b| b.facets);
        vec![r.triangles.to_string(), facets.to_string(), valid, format!("{:.4}", r.matched.scene_rmse)]
    };
    let head = vec!["triangles", "pixels on the boundary", "valid samples of 32", "RMSE"];
    vec![Table { title: "The paper's figure: 18.5.".to_owned(), head, lines: rows.iter().map(line).collect() }]
}

/// Of each method its time at every number of samples over that at one.
fn over_samples(rows: &[&Row]) -> Table {
    let mut lines: Vec<Vec<String>> = Vec::new();
    let mut names: Vec<String> = Vec::new();
    for row in rows {
        if !names.contains(&row.series()) {
            names.push(row.series());
        }
    }
    let counts = [1, 8, 16, 32, 64, 128];
    for name in names {
        let at = |n: u32| rows.iter().find(|r| r.series() == name && r.samples == n);
        let ours = |n: u32| rows.iter().find(|r| r.series() == "facet-masks facets=all" && r.samples == n);
        let mut line = vec![name.clone()];
        line.extend(counts.map(|n| or_dash(at(n).zip(at(1)).map(|(r, one)| r.time() / one.time()), 2)));
        line.extend([1, 32, 128].map(|n| or_dash(at(n).zip(ours(n)).map(|(r, o)| r.time() / o.time()), 2)));
        lines.push(line);
    }
    let head = vec!["method", "1", "8", "16", "32", "64", "128", "over facets=all at 1", "at 32", "at 128"];
    Table { title: "Time over that of one sample, and over that of `facet-masks facets=all`:".to_owned(), head, lines }
}

fn silhouettes(rows: &[&Row]) -> Vec<Table> {
    let line = |r: &&Row| {
        let c = &r.counts;
        let first = rows.iter().find(|o| o.series() == r.series());
        vec![
            r.series(),
            r.triangles.to_string(),
            c.silhouette_edges.to_string(),
            c.visibility_evaluations.to_string(),
            format!("{:.1}", r.time()),
            or_dash(first.map(|first| r.time() / first.time()), 2),
            format!("{:.1}", STEPS.map(|names| step_ms(r, names)).iter().sum::<f64>()),
        ]
    };
    let head =
        vec!["method", "triangles", "silhouette edges", "evaluations", "ms", "times", "ms of the paper's three steps"];
    let mut sorted = rows.to_vec();
    sorted.sort_by_key(|r| (r.series(), r.tessellation));
    vec![Table { title: String::new(), head, lines: sorted.iter().map(line).collect() }]
}
