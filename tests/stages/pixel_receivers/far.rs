//! Planes far from the origin.

use super::*;

/// A plane a thousand units from the origin, along an axis: it stays exactly where it is.
pub fn case_far(random: &mut Random) -> (World, Case) {
    let world = world(gpu(), [12, 9], random);
    let mut case = Case::new(&world, random).by_position();
    let eye = world.view.rays.eye;
    for (pixel, p) in case.positions.iter_mut().enumerate() {
        let ray = world.view.rays.direction((pixel % 12) as f64 + 0.5, (pixel / 12) as f64 + 0.5);
        let at = eye + ray * (1000.0 / ray.dot(world.view.rays.forward));
        *p = at.as_vec3().extend(1.0).into();
    }
    case.normals = Some(vec![[0.0, 1.0, 0.0, 0.0]; case.positions.len()]);
    (world, case)
}

/// A plane across an axis keeps its coordinate to the last bit.
#[gpu_test]
fn planes_across_an_axis_are_exact() {
    let (world, mut case) = case_far(&mut Random::new(6));
    case.positions.iter_mut().for_each(|p| p[1] = 0.1);
    let forward = world.view.rays.forward;
    let got = ask(&world, &case);
    let mut planes = 0;
    for (pixel, p) in case.positions.iter().enumerate() {
        let ahead = (DVec3::new(p[0].into(), p[1].into(), p[2].into()) - world.view.rays.eye).dot(forward) > 0.0;
        if ahead {
            assert!((0..3).all(|k| got.positions[3 * pixel + k][1] == 0.1), "pixel {pixel}");
            planes += 1;
        }
    }
    assert!(planes > 50, "{planes} planes");
}
