//! The program on an adapter.

use super::*;
use test_support::gpu_test;

#[gpu_test]
fn all_files_are_written_and_keep_the_contract() {
    let folder = Folder::new("gpu");
    let out = folder.path("out");
    let done = render(&out, &["spheres"]);
    assert_contract(&out, "gpu", [64, 48], 32);
    assert_eq!(names(&out), ["frame.json", "shaded.png", "visibility.exr", "visibility.png"]);
    for part in ["visibility_masks", "undecided facets", "silhouette edges", "frame.json", "look further"] {
        assert!(stdout(&done).contains(part), "{part}: {}", stdout(&done));
    }
    let f = frame(&out);
    assert!(f["error"].is_null() && f["timed_frames"].as_u64().is_some_and(|n| (1..4).contains(&n)), "{f}");
    let first = exr(&out, "visibility.exr");
    let one = render(&out, &["spheres", "--frames", "1"]);
    assert_eq!((frame(&out)["timed_frames"].as_u64(), exr(&out, "visibility.exr")), (Some(1), first));
    for (done, what) in [(&done, "frames, after one that is not timed"), (&one, "of one frame, after one that is not")]
    {
        assert!(stdout(done).contains(what), "{}", stdout(done));
    }
    render(&out, &["spheres", "--truth"]);
    let f = frame(&out);
    assert!(f["error"]["facet_samples"].as_u64().is_some_and(|n| n > 0), "{}", f["error"]);
    assert!(f["error"]["scene_pixel_match"].as_f64().is_some_and(|v| v > 0.5), "{}", f["error"]);
}

/// Every method renders, explains itself, and leaves out what is not needed, under its own name.
#[gpu_test]
fn every_method_keeps_the_contract() {
    let folder = Folder::new("methods");
    let out = folder.path("out");
    let empty = folder.path("empty.obj");
    std::fs::write(&empty, "# nothing\n").expect("a file");
    let stages = [
        ("spsm", "spsm_map"),
        ("reconstructable", "kept_triangles"),
        ("polygon-ids", "polygon_ids"),
        ("shadow-map", "shadow_map"),
        ("pcf", "shadow_map"),
        ("smsr", "smsr"),
        ("silhouette-map", "silhouette_points"),
        ("variance", "map_moments"),
        ("layered-variance", "map_moments"),
        ("convolution", "map_moments"),
        ("exponential", "map_moments"),
        ("exponential-variance", "moment_shadows"),
        ("four-moments", "moment_shadows"),
        ("deep", "deep_map"),
        ("trapezoidal", "shadow_map"),
        ("lispsm", "shadow_map"),
        ("perspective", "shadow_map"),
        ("parallel-split", "pixel_views"),
        ("remix", "moment_shadows"),
        ("resolution-matched", "page_casters"),
        ("rectilinear", "warped_casters"),
        ("ray-traced", "shadow_rays"),
        ("supersampled", "sample_tests"),
    ];
    for (method, stage) in stages {
        render(&out, &["spheres", "--method", method, "--truth"]);
        assert_contract(&out, "gpu", [64, 48], 32);
        let f = frame(&out);
        assert_eq!(f["method"], method);
        let time = |f: &Value| f["stages"].as_array().and_then(|s| s.iter().find(|s| s["name"] == stage).cloned());
        assert!(time(&f).is_some_and(|s| s["left_out"].is_null() && s["gpu_ms"].as_f64() > Some(0.0)), "{f}");
        // Polygons break down where triangles are smaller than texels.
        let most = if method == "polygon-ids" { 0.25 } else { 0.2 };
        assert!(f["error"]["scene_rmse"].as_f64().is_some_and(|e| e < most), "{method}: {}", f["error"]);
        let text = stdout(&run(&["explain", "spheres", "--method", method]));
        assert!(text.contains(stage) && !text.contains("visibility_masks"), "{text}");
        render(&out, &[&empty, "--method", method]);
        assert!(time(&frame(&out)).is_some_and(|s| !s["left_out"].is_null()), "an empty scene needs no {stage}");
    }
}

