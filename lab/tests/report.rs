//! `report` as its users meet it: what it writes, that its rows are the truth, that it goes on where it stopped.

use lab::report::comparison::html::data_of;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use subpixel_shadows::methods::MethodName;
use test_support::Folder;
use test_support::gpu_test;

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subpixel-shadows")).args(args).output().expect("the program starts")
}

/// What the program itself says; drivers may say more.
fn complaint(done: &Output) -> String {
    let text = String::from_utf8_lossy(&done.stderr).into_owned();
    text.lines().filter(|l| l.starts_with("subpixel-shadows: ")).map(|l| format!("{l}\n")).collect()
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("a file")).expect("JSON")
}

const SMALL: [&str; 9] = ["--quick", "--size", "64x48", "--maps", "64,128", "--samples", "1,32", "--repeats", "2"];

fn report(out: &str, args: &[&str]) -> Output {
    let done = run(&[&["report", "--out", out], &SMALL[..], args].concat());
    assert!(done.status.success(), "{args:?}: {}", String::from_utf8_lossy(&done.stderr));
    done
}

/// Rows whose pictures are shown.
fn pictured(timed: &[&Value]) -> usize {
    let like = |r: &&&Value| r["tessellation"] == 0 && ["map", "samples"].iter().all(|k| r[k] == timed[0][k]);
    timed.iter().filter(like).count()
}

#[gpu_test]
fn every_row_agrees_with_render() {
    let folder = Folder::new("rows");
    let (out, frame) = (folder.path("report"), folder.path("frame"));
    let done = report(&out, &["plane", "--tessellate", "1"]);
    assert!(String::from_utf8_lossy(&done.stdout).contains("front"));
    let found = json(&Path::new(&out).join("rows.json"));
    let rows = found["rows"].as_array().expect("rows");
    let timed: Vec<&Value> = rows.iter().filter(|r| r["method"] != "scene-truth" && r["failed"].is_null()).collect();
    assert!(timed.len() >= 8, "{} rows", timed.len());
    assert_eq!(rows.len() - timed.len(), 2, "one row of truth for each number of samples");
    for row in rows.iter().filter(|r| r["method"] == "scene-truth") {
        assert_eq!(row["matched"]["scene_max"], 0.0);
        assert!(row["converged"]["scene_band_rmse"].as_f64().is_some_and(|e| e > 0.0), "{row}");
    }
    // The page tells of each row the command that renders it.
    let index =
        data_of(&std::fs::read_to_string(Path::new(&out).join("index.html")).expect("the page")).expect("a report");
    let told = index["rows"].as_array().expect("rows");
    assert_eq!(told.len(), rows.iter().filter(|r| r["tessellation"] == 0).count());
    assert_eq!(index["pictures"]["plane"]["names"].as_array().map(Vec::len), Some(pictured(&timed) + 1));
    let mut compared = [0; 2];
    // Of facet-masks all, of other methods those of one map and number of samples.
    let asked = |r: &&&Value| r["method"] == "facet-masks" || (r["map"] == 128 && r["samples"] == 32);
    for row in timed.iter().filter(|r| r["tessellation"] == 0).filter(asked) {
        let own = row["method"] == "facet-masks";
        assert_eq!(row["repeats"], 2);
        assert!(row["gpu_ms"]["median"].as_f64().is_some_and(|t| t > 0.0), "{row}");
        let [method, setting] = ["method", "setting"].map(|key| row[key].as_str().expect("a word"));
        let series = format!("{method} {setting}").trim_end().to_owned();
        let same = |t: &&Value| t["series"] == series && t["map"] == row["map"] && t["samples"] == row["samples"];
        let line = told.iter().find(same).and_then(|t| t["command"].as_str()).expect("a command");
        let args: Vec<&str> = line.strip_prefix("cargo run --release -- ").expect("a command").split(' ').collect();
        assert!(run(&[&args[..], &["--out", &frame]].concat()).status.success(), "{line}");
        let rendered = json(&Path::new(&frame).join("frame.json"));
        for (key, value) in row["matched"].as_object().expect("an object") {
            assert_eq!(value, &rendered["error"][key], "{key} of {series}");
        }
        for key in ["silhouette_pixels", "pixel_texel_pairs", "triangle_texel_pairs", "facets"] {
            assert!(!own || row["counts"][key] == rendered["counts"][key], "{key} of {series}");
        }
        compared[usize::from(own)] += 1;
    }
    assert!(compared[0] >= MethodName::ALL.len() && compared[1] >= 6, "{compared:?} rows compared");
    let page = std::fs::read_to_string(Path::new(&out).join("report.md")).expect("the page");
    for part in page.lines().filter_map(|l| l.strip_prefix("![")) {
        let name = part.split(['(', ')']).nth(1).expect("a link");
        assert!(Path::new(&out).join(name).exists(), "the page links {name}");
    }
    let csv = std::fs::read_to_string(Path::new(&out).join("rows.csv")).expect("the table");
    assert_eq!(csv.lines().count(), rows.len() + 1);
}

