//! The program as its users meet it: exit status, lines, files.

mod with_a_gpu;

use lab::report::looks::CLASS_COLOURS;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use subpixel_shadows::methods::{METHODS, MethodName};
use test_support::Folder;

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subpixel-shadows")).args(args).output().expect("the program starts")
}

/// Runs a small frame into `out`; fails unless it succeeds.
fn render(out: &str, args: &[&str]) -> Output {
    let small: [&str; 4] = ["--size", "64x48", "--map", "64"];
    let mut all = vec!["render", "--out", out];
    if !args.contains(&"--size") {
        all.extend(small);
    }
    all.extend(args);
    let done = run(&all);
    assert!(done.status.success(), "{args:?}: {}", String::from_utf8_lossy(&done.stderr));
    done
}

fn stdout(done: &Output) -> String {
    String::from_utf8_lossy(&done.stdout).into_owned()
}

fn frame(out: &str) -> Value {
    let text = std::fs::read_to_string(Path::new(out).join("frame.json")).expect("frame.json");
    serde_json::from_str(&text).expect("frame.json is JSON")
}

/// Red and alpha of each pixel of an EXR file.
fn exr(out: &str, name: &str) -> (u32, u32, Vec<[f32; 2]>) {
    let image = image::open(Path::new(out).join(name)).expect(name).into_rgba32f();
    let pixels = image.pixels().map(|p| {
        assert!(p[0] == p[1] && p[1] == p[2], "{name} is grey");
        [p[0], p[3]]
    });
    (image.width(), image.height(), pixels.collect())
}

/// Names in a folder, in order.
fn names(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("an entry").file_name().into_string().expect("UTF-8")).collect();
    names.sort();
    names
}

/// Triangles as an OBJ file.
fn write_obj(path: &str, corners: &[[f32; 3]]) {
    let mut text = String::new();
    for [x, y, z] in corners {
        text += &format!("v {x} {y} {z}\n");
    }
    for t in 0..corners.len() / 3 {
        text += &format!("f {} {} {}\n", 3 * t + 1, 3 * t + 2, 3 * t + 3);
    }
    std::fs::write(path, text).expect("a file");
}

