//! Vertices of instances, by transforms at any offset.

use crate::support::{POISON, Random, gpu, poisoned, run, sizes_around, small_gpu, upload};
use oracle::reference::instance_positions::{PlacedVertices, place};
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::scene::Homography;
use subpixel_shadows::stages::instance_positions::{FAULT_OUTSIDE, InstancePositions, Transforms};
use test_support::gpu_test;

const BOX: [[f32; 3]; 2] = [[-9.0, -8.0, -7.0], [9.0, 8.0, 7.0]];

/// Meshes' vertices, places, and transforms behind some words.
#[derive(Clone)]
struct Case {
    vertices: Vec<[f32; 3]>,
    sources: Vec<[u32; 2]>,
    transforms: Vec<[[f32; 4]; 3]>,
    before: usize,
    homography: Homography,
}

impl Case {
    fn new(places: usize, before: usize, random: &mut Random) -> Self {
        let unit = |random: &mut Random| (f64::from(random.word()) / f64::from(u32::MAX) * 2.0 - 1.0) as f32;
        let (vertices, instances) = (1 + places / 3, 1 + places / 5);
        let point = |random: &mut Random| [0; 3].map(|_: u32| unit(random));
        Self {
            vertices: (0..vertices).map(|_| point(random)).collect(),
            sources: (0..places).map(|_| [random.below(vertices as u32), random.below(instances as u32)]).collect(),
            // Some go out of the box.
            transforms: (0..instances)
                .map(|_| {
                    let far = [4.0, 4.0, 12.0][random.below(3) as usize];
                    [0; 3].map(|_: u32| {
                        let [a, b, c] = point(random);
                        [a, b, c, far * unit(random)]
                    })
                })
                .collect(),
            before,
            homography: Homography::default(),
        }
    }

    fn ask(&self, gpu: &Gpu) -> (Vec<[f32; 3]>, u32) {
        let mut words = vec![POISON; self.before];
        words.extend(self.transforms.iter().flatten().flatten().map(|v| v.to_bits()));
        let (transforms, sources) = (upload(gpu, &words), upload(gpu, &self.sources));
        let vertices: Vec<[f32; 4]> = self.vertices.iter().map(|&[x, y, z]| [x, y, z, f32::NAN]).collect();
        let vertices = upload(gpu, &vertices);
        let count = self.sources.len();
        let positions: Buffer<[f32; 4]> = Buffer::storage(&gpu.device, "test.positions", count + 1).expect("memory");
        positions.write(&gpu.queue, &vec![[f32::from_bits(POISON); 4]; count + 1]);
        let faults = poisoned(gpu, 2);
        faults.write(&gpu.queue, &[0]);
        let given = (Transforms { buffer: transforms.raw(), offset: 4 * self.before as u64 }, self.transforms.len());
        let stage = InstancePositions::new(&gpu.device);
        run(gpu, |s| stage.record(s, given, &sources, &vertices, (BOX, self.homography), (&positions, 0), &faults));
        let mut got = positions.read(gpu).expect("readback");
        let faults = faults.read(gpu).expect("readback");
        let beyond = got.pop().expect("one more").map(f32::to_bits);
        assert!(beyond == [POISON; 4] && faults[1] == POISON, "something was written past the end");
        assert!(got.iter().all(|p| p[3].to_bits() == POISON), "the fourth word is left alone");
        (got.into_iter().map(|[x, y, z, _]| [x, y, z]).collect(), faults[FAULT_OUTSIDE as usize])
    }

    fn wanted(&self) -> PlacedVertices {
        place(&self.vertices, &self.sources, &self.transforms, (BOX, &self.homography))
    }
}

/// Places that are off by more than rounding, told of. A place within rounding of the box's sides may count as inside or outside.
fn fault(case: &Case, (positions, outside): &(Vec<[f32; 3]>, u32)) -> Option<String> {
    let want = case.wanted();
    // A homography divides by little where places are large.
    let bound = |at: f64| if case.homography.is_none() { 1e-5 } else { 1e-5 * (1.0 + at * at) };
    let far = |(got, want): (&f32, &f64)| (f64::from(*got) - want).abs() > bound(*want);
    let off = |k: usize| positions[k].iter().zip(&want.positions[k]).any(far);
    let wrong = (0..positions.len()).filter(|k| off(*k)).count();
    (wrong > 0 || outside.abs_diff(want.outside) > 1)
        .then(|| format!("{wrong} places, {outside} outside for {}", want.outside))
}

