//! The stiff and extreme cases: small scenes, each pushed in steps towards what breaks shadow algorithms.

use super::shapes::{Numbers, add, at, ball, block, sheet};
use glam::{DQuat, DVec3};
use subpixel_shadows::render::Budget;
use subpixel_shadows::scene::{Camera, Lens, Light, Mesh};

/// A case with its steps, from harmless to extreme.
#[derive(Clone, Debug)]
pub struct StiffCase {
    /// Its name.
    pub name: &'static str,
    /// Quantity that is pushed, and the fault that it could cause.
    pub about: &'static str,
    /// Its steps.
    pub steps: Vec<StiffFrame>,
    /// Whether all steps must give one picture, bit for bit.
    pub same_bits: bool,
}

/// One frame of a case.
#[derive(Clone, Debug)]
pub struct StiffFrame {
    /// Quantity and how far it was pushed.
    pub label: String,
    /// The scene.
    pub mesh: Mesh,
    /// Its camera.
    pub camera: Camera,
    /// Its light.
    pub light: Light,
    /// Texels a side, where the case asks for another map than the caller.
    pub map: Option<u32>,
    /// Memory of lists.
    pub budget: Budget,
}

impl StiffFrame {
    fn new(label: impl std::fmt::Display, mesh: Mesh) -> Self {
        Self {
            label: label.to_string(),
            mesh,
            camera: camera(at(2.2, 2.6, 4.0), at(0.0, 0.2, 0.0)),
            light: towards(at(-0.5, 1.0, 0.35)),
            map: None,
            budget: Budget::default(),
        }
    }

    fn seen(self, camera: Camera) -> Self {
        Self { camera, ..self }
    }

    fn lit(self, light: Light) -> Self {
        Self { light, ..self }
    }
}

fn camera(eye: DVec3, target: DVec3) -> Camera {
    Camera {
        eye: eye.as_vec3().into(),
        target: target.as_vec3().into(),
        up: [0.0, 1.0, 0.0],
        vertical_fov_degrees: 40.0,
        near: 1e-3,
        far: 1e3,
        lens: Lens::CENTRED,
        near_plane: None,
    }
}

fn towards(direction: DVec3) -> Light {
    Light::Directional { direction: direction.as_vec3().into() }
}

/// A floor with a block, a ball, a leaning plate and a thin bar on it.
fn still_life() -> Mesh {
    let mut mesh = Mesh::default();
    sheet(&mut mesh, at(-4.0, 0.0, 4.0), at(8.0, 0.0, 0.0), at(0.0, 0.0, -8.0), 4);
    block(&mut mesh, at(-0.9, 0.0, -0.5), at(-0.2, 0.7, 0.2));
    ball(&mut mesh, at(0.6, 0.4, 0.3), 0.35, 24, 16);
    sheet(&mut mesh, at(-0.2, 0.1, 0.9), at(0.8, 0.05, 0.1), at(0.1, 0.8, -0.4), 1);
    block(&mut mesh, at(-1.4, 0.55, 0.7), at(1.4, 0.57, 0.72));
    mesh
}

fn floor(n: u32) -> Mesh {
    let mut mesh = Mesh::default();
    sheet(&mut mesh, at(-3.0, 0.0, 3.0), at(6.0, 0.0, 0.0), at(0.0, 0.0, -6.0), n);
    mesh
}

fn mapped(mesh: &Mesh, f: impl Fn(DVec3) -> DVec3) -> Mesh {
    let move_one = |p: &[f32; 3]| f(DVec3::from_array(p.map(f64::from))).as_vec3().into();
    Mesh { positions: mesh.positions.iter().map(move_one).collect(), triangles: mesh.triangles.clone() }
}

/// Powers of ten from `first` to `last`.
fn tens(first: i32, last: i32) -> Vec<(String, f64)> {
    let all: Vec<i32> = if first <= last { (first..=last).collect() } else { (last..=first).rev().collect() };
    all.into_iter().map(|k| (format!("1e{k}"), 10f64.powi(k))).collect()
}

fn case(name: &'static str, about: &'static str, steps: Vec<StiffFrame>) -> StiffCase {
    StiffCase { name, about, steps, same_bits: false }
}

