//! The viewer as its users meet it, without a screen: what is dragged, picked and dropped, against the library's own frames.

#[path = "../common/mod.rs"]
mod common;
mod panel;
mod touch;

use common::{WIDE, Window, key};
use egui::{Event, Key, PointerButton};
use lab::scene::Light;
use oracle::truth::{SceneTruth, Tracer};
use std::sync::Arc;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{MethodName, Settings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use test_support::{Folder, gpu_test};
use viewer::View;
use viewer::overlay::Overlay;
use viewer::view::Against;

/// Visibility by the library, bits, of what the window shows by the left half's settings or the right half's.
fn by_library(window: &Window, half: usize) -> Vec<u32> {
    let (view, scene) = (window.viewer.view(), window.viewer.scene_now());
    let options = match (&view.right, half) {
        (Against::Method(options), 1) => options,
        _ => &view.left,
    };
    let settings = Settings { size: window.picture(), ..options.settings().unwrap() };
    let gpu = Gpu::open(None).unwrap();
    let prepared = scene.prepared().unwrap();
    let renderer = Renderer::of_method(&gpu, &prepared, options.method, &settings, Budget::default());
    let frame = renderer.unwrap().render(&scene.camera, &scene.light).unwrap();
    frame.visibility.iter().map(|v| v.to_bits()).collect()
}

fn differing<T: PartialEq>(a: &[T], b: &[T]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// Both halves are the library's, also after the camera and the light were dragged; they are two.
#[gpu_test]
fn halves_are_the_methods() {
    let mut window = Window::new("spheres --method shadow-map --map 128 --samples 8 --against '--samples 8 --map 128'");
    window.settle();
    let [width, height] = window.picture();
    assert!(width == WIDE && height > 100, "{width} x {height}");
    let mut seen = Vec::new();
    for step in 0..3 {
        match step {
            1 => window.drag(PointerButton::Primary, [0.3, 0.5], [0.4, 0.55]),
            2 => window.drag(PointerButton::Middle, [0.6, 0.5], [0.45, 0.4]),
            _ => {}
        }
        window.settle();
        assert_eq!(window.viewer.complaint(), None);
        let halves = [0, 1].map(|half| window.visibility(half));
        for (half, shown) in halves.iter().enumerate() {
            assert_eq!(differing(shown, &by_library(&window, half)), 0, "step {step}, half {half}");
        }
        let lit = halves[1].iter().filter(|v| **v == 1.0f32.to_bits()).count();
        let dark = halves[1].iter().filter(|v| **v == 0).count();
        assert!(lit > 1000 && dark > 500, "{lit} lit, {dark} dark");
        assert!(differing(&halves[0], &halves[1]) > 100, "the halves are of two methods");
        let moved = window.viewer.scene_now();
        seen.push((halves, moved.camera, moved.light));
    }
    assert!(seen[0].1 != seen[1].1 && seen[0].2 == seen[1].2, "the camera alone was dragged");
    assert!(seen[1].1 == seen[2].1 && seen[1].2 != seen[2].2, "the light alone was dragged");
    // Each picture is another than the one before it.
    assert!(differing(&seen[0].0[1], &seen[1].0[1]) > 1000 && differing(&seen[1].0[1], &seen[2].0[1]) > 500);
}

/// Triangles with holes cast and show them: as the library has them, and as traced truth.
#[gpu_test]
fn holes_are_shown() {
    let mut window =
        Window::new("leaves --samples 8 --map 128 --wipe 1 --against '--method pcf --samples 8 --map 128'");
    window.settle();
    assert_eq!(window.viewer.complaint(), None);
    assert_eq!(differing(&window.visibility(0), &by_library(&window, 0)), 0);
    window.viewer.set_overlay(Overlay::Visibility);
    window.settle();
    let (colours, seen) = (window.colours(), window.visibility(0));
    // Where the library sees no shadow and no leaf stands before the sky, the picture is the sky's.
    let scene = window.viewer.scene_now();
    let tracer = Tracer::with_alpha(&scene.mesh, &scene.alpha).unwrap();
    let whole = Tracer::new(&scene.mesh).unwrap();
    let [width, height] = window.picture();
    let samples = Samples::new(Pattern::LowDiscrepancy, 1).unwrap();
    let hits = |tracer: &Tracer| {
        let truth = SceneTruth::new(tracer, &scene.camera, &scene.light, &samples, width, height).unwrap();
        truth.image(None).centre_hits()
    };
    let (with, without) = (hits(&tracer), hits(&whole));
    let through: Vec<usize> = (0..colours.len()).filter(|&p| without[p] && !with[p]).collect();
    assert!(through.len() > 100, "{} pixels show the sky through a hole", through.len());
    // Surfaces are grey here, the sky is blue.
    let is_sky = |p: &&usize| colours[**p][2] > colours[**p][0].saturating_add(8);
    let sky = through.iter().filter(is_sky).count();
    assert!(sky * 10 > through.len() * 7, "{sky} of {}", through.len());
    let surfaces: Vec<usize> = (0..colours.len()).filter(|&p| with[p]).collect();
    let wrong = surfaces.iter().filter(is_sky).count();
    assert!(wrong * 20 < surfaces.len(), "{wrong} of {}", surfaces.len());
    assert!(seen.contains(&0) && seen.contains(&1.0f32.to_bits()));
}

/// Pixels left of the wipe are of the left half, the others of the right one.
#[gpu_test]
fn the_wipe_parts_the_picture() {
    let mut window = Window::new("spheres --method shadow-map --map 64 --samples 1 --against '--samples 8 --map 64'");
    window.settle();
    let pictures: Vec<_> = [0.99, 0.01, 0.3]
        .into_iter()
        .map(|share| {
            let at = window.viewer.view().wipe;
            window.drag(PointerButton::Primary, [at, 0.5], [share, 0.5]);
            window.settle();
            assert!((window.viewer.view().wipe - share).abs() < 0.02);
            window.colours()
        })
        .collect();
    let column = |pixel: usize| pixel % WIDE as usize;
    let of = |part: &dyn Fn(usize) -> bool, a: &[[u8; 4]], b: &[[u8; 4]]| {
        (0..a.len()).filter(|pixel| part(column(*pixel)) && a[*pixel] != b[*pixel]).count()
    };
    let wipe = (window.viewer.view().wipe * WIDE as f32).round() as usize;
    let (left, right) = (|x: usize| x < wipe && x > 3, |x: usize| x >= wipe && x < WIDE as usize - 4);
    assert_eq!(of(&left, &pictures[2], &pictures[0]), 0);
    assert_eq!(of(&right, &pictures[2], &pictures[1]), 0);
    assert!(of(&left, &pictures[2], &pictures[1]) > 20, "the left half is another");
    assert!(of(&right, &pictures[2], &pictures[0]) > 50, "the right half is another");
}

/// With visibility shown each pixel of the ground is as bright as the half's visibility there.
#[gpu_test]
fn visibility_is_shown_pixel_by_pixel() {
    let mut window = Window::new("spheres --samples 8 --map 64 --wipe 1 --against '--method pcf --samples 8 --map 64'");
    window.settle();
    window.viewer.set_overlay(Overlay::Visibility);
    window.settle();
    let (colours, visibility) = (window.colours(), window.visibility(0));
    // Shown as its square, encoded in sRGB.
    let wanted = |bits: u32| {
        let v = f32::from_bits(bits).powi(2);
        let encoded = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    };
    let differ = |shift: usize| {
        let pairs = colours.iter().zip(visibility.iter().cycle().skip(shift));
        pairs.filter(|(colour, bits)| colour[0].abs_diff(wanted(**bits)) > 1).count()
    };
    // The sky, and pixels that show both it and a surface.
    let most = colours.len() / 3;
    let (same, shifted) = (differ(0), differ(3 * WIDE as usize));
    assert!(same < most && shifted > same + 500, "{same} pixels differ, {shifted} three rows lower");
    let ground = colours.len() * 3 / 4..colours.len() - WIDE as usize;
    let wrong = ground.clone().filter(|p| colours[*p][0].abs_diff(wanted(visibility[*p])) > 1).count();
    let dark = ground.clone().filter(|p| visibility[*p] == 0).count();
    assert!(wrong == 0 && dark > 50, "{wrong} of {} pixels are wrong, {dark} dark", ground.len());
}

/// Classes and numbers have the colours of their legend, pixel by pixel; a half that has none is grey.
#[gpu_test]
fn counts_are_shown_pixel_by_pixel() {
    let mut window = Window::new("bicycle --samples 8 --map 64 --against '--method spsm --samples 8 --map 64'");
    window.settle();
    let shaded = window.colours();
    let mut pictures = Vec::new();
    for (pressed, overlay) in [
        (Key::Num4, Overlay::Classes),
        (Key::Num5, Overlay::Facets),
        (Key::Num6, Overlay::Texels),
        (Key::Num7, Overlay::Pairs),
    ] {
        window.frame(vec![key(pressed, true)]);
        window.frame(vec![key(pressed, false)]);
        window.settle();
        assert_eq!((window.viewer.view().overlay, window.viewer.complaint()), (overlay, None));
        assert!(window.viewer.command_line().ends_with(&format!("--show {}", overlay.name())));
        let (colours, counts, legend) = (window.colours(), [0, 1].map(|half| window.counts(half)), overlay.legend());
        let which = overlay.counted().expect("a number") as usize;
        // The powers of two that are less.
        let step =
            |n: u32| if which == 0 { n } else { (0..9).filter(|k| n > 1 << k).count() as u32 + u32::from(n > 0) };
        let near = |colour: [u8; 4], wanted: [u8; 3]| (0..3).all(|k| colour[k].abs_diff(wanted[k]) <= 1);
        let wrong = |shift: usize| {
            let wrong = |pixel: &usize| {
                let left = *pixel as u32 % WIDE < WIDE / 2;
                let n = counts[usize::from(!left)][(pixel + shift) % colours.len()][which];
                let colour = colours[*pixel];
                match left || which == 0 {
                    true => !near(colour, legend[step(n) as usize].1),
                    false => colour[0].abs_diff(colour[1]).max(colour[1].abs_diff(colour[2])) > 60,
                }
            };
            (0..colours.len()).filter(wrong).count()
        };
        assert_eq!(wrong(0), 0, "{overlay:?}");
        assert!(wrong(WIDE as usize) > 200, "{overlay:?}");
        let most = counts[0].iter().map(|c| c[which]).max().unwrap_or(0);
        assert!(most >= 2, "{overlay:?}: {most}");
        assert!(window.texts.iter().any(|text| text.contains(overlay.meaning())), "{:?}", window.texts);
        assert_eq!(window.texts.iter().any(|text| text.contains("right: spsm, none")), which > 0);
        pictures.push(colours);
    }
    assert!(pictures.windows(2).all(|two| differing(&two[0], &two[1]) > 1000));
    window.frame(vec![key(Key::Num1, true)]);
    window.frame(vec![key(Key::Num1, false)]);
    window.settle();
    assert_eq!(differing(&window.colours(), &shaded), 0);
    assert!(window.viewer.counts(0).is_none(), "nothing is counted that is not shown");
}

/// A light that no pass takes is told of; the picture of before stays as it is, and the next light that it takes is shown.
#[gpu_test]
fn a_moment_that_fails_leaves_the_picture() {
    let line = "spheres --method spsm --samples 8 --map 64 --light 'point=0,40,0' --wipe 1 --against '--method pcf --samples 8 --map 64'";
    let mut window = Window::new(line);
    window.settle();
    assert_eq!(window.viewer.complaint(), None);
    let before = window.colours();
    window.viewer.set_light(Light::Directional { direction: [0.0; 3] });
    window.settle();
    let told = window.viewer.complaint().expect("the light is refused");
    assert!(told.contains("length 0") && !told.contains('\n'), "{told}");
    assert_eq!(differing(&window.colours(), &before), 0);
    window.drag(PointerButton::Primary, [0.3, 0.5], [0.5, 0.6]);
    window.settle();
    assert!(window.viewer.complaint().is_some());
    assert_eq!(differing(&window.colours(), &before), 0, "no picture is drawn of a moment that failed");
    window.frame(vec![key(Key::R, true)]);
    window.frame(vec![key(Key::R, false)]);
    window.settle();
    assert_eq!((window.viewer.complaint(), differing(&window.colours(), &before)), (None, 0));
}

/// A moment that comes back is drawn again, also by a half that was drawn alone of it before the other one was made.
#[gpu_test]
fn a_moment_comes_back() {
    let mut window = Window::new("spheres --method shadow-map --samples 8 --map 64 --against '--samples 8 --map 64'");
    // Most often the left half, of few kernels, is drawn first.
    window.settle();
    let home = [0, 1].map(|half| window.visibility(half));
    window.drag(PointerButton::Primary, [0.3, 0.5], [0.4, 0.5]);
    window.settle();
    assert!(differing(&window.visibility(0), &home[0]) > 500);
    window.frame(vec![key(Key::R, true)]);
    window.frame(vec![key(Key::R, false)]);
    window.settle();
    assert_eq!([0, 1].map(|half| differing(&window.visibility(half), &home[half])), [0; 2]);
}

/// A half whose pass is made is shown and follows the camera while the other has none; of that no pixel is known.
#[gpu_test]
fn a_half_is_shown_alone() {
    let line = "spheres --method shadow-map --samples 8 --map 64 --against '--samples 8 --map 64'";
    let mut view = View::of_line(line).unwrap();
    let Against::Method(right) = &mut view.right else { panic!("a method") };
    right.samples = 0;
    let mut window = Window::of(view);
    let mut seen = Vec::new();
    for turn in [0.0, 0.1] {
        window.drag(PointerButton::Primary, [0.3, 0.5], [0.3 + turn, 0.5]);
        window.settle();
        let told = window.viewer.complaint();
        assert!(told.as_ref().is_some_and(|told| told.contains("sample")), "{told:?}");
        assert_eq!(window.viewer.halves_shown(), 1);
        assert_eq!(differing(&window.visibility(0), &by_library(&window, 0)), 0);
        assert!(window.visibility(1).iter().all(|v| f32::from_bits(*v) == -1.0));
        seen.push(window.visibility(0));
    }
    assert!(differing(&seen[0], &seen[1]) > 500);
    let bluish = window.colours();
    window.viewer.take_line(line).unwrap();
    window.settle();
    assert_eq!((window.viewer.complaint(), window.viewer.halves_shown()), (None, 2));
    assert_eq!(differing(&window.visibility(1), &by_library(&window, 1)), 0);
    assert!(differing(&window.colours(), &bluish) > 1000);
}

/// Truth in slices is truth.
#[gpu_test]
fn truth_is_the_oracles() {
    let mut window = Window::new("plane --samples 8 --map 64 --against truth");
    window.resize([WIDE as f32, 90.0]);
    window.settle();
    let scene = window.viewer.scene_now();
    let [width, height] = window.picture();
    let tracer = Tracer::new(&scene.mesh).unwrap();
    let samples = Samples::new(Pattern::LowDiscrepancy, 1).unwrap();
    let truth = SceneTruth::new(&tracer, &scene.camera, &scene.light, &samples, width, height).unwrap();
    let truth: Vec<u32> = truth.converged(None).iter().map(|(v, _)| v.to_bits()).collect();
    assert_eq!(differing(&window.visibility(1), &truth), 0);
    assert!(differing(&window.visibility(0), &truth) > 50, "eight samples are not 1024");
}

/// A broken file is told of by name, and the picture stays; a good one is shown.
#[gpu_test]
fn files_are_dropped() {
    let folder = Folder::new("viewer-dropped");
    let broken = folder.file("broken.obj", "v 0 0 0\nf 1 2 3\n");
    let good = folder
        .file("good.obj", "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv -.4 .5 -.4\nv .4 .5 -.4\nv 0 .5 .4\nf 1 3 2\nf 4 6 5\n");
    let mut window = Window::new("spheres --samples 8 --map 64 --against truth --wipe 1");
    window.settle();
    let before = window.colours();
    window.drop_files(&[&broken]);
    window.settle();
    let told = window.viewer.complaint().expect("a complaint");
    assert!(told.contains("broken.obj") && told.contains('2') && !told.contains('\n'), "{told}");
    assert_eq!(differing(&window.colours(), &before), 0);
    window.drop_files(&[&good]);
    window.settle();
    assert_eq!((window.viewer.complaint(), window.viewer.scene_now().mesh.triangles.len()), (None, 2));
    assert!(differing(&window.colours(), &before) > 5000);
}

/// Of files that are dropped together the one that names the others is opened; a scene file that is saved of it opens as the same.
#[gpu_test]
fn scene_files_are_dropped_and_saved() {
    let folder = Folder::new("viewer-saved");
    let good = folder
        .file("good.obj", "v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv -.4 .5 -.4\nv .4 .5 -.4\nv 0 .5 .4\nf 1 3 2\nf 4 6 5\n");
    let scene = folder.file("scene.toml", "mesh = \"good.obj\"\n[camera]\neye = [1.0, 2.0, 3.0]\n");
    let mut window = Window::new("plane --samples 8 --map 64 --against '--method pcf --samples 8 --map 64'");
    window.settle();
    window.drop_files(&[&good, &scene]);
    window.settle();
    window.drag(PointerButton::Primary, [0.3, 0.5], [0.4, 0.55]);
    window.settle();
    let shown = window.viewer.scene_now();
    assert!(
        shown.name.ends_with("scene.toml") && shown.mesh.triangles.len() == 2 && shown.camera.eye != [1.0, 2.0, 3.0]
    );
    window.click("save");
    let told = window.viewer.complaint().expect("a message");
    let saved = told.strip_prefix("wrote ").expect(&told).to_owned();
    assert!(saved.ends_with("view-1.toml"), "{told}");
    window.drop_files(&[&saved]);
    window.settle();
    let again = window.viewer.scene_now();
    assert_eq!((window.viewer.complaint(), &again.name, again.camera), (None, &saved, shown.camera));
    assert_eq!((again.light, again.mesh), (shown.light, shown.mesh));
}

/// A view at rest is drawn as often as its history has frames: it is the library's; a move goes on from there.
#[gpu_test]
fn a_history_is_filled_at_rest() {
    let line = |of: &str| format!("spheres {of} --against '--method shadow-map --map 64 --samples 8'");
    let mut window = Window::new(&line("--method shadow-map --map 64 --samples 8 --history 8"));
    window.settle();
    let halves = [0, 1].map(|half| window.visibility(half));
    assert_eq!([0, 1].map(|half| differing(&halves[half], &by_library(&window, half))), [0, 0]);
    assert!(differing(&halves[0], &halves[1]) > 300, "{}", differing(&halves[0], &halves[1]));
    window.drag(PointerButton::Primary, [0.3, 0.5], [0.4, 0.55]);
    window.settle();
    assert_eq!(window.viewer.complaint(), None);
    let moved = [0, 1].map(|half| window.visibility(half));
    assert_eq!(differing(&moved[1], &by_library(&window, 1)), 0);
    assert!(differing(&moved[0], &halves[0]) > 500 && differing(&moved[0], &moved[1]) > 300);
}

/// Bad lines are told of; good ones open what they name.
#[gpu_test]
fn lines_are_entered() {
    let mut window = Window::new("spheres --samples 8 --map 64 --against '--method pcf --samples 8 --map 64'");
    window.settle();
    let told = window.viewer.take_line("spheres --samples 3").unwrap_err().to_string();
    assert!(told.contains('3') && !told.contains('\n'), "{told}");
    assert_eq!(window.viewer.view().left.samples, 8);
    let line = window.viewer.command_line();
    window.viewer.take_line("plane --samples 1 --map 64 --against '--method variance --map 64'").unwrap();
    window.settle();
    assert_eq!((window.viewer.complaint(), window.viewer.view().left.samples), (None, 1));
    window.viewer.take_line(&line).unwrap();
    window.settle();
    assert_eq!(window.viewer.command_line(), line);
    assert!(matches!(&window.viewer.view().right, Against::Method(options) if options.method == MethodName::Pcf));
}

/// No size and no number of resizes is one too many.
#[gpu_test]
fn windows_of_any_size() {
    let mut window = Window::new("plane --samples 1 --map 64 --against '--method pcf --samples 1 --map 64'");
    window.settle();
    for step in 0..60u32 {
        let side = |k: u32| (step * k % 23) as f32 * 9.0;
        window.resize([side(7), side(5)]);
        window.frame(vec![Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, 30.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: egui::Modifiers::NONE,
        }]);
    }
    window.resize([0.0, 0.0]);
    window.frame(Vec::new());
    window.resize([WIDE as f32, 120.0]);
    window.settle();
    assert_eq!((window.viewer.complaint(), window.picture()[0]), (None, WIDE));
    for pressed in [Key::Z, Key::F1, Key::T, Key::W, Key::ArrowLeft, Key::R, Key::T] {
        window.frame(vec![key(pressed, true)]);
        window.frame(vec![key(pressed, false)]);
    }
    window.settle();
    assert_eq!(window.viewer.complaint(), None);
}

/// A window that nobody touches draws itself until its picture has its size and the panel tells of all that was computed, and then no more.
#[gpu_test]
fn a_window_comes_to_rest_by_itself() {
    let mut window = Window::new("plane --samples 1 --map 64 --against '--method pcf --samples 1 --map 64'");
    window.frame(vec![key(Key::H, true), key(Key::H, false)]);
    for size in [[900.0, 4000.0], [700.0, 3600.0], [900.0, 3000.0]] {
        window.resize(size);
        window.frame(Vec::new());
        assert!(!window.viewer.is_settled(), "{size:?}");
        window.rest();
        assert!(window.viewer.is_settled() && window.viewer.complaint().is_none(), "{size:?}");
        let image = window.viewer.image().size();
        assert_eq!(window.picture(), [image.x, image.y].map(|side| side.round() as u32), "{size:?}");
        // Of both halves.
        let told = window.texts.iter().filter(|text| text.contains("ms on the GPU")).count();
        assert_eq!(told, 2, "{size:?}: {:?}", window.texts);
    }
}

/// A screenshot is told of when it is written, and where it cannot be; no earlier one is lost.
#[gpu_test]
fn a_message_of_the_screenshot_is_true() {
    let mut window = Window::new("plane --samples 1 --map 64 --against '--method pcf --samples 1 --map 64'");
    window.settle();
    let folder = Folder::new("screenshots");
    window.viewer.keep_screenshots_in(folder.path(""));
    std::fs::write(folder.path("shadows-2.png"), "an earlier one").unwrap();
    let image = Arc::new(egui::ColorImage::filled([WIDE as usize, 400], egui::Color32::from_rgb(1, 2, 3)));
    let taken = |window: &mut Window| {
        window.frame(vec![key(Key::P, true), key(Key::P, false)]);
        assert_eq!(window.viewer.complaint(), None, "nothing is written yet, and the picture has no message on it");
        let shot = window.shots.pop().expect("it asks for a picture");
        shot.complete(image.clone());
        window.frame(Vec::new());
        window.viewer.complaint().expect("a message")
    };
    for number in [1, 3] {
        let told = taken(&mut window);
        let path = folder.path(&format!("shadows-{number}.png"));
        assert_eq!(told, format!("wrote {path}"));
        let [width, height] = window.picture();
        assert_eq!(image::image_dimensions(&path).unwrap(), (width, height));
    }
    assert_eq!(std::fs::read_to_string(folder.path("shadows-2.png")).unwrap(), "an earlier one");
    window.viewer.keep_screenshots_in(folder.path("shadows-2.png"));
    let told = taken(&mut window);
    assert!(told.contains("shadows-2.png") && !told.contains("wrote") && !told.contains('\n'), "{told}");
}

/// A GPU that is gone is told of, and nothing panics; what was looked at can be opened again.
#[gpu_test]
fn a_lost_gpu_is_told_of() {
    let mut window = Window::new("spheres --samples 8 --map 64 --against '--method pcf --samples 8 --map 64'");
    window.settle();
    assert_eq!(window.viewer.lost(), None);
    let line = window.viewer.command_line();
    window.lose();
    // Submitted work runs to its end first.
    for step in 0..1000 {
        window.frame(vec![key(Key::W, step % 2 == 0)]);
        if step > 20 && window.viewer.lost().is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let told = window.viewer.complaint().expect("a complaint");
    assert!(told.contains("lost") && !told.contains('\n'), "{told}");
    assert!(window.viewer.is_settled() && View::of_line(&line).is_ok());
    // While passes are made, too.
    let mut window = Window::new("spheres --samples 1 --map 64 --against '--method exponential --map 64'");
    window.lose();
    for step in 0..1000 {
        window.frame(Vec::new());
        if step > 20 && window.viewer.lost().is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(window.viewer.lost().is_some());
}