/// Options of `smsr` reach its lines: corners only darken, and the farther they reach the more.
#[gpu_test]
fn smsr_takes_its_options() {
    let folder = Folder::new("smsr");
    let of = |name: &str, more: &[&str]| {
        let out = folder.path(name);
        render(&out, &[&["plane", "--method", "smsr", "--samples", "8"], more].concat());
        exr(&out, "visibility.exr").2
    };
    let darkness = |v: &[[f32; 2]]| v.iter().map(|v| f64::from(1.0 - v[0])).sum::<f64>();
    let [far, near] = ["16", "1"].map(|reach| of(reach, &["--shape", "corners", "--reach", reach]));
    let (middle, usual) = (of("middle", &["--shape", "midpoints", "--reach", "16"]), of("usual", &[]));
    assert!(middle == usual && darkness(&usual) > 20.0, "other defaults: {}", darkness(&usual));
    assert!(darkness(&far) > darkness(&near) + 1.0, "{} {}", darkness(&far), darkness(&near));
    assert!(darkness(&far) > darkness(&middle) + 1.0, "{} {}", darkness(&far), darkness(&middle));
}

/// Options of the methods of fitted and filtered maps reach them.
#[gpu_test]
fn remix_takes_its_options() {
    let folder = Folder::new("remix");
    let in_scene = |scene: &str, method: &str, more: &[&str]| {
        let out = folder.path("out");
        render(&out, &[&[scene, "--method", method, "--samples", "8"], more].concat());
        exr(&out, "visibility.exr").2
    };
    let of = |method: &str, more: &[&str]| in_scene("windmill", method, more);
    let light = |v: &[[f32; 2]]| v.iter().map(|v| f64::from(v[0])).sum::<f64>();
    let usual = of("remix", &[]);
    let given = ["--warp", "fitted", "--splits", "3", "--bleeding", "0", "--grazing", "0"];
    assert!(of("remix", &given) == usual, "other defaults");
    let trapezoid = of("remix", &["--warp", "trapezoid"]);
    // From outside a scene the fitted warp is even, as that makes texels smallest.
    let inside = |warp| in_scene("plane", "remix", &["--camera", "eye=0,2,6;target=8,0,-8", "--warp", warp]);
    assert!(inside("fitted") != inside("even"), "an even warp is no other");
    for more in
        [["--warp", "lispsm"], ["--warp", "perspective"], ["--splits", "1"], ["--splits", "4"], ["--split-weight", "1"]]
    {
        let other = of("remix", &more);
        assert!(other != usual && other != trapezoid, "{more:?} changes nothing");
    }
    assert!(of("remix", &["--warp", "trapezoid", "--focus", "0.9"]) != trapezoid, "the focus changes nothing");
    assert!(of("trapezoidal", &["--focus", "0.9"]) != of("trapezoidal", &[]), "the focus changes nothing");
    assert!(of("parallel-split", &["--splits", "1"]) != of("parallel-split", &[]), "the splits change nothing");
    // Less light against leaks; half of it on what the light grazes.
    assert!(light(&of("remix", &["--bleeding", "0.3"])) + 1.0 < light(&usual), "nothing is taken off");
    let halves = |v: &[[f32; 2]]| v.iter().filter(|v| v[0] == 0.5).count();
    let grazed = of("remix", &["--grazing", "45"]);
    assert!(halves(&grazed) > halves(&usual) + 50, "{} and {}", halves(&grazed), halves(&usual));
}

/// Pixels of each colour of classes.png, in the order of the classes.
fn class_counts(image: &image::RgbImage) -> [u64; 5] {
    let mut counts = [0; 5];
    for pixel in image.pixels() {
        let class = CLASS_COLOURS.iter().position(|c| c.2 == pixel.0).expect("a colour of the key");
        counts[class] += 1;
    }
    counts
}

/// How the classes of pixels fit what `frame.json` counts; with one facet a pixel they are the same numbers.
fn fault_of_classes(counts: [u64; 5], f: &Value, all: bool) -> Option<String> {
    let names = ["empty_facets", "dark_facets", "lit_facets", "shadowed_facets", "silhouette_pixels"];
    let listed = names.map(|n| f["counts"][n].as_u64().expect("a count"));
    let pixels = 64 * 48;
    let fits = match all {
        false => counts == listed,
        // A pixel's facets are counted one by one: at least one stands for its class.
        true => (0..5).all(|k| counts[k] <= listed[k]) && listed.iter().sum::<u64>() >= pixels,
    };
    (!fits || counts.iter().sum::<u64>() != pixels).then(|| format!("{counts:?}, {listed:?}"))
}