#[gpu_test]
fn goes_on_where_it_stopped() {
    let folder = Folder::new("resume");
    let out = folder.path("report");
    let args = ["plane", "--tessellate", "0", "--methods", "facet-masks"];
    report(&out, &args);
    let journal = Path::new(&out).join("rows.jsonl");
    let whole = std::fs::read_to_string(&journal).expect("the journal");
    // As if it had been stopped while it wrote the last line.
    std::fs::write(&journal, &whole[..whole.len() - 9]).expect("written");
    report(&out, &args);
    let again = std::fs::read_to_string(&journal).expect("the journal");
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let (before, after) = (lines(&whole), lines(&again));
    assert_eq!(before.len(), after.len());
    assert_eq!(before[..before.len() - 1], after[..after.len() - 1], "finished rows are kept");
    report(&out, &[&args[..], &["--fresh"]].concat());
    let fresh = lines(&std::fs::read_to_string(&journal).expect("the journal"));
    assert_eq!(fresh.len(), before.len());
    assert_ne!(fresh, before, "times are measured anew");
    // Rows of another machine are not mixed in.
    std::fs::write(&journal, whole.replacen("\"threads\":", "\"threads\":1", 1)).expect("written");
    let done = run(&[&["report", "--out", &out], &SMALL[..], &args].concat());
    let line = complaint(&done);
    assert_eq!(done.status.code(), Some(1), "{line}");
    assert!(line.contains("rows.jsonl") && line.contains("--fresh") && line.lines().count() == 1, "{line}");
}

/// A method that is added later finds the others in the picture.
#[gpu_test]
fn pictures_show_all_rows() {
    let folder = Folder::new("pictures");
    let (out, whole) = (folder.path("added"), folder.path("whole"));
    let picture = |out: &str| std::fs::read(Path::new(out).join("pictures-plane.png")).expect("a picture");
    let args = |methods: &'static str| ["plane", "--tessellate", "0", "--methods", methods];
    report(&out, &args("facet-masks"));
    let first = picture(&out);
    report(&out, &args("facet-masks,shadow-map"));
    report(&whole, &args("facet-masks,shadow-map"));
    assert!(picture(&out) == picture(&whole), "the picture is another one than that of one run");
    assert!(picture(&out) != first, "nothing was added");
}

#[gpu_test]
fn bad_input_is_one_line_and_leaves_nothing() {
    let folder = Folder::new("bad");
    let out = folder.path("report");
    let cases: [(&[&str], &str); 4] = [
        (&["plane", "no-such-scene"], "no-such-scene"),
        (&["plane", "--samples", "33"], "33"),
        (&["plane", "--maps", "0"], "0 texels"),
        (&["plane", "--size", "0x5"], "0x5"),
    ];
    for (args, part) in cases {
        let done = run(&[&["report", "--out", &out], args].concat());
        let line = complaint(&done);
        assert_eq!(done.status.code(), Some(1), "{args:?}: {line}");
        assert!(line.contains(part) && line.lines().count() == 1, "{args:?}: {line}");
        assert!(!Path::new(&out).exists(), "{args:?} left a folder");
    }
}