/// A frame of the contract, whichever engine made it.
fn assert_contract(out: &str, engine: &str, size: [u32; 2], samples: usize) {
    let f = frame(out);
    let keys = [
        "program",
        "adapter",
        "engine",
        "scene",
        "method",
        "image_size",
        "map_size",
        "samples",
        "camera",
        "light",
        "mesh",
        "ground",
        "stages",
        "gpu_ms",
        "wall_ms",
        "timed_frames",
        "setup_ms",
        "memory",
        "settings",
        "counts",
        "lists",
        "error",
    ];
    let object = f.as_object().expect("an object");
    assert_eq!(object.len(), keys.len(), "{:?}", object.keys());
    assert!(keys.iter().all(|k| object.contains_key(*k)), "{:?}", object.keys());
    assert_eq!(f["program"]["version"], env!("CARGO_PKG_VERSION"));
    assert!(f["adapter"]["name"].is_string() && f["adapter"]["backend"].is_string());
    assert_eq!(f["engine"], engine);
    assert!(METHODS.iter().any(|row| f["method"] == row.name), "{}", f["method"]);
    assert_eq!(f["image_size"], serde_json::json!(size));
    let offsets = f["samples"].as_array().expect("samples");
    assert_eq!((offsets.len(), &offsets[0]), (samples, &serde_json::json!([0.5, 0.5])));
    let inside = |v: &Value| v.as_f64().is_some_and(|v| (0.0..1.0).contains(&v));
    assert!(offsets.iter().all(|o| inside(&o[0]) && inside(&o[1])));
    for key in ["eye", "target", "up"] {
        assert_eq!(f["camera"][key].as_array().map(Vec::len), Some(3), "camera {key}");
    }
    for key in ["vertical_fov_degrees", "near", "far"] {
        assert!(f["camera"][key].as_f64().is_some_and(|v| v > 0.0), "camera {key}");
    }
    assert!(f["light"]["kind"].is_string());
    for key in ["triangles", "vertices", "edges"] {
        assert!(f["mesh"][key].is_u64(), "mesh {key}");
    }
    assert!(f["mesh"]["closed"].is_boolean());
    let stages = f["stages"].as_array().expect("stages");
    assert!(stages.len() >= if f["method"] == "facet-masks" { 11 } else { 4 }, "{}", f["stages"]);
    for stage in stages {
        assert!(stage["name"].is_string() && stage["gpu_ms"].as_f64().is_some_and(|ms| ms >= 0.0), "{stage}");
        assert!(stage["left_out"].is_null() || stage["left_out"].is_string(), "{stage}");
        assert!(stage["cpu_ms"].as_f64().is_some_and(|ms| ms == 0.0 || (ms > 0.0 && engine == "cpu")), "{stage}");
    }
    assert!(f["gpu_ms"].is_number() && f["wall_ms"].is_number() && f["timed_frames"].is_u64());
    assert!(f["setup_ms"].as_f64().is_some_and(|ms| ms > 0.0) && f["settings"]["method"] == f["method"]);
    let held = f["memory"]["buffers"].as_array().expect("buffers");
    let bytes: Vec<u64> = held.iter().map(|buffer| buffer["bytes"].as_u64().expect("bytes")).collect();
    assert_eq!(f["memory"]["bytes"].as_u64(), Some(bytes.iter().sum()));
    assert!(bytes.is_sorted_by(|a, b| a >= b) && bytes.is_empty() == (engine == "cpu" || f["timed_frames"] == 0));
    for key in [
        "silhouette_edges",
        "silhouette_texels",
        "silhouette_pixels",
        "pixel_texel_pairs",
        "triangle_texel_pairs",
        "visibility_evaluations",
    ] {
        assert!(f["counts"][key].is_u64(), "counts {key}");
    }
    for list in f["lists"].as_array().expect("lists") {
        assert!(list["name"].is_string(), "{list}");
        assert!(["needed", "capacity", "runs"].iter().all(|k| list[k].is_u64()), "{list}");
        assert!(list["needed"].as_u64() <= list["capacity"].as_u64(), "{list}");
    }
    let (w, h, pixels) = exr(out, "visibility.exr");
    assert_eq!([w, h], size);
    for [v, seen] in pixels {
        assert!((0.0..=1.0).contains(&v) && (seen == 1.0 || (seen == 0.0 && v == 1.0)), "{v} {seen}");
    }
    for picture in ["shaded.png", "visibility.png"] {
        let image = image::open(Path::new(out).join(picture)).expect(picture);
        assert_eq!([image.width(), image.height()], size, "{picture}");
    }
}

#[test]
fn help_and_version_succeed_and_usage_is_2() {
    for args in [&["--help"][..], &["--version"], &["render", "--help"], &["adapters", "--help"]] {
        assert_eq!(run(args).status.code(), Some(0), "{args:?}");
    }
    for args in [
        &["report", "--methods", "none"][..],
        &["stability", "--size", "5"],
        &["--samples", "many"],
        &["--size", "800"],
        &["--size", "axb"],
        &["--size", "-1x5"],
        &["--method", "no-such-method"],
        &["--facets", "both"],
        &["--engine", "tpu"],
        &["render", "a", "b"],
        &["--unknown"],
        &["--map"],
        &["--out", ""],
        &["--memory-limit", "0"],
    ] {
        let done = run(args);
        assert_eq!(done.status.code(), Some(2), "{args:?}");
        assert!(!done.stderr.is_empty() && done.stdout.is_empty(), "{args:?}");
    }
}

