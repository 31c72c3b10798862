//! Proofs behind the [plan](super): certain facts of a scene, from its mesh, camera and light.
//!
//! They are made in `f64` with margins far above the rounding of the kernels: what is not certain is not claimed.

use crate::methods::prepared::{Counterexample, Prepared};
use crate::scene::mesh_tree::Which;
use crate::scene::{Camera, Light};
use glam::{DVec3, DVec4, Vec3};
use rayon::prelude::*;

/// Share of the sizes at hand that a proof must keep clear of: far above the rounding of `f32` kernels.
const CLEAR: f64 = 1e-5;

/// Why no pixel centre can see a surface, if that is certain.
pub fn nothing_seen(prepared: &Prepared, camera: &Camera, [width, height]: [u32; 2]) -> Option<String> {
    if prepared.mesh.triangles.is_empty() {
        return Some("the mesh has no triangles".to_owned());
    }
    let rays = camera.rays(width, height);
    // Inner normals of the four sides of the view; a point on the inner side of all of them may be seen.
    let [a, b, c, d] = rays.corners(width, height);
    let middle = rays.direction(f64::from(width) * 0.5, f64::from(height) * 0.5);
    let sides = [("above", a, b), ("to the right of", b, c), ("below", c, d), ("to the left of", d, a)];
    let planes = sides.map(|(name, p, q)| {
        let n = p.cross(q);
        (name, n * n.dot(middle).signum() / n.length())
    });
    let (lowest, highest) = prepared.tree().bounds()?;
    let size = (lowest - rays.eye).abs().max((highest - rays.eye).abs()).max_element();
    // How far the mesh reaches from the eye.
    let reach = |axis: DVec3| {
        let of_corners =
            |corners: [DVec3; 3]| corners.map(|p| (p - rays.eye).dot(axis)).into_iter().fold(f64::MIN, f64::max);
        let tree = prepared.tree();
        let greatest = tree.greatest(&prepared.mesh, Which::All, |b| b.reach(axis) - rays.eye.dot(axis), of_corners);
        greatest.map_or(f64::NEG_INFINITY, |(reach, _)| reach)
    };
    if reach(rays.forward) < f64::from(camera.near) - CLEAR * size {
        return Some("the whole mesh lies nearer than the near plane or behind the camera".to_owned());
    }
    let (name, _) = planes.into_iter().find(|(_, n)| reach(*n) < -CLEAR * size)?;
    Some(format!("the whole mesh lies {name} the view"))
}

/// Why it does not pay to ask the facets of an image which part of the light's view they need: so few triangles that it would take longer than to set them
/// all up, or half or more of the box `bounds` of the scene lies before the camera, by 64 points all over. It is no proof, and need be none: blocks that
/// are not requested change nothing.
pub fn asks_for_most(
    camera: &Camera,
    [width, height]: [u32; 2],
    (low, high): (DVec3, DVec3),
    triangles: usize,
) -> Option<String> {
    let pixels = width as usize * height as usize;
    if 2 * triangles < pixels {
        return Some(format!("{triangles} triangles are few beside {pixels} pixels"));
    }
    const SIDE: u32 = 4;
    let rays = camera.rays(width, height);
    let [a, b, c, d] = rays.corners(width, height);
    let sides = [(a, b), (b, c), (c, d), (d, a)].map(|(p, q)| p.cross(q) * p.cross(q).dot(a + c).signum());
    let share = |k: u32| (f64::from(k) + 0.5) / f64::from(SIDE);
    let point = |k: u32| DVec3::new(share(k % SIDE), share(k / SIDE % SIDE), share(k / SIDE / SIDE));
    let points = (0..SIDE.pow(3)).map(|k| low + (high - low) * point(k) - rays.eye);
    let seen = points.filter(|p| p.dot(rays.forward) > 0.0 && sides.iter().all(|n| n.dot(*p) >= 0.0)).count() as u32;
    let percent = 100 * seen / SIDE.pow(3);
    (percent >= 50).then(|| format!("the image holds {percent} % of the scene's box"))
}

/// Why no surface that is seen and faces the light can be in shadow, if that is certain. `only_seen`: no sample is evaluated off the
/// triangle that its pixel shows, where its plane may be behind others.
pub fn no_shadow(prepared: &Prepared, camera: &Camera, light: &Light, only_seen: bool) -> Option<String> {
    if in_one_plane(prepared) {
        return Some("all triangles lie in one plane: none shadows another".to_owned());
    }
    if nothing_faces_both(prepared, camera, light) {
        return Some("no triangle shows the camera the side it shows the light: all that is seen is dark".to_owned());
    }
    (only_seen && light_inside_one_closed_body(prepared, light))
        .then(|| "closed mesh around the light, no silhouette edge: each ray of light meets it once".to_owned())
}

