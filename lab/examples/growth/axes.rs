//! Scenes in which one thing grows.

use glam::{DVec3, Vec3};
use lab::scene::{Scene, SceneOptions, builtin};
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};
use subpixel_shadows::{Error, Result};

/// A frame to be measured: what it shows is made when its turn comes.
pub struct Point {
    /// Value along the axis, or the number of the point.
    pub x: f64,
    /// The value in words.
    pub label: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Texels a side.
    pub map: u32,
    /// Samples a pixel.
    pub samples: u32,
    scene: Box<dyn Fn() -> Result<Scene>>,
}

impl Point {
    /// The scene.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn scene(&self) -> Result<Scene> {
        (self.scene)()
    }
}

/// Frames that differ in one thing.
pub struct Axis {
    /// Name, as `--axes` takes it.
    pub name: &'static str,
    /// Unit of the value.
    pub unit: &'static str,
    /// Everything else, which stays.
    pub held: &'static str,
    /// Whether a slope says something.
    pub sloped: bool,
    /// The frames.
    pub points: Vec<Point>,
}

/// Sizes of what is measured.
#[derive(Clone, Copy)]
pub struct Sizes {
    image: [u32; 2],
    /// Powers of two that every axis is longer by than the shortest.
    steps: u32,
}

impl Sizes {
    /// The whole page, or a small one.
    pub fn new(quick: bool) -> Self {
        if quick { Self { image: [160, 120], steps: 3 } } else { Self { image: [400, 300], steps: 6 } }
    }

    fn point(self, x: f64, label: String, scene: impl Fn() -> Result<Scene> + 'static) -> Point {
        Point { x, label, size: self.image, map: 512, samples: 32, scene: Box::new(scene) }
    }

    fn built_in(self, name: &'static str, x: f64, label: String) -> Point {
        self.point(x, label, move || builtin(name).ok_or_else(|| Error::Config(format!("no scene '{name}'"))))
    }
}

/// All axes; the last has the `files`, and views from within.
pub fn axes(sizes: Sizes, files: &[String]) -> Vec<Axis> {
    let steps = 0..sizes.steps;
    let few = steps.clone().map(|k| if sizes.steps > 3 { k } else { 2 * k });
    let samples = [1, 8, 16, 32, 64, 128].into_iter().filter(|n| sizes.steps > 3 || [1, 8, 32].contains(n));
    let samples = samples.map(|n| Point { samples: n, ..sizes.built_in("windmill", f64::from(n), n.to_string()) });
    let cuts: &[u32] = if sizes.steps > 3 { &[5, 10, 20, 45, 100] } else { &[5, 10, 20] };
    let triangles = cuts.iter().map(|&cut| {
        let count = posts(40, 1).triangles.len() * (cut * cut) as usize;
        sizes.point(count as f64, count.to_string(), move || scene_of("posts", posts(40, cut), 40.0))
    });
    let silhouettes = few.clone().map(|k| {
        let count = 10 * 4u32.pow(k);
        sizes.point(f64::from(count), count.to_string(), move || scene_of("posts", posts(count, 1), 40.0))
    });
    let pixels: &[[u32; 2]] = &[[200, 150], [400, 300], [800, 600], [1600, 1200], [3840, 2160]];
    let pixels = pixels[..if sizes.steps > 3 { 5 } else { 3 }].iter().map(|&[w, h]| {
        let point = sizes.built_in("windmill", f64::from(w) * f64::from(h), format!("{w} x {h}"));
        Point { size: [w, h], ..point }
    });
    let maps = steps.clone().map(|k| {
        let map = 128 << k;
        Point { map, ..sizes.built_in("windmill", f64::from(map), map.to_string()) }
    });
    let heights = [64.0, 32.0, 16.0, 8.0, 4.0, 2.0].into_iter().take(sizes.steps as usize).map(|degrees: f64| {
        let length = 1.0 / degrees.to_radians().tan();
        sizes.point(length, format!("{degrees}°"), move || scene_of("posts", posts(40, 1), degrees))
    });
    let depths = few.map(|k| {
        let count = 2 << k;
        sizes.point(f64::from(count), count.to_string(), move || scene_of("sheets", sheets(count), 40.0))
    });
    let city = |x: f64, label: &str, camera: Option<Camera>| {
        sizes.point(x, label.to_owned(), move || {
            let scene = builtin("city").ok_or_else(|| Error::Config("no scene 'city'".to_owned()))?;
            Ok(Scene { camera: camera.unwrap_or(scene.camera), ..scene })
        })
    };
    let street = Camera {
        eye: [43.5, 2.0, 200.0],
        target: [43.5, 8.0, -200.0],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 60.0,
        near: 0.05,
        far: 1e4,
        lens: Lens::CENTRED,
        near_plane: None,
    };
    let mut views = vec![city(1.0, "`city` from above", None), city(2.0, "`city` from the street", Some(street))];
    views.extend(files.iter().zip(3u8..).map(|(file, x)| {
        let path = file.clone();
        let name = path.rsplit('/').next().unwrap_or(&path).to_owned();
        sizes.point(f64::from(x), format!("`{name}`"), move || {
            Scene::open(&path, &SceneOptions { ground: !path.ends_with(".toml"), ..SceneOptions::default() })
        })
    }));
    let axis = |name, unit, held, points: Vec<Point>| Axis { name, unit, held, sloped: name != "views", points };
    vec![
        axis("samples", "samples a pixel", "`windmill`", samples.collect()),
        axis(
            "triangles",
            "triangles",
            "40 posts on a ground, their faces cut ever finer: the same silhouettes",
            triangles.collect(),
        ),
        axis("silhouettes", "posts", "posts on a ground, the more the smaller", silhouettes.collect()),
        axis("pixels", "pixels", "`windmill`", pixels.collect()),
        axis("map", "texels a side", "`windmill`", maps.collect()),
        axis(
            "light",
            "length of a shadow over height",
            "40 posts on a ground, a light at 64° down to 2°",
            heights.collect(),
        ),
        axis(
            "depth",
            "sheets behind each other",
            "sheets of tiles across the view, every other tile left out",
            depths.collect(),
        ),
        axis("views", "", "", views),
    ]
}

