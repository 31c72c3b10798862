//! Asks a browser's own compiler (Tint in Chromium) whether it takes every kernel, with the constants that the methods give.
//!
//! `cargo run --release --example browser_kernels -- [BROWSER]`: `chromium` if none is named; the exit status is 1 if it refuses any.
//! Debian: `apt-get install --no-install-recommends chromium`. It needs no GPU in the browser (SwiftShader), and one here, of any kind.

use lab::scene::builtin;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use subpixel_shadows::gpu::{Gpu, kernels, program};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::MethodName;
use subpixel_shadows::methods::{FacetMode, PairVariant, Prepared, ProjectionVariant, Settings};
use subpixel_shadows::pass::{Casters, PassConfig};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::{Error, Result, ShadowPass};

const PAGE: &str = r#"<!doctype html><script type="module">
const say = (what) => fetch('/say', { method: 'POST', body: JSON.stringify(what) });
const all = await (await fetch('/kernels')).json();
const adapter = await navigator.gpu?.requestAdapter();
if (!adapter) { await say({ end: 'no adapter', refused: 1 }); } else {
  const wide = adapter.features.has('shader-int64');
  const device = await adapter.requestDevice();
  let made = 0, refused = 0;
  for (const k of all) {
    if (k.wide && !wide) continue;
    device.pushErrorScope('validation');
    const module = device.createShaderModule({ code: k.source });
    const told = (await module.getCompilationInfo()).messages.filter((m) => m.type === 'error');
    await device.popErrorScope();
    if (told.length) {
      refused++;
      const lines = k.source.split('\n');
      await say({ kernel: k.name, errors: told.map((m) => `${m.message}: ${lines[m.lineNum - 1]}`) });
      continue;
    }
    for (const e of k.entries) {
      made++;
      try {
        await device.createComputePipelineAsync({
          layout: 'auto', compute: { module, entryPoint: e.name, constants: e.constants } });
      } catch (error) {
        refused++;
        await say({ kernel: k.name, entry: e, errors: [error.message] });
      }
    }
  }
  await say({ end: `${made} pipelines of ${all.length} kernels by ${adapter.info.vendor} ${adapter.info.architecture}`, refused });
}
</script>"#;

fn main() {
    match run() {
        Ok(true) => {}
        Ok(false) => std::process::exit(1),
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(3);
        }
    }
}

