//! Random worlds: a fixed set of them, and that a fault of a frame is found.

use lab::fuzz::{Fault, FuzzCase, FuzzDevice, FuzzProgress, Kind, Run, Shot, judge, run};
use lab::report::Promise;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;
use subpixel_shadows::gpu::KeptPrograms;
use subpixel_shadows::methods::{FacetMode, MethodName};
use subpixel_shadows::plan::Extent;
use subpixel_shadows::stages::facet_classify::FacetState;
use test_support::gpu;
use test_support::gpu_test;
use test_support::kept_light::Walks;

/// The seed of the fixed set.
const SEED: u64 = 4;
/// Ten of each kind.
const CASES: u64 = 10 * Kind::ALL.len() as u64;

fn cases() -> impl Iterator<Item = FuzzCase> {
    (0..).map(|number| FuzzCase::of(SEED, number).expect("a case"))
}

#[gpu_test]
fn no_sample_of_random_worlds_is_wrong() {
    let bench = FuzzDevice::new(gpu());
    let asked = Run { seed: SEED, first: 0, cases: CASES, patience: None, out: None, shrink: Duration::ZERO };
    let mut told = 0;
    let mut tell = |progress: FuzzProgress| told += u64::from(matches!(progress, FuzzProgress::Done(..)));
    let summary = run(&bench, &asked, &mut tell).expect("a run");
    let all = summary.all();
    eprintln!("{}; {} programs", summary.line(), bench.programs());
    assert!(summary.failures.is_empty(), "{:#?}", summary.failures);
    assert_eq!((all.cases, told), (CASES, CASES));
    assert!(all.refused <= 3, "{:?}", summary.refusals);
    assert!(summary.kinds.len() == Kind::ALL.len() && summary.kinds.values().all(|tally| tally.figures.compared > 0));
    assert!(all.figures.compared > 2_500_000 && all.figures.seen > 1_000_000, "{all:?}");
    let of = |method: MethodName| summary.methods.get(method.name()).copied().unwrap_or(0);
    assert!(of(MethodName::RayTraced) > 1 && of(MethodName::Supersampled) > 3 && summary.forced > 10, "{summary:?}");
    assert!(summary.methods.len() > 6, "{:?}", summary.methods);
}

/// A frame with facets that were evaluated, of the method and number of facets that are asked for.
fn evaluated(bench: &FuzzDevice, method: MethodName, facets: FacetMode) -> (FuzzCase, Shot) {
    // Where triangles stand twice the next one may be as near as the one that is seen.
    let doubled = [Kind::Doubled, Kind::Duplicates, Kind::NearCopies, Kind::OnePlane, Kind::Mixed];
    let wanted = |case: &FuzzCase| {
        let how = &case.how;
        let exact =
            how.promise() == Promise::Exact && how.settings.samples.count() >= 8 && !doubled.contains(&case.kind);
        how.method == method && how.settings.facets == facets && exact
    };
    let shots = cases().filter(wanted).filter_map(|case| bench.render(&case).ok().map(|shot| (case, shot)));
    let many = |shot: &Shot| shot.facets.facets.iter().filter(|f| f.state == FacetState::Undecided as u32).count() > 20;
    shots.into_iter().find(|(_, shot)| shot.plan.extent == Extent::Everything && many(shot)).expect("such a frame")
}

/// Turns the occlusion of every evaluated facet over, in its masks and the picture.
fn turn_masks(shot: &mut Shot) {
    let words = shot.facets.words as usize;
    for (f, facet) in shot.facets.facets.iter().enumerate().filter(|(_, f)| f.state == FacetState::Undecided as u32) {
        (0..words).for_each(|w| shot.facets.masks[(3 * f + 1) * words + w] ^= u32::MAX);
        let at = facet.pixel as usize * words;
        shot.output.lit[at..at + words].iter_mut().for_each(|word| *word ^= u32::MAX);
    }
}

#[gpu_test]
fn spoiled_frames_are_failures() {
    let bench = FuzzDevice::new(gpu());
    for (method, facets) in [
        (MethodName::FacetMasks, FacetMode::All),
        (MethodName::FacetMasks, FacetMode::One),
        (MethodName::Supersampled, FacetMode::One),
        (MethodName::RayTraced, FacetMode::One),
    ] {
        let of = if method == MethodName::FacetMasks { facets } else { FacetMode::All };
        let (case, mut shot) = evaluated(&bench, method, of);
        let what = format!("{} of {:?}, case {}", method.name(), facets, case.number);
        let judged = |shot: &Shot| judge(&case, shot).expect("a judgement");
        assert!(!judged(&shot).fails(), "{what}: {:?}", judged(&shot));
        turn_masks(&mut shot);
        let turned = judged(&shot);
        assert!(turned.has(Fault::Facet), "{what}: {turned:?}");
        if method == MethodName::FacetMasks && facets == FacetMode::All {
            assert!(turned.has(Fault::Scene) && turned.has(Fault::Picture), "{what}: {turned:?}");
        }
        turn_masks(&mut shot);
        assert!(!judged(&shot).fails(), "{what}");
        // Every facet is given the next triangle.
        let count = shot.prepared.mesh().triangles.len() as u32;
        let before = shot.facets.clone();
        for facet in shot.facets.facets.iter_mut().filter(|f| f.state != FacetState::Empty as u32) {
            facet.triangle = (facet.triangle + 1) % count;
        }
        assert!(judged(&shot).has(Fault::Seen), "{what}");
        shot.facets = before;
        // One pixel is no share; the picture of everything run is another.
        shot.output.visibility[0] = 1.5;
        assert!(judged(&shot).has(Fault::Picture), "{what}");
        shot.output.visibility[0] = 1.0;
        let mut forced = shot.output.clone();
        forced.visibility.iter_mut().for_each(|v| *v = 0.5);
        shot.forced = Some((forced, shot.facets.clone()));
        assert!(judged(&shot).has(Fault::Forced), "{what}");
    }
}

