//! Fingers, which have no keys and no second button.

use crate::common::{Window, key};
use egui::{Event, Key, PointerButton, Pos2, TouchDeviceId, TouchId, TouchPhase, vec2};
use glam::Vec3;
use test_support::gpu_test;

const LINE: &str = "plane --samples 8 --map 64 --against '--method pcf --samples 8 --map 64'";

/// A drag of the first finger, which a window tells as a drag of the pointer, and of a second one beside it.
fn drag_two(window: &mut Window) {
    let image = window.viewer.image();
    let touch = |id, phase, pos| Event::Touch { device_id: TouchDeviceId(1), id: TouchId(id), phase, pos, force: None };
    let press = |pos: Pos2, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Default::default(),
    };
    let first = image.min + image.size() * vec2(0.2, 0.3);
    let at = |id: u64, step: f32| first + vec2(20.0 * id as f32 + 4.0 * step, 2.0 * step);
    window.frame(vec![touch(0, TouchPhase::Start, first), Event::PointerMoved(first), press(first, true)]);
    window.frame(vec![touch(1, TouchPhase::Start, at(1, 0.0))]);
    for step in 1..=8 {
        let [one, other] = [at(0, step as f32), at(1, step as f32)];
        window.frame(vec![
            touch(0, TouchPhase::Move, one),
            Event::PointerMoved(one),
            touch(1, TouchPhase::Move, other),
        ]);
    }
    let [one, other] = [at(0, 8.0), at(1, 8.0)];
    window.frame(vec![touch(0, TouchPhase::End, one), press(one, false), touch(1, TouchPhase::End, other)]);
    window.frame(vec![Event::PointerGone]);
}

/// Two fingers move the camera and turn it not.
#[gpu_test]
fn two_fingers_move_the_camera() {
    let mut window = Window::new(LINE);
    window.settle();
    let before = window.viewer.scene_now();
    drag_two(&mut window);
    let after = window.viewer.scene_now();
    let arm = |camera: &lab::scene::Camera| Vec3::from(camera.eye) - Vec3::from(camera.target);
    let moved = (Vec3::from(after.camera.eye) - Vec3::from(before.camera.eye)).length();
    let turned = (arm(&after.camera) - arm(&before.camera)).length();
    assert!(moved > 0.05 * arm(&before.camera).length() && turned < 1e-4 * moved, "{moved} {turned}");
    assert_eq!(after.light, before.light);
}

/// A drag moves the light where that is ticked, and turns the camera where it is not.
#[gpu_test]
fn a_finger_moves_the_light_where_asked() {
    let mut window = Window::new(LINE);
    window.resize([620.0, 1400.0]);
    window.frame(vec![key(Key::H, true)]);
    window.frame(vec![key(Key::H, false)]);
    window.settle();
    for ticked in [false, true] {
        if ticked {
            window.click("drag the light");
        }
        let before = window.viewer.scene_now();
        window.drag(PointerButton::Primary, [0.2, 0.5], [0.3, 0.55]);
        let after = window.viewer.scene_now();
        assert_eq!([before.camera != after.camera, before.light != after.light], [!ticked, ticked]);
    }
}
