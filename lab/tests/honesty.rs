//! The program says what it did, and refuses what it cannot do: times, figures, settings, options.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};
use subpixel_shadows::methods::{METHOD_OPTIONS, MethodName};
use test_support::Folder;

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_subpixel-shadows")).args(args).output().expect("the program starts")
}

/// Runs a command that has to succeed; what it prints.
fn done(args: &[&str]) -> String {
    let done = run(args);
    assert!(done.status.success(), "{args:?}: {}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8_lossy(&done.stdout).into_owned()
}

/// Runs a command that has to succeed; what it notes.
fn complaint(args: &[&str]) -> String {
    let done = run(args);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.success(), "{args:?}: {said}");
    said
}

/// Runs a small frame into `out`, which has to succeed.
fn render(out: &str, args: &[&str]) -> String {
    done(&[&["render", "--quiet", "--out", out, "--size", "48x36", "--map", "64", "--frames", "1"], args].concat())
}

fn frame(out: &str) -> Value {
    serde_json::from_slice(&bytes(out, "frame.json")).expect("frame.json is JSON")
}

fn bytes(out: &str, name: &str) -> Vec<u8> {
    std::fs::read(Path::new(out).join(name)).expect(name)
}

/// A value of each option that is not its default.
fn other_value(option: &str) -> &'static str {
    match option {
        "facets" => "one",
        "masks" => "table",
        "pairs" => "sorted",
        "projection" => "two-step",
        "memory-limit" | "taps" => "16",
        "encoding" => "paper",
        "density" => "logarithmic",
        "page-rule" => "fitted",
        "search" => "near",
        "validity" | "recovery" => "off",
        "list-start" | "slope-power" | "reach" | "splits" => "1",
        "lookups" | "kernel" | "history" => "7",
        "rays" => "silhouettes",
        "radius" | "nodes" | "terms" => "3",
        "turned" => "on",
        "compare" => "midpoint",
        // As they are, which alone goes with another depth, and with slices.
        "omni" => "planes",
        "bias" => "0.00005",
        "slope-bias" => "1.05",
        "shape" => "corners",
        "partition" => "frustum-faces",
        "split-weight" => "0",
        "warp" => "even",
        "focus" => "0.2",
        "bleeding" | "error" => "0.4",
        "grazing" | "pages" => "20",
        "exponent" | "sub-texels" => "8",
        "filter" => "tent",
        "layers" | "finer" | "stretch" | "confidence-power" | "changed" => "2",
        _ => panic!("--{option} is new: give it a value here"),
    }
}

fn argument(option: &str) -> String {
    if option == "looks" { "--looks".to_owned() } else { format!("--{option}={}", other_value(option)) }
}

/// An option that the method does not take is a usage error that names those that do.
#[test]
fn options_of_other_methods_are_refused() {
    let folder = Folder::new("refused");
    let out = folder.path("out");
    for (k, option) in METHOD_OPTIONS.iter().enumerate() {
        let given = argument(option);
        let (takers, others): (Vec<_>, Vec<_>) = MethodName::ALL.into_iter().partition(|method| method.takes(option));
        let not = others[k % others.len()].name();
        for command in [&["render", "plane"][..], &["explain", "plane"], &[]] {
            let refused = run(&[command, &["--method", not, &given, "--out", &out]].concat());
            let said = String::from_utf8_lossy(&refused.stderr).into_owned();
            assert_eq!(refused.status.code(), Some(2), "{command:?} {not} {given}: {said}");
            assert!(said.contains(not) && said.contains(&format!("'--{option}'")), "{said}");
            assert!(takers.iter().all(|m| said.contains(m.name())), "{said}");
            assert!(refused.stdout.is_empty() && !Path::new(&out).exists(), "{command:?} {not} {given}");
        }
    }
    // What is a default is given by nobody, and what the method takes is taken.
    for method in MethodName::ALL {
        let mut given = vec!["explain", "plane", "--engine", "cpu", "--size", "8x6", "--method", method.name()];
        let own: Vec<String> = method.row().options.iter().map(|option| argument(option)).collect();
        given.extend(own.iter().map(String::as_str));
        done(&given);
    }
}