/// Cases that must give one picture do, and no sample is wrong; what is not known is refused in one line.
#[gpu_test]
fn stiff_cases_hold() {
    let folder = Folder::new("stability");
    let out = folder.path("out");
    let cases = ["contact", "crossing", "light-in-plane", "degenerate", "scale", "order", "overflow"];
    let own = ["stability", "--methods", "facet-masks", "--size", "80x60", "--out", &out];
    let done = run(&[&own, &cases[..]].concat());
    assert!(done.status.success(), "{}", complaint(&done));
    let outcomes = outcomes(&out);
    let page = std::fs::read_to_string(Path::new(&out).join("stability.md"));
    assert!(outcomes.len() > 80, "{} frames", outcomes.len());
    let same = outcomes.iter().filter(|o| o["same_bits"] == true).count();
    assert_eq!(same, 4 * (5 + 3 + 4), "steps of scale, order and overflow in four variants");
    let of = |variant: &str| outcomes.iter().filter(|o| o["variant"] == variant && o["promise"] == "rounded").count();
    assert!(of("facets=one projection=two-step") > 20 && of("facets=one masks=table") > 20 && of("facets=all") == 0);
    let page = page.expect("the page");
    assert!(cases.iter().all(|c| page.contains(&format!("## {c}\n"))) && !page.contains("**"), "{page}");
    let done = run(&["stability", "no-such-case", "--out", &folder.path("none")]);
    assert_eq!(done.status.code(), Some(1));
    assert!(complaint(&done).contains("no-such-case") && complaint(&done).contains("contact"), "{}", complaint(&done));
    assert!(!Path::new(&folder.path("none")).exists());
}

/// Every other method keeps what it promises in cases that stress it, rays and supersampling among them with no sample wrong.
#[gpu_test]
fn other_methods_keep_their_promises() {
    let folder = Folder::new("stability-methods");
    let out = folder.path("out");
    let others = MethodName::ALL.map(MethodName::name)[1..].join(",");
    let cases = ["grazing-light", "degenerate", "order", "small-map"];
    let done = run(&[&["stability", "--methods", &others, "--size", "40x30", "--out", &out], &cases[..]].concat());
    assert!(done.status.success(), "{}", complaint(&done));
    let outcomes = outcomes(&out);
    let mut compared = 0;
    for method in &MethodName::ALL[1..] {
        let own: Vec<&Value> = outcomes.iter().filter(|o| o["method"] == method.name()).collect();
        assert!(own.len() > 15, "{}: {} frames", method.name(), own.len());
        assert!(own.iter().any(|o| o["scene"]["scene_rmse"].as_f64() > Some(0.01)), "{}", method.name());
        let exact = own.iter().filter(|o| o["promise"] == "exact");
        compared += exact.filter_map(|o| o["facet"]["facet_samples"].as_u64()).sum::<u64>();
    }
    assert!(compared > 500_000, "{compared} samples");
}

/// The frames that `stability` wrote, each as it must be.
fn outcomes(out: &str) -> Vec<Value> {
    let found = json(&Path::new(out).join("stability.json"));
    let outcomes = found["outcomes"].as_array().expect("outcomes").clone();
    for o in &outcomes {
        assert!(o["promise"] != "exact" || o["facet"]["facet_wrong_outside_band"] == 0, "{o}");
        assert!(
            o["refused"].is_null() && o["not_a_share"] == 0 && o["same_bits"] != false && o["repeats"] == true,
            "{o}"
        );
    }
    outcomes
}
