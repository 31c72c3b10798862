//! The page in a real browser: `./web.sh --test` makes it and runs these tests in Chromium without a screen, one after the other.

mod chromium;
mod life;
mod report;
mod site;

use chromium::Chromium;
use lab::scene::names;
use occupancy::Pipeline;
use serde_json::{Value, json};
use std::process::Command;
use std::sync::LazyLock;
use subpixel_shadows::gpu::{Gpu, Profile, kernels};
use subpixel_shadows::methods::{MethodName, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use test_support::Folder;
use viewer::View;
use viewer::overlay::Overlay;
use viewer::view::Against;

/// The window, points and pixels.
const SIZE: [u32; 2] = [640, 320];

/// The page, made once.
static SITE: LazyLock<(Folder, String)> = LazyLock::new(|| {
    let folder = Folder::new("browser-site");
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let made = Command::new("sh").args(["web.sh", &folder.path("web")]).current_dir(root).output().expect("sh");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let address = site::serve(folder.path("web").as_ref());
    (folder, address)
});

fn address(line: &str) -> String {
    let hash: String = line.bytes().map(|b| if b == b' ' { "+".to_owned() } else { format!("%{b:02X}") }).collect();
    format!("{}/#{hash}", SITE.1)
}

/// Whether the page tells why there is nothing to see.
const REFUSED: &str = "!document.getElementById('picture').hidden";

/// The viewer in a tab.
struct Page(Chromium);

impl Page {
    fn open(name: &str, line: &str) -> Self {
        let mut page = Self(Chromium::start(name, SIZE));
        // On a busy machine the browser's GPU process may come too late for the first load.
        for _ in 0..3 {
            page.0.open(&address(line));
            let started = "document.documentElement.dataset.started == 'true'";
            page.0.until("the viewer has started, or says why not", &format!("{started} || {REFUSED}"));
            if page.0.value(started) == json!(true) {
                page.settle();
                return page;
            }
            println!("{name}: {}", page.0.value("document.getElementById('said').textContent"));
        }
        panic!("{name}: the viewer does not start");
    }

    fn settle(&mut self) {
        // A move is followed by the whole resolution after a rest.
        std::thread::sleep(std::time::Duration::from_millis(400));
        self.0.until("the picture is complete", "viewer.settled()");
    }

    fn complaint(&mut self) -> Option<String> {
        self.0.value("viewer.complaint() ?? null").as_str().map(ToOwned::to_owned)
    }

    fn line(&mut self) -> String {
        self.0.value("viewer.line()").as_str().expect("a line").to_owned()
    }

    /// Takes another view and waits for its picture.
    fn take(&mut self, line: &str) {
        self.0.value(&format!("viewer.open({})", json!(line)));
        self.settle();
        assert_eq!(self.complaint(), None, "{line}");
    }

    /// Size of the picture, and visibility of a half.
    fn visibility(&mut self, half: usize) -> ([u32; 2], Vec<f32>) {
        let numbers = self.0.value(&format!("viewer.visibility({half}).then(all => Array.from(all))"));
        let mut numbers = numbers.as_array().expect("numbers").iter().map(|v| v.as_f64().expect("a number") as f32);
        let size = [0; 2].map(|_: u32| numbers.next().expect("a size") as u32);
        (size, numbers.collect())
    }

    /// A place in a widget, shares of it.
    fn place(&mut self, name: &str, share: [f64; 2]) -> [f64; 2] {
        let rect = self.0.value(&format!("Array.from(viewer.place({}) ?? [])", json!(name)));
        let rect: Vec<f64> = rect.as_array().expect("a place").iter().filter_map(Value::as_f64).collect();
        assert_eq!(rect.len(), 4, "no {name}");
        [0, 1].map(|k| rect[k] + rect[k + 2] * share[k])
    }

    /// The canvas.
    fn shot(&mut self) -> image::RgbaImage {
        self.fetched(
            "await new Promise(taken => requestAnimationFrame(() => requestAnimationFrame(() =>
                taken(document.getElementById('canvas').toDataURL()))))",
        )
    }

    /// The picture at the address that an expression gives.
    fn fetched(&mut self, address: &str) -> image::RgbaImage {
        let read = format!("(async () => Array.from(new Uint8Array(await (await fetch({address})).arrayBuffer())))()");
        let bytes = self.0.value(&read);
        let bytes = bytes.as_array().expect("bytes").iter().map(|b| b.as_u64().expect("a byte") as u8);
        image::load_from_memory(&bytes.collect::<Vec<_>>()).expect("a PNG file").into_rgba8()
    }

    /// Presses a key and lets it go.
    fn press(&mut self, key: &str, code: u32) {
        for kind in ["keyDown", "keyUp"] {
            let event =
                json!({ "type": kind, "key": key, "code": format!("Digit{key}"), "windowsVirtualKeyCode": code });
            self.0.call("Input.dispatchKeyEvent", event);
            self.0.value("new Promise(seen => requestAnimationFrame(() => requestAnimationFrame(() => seen(true))))");
        }
        self.settle();
    }

    fn drag(&mut self, name: &str, from: [f64; 2], to: [f64; 2]) {
        let (from, to) = (self.place(name, from), self.place(name, to));
        self.0.drag(from, to);
        self.settle();
    }

    fn pick(&mut self, list: &str, word: &str) {
        let at = self.place(list, [0.3, 0.5]);
        self.0.click(at);
        let at = self.place(&format!("{list}.{word}"), [0.3, 0.5]);
        self.0.click(at);
        self.settle();
    }

    /// Drops a file of this content.
    fn drop_file(&mut self, name: &str, content: &str) {
        self.drop_files(&[(name, content)]);
    }

    /// Drops files of these names and contents together.
    fn drop_files(&mut self, files: &[(&str, &str)]) {
        self.0.value(&format!(
            "{{ const data = new DataTransfer();
                for (const [name, content] of {})
                    data.items.add(new File([content], name));
                const canvas = document.getElementById('canvas');
                for (const kind of ['dragover', 'drop'])
                    canvas.dispatchEvent(new DragEvent(kind, {{ dataTransfer: data, bubbles: true, cancelable: true }}));
            }}",
            json!(files)
        ));
        std::thread::sleep(std::time::Duration::from_millis(500));
        self.settle();
    }
}