/// Why every sample that sees a surface is lit, if that is certain.
pub fn all_is_lit(prepared: &Prepared, camera: &Camera, light: &Light) -> Option<String> {
    let lit = in_one_plane(prepared)
        && sides_of_eye_and_light(prepared, camera, light, &prepared.known.facing_one, |product| product > 0);
    lit.then(|| "all triangles lie in one plane and face the light: none shadows another".to_owned())
}

/// Whether all vertices lie in one plane, exactly; found once.
pub fn in_one_plane(prepared: &Prepared) -> bool {
    *prepared.known.in_one_plane.get_or_init(|| found_in_one_plane(prepared))
}

fn found_in_one_plane(prepared: &Prepared) -> bool {
    let mesh = &prepared.mesh;
    let area = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        (b - a).cross(c - a).length_squared()
    };
    let areas = (0..mesh.triangles.len()).into_par_iter().map(|t| (area(t), t));
    let Some((_, largest)) = areas.max_by(|s, t| s.0.total_cmp(&t.0).then(s.1.cmp(&t.1))) else { return true };
    let [a, b, c] = mesh.corners(largest);
    let normal = (b - a).cross(c - a);
    // Differences of f32 and their products round in f64 at 2^-53 each: what is off the plane by more is seen.
    let flat = 1.0 / (1u64 << 49) as f64 * (b - a).length() * (c - a).length();
    mesh.positions.par_iter().all(|p| {
        let from = Vec3::from(*p).as_dvec3() - a;
        normal.dot(from).abs() <= flat * from.length()
    })
}

/// Whether every triangle certainly shows the eye the side it hides from the light.
fn nothing_faces_both(prepared: &Prepared, camera: &Camera, light: &Light) -> bool {
    sides_of_eye_and_light(prepared, camera, light, &prepared.known.facing_both, |product| product < 0)
}

/// Whether the product of the sides on which eye and light lie, 0 where that is not certain, is as wanted for all triangles.
fn sides_of_eye_and_light(
    prepared: &Prepared,
    camera: &Camera,
    light: &Light,
    known: &Counterexample,
    wanted: fn(i32) -> bool,
) -> bool {
    // Relative to the eye, as the kernels see it.
    let (eye, l) = (Vec3::from(camera.eye).as_dvec3(), light.homogeneous());
    let light = (l.truncate() - eye * l.w).extend(l.w);
    let mesh = &prepared.mesh;
    known.all(mesh.triangles.len(), |t| {
        let corners = mesh.corners(t).map(|p| p - eye);
        wanted(side(corners, DVec4::W) * side(corners, light))
    })
}

/// The side of a triangle that a homogeneous point lies on: 1, -1, or 0 where that is not certain.
fn side([a, b, c]: [DVec3; 3], point: DVec4) -> i32 {
    let (ab, ac, to) = (b - a, c - a, point.truncate() - a * point.w);
    let value = ab.cross(ac).dot(to);
    // Products round, and so do the vertices, at the scale of the largest of them.
    let reach = a.length().max(b.length()).max(c.length());
    let size = ab.length() * ac.length() + 0.25 * reach * (ab.length() + ac.length());
    let bound = CLEAR * size * (to.length() + reach * point.w);
    if value > bound {
        1
    } else if value < -bound {
        -1
    } else {
        0
    }
}

/// Whether each ray from the light meets the mesh exactly once: every triangle certainly shows the light its back, and
/// all of them together fill its view once.
fn light_inside_one_closed_body(prepared: &Prepared, light: &Light) -> bool {
    if !prepared.closed || light.is_directional() {
        return false;
    }
    let (mesh, at) = (&prepared.mesh, light.homogeneous());
    let all_back = prepared.known.facing_light.all(mesh.triangles.len(), |t| side(mesh.corners(t), at) == -1);
    // A closed mesh fills the view as often as it runs around the light.
    all_back && prepared.bodies_around(light) == Some(1)
}

/// Why casters of closed bodies that face away from the light add no shadow, if that is certain: every segment towards the light
/// that crosses such a body leaves it, through a face turned to the light.
pub fn back_faces_add_nothing(prepared: &Prepared, light: &Light) -> Option<String> {
    let (of_bodies, all) = (prepared.bodies.iter().filter(|b| **b).count(), prepared.bodies.len());
    if !prepared.backs_add_nothing(light) {
        return None;
    }
    Some(match prepared.closed {
        true => "closed mesh, light outside: faces turned to the light cast it all".to_owned(),
        false => {
            let share = (100.0 * of_bodies as f64 / all as f64).floor();
            format!(
                "closed bodies ({share} % of the triangles), light outside: their faces turned to the light cast it all"
            )
        }
    })
}