/// Bad input: status 1, one line that says what and with which numbers, and nothing left behind.
#[test]
fn bad_input_is_one_line_and_leaves_nothing() {
    let folder = Folder::new("bad");
    let file = |name: &str, text: &str| {
        std::fs::write(folder.path(name), text).expect("a file");
        folder.path(name)
    };
    let bad_index = file("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    let bad_number = file("number.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let empty = file("empty.ply", "");
    let missing = folder.path("missing.obj");
    let taken = file("taken", "");
    let out = folder.path("out");
    let cases: &[(&[&str], &[&str])] = &[
        (&["no-such-scene"], &["no-such-scene", "windmill"]),
        (&[&missing], &["missing.obj"]),
        (&[&bad_index], &["index.obj", "9"]),
        (&[&bad_number], &["number.obj"]),
        (&[&empty], &["empty.ply", "0 bytes"]),
        (&["plane", "--camera", "eye=nan,1,2"], &["eye", "NaN"]),
        (&["plane", "--camera", "eye=1,1"], &["eye", "2 numbers"]),
        (&["plane", "--camera", "eye=1,1,1;target=1,1,1"], &["(1, 1, 1)"]),
        (&["plane", "--camera", "fov=180"], &["180"]),
        (&["plane", "--light", "directional=0,0,0"], &["(0, 0, 0)", "length 0"]),
        (&["plane", "--light", "point=inf,0,0"], &["inf"]),
        (&["plane", "--light", "sun=0,0,0"], &["sun"]),
        (&["plane", "--size", "0x0"], &["0x0"]),
        (&["plane", "--size", "5x0"], &["5x0"]),
        (&["plane", "--size", "20000x1"], &["20000x1"]),
        (&["plane", "--samples", "33"], &["33"]),
        (&["plane", "--samples", "0"], &["0 samples"]),
        (&["plane", "--map", "0"], &["0 texels"]),
        (&["plane", "--map", "9000"], &["9000", "8192"]),
        (&["plane", "--method", "pcf", "--kernel", "4"], &["4 x 4"]),
        (&["plane", "--method", "reconstructable", "--lookups", "4"], &["4 x 4"]),
        (&["plane", "--method", "polygon-ids", "--lookups", "2"], &["2 x 2"]),
        (&["plane", "--method", "smsr", "--reach", "65"], &["65", "64"]),
        (&["plane", "--method", "deep", "--sub-texels", "3"], &["3 x 3", "2, 4 and 8"]),
        (&["plane", "--method", "deep", "--nodes", "2"], &["2 nodes", "3 to 15"]),
        (&["plane", "--method", "deep", "--error", "0.6"], &["0.6", "0.5"]),
        (&["plane", "--method", "remix", "--splits", "5"], &["5 splits", "4"]),
        (&["plane", "--method", "parallel-split", "--splits", "0"], &["0 splits"]),
        (&["plane", "--method", "pcf", "--bias", "0.1", "--compare", "dual"], &["--bias", "--compare"]),
        (&["plane", "--method", "lispsm", "--slope-bias", "101"], &["101 slopes", "100"]),
        (&["plane", "--method", "pcf", "--splits", "2", "--partition", "frustum-faces"], &["2 splits", "faces"]),
        (&["plane", "--method", "pcf", "--warp", "stable", "--partition", "frustum-faces"], &["stable", "faces"]),
        (&["plane", "--method", "pcf", "--splits", "2", "--partition", "receiver-clusters"], &["2 splits", "clusters"]),
        (&["plane", "--method", "pcf", "--splits", "2", "--omni", "paraboloids"], &["paraboloid", "slices"]),
        (&["plane", "--method", "pcf", "--compare", "dual", "--omni", "paraboloids"], &["paraboloid", "depth"]),
        (&["plane", "--method", "pcf", "--history", "2", "--omni", "paraboloids"], &["paraboloid", "history"]),
        (&["plane", "--method", "trapezoidal", "--focus", "0"], &["first 0 of"]),
        (&["plane", "--method", "remix", "--focus", "nan"], &["first NaN of"]),
        (&["plane", "--method", "variance", "--bleeding", "1"], &["1 of the light", "0.9"]),
        (&["plane", "--method", "remix", "--grazing", "91"], &["91 degrees", "90"]),
        (&["plane", "--method", "spsm", "--engine", "cpu"], &["spsm"]),
        (&["plane", "--out", &taken], &["taken"]),
    ];
    for (args, parts) in cases {
        let mut all = vec!["render"];
        if !args.contains(&"--out") {
            all.extend(["--out", out.as_str()]);
        }
        all.extend(*args);
        let done = run(&all);
        let line = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(1), "{args:?}: {line}");
        assert!(line.starts_with("subpixel-shadows: ") && line.lines().count() == 1, "{args:?}: {line}");
        assert!(parts.iter().all(|p| line.contains(p)), "{args:?}: {line}");
        assert!(done.stdout.is_empty(), "{args:?}");
        assert!(!Path::new(&out).exists(), "{args:?} left a folder");
    }
    assert_eq!(names(&folder.path("")), ["empty.ply", "index.obj", "number.obj", "taken"]);
}

