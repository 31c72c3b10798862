//! Cameras and lights for a mesh: outside, inside, on it, in the planes of its faces.

use super::random::Random;
use crate::scene::CameraOverride;
use glam::{DVec3, Vec3};
use subpixel_shadows::scene::{Light, Mesh};

/// Where a mesh is, as cameras and lights need it.
struct Stand<'a> {
    mesh: &'a Mesh,
    low: DVec3,
    high: DVec3,
    radius: f64,
}

/// A place on a triangle with its normal (of length 1, or 0 where the triangle has no area) and a direction along it.
struct Spot {
    at: DVec3,
    normal: DVec3,
    along: DVec3,
}

impl<'a> Stand<'a> {
    fn of(mesh: &'a Mesh) -> Self {
        let (low, high) = mesh.bounds().unwrap_or((DVec3::NEG_ONE, DVec3::ONE));
        let radius = ((high - low).length() * 0.5).max(low.abs().max(high.abs()).max_element() * 1e-5).max(1e-12);
        Self { mesh, low, high, radius }
    }

    fn centre(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }

    fn inside(&self, r: &mut Random) -> DVec3 {
        self.low + (self.high - self.low) * r.point()
    }

    fn spot(&self, r: &mut Random) -> Spot {
        let count = self.mesh.triangles.len();
        if count == 0 {
            return Spot { at: self.centre(), normal: DVec3::Y, along: DVec3::X };
        }
        let [a, b, c] = self.mesh.corners(r.whole(0, count as u32 - 1) as usize);
        let [mut s, mut t] = [r.unit(), r.unit()];
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        let along = if r.chance(0.5) { b - a } else { c - a };
        Spot { at: a + (b - a) * s + (c - a) * t, normal: (b - a).cross(c - a).normalize_or_zero(), along }
    }
}

/// A camera that sees something of the mesh, mostly.
pub fn camera(r: &mut Random, mesh: &Mesh) -> CameraOverride {
    let stand = Stand::of(mesh);
    let spot = stand.spot(r);
    let aim = match r.whole(0, 3) {
        0 => stand.centre(),
        1 => stand.inside(r),
        _ => spot.at,
    };
    let mut fov = r.between(20.0, 90.0);
    let (eye, target) = match r.whole(0, 19) {
        0..=8 => (stand.centre() + r.direction() * (stand.radius * r.between(1.05, 4.0)), aim),
        9..=11 => (stand.inside(r), aim),
        // Just off a surface: what is beside it crosses the near plane.
        12..=14 => {
            let other = stand.spot(r);
            (other.at + other.normal * (stand.radius * r.by_size(1e-6, 0.3)), aim)
        }
        // In the plane of a face, or nearly.
        15 | 16 => {
            let away = spot.along.normalize_or(DVec3::X) * (stand.radius * r.by_size(0.02, 3.0));
            (spot.at + away + spot.normal * (stand.radius * r.pick([0.0, 1e-7, 1e-4, 1e-2])), spot.at)
        }
        17 => {
            let corner = stand.spot(r);
            (corner.at + r.vector() * (stand.radius * r.by_size(1e-4, 0.1)), aim)
        }
        18 => {
            fov = r.between(90.0, 150.0);
            (stand.inside(r), stand.inside(r))
        }
        _ => {
            let far = r.by_size(5.0, 500.0);
            fov = (2.0 * (1.0 / far).atan()).to_degrees() * r.between(0.5, 1.5);
            (stand.centre() + r.direction() * (stand.radius * far), aim)
        }
    };
    let camera = usable(r, &stand, eye, target, fov);
    if r.chance(0.75) { camera } else { CameraOverride { mirrored: Some(r.chance(0.5)), ..through_lens(r, camera) } }
}

/// The camera jittered by less than a pixel of most images, off-centre, or with oblong pixels.
fn through_lens(r: &mut Random, camera: CameraOverride) -> CameraOverride {
    let shift = [0, 1].map(|_| r.between(-1.0, 1.0));
    let by = |size: f64| CameraOverride { shift: Some(shift.map(|c| (c * size) as f32)), ..camera };
    match r.whole(0, 4) {
        0 => by(0.02),
        1 => by(0.5),
        2 => by(3.0),
        3 => CameraOverride { near_plane: near_plane(r, &camera), ..camera },
        _ => CameraOverride { pixel_aspect: Some(r.by_size(0.1, 10.0) as f32), ..camera },
    }
}

