//! Faults of the machine: a full disk, a standard output that is full or closed, two runs at once, runs that are
//! killed.
#![cfg(unix)]

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs::File;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use test_support::Folder;
use test_support::gpu_test;

const PROGRAM: &str = env!("CARGO_BIN_EXE_subpixel-shadows");

/// What the program itself says; drivers may say more.
fn complaint(done: &Output) -> String {
    let text = String::from_utf8_lossy(&done.stderr).into_owned();
    text.lines().filter(|l| l.starts_with("subpixel-shadows: ")).map(|l| format!("{l}\n")).collect()
}

fn names(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
    names.sort();
    names
}

/// A small frame of the CPU engine.
fn frame(out: &str, size: &str) -> Vec<String> {
    let args = ["render", "plane", "--engine", "cpu", "--map", "16", "--samples", "8", "--quiet", "--size"];
    args.iter().copied().chain([size, "--out", out]).map(str::to_owned).collect()
}

const FILES: [&str; 4] = ["frame.json", "shaded.png", "visibility.exr", "visibility.png"];

fn run(args: &[String]) -> Output {
    Command::new(PROGRAM).args(args).output().expect("the program starts")
}

/// Runs it where no file may be longer than 20 blocks of 512 bytes; `before` goes before that.
fn run_limited(before: &str, args: &[String]) -> Output {
    let script = format!("{before} ulimit -f 20; exec \"$0\" \"$@\"");
    Command::new("sh").args(["-c", &script, PROGRAM]).args(args).output().expect("a shell")
}

#[test]
fn a_full_standard_output_is_a_fault_and_a_closed_one_is_none() {
    let folder = Folder::new("stdout");
    let (out, full) = (folder.path("out"), || File::options().write(true).open("/dev/full").expect("/dev/full"));
    let explain = ["explain", "plane", "--engine", "cpu", "--size", "8x6", "--map", "8"].map(str::to_owned);
    for args in [frame(&out, "8x6"), explain.to_vec(), vec!["--help".into()], vec!["adapters".into()]] {
        let done = Command::new(PROGRAM).args(&args).stdout(full()).output().expect("the program starts");
        let line = complaint(&done);
        assert_eq!(done.status.code(), Some(1), "{args:?}: {line}");
        assert!(line.contains("standard output: cannot be written: No space") && line.lines().count() == 1, "{line}");
        // Dropped at once: the program writes into a pipe that nobody reads.
        let mut child = Command::new(PROGRAM).args(&args).stdout(Stdio::piped()).spawn().expect("the program starts");
        drop(child.stdout.take());
        assert_eq!(child.wait().expect("an end").code(), Some(0), "{args:?}");
    }
    assert_eq!(names(&out), FILES, "the files are complete");
}

/// The shell makes the limit an error of `write`, as a full disk is one.
#[test]
fn a_full_disk_is_told_in_words_that_are_true() {
    let folder = Folder::new("full");
    let out = folder.path("a/b");
    let done = run_limited("trap '' XFSZ;", &frame(&out, "64x48"));
    let line = complaint(&done);
    assert_eq!(done.status.code(), Some(1), "{line}");
    let expected = format!("subpixel-shadows: {out}/visibility.exr: cannot be written: File too large");
    assert!(line.starts_with(&expected) && line.lines().count() == 1, "{line}");
    assert!(names(&folder.path("")).is_empty(), "{:?}", names(&folder.path("")));
}

/// A run that a signal ends in the middle of a file leaves what was there, and the next one clears what it left.
#[test]
fn what_a_killed_run_left_is_cleared_by_the_next() {
    let folder = Folder::new("left");
    let out = folder.path("out");
    assert!(run(&frame(&out, "8x6")).status.success());
    let before = FILES.map(|name| std::fs::read(Path::new(&out).join(name)).expect("a file"));
    let killed = run_limited("", &frame(&out, "64x48"));
    assert!(killed.status.signal().is_some(), "{:?}", killed.status);
    assert_eq!(FILES.map(|name| std::fs::read(Path::new(&out).join(name)).expect("a file")), before);
    assert_eq!(names(&out).len(), FILES.len() + 1, "{:?}", names(&out));
    assert!(names(&out)[0].ends_with(".part"), "{:?}", names(&out));
    assert!(run(&frame(&out, "8x6")).status.success());
    assert_eq!(names(&out), FILES);
}

/// Two frames at once into one folder: both succeed, and all files are of one of them.
#[test]
fn files_of_two_runs_do_not_mix() {
    let folder = Folder::new("two");
    let out = folder.path("out");
    for _ in 0..4 {
        let start = |size| {
            let mut command = Command::new(PROGRAM);
            command.args(frame(&out, size)).stdout(Stdio::null()).spawn().expect("the program starts")
        };
        let both = [start("9x5"), start("12x7")].map(|mut child| child.wait().expect("an end").success());
        assert_eq!(both, [true; 2]);
        assert_eq!(names(&out), FILES);
        let text = std::fs::read_to_string(Path::new(&out).join("frame.json")).expect("frame.json");
        let size = serde_json::from_str::<Value>(&text).expect("JSON")["image_size"].clone();
        for name in ["shaded.png", "visibility.png", "visibility.exr"] {
            let (w, h) = image::image_dimensions(Path::new(&out).join(name)).expect("a picture");
            assert_eq!(serde_json::json!([w, h]), size, "{name}");
        }
    }
}

