//! Growth of the counters of a frame, on small frames of `examples/growth`: samples bring no pairs, finer triangles no facets and no marks, and
//! neither brings work in proportion.

#[path = "../examples/growth/axes.rs"]
mod axes;
#[path = "../examples/growth/row.rs"]
mod row;

use axes::{Axis, Sizes, axes};
use row::{COLUMNS, Figure, Row, slope};
use subpixel_shadows::gpu::KeptPrograms;
use subpixel_shadows::methods::{MethodName, Settings};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use test_support::{gpu, gpu_test};

/// Counters of the frames of an axis.
fn counted(axis: &Axis) -> Vec<Row> {
    let programs = KeptPrograms::default();
    let count = |point: &axes::Point| {
        let scene = point.scene().expect("a scene");
        let prepared = scene.prepared().expect("a sound mesh");
        let samples = Samples::new(Pattern::LowDiscrepancy, point.samples).expect("a pattern");
        let wanted = Settings { cull_back: true, ..Settings::new(point.size, point.map, samples) };
        let method = MethodName::FacetMasks;
        let plan = Plan::of_method(method, &prepared, &scene.camera, &scene.light, &wanted, false).expect("a plan");
        let renderer = || Renderer::of_plan(gpu(), &prepared, method, &plan, Budget::default());
        let mut renderer = programs.within(renderer).expect("a renderer");
        let output = renderer.render(&scene.camera, &scene.light).expect("a frame");
        let dark = output.visibility.iter().filter(|v| **v < 1.0).count();
        assert!(20 * dark > output.visibility.len(), "{}: {dark} pixels are in shadow", point.label);
        Row::counted(axis.name, point.x, &point.label, prepared.mesh().triangles.len(), &output.counts)
    };
    axis.points.iter().map(count).collect()
}

/// A figure's name, the figure, and the slopes between which it has to lie.
type Bound = (&'static str, Figure, [f64; 2]);

/// The figures whose slope is out of bounds.
fn out_of_bounds(rows: &[Row], bounds: &[Bound]) -> Vec<String> {
    let of = |&(name, figure, [low, high]): &Bound| {
        let slope = slope(rows.iter().map(|row| (row.x, figure(row)))).expect("two frames");
        (slope < low || slope > high).then(|| format!("{} {name}: {slope:.3}, {low} to {high} allowed", rows[0].axis))
    };
    bounds.iter().filter_map(of).collect()
}

#[gpu_test]
fn counters_grow_as_told() {
    let bounds: [(&str, &[Bound]); 4] = [
        (
            "samples",
            &[
                ("marked", |r| r.marked as f64, [-0.05, 0.05]),
                ("facets", |r| r.facets as f64, [0.0, 0.3]),
                ("pairs", |r| r.pairs as f64, [-0.1, 0.1]),
                ("evaluations", |r| r.evaluations as f64, [-0.2, 0.2]),
            ],
        ),
        (
            "triangles",
            &[
                ("triangles", |r| r.triangles as f64, [0.99, 1.01]),
                ("silhouettes", |r| r.silhouettes as f64, [0.45, 0.55]),
                ("marked", |r| r.marked as f64, [-0.1, 0.1]),
                ("facets", |r| r.facets as f64, [-0.01, 0.01]),
                ("pairs", |r| r.pairs as f64, [0.0, 0.5]),
                ("evaluations", |r| r.evaluations as f64, [0.3, 0.85]),
            ],
        ),
        (
            "silhouettes",
            &[
                ("silhouettes", |r| r.silhouettes as f64, [0.95, 1.05]),
                ("marked", |r| r.marked as f64, [0.3, 0.55]),
                ("pairs", |r| r.pairs as f64, [0.3, 0.6]),
                ("evaluations", |r| r.evaluations as f64, [0.6, 0.9]),
            ],
        ),
        (
            "depth",
            &[
                ("facets", |r| r.facets as f64, [0.0, 0.15]),
                ("pairs", |r| r.pairs as f64, [0.0, 0.3]),
                ("evaluations", |r| r.evaluations as f64, [0.0, 0.4]),
            ],
        ),
    ];
    let axes = axes(Sizes::new(true), &[]);
    let mut faults = Vec::new();
    for (name, bounds) in bounds {
        let axis = axes.iter().find(|axis| axis.name == name).expect("an axis");
        assert!(axis.sloped, "{name} has no slope");
        let rows = counted(axis);
        let wrong = out_of_bounds(&rows, bounds);
        if !wrong.is_empty() {
            let figures = |row: &Row| {
                let cells = COLUMNS.map(|(name, figure)| format!("{name} {}", figure(row)));
                format!("{}: {}", row.key(), cells.join(", "))
            };
            faults.push(format!("over {}, of {}:", axis.unit, axis.held));
            faults.extend(wrong.into_iter().chain(rows.iter().map(figures)));
        }
        // Work in proportion is told apart.
        let spoilt: Vec<Row> = rows
            .iter()
            .map(|row| {
                let by = row.x / rows[0].x;
                Row { evaluations: (row.evaluations as f64 * by) as u64, ..row.clone() }
            })
            .collect();
        assert!(!out_of_bounds(&spoilt, bounds).is_empty(), "{name}: work in proportion passes");
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
