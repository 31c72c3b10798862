//! Positions out of vertex buffers of any stride and offset.

use crate::support::{POISON, Random, difference, gpu, poisoned, run, sizes_around, small_gpu, upload};
use oracle::reference::caster_positions::{Gathered, gather};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::scene::Homography;
use subpixel_shadows::stages::caster_positions::{CasterPositions, FAULT_OUTSIDE, FAULT_PARTED, NO_PLACE, Vertices};
use test_support::gpu_test;

const BOX: [[f32; 3]; 2] = [[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]];

/// Vertices in a buffer, and their places.
#[derive(Clone)]
struct Case {
    vertices: Vec<[f32; 3]>,
    places: Vec<[u32; 2]>,
    count: usize,
    /// Words before the first position, and from one to the next.
    layout: [usize; 2],
    homography: Homography,
}

impl Case {
    /// `count` vertices; of three, one shares its place with the one before, and some are not used.
    fn new(count: usize, layout: [usize; 2], random: &mut Random) -> Self {
        let mut vertices: Vec<[f32; 3]> = Vec::new();
        let mut places: Vec<[u32; 2]> = Vec::new();
        let mut taken = 0;
        for v in 0..count {
            let unit = |random: &mut Random| f64::from(random.word()) / f64::from(u32::MAX) * 2.0 - 1.0;
            let point = [0, 1, 2].map(|k| (unit(random) as f32 * BOX[1][k]).clamp(BOX[0][k], BOX[1][k]));
            match random.below(6) {
                0 => places.push([NO_PLACE, 0]),
                1 | 2 if v > 0 && places[v - 1][0] != NO_PLACE => {
                    vertices.push(vertices[v - 1]);
                    places.push(places[v - 1]);
                    continue;
                }
                _ => {
                    places.push([taken, v as u32]);
                    taken += 1;
                }
            }
            vertices.push(point);
        }
        Self { vertices, places, count: taken as usize, layout, homography: Homography::default() }
    }

    fn ask(&self, gpu: &Gpu) -> Result<Gathered, String> {
        let [first, stride] = self.layout;
        let mut words = vec![POISON; first + stride * self.vertices.len()];
        for (v, p) in self.vertices.iter().enumerate() {
            let at = first + v * stride;
            words[at..at + 3].copy_from_slice(&p.map(f32::to_bits));
        }
        let (source, places) = (upload(gpu, &words), upload(gpu, &self.places));
        let positions: Buffer<[f32; 4]> =
            Buffer::storage(&gpu.device, "test.positions", self.count + 1).expect("memory");
        positions.write(&gpu.queue, &vec![[f32::from_bits(POISON); 4]; self.count + 1]);
        let faults = poisoned(gpu, 3);
        faults.write(&gpu.queue, &[0, 0]);
        let vertices = Vertices { buffer: source.raw(), offset: 4 * first as u64, stride: 4 * stride as u64 };
        let stage = CasterPositions::new(&gpu.device);
        run(gpu, |s| stage.record(s, vertices, &places, (BOX, self.homography), &positions, &faults));
        let mut got = positions.read(gpu).expect("readback");
        let faults = faults.read(gpu).expect("readback");
        let beyond = got.pop().expect("one more");
        if beyond.map(f32::to_bits) != [POISON; 4] || faults[2] != POISON {
            return Err("something was written past the end".to_owned());
        }
        let positions = got.into_iter().map(|[x, y, z, _]| [x, y, z]).collect();
        Ok(Gathered { positions, outside: faults[FAULT_OUTSIDE as usize], parted: faults[FAULT_PARTED as usize] })
    }

    fn wanted(&self) -> Gathered {
        gather(&self.vertices, &self.places, self.count, (BOX, &self.homography))
    }
}

fn fault(got: &Gathered, want: &Gathered) -> Option<String> {
    let bits = |g: &Gathered| g.positions.iter().map(|p| p.map(f32::to_bits)).collect::<Vec<_>>();
    let counts = |g: &Gathered| [g.outside, g.parted];
    difference(&bits(got), &bits(want)).or_else(|| difference(&counts(got), &counts(want)))
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) -> Gathered {
    let got = case.ask(gpu).expect("nothing past the end");
    assert_eq!(fault(&got, &case.wanted()), None);
    got
}

#[gpu_test]
fn empty() {
    let none = Case { count: 0, ..Case::new(0, [0, 3], &mut Random::new(1)) };
    assert_eq!(check(gpu(), &none), Gathered::default());
}