/// A frame of the CPU engine of a scene file with all it may have, by its path.
#[test]
fn a_frame_of_the_cpu_engine_is_repeated() {
    let folder = Folder::new("repeat-cpu");
    let (first, again) = (folder.path("first"), folder.path("again"));
    folder.file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0.1\nv 0.3 0.2 1\nf 1 2 3\nf 1 2 4\n");
    let scene = folder.file(
        "s.toml",
        "mesh = \"m.obj\"\nground = true\n[camera]\neye = [3.1, 2.7, 4.3]\ntarget = [0.3, 0.2, 0.1]\n[light]\ndirectional = [0.3, 1, 0.7]\n",
    );
    let soft = ["--light-radius", "0.25", "--light-points", "3"];
    let asked = [&["--engine", "cpu", "--samples", "8", "--pattern", "rotated", "--facets", "one"][..], &soft].concat();
    render(&first, &[&[scene.as_str(), "--light", "spot=1.3,4.1,0.77;target=0,0,0.1;angle=71.3"], &asked[..]].concat());
    done(&["render", "--quiet", "--from", &format!("{first}/frame.json"), "--out", &again]);
    let mut frames = [frame(&first), frame(&again)];
    assert_eq!(bytes(&first, "visibility.exr"), bytes(&again, "visibility.exr"));
    assert_eq!(bytes(&first, "shaded.png"), bytes(&again, "shaded.png"));
    for f in &mut frames {
        for time in ["wall_ms", "setup_ms", "stages"] {
            f.as_object_mut().expect("an object").remove(time);
        }
    }
    assert_eq!(frames[0], frames[1]);
    let told = &frames[0]["settings"];
    assert_eq!(told["light"], "spot=1.3,4.1,0.77;target=0,0,0.1;angle=71.3");
    assert_eq!((&told["light-radius"], &told["light-points"]), (&json!(0.25), &json!(3)));
    assert!(!complaint(&["render", "--from", &format!("{first}/frame.json"), "--out", &again]).contains("another"));
    // A mesh that has changed since is another picture, and that is said.
    folder.file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0.1\nv 0.3 0.2 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\n");
    let said = complaint(&["render", "--from", &format!("{first}/frame.json"), "--out", &again]);
    assert!(
        said.contains("frame.json") && said.contains("\"triangles\":4") && said.contains("\"triangles\":5"),
        "{said}"
    );
    // What is given beside it comes first; another scene, too.
    let other = ["--samples", "1", "--light", "directional=1,1,1", "--out", &again];
    done(&[&["render", "plane", "--quiet", "--from", &format!("{first}/frame.json")], &other[..]].concat());
    let f = frame(&again);
    assert_eq!(
        (&f["scene"], &f["settings"]["samples"], &f["light"]["kind"]),
        (&json!("plane"), &json!(1), &json!("directional"))
    );
    assert_eq!((&f["settings"]["pattern"], &f["camera"]["eye"]), (&json!("rotated"), &frames[0]["camera"]["eye"]));
}