#[test]
fn rays_on_the_cpu_are_a_method() {
    let folder = Folder::new("cpu-rays");
    let out = folder.path("out");
    let args = ["windmill", "--engine", "cpu", "--method", "ray-traced", "--truth", "--frames", "2", "--quiet"];
    render(&out, &args);
    assert_contract(&out, "cpu", [64, 48], 32);
    let f = frame(&out);
    assert!(f["error"]["scene_rmse"].as_f64().is_some_and(|e| e < 0.01), "{}", f["error"]);
    assert_eq!((&f["timed_frames"], &f["gpu_ms"]), (&2.into(), &0.0.into()));
    for stage in f["stages"].as_array().expect("stages") {
        let rays = stage["name"] == "shadow_rays";
        assert_eq!((stage["left_out"].is_null(), stage["cpu_ms"].as_f64() > Some(0.0)), (rays, rays), "{stage}");
    }
    let share: f32 = exr(&out, "visibility.exr").2.iter().map(|v| v[0]).sum::<f32>() / (64.0 * 48.0);
    assert!(share > 0.3 && share < 0.95, "{share}");
    // Other methods have no CPU engine, and say so.
    let other = folder.path("other");
    for (asked, words) in [
        (&["--method", "spsm"][..], ["spsm", "facet-masks and ray-traced"]),
        (&["--method", "ray-traced", "--facets", "one"], ["ray-traced", "--facets all"]),
    ] {
        let refused = run(&[&["render", "plane", "--engine", "cpu", "--out", &other], asked].concat());
        let line = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!((refused.status.code(), line.lines().count()), (Some(1), 1), "{line}");
        assert!(words.iter().all(|word| line.contains(word)), "{line}");
    }
    assert!(!Path::new(&other).exists());
}