#[gpu_test]
fn one() {
    for layout in [[0, 3], [1, 3], [70, 8]] {
        let one = Case {
            vertices: vec![[0.5, -0.0, 1.5]],
            places: vec![[0, 0]],
            count: 1,
            layout,
            homography: Homography::default(),
        };
        assert_eq!(check(gpu(), &one).positions[0].map(f32::to_bits), [0.5f32, 0.0, 1.5].map(f32::to_bits));
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    for count in sizes_around(64) {
        check(gpu(), &Case::new(count, [0, 3], &mut Random::new(count as u64)));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(11);
    for layout in [[0, 3], [0, 8], [5, 4], [64, 3], [131, 17]] {
        let got = check(gpu(), &Case::new(3000, layout, &mut random));
        assert_eq!((got.outside, got.parted), (0, 0));
    }
}

/// Positions by a homography come where it says, to what single precision loses; the box, which takes some in, is that of the mapped ones.
#[gpu_test]
fn mapped() {
    let case = Case { homography: crate::support::HOMOGRAPHY, ..Case::new(3000, [1, 4], &mut Random::new(61)) };
    let got = case.ask(gpu()).expect("nothing past the end");
    let off = |case: &Case| {
        let want = case.wanted();
        let far = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|k| (a[k] - b[k]).abs() > 1e-5);
        let places = got.positions.iter().zip(&want.positions).filter(|of| far(*of)).count();
        (places, got.outside.abs_diff(want.outside), got.parted.abs_diff(want.parted))
    };
    assert!((100..2000).contains(&got.outside), "{} outside", got.outside);
    assert!(matches!(off(&case), (0, 0..=1, 0)), "{:?}", off(&case));
    let mut other = case.clone();
    other.homography.divisor[1] += 0.01;
    assert!(off(&other).0 > 100, "another homography");
}

/// No numbers, values far outside, vertices that have parted: counted, and what is written lies in the box.
#[gpu_test]
fn degenerate() {
    let mut case = Case::new(400, [2, 5], &mut Random::new(21));
    let bad = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1.0f32.next_up(), -2.5];
    for (k, bad) in bad.into_iter().enumerate() {
        case.vertices[31 * k + 7][k % 3] = bad;
    }
    case.vertices[300] = [-0.0, 1e-42, 0.0];
    let got = check(gpu(), &case);
    assert!(got.outside > 2, "{got:?}");
    for p in &got.positions {
        assert!((0..3).all(|k| (BOX[0][k]..=BOX[1][k]).contains(&p[k])), "{p:?}");
    }
    // On the sides of the box, which belong to it.
    for (k, (low, high)) in BOX[0].into_iter().zip(BOX[1]).enumerate() {
        for (side, outside) in [(low, 0), (high, 0), (low.next_down(), 1), (high.next_up(), 1)] {
            let mut on = Case::new(1, [0, 3], &mut Random::new(5));
            (on.vertices[0], on.places[0], on.count) = ([0.5; 3], [0, 0], 1);
            on.vertices[0][k] = side;
            assert_eq!(check(gpu(), &on).outside, outside, "component {k} at {side}");
        }
    }
    let shared = (1..400).find(|&v| case.places[v][0] == case.places[v - 1][0] && case.places[v][0] != NO_PLACE);
    let mut parted = Case::new(400, [0, 3], &mut Random::new(21));
    parted.vertices[shared.expect("a shared place")][1] = 0.125;
    assert_eq!(check(gpu(), &parted).parted, 1);
}

/// The stage has no list: nothing is written past the last place, whatever the size of the last workgroup.
#[gpu_test]
fn overflow_by_one() {
    for count in [63, 64, 65, 127, 128, 129] {
        check(gpu(), &Case::new(count, [1, 6], &mut Random::new(31)));
    }
    // A buffer that ends one word early is refused.
    let (buffer, places) = (upload(gpu(), &[0u32; 40]), upload(gpu(), &[[0u32, 0]; 13]));
    let limits = gpu().device.limits();
    let check = |v: Vertices| v.check(places.len(), &limits);
    assert!(check(Vertices { offset: 4, ..Vertices::packed(buffer.raw()) }).is_ok());
    assert!(check(Vertices { offset: 8, ..Vertices::packed(buffer.raw()) }).is_err());
    assert!(check(Vertices { stride: 8, ..Vertices::packed(buffer.raw()) }).is_err());
    assert!(check(Vertices { offset: 2, ..Vertices::packed(buffer.raw()) }).is_err());
    assert!(check(Vertices { stride: u64::MAX / 4 * 4, ..Vertices::packed(buffer.raw()) }).is_err());
}

#[gpu_test]
fn two_d_dispatch() {
    let small = small_gpu(7, 1 << 20);
    for count in [64 * 7, 64 * 7 + 1, 64 * 33 + 5] {
        check(&small, &Case::new(count, [0, 3], &mut Random::new(41)));
    }
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(200, [0, 3], &mut Random::new(51));
    let got = check(gpu(), &case);
    let want = case.wanted();
    let spoilt = |spoil: &dyn Fn(&mut Gathered)| {
        let mut off = got.clone();
        spoil(&mut off);
        fault(&off, &want).is_some()
    };
    assert!(spoilt(&|g| g.positions[50][1] = g.positions[50][1].next_up()));
    assert!(spoilt(&|g| g.outside += 1));
    assert!(spoilt(&|g| g.parted += 1));
    assert!(spoilt(&|g| g.positions.truncate(50)));
}
