//! Meshes by name, lights by number.

use super::Random;
use subpixel_shadows::glam::{DVec2, DVec3, Vec3};
use subpixel_shadows::scene::{Light, Mesh};

/// Names of the meshes of [`mesh`].
pub const MESHES: [&str; 13] = [
    "closed balls",
    "bodies and sheets",
    "leaves",
    "interpenetrating",
    "doubled",
    "slivers",
    "t-junctions",
    "contact",
    "fan",
    "grid",
    "flipped",
    "huge",
    "non-manifold",
];

/// A mesh that is hard to get right, different for each seed.
pub fn mesh(name: &str, seed: u64) -> Mesh {
    let mut r = Place(Random::new(seed.wrapping_mul(977) ^ name.len() as u64));
    let mut m = Mesh::default();
    match name {
        "closed balls" => (0..5).for_each(|_| ball(&mut m, r.point(), 0.15 + 0.3 * r.unit(), 7, 5)),
        "bodies and sheets" => {
            // Bodies that meet each other and a floor, one that is torn, one turned inside out.
            (0..4).for_each(|_| ball(&mut m, r.point(), 0.15 + 0.3 * r.unit(), 7, 5));
            ball(&mut m, r.point(), 0.3, 6, 4);
            m.triangles.pop();
            let first = m.triangles.len();
            ball(&mut m, r.point(), 0.3, 5, 4);
            m.triangles[first..].iter_mut().for_each(|t| t.reverse());
            let floor = [[-1.5, -0.3, -1.5], [1.5, -0.3, -1.5], [1.5, -0.3, 1.5], [-1.5, -0.3, 1.5]];
            add(&mut m, &floor.map(DVec3::from), &[[0, 2, 1], [0, 3, 2]]);
        }
        "leaves" => (0..30).for_each(|_| {
            let (at, u, v) = (r.point(), r.point() * 0.3, r.point() * 0.3);
            add(&mut m, &[at, at + u, at + u + v, at + v], &[[0, 1, 2], [0, 2, 3]]);
        }),
        "interpenetrating" => (0..24).for_each(|_| add(&mut m, &[r.point(), r.point(), r.point()], &[[0, 1, 2]])),
        "doubled" => {
            ball(&mut m, DVec3::ZERO, 0.8, 6, 5);
            let again = m.triangles.clone();
            m.triangles.extend(again);
        }
        "slivers" => (0..40).for_each(|k| {
            let (at, u) = (r.point(), r.point());
            let thin = r.point() * 10f64.powi(-1 - k % 7);
            add(&mut m, &[at, at + u, at + u * r.unit() + thin], &[[0, 1, 2]]);
        }),
        "t-junctions" => {
            // One long edge against many short ones on it.
            let (a, b) = (DVec3::new(-1.0, 0.2, 0.0), DVec3::new(1.0, 0.4, 0.125));
            add(&mut m, &[a, b, DVec3::new(0.0, 0.3, -1.0)], &[[0, 1, 2]]);
            let n = 17;
            for k in 0..n {
                let at = |k: i32| a.lerp(b, f64::from(k) / f64::from(n));
                add(&mut m, &[at(k), DVec3::new(0.1, 0.2, 0.9), at(k + 1)], &[[0, 1, 2]]);
            }
            add(
                &mut m,
                &[DVec3::new(-2.0, -0.5, -2.0), DVec3::new(2.0, -0.5, -2.0), DVec3::new(0.0, -0.5, 2.0)],
                &[[0, 2, 1]],
            );
        }
        "contact" => {
            // Boxes that stand exactly on a ground, and a ball that sinks into it.
            let y = -0.5;
            add(
                &mut m,
                &[
                    DVec3::new(-2.0, y, -2.0),
                    DVec3::new(2.0, y, -2.0),
                    DVec3::new(2.0, y, 2.0),
                    DVec3::new(-2.0, y, 2.0),
                ],
                &[[0, 2, 1], [0, 3, 2]],
            );
            for _ in 0..4 {
                let at = r.point();
                cuboid(&mut m, DVec3::new(at.x, y, at.z), DVec3::new(at.x + 0.4, y + 0.5 * r.unit(), at.z + 0.3));
            }
            ball(&mut m, DVec3::new(0.1, y + 0.1, -0.2), 0.35, 8, 6);
        }
        "fan" => fan(&mut m, 16 + (seed % 40) as u32 * 4),
        "grid" => {
            let n = 6u32;
            let bump =
                |i: u32, j: u32| DVec3::new(f64::from(i) / 3.0 - 1.0, 0.1 * r_hash(i, j), f64::from(j) / 3.0 - 1.0);
            let points: Vec<DVec3> = (0..=n).flat_map(|j| (0..=n).map(move |i| bump(i, j))).collect();
            let at = |i: u32, j: u32| j * (n + 1) + i;
            let quads = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
            let faces: Vec<[u32; 3]> = quads
                .flat_map(|(i, j)| {
                    [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)]]
                })
                .collect();
            add(&mut m, &points, &faces);
        }
        "flipped" => {
            ball(&mut m, DVec3::ZERO, 0.7, 9, 7);
            for triangle in m.triangles.iter_mut().filter(|_| r.unit() < 0.4) {
                triangle.reverse();
            }
        }
        "huge" => {
            ball(&mut m, DVec3::ZERO, 0.5, 7, 5);
            for k in 0..4 {
                let size = 10f64.powi(k + 1);
                add(&mut m, &[r.point() * size, r.point() * size, r.point() * size], &[[0, 1, 2]]);
            }
        }
        _ => {
            // Pages of a book: five sheets on one edge.
            let (a, b) = (DVec3::new(0.0, -0.6, 0.1), DVec3::new(0.1, 0.7, 0.0));
            for _ in 0..5 {
                let p = r.point();
                add(&mut m, &[a, b, p], &[[0, 1, 2]]);
            }
        }
    }
    m
}