/// `--looks` adds pictures of what was known, in the colours of the key.
#[gpu_test]
fn looks_show_what_was_counted() {
    let folder = Folder::new("looks");
    // A roof over a floor, and a sail that shows its dark side; sky around them.
    let roofed = folder.path("roofed.obj");
    let [a, b, c, d] = [[-1.5, 1.0, -1.5], [1.5, 1.0, -1.5], [1.5, 1.0, 1.5], [-1.5, 1.0, 1.5]];
    let sail = [[2.0, 0.1, 1.0], [3.0, 0.1, 1.0], [2.5, 1.5, 1.0]];
    let floor = [[-6.0, 0.0, -4.0], [6.0, 0.0, -4.0], [0.0, 0.0, 6.0]];
    write_obj(&roofed, &[&floor[..], &[a, b, c, a, c, d], &sail].concat());
    let view = ["--camera", "eye=0,3,8;target=0,0.5,0;fov=50", "--light", "directional=-0.4,1,-1"];
    let size = ["--size", "64x48", "--map", "64"];
    for (method, facets, classes) in
        [("facet-masks", "one", true), ("facet-masks", "all", true), ("spsm", "one", true), ("pcf", "one", false)]
    {
        let out = folder.path(&format!("{method}-{facets}"));
        let own: &[&str] = if method == "facet-masks" { &["--facets", facets] } else { &[] };
        let args = [&[&roofed, "--method", method, "--looks"], own, &view[..], &size].concat();
        let text = stdout(&render(&out, &args));
        let wrote = text.lines().find(|l| l.starts_with("wrote ")).expect("what was written");
        assert_eq!(wrote.contains("classes.png"), classes, "{text}");
        assert!(wrote.contains("light-view.png"), "{text}");
        let map = image::open(Path::new(&out).join("light-view.png")).expect("light-view.png").into_rgb8();
        assert_eq!([map.width(), map.height()], [64, 64]);
        // The roof is nearest, the floor beneath it farther.
        let bright = |p: &image::Rgb<u8>| p.0.into_iter().max().unwrap_or_default();
        let [near, far] = [map.pixels().map(bright).max(), map.pixels().map(bright).min()];
        assert!(near > Some(200) && far < Some(150), "{method}: {near:?} and {far:?}");
        if !classes {
            assert!(text.contains("no classes.png: pcf"), "{text}");
            assert!(!names(&out).contains(&"classes.png".to_owned()));
            continue;
        }
        assert!(text.contains("green shadowed, red undecided"), "{text}");
        let image = image::open(Path::new(&out).join("classes.png")).expect("classes.png").into_rgb8();
        let (counts, f, all) = (class_counts(&image), frame(&out), facets == "all");
        assert_eq!(fault_of_classes(counts, &f, all), None, "{method} {facets}");
        assert!(counts[1..].iter().all(|&n| n > 0), "{method} {facets}: {counts:?}");
        // One pixel in another class, and no pixel of a class that is there in plenty.
        let [mut off, mut gone] = [counts; 2];
        (off[2], off[3]) = (off[2] + 1, off[3].saturating_sub(2));
        assert!(fault_of_classes(off, &f, all).is_some(), "{method} {facets}: {counts:?}");
        gone[4] = 0;
        assert!(fault_of_classes(gone, &f, all).is_some(), "{method} {facets}");
        // A dark pixel has no light, a lit one some, and of one facet all of it; not so one row off. Where the centre sees
        // nothing the picture says 1 whatever the samples see.
        let visible = exr(&out, "visibility.exr").2;
        let wrong = |visible: &[[f32; 2]]| {
            let pixel = |(p, [v, seen]): (&image::Rgb<u8>, &[f32; 2])| {
                *seen == 1.0
                    && match CLASS_COLOURS.iter().position(|c| c.2 == p.0) {
                        Some(0) => true,
                        Some(1) => *v != 0.0,
                        Some(2) => *v == 0.0 || (!all && *v != 1.0),
                        Some(3) => *v == 1.0 || (!all && *v != 0.0),
                        _ => false,
                    }
            };
            image.pixels().zip(visible).map(pixel).filter(|w| *w).count()
        };
        assert_eq!(wrong(&visible), 0, "{method} {facets}");
        assert!(wrong(&[&visible[64..], &visible[..64]].concat()) > 0, "{method} {facets}");
    }
    // Where something is seen, and nowhere else, the picture has the tint of one of two slices. Where there is one view no picture tells of several.
    let tinted = |out: &str| {
        let of = |name| image::open(Path::new(out).join(name)).expect(name).into_rgb8().into_raw();
        let moved = of("views.png").into_iter().zip(of("shaded.png"));
        let tints: Vec<i32> = moved.map(|(tinted, plain)| 2 * i32::from(tinted) - i32::from(plain)).collect();
        [230, 60].map(|red| tints.chunks(3).filter(|tint| (tint[0] - red).abs() < 2).count())
    };
    for (splits, several) in [("2", true), ("1", false)] {
        let out = folder.path(&format!("views-{splits}"));
        let args = [&[&roofed, "--method", "pcf", "--looks", "--splits", splits], &view[..], &size].concat();
        let text = stdout(&render(&out, &args));
        let told = text.contains("views.png: the view of the light that each pixel asks, red 1, green 2");
        assert_eq!([told, names(&out).contains(&"views.png".to_owned())], [several; 2], "{text}");
        if several {
            let [first, second] = tinted(&out);
            let seen = exr(&out, "visibility.exr").2.iter().filter(|[_, seen]| *seen == 1.0).count();
            assert!(first > 50 && second > 50 && first + second == seen, "{first}, {second} of {seen}");
        }
    }
}