/// Visibility by the library on this machine's adapter, of both halves of a view.
fn natively(gpu: &Gpu, line: &str, size: [u32; 2]) -> [Vec<f32>; 2] {
    let view = View::of_line(line).expect(line);
    let Against::Method(right) = &view.right else { panic!("{line}: truth") };
    let (scene, _) = view.left.open(view.scene.as_deref()).expect(line);
    let prepared = scene.prepared().expect(line);
    [&view.left, right].map(|options| {
        let settings = Settings { size, ..options.settings().expect(line) };
        let renderer = Renderer::of_method(gpu, &prepared, options.method, &settings, Budget::default());
        let mut renderer = renderer.expect(line);
        renderer.render(&scene.camera, &scene.light).expect(line).visibility
    })
}

fn differing(a: &[f32], b: &[f32]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| (*a - *b).abs() > 1e-6).count()
}

/// The browser's compiler takes every kernel as the library hands it over, and every pipeline that a method makes of it.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn every_kernel_is_accepted() {
    let mut browser = Chromium::start("kernels", SIZE);
    browser.open(&address("plane"));
    browser.value(
        "globalThis.take = async (stem, code, entries) => {
            globalThis.device ??= await (await navigator.gpu.requestAdapter()).requestDevice();
            const module = device.createShaderModule({ code });
            const info = await module.getCompilationInfo();
            const errors = info.messages.filter(m => m.type == 'error').map(m => `${stem}:${m.lineNum}: ${m.message}`);
            for (const [entryPoint, constants] of errors.length ? [] : entries) {
                const compute = { module, entryPoint, constants };
                const made = device.createComputePipelineAsync({ layout: 'auto', compute });
                await made.catch(e => errors.push(`${stem}.${entryPoint}: ${e.message}`));
            }
            return errors;
        }; true",
    );
    let mut take = |stem: &str, text: &str, entries: Value| -> Vec<String> {
        let told = browser.value(&format!("take({}, {}, {entries})", json!(stem), json!(text)));
        told.as_array().expect("a list").iter().map(|e| e.as_str().unwrap_or_default().to_owned()).collect()
    };
    let pipelines = occupancy::made::pipelines().expect("an adapter");
    let mut made = 0;
    for (stem, text, _) in kernels::ALL {
        let text = &text.text();
        // Needs what WebGPU does not have; the library takes another kernel there.
        if *stem == "spsm_map_64" {
            assert_eq!(take(stem, text, json!([])).len(), 1, "{stem}");
            continue;
        }
        let all: Vec<_> = pipelines.iter().filter(|p| p.0 == *stem).collect();
        let of_entry = |p: &Pipeline| all.iter().filter(|other| other.1 == p.1).position(|other| other.2 == p.2);
        // Each takes the browser a second. Of those of one entry point, which differ by constants alone, the first, and some of the others.
        let some = all.iter().filter(|p| of_entry(p).is_some_and(|k| k % 7 == 0));
        let entries: Vec<_> = some.map(|p| json!([p.1, p.2])).collect();
        made += entries.len();
        assert_eq!(take(stem, &Profile::Gpu.text(text), json!(entries)), Vec::<String>::new());
        assert_eq!(take(stem, &Profile::Software.text(text), json!([])), Vec::<String>::new());
    }
    println!("{made} pipelines");
    assert!(made > 100, "{made} pipelines");
    // A wrong type and an entry point that is not there are told of.
    let (stem, text, _) = kernels::ALL[0];
    let text = &text.text();
    assert!(!take(stem, &text.replacen("u32", "f32", 3), json!([])).is_empty());
    assert_eq!(take(stem, text, json!([["nothing", {}]])).len(), 1);
}