fn r_hash(i: u32, j: u32) -> f64 {
    f64::from((i * 7919 + j * 104_729) % 17) / 8.0 - 1.0
}

/// Lights of every kind, from the side on which the meshes' ground is not.
pub fn light(k: u64) -> Light {
    let mut r = Place(Random::new(k ^ 0x51));
    let p = r.point();
    let towards = [0.7 * p.x as f32, 1.0, 0.7 * p.z as f32];
    match k % 3 {
        0 => Light::Directional { direction: towards },
        1 => Light::Point { position: towards.map(|c| 3.0 * c) },
        _ => Light::Spot { position: towards.map(|c| 2.5 * c), target: [0.1, 0.0, 0.2], angle_degrees: 60.0 },
    }
}

/// Random places.
pub struct Place(pub Random);

impl Place {
    /// A number of [0, 1).
    pub fn unit(&mut self) -> f64 {
        f64::from(self.0.word()) / 4_294_967_296.0
    }

    /// A point of the cube from -1 to 1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    /// A place within a texel, away from nothing.
    pub fn in_cell(&mut self, x: u32, y: u32) -> DVec2 {
        DVec2::new(f64::from(x) + self.unit(), f64::from(y) + self.unit())
    }
}

/// Appends points and the triangles between them.
pub fn add(m: &mut Mesh, points: &[DVec3], triangles: &[[u32; 3]]) {
    let base = m.positions.len() as u32;
    m.positions.extend(points.iter().map(|p| <[f32; 3]>::from(p.as_vec3())));
    m.triangles.extend(triangles.iter().map(|t| t.map(|v| v + base)));
}

/// A closed ball of `n` segments and `rings` rings.
pub fn ball(m: &mut Mesh, centre: DVec3, radius: f64, n: u32, rings: u32) {
    let mut points = vec![centre + DVec3::Y * radius];
    for j in 1..rings {
        let polar = f64::from(j) / f64::from(rings) * std::f64::consts::PI;
        for i in 0..n {
            let turn = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            points.push(centre + DVec3::new(polar.sin() * turn.cos(), polar.cos(), -polar.sin() * turn.sin()) * radius);
        }
    }
    points.push(centre - DVec3::Y * radius);
    let last = points.len() as u32 - 1;
    let at = |j: u32, i: u32| 1 + (j - 1) * n + i % n;
    let mut faces = Vec::new();
    for i in 0..n {
        faces.extend([[0, at(1, i), at(1, i + 1)], [last, at(rings - 1, i + 1), at(rings - 1, i)]]);
        for j in 1..rings - 1 {
            faces.extend([[at(j, i), at(j + 1, i), at(j, i + 1)], [at(j, i + 1), at(j + 1, i), at(j + 1, i + 1)]]);
        }
    }
    add(m, &points, &faces);
}

/// A closed cuboid.
pub fn cuboid(m: &mut Mesh, lo: DVec3, hi: DVec3) {
    let points: [DVec3; 8] =
        std::array::from_fn(|k| DVec3::new([lo.x, hi.x][k & 1], [lo.y, hi.y][k >> 1 & 1], [lo.z, hi.z][k >> 2]));
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces: Vec<[u32; 3]> = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    add(m, &points, &faces);
}

/// A flat closed fan of `n` triangles around one vertex.
pub fn fan(m: &mut Mesh, n: u32) {
    let mut points = vec![DVec3::new(0.03, 0.0, 0.02)];
    points.extend((0..n).map(|k| {
        let turn = f64::from(k) / f64::from(n) * std::f64::consts::TAU;
        DVec3::new(turn.cos(), 0.1 * (3.0 * turn).sin(), -turn.sin())
    }));
    let faces: Vec<[u32; 3]> = (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect();
    add(m, &points, &faces);
}

/// A world position in `f64`.
pub fn world(p: [f32; 3]) -> DVec3 {
    Vec3::from(p).as_dvec3()
}