/// Of methods of texels shares, second frames and those of everything run are asked.
#[gpu_test]
fn spoiled_frames_of_texels_are_failures() {
    let bench = FuzzDevice::new(gpu());
    let wanted = |case: &FuzzCase| case.how.promise() == Promise::Texels && case.how.both;
    let mut shots = cases().filter(wanted).filter_map(|case| bench.render(&case).ok().map(|shot| (case, shot)));
    let (case, shot) = shots.find(|(_, shot)| shot.plan.extent == Extent::Everything).expect("a frame of texels");
    let pixel = shot.output.visibility.len() / 2;
    let spoiled = |spoil: &dyn Fn(&mut Shot)| {
        let mut shot = bench.render(&case).expect("a frame");
        spoil(&mut shot);
        judge(&case, &shot).expect("a judgement")
    };
    assert!(!spoiled(&|_| {}).fails(), "{:?}", spoiled(&|_| {}));
    assert!(spoiled(&|shot| shot.output.visibility[pixel] = f32::NAN).has(Fault::Picture));
    let other = |v: &mut f32| *v = (*v - 0.5).abs();
    assert!(
        spoiled(&|shot| other(&mut shot.again.as_mut().expect("a second frame").visibility[pixel])).has(Fault::Again)
    );
    let forced = |shot: &mut Shot| other(&mut shot.forced.as_mut().expect("everything run").0.visibility[pixel]);
    assert!(spoiled(&forced).has(Fault::Forced));
}

/// With masks from a table a few samples may be wrong, not many.
#[gpu_test]
fn tables_are_held_to_their_bound() {
    let bench = FuzzDevice::new(gpu());
    let wanted = |case: &FuzzCase| case.how.promise() == Promise::Rounded && case.how.settings.samples.count() >= 32;
    let mut shots = cases().filter(wanted).filter_map(|case| bench.render(&case).ok().map(|shot| (case, shot)));
    let evaluations = |shot: &Shot| shot.output.counts.visibility_evaluations;
    let undecided = |shot: &Shot| shot.facets.facets.iter().filter(|f| f.state == FacetState::Undecided as u32).count();
    let (case, mut shot) =
        shots.find(|(_, shot)| undecided(shot) > 100 && evaluations(shot) < 1000).expect("a frame by table");
    assert!(!judge(&case, &shot).expect("a judgement").fails());
    turn_masks(&mut shot);
    assert!(judge(&case, &shot).expect("a judgement").has(Fault::Facet));
}

fn program(arguments: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_subpixel-shadows")).args(arguments).output().expect("the program");
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (output.status.code().expect("a status"), text)
}

#[gpu_test]
fn the_program_runs_cases() {
    let folder = std::env::temp_dir().join(format!("subpixel-shadows-fuzz-program-{}", std::process::id()));
    let page: PathBuf = folder.join("page.md");
    std::fs::create_dir_all(&folder).expect("a folder");
    let out = folder.join("out");
    let paths = [&out, &page].map(|p| p.to_string_lossy().into_owned());
    let of = ["fuzz", "--cases", "5", "--seed", "4", "--quiet", "--out", &paths[0], "--page", &paths[1]];
    let (status, text) = program(&of);
    assert_eq!(status, 0, "{text}");
    assert!(text.contains("loose soup") && text.contains("cases a second"), "{text}");
    let page = std::fs::read_to_string(&page).expect("a page");
    assert!(page.contains("5 cases: 0 failed") && page.contains("| kind | cases |"), "{page}");
    assert!(!out.exists(), "nothing failed, nothing is written");
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// Needs no GPU: nothing is rendered before the words are understood, and without an adapter it says so.
#[test]
fn the_program_refuses_what_it_cannot_do() {
    for arguments in [&["fuzz", "--minutes", "0"][..], &["fuzz", "--cases", "0"], &["fuzz", "--cases", "many"]] {
        assert_eq!(program(arguments).0, 2, "{arguments:?}");
    }
    let (status, text) = program(&["fuzz", "--cases", "1", "--adapter", "no such adapter"]);
    assert_eq!(status, 3, "{text}");
    assert!(text.contains("no adapter") && text.contains("no such adapter"), "{text}");
}

/// Cameras that go about, while the light's maps stay: every picture is that of a pass that makes them anew.
#[gpu_test]
fn light_maps_that_are_kept_change_nothing() {
    let (programs, mut walks) = (KeptPrograms::default(), Walks::default());
    for case in cases().take(Kind::ALL.len()) {
        walks.take(gpu(), &programs, &case).expect("a walk");
    }
    assert!(walks.faults.is_empty(), "{:#?}", walks.faults);
    assert!(walks.refused <= 2 && walks.kept > walks.pictures / 4 && walks.shadowed > walks.pictures / 4, "{walks:?}");
}