/// A frame.json that cannot be followed: status 1, and one line with file, key and value.
#[test]
fn bad_frames_are_named() {
    let folder = Folder::new("bad-frame");
    let out = folder.path("out");
    let cases = [
        (r#"{"settings": {"kernel": 4}}"#, &["kernel", " 4", "2, 3, 5 and 7"][..]),
        (r#"{"settings": {"samples": 33}}"#, &["samples", "33"]),
        (r#"{"settings": {"samples": "many"}}"#, &["samples", "\"many\""]),
        (r#"{"settings": {"size": "5x"}}"#, &["size", "\"5x\""]),
        (r#"{"settings": {"camera": "eye=1,nan,2;target=0,0,0"}}"#, &["camera", "eye=1,nan,2", "NaN"]),
        (r#"{"settings": {"camera": "eye=1"}}"#, &["camera", "eye=1"]),
        (r#"{"settings": {"light": "sun=1,2,3"}}"#, &["light", "sun=1,2,3"]),
        (r#"{"settings": {"ground": 1}}"#, &["ground", " 1"]),
        (r#"{"settings": {"map": [512]}}"#, &["map", "[512]"]),
        (r#"{"settings": {"method": "magic"}}"#, &["method", "magic", "facet-masks"]),
        (r#"{"settings": {"scene": "no-such-scene"}}"#, &["scene", "no-such-scene"]),
        (r#"{"settings": {"converged": true}}"#, &["--truth"]),
        (r#"{"settings": {"out": "elsewhere"}}"#, &["out", "elsewhere"]),
        (r#"{"settings": {"colour": "red"}}"#, &["colour", "red"]),
        (r#"{"settings": 5}"#, &["settings", "5"]),
        (r#"{"engine": "cpu"}"#, &["settings"]),
        ("{", &["JSON"]),
        ("", &["JSON"]),
    ];
    for (text, parts) in cases {
        let file = folder.file("f.json", text);
        let refused = run(&["render", "plane", "--engine", "cpu", "--from", &file, "--out", &out]);
        let line = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(1), "{text}: {line}");
        assert!(line.starts_with("subpixel-shadows: ") && line.lines().count() == 1, "{text}: {line}");
        assert!(line.contains("f.json") && parts.iter().all(|p| line.contains(p)), "{text}: {line}");
        assert!(refused.stdout.is_empty() && !Path::new(&out).exists(), "{text}");
    }
    for path in [folder.path("missing.json"), folder.path("")] {
        let refused = run(&["render", "--from", &path, "--out", &out]);
        assert_eq!(refused.status.code(), Some(1), "{path}");
    }
}

/// With one sample, and where the band is empty, there is no score.
#[test]
fn nothing_has_no_score() {
    let folder = Folder::new("scores");
    let out = folder.path("out");
    let with = |args: &[&str]| {
        let text = render(&out, &[&["--engine", "cpu", "--truth", "--converged"], args].concat());
        (text, frame(&out)["error"].clone())
    };
    let band = ["scene_band_rmse", "scene_band_mean", "scene_band_max", "scene_band_pixel_match"];
    let (text, one) = with(&["plane", "--samples", "1"]);
    for key in band.iter().chain(&["scene_pixel_match", "scene_one_plane_match"]) {
        assert!(one[key].is_null() && one.as_object().is_some_and(|o| o.contains_key(*key)), "{key}: {one}");
    }
    assert!(one["scene_rmse"].is_number() && one["converged_band_rmse"].is_number(), "{one}");
    let line = |text: &str, name: &str| text.lines().find(|l| l.starts_with(name)).expect(name).to_owned();
    assert_eq!(line(&text, "silhouette band").matches('–').count(), 4, "{text}");
    assert_eq!(
        [line(&text, "whole image"), line(&text, "one plane")].map(|l| l.matches('–').count()),
        [1; 2],
        "{text}"
    );
    let (text, many) = with(&["plane", "--samples", "8"]);
    assert!(band.iter().all(|key| many[key].is_number()) && many["scene_one_plane_match"].is_number(), "{many}");
    assert!(!text.lines().any(|l| l.contains("band") && l.contains('–')), "{text}");
    // A sheet that nothing shadows, from above.
    let flat = folder.file("flat.obj", "v -9 0 -9\nv 9 0 -9\nv 0 0 9\nf 1 3 2\n");
    let (text, lit) =
        with(&[&flat, "--samples", "8", "--camera", "eye=0,2,0;target=0,0,0", "--light", "directional=0,1,0.2"]);
    assert!(band.iter().all(|key| lit[key].is_null()) && lit["converged_band_rmse"].is_null(), "{lit}");
    assert!(lit["scene_one_plane_match"] == 1.0 && lit["scene_pixel_match"] == 1.0, "{lit}");
    assert!(text.contains("in the silhouette band of 0 pixels –"), "{text}");
}

#[test]
fn a_long_name_is_shortened() {
    let name = "windmil".repeat(700);
    for args in [["render", &name, "--quiet"], ["explain", &name, "--quiet"]] {
        let refused = run(&args);
        let line = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!((refused.status.code(), line.lines().count()), (Some(1), 1), "{line}");
        assert!(line.contains("'windmil") && line.contains('…') && line.contains("built in are"), "{line}");
        assert!(line.chars().count() < 700, "{} characters", line.chars().count());
    }
}

/// The CPU engine compiles nothing; what it makes once is not in its times either.
#[test]
fn set_up_is_a_line_of_its_own() {
    let folder = Folder::new("set-up");
    let out = folder.path("out");
    let text = render(&out, &["spheres", "--engine", "cpu"]);
    let f = frame(&out);
    assert_eq!(f["timed_frames"], 1);
    let set_up = text.lines().find(|l| l.starts_with("set-up")).expect("a line");
    let ms = format!("{:.3}", f["setup_ms"].as_f64().expect("a time"));
    assert!(set_up.contains(&ms), "{set_up}, {ms}");
}

mod gpu {
    use super::*;
    use lab::scene::{Scene, SceneOptions};
    use subpixel_shadows::gpu::Gpu;
    use subpixel_shadows::methods::{FacetMode, Settings};
    use subpixel_shadows::render::{Budget, Output, Renderer};
    use subpixel_shadows::samples::{Pattern, Samples};
    use subpixel_shadows::scene::Light;
    use test_support::gpu_test;

    #[gpu_test]
    fn frames_are_repeated_bit_for_bit() {
        let folder = Folder::new("repeat");
        let (first, again) = (folder.path("first"), folder.path("again"));
        let cases: [&[&str]; 6] = [
            &[
                "spheres",
                "--facets",
                "one",
                "--masks",
                "table",
                "--ground",
                "--samples",
                "16",
                "--light",
                "point=0.3123,5.3,0.70711",
            ],
            &["bumpy", "--validity", "off", "--facets", "one", "--projection", "two-step", "--force-all"],
            &["knot", "--method", "spsm", "--encoding", "paper", "--search", "near", "--samples", "8"],
            &[
                "cage",
                "--method",
                "smsr",
                "--shape",
                "corners",
                "--reach",
                "5",
                "--camera",
                "fov=33.3;eye=1.1234567,2.3,7.7654321",
            ],
            &[
                "city",
                "--method",
                "remix",
                "--warp",
                "trapezoid",
                "--focus",
                "0.3",
                "--bleeding",
                "0.21",
                "--splits",
                "2",
            ],
            &["plane", "--method", "ray-traced", "--rays", "silhouettes", "--pattern", "grid", "--truth"],
        ];
        for case in cases {
            render(&first, case);
            done(&["render", "--quiet", "--from", &format!("{first}/frame.json"), "--out", &again]);
            assert!(bytes(&first, "visibility.exr") == bytes(&again, "visibility.exr"), "{case:?}");
            let [a, b] = [frame(&first), frame(&again)];
            for key in ["settings", "camera", "light", "ground", "adapter", "error"] {
                assert_eq!(a[key], b[key], "{case:?} {key}");
            }
        }
        // Another method takes what it takes of it.
        done(&[
            "render",
            "--quiet",
            "--from",
            &format!("{first}/frame.json"),
            "--method",
            "pcf",
            "--kernel",
            "5",
            "--out",
            &again,
        ]);
        let f = frame(&again);
        assert_eq!(
            (&f["method"], &f["settings"]["kernel"], &f["settings"]["pattern"]),
            (&json!("pcf"), &json!(5), &json!("grid"))
        );
        assert!(bytes(&first, "visibility.exr") != bytes(&again, "visibility.exr"));
    }

    /// One frame before the clock starts, on every way, with one frame, too.
    #[gpu_test]
    fn some_frame_is_timed_on_every_way() {
        let folder = Folder::new("timed");
        let out = folder.path("out");
        let flat = folder.file("flat.obj", "v -9 0 -9\nv 9 0 -9\nv 0 0 9\nf 1 3 2\n");
        let behind = ["--camera", "eye=0,5,30;target=0,5,60"];
        let cases: [(&[&str], u64); 4] =
            [(&["plane"], 1), (&["plane", "--method", "pcf"], 1), (&[&flat], 1), (&[&flat, behind[0], behind[1]], 0)];
        for (args, timed) in cases {
            let text = render(&out, args);
            let f = frame(&out);
            assert_eq!(f["timed_frames"], timed, "{args:?}");
            assert!(text.contains("times of one frame, after one that is not timed") == (timed == 1), "{text}");
            assert!(f["setup_ms"].as_f64() > f["wall_ms"].as_f64(), "{f}");
            assert!((f["wall_ms"].as_f64() > Some(0.0)) == (timed == 1), "{f}");
        }
        let text = done(&["render", &flat, "--quiet", "--frames", "3", "--size", "24x18", "--out", &out]);
        assert_eq!(frame(&out)["timed_frames"], 3, "{text}");
    }

    /// Memory that is kept from frame to frame leaves nothing behind.
    #[gpu_test]
    fn unshadowed_frames_are_as_fresh_ones() {
        let gpu = Gpu::open(None).expect("a GPU");
        let scene = Scene::open("spheres", &SceneOptions::default()).expect("a scene");
        let prepared = scene.prepared().expect("a sound mesh");
        let settings = Settings::new([48, 36], 64, Samples::new(Pattern::default(), 32).expect("32 samples"));
        let mut aside = scene.camera;
        aside.target = [scene.camera.target[0] + 3.0, scene.camera.target[1] + 1.0, scene.camera.target[2]];
        let facing = || Renderer::facing(&gpu, &prepared, &settings).expect("a renderer");
        let mut kept = facing();
        let what = |o: &Output| (o.visibility.clone(), o.lit.clone(), o.triangles.clone(), o.counts);
        let [one, other] = [scene.camera, aside].map(|camera| {
            let fresh = facing().render(&camera, &scene.light).expect("a frame");
            (camera, what(&fresh))
        });
        assert!(one.1 != other.1 && one.1.3.lit_facets > 0);
        for (camera, fresh) in [&one, &other, &one, &one] {
            assert!(what(&kept.render(camera, &scene.light).expect("a frame")) == *fresh);
        }
    }

    /// The settings with another value of an option.
    fn with(method: MethodName, option: &str, s: &Settings) -> Option<Settings> {
        use subpixel_shadows::light_view::{OmniMaps, PartBy, SplitPlan, Warp};
        use subpixel_shadows::mask_table::MaskVariant;
        use subpixel_shadows::methods::{
            DensityRule, DiscFilter, HistorySettings, PageRule, PairVariant, PixelFilter, ProjectionVariant, SmsrShape,
            SpsmEncoding,
        };
        use subpixel_shadows::stages::compared_depths::DepthRule;
        let mut s = s.clone();
        let one = SplitPlan { splits: 1, warp: Warp::Fitted, focus: SplitPlan::FOCUS, ..SplitPlan::default() };
        let plan = s.partition.or(method.row().partition).unwrap_or(one);
        match option {
            "facets" => s.facets = FacetMode::One,
            "validity" => s.validity = false,
            "masks" => s.masks = MaskVariant::TABLE,
            "pairs" => s.pairs = PairVariant::Sorted,
            "projection" => s.projection = ProjectionVariant::TwoStep,
            "encoding" => s.spsm.encoding = SpsmEncoding::Paper,
            "search" => (s.spsm.radius, s.spsm.stretch) = (1, 0),
            "recovery" => s.spsm.recovery = false,
            "slope-power" => s.spsm.exponent = 1,
            "lookups" => (s.reconstructable.lookups, s.polygon_ids.lookups) = (7, 7),
            "rays" => s.ray_traced.silhouettes = true,
            "kernel" => s.shadow_map.kernel = 7,
            "taps" => s.shadow_map.disc = Some(DiscFilter::default()),
            "radius" => s.shadow_map.disc = s.shadow_map.disc.map(|disc| DiscFilter { radius: 3.0, ..disc }),
            "turned" => s.shadow_map.disc = s.shadow_map.disc.map(|disc| DiscFilter { turned: true, ..disc }),
            "compare" => s.shadow_map.compared = Some(DepthRule::Midpoint),
            "bias" => s.shadow_map.constant = 0.02,
            "slope-bias" => s.shadow_map.slope = 9.0,
            "sub-texels" => s.deep.sub_texels = 8,
            "nodes" => s.deep.nodes = 3,
            "error" => s.deep.error = 0.5,
            "shape" => s.smsr.shape = SmsrShape::Corners,
            "reach" => s.smsr.reach = 1,
            "partition" => s.partition = Some(SplitPlan { by: PartBy::FrustumFaces, splits: 1, ..plan }),
            "splits" => s.partition = Some(SplitPlan { by: PartBy::Depth, splits: 2, ..plan }),
            "split-weight" => s.partition = Some(SplitPlan { weight: 0.0, ..plan }),
            "warp" => s.partition = Some(SplitPlan { warp: Warp::Trapezoid, ..plan }),
            "focus" => s.partition = Some(SplitPlan { focus: 0.2, ..plan }),
            "omni" => s.omni = OmniMaps::Paraboloids,
            "bleeding" => s.moments.bleeding = 0.4,
            "grazing" => s.moments.grazing = 20.0,
            "exponent" => s.moments.exponent = 8.0,
            "filter" => s.filter = PixelFilter::Mitchell,
            "layers" => s.moments.layers = 2,
            "terms" => s.moments.terms = 3,
            "history" => s.history = Some(HistorySettings { frames: 5, ..HistorySettings::default() }),
            "confidence-power" => s.history = s.history.map(|history| HistorySettings { power: 1, ..history }),
            "pages" => s.pages.pages = Some(1),
            "finer" => s.pages.finer = 2,
            "page-rule" => s.pages.rule = PageRule::Queried,
            "changed" => s.pages.changed = 10_000,
            "density" => s.axes.density = DensityRule::Logarithmic,
            "stretch" => s.axes.stretch = 2,
            "memory-limit" | "list-start" | "looks" => return None, // of memory, and of what is written
            _ => panic!("--{option} is new: set it here"),
        }
        Some(s)
    }

    /// What a method does not take changes nothing of its picture, and what it takes changes picture or stages.
    #[gpu_test]
    fn the_table_of_options_is_true() {
        let gpu = Gpu::open(None).expect("a GPU");
        let sun = Light::Directional { direction: [0.4, 1.0, 0.3] }; // of one at a point slices have no warp
        let scene = Scene::open("spheres", &SceneOptions::default()).expect("a scene");
        let prepared = scene.prepared().expect("a sound mesh");
        let mut default = Settings::new([64, 48], 96, Samples::new(Pattern::default(), 32).expect("32 samples"));
        // Room for what pixels ask for: with less it is the budget that decides.
        default.pages.pages = Some(500);
        for method in MethodName::ALL {
            let of = |settings: &Settings, light: &Light| {
                let made = Renderer::of_method(&gpu, &prepared, method, settings, Budget::default());
                let output = made.expect("a renderer").render(&scene.camera, light).expect("a frame");
                let stages: Vec<&str> = output.stages.iter().map(|s| s.name).collect();
                let bits: Vec<u32> = output.visibility.iter().map(|v| v.to_bits()).collect();
                (bits, stages)
            };
            let (mut others, mut own) = (default.clone(), Vec::new());
            for option in METHOD_OPTIONS {
                match method.takes(option) {
                    true => own.push(option),
                    false => others = with(method, option, &others).unwrap_or(others),
                }
            }
            let plain = of(&default, &scene.light);
            assert!(of(&others, &scene.light) == plain, "{}: another's option changes something", method.name());
            for option in own {
                // Of facet-masks where they say something: with one facet a pixel, a warp of the view's own.
                let base = match option {
                    "validity" => with(method, "facets", &default),
                    "split-weight" => with(method, "splits", &default),
                    "slope-power" => with(method, "encoding", &default),
                    "confidence-power" => with(method, "history", &default),
                    "focus" | "partition" if method != MethodName::Trapezoidal => with(method, "warp", &default),
                    "radius" | "turned" => with(method, "taps", &default),
                    "changed" => with(method, "finer", &default).and_then(|s| with(method, "page-rule", &s)),
                    _ => Some(default.clone()),
                };
                let Some((base, changed)) = base.and_then(|b| Some((b.clone(), with(method, option, &b)?))) else {
                    continue;
                };
                let light =
                    if matches!(option, "focus" | "partition" | "split-weight" | "warp") { &sun } else { &scene.light };
                let same = if base == default && light == &scene.light { plain.clone() } else { of(&base, light) };
                // Where texels lie does not show in exact pictures.
                let exact = matches!(method, MethodName::FacetMasks | MethodName::Supersampled);
                if exact && matches!(option, "partition" | "splits" | "split-weight" | "warp" | "focus") {
                    assert!(of(&changed, light).0 == same.0, "--{option} changes the picture of {}", method.name());
                    continue;
                }
                // How pairs come together, and a table of masks, may give the same picture.
                let how = matches!(option, "pairs" | "projection" | "masks");
                assert!(how || of(&changed, light) != same, "--{option} changes nothing of {}", method.name());
            }
        }
    }
}
