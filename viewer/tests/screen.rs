//! The window on a screen of its own (Xvfb): it opens, shows what its command line names, writes a picture of itself, and ends.

use std::process::{Command, Output};
use test_support::{Folder, window_test};

/// Runs the viewer on a screen of its own. Two at a time may pick the same screen.
fn run_on_screen(args: &[&str]) -> Output {
    Command::new("xvfb-run")
        .args(["-a", "-s", "-screen 0 800x600x24", env!("CARGO_BIN_EXE_viewer")])
        .args(args)
        // Of a desktop that the test may run in.
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("xvfb-run, which ./test.sh installs; SUBPIXEL_SHADOWS_NO_WINDOW=1 leaves these tests out")
}

/// The part of the window without panel and line.
fn picture(path: &str) -> image::RgbaImage {
    let whole = image::open(path).expect(path).into_rgba8();
    let (width, height) = whole.dimensions();
    assert_eq!((width, height), (640, 480));
    image::imageops::crop_imm(&whole, 280, 40, width - 300, height - 100).to_image()
}

#[window_test]
fn it_writes_a_picture_of_itself() {
    let folder = Folder::new("viewer-screen");
    let views = ["shadow-map", "facet-masks"].map(|method| {
        let path = folder.path(&format!("{method}.png"));
        let line = [
            "bicycle",
            "--window",
            "640x480",
            "--wipe",
            "1",
            "--samples",
            "8",
            "--method",
            method,
            "--against",
            "--samples 8",
        ];
        let done = run_on_screen(&[&line[..], &["--screenshot", &path]].concat());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        picture(&path)
    });
    let brightness = |pixel: &image::Rgba<u8>| pixel.0[..3].iter().map(|c| u32::from(*c)).sum::<u32>();
    for view in &views {
        let bright = view.pixels().filter(|p| brightness(p) > 600).count();
        let dark = view.pixels().filter(|p| (200..480).contains(&brightness(p))).count();
        assert!(bright > 20_000 && dark > 4000, "{bright} bright, {dark} dark");
    }
    let differ = views[0].pixels().zip(views[1].pixels()).filter(|(a, b)| a != b).count();
    assert!((500..30_000).contains(&differ), "{differ} pixels differ between the methods");
}

#[test]
fn bad_input_is_one_line() {
    for (args, status, part) in [
        (&["nowhere.obj"][..], 1, "nowhere.obj"),
        (&["plane", "--samples", "3"], 1, "3"),
        (&["plane", "--against", "--samples 3"], 1, "3"),
        (&["plane", "--wipe", "7"], 1, "--wipe 7"),
        (&["--colour"], 2, "--colour"),
    ] {
        let done = Command::new(env!("CARGO_BIN_EXE_viewer")).args(args).output().expect("the viewer starts");
        let told = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(status), "{args:?}: {told}");
        assert!(told.contains(part) && (status == 2 || told.trim().lines().count() == 1), "{args:?}: {told}");
    }
}
