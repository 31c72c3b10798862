//! Tests of the tests: one token of one kernel changed at a time, and whether the tests of that stage notice.
//!
//! `cargo run --release --features mutations --example mutations -- [--per-kernel N] [--seed S] [--suites NAME,NAME] [--page FILE] [KERNEL...]`
//!
//! A change is a comparison, an operator, a constant, a component or a function taken for its neighbour, in the body of a function of the
//! kernel's own files; only those count that are still WGSL. Nothing is compiled again: the tests take the change from the environment.
//! Changes that a stage's tests let through meet the suites of `--suites` (`surfaces`, `found`, `cpu`, …), in that order.
//! A survivor may be a change that changes nothing (a bound that is never met with equality, a margin that is wide enough), or a gap
//! in the tests. The exit status is 1 if the unchanged tests of a kernel fail.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use subpixel_shadows::gpu::kernels;
use subpixel_shadows::gpu::mutation::VARIABLE;
use subpixel_shadows::{Error, Result};

fn main() {
    if let Err(error) = run() {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

/// Options of the command line.
struct Asked {
    per_kernel: usize,
    seed: u64,
    page: Option<PathBuf>,
    suites: Vec<String>,
    kernels: Vec<String>,
}

/// A program of tests, those of it that are run, and how long they may take.
struct Suite {
    name: String,
    program: PathBuf,
    filter: Option<String>,
    limit: Duration,
}

fn asked() -> Result<Asked> {
    let mut asked = Asked { per_kernel: 20, seed: 1, page: None, suites: Vec::new(), kernels: Vec::new() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| Error::Config(format!("{word} needs a value")));
        let number = |text: String| text.parse().map_err(|_| Error::Config(format!("'{text}' is no number")));
        match word.as_str() {
            "--per-kernel" => asked.per_kernel = number(value()?)? as usize,
            "--seed" => asked.seed = number(value()?)?,
            "--page" => asked.page = Some(value()?.into()),
            "--suites" => asked.suites = value()?.split(',').map(str::to_owned).collect(),
            name if kernels::ALL.iter().any(|(stem, ..)| *stem == name) => asked.kernels.push(word),
            name => return Err(Error::Config(format!("no kernel '{name}'"))),
        }
    }
    if asked.kernels.is_empty() {
        // Those for 64-bit atomics run where a device has them alone.
        let all = kernels::ALL.iter().map(|(stem, ..)| (*stem).to_owned());
        asked.kernels = all.filter(|stem| !stem.ends_with("_64")).collect();
    }
    Ok(asked)
}

fn run() -> Result<()> {
    let asked = asked()?;
    let stages = test_program("stages")?;
    let suites = asked.suites.iter().map(|name| Suite::new(name, test_program(name)?, None));
    let suites = suites.collect::<Result<Vec<_>>>()?;
    let mut page = format!(
        "# Mutations\n\n`cargo run --release --features mutations --example mutations -- --per-kernel {} --seed {}{}{}`\n\n\
         One token of a kernel changed at a time, in its own files; caught: tests fail, or do not end.{}\n\n\
         | kernel | changes | caught by its stage | by others | survivors |\n|---|---|---|---|---|\n",
        asked.per_kernel,
        asked.seed,
        if suites.is_empty() { String::new() } else { format!(" --suites {}", asked.suites.join(",")) },
        if asked.kernels.len() < 30 { format!(" {}", asked.kernels.join(" ")) } else { String::new() },
        if suites.is_empty() { "" } else { " By others: by one of the suites, what the stage let through." },
    );
    let (mut sum, mut listed) = ([0; 4], String::new());
    for stem in &asked.kernels {
        let Some((_, source, _)) = kernels::ALL.iter().find(|(name, ..)| name == stem) else { continue };
        let source = &source.text();
        let start = Instant::now();
        let stage = Suite::new(stem, stages.clone(), Some(format!("{stem}::")))?;
        let changes = chosen(stem, source, asked.per_kernel, asked.seed)?;
        if changes.is_empty() {
            return Err(Error::Config(format!("{stem}: no change was found in its text")));
        }
        let mut counts = [changes.len(), 0, 0, 0];
        for (k, change) in changes.iter().enumerate() {
            let shown = change.shown(source);
            eprintln!("{stem}: {} of {}: {shown}", k + 1, changes.len());
            let variable = format!("{stem}:{}:{}:{}", change.first, change.length, change.text);
            if stage.catches(&variable)? {
                counts[1] += 1;
                continue;
            }
            let mut catcher = None;
            for suite in &suites {
                if catcher.is_none() && suite.catches(&variable)? {
                    catcher = Some(&suite.name);
                }
            }
            counts[if catcher.is_some() { 2 } else { 3 }] += 1;
            let by = catcher.map_or("nobody".to_owned(), |name| format!("`{name}`"));
            println!("  caught by {by}: {shown}");
            let _ = writeln!(listed, "- {stem}, by {by}: `{shown}`");
        }
        let [of, own, others, none] = counts;
        let _ = writeln!(page, "| {stem} | {of} | {own} | {others} | {none} |");
        println!("{stem}: {own} and {others} of {of} caught, {:.0} s", start.elapsed().as_secs_f64());
        sum = std::array::from_fn(|k| sum[k] + counts[k]);
    }
    let [of, own, others, none] = sum;
    let share = |n: usize| 100.0 * n as f64 / of.max(1) as f64;
    let _ = writeln!(
        page,
        "| all | {of} | {own} ({:.1} %) | {others} | {none} ({:.1} %) |\n\nNot caught by the stage:\n\n{listed}",
        share(own),
        share(none)
    );
    println!("{own} and {others} of {of} caught ({:.1} %)", share(own + others));
    if let Some(file) = &asked.page {
        std::fs::write(file, page).map_err(|e| Error::File { path: file.clone(), message: e.to_string() })?;
    }
    Ok(())
}

/// Builds a suite of tests and returns its program.
fn test_program(name: &str) -> Result<PathBuf> {
    let failed = |e: &dyn std::fmt::Display| Error::Config(format!("building the tests {name}: {e}"));
    let words = ["test", "--release", "--features", "subpixel-shadows/mutations", "--test", name, "--no-run"];
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let built = Command::new(cargo)
        .args(words)
        .arg("--message-format=json")
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| failed(&e))?;
    let text = String::from_utf8_lossy(&built.stdout);
    let messages = text.lines().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok());
    let programs = messages.filter(|m| m["target"]["name"] == name && m["target"]["kind"][0] == "test");
    let found = programs.filter_map(|m| m["executable"].as_str().map(PathBuf::from)).next_back();
    found.ok_or_else(|| failed(&"cargo names no program"))
}

