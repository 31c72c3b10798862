//! `report figure` as its users meet it: what it measures is what `render` renders, and it goes on where it stopped.

use lab::report::experiments::experiments;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use test_support::{Folder, gpu_test};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subpixel-shadows")).args(args).output().expect("the program starts")
}

/// Lines of the program itself; drivers may say more.
fn complaint(done: &Output) -> String {
    let text = String::from_utf8_lossy(&done.stderr).into_owned();
    text.lines().filter(|l| l.starts_with("subpixel-shadows: ")).map(|l| format!("{l}\n")).collect()
}

const SMALL: [&str; 7] = ["--size", "64x48", "--repeats", "1", "--row-seconds", "1", "--quiet"];

fn figure(out: &str, args: &[&str]) {
    let done = run(&[&["report", "figure", "--out", out], &SMALL[..], args].concat());
    assert!(done.status.success(), "{args:?}: {}", String::from_utf8_lossy(&done.stderr));
}

/// The rows of an experiment's journal.
fn rows(folder: &Path) -> Vec<Value> {
    let journal = std::fs::read_to_string(folder.join("rows.jsonl")).expect("a journal");
    journal.lines().skip(1).map(|line| serde_json::from_str(line).expect("a row")).collect()
}

/// One of each paper: every row is on the page with the command that renders it, and that command finds the same errors; what the page links
/// is there.
#[gpu_test]
fn every_row_agrees_with_render() {
    let folder = Folder::new("figures");
    let (out, frame) = (folder.path("figures"), folder.path("frame"));
    let names = ["pan-11", "lecocq-2", "bondarev-graph-1", "scherzer-17"];
    figure(&out, &names);
    let mut compared = 0;
    for name in names {
        let own = Path::new(&out).join(name);
        let page = std::fs::read_to_string(own.join("page.md")).expect("a page");
        let experiment = experiments().find(|e| e.name == name).expect("an experiment");
        let rows = rows(&own);
        let wanted = experiment.places.len() * experiment.rows.len() * experiment.samples.len() * experiment.maps.len();
        assert_eq!(rows.len(), wanted, "{name}");
        assert!(rows.iter().all(|r| r["failed"].is_null()), "{name}");
        assert!(page.contains(experiment.shows) && page.contains(experiment.differs), "{name}");
        let commands: Vec<&str> =
            page.lines().filter_map(|l| l.strip_prefix("- `cargo run --release -- ")?.strip_suffix('`')).collect();
        assert_eq!(commands.len(), wanted, "{name}");
        for part in page.lines().filter_map(|l| l.strip_prefix("![")) {
            let link = part.split(['(', ')']).nth(1).expect("a link");
            assert!(own.join(link).exists(), "{name} links {link}");
        }
        for (row, command) in rows.iter().zip(&commands).step_by(5) {
            let args: Vec<&str> = command.split(' ').collect();
            let done = run(&[&args[..], &["--frames", "1", "--quiet", "--out", &frame]].concat());
            assert!(done.status.success(), "{command}: {}", complaint(&done));
            let text = std::fs::read_to_string(Path::new(&frame).join("frame.json")).expect("a frame");
            let rendered: Value = serde_json::from_str(&text).expect("JSON");
            assert_eq!(row["method"], rendered["method"], "{command}");
            for (key, value) in row["matched"].as_object().expect("an object") {
                assert_eq!(value, &rendered["error"][key], "{key} of {command}");
            }
            compared += 1;
        }
    }
    assert!(compared > 8, "{compared} rows");
}

/// Rows of an earlier run are kept, one that was cut off is measured, and the page is the same but for times.
#[gpu_test]
fn goes_on_where_it_stopped() {
    let folder = Folder::new("figures-resume");
    let out = folder.path("figures");
    figure(&out, &["pan-9"]);
    let own = Path::new(&out).join("pan-9");
    let journal = own.join("rows.jsonl");
    let whole = std::fs::read_to_string(&journal).expect("a journal");
    let (page, known) = (std::fs::read_to_string(own.join("page.md")).expect("a page"), rows(&own));
    // Samples that a validity mask leaves where a shadow ends: some, and not all.
    let valid: Vec<[f64; 2]> = known
        .iter()
        .map(|r| ["facets", "valid_samples"].map(|key| r["boundary"][key].as_f64().expect("a figure")))
        .collect();
    let some = |[facets, valid]: &[f64; 2]| *facets > 50.0 && (2.0..31.0).contains(valid);
    assert!(valid.len() == 2 && valid.iter().all(some), "{valid:?}");
    std::fs::write(&journal, &whole[..whole.len() - 9]).expect("written");
    figure(&out, &["pan-9"]);
    let again = rows(&own);
    assert_eq!(again[0], known[0], "a finished row is kept");
    assert_eq!(again[1]["matched"], known[1]["matched"]);
    assert_eq!(std::fs::read_to_string(own.join("page.md")).expect("a page"), page);
}

