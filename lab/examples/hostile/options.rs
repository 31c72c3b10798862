//! Extremes of every option, by the program, on the GPU where there is one and on the CPU engine.

use super::Section;
use super::process::{Ended, Program};
use std::time::Instant;
use subpixel_shadows::Result;
use subpixel_shadows::methods::METHODS;

/// Options of a small frame, which a case replaces or adds to.
const USUAL: [(&str, &str); 4] = [("--size", "24x18"), ("--map", "16"), ("--samples", "8"), ("--frames", "1")];

/// A value of an option with the statuses that it may have.
struct Case {
    scene: &'static str,
    words: Vec<String>,
    allowed: Vec<i32>,
}

/// Whether the method of a text of options takes one of them.
fn is_taken(options: &str, name: &str) -> bool {
    let mut words = options.split(' ');
    let method = words.find(|w| *w == "--method").and_then(|_| words.next()).unwrap_or("facet-masks");
    let row = METHODS.iter().find(|row| row.name == method);
    row.is_none_or(|row| name.strip_prefix("--").is_none_or(|option| row.method.takes(option)))
}

/// A run of a scene, with options as one text. What the method does not take is refused with status 2.
fn case(scene: &'static str, options: &str, allowed: &[i32]) -> Case {
    let given = |name: &str| options.split(' ').any(|w| w == name);
    let mut words: Vec<String> = Vec::new();
    for (name, value) in USUAL.iter().filter(|(name, _)| !given(name) && is_taken(options, name)) {
        words.extend([*name, *value].map(str::to_owned));
    }
    words.extend(options.split(' ').filter(|w| !w.is_empty()).map(str::to_owned));
    let all_taken = options.split(' ').all(|word| is_taken(options, word));
    Case { scene, words, allowed: if all_taken { allowed.to_vec() } else { vec![2] } }
}

/// Every numeric option at 0, 1, its greatest value and beyond, below 0, and as no number.
fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    let mut add = |options: &str, values: &[(&str, i32)]| {
        for (value, status) in values {
            all.push(case("plane", &format!("{options}{value}"), &[*status]));
        }
    };
    let no_number = [("4294967296", 2), ("-1", 2), ("1.5", 2), ("nan", 2), ("", 2)];
    add("--samples ", &[("0", 1), ("1", 0), ("2", 1), ("128", 0), ("129", 1), ("4294967295", 1)]);
    add("--samples ", &no_number);
    add("--map ", &[("0", 1), ("1", 0), ("2", 0), ("3", 0), ("8192", 0), ("8193", 1), ("4294967295", 1)]);
    add("--map ", &no_number);
    add("--size ", &[("0x1", 1), ("1x0", 1), ("1x1", 0), ("1x2", 0), ("16384x1", 0), ("1x16384", 0), ("16385x1", 1)]);
    add("--size ", &[("4294967295x4294967295", 1), ("4294967296x1", 2), ("-1x1", 2), ("nanxnan", 2), ("1x1x1", 2)]);
    add("--frames ", &[("0", 2), ("1000", 0), ("1001", 2), ("4294967296", 2), ("-1", 2)]);
    add("--memory-limit ", &[("0", 2), ("1", 0), ("18446744073709551615", 0), ("18446744073709551616", 2), ("-1", 2)]);
    add("--list-start ", &[("0", 0), ("1", 0), ("1000000", 0), ("4294967295", 1), ("18446744073709551615", 1)]);
    add("--list-start ", &[("18446744073709551616", 2), ("-1", 2)]);
    add("--method pcf --kernel ", &[("0", 1), ("1", 1), ("2", 0), ("7", 0), ("8", 1), ("4294967295", 1), ("-1", 2)]);
    add("--method smsr --reach ", &[("0", 1), ("1", 0), ("64", 0), ("65", 1), ("4294967295", 1), ("-1", 2)]);
    for method in ["parallel-split", "remix"] {
        let option = format!("--method {method} --splits ");
        add(&option, &[("0", 1), ("1", 0), ("4", 0), ("5", 1), ("4294967295", 1), ("-1", 2)]);
    }
    let shares = [("nan", 1), ("inf", 1), ("-inf", 2), ("1e39", 1), ("-1", 2), ("x", 2)];
    for option in ["--method trapezoidal --focus ", "--method remix --warp trapezoid --focus "] {
        add(option, &[("0", 1), ("1e-45", 0), ("1e-6", 0), ("0.999999", 0), ("1", 0), ("1.0000001", 1)]);
        add(option, &shares);
    }
    for option in ["--method variance --bleeding ", "--method remix --bleeding "] {
        add(option, &[("0", 0), ("1e-45", 0), ("0.9", 0), ("0.9000001", 1), ("1", 1)]);
        add(option, &shares);
    }
    add("--method remix --grazing ", &[("0", 0), ("1e-45", 0), ("90", 0), ("90.00001", 1), ("180", 1)]);
    add("--method remix --grazing ", &shares);
    add("--method exponential --exponent ", &[("1", 0), ("42", 0), ("0.9999999", 1), ("42.00001", 1)]);
    add("--method exponential-variance --exponent ", &shares);
    add("--camera fov=", &[("0", 1), ("1e-45", 0), ("1e-6", 0), ("179.9999", 0), ("180", 1), ("360", 1)]);
    add("--camera fov=", &[("nan", 1), ("inf", 1), ("-1", 1), ("1e39", 1), ("x", 1)]);
    let places = [("0,0,0", 0), ("1e-45,0,0", 0), ("0,1e6,0.1", 0), ("1e18,0,0", 0), ("1e38,1e38,1e38", 1)];
    add("--camera target=0,1,0;eye=", &places);
    add("--camera eye=", &[("nan,0,0", 1), ("inf,0,0", 1), ("1e39,0,0", 1), ("1,2", 1), ("1,2,3,4", 1), ("", 1)]);
    add("--camera eye=0,3,0;target=", &[("0,3,0", 1), ("0,-3,0", 0), ("0,3,1e-45", 0), ("1e38,1e38,1e38", 0)]);
    add("--camera up=", &[("0,0,0", 1), ("1e-45,0,0", 0), ("1e38,1e38,0", 0), ("nan,0,1", 1)]);
    for kind in ["directional", "point"] {
        let option = format!("--light {kind}=");
        add(&option, &[("1e-45,0,0", 0), ("0,1e-45,0", 0), ("1e38,1e38,1e38", 0), ("1e18,1e-18,0", 0)]);
        add(&option, &[("nan,0,0", 1), ("inf,0,0", 1), ("1e39,0,0", 1), ("1,2", 1), ("1,2,x", 1), ("", 1)]);
    }
    add("--light ", &[("directional=0,0,0", 1), ("point=0,0,0", 0), ("sun=1,1,1", 1), ("=", 1), (";;", 1)]);
    let spot = "--light spot=1,3,1;target=0,0,0;angle=";
    add(spot, &[("0", 1), ("1e-45", 0), ("1", 0), ("179.9999", 0), ("180", 1), ("360", 1), ("nan", 1), ("-1", 1)]);
    add("--light spot=1,3,1;target=", &[("1,3,1", 1), ("1,3,1.0000001", 0), ("1e38,0,0", 0), ("nan,0,0", 1)]);
    for method in METHODS.iter().map(|row| row.name) {
        for options in ["--size 1x1 --map 1 --samples 1", "--size 1x1 --map 1 --samples 128", "--size 3x257 --map 255"]
        {
            add(&format!("--method {method} {options}"), &[("", 0)]);
        }
        add(&format!("--method {method} --force-all --memory-limit 1 --list-start 0"), &[("", 0)]);
    }
    // Two million triangles: bands enough for a MiB would take minutes.
    let city = [("--memory-limit 1", 1), ("--force-all", 0), ("--force-all --memory-limit 16", 0)];
    let city = city.into_iter().chain([("--force-all --memory-limit 1", 1)]);
    all.extend(city.map(|(o, s)| case("city", &format!("--size 64x48 --map 17 --samples 32 {o}"), &[s])));
    all.push(case("plane", "--engine cpu --map 8192 --samples 32", &[0]));
    all.push(case("plane", "--engine cpu --size 1x1 --map 8192 --samples 128", &[0]));
    all.push(case("no-such-scene", "", &[1]));
    all
}

