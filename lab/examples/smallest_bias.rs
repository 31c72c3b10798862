//! The smallest constant bias at which a bare plane has no acne, by its tilt, for `spsm` in both encodings and for `shadow-map`,
//! as a table: `cargo run --release --example smallest_bias -- [MAP_SIZE …]`
//!
//! A square of half width 1.5 is tilted from the light's direction; small triangles aside hold the light view's extent at
//! 6 x 6 and its depth at 4.4 whatever the tilt. The camera looks along the normal. Of two tessellations the worse counts.

use std::collections::HashMap;
use subpixel_shadows::glam::{DQuat, DVec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::methods::{MethodName, Prepared, Settings, ShadowMapSettings, SpsmEncoding, SpsmSettings};
use subpixel_shadows::render::{Budget, Renderer};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};
use subpixel_shadows::{Error, Result};

const SIZE: [u32; 2] = [320, 240];
const TILTS: [f64; 11] = [0.0, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 87.0, 88.0, 89.0];
const CELLS: [u32; 2] = [6, 200];

/// What is given a bias.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Variant {
    Paper,
    Lines,
    /// `shadow-map` without a slope-scaled bias.
    Constant,
    /// `shadow-map` with that of its default, 1.05 slopes a texel.
    Sloped,
}

const VARIANTS: [(Variant, &str); 4] = [
    (Variant::Paper, "spsm paper"),
    (Variant::Lines, "spsm lines"),
    (Variant::Constant, "shadow-map, no slope"),
    (Variant::Sloped, "shadow-map, slope 1.05"),
];

impl Variant {
    fn settings(self, map: u32, bias: f64) -> Result<(MethodName, Settings)> {
        let plain = Settings::new(SIZE, map, Samples::new(Pattern::default(), 8)?);
        let spsm = |encoding| SpsmSettings { encoding, bias: bias as f32, ..SpsmSettings::default() };
        let mapped = |slope| ShadowMapSettings { constant: bias as f32, slope, ..ShadowMapSettings::default() };
        let with_map = |slope| (MethodName::ShadowMap, Settings { shadow_map: mapped(slope), ..plain.clone() });
        let with_spsm = |encoding| (MethodName::Spsm, Settings { spsm: spsm(encoding), ..plain.clone() });
        Ok(match self {
            Self::Paper => with_spsm(SpsmEncoding::Paper),
            Self::Lines => with_spsm(SpsmEncoding::Lines),
            Self::Constant => with_map(0.0),
            Self::Sloped => with_map(ShadowMapSettings::default().slope),
        })
    }
}

/// A tilted plane with its camera.
struct Plane {
    prepared: Prepared,
    camera: Camera,
    /// Whether a triangle is of the plane.
    own: Vec<bool>,
}