/// An oblique near plane that faces away from the eye.
fn near_plane(r: &mut Random, camera: &CameraOverride) -> Option<[f32; 4]> {
    let [eye, target] = [camera.eye?, camera.target?].map(|p| Vec3::from(p).as_dvec3());
    let normal = ((target - eye).normalize_or(DVec3::X) + r.vector() * r.by_size(1e-3, 2.0)).normalize_or(DVec3::Y);
    let distance = (target - eye).length() * r.by_size(0.1, 1.5);
    let plane = normal.extend(-normal.dot(eye) - distance).as_vec4();
    // Rounding may have brought it to the eye.
    let hidden = -(plane.truncate().as_dvec3().dot(eye) + f64::from(plane.w));
    (hidden > 0.0).then(|| plane.into())
}

/// A camera of these numbers that passes its checks: eye and target apart in `f32`, up not along the view.
fn usable(r: &mut Random, stand: &Stand, eye: DVec3, target: DVec3, fov: f64) -> CameraOverride {
    let eye = eye.as_vec3();
    let mut target = target.as_vec3();
    let least = eye.abs().max_element().max(1e-12) * 1e-5;
    if (target - eye).length() < least {
        target = eye + r.direction().as_vec3() * least.max(stand.radius as f32);
    }
    let view = (target - eye).as_dvec3().normalize_or(DVec3::X);
    let mut up = if r.chance(0.7) { DVec3::Y } else { r.direction() };
    if view.cross(up).length() < 1e-2 {
        up = if view.z.abs() > 0.7 { DVec3::X } else { DVec3::Z };
    }
    CameraOverride {
        eye: Some(eye.into()),
        target: Some(target.into()),
        up: Some(up.as_vec3().into()),
        fov: Some(fov.clamp(0.05, 170.0) as f32),
        ..CameraOverride::default()
    }
}

/// A light of any kind and anywhere; `outside`: where one view holds all casters, mostly.
pub fn light(r: &mut Random, mesh: &Mesh, eye: [f32; 3], outside: bool) -> Light {
    let stand = Stand::of(mesh);
    let spot = stand.spot(r);
    let f32s = |v: DVec3| <[f32; 3]>::from(v.as_vec3());
    let kind = r.whole(0, if outside { 11 } else { 21 });
    let direction = match kind {
        0..=4 => {
            let d = r.direction();
            Some(if r.chance(0.7) { DVec3::new(d.x, d.y.abs(), d.z) } else { d })
        }
        // Along a face, exactly where its corners allow that, or by a hair off it.
        5 => Some(spot.along),
        6 => Some(spot.along + spot.normal * spot.along.length() * r.by_size(1e-16, 1e-5)),
        7 => {
            let [x, z] = [r.between(-1.0, 1.0), r.between(-1.0, 1.0)];
            let hair = r.by_size(1e-16, 1e-3) * r.pick([1.0, 1.0, -1.0, 0.0]);
            Some(r.pick([DVec3::new(x, hair, z), DVec3::new(hair, x, z), DVec3::new(x, z, hair)]))
        }
        8 => Some(r.pick([DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_Y, DVec3::new(1.0, 1.0, 0.0)])),
        _ => None,
    };
    if let Some(direction) = direction.filter(|d| f32s(*d) != [0.0; 3]) {
        return Light::Directional { direction: f32s(direction) };
    }
    let position = match kind {
        0..=11 => stand.centre() + r.direction() * (stand.radius * r.between(1.1, 6.0)),
        12..=15 => stand.inside(r),
        16 | 17 => spot.at + spot.normal * (stand.radius * r.by_size(1e-6, 0.1)),
        18 | 20 => spot.at + spot.along * r.pick([1.5, -1.5, 3.0]),
        19 => DVec3::from(eye.map(f64::from)) + r.vector() * (stand.radius * r.pick([0.0, 1e-3, 0.1])),
        _ => {
            let at = Vec3::from(mesh.positions.first().copied().unwrap_or_default());
            at.as_dvec3() + DVec3::Y * stand.radius * r.pick([1e-4, 1e-3, 1.0])
        }
    };
    let position = f32s(position);
    let target = f32s(stand.inside(r));
    if r.chance(0.3) && target != position {
        return Light::Spot { position, target, angle_degrees: r.between(5.0, 170.0) as f32 };
    }
    Light::Point { position }
}