/// A folder that another run holds for long is refused in one line, and free again when that run is gone.
#[gpu_test]
fn the_second_run_is_refused() {
    let folder = Folder::new("held");
    let out = folder.path("out");
    std::fs::create_dir(&out).expect("made");
    let held = File::open(&out).expect("a folder");
    held.try_lock().expect("nobody holds it");
    let report = ["report", "plane", "--quick", "--out", &out].map(str::to_owned).to_vec();
    let stability = ["stability", "contact", "--out", &out].map(str::to_owned).to_vec();
    for args in [frame(&out, "8x6"), report, stability] {
        let start = Instant::now();
        let done = run(&args);
        let line = complaint(&done);
        assert_eq!(done.status.code(), Some(1), "{args:?}: {line}");
        assert!(line.contains(&format!("{out}: another run is writing there")) && line.lines().count() == 1, "{line}");
        assert!(start.elapsed() < Duration::from_secs(20), "{args:?} took {:?}", start.elapsed());
    }
    assert!(names(&out).is_empty());
    drop(held);
    assert!(run(&frame(&out, "8x6")).status.success());
}

/// The arguments of a small report: many rows, little work.
const REPORT: [&str; 17] = [
    "report",
    "plane",
    "spheres",
    "--quick",
    "--quiet",
    "--size",
    "16x12",
    "--maps",
    "16,32",
    "--samples",
    "1,8,16,32",
    "--methods",
    "shadow-map,pcf,variance,smsr",
    "--repeats",
    "1",
    "--tessellate",
    "0",
];

fn start_report(out: &str) -> Child {
    let mut command = Command::new(PROGRAM);
    command.args(REPORT).args(["--out", out]).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("the program starts")
}

/// Key that tells rows apart.
fn key(row: &Value) -> String {
    let keys = ["scene", "tessellation", "method", "setting", "samples", "map"];
    keys.map(|k| row[k].to_string()).join(" ")
}

/// The rows of a finished report in order, after the journal was found to hold each of them once.
fn rows(out: &str) -> Vec<String> {
    let text = std::fs::read_to_string(Path::new(out).join("rows.json")).expect("rows.json");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    let rows: Vec<String> = found["rows"].as_array().expect("rows").iter().map(key).collect();
    let journal = std::fs::read_to_string(Path::new(out).join("rows.jsonl")).expect("rows.jsonl");
    let lines: Vec<String> = journal.lines().skip(1).map(|l| key(&serde_json::from_str(l).expect("a row"))).collect();
    let once: BTreeSet<&String> = lines.iter().collect();
    assert_eq!((once.len(), lines.len()), (rows.len(), rows.len()), "rows are in the journal once: {lines:#?}");
    assert_eq!(once, rows.iter().collect(), "and no others");
    rows
}

/// Kills a report `kills` times, by TERM and KILL in turns, now at a random moment and now just after a row was
/// written; then lets it come to its end. Returns how many of the killed runs were at work, and how often half a line
/// was left.
fn kill_and_resume(kills: u64) -> (u64, u64) {
    let folder = Folder::new("killed");
    let (whole, out) = (folder.path("whole"), folder.path("killed"));
    let length = |folder: &str| std::fs::metadata(Path::new(folder).join("rows.jsonl")).map_or(0, |m| m.len());
    let (start, mut child) = (Instant::now(), start_report(&whole));
    // The machine is the first line, and about as long as it is here.
    while length(&whole) < 500 && child.try_wait().expect("a state").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let to_a_row = start.elapsed();
    assert!(child.wait().expect("an end").success());
    let expected = rows(&whole);
    assert!(expected.len() >= 40, "{expected:#?}");
    let journal = Path::new(&out).join("rows.jsonl");
    let (mut state, mut at_work, mut halves) = (1u64, 0, 0);
    for k in 0..kills {
        let mut child = start_report(&out);
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let share = (state >> 40) as f64 / (1u64 << 24) as f64;
        let (began, before) = (Instant::now(), length(&out));
        if k % 4 < 2 {
            while length(&out) == before && began.elapsed() < 5 * to_a_row {
                std::thread::sleep(Duration::from_micros(200));
            }
            std::thread::sleep(Duration::from_secs_f64(0.02 * share));
        } else {
            std::thread::sleep(to_a_row.mul_f64(1.2 * share));
        }
        at_work += u64::from(child.try_wait().expect("a state").is_none());
        if k % 2 == 0 {
            child.kill().expect("killed");
        } else {
            let done = Command::new("sh").args(["-c", &format!("kill -TERM {} 2>/dev/null", child.id())]).status();
            done.expect("a shell");
        }
        child.wait().expect("an end");
        let left = std::fs::read(&journal).unwrap_or_default();
        halves += u64::from(!left.is_empty() && !left.ends_with(b"\n"));
    }
    assert!(start_report(&out).wait().expect("an end").success());
    assert_eq!(rows(&out), expected, "after {kills} kills");
    assert_eq!(names(&out), names(&whole), "nothing unfinished is left");
    (at_work, halves)
}

#[gpu_test]
fn a_report_killed_twenty_times_goes_on_without_a_row_lost_or_twice() {
    let start = Instant::now();
    let (at_work, halves) = kill_and_resume(20);
    println!("20 kills, {at_work} at work, {halves} left half a line, {:.0} s", start.elapsed().as_secs_f64());
    assert!(at_work >= 15, "{at_work} of 20 were killed at work");
}