#[test]
fn the_cpu_engine_works_and_says_so() {
    let folder = Folder::new("cpu");
    let out = folder.path("deep/out");
    let done = render(&out, &["plane", "--engine", "cpu", "--truth", "--quiet"]);
    assert!(stdout(&done).contains("CPU engine"), "{}", stdout(&done));
    assert!(done.stderr.is_empty(), "{}", String::from_utf8_lossy(&done.stderr));
    assert_contract(&out, "cpu", [64, 48], 32);
    let f = frame(&out);
    assert!(f["error"]["scene_rmse"].is_number(), "{}", f["error"]);
    assert_eq!(f["error"]["facet_wrong_outside_band"], 0, "{}", f["error"]);
    assert!(f["error"]["facet_samples"].as_u64() > Some(1000), "{}", f["error"]);
    assert!(f["error"]["converged_rmse"].is_null(), "{}", f["error"]);
    let files = ["difference.png", "frame.json", "shaded.png", "truth.exr", "visibility.exr", "visibility.png"];
    assert_eq!(names(&out), files);
    assert_eq!(exr(&out, "truth.exr").2.len(), 64 * 48);
    // Every stage has its time, or a reason.
    for stage in f["stages"].as_array().expect("stages") {
        let (ran, time) = (stage["left_out"].is_null(), stage["cpu_ms"].as_f64().expect("a time"));
        assert!(time > 0.0 || (time == 0.0 && !ran), "{stage}");
        assert_eq!(stage["gpu_ms"], 0.0, "{stage}");
    }
    assert!(stdout(&done).contains("CPU ms") && f["counts"]["visibility_evaluations"].as_u64() > Some(0));
    let done = render(&out, &["plane", "--engine", "cpu", "--facets", "one", "--looks", "--quiet"]);
    assert!(stdout(&done).contains("classes.png: "), "{}", stdout(&done));
    assert!(names(&out).contains(&"light-view.png".to_owned()), "{:?}", names(&out));
}

/// The error against many rays holds that of the samples: with one there is more of it than with 128, and those leave little.
#[test]
fn the_error_against_many_rays() {
    let folder = Folder::new("converged");
    let out = folder.path("out");
    let errors = ["1", "128"].map(|samples| {
        let args = ["plane", "--engine", "cpu", "--truth", "--converged", "--quiet", "--samples", samples];
        let done = render(&out, &args);
        assert!(stdout(&done).contains("against 1024 rays a pixel: RMSE 0."), "{}", stdout(&done));
        let error = &frame(&out)["error"];
        assert!(error["scene_band_rmse"].as_f64() < Some(0.01), "{error}");
        assert!(error["converged_band_pixels"].as_u64() > Some(50), "{error}");
        error["converged_band_rmse"].as_f64().expect("an error")
    });
    assert!(errors[0] > 0.15 && errors[1] > 0.0 && errors[1] < 0.05, "{errors:?}");
    let alone = run(&["render", "plane", "--engine", "cpu", "--converged", "--out", &out]);
    assert_eq!(alone.status.code(), Some(2));
}

#[test]
fn the_cpu_engine_takes_odd_sizes_and_every_number_of_samples() {
    let folder = Folder::new("odd");
    let out = folder.path("out");
    for (size, w, h) in [("1x1", 1, 1), ("3x5", 3, 5)] {
        for (samples, n) in [("1", 1), ("8", 8), ("128", 128)] {
            let args = ["render", "plane", "--engine", "cpu", "--size", size, "--samples", samples, "--out", &out];
            assert!(run(&args).status.success(), "{args:?}");
            assert_contract(&out, "cpu", [w, h], n);
        }
    }
}