fn run() -> Result<bool> {
    let kernels = asked(&made()?);
    let io = |e: std::io::Error| Error::file("127.0.0.1", e.to_string());
    let listener = TcpListener::bind("127.0.0.1:0").map_err(io)?;
    let address = listener.local_addr().map_err(io)?;
    let name = std::env::args().nth(1).unwrap_or_else(|| "chromium".to_owned());
    let profile = std::env::temp_dir().join(format!("browser-kernels-{}", std::process::id()));
    let mut browser = Command::new(&name)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--enable-unsafe-webgpu"])
        .args(["--use-webgpu-adapter=swiftshader", "--remote-debugging-port=0", "--no-first-run"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("http://{address}/"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|e| Error::file(&name, e.to_string()))?;
    let told = serve(&listener, &kernels, &mut browser);
    let (_, _) = (browser.kill(), browser.wait());
    let _ = std::fs::remove_dir_all(profile);
    told.map_err(io)
}

/// The pipelines that the library makes: kernel, entry point, constants.
fn made() -> Result<BTreeSet<String>> {
    log::set_logger(&MADE).map(|()| log::set_max_level(log::LevelFilter::Debug)).ok();
    let gpu = Gpu::open(None)?;
    let scene = builtin("plane").ok_or_else(|| Error::Config("no scene of that name".to_owned()))?;
    let prepared = Prepared::new(&scene.mesh)?;
    let of = |count: u32| Ok::<_, Error>(Settings::new([32, 32], 32, Samples::new(Pattern::LowDiscrepancy, count)?));
    let mut all = Vec::new();
    for count in [1, 8, 32, 64, 128] {
        for facets in [FacetMode::One, FacetMode::All] {
            all.push((MethodName::FacetMasks, Settings { facets, ..of(count)? }));
        }
    }
    for facets in [FacetMode::One, FacetMode::All] {
        let plain = Settings { facets, ..of(32)? };
        all.push((MethodName::FacetMasks, Settings { masks: MaskVariant::TABLE, ..plain.clone() }));
        all.push((MethodName::FacetMasks, Settings { projection: ProjectionVariant::TwoStep, ..plain.clone() }));
        for pairs in [PairVariant::Grouped, PairVariant::Sorted] {
            all.push((MethodName::FacetMasks, Settings { pairs, ..plain.clone() }));
        }
    }
    for method in &MethodName::ALL[1..] {
        for count in [1, 32] {
            all.push((*method, of(count)?));
        }
    }
    for (method, settings) in all {
        eprint!(".");
        Renderer::of_method(&gpu, &prepared, method, &settings, Budget::default())?;
    }
    for facets in [FacetMode::One, FacetMode::All] {
        let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
        let config = PassConfig { receivers: true, ..PassConfig::new(Settings { facets, ..of(32)? }, casters) };
        ShadowPass::new(&gpu.device, &gpu.queue, &config)?;
    }
    eprintln!();
    Ok(MADE.0.lock().map(|made| made.clone()).unwrap_or_default())
}

/// Keeps what the library says of the pipelines that it makes.
struct Pipelines(Mutex<BTreeSet<String>>);

static MADE: Pipelines = Pipelines(Mutex::new(BTreeSet::new()));

impl log::Log for Pipelines {
    fn enabled(&self, of: &log::Metadata) -> bool {
        of.target() == program::LOG
    }

    fn log(&self, record: &log::Record) {
        if let (true, Ok(mut made)) = (self.enabled(record.metadata()), self.0.lock()) {
            made.insert(record.args().to_string());
        }
    }

    fn flush(&self) {}
}

/// What the page is to compile: each kernel, each entry point with the defaults and with what is given to it.
fn asked(made: &BTreeSet<String>) -> Value {
    let made: Vec<Value> = made.iter().filter_map(|text| serde_json::from_str(text).ok()).collect();
    let of = |(stem, source, entries): &(&str, &str, &[program::Entry])| {
        let entries: Vec<Value> = entries
            .iter()
            .flat_map(|entry| {
                let given = made.iter().filter(|m| m[0] == *stem && m[1] == entry.name);
                let given = given.map(|m| json!({ "name": entry.name, "constants": m[2] }));
                std::iter::once(json!({ "name": entry.name, "constants": {} })).chain(given).collect::<Vec<_>>()
            })
            .collect();
        json!({ "name": stem, "source": source, "entries": entries, "wide": stem.ends_with("_64") })
    };
    kernels::ALL.iter().map(of).collect()
}

/// Answers the page until it says that it is at its end, or the browser is gone.
fn serve(listener: &TcpListener, kernels: &Value, browser: &mut Child) -> std::io::Result<bool> {
    listener.set_nonblocking(true)?;
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                // A browser opens connections that it does not use.
                if let Ok(Some(told)) = answer(stream, kernels) {
                    return Ok(told);
                }
            }
            Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {
                if let Some(status) = browser.try_wait()? {
                    return Err(std::io::Error::other(format!("the browser ended ({status}) before it answered")));
                }
                std::thread::sleep(std::time::Duration::from_millis(10));
            }
            Err(error) => return Err(error),
        }
    }
}

/// One request; whether all is well, once that is said.
fn answer(mut stream: TcpStream, kernels: &Value) -> std::io::Result<Option<bool>> {
    let mut reader = BufReader::new(stream.try_clone()?);
    let (mut first, mut length) = (String::new(), 0);
    reader.read_line(&mut first)?;
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line)? == 0 || line.trim().is_empty() {
            break;
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().unwrap_or(0);
        }
    }
    let mut told = vec![0; length];
    reader.read_exact(&mut told)?;
    let (kind, body) = match first.split_whitespace().nth(1) {
        Some("/") => ("text/html", PAGE.to_owned()),
        Some("/kernels") => ("application/json", kernels.to_string()),
        _ => ("text/plain", String::new()),
    };
    write!(
        stream,
        "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )?;
    let Ok(told) = serde_json::from_slice::<Value>(&told) else { return Ok(None) };
    println!("{}", told["end"].as_str().map_or_else(|| told.to_string(), str::to_owned));
    Ok(told["end"].is_string().then(|| told["refused"] == 0))
}