/// A mesh, seen from above at a slant, the sun so many degrees high.
fn scene_of(name: &str, mesh: Mesh, degrees: f64) -> Result<Scene> {
    let mut scene = Scene::of_mesh(name, mesh)?;
    let height = degrees.to_radians();
    scene.light =
        Light::Directional { direction: [0.8 * height.cos() as f32, height.sin() as f32, 0.6 * height.cos() as f32] };
    scene.camera = Camera {
        eye: [0.0, 1.1, 1.6],
        target: [0.0, 0.0, 0.1],
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 45.0,
        near: 0.05,
        far: 100.0,
        lens: Lens::CENTRED,
        near_plane: None,
    };
    Ok(scene)
}

fn quad(mesh: &mut Mesh, at: Vec3, u: Vec3, v: Vec3) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([at, at + u, at + u + v, at + v].map(<[f32; 3]>::from));
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// So many posts in rows on a ground of width 2, faces cut into `cut` x `cut` pieces each triangle.
fn posts(count: u32, cut: u32) -> Mesh {
    let mut mesh = Mesh::default();
    quad(&mut mesh, Vec3::new(-1.0, 0.0, 1.0), Vec3::X * 2.0, Vec3::Z * -2.0);
    let across = f64::from(count).sqrt().ceil() as u32;
    let cell = 2.0 / across as f32;
    for k in 0..count {
        let at = Vec3::new((k % across) as f32, 0.0, (k / across) as f32) * cell - Vec3::new(1.0, 0.0, 1.0);
        let (low, size) = (at + Vec3::new(0.35, 0.0, 0.35) * cell, Vec3::new(0.3, 0.8, 0.3) * cell);
        let [x, y, z] = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z];
        for (at, u, v) in [(low, z, y), (low + x, y, z), (low, y, x), (low + z, x, y), (low, x, z), (low + y, z, x)] {
            quad(&mut mesh, at, u, v);
        }
    }
    cut_up(&mesh, cut)
}

/// Sheets across the view, each of 16 x 16 tiles of which every other is missing, over a ground.
fn sheets(count: u32) -> Mesh {
    let mut mesh = Mesh::default();
    quad(&mut mesh, Vec3::new(-1.0, 0.0, 1.0), Vec3::X * 2.0, Vec3::Z * -2.0);
    for k in 0..count {
        let z = 0.8 - 1.6 * k as f32 / count as f32;
        for tile in (0..256u32).filter(|t| (t % 16 + t / 16 + k) % 2 == 0) {
            let at = Vec3::new((tile % 16) as f32 / 8.0 - 1.0, (tile / 16) as f32 / 20.0 + 0.05, z);
            quad(&mut mesh, at, Vec3::X / 8.0, Vec3::Y / 20.0);
        }
    }
    mesh
}

/// Every triangle cut into `cut` x `cut` equal ones; neighbours share the points on their edge, to the bit.
fn cut_up(mesh: &Mesh, cut: u32) -> Mesh {
    if cut == 1 {
        return mesh.clone();
    }
    let mut out = Mesh::default();
    let at = |k: u32| DVec3::from(mesh.positions[k as usize].map(f64::from));
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(at);
        let first = out.positions.len() as u32;
        // Row by row; products and sums of the two ends of an edge are the same from both sides.
        for j in 0..=cut {
            for i in 0..=cut - j {
                let [i, j] = [f64::from(i), f64::from(j)];
                let p = (a * (f64::from(cut) - i - j) + b * i + c * j) / f64::from(cut);
                out.positions.push(p.as_vec3().into());
            }
        }
        let place = |i: u32, j: u32| first + j * (cut + 1) - j * j.saturating_sub(1) / 2 + i;
        for j in 0..cut {
            for i in 0..cut - j {
                out.triangles.push([place(i, j), place(i + 1, j), place(i, j + 1)]);
                if i + j + 1 < cut {
                    out.triangles.push([place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)]);
                }
            }
        }
    }
    out
}
