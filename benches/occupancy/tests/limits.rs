//! Every pipeline of the library keeps to the limits, as AMD's compiler makes it; and what does not is found.

use gpu_test::gpu_test;
use occupancy::families::{FAMILIES, Job, Report, measure};
use occupancy::limits::{EXCEPTIONS, Exception, Figure, faults};
use occupancy::{Figures, Measured, Pipeline, made};
use std::path::Path;
use subpixel_shadows::gpu::kernels;

fn compiled(job: &Job) -> Vec<Report> {
    measure(Path::new(env!("CARGO_BIN_EXE_occupancy")), job).unwrap_or_else(|e| panic!("{e}"))
}

#[gpu_test(alone)]
fn every_pipeline_keeps_to_the_limits() {
    let pipelines = made::pipelines().unwrap_or_else(|e| panic!("{e}"));
    for entry in kernels::ALL.iter().flat_map(|(_, _, entries)| *entries) {
        let found = pipelines.iter().any(|p| p.0 == entry.kernel && p.1 == entry.name);
        assert!(found, "no pipeline of {}.{}", entry.kernel, entry.name);
    }
    assert!(pipelines.len() > 200, "{} pipelines", pipelines.len());
    let reports = compiled(&Job::of(pipelines));
    let faults = faults(&reports, EXCEPTIONS);
    assert!(faults.is_empty(), "{}:\n{}", reports[0].driver, faults.join("\n"));
}

/// The figures are the compiler's: an array that is indexed is scratch, values that no registers are left for are spilled.
#[gpu_test(alone)]
fn scratch_and_spills_are_seen() {
    let text = "
        override TURNS: u32 = 8u;
        @group(0) @binding(0) var<storage, read_write> data: array<u32>;
        @compute @workgroup_size(64) fn indexed(@builtin(global_invocation_id) id: vec3<u32>) {
            var kept: array<u32, 512>;
            for (var k = 0u; k < TURNS; k++) { kept[data[k] % 512u] = data[k + id.x]; }
            data[id.x] = kept[data[id.x] % 512u];
        }
        @compute @workgroup_size(64) fn plain(@builtin(global_invocation_id) id: vec3<u32>) {
            data[id.x] += TURNS;
        }";
    let pipeline = |entry: &str| Pipeline("array".to_owned(), entry.to_owned(), [("TURNS".to_owned(), 9.0)].into());
    // The same twice is one row.
    let pipelines = vec![pipeline("indexed"), pipeline("plain"), pipeline("plain")];
    let reports = compiled(&Job { texts: [("array".to_owned(), text.to_owned())].into(), pipelines });
    assert_eq!(reports.len(), FAMILIES.len());
    for (report, family) in reports.iter().zip(FAMILIES) {
        assert!(report.device.to_lowercase().contains(family), "{}", report.device);
        let [indexed, plain] = &report.rows[..] else { panic!("{:?}", report.rows) };
        assert!(indexed.figures.scratch >= 64 * 4 * 512, "{indexed:?}");
        assert_eq!((plain.figures.scratch, plain.alike), (0, 2));
    }
    let found = faults(&reports, &[]);
    assert!(
        found.len() == FAMILIES.len() && found.iter().all(|f| f.contains("array.indexed (TURNS 9): scratch")),
        "{found:?}"
    );
}

#[test]
fn a_worse_figure_an_old_exception_and_a_loose_one_are_faults() {
    let good = Figures { vector_registers: 32, code: 100, waves: 8, ..Figures::default() };
    let of = |figures| {
        let row =
            Measured { pipeline: Pipeline("k".to_owned(), "go".to_owned(), Default::default()), alike: 1, figures };
        [0, 1].map(|_| Report { device: String::new(), driver: String::new(), rows: vec![row.clone()] })
    };
    let except = |figure, worst| [Exception { entry: "k.go", figure, worst, why: "a test" }];
    assert!(faults(&of(good), &[]).is_empty());
    for (bad, figure, worst, better) in [
        (Figures { scratch: 1, ..good }, Figure::Scratch, [1, 1], [0, 1]),
        (Figures { spilled_vector: 1, ..good }, Figure::SpilledVector, [1, 1], [1, 0]),
        (Figures { spilled_scalar: 9, ..good }, Figure::SpilledScalar, [9, 9], [8, 9]),
        (Figures { code: 16 << 10, ..good }, Figure::Code, [16 << 10; 2], [20_000, 16_000]),
        (Figures { waves: 1, ..good }, Figure::Waves, [1, 1], [1, 2]),
    ] {
        assert_eq!(faults(&of(bad), &[]).len(), 2, "{bad:?}");
        assert!(faults(&of(bad), &except(figure, worst)).is_empty(), "{bad:?}");
        assert!(!faults(&of(bad), &except(figure, better)).is_empty(), "{bad:?}");
        assert_eq!(faults(&of(good), &except(figure, worst)).last().map(|f| f.contains("no exception")), Some(true));
    }
    let loose = faults(&of(Figures { scratch: 100, ..good }), &except(Figure::Scratch, [200, 100]));
    assert!(loose.len() == 1 && loose[0].contains("may say less"), "{loose:?}");
    let gone = [Exception { entry: "k.gone", figure: Figure::Code, worst: [1, 1], why: "a test" }];
    assert_eq!(faults(&of(good), &gone), ["k.gone: an exception, and no such entry point"]);
}