/// All cases.
pub fn cases() -> Vec<StiffCase> {
    let mut all = vec![
        case(
            "grazing-light",
            "the light sinks to the floor's plane (radians): facets edge-on to the light, shadows without end",
            [vec![("0.3".to_owned(), 0.3)], tens(-1, -7), vec![("0".to_owned(), 0.0)]]
                .concat()
                .into_iter()
                .map(|(label, a)| {
                    StiffFrame::new(label, still_life()).lit(towards(at(-a.cos(), a.sin(), 0.2 * a.cos())))
                })
                .collect(),
        ),
        case(
            "light-below",
            "the light shines from beneath the floor: what is seen is dark, nothing leaks through",
            [-1.0, -0.1, -1e-3]
                .map(|y| StiffFrame::new(format!("y {y}"), still_life()).lit(towards(at(0.3, y, 0.2))))
                .into(),
        ),
        case(
            "light-in-plane",
            "a plate whose plane holds the light but for this much: its shadow is a line, its pyramid flat",
            [vec![("0".to_owned(), 0.0)], tens(-8, -2)]
                .concat()
                .into_iter()
                .map(|(label, d)| {
                    let mut mesh = floor(2);
                    sheet(&mut mesh, at(-0.8, 0.2, d), at(1.6, 0.0, 0.0), at(0.0, 0.9, -d), 1);
                    StiffFrame::new(label, mesh).lit(towards(at(0.25, 1.0, 0.0)))
                })
                .collect(),
        ),
        case(
            "point-light-near",
            "a point light this high over the block's corner: the light view is wide and its depth uneven",
            [1.0, 0.3, 0.1, 0.03, 0.01]
                .map(|h| {
                    let mut mesh = floor(2);
                    block(&mut mesh, at(-0.4, 0.0, -0.4), at(0.4, 0.3, 0.4));
                    let position = at(0.05, 0.3 + h, 0.02).as_vec3().into();
                    StiffFrame::new(h, mesh).lit(Light::Point { position })
                })
                .into(),
        ),
        case(
            "behind-the-eye",
            "the eye stands this high over the floor, casters beside and behind it: shadow lines cross the eye's plane",
            tens(0, -6)
                .into_iter()
                .map(|(label, h)| {
                    let mut mesh = floor(4);
                    sheet(&mut mesh, at(-2.0, 2.0, 4.0), at(0.7, 0.0, 0.0), at(0.0, 0.0, -6.0), 1);
                    block(&mut mesh, at(0.4, 0.0, -1.5), at(0.8, 0.6, -1.1));
                    StiffFrame::new(label, mesh).seen(camera(at(0.0, h, 2.0), at(0.0, h + 0.02, 0.0)))
                })
                .collect(),
        ),
        case(
            "coplanar-floor",
            "a tilted floor of so many quads a side under a block: neighbours in one plane must not shade one another",
            [1u32, 4, 16, 64, 128]
                .map(|n| {
                    let mut mesh = floor(n);
                    block(&mut mesh, at(-0.5, 0.3, -0.5), at(0.5, 0.8, 0.5));
                    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.1237, 0.7713, -0.0931);
                    StiffFrame::new(n, mapped(&mesh, |p| turn * p))
                })
                .into(),
        ),
        case(
            "crossing",
            "a plate reaches this far through the floor: the shadow begins on the line where they cross",
            [vec![("0".to_owned(), 0.0)], tens(-7, -1)]
                .concat()
                .into_iter()
                .map(|(label, d)| {
                    let mut mesh = floor(2);
                    sheet(&mut mesh, at(-0.8, -d, 0.3), at(1.6, 0.0, -0.5), at(0.1, 0.9, 0.2), 1);
                    StiffFrame::new(label, mesh)
                })
                .collect(),
        ),
        case(
            "contact",
            "a block this far above the floor: the shadow meets the block, with no leak and no gap",
            [vec![("0".to_owned(), 0.0)], tens(-7, -1)]
                .concat()
                .into_iter()
                .map(|(label, d)| {
                    let mut mesh = floor(2);
                    block(&mut mesh, at(-0.5, d, -0.5), at(0.5, 0.6 + d, 0.5));
                    StiffFrame::new(label, mesh)
                })
                .collect(),
        ),
        case(
            "grazing-camera",
            "the camera sinks to the floor: a facet's footprint runs to the horizon",
            tens(0, -6)
                .into_iter()
                .map(|(label, h)| {
                    StiffFrame::new(label, still_life()).seen(camera(at(0.3, h, 3.8), at(0.0, 0.5 * h, 0.0)))
                })
                .collect(),
        ),
        case(
            "slivers",
            "200 triangles so many times longer than wide over the floor: their normals are noise",
            tens(1, 7)
                .into_iter()
                .map(|(label, aspect)| {
                    let mut mesh = floor(2);
                    let mut numbers = Numbers(7);
                    for _ in 0..200 {
                        let (start, along) =
                            (numbers.vector() * at(1.5, 0.4, 1.5) + at(0.0, 0.6, 0.0), numbers.vector());
                        let wide = numbers.vector() / aspect;
                        add(&mut mesh, &[start, start + along, start + along * 0.5 + wide], &[[0, 1, 2]]);
                    }
                    StiffFrame::new(label, mesh)
                })
                .collect(),
        ),
        case(
            "degenerate",
            "triangles without area, doubled vertices, doubled faces, fins, half the faces turned",
            broken(),
        ),
        case(
            "t-junctions",
            "one long edge against so many short ones: the shadow beneath has no hole along them",
            [1u32, 8, 64, 512]
                .map(|n| {
                    let mut mesh = floor(2);
                    sheet(&mut mesh, at(-1.0, 0.7, 0.0), at(2.0, 0.013, 0.0), at(0.0, 0.0, -0.8), 1);
                    // Beside it a strip of n quads along the same edge.
                    let corners: Vec<DVec3> = (0..=n)
                        .flat_map(|k| {
                            let x = f64::from(k) / f64::from(n);
                            [at(-1.0 + 2.0 * x, 0.7 + 0.013 * x, 0.0), at(-1.0 + 2.0 * x, 0.7 + 0.013 * x, 0.6)]
                        })
                        .collect();
                    let strip: Vec<[u32; 3]> = (0..n)
                        .flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 2, 2 * k + 1, 2 * k + 3]])
                        .collect();
                    add(&mut mesh, &corners, &strip);
                    StiffFrame::new(n, mesh)
                })
                .into(),
        ),
        case(
            "fan",
            "a closed cone of so many triangles: nothing leaks at its tip",
            [4u32, 16, 64, 256, 1024]
                .map(|n| {
                    let mut mesh = floor(2);
                    let ring = |k: u32| {
                        let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
                        at(0.7 * c, 0.5, 0.7 * s)
                    };
                    let mut corners = vec![at(0.1, 1.1, 0.05)];
                    corners.extend((0..n).map(ring));
                    let sides: Vec<[u32; 3]> = (0..n).map(|k| [0, 1 + (k + 1) % n, 1 + k]).collect();
                    add(&mut mesh, &corners, &sides);
                    StiffFrame::new(n, mesh)
                })
                .into(),
        ),
        case(
            "sub-texel",
            "a ball of about so many triangles in a few texels: lists of a texel grow long",
            [8u32, 32, 96, 224]
                .map(|n| {
                    let mut mesh = floor(2);
                    ball(&mut mesh, at(0.0, 0.4, 0.0), 0.25, 2 * n, n);
                    StiffFrame { map: Some(16), ..StiffFrame::new(4 * n * n, mesh) }
                })
                .into(),
        ),
        case(
            "huge-floor",
            "the floor is two triangles of this half-width: the scene is a dot in it (at 1e6 rounding is as large as the map: still right, but a hundred times slower)",
            tens(1, 5)
                .into_iter()
                .map(|(label, half)| {
                    let mut mesh = still_life();
                    sheet(&mut mesh, at(-half, -0.01, half), at(2.0 * half, 0.0, 0.0), at(0.0, 0.0, -2.0 * half), 1);
                    StiffFrame::new(label, mesh)
                })
                .collect(),
        ),
        case(
            "grass",
            "so many blades: every texel holds silhouettes, and the mask saves nothing",
            [100u32, 1000, 10_000]
                .map(|n| {
                    let mut mesh = floor(2);
                    let mut numbers = Numbers(11);
                    for _ in 0..n {
                        let foot = numbers.vector() * at(2.0, 0.0, 2.0);
                        let lean = numbers.vector() * 0.1;
                        let wide = numbers.vector() * at(0.02, 0.0, 0.02);
                        let tip = foot + at(0.0, 0.4 + 0.2 * numbers.unit(), 0.0) + lean;
                        add(&mut mesh, &[foot - wide, foot + wide, tip], &[[0, 1, 2]]);
                    }
                    StiffFrame::new(n, mesh)
                })
                .into(),
        ),
        case(
            "small-map",
            "a map of so many texels a side: everything lies in few texels",
            [64u32, 16, 4, 2, 1].map(|map| StiffFrame { map: Some(map), ..StiffFrame::new(map, still_life()) }).into(),
        ),
    ];
    all.extend(same_picture());
    all
}

