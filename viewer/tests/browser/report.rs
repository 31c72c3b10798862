//! The page of a report in a browser: it sorts, tells, and wipes.

use crate::SIZE;
use crate::chromium::Chromium;
use crate::site;
use lab::report::comparison::html::{PictureSheet, html};
use lab::report::comparison::page::Page;
use lab::report::comparison::pictures::{Panel, PanelCut, side_by_side};
use lab::report::comparison::{Row, Spread};
use serde_json::json;
use test_support::Folder;

/// Rows of two scenes: three methods, each slower and better by its samples, one of them without figures in the second.
fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (scene, slower) in [("plane", 1.0), ("windmill", 3.0)] {
        for (k, method) in ["facet-masks", "pcf", "shadow-map"].into_iter().enumerate() {
            for samples in [8, 32, 128] {
                let mut row = Row { scene: scene.to_owned(), method: method.to_owned(), samples, ..Row::default() };
                (row.size, row.map) = ([48, 32], 64);
                let median = slower * f64::from(samples) * (3.0 - k as f64);
                row.gpu_ms = Spread { median, low: median, high: median };
                row.converged.scene_band_rmse = Some((1.0 + k as f64) / f64::from(samples));
                row.failed = (scene == "windmill" && k == 2).then(|| "no room for the lists".to_owned());
                rows.push(row);
            }
        }
    }
    rows
}

#[test]
#[ignore = "in a browser: ./web.sh --test"]
fn a_report_is_looked_at() {
    let folder = Folder::new("browser-report-site");
    let picture = folder.path("pictures.png");
    let light = vec![1.0; 48 * 32];
    let panels = [0.0, 0.25, 0.5, 1.0].map(|v| Panel { ours: vec![v; 48 * 32], truth: light.clone() });
    side_by_side(picture.as_ref(), [48, 32], PanelCut::middle([48, 32]), &panels).expect("a picture");
    let sheet = PictureSheet { scene: "plane".to_owned(), png: std::fs::read(&picture).expect("it") };
    let text = html(&Page { command: "as told".to_owned(), ..Page::default() }, &rows(), &[sheet], false);
    std::fs::write(folder.path("index.html"), text).expect("written");
    let mut page = Chromium::without_webgpu("report", SIZE);
    page.open(&site::serve(folder.path("").as_ref()));
    assert_eq!(page.value("made.textContent"), json!("as told"));

    // The table has every row of the scene, and sorts by what is clicked, either way.
    let column = "Array.from(document.querySelectorAll('#body tr[data-row]'), r => Number(r.children[3].textContent))";
    let times = |page: &mut Chromium| -> Vec<f64> {
        page.value(column).as_array().expect("numbers").iter().filter_map(serde_json::Value::as_f64).collect()
    };
    let rising = times(&mut page);
    assert!(rising.len() == 9 && rising.is_sorted(), "{rising:?}");
    page.value("document.querySelector('th[data-key=ms]').click()");
    let falling = times(&mut page);
    assert!(falling.iter().rev().eq(&rising), "{falling:?}");
    page.value("filter.value = 'pcf'; filter.dispatchEvent(new Event('input'))");
    assert_eq!(times(&mut page).len(), 3);
    page.value("filter.value = ''; filter.dispatchEvent(new Event('input'))");

    // Points tell their rows, and a click shows the command.
    assert_eq!(page.value("document.querySelectorAll('#plot circle').length"), json!(9));
    page.value("document.querySelector('#plot circle').dispatchEvent(new PointerEvent('pointerenter', {clientX: 9, clientY: 9}))");
    let told = page.value("document.getElementById('hover').textContent");
    assert!(told.as_str().is_some_and(|told| told.contains("facet-masks, 8 samples")), "{told}");
    page.value("document.querySelector('#plot circle').dispatchEvent(new MouseEvent('click'))");
    let command = page.value("document.querySelector('td.command').textContent");
    let want = "cargo run --release -- render plane --method facet-masks --size 48x32 --samples 8 --map 64 --truth";
    assert_eq!(command, json!(want));
    page.value("document.querySelector('#legend input').click()");
    assert_eq!(page.value("document.querySelectorAll('#plot circle').length"), json!(6));

    // Left of the wipe is one picture, right of it the other.
    page.until("the picture is drawn", "document.getElementById('picture').width == 24 * 45");
    let brightness = "Array.from([2, 24 * 45 - 3], x => document.getElementById('picture').getContext('2d').getImageData(x, 9, 1, 1).data[0])";
    assert_eq!(page.value(brightness), json!([0, 255]), "the first method and rays");
    page.value(
        "document.getElementById('wipe').value = 1; document.getElementById('wipe').dispatchEvent(new Event('input'))",
    );
    assert_eq!(page.value(brightness), json!([0, 0]));
    page.value("document.getElementById('left').value = '2'; document.getElementById('left').dispatchEvent(new Event('input'))");
    assert_eq!(page.value(brightness), json!([128, 128]));

    // Another scene has rows of its own; what has no figures says why.
    page.value("scene.value = 'windmill'; scene.dispatchEvent(new Event('change'))");
    assert_eq!(page.value("document.querySelectorAll('#body tr[data-row]').length"), json!(9));
    assert_eq!(page.value("pictures.hidden"), json!(true));
    page.value("Array.from(document.querySelectorAll('#body tr[data-row]')).at(-1).click()");
    assert_eq!(page.value("document.querySelector('td.command').textContent"), json!("no room for the lists"));
    // Nothing runs out of a narrow screen but the table, which scrolls by itself.
    assert_eq!(page.value("document.documentElement.scrollWidth <= innerWidth"), json!(true));
    assert!(page.heard.is_empty(), "{:?}", page.heard);
}