/// Parts that are measured apart make the page that one run makes, but for times; rows of another machine do not go together.
#[gpu_test]
fn parts_make_the_page_of_the_whole() {
    let folder = Folder::new("figures-parts");
    let whole = folder.path("whole");
    figure(&whole, &["scherzer-23"]);
    let parts = ["1/3", "2/3", "3/3"].map(|part| {
        let out = folder.path(&part.replace('/', "-of-"));
        figure(&out, &["scherzer-23", "--part", part]);
        assert!(!Path::new(&out).join("scherzer-23/page.md").exists(), "a part has no page");
        out
    });
    let counts = parts.each_ref().map(|out| rows(&Path::new(out).join("scherzer-23")).len());
    let known = rows(&Path::new(&whole).join("scherzer-23"));
    assert_eq!(counts.iter().sum::<usize>(), known.len(), "{counts:?}");
    assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
    let merged = folder.path("merged");
    let [a, b, c] = parts.each_ref().map(String::as_str);
    // In any order, and one of them twice.
    let done = run(&["report", "merge", c, a, b, a, "--out", &merged]);
    assert!(done.status.success(), "{}", complaint(&done));
    let page = |out: &str| std::fs::read_to_string(Path::new(out).join("scherzer-23/page.md")).expect("a page");
    let lines = |out: &str| {
        let found = page(out);
        let rows = found.lines().filter(|l| l.starts_with("| ")).map(|line| {
            let cells: Vec<&str> = line.split(" | ").collect();
            // Without the two of times.
            [&cells[..3], &cells[5.min(cells.len())..]].concat().join(" | ")
        });
        rows.collect::<Vec<String>>()
    };
    assert_eq!(lines(&merged), lines(&whole));
    assert!(lines(&merged).len() > known.len());
    // The command of the whole measures no row again, and draws the pictures.
    figure(&merged, &["scherzer-23"]);
    assert!(Path::new(&merged).join("scherzer-23/pictures-knot.png").exists());
    assert_eq!(rows(&Path::new(&merged).join("scherzer-23")).len(), known.len());
    let journal = Path::new(b).join("scherzer-23/rows.jsonl");
    let text = std::fs::read_to_string(&journal).expect("a journal");
    std::fs::write(&journal, text.replacen("\"threads\":", "\"threads\":1", 1)).expect("written");
    let mixed = folder.path("mixed");
    let done = run(&["report", "merge", a, b, "--out", &mixed]);
    let line = complaint(&done);
    assert_eq!(done.status.code(), Some(1), "{line}");
    assert!(line.contains("another machine") && line.lines().count() == 1 && !Path::new(&mixed).exists(), "{line}");
    let done = run(&["report", "merge", &folder.path("none"), "--out", &mixed]);
    assert!(done.status.code() == Some(1) && !Path::new(&mixed).exists());
    for part in ["0/3", "4/3", "half"] {
        let done = run(&["report", "figure", "scherzer-23", "--part", part, "--out", &mixed]);
        assert!(done.status.code() == Some(2) && !Path::new(&mixed).exists(), "{part}");
    }
}

#[test]
fn bad_input_is_one_line_and_figures_are_listed() {
    let folder = Folder::new("figures-bad");
    let out = folder.path("figures");
    for (args, part) in [(&["pan-0"][..], "pan-0"), (&["pan-10", "--size", "0x5"], "0x5")] {
        let done = run(&[&["report", "figure", "--out", &out], args].concat());
        let line = complaint(&done);
        assert_eq!(done.status.code(), Some(1), "{args:?}: {line}");
        assert!(line.contains(part) && line.lines().count() == 1, "{args:?}: {line}");
        assert!(!Path::new(&out).exists(), "{args:?} left a folder");
    }
    let listed = run(&["report", "figure"]);
    let text = String::from_utf8_lossy(&listed.stdout).into_owned();
    assert!(listed.status.success());
    for experiment in experiments() {
        assert!(text.contains(experiment.name) && text.contains(experiment.title), "{}: {text}", experiment.name);
    }
    // After options of the whole report a figure is a scene.
    let both = run(&["report", "--quick", "figure", "pan-9", "--out", &out]);
    assert!(both.status.code() == Some(1) && complaint(&both).contains("'figure'") && !Path::new(&out).exists());
}