/// A plain server, which compresses what it sends, sends little.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn the_page_is_small() {
    let sent = |names: &[&str], level: &str| -> usize {
        let paths = names.iter().map(|name| SITE.0.path(&format!("web/{name}")));
        let done = Command::new("gzip").args([level, "-c"]).args(paths).output().expect("gzip");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        done.stdout.len()
    };
    LazyLock::force(&SITE);
    let code = ["viewer_bg.wasm", "viewer.js", "worker.js", "index.html"];
    let bytes = sent(&code, "-9");
    println!("{bytes} bytes");
    assert!((500_000..=2_000_000).contains(&bytes), "{bytes} bytes");
    assert!(sent(&[&code[..], &["viewer.png"]].concat(), "-9") > bytes + 100_000);
}

/// All built-in scenes look as they do natively: exact methods to the last sample.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn scenes_are_the_native_ones() {
    let gpu = Gpu::open(None).expect("an adapter");
    let line = |scene: &str| format!("{scene} --samples 8 --map 256 --against '--method pcf --samples 8 --map 256'");
    let mut page = Page::open("scenes", &line("windmill"));
    let mut before = Vec::new();
    for scene in names() {
        page.take(&line(scene));
        let (size, left) = page.visibility(0);
        let (_, right) = page.visibility(1);
        let native = natively(&gpu, &page.line(), size);
        let [of_left, of_right] = [differing(&left, &native[0]), differing(&right, &native[1])];
        println!("{scene}: {} x {}, {of_left} and {of_right} pixels differ", size[0], size[1]);
        assert_eq!(of_left, 0, "{scene}");
        assert!(of_right <= left.len() / 100, "{scene}: {of_right}");
        let dark = left.iter().filter(|v| **v == 0.0).count();
        let lit = left.iter().filter(|v| **v == 1.0).count();
        assert!(dark > 100 && lit > 1000, "{scene}: {lit} lit, {dark} dark");
        assert!(before.is_empty() || differing(&before, &left) > 1000, "{scene} is another one");
        before = left;
    }
}

/// Every method draws in the browser what it draws natively.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn methods_are_the_native_ones() {
    let gpu = Gpu::open(None).expect("an adapter");
    let of = |method: MethodName| {
        format!("spheres --method {} --samples 8 --map 128 --against '--samples 8 --map 128'", method.name())
    };
    let mut page = Page::open("methods", &of(MethodName::ShadowMap));
    for method in MethodName::ALL {
        page.take(&of(method));
        let (size, left) = page.visibility(0);
        let native = natively(&gpu, &page.line(), size);
        let count = differing(&left, &native[0]);
        println!("{}: {count} of {} pixels differ", method.name(), left.len());
        // Where a depth equals one in the map, or a moment is as large as its rounding, adapters may differ.
        assert!(count <= left.len() / 100, "{}: {count} of {}", method.name(), left.len());
        let shifted: Vec<f32> = left.iter().copied().cycle().skip(5).take(left.len()).collect();
        assert!(differing(&shifted, &native[0]) > left.len() / 50, "{}", method.name());
    }
}

