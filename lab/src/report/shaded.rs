//! Simple shading, to look at shadows in their place.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use subpixel_shadows::scene::{Camera, Light, Mesh, PixelRays};

/// Inputs of shading.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    /// The mesh that `triangles` are indices of.
    pub mesh: &'a Mesh,
    /// The camera.
    pub camera: &'a Camera,
    /// The light; a spot light's cone shows here, and only here.
    pub light: &'a Light,
    /// Image width and height.
    pub size: [u32; 2],
    /// Triangle at each pixel centre; `u32::MAX` where there is none.
    pub triangles: &'a [u32],
    /// Visibility of each pixel.
    pub visibility: &'a [f32],
}

const SURFACE: Vec3 = Vec3::new(0.70, 0.67, 0.62);
const SUN: Vec3 = Vec3::new(0.95, 0.90, 0.80);
const SKY_LIGHT: Vec3 = Vec3::new(0.30, 0.36, 0.45);
const GROUND_LIGHT: Vec3 = Vec3::new(0.16, 0.15, 0.13);

/// Diffuse shading times visibility, plus light from the sky, as 8-bit sRGB, row 0 at the top. Pixels whose centre sees
/// nothing show a grey sky.
pub fn shade(s: &Shading) -> Vec<[u8; 3]> {
    let [w, h] = s.size;
    let rays = s.camera.rays(w, h);
    let corners = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < s.mesh.positions.len());
    (0..w.saturating_mul(h))
        .into_par_iter()
        .map(|pixel| {
            let p = pixel as usize;
            let linear = match (s.triangles.get(p), s.visibility.get(p)) {
                (Some(&t), Some(&v)) if s.mesh.triangles.get(t as usize).is_some_and(corners) => {
                    surface(s, &rays, pixel, t, v)
                }
                _ => sky((pixel / w) as f32 / h as f32),
            };
            linear.to_array().map(srgb)
        })
        .collect()
}

fn surface(s: &Shading, rays: &PixelRays, pixel: u32, triangle: u32, visibility: f32) -> Vec3 {
    let [w, _] = s.size;
    let [a, b, c] = s.mesh.corners(triangle as usize);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let r = rays.direction(f64::from(pixel % w) + 0.5, f64::from(pixel / w) + 0.5);
    let normal = if normal.dot(r) > 0.0 { -normal } else { normal };
    let along = normal.dot(r);
    let point = if along == 0.0 { a } else { rays.eye + r * (normal.dot(a - rays.eye) / along) };
    let to_light = s.light.towards(point).normalize_or_zero();
    let diffuse = (normal.dot(to_light).max(0.0) * cone(s.light, to_light)) as f32;
    let up = (0.5 + 0.5 * normal.y) as f32;
    SURFACE * (GROUND_LIGHT.lerp(SKY_LIGHT, up) + SUN * (diffuse * visibility))
}

/// The share of a spot light that goes in a direction: all inside the cone, none outside, with a soft rim.
fn cone(light: &Light, to_light: DVec3) -> f64 {
    let Light::Spot { position, target, angle_degrees } = *light else { return 1.0 };
    let axis = (Vec3::from(position) - Vec3::from(target)).as_dvec3().normalize_or_zero();
    let rim = (f64::from(angle_degrees).to_radians() * 0.5).cos();
    let t = ((axis.dot(to_light) - rim) / (0.1 * (1.0 - rim)).max(1e-9)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn sky(down: f32) -> Vec3 {
    Vec3::new(0.42, 0.47, 0.54).lerp(Vec3::new(0.70, 0.73, 0.76), down)
}

/// The sRGB encoding of a linear value.
fn srgb(linear: f32) -> u8 {
    let v = linear.clamp(0.0, 1.0);
    let encoded = if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use subpixel_shadows::scene::Lens;

    #[test]
    fn light_shadow_and_sky_differ() {
        let mesh =
            Mesh { positions: vec![[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [0.0, 0.0, 9.0]], triangles: vec![[0, 2, 1]] };
        let camera = Camera {
            eye: [0.0, 5.0, 0.1],
            target: [0.0, 0.0, 0.0],
            up: [0.0, 0.0, -1.0],
            vertical_fov_degrees: 30.0,
            near: 0.1,
            far: 100.0,
            lens: Lens::CENTRED,
            near_plane: None,
        };
        let shade = |light: Light, triangle: u32, visibility: f32| {
            let s = Shading {
                mesh: &mesh,
                camera: &camera,
                light: &light,
                size: [1, 1],
                triangles: &[triangle],
                visibility: &[visibility],
            };
            shade(&s)[0][1]
        };
        let above = Light::Directional { direction: [0.0, 1.0, 0.0] };
        let below = Light::Directional { direction: [0.0, -1.0, 0.0] };
        let (lit, half, dark) = (shade(above, 0, 1.0), shade(above, 0, 0.5), shade(above, 0, 0.0));
        assert!(lit > half && half > dark && dark > 0, "{lit} {half} {dark}");
        assert_eq!(shade(below, 0, 1.0), dark, "light from behind adds nothing");
        let aside = Light::Spot { position: [9.0, 3.0, 0.0], target: [9.0, 0.0, 0.0], angle_degrees: 20.0 };
        assert_eq!(shade(aside, 0, 1.0), dark, "outside the cone");
        assert_eq!(shade(above, u32::MAX, 1.0), shade(below, u32::MAX, 0.0));
    }

    #[test]
    fn srgb_ends() {
        assert_eq!([0.0, 1.0, 2.0, f32::NAN].map(srgb)[..3], [0, 255, 255]);
    }
}
