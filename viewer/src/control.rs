//! Cameras and lights moved by hand.

use glam::{Quat, Vec3};
use lab::scene::{Camera, Light};
use subpixel_shadows::methods::Prepared;

/// Extent of a scene, which moves are measured by.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    centre: Vec3,
    radius: f32,
}

impl Extent {
    /// That of a mesh.
    pub fn of(mesh: &Prepared) -> Self {
        let [low, high] = mesh.bounds().unwrap_or_default();
        Self { centre: ((low + high) * 0.5).as_vec3(), radius: ((high - low).length() * 0.5).max(1e-30) as f32 }
    }
}

/// The camera's axes: to the right, up in the image, along the view.
fn axes(camera: &Camera) -> [Vec3; 3] {
    let forward = (Vec3::from(camera.target) - Vec3::from(camera.eye)).normalize_or(Vec3::NEG_Z);
    let right = forward.cross(camera.up.into()).normalize_or(Vec3::X);
    [right, right.cross(forward), forward]
}

/// A camera that can be used, or else the one of before. What lies far off stays within its depth range.
fn kept(camera: Camera, before: &Camera, extent: Extent) -> Camera {
    let distance = (Vec3::from(camera.eye) - extent.centre).length();
    let camera = Camera { far: (extent.radius + distance) * 100.0, ..camera };
    if camera.check().is_ok() { camera } else { *before }
}

/// Turns the eye around the target: by `x` radians around the up direction, by `y` over it.
pub fn orbit(camera: &Camera, extent: Extent, x: f32, y: f32) -> Camera {
    let [right, ..] = axes(camera);
    let (target, up) = (Vec3::from(camera.target), Vec3::from(camera.up).normalize_or(Vec3::Y));
    let arm = Vec3::from(camera.eye) - target;
    // Short of straight above and below, where there is no up.
    let elevation = up.dot(arm.normalize_or_zero()).clamp(-1.0, 1.0).asin();
    let most = 1.55;
    let y = (elevation + y).clamp(-most, most) - elevation;
    let arm = Quat::from_axis_angle(up, -x) * (Quat::from_axis_angle(right, -y) * arm);
    kept(Camera { eye: (target + arm).into(), ..*camera }, camera, extent)
}

/// Moves eye and target in the image's plane: `x` to the right and `y` up, of the image's height at the target.
pub fn pan(camera: &Camera, extent: Extent, x: f32, y: f32) -> Camera {
    let [right, up, _] = axes(camera);
    let distance = (Vec3::from(camera.eye) - Vec3::from(camera.target)).length();
    let height = 2.0 * distance * (camera.vertical_fov_degrees.to_radians() * 0.5).tan();
    moved(camera, extent, (right * x + up * y) * height)
}

/// Moves eye and target along the axes: to the right, up and along the view, in radii of the scene.
pub fn fly(camera: &Camera, extent: Extent, by: Vec3) -> Camera {
    let [right, up, forward] = axes(camera);
    moved(camera, extent, (right * by.x + up * by.y + forward * by.z) * extent.radius)
}

fn moved(camera: &Camera, extent: Extent, by: Vec3) -> Camera {
    let at = |place: [f32; 3]| (Vec3::from(place) + by).into();
    kept(Camera { eye: at(camera.eye), target: at(camera.target), ..*camera }, camera, extent)
}

/// Brings the eye nearer to the target by a factor.
pub fn zoom(camera: &Camera, extent: Extent, factor: f32) -> Camera {
    let target = Vec3::from(camera.target);
    let arm = (Vec3::from(camera.eye) - target) / factor.clamp(0.1, 10.0);
    // Not so near that steps are lost in rounding.
    if arm.length() < extent.radius * 1e-3 {
        return *camera;
    }
    kept(Camera { eye: (target + arm).into(), ..*camera }, camera, extent)
}

/// Turns a directional light, by `x` radians around the camera's up direction and by `y` over it; moves another in the image's plane, by so
/// many radii of the scene.
pub fn turn_light(light: &Light, camera: &Camera, extent: Extent, x: f32, y: f32) -> Light {
    let [right, up, _] = axes(camera);
    let moved = |place: [f32; 3]| (Vec3::from(place) + (right * x + up * y) * extent.radius).into();
    let turned = match *light {
        Light::Directional { direction } => {
            let around = Vec3::from(camera.up).normalize_or(Vec3::Y);
            let direction =
                Quat::from_axis_angle(around, x) * (Quat::from_axis_angle(right, -y) * Vec3::from(direction));
            Light::Directional { direction: direction.normalize_or(around).into() }
        }
        Light::Point { position } => Light::Point { position: moved(position) },
        Light::Spot { position, target, angle_degrees } => {
            Light::Spot { position: moved(position), target, angle_degrees }
        }
    };
    if turned.check().is_ok() { turned } else { *light }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lab::scene::Scene;

    fn scene() -> (Camera, Light, Extent) {
        let scene = Scene::open("spheres", &Default::default()).unwrap();
        (scene.camera, scene.light, Extent::of(&scene.prepared().unwrap()))
    }

    fn distance(camera: &Camera) -> f32 {
        (Vec3::from(camera.eye) - Vec3::from(camera.target)).length()
    }

    #[test]
    fn an_orbit_keeps_the_distance_and_comes_back() {
        let (camera, _, extent) = scene();
        let there = orbit(&camera, extent, 0.7, 0.2);
        assert!((distance(&there) / distance(&camera) - 1.0).abs() < 1e-5);
        assert!((Vec3::from(there.eye) - Vec3::from(camera.eye)).length() > 0.1 * distance(&camera));
        let back = orbit(&orbit(&there, extent, -0.7, 0.0), extent, 0.0, -0.2);
        assert!((Vec3::from(back.eye) - Vec3::from(camera.eye)).length() < 1e-4 * distance(&camera));
    }

    /// Camera and light can be used after any drag.
    #[test]
    fn every_move_gives_a_camera_and_a_light() {
        let (mut camera, mut light, extent) = scene();
        for step in 0..2000 {
            let [x, y] = [(step * 37 % 101) as f32 / 10.0 - 5.0, (step * 53 % 97) as f32 / 10.0 - 4.8];
            camera = match step % 4 {
                0 => orbit(&camera, extent, x, y),
                1 => pan(&camera, extent, x * 0.1, y * 0.1),
                2 => zoom(&camera, extent, 1.0 + 0.1 * x),
                _ => fly(&camera, extent, Vec3::new(x, y, -x) * 0.01),
            };
            light = turn_light(&light, &camera, extent, x, y);
            camera.check().unwrap();
            light.check().unwrap();
        }
        let (camera, ..) = scene();
        let above = orbit(&camera, extent, 0.0, 100.0);
        assert!(above.check().is_ok() && above.eye[1] > camera.eye[1], "{above:?}");
    }

    #[test]
    fn a_zoom_comes_nearer_and_stops() {
        let (mut camera, _, extent) = scene();
        assert!(distance(&zoom(&camera, extent, 2.0)) < 0.6 * distance(&camera));
        for _ in 0..100 {
            camera = zoom(&camera, extent, 2.0);
        }
        assert!(distance(&camera) > 0.0 && camera.check().is_ok());
    }
}