impl Suite {
    /// A suite whose unchanged tests pass.
    fn new(name: &str, program: PathBuf, filter: Option<String>) -> Result<Self> {
        let suite = Self { name: name.to_owned(), program, filter, limit: Duration::from_secs(900) };
        let start = Instant::now();
        if !suite.passes(None)? {
            return Err(Error::Config(format!("{name}: the tests fail without a change")));
        }
        Ok(Self { limit: start.elapsed() * 3 + Duration::from_secs(20), ..suite })
    }

    fn catches(&self, change: &str) -> Result<bool> {
        Ok(!self.passes(Some(change))?)
    }

    /// Whether the tests pass within their time.
    fn passes(&self, change: Option<&str>) -> Result<bool> {
        let failed = |e: std::io::Error| Error::Config(format!("running the tests {}: {e}", self.name));
        let mut command = Command::new(&self.program);
        command.args(&self.filter).arg("--quiet").stdout(Stdio::null()).stderr(Stdio::null());
        command.current_dir(env!("CARGO_MANIFEST_DIR")).env_remove(VARIABLE);
        if let Some(change) = change {
            command.env(VARIABLE, change);
        }
        let mut child = command.spawn().map_err(failed)?;
        let start = Instant::now();
        loop {
            if let Some(status) = child.try_wait().map_err(failed)? {
                return Ok(status.success());
            }
            if start.elapsed() > self.limit {
                child.kill().map_err(failed)?;
                child.wait().map_err(failed)?;
                return Ok(false);
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// A change of a kernel's text.
struct Change {
    first: usize,
    length: usize,
    text: String,
}

impl Change {
    /// The line, and what becomes of it.
    fn shown(&self, source: &str) -> String {
        let start = source[..self.first].rfind('\n').map_or(0, |at| at + 1);
        let end = source[self.first..].find('\n').map_or(source.len(), |at| self.first + at);
        let line = source[start..end].trim();
        format!("{} → {} in {line}", &source[self.first..self.first + self.length], self.text)
    }
}

/// So many changes of a kernel that are WGSL, drawn from the seed.
fn chosen(stem: &str, source: &str, count: usize, seed: u64) -> Result<Vec<Change>> {
    let mut all = changes(&own_text(stem)?, source);
    let mut state =
        seed ^ stem.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    let mut found = Vec::new();
    while found.len() < count && !all.is_empty() {
        let change = all.swap_remove(random() % all.len());
        let text = [&source[..change.first], &change.text, &source[change.first + change.length..]].concat();
        let valid = naga::front::wgsl::parse_str(&text).is_ok_and(|module| {
            Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).is_ok()
        });
        if valid {
            found.push(change);
        }
    }
    Ok(found)
}

/// The texts of a kernel's own files: its own, and what lies in its folder.
fn own_text(stem: &str) -> Result<Vec<String>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
    let read = |file: PathBuf| {
        std::fs::read_to_string(&file).map_err(|e| Error::File { path: file.clone(), message: e.to_string() })
    };
    let mut texts = vec![read(folder.join(format!("{stem}.wgsl")))?];
    if let Ok(entries) = std::fs::read_dir(folder.join(stem)) {
        for entry in entries.flatten() {
            texts.push(read(entry.path())?);
        }
    }
    Ok(texts)
}

/// Tokens and what may be taken for them. Longer ones come first, so that none is a part of another.
const NEIGHBOURS: &[(&str, &[&str])] = &[
    (" <= ", &[" < "]),
    (" >= ", &[" > "]),
    (" == ", &[" != "]),
    (" != ", &[" == "]),
    (" << ", &[" >> "]),
    (" >> ", &[" << "]),
    (" && ", &[" || "]),
    (" || ", &[" && "]),
    (" += ", &[" -= "]),
    (" < ", &[" <= ", " > "]),
    (" > ", &[" >= ", " < "]),
    (" + ", &[" - "]),
    (" - ", &[" + "]),
    (" * ", &[" + "]),
    (" & ", &[" | "]),
    (" | ", &[" & "]),
    ("min(", &["max("]),
    ("max(", &["min("]),
    (".x", &[".y"]),
    (".y", &[".x"]),
    (".z", &[".x"]),
    ("!", &[""]),
    ("~", &[""]),
];

/// All changes of the bodies of functions in `texts` that lie in the joined `source`.
fn changes(texts: &[String], source: &str) -> Vec<Change> {
    let mut found = Vec::new();
    for text in texts {
        let Some(base) = source.find(text.as_str()) else { continue };
        let (mut depth, mut at, mut signature) = (0usize, 0, false);
        for line in text.split_inclusive('\n') {
            let code = line.split("//").next().unwrap_or_default();
            // Bodies of functions and not of structs; signatures stay, which may take several lines.
            signature |= depth == 0 && code.starts_with("fn ");
            let inside = depth > 0 || signature && code.contains('{');
            let body = if depth > 0 { 0 } else { code.find('{').unwrap_or(code.len()) };
            if inside && !code.trim_start().starts_with('@') {
                of_line(&code[body..], base + at + body, &mut found);
            }
            if inside {
                depth = (depth + code.matches('{').count()).saturating_sub(code.matches('}').count());
                signature = false;
            }
            at += line.len();
        }
    }
    found
}

/// The changes of one line of code, which begins at a byte of the joined text.
fn of_line(code: &str, start: usize, found: &mut Vec<Change>) {
    let mut at = 0;
    while at < code.len() {
        let rest = &code[at..];
        if let Some((token, others)) = NEIGHBOURS.iter().find(|(token, _)| rest.starts_with(token)) {
            let alone = !token.starts_with('.') || !rest[2..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
            if alone && !rest.starts_with("!=") {
                let change = |text: &&str| Change { first: start + at, length: token.len(), text: (*text).to_owned() };
                found.extend(others.iter().map(change));
            }
            at += token.trim_end().len().max(1);
            continue;
        }
        // A number that is no part of a name: one more, or twice as much.
        let before = code[..at].chars().next_back().unwrap_or(' ');
        if rest.starts_with(|c: char| c.is_ascii_digit()) && !before.is_alphanumeric() && !"_.".contains(before) {
            let length = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '.').unwrap_or(rest.len());
            let word = &rest[..length];
            let whole = word.trim_end_matches('u');
            let text = match (whole.parse::<u32>(), word.parse::<f64>()) {
                (Ok(n), _) => Some(word.replacen(whole, &n.wrapping_add(1).to_string(), 1)),
                (_, Ok(v)) => Some(format!("{:?}", if v == 0.0 { 1.0 } else { 2.0 * v })),
                _ => None,
            };
            found.extend(text.map(|text| Change { first: start + at, length, text }));
            at += length;
            continue;
        }
        at += rest.chars().next().map_or(1, char::len_utf8);
    }
}