#[gpu_test]
fn adapters_are_listed_and_unknown_ones_are_status_3() {
    let text = stdout(&run(&["adapters"]));
    assert!(text.contains("backend") && text.contains("path"), "{text}");
    assert_eq!(run(&["adapters", "--check"]).status.code(), Some(0));
    let folder = Folder::new("adapter");
    let out = folder.path("out");
    let done = run(&["render", "plane", "--adapter", "no such adapter", "--out", &out]);
    assert_eq!(done.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&done.stderr).contains("no such adapter"));
    assert!(!Path::new(&out).exists());
}

#[gpu_test]
fn odd_sizes_work() {
    let folder = Folder::new("gpu-odd");
    let out = folder.path("out");
    for (size, w, h) in [("1x1", 1, 1), ("3x5", 3, 5)] {
        for (map, samples, n) in [("1", "1", 1), ("17", "64", 64)] {
            let args = ["render", "spheres", "--size", size, "--map", map, "--samples", samples, "--out", &out];
            assert!(run(&args).status.success(), "{args:?}");
            assert_contract(&out, "gpu", [w, h], n);
        }
    }
}

/// The engines share only the definition of the method; samples on an edge may fall to either side.
#[gpu_test]
fn both_engines_give_one_picture() {
    let folder = Folder::new("engines");
    let (ours, theirs) = (folder.path("gpu"), folder.path("cpu"));
    for scene in ["plane", "spheres"] {
        render(&ours, &[scene, "--engine", "gpu"]);
        render(&theirs, &[scene, "--engine", "cpu"]);
        let (a, b) = (exr(&ours, "visibility.exr").2, exr(&theirs, "visibility.exr").2);
        let far = a.iter().zip(&b).filter(|(a, b)| (a[0] - b[0]).abs() > 2.5 / 32.0 || a[1] != b[1]).count();
        assert!(far * 200 <= a.len(), "{scene}: {far} of {} pixels differ by more than 2 samples", a.len());
    }
}