/// Cases whose steps are one scene in other guise.
fn same_picture() -> Vec<StiffCase> {
    let scaled = |k: i32| {
        let s = 2f64.powi(k);
        let mut step = StiffFrame::new(format!("2^{k}"), mapped(&still_life(), |p| p * s));
        let mul = |v: [f32; 3]| v.map(|c| c * s as f32);
        step.camera = Camera {
            eye: mul(step.camera.eye),
            target: mul(step.camera.target),
            near: step.camera.near * s as f32,
            far: step.camera.far * s as f32,
            ..step.camera
        };
        step
    };
    let limits = [(None, 1 << 30), (Some(1), 1 << 30), (Some(1), 1 << 20), (Some(1), 1 << 16)];
    let shuffled = |seed: u64| {
        let mut mesh = still_life();
        let mut numbers = Numbers(seed);
        for k in (1..mesh.triangles.len()).rev() {
            mesh.triangles.swap(k, (numbers.unit() * (k + 1) as f64) as usize);
        }
        for t in &mut mesh.triangles {
            t.rotate_left((numbers.unit() * 3.0) as usize);
        }
        StiffFrame::new(format!("order {seed}"), mesh)
    };
    let far_away = |k: i32| {
        // Far offsets round the vertices: each step is a scene of its own, judged by its own truth.
        let o = at(1.0, 2.0, 3.0) * 10f64.powi(k);
        let mut step = StiffFrame::new(format!("1e{k}"), mapped(&still_life(), |p| p + o));
        let shift = |v: [f32; 3]| (DVec3::from_array(v.map(f64::from)) + o).as_vec3().into();
        step.camera = Camera { eye: shift(step.camera.eye), target: shift(step.camera.target), ..step.camera };
        step
    };
    vec![
        case(
            "world-offset",
            "the scene stands this far from the origin: coordinates lose their last bits",
            (0..=6).map(far_away).collect(),
        ),
        StiffCase {
            same_bits: true,
            ..case(
                "scale",
                "the scene scaled by powers of two: no constant has a length",
                [0, -40, -20, 20, 40].map(scaled).into(),
            )
        },
        StiffCase {
            same_bits: true,
            ..case(
                "order",
                "triangles shuffled and turned: nothing depends on their order",
                (0..3).map(shuffled).collect(),
            )
        },
        StiffCase {
            same_bits: true,
            ..case(
                "overflow",
                "lists that start at one element, in ever less memory: the frame runs again, or in bands",
                limits
                    .map(|(start, bytes)| {
                        let label = format!(
                            "start {}, {} KiB",
                            start.map_or("ample".to_owned(), |n: usize| n.to_string()),
                            bytes >> 10
                        );
                        StiffFrame { budget: Budget { start, bytes }, ..StiffFrame::new(label, still_life()) }
                    })
                    .into(),
            )
        },
    ]
}

