//! The panel of options.

use crate::common::{Window, key};
use egui::Key;
use test_support::gpu_test;

/// The panel's lists change the halves; the plan says what is left out, and why.
#[gpu_test]
fn the_panel_is_used() {
    let mut window = Window::new("plane --samples 8 --map 64 --against '--method remix --samples 8 --map 64'");
    window.resize([620.0, 1400.0]);
    window.frame(vec![key(Key::H, true)]);
    window.frame(vec![key(Key::H, false)]);
    window.settle();
    window.click("left.filter");
    window.click("left.filter.tent");
    window.click("right.method");
    window.click("right.method.spsm");
    window.settle();
    let line = window.viewer.command_line();
    assert!(line.contains("--filter tent") && line.contains("--method spsm"), "{line}");
    assert_eq!(window.viewer.complaint(), None);
    window.click("left out");
    // The list unfolds.
    for _ in 0..500 {
        window.frame(Vec::new());
        std::thread::sleep(std::time::Duration::from_millis(10));
        if window.texts.iter().any(|text| text.contains("pixel_views")) {
            break;
        }
    }
    let told = |what: &str| window.texts.iter().any(|text| text.contains(what));
    assert!(told("vertex_project.divide: directional light"), "{:?}", window.texts);
    assert!(!told("pixel_filter:") && told("pixel_views: one view of the light holds all"), "{:?}", window.texts);
}
