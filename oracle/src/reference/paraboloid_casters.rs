//! The nearest caster at every texel centre of a paraboloid view of the light: the ray of the centre against every triangle.

use super::view::{View, centre};
use glam::DVec3;
use rayon::prelude::*;

/// A texel of a paraboloid view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurvedTexel {
    /// Depth of the nearest caster.
    pub nearest: Option<f64>,
    /// Cosine of the angle between its ray and that caster's normal.
    pub cosine: f64,
    /// An edge passes the centre within what rounding moves it, or a triangle is seen edge-on.
    pub open: bool,
}

/// Rounding of a point, of the unit cube.
const ROUNDING: f64 = 5e-7;

/// The texels, row by row. `triangles`: corners of the casters, points of the frame; `None` for one that casts nothing.
pub fn texels(view: &View, triangles: &[Option<[DVec3; 3]>]) -> Vec<CurvedTexel> {
    let size = view.map.map_size;
    let light = view.light.truncate();
    let from_light: Vec<[DVec3; 3]> = triangles.iter().flatten().map(|corners| corners.map(|p| p - light)).collect();
    let place = |k: u32| view.map.ray_of_texel(centre(k % size, k / size)).normalize();
    (0..size * size).into_par_iter().map(|k| texel(view, &from_light, place(k))).collect()
}

/// The nearest meeting of a ray of length 1 from the light with a triangle.
fn texel(view: &View, triangles: &[[DVec3; 3]], ray: DVec3) -> CurvedTexel {
    let mut texel = CurvedTexel::default();
    for corners in triangles {
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a);
        let (height, over) = (normal.dot(a), normal.dot(ray));
        let turn = height.signum();
        let nearest = corners.iter().map(|p| p.length()).fold(f64::INFINITY, f64::min);
        // Angles between the ray and the planes through the light and an edge; above 0 inside.
        let angle = |(a, b): (DVec3, DVec3)| turn * a.cross(b).normalize_or_zero().dot(ray);
        let inside = [(a, b), (b, c), (c, a)].map(angle).into_iter().fold(f64::INFINITY, f64::min);
        let noise = ROUNDING * (1.0 + 1.0 / nearest.max(1e-9));
        let flat = height.abs() <= noise * 4.0 * normal.length() || normal.length() <= noise * 4.0 * (b - a).length();
        if flat {
            texel.open |= inside.abs() < 64.0 * noise || beside(corners, ray, 64.0 * noise);
            continue;
        }
        if turn * over <= 0.0 {
            continue;
        }
        texel.open |= inside.abs() <= noise;
        let apart = (height / over).min(corners.iter().map(|p| p.length()).fold(0.0, f64::max));
        let depth = apart * view.map.z.w;
        if inside >= 0.0 && texel.nearest.is_none_or(|nearest| depth < nearest) {
            texel.nearest = Some(depth);
            texel.cosine = over.abs() / normal.length();
        }
    }
    texel
}

/// Whether a ray passes near a triangle that is seen edge-on.
fn beside(corners: &[DVec3; 3], ray: DVec3, within: f64) -> bool {
    let [a, b, c] = corners.map(DVec3::normalize_or_zero);
    [(a, b), (b, c), (c, a)].into_iter().any(|(a, b)| {
        let along = b - a;
        let share = ((ray - a).dot(along) / along.length_squared().max(1e-300)).clamp(0.0, 1.0);
        (a + along * share).normalize_or_zero().distance(ray) <= within + 0.5 * along.length_squared()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::light_view::LightView;
    use subpixel_shadows::scene::{Camera, Light, Mesh};

    /// A square overhead, as large as the sky within 45 degrees of its middle along either axis: the rays that meet it.
    #[test]
    fn a_square_covers_its_rays() {
        let corners = [[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
        let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] };
        let light = Light::Point { position: [0.0; 3] };
        let bounds = (DVec3::splat(-1.0), DVec3::ONE);
        let camera = Camera::look_at([0.0, -2.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0], 60.0, 0.1);
        let mut covered = 0;
        for map in LightView::paraboloids(bounds, &light, 64, false).unwrap() {
            let view = View::new(&camera, &light, &map, bounds, [4, 4], false);
            let triangles: Vec<_> =
                mesh.triangles.iter().map(|t| Some(t.map(|v| view.point(mesh.positions[v as usize])))).collect();
            for (k, texel) in (0..).zip(texels(&view, &triangles)) {
                let ray = view.map.ray_of_texel(centre(k % 64, k / 64)).normalize();
                let meets = ray.y > 0.0 && ray.x.abs().max(ray.z.abs()) < ray.y;
                assert!(texel.open || texel.nearest.is_some() == meets, "{texel:?} along {ray}");
                if let Some(depth) = texel.nearest {
                    assert!((depth * 3f64.sqrt() * ray.y - 1.0).abs() < 1e-9, "{depth} along {ray}");
                    covered += 1;
                }
            }
        }
        assert!(covered > 500, "{covered}");
    }
}