fn broken() -> Vec<StiffFrame> {
    let mut collapsed = still_life();
    let count = collapsed.positions.len() as u32;
    for k in 0..count.min(200) {
        collapsed.triangles.push([k, k, (k + 1) % count]);
    }
    let mut collinear = still_life();
    for k in 0..50 {
        let (a, d) = (at(-1.0 + 0.04 * f64::from(k), 0.9, 0.3), at(0.01, 0.3, -0.2));
        add(&mut collinear, &[a, a + d, a + d * 2.0], &[[0, 1, 2]]);
    }
    let mut doubled = still_life();
    doubled.triangles.extend(doubled.triangles.clone());
    let mut turned = still_life();
    turned.triangles.iter_mut().step_by(2).for_each(|t| t.swap(1, 2));
    let mut fins = still_life();
    for k in 0..8 {
        let (s, c) = (std::f64::consts::TAU * f64::from(k) / 8.0).sin_cos();
        let (low, high) = (at(0.9, 0.0, -0.6), at(0.9, 0.9, -0.6));
        add(&mut fins, &[low, high, high + at(0.4 * c, 0.0, 0.4 * s)], &[[0, 1, 2]]);
    }
    [
        ("whole", still_life()),
        ("collapsed", collapsed),
        ("collinear", collinear),
        ("doubled", doubled),
        ("turned", turned),
        ("fins", fins),
    ]
    .map(|(label, mesh)| StiffFrame::new(label, mesh))
    .into()
}