/// Leaving out by the plan changes nothing, rule by rule.
#[gpu_test]
fn the_plan_changes_no_bit() {
    let folder = Folder::new("plan");
    let (planned, forced) = (folder.path("planned"), folder.path("forced"));
    let file = |name: &str, corners: &[[f32; 3]]| {
        write_obj(&folder.path(name), corners);
        folder.path(name)
    };
    let (a, b, c, d) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.3, 1.0, 0.3]);
    let flat = file("flat.obj", &[a, b, c, [2.0, 0.0, 0.0], [3.0, 0.0, 0.5], [2.0, 0.0, 1.0]]);
    let sheets = file("sheets.obj", &[a, c, b, [0.0, 0.5, 0.0], [0.0, 0.5, 1.0], [1.0, 0.5, 0.0]]);
    let body = file("body.obj", &[a, b, c, a, d, b, b, d, c, c, d, a]);
    const INSIDE: &[&str] =
        &["--light", "point=0.3,0.2,0.3", "--camera", "eye=0.2,0.15,0.25;target=0.4,0.2,0.4;fov=120"];
    let cases: &[(&[&str], &str)] = &[
        (&["spheres"], ""),
        (&["spheres", "--validity", "off"], "closed mesh, light outside"),
        (&["plane", "--samples", "1"], "one sample"),
        (&[&flat], "one plane"),
        (&[&flat, "--facets", "one", "--light", "directional=0,-1,0"], "one plane"),
        (&[&sheets, "--facets", "one", "--light", "directional=0,-1,0"], "all that is seen is dark"),
        (&[&sheets, "--light", "directional=0,-1,0"], "every sample lies in the facet"),
        (&[&sheets, "--camera", "eye=0,5,30;target=0,5,60"], "behind the camera"),
        (&[&sheets, "--camera", "eye=0,0,30;target=40,0,30"], "the view"),
        (&[&body, "--samples", "1"], "one sample"),
        (&[&[&body, "--facets", "one"], INSIDE].concat(), "closed mesh around the light"),
        (&[&[&body, "--facets", "one", "--validity", "off"], INSIDE].concat(), ""),
        (&["knot", "--method", "spsm", "--samples", "1", "--size", "64x48", "--map", "300"], "never asked for"),
        (&["knot", "--method", "spsm", "--samples", "1"], "nearly all are asked for"),
        (&["knot", "--method", "spsm"], "nearly every texel is asked for"),
    ];
    for (args, reason) in cases {
        let text = stdout(&render(&planned, args));
        assert!(text.contains(reason), "{args:?}: {text}");
        let mut all = args.to_vec();
        all.push("--force-all");
        render(&forced, &all);
        let bits = |out: &str| exr(out, "visibility.exr").2.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
        let wrong = bits(&planned).iter().zip(&bits(&forced)).filter(|(a, b)| a != b).count();
        assert_eq!(wrong, 0, "{args:?}: {wrong} pixels differ");
    }
}

/// Options that choose how something is computed change no bit, those that choose what change some.
#[test]
fn options_choose_what_or_how() {
    let folder = Folder::new("options");
    let out = folder.path("out");
    let picture = |args: &[&str]| {
        render(&out, &[&["spheres", "--size", "64x48", "--map", "96"], args].concat());
        exr(&out, "visibility.exr").2.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>()
    };
    // The first values of each are alike, so many; the others are all different.
    let options: &[(&str, &str, &[&str], usize)] = &[
        ("facet-masks", "--pairs", &["tiled", "grouped", "sorted"], 3),
        ("facet-masks", "--masks", &["exact", "table"], 1),
        ("facet-masks", "--pattern", &["low-discrepancy", "rotated", "grid"], 1),
        ("ray-traced", "--rays", &["all", "silhouettes"], 2),
        ("spsm", "--encoding", &["lines", "paper"], 1),
        ("spsm", "--search", &["along", "wide", "near"], 1),
        ("spsm", "--recovery", &["on", "off"], 1),
    ];
    for (method, option, values, alike) in options {
        let default = picture(&["--method", method]);
        let pictures: Vec<_> = values.iter().map(|value| picture(&["--method", method, option, value])).collect();
        assert!(pictures[..*alike].iter().all(|p| *p == default), "{option}: how it is computed changes the picture");
        for (k, p) in pictures.iter().enumerate().skip(*alike) {
            assert!(pictures[..k].iter().all(|other| other != p), "{option} {} changes nothing", values[k]);
        }
    }
    let two_step = picture(&["--projection", "two-step", "--facets", "one"]);
    let pencil = picture(&["--projection", "pencil", "--facets", "one"]);
    let off = two_step.iter().zip(&pencil).filter(|(a, b)| a != b).count();
    assert!((1..10).contains(&off), "the paper's projections are off in {off} pixels");
    assert!(picture(&["--ground"]) != picture(&[]), "no ground");
}