/// Drags, picks and lines change the view as in the window.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn it_is_used_by_hand() {
    let mut page = Page::open("hand", "spheres --method remix --samples 8 --map 64 --against '--samples 8 --map 64'");
    let first = page.line();
    page.drag("picture", [0.5, 0.5], [0.25, 0.5]);
    let wiped = page.line();
    assert!(first.contains("--wipe 0.5") && wiped.contains("--wipe 0.2"), "{wiped}");
    let camera = |line: &str| line.split("--camera").nth(1).map(|rest| rest.split("--").next().map(str::to_owned));
    page.drag("picture", [0.6, 0.5], [0.7, 0.6]);
    assert_ne!(camera(&page.line()), camera(&wiped), "the camera was turned");
    page.drag("left.splits", [0.5, 0.5], [0.05, 0.5]);
    assert!(page.line().contains("--splits 1"), "{}", page.line());
    page.drag("left.bleeding", [0.02, 0.5], [0.3, 0.5]);
    assert!(page.line().contains("--bleeding 0."), "{}", page.line());
    page.pick("left.samples", "16");
    page.pick("left.method", "pcf");
    let line = page.line();
    assert!(line.contains("--method pcf") && line.contains("--samples 16"), "{line}");
    assert_eq!(page.complaint(), None);
    let (_, left) = page.visibility(0);
    assert!(left.contains(&0.0) && left.contains(&1.0));
    let told = page.0.try_value("viewer.open('spheres --samples 3')").expect_err("no such number");
    assert!(told.contains('3') && !told.contains('\n'), "{told}");
    assert_eq!(page.line(), line);
}

/// A model that is dropped is shown; a broken one is told of in one line and changes no pixel.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn models_are_dropped() {
    let mut page = Page::open("drop", "spheres --samples 8 --map 64 --against '--method pcf --samples 8 --map 64'");
    let (_, before) = page.visibility(0);
    page.drop_file("broken.obj", "v 0 0 0\nf 1 2 3\n");
    let told = page.complaint().expect("a complaint");
    assert!(told.contains("broken.obj") && told.contains('2') && !told.contains('\n'), "{told}");
    assert_eq!(differing(&page.visibility(0).1, &before), 0);
    page.drop_file("noise.glb", "glTF, but no more than its name");
    assert!(page.complaint().is_some_and(|told| told.contains("noise.glb")), "{:?}", page.complaint());
    page.drop_file(
        "good.obj",
        "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv -.4 .5 -.4\nv .4 .5 -.4\nv 0 .5 .4\nf 1 3 2\nf 4 6 5\n",
    );
    assert_eq!(page.complaint(), None);
    assert!(page.line().starts_with("good.obj"), "{}", page.line());
    let (_, after) = page.visibility(0);
    assert!(differing(&after, &before) > 1000 && after.contains(&0.0));
    // The page keeps the model, for lines and scene files that name it.
    let line = page.line();
    page.take(&line);
    assert_eq!((differing(&page.visibility(0).1, &after), page.line()), (0, line));
    page.drop_file("seen.toml", "mesh = \"good.obj\"\n[camera]\neye = [-1.5, 0.8, -1.0]\n");
    assert_eq!((page.complaint(), page.line().starts_with("seen.toml")), (None, true));
    assert!(differing(&page.visibility(0).1, &after) > 1000);
    let other = "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nf 1 3 2\n";
    page.drop_files(&[("other.obj", other), ("other.toml", "mesh = \"other.obj\"\n")]);
    assert_eq!((page.complaint(), page.line().starts_with("other.toml")), (None, true));
    page.drop_file("seen.toml", "mesh = \"good.obj\"\n");
    assert!(page.complaint().is_some_and(|told| told.contains("good.obj")), "{:?}", page.complaint());
}

