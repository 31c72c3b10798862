//! A page from its first picture to its end: how soon, how smoothly, and what it says when something fails.

use crate::chromium::Chromium;
use crate::{Page, SITE, SIZE, address, differing};
use serde_json::{Value, json};
use std::sync::LazyLock;

/// The first picture is there soon, and the page answers its user: tasks of its one thread are short after the first picture.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn the_first_picture_comes_soon() {
    LazyLock::force(&SITE);
    let mut page = Page(Chromium::start("soon", SIZE));
    let start = std::time::Instant::now();
    page.0.open(&address(""));
    page.0.until("a half", "document.documentElement.dataset.started == 'true' && viewer.halves_shown() > 0");
    let half = start.elapsed().as_secs_f64();
    page.0.until("both halves", "viewer.settled() && viewer.halves_shown() == 2");
    let both = start.elapsed().as_secs_f64();
    println!("{half:.1} s to the picture of the left half, {both:.1} s to that of both");
    assert!(half < 0.8 * both && both < 30.0, "{half} s, {both} s");
    page.0.value(
        "globalThis.tasks = []; new PerformanceObserver(list => tasks.push(...list.getEntries().map(e => e.duration)))
            .observe({ type: 'longtask' }); true",
    );
    let told = |page: &mut Page, what: &str, expression: &str| -> bool {
        let tasks = page.0.value(expression);
        let tasks: Vec<f64> = tasks.as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
        println!("tasks of more than 50 ms while {what}: {tasks:.0?} ms");
        // A single one waits for a software adapter whose cores others use, too.
        tasks.iter().filter(|ms| **ms > 100.0).count() < 2
    };
    page.drag("picture", [0.7, 0.5], [0.8, 0.55]);
    page.drag("picture", [0.5, 0.5], [0.3, 0.5]);
    let turned = told(&mut page, "the camera is turned and the wipe is moved", "tasks");
    let mut opened = Vec::new();
    // The first compiles what the others need, too; in a worker, large meshes hold the page up no more than small ones.
    for scene in ["spheres", "windmill", "plant", "spheres", "city"] {
        let line = format!("{scene} --samples 8 --map 256 --against \\'--method pcf --map 256\\'");
        page.0.value(&format!("tasks.length = 0; viewer.open('{line}'); true"));
        page.settle();
        opened.push(told(&mut page, &format!("{scene} is opened"), "tasks"));
    }
    page.0.value("viewer.open('windmill --samples 8 --against truth'); true");
    page.0.until("rays are traced", "viewer.visibility(1).then(all => all.some(v => v >= 0), () => false)");
    let wait = "tasks.length = 0; new Promise(seen => setTimeout(() => seen(tasks), 4000))";
    let traced = told(&mut page, "rays are traced", wait);
    // A task of 200 ms is seen.
    page.0
        .value("setTimeout(() => { const end = performance.now() + 200; while (performance.now() < end); }, 0); true");
    page.0.until("a long task is told", "tasks.some(ms => ms > 190)");
    assert!(turned && traced, "tasks of more than 100 ms");
    assert!(opened[1..].iter().all(|short| *short), "tasks of more than 100 ms while scenes are opened: {opened:?}");
}

/// A worker that comes to its end is replaced: the page says so, and opens the next scene as before.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn a_worker_that_ends_is_replaced() {
    LazyLock::force(&SITE);
    let mut page = Page(Chromium::start("worker", SIZE));
    let watched = "globalThis.workers = []; const Real = Worker;
        globalThis.Worker = class extends Real { constructor(...given) { super(...given); workers.push(this); } };";
    page.0.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": watched }));
    let line = "plane --samples 8 --map 64 --against '--method pcf --samples 8 --map 64'";
    page.0.open(&address(line));
    page.0.until("the page has started", "document.documentElement.dataset.started == 'true'");
    page.settle();
    let (_, before) = page.visibility(0);
    page.0.value("viewer.open('spheres --samples 8 --against truth'); workers[0].terminate(); true");
    page.0.value(
        "workers[0].dispatchEvent(new MessageEvent('message', { data: { number: 0, error: 'trap', ended: true } })); true",
    );
    page.0.until("the end is told", "(viewer.complaint() ?? '').includes('ended')");
    page.settle();
    assert_eq!(page.0.value("workers.length"), json!(2));
    assert_eq!(differing(&page.visibility(0).1, &before), 0, "the left half is as before");
    page.take("spheres --samples 8 --map 64 --against '--method pcf --samples 8 --map 64'");
    assert_eq!(page.complaint(), None);
    assert!(differing(&page.visibility(0).1, &before) > 1000);
}

/// Without WebGPU, and when the GPU is lost, the page says so.
#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn what_cannot_be_drawn_is_told() {
    let mut browser = Chromium::without_webgpu("without", SIZE);
    browser.open(&address(""));
    browser.until("a picture is shown", "picture.naturalWidth > 100 && !picture.hidden && !wait.hidden");
    let said = browser.value("said.textContent");
    assert!(said.as_str().is_some_and(|said| said.contains("WebGPU")), "{said}");
    drop(browser);
    let mut page = Page::open("lost", "plane --samples 1 --map 64 --against '--method pcf --samples 1 --map 64'");
    assert_eq!(page.0.value("lost.hidden"), json!(true));
    page.0.lose_gpu();
    page.0.until("the loss is told", "!lost.hidden && lost.textContent.includes('lost')");
    drop(page);
    let mut bad = Chromium::start("bad", SIZE);
    // A browser that has just begun may offer no adapter.
    let told = (0..3).map(|_| {
        bad.open(&address("plane --samples 3"));
        bad.until("something is told", "!wait.hidden && !said.textContent.startsWith('Loading')");
        bad.value("said.textContent").as_str().unwrap_or_default().to_owned()
    });
    let told = told.into_iter().find(|told| !told.contains("no adapter"));
    assert!(told.as_ref().is_some_and(|told| told.contains("3 samples")), "{told:?}");
}