pub fn run(program: &Program, gpu: bool) -> Result<Section> {
    let (start, cases) = (Instant::now(), cases());
    let mut rows = String::new();
    let (mut failed, mut counted, mut slowest) = (0, [0usize; 4], 0.0f64);
    let mut failures = String::new();
    for (k, case) in cases.iter().enumerate() {
        let mut words = vec!["render".to_owned(), case.scene.to_owned(), "--quiet".to_owned()];
        words.extend(case.words.iter().cloned());
        // Without an adapter, what is refused by the methods of the GPU is no fault.
        let allowed: Vec<i32> = case.allowed.iter().copied().chain((!gpu).then_some(1)).collect();
        let Ended { status, seconds, line, fault } = program.run(&words, &allowed)?;
        slowest = slowest.max(seconds);
        if let Some(count) = status.and_then(|s| counted.get_mut(s as usize)) {
            *count += 1;
        }
        let shown = case.words.join(" ");
        if let Some(fault) = fault {
            failed += 1;
            failures += &format!("\nFAILED: `render {} {shown}` {fault}: {line}\n", case.scene);
            eprintln!("hostile: render {} {shown}: {fault}: {line}", case.scene);
        }
        let status = status.map_or("none".to_owned(), |s| s.to_string());
        rows += &format!("| `{} {shown}` | {status} | {seconds:.1} | {} |\n", case.scene, line.replace('|', "\\|"));
        if k % 20 == 19 {
            eprintln!("hostile: {} of {} runs, {failed} failed", k + 1, cases.len());
        }
    }
    let mut text = format!(
        "## Options\n\n{} runs of the program, each option at 0, 1, its greatest value and beyond, below 0 and as no\n\
         number; {} with status 0, {} with 1, {} with 2, {} with 3,\n\
         the slowest {slowest:.1} s. {failed} failed. {:.0} s.\n",
        cases.len(),
        counted[0],
        counted[1],
        counted[2],
        counted[3],
        start.elapsed().as_secs_f64()
    );
    text += &failures;
    text += "\n| run | status | s | line |\n|---|---|---|---|\n";
    text += &rows;
    Ok(Section { text, failures: failed })
}