/// The tab shows what the window shows.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn a_screenshot_shows_the_picture() {
    let line = "spheres --method shadow-map --samples 8 --map 64 --against '--samples 8 --map 256'";
    let mut page = Page::open("screenshot", line);
    let shot = page.shot();
    let (size, visibility) = page.visibility(0);
    let corner = page.place("picture", [0.0, 0.0]).map(|c| c.round() as u32);
    // Lit ground is brighter than dark ground, pixel by pixel, left of the wipe and away from edges.
    let [mut right, mut wrong] = [0; 2];
    let brightness = |x: u32, y: u32| {
        let pixel = shot.get_pixel(corner[0] + x, corner[1] + y).0;
        pixel[..3].iter().map(|c| u32::from(*c)).sum::<u32>()
    };
    for y in size[1] * 2 / 3..size[1] - 24 {
        for x in 8..size[0] / 2 - 12 {
            let at = |x: u32, y: u32| visibility[(y * size[0] + x) as usize];
            let around = [at(x, y), at(x + 4, y)];
            if around == [1.0, 0.0] || around == [0.0, 1.0] {
                let brighter = brightness(x, y) > brightness(x + 4, y);
                *(if brighter == (around[0] > around[1]) { &mut right } else { &mut wrong }) += 1;
            }
        }
    }
    assert!(right > 100 && wrong * 20 < right, "{right} right, {wrong} wrong");
    // The file that a key offers is the picture.
    page.0.value("globalThis.kept = null; HTMLAnchorElement.prototype.click = function () { kept = this.href }; true");
    page.press("p", 80);
    page.0.until("a picture is offered", "kept != null");
    let offered = page.fetched("kept");
    assert_eq!([offered.width(), offered.height()], size);
    let other = |at: [u32; 2]| offered.get_pixel(at[0], at[1]) != shot.get_pixel(corner[0] + at[0], corner[1] + at[1]);
    let differs = (0..size[0] * size[1]).filter(|p| other([p % size[0], p / size[0]])).count();
    assert!(differs * 100 < offered.len() / 4, "{differs} pixels differ");
}

/// Classes have their colours in the tab, where they are asked for in the address or by a key; a view is offered as a scene file.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn counts_are_shown() {
    let mut page =
        Page::open("counts", "spheres --samples 8 --map 64 --show classes --against '--samples 8 --map 256'");
    assert!(page.line().contains("--show classes"), "{}", page.line());
    let corner = page.place("picture", [0.0, 0.0]).map(|c| c.round() as u32);
    let many = |shot: &image::RgbaImage, colour: [u8; 3]| {
        let near = |p: &image::Rgba<u8>| (0..3).all(|k| p.0[k].abs_diff(colour[k]) <= 2);
        shot.enumerate_pixels().filter(|(x, _, p)| *x > corner[0] && near(p)).count()
    };
    let classes = page.shot();
    let colours = Overlay::Classes.legend();
    let counts: Vec<_> = colours.iter().map(|(_, colour)| many(&classes, *colour)).collect();
    println!("pixels of each class: {counts:?}");
    assert!(counts[1] > 300 && counts[2] > 10_000 && counts[4] > 500, "{counts:?}");
    page.press("7", 55);
    assert!(page.line().contains("--show pairs"), "{}", page.line());
    let pairs = page.shot();
    let (none, some) = (many(&pairs, Overlay::Pairs.legend()[0].1), many(&pairs, Overlay::Pairs.legend()[3].1));
    assert!(none > 10_000 && some > 20 && many(&pairs, colours[2].1) < 100, "{none} and {some} pixels");
    let kept =
        "globalThis.kept = null; URL.createObjectURL = blob => { globalThis.kept = blob; return 'data:,'; }; true";
    page.0.value(kept);
    let save = page.place("save", [0.5, 0.5]);
    page.0.click(save);
    let text = page.0.value("kept.text()");
    let text = text.as_str().expect("a text");
    assert!(text.starts_with("builtin = \"spheres\"") && text.contains("[camera]"), "{text}");
    page.drop_file("view.toml", text);
    assert_eq!((page.complaint(), page.line().starts_with("view.toml")), (None, true));
}