impl Plane {
    fn new(tilt: f64, cells: u32) -> Result<Self> {
        let axis = DVec3::new(25f64.to_radians().cos(), 0.0, 25f64.to_radians().sin());
        let turn = DQuat::from_axis_angle(axis, tilt.to_radians());
        let mut mesh = Mesh::default();
        let at = |k: u32| 1.5 * (2.0 * f64::from(k) / f64::from(cells) - 1.0);
        for j in 0..=cells {
            for i in 0..=cells {
                mesh.positions.push((turn * DVec3::new(at(i), 0.0, at(j))).as_vec3().into());
            }
        }
        for j in 0..cells {
            for i in 0..cells {
                let a = i + j * (cells + 1);
                mesh.triangles.extend([[a, a + cells + 1, a + 1], [a + 1, a + cells + 1, a + cells + 2]]);
            }
        }
        for side in [-1.0, 1.0f32] {
            let first = mesh.positions.len() as u32;
            let corner = |x: f32, y: f32, z: f32| [side * x, side * y, side * z];
            mesh.positions.extend([corner(3.0, 2.2, 3.0), corner(2.9, 2.15, 3.0), corner(3.0, 2.1, 2.9)]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        let prepared = Prepared::new(&mesh)?;
        let inside = |t: usize| prepared.mesh().corners(t).iter().all(|p| p.length() < 2.5);
        let own = (0..prepared.mesh().triangles.len()).map(inside).collect();
        let camera = Camera {
            eye: (turn * DVec3::Y * 6.0).as_vec3().into(),
            target: [0.0; 3],
            up: axis.as_vec3().into(),
            vertical_fov_degrees: 40.0,
            near: 0.1,
            far: 100.0,
            lens: Lens::CENTRED,
            near_plane: None,
        };
        Ok(Self { prepared, camera, own })
    }

    /// Pixels of the plane that are not wholly lit.
    fn acne(&self, gpu: &Gpu, variant: Variant, map: u32, bias: f64) -> Result<usize> {
        let (method, settings) = variant.settings(map, bias)?;
        let mut renderer = Renderer::of_method(gpu, &self.prepared, method, &settings, Budget::default())?;
        let got = renderer.render(&self.camera, &Light::Directional { direction: [0.0, 1.0, 0.0] })?;
        let of_plane = |t: u32| self.own.get(t as usize) == Some(&true);
        let pixels = || got.triangles.iter().zip(&got.visibility).filter(|(t, _)| of_plane(**t));
        if pixels().count() < SIZE[0] as usize * SIZE[1] as usize / 4 {
            return Err(Error::Config("the plane is not in view".to_owned()));
        }
        Ok(pixels().filter(|(_, v)| **v < 1.0).count())
    }

    /// The smallest bias without acne, to a twentieth of itself from above; `None` if there is none up to 1.
    fn smallest(&self, gpu: &Gpu, variant: Variant, map: u32) -> Result<Option<f64>> {
        if self.acne(gpu, variant, map, 0.0)? == 0 {
            return Ok(Some(0.0));
        }
        if self.acne(gpu, variant, map, 1.0)? != 0 {
            return Ok(None);
        }
        let (mut low, mut high) = (1e-8f64, 1.0);
        while high > 1.05 * low {
            let middle = (low * high).sqrt();
            if self.acne(gpu, variant, map, middle)? == 0 { high = middle } else { low = middle }
        }
        Ok(Some(high))
    }
}

fn main() -> Result<()> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let number = |text: &String| text.parse::<u32>().map_err(|e| Error::Config(format!("'{text}': {e}")));
    let mut maps = given.iter().map(number).collect::<Result<Vec<_>>>()?;
    if maps.is_empty() {
        maps = vec![512, 2048];
    }
    let gpu = Gpu::open(None)?;
    println!("adapter: {}, {} x {} pixels, 8 samples a pixel\n", gpu.adapter.name, SIZE[0], SIZE[1]);
    let columns: Vec<(u32, Variant, &str)> =
        maps.iter().flat_map(|&map| VARIANTS.iter().map(move |&(v, name)| (map, v, name))).collect();
    let heads: Vec<String> = columns.iter().map(|(map, _, name)| format!("{name}, {map}")).collect();
    println!("| degrees | {} |", heads.join(" | "));
    println!("|---|{}", "---|".repeat(heads.len()));
    let mut worst: HashMap<(u32, Variant), f64> = HashMap::new();
    for tilt in TILTS {
        let planes = CELLS.iter().map(|&cells| Plane::new(tilt, cells)).collect::<Result<Vec<_>>>()?;
        let mut cells = Vec::new();
        for &(map, variant, _) in &columns {
            let mut most = Some(0.0);
            for plane in &planes {
                let bias = plane.smallest(&gpu, variant, map)?;
                most = most.zip(bias).map(|(a, b)| f64::max(a, b));
            }
            let all = worst.entry((map, variant)).or_default();
            *all = all.max(most.unwrap_or(f64::INFINITY));
            cells.push(most.map_or("none".to_owned(), text));
        }
        println!("| {tilt} | {} |", cells.join(" | "));
    }
    let all: Vec<String> = columns.iter().map(|(map, v, _)| text(worst[&(*map, *v)])).collect();
    println!("| all | {} |", all.join(" | "));
    Ok(())
}

fn text(bias: f64) -> String {
    if bias == 0.0 { "0".to_owned() } else { format!("{bias:.1e}") }
}