#[test]
fn explain_names_each_stage_and_reason() {
    let folder = Folder::new("explain");
    let text = stdout(&run(&["explain", "windmill"]));
    for stage in ["triangle_setup", "visibility_masks", "resolve"] {
        assert!(text.lines().any(|l| l.starts_with(stage) && l.contains("runs")), "{text}");
    }
    assert!(text.contains("directional light"), "{text}");
    let flat = folder.path("flat.obj");
    write_obj(&flat, &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    let text = stdout(&run(&["explain", &flat]));
    assert!(text.contains("left out") && text.contains("one plane"), "{text}");
    let text = stdout(&run(&["explain", &flat, "--force-all"]));
    assert!(!text.contains("one plane"), "{text}");
}

/// Each pixel takes one way, and so does each facet.
#[test]
fn explain_counts_the_ways_of_pixels() {
    for facets in ["one", "all"] {
        let text = stdout(&run(&[
            "explain", "spheres", "--size", "64x48", "--map", "64", "--facets", facets, "--engine", "cpu",
        ]));
        let count = |way: &str| -> u64 {
            let line = text.lines().find(|l| l.starts_with(way)).unwrap_or_else(|| panic!("{way}: {text}"));
            let digits: String = line[way.len()..].trim_start().chars().take_while(|c| *c != ' ').collect();
            digits.replace(',', "").parse().expect("a number")
        };
        let ways: &[&str] = match facets {
            "one" => &["pixels with one facet"],
            _ => &["pixels proved to show one surface", "pixels that may show several"],
        };
        let shown: u64 = ways.iter().map(|way| count(way)).sum();
        assert_eq!(shown + count("pixels that see nothing"), 64 * 48, "{text}");
        assert!(ways.iter().all(|way| count(way) > 0), "{text}");
        let facets = ["turned from the light", "proved lit", "proved in shadow", "left undecided"];
        let made: u64 = facets.iter().map(|way| count(&format!("facets {way}"))).sum();
        assert!(made >= shown, "{made} facets of {shown} pixels");
    }
}

/// Every row makes the method that it names, with the arguments that it tells.
#[test]
fn methods_are_rows_that_render_takes() {
    let rows: Vec<Value> = serde_json::from_str(&stdout(&run(&["methods", "--json"]))).expect("JSON");
    let name = |row: &Value| row["name"].as_str().expect("a name").to_owned();
    let known: Vec<&str> = MethodName::ALL.iter().map(|method| method.name()).collect();
    assert_eq!(rows.iter().map(name).collect::<Vec<_>>(), known);
    let table = stdout(&run(&["methods"]));
    for row in &rows {
        let text = |key: &str| row[key].as_str().expect(key).to_owned();
        assert!(table.contains(&text("paper")) && !text("section").is_empty(), "{row}");
        let options = row["options"].as_array().expect("a list").iter().map(|o| o.as_str().expect("an argument"));
        let args: Vec<&str> =
            ["explain", "plane", "--size", "16x12", "--map", "16"].into_iter().chain(options).collect();
        let told = run(&args);
        assert!(told.status.success() && stdout(&told).contains("triangle_setup"), "{args:?}: {}", stdout(&told));
        for option in row["takes"].as_array().expect("a list") {
            let option = format!("--{}", option.as_str().expect("an option"));
            assert!(stdout(&run(&["render", "--help"])).contains(&option), "{option}");
        }
    }
}

#[test]
fn kernels_are_written_whole() {
    let folder = Folder::new("kernels");
    let out = folder.path("wgsl");
    assert!(run(&["kernels", "--out", &out]).status.success());
    let files = names(&out);
    assert_eq!(files.len(), subpixel_shadows::gpu::kernels::ALL.len());
    for (stem, _, entries) in subpixel_shadows::gpu::kernels::ALL {
        let text = std::fs::read_to_string(Path::new(&out).join(format!("{stem}.wgsl"))).expect("a kernel");
        let module = naga::front::wgsl::parse_str(&text).expect("WGSL");
        assert_eq!(module.entry_points.len(), entries.len(), "{stem}");
    }
    std::fs::write(folder.path("taken"), "").expect("a file");
    let refused = run(&["kernels", "--out", &folder.path("taken")]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("taken"));
}

#[test]
fn an_empty_scene_is_fully_lit_without_an_adapter() {
    let folder = Folder::new("empty");
    let (file, out) = (folder.path("empty.obj"), folder.path("out"));
    std::fs::write(&file, "# nothing\n").expect("a file");
    let done = render(&out, &[&file, "--engine", "cpu"]);
    assert!(done.stderr.is_empty());
    assert!(exr(&out, "visibility.exr").2.iter().all(|p| *p == [1.0, 0.0]));
    let f = frame(&out);
    let reasons = f["stages"].as_array().expect("stages").iter().map(|s| s["left_out"].as_str().unwrap_or_default());
    assert!(reasons.into_iter().all(|r| r.contains("no triangles")), "{}", f["stages"]);
}