#[track_caller]
fn check(gpu: &Gpu, case: &Case) {
    assert_eq!(fault(case, &case.ask(gpu)), None);
}

#[gpu_test]
fn empty() {
    let case = Case { sources: Vec::new(), ..Case::new(5, 0, &mut Random::new(81)) };
    check(gpu(), &case);
}

#[gpu_test]
fn one() {
    let mut random = Random::new(82);
    for before in [0, 1, 64, 67] {
        check(gpu(), &Case::new(1, before, &mut random));
    }
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(83);
    for size in sizes_around(64) {
        check(gpu(), &Case::new(size, size % 3, &mut random));
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(84);
    for before in [0, 3, 100] {
        let case = Case::new(5000, before, &mut random);
        let outside = case.wanted().outside;
        assert!((100..4000).contains(&outside), "{outside} outside");
        check(gpu(), &case);
    }
}

/// Places by a homography, some of them where it divides by less than 0.
#[gpu_test]
fn mapped() {
    let mut random = Random::new(88);
    let case = Case { homography: crate::support::HOMOGRAPHY, ..Case::new(3000, 2, &mut random) };
    let outside = case.wanted().outside;
    assert!((100..2900).contains(&outside), "{outside} outside");
    check(gpu(), &case);
    let got = case.ask(gpu());
    for k in 0..4 {
        let mut other = case.clone();
        let row = [
            &mut other.homography.origin,
            &mut other.homography.right,
            &mut other.homography.up,
            &mut other.homography.divisor,
        ];
        row.into_iter().nth(k).expect("a row")[3] += 0.05;
        assert!(fault(&other, &got).is_some(), "another row {k}");
    }
}

/// A place without a number goes to the low corner, and −0 is +0.
#[gpu_test]
fn degenerate() {
    let same = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let case = Case {
        vertices: vec![[-0.0, 0.0, -0.0], [1.0, f32::INFINITY, 1e30], [2.0, 3.0, 4.0]],
        sources: vec![[0, 0], [1, 0], [2, 0], [2, 1], [0, 1]],
        transforms: vec![same, [[f32::NAN; 4]; 3]],
        before: 0,
        homography: Homography::default(),
    };
    let (positions, outside) = case.ask(gpu());
    assert_eq!(positions[0].map(f32::to_bits), [0; 3]);
    assert_eq!(positions[2], [2.0, 3.0, 4.0]);
    assert_eq!((positions[3], positions[4], outside), (BOX[0], BOX[0], 3));
    assert!((0..3).all(|k| (BOX[0][k]..=BOX[1][k]).contains(&positions[1][k])), "{:?}", positions[1]);
}

/// There is no list to overflow: a buffer that is too short is refused.
#[gpu_test]
fn overflow_by_one() {
    let case = Case::new(100, 1, &mut Random::new(85));
    let words: Vec<u32> = vec![0; 12 * case.transforms.len()];
    let transforms = upload(gpu(), &words);
    let limits = gpu().device.limits();
    let of = |offset| Transforms { buffer: transforms.raw(), offset };
    assert!(of(0).check(case.transforms.len(), &limits).is_ok());
    for (told, given) in [
        ("do not hold", of(0).check(case.transforms.len() + 1, &limits)),
        ("do not hold", of(4).check(case.transforms.len(), &limits)),
        ("offset 2", of(2).check(1, &limits)),
        ("do not hold", of(u64::MAX - 3).check(1, &limits)),
    ] {
        let error = given.expect_err("refused").to_string();
        assert!(error.contains(told) && !error.contains('\n'), "{error}");
    }
}

#[gpu_test]
fn two_d_dispatch() {
    let gpu = small_gpu(7, 1 << 20);
    check(&gpu, &Case::new(64 * 40 + 9, 5, &mut Random::new(86)));
}

#[gpu_test]
fn detects_corruption() {
    let case = Case::new(300, 2, &mut Random::new(87));
    let got = case.ask(gpu());
    assert_eq!(fault(&case, &got), None);
    let mut other = case.clone();
    other.transforms[0][1][3] += 0.01;
    assert!(fault(&other, &got).is_some(), "another transform");
    let mut other = case.clone();
    other.sources.swap(0, 1);
    assert!(fault(&other, &got).is_some(), "other places");
    assert!(fault(&case, &(got.0.clone(), got.1 + 2)).is_some(), "another count");
}