/// One view cannot hold what is all around a light: methods take a cube of them.
#[gpu_test]
fn a_light_among_its_casters_has_a_cube_of_views() {
    let folder = Folder::new("among");
    let rendered = folder.path("rendered");
    let scene = ["spheres", "--light", "point=0.3,1.6,0.2", "--size", "64x48"];
    render(&rendered, &[&scene[..], &["--truth"]].concat());
    let error = &frame(&rendered)["error"];
    assert_eq!(error["facet_wrong_outside_band"].as_u64(), Some(0), "{error}");
    for method in ["facet-masks", "remix"] {
        let done = run(&[&["render"], &scene[..], &["--method", method, "--out", &rendered]].concat());
        let note = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(0), "{note}");
        assert!(note.contains("6 views of the light"), "{method}: {note}");
    }
}

/// Lists that overflow, and a frame split for want of memory, give the same picture.
#[gpu_test]
fn overflow_is_harmless() {
    let folder = Folder::new("overflow");
    let (ample, tight) = (folder.path("ample"), folder.path("tight"));
    let size = ["--size", "300x200", "--map", "128", "--samples", "8"];
    render(&ample, &[&["plane"], &size[..]].concat());
    let limits: [&[&str]; 2] = [&["--list-start", "1"], &["--list-start", "1", "--memory-limit", "1"]];
    let most = run(&["render", "plane", "--list-start", "18446744073709551615", "--out", &folder.path("most")]);
    let said = String::from_utf8_lossy(&most.stderr).into_owned();
    assert!(most.status.code() == Some(1) && said.contains("subpixel-shadows: memory: "), "{said}");
    for limit in limits {
        render(&tight, &[&["plane"], &size[..], limit].concat());
        let lists = frame(&tight)["lists"].clone();
        assert!(lists[0]["runs"].as_u64().is_some_and(|r| r > 1), "{lists}");
        assert_eq!(exr(&ample, "visibility.exr").2, exr(&tight, "visibility.exr").2, "{limit:?}");
    }
}

/// A light with a radius makes soft shadows, those of rays to the same points; what shows one point is refused, and what cannot be.
#[gpu_test]
fn a_light_with_a_radius_is_soft() {
    let folder = Folder::new("soft");
    let [soft, hard] = ["soft", "hard"].map(|name| folder.path(name));
    let args = ["spheres", "--samples", "8", "--truth", "--quiet", "--frames", "1"];
    for method in ["facet-masks", "ray-traced"] {
        let asked = ["--method", method, "--light-radius", "4", "--light-points", "6"];
        let done = render(&soft, &[&args[..], &asked].concat());
        let text = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(text.contains("the mean of 6 points within a radius of 4"), "{text}");
        let f = frame(&soft);
        assert!(
            f["error"]["scene_rmse"].as_f64() < Some(1e-4) && f["error"]["facet_samples"].is_null(),
            "{}",
            f["error"]
        );
        render(&hard, &[&args[..], &["--method", method]].concat());
        let [soft, hard] =
            [&soft, &hard].map(|out| exr(out, "visibility.exr").2.iter().map(|v| v[0]).collect::<Vec<f32>>());
        let partly = |values: &[f32]| values.iter().filter(|v| **v > 0.0 && **v < 1.0).count();
        assert!(partly(&soft) > partly(&hard) + 100, "{method}: {} and {}", partly(&soft), partly(&hard));
        let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
        assert!((mean(&soft) - mean(&hard)).abs() < 0.02, "{method}: {} and {}", mean(&soft), mean(&hard));
    }
    let other = folder.path("other");
    for (asked, word) in [
        (&["--light-radius", "4", "--looks"][..], "--looks shows one point"),
        (&["--light-radius", "50"], "less than 45"),
        (&["--light-radius", "1", "--light-points", "0"], "0 points"),
    ] {
        let refused = run(&[&["render", "plane", "--out", &other], asked].concat());
        let line = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(1), "{line}");
        assert!(line.contains(word) && !Path::new(&other).exists(), "{line}");
    }
}
