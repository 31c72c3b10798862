//! Visibility functions of deep texels, texel by texel against the steps of their sub-texels and `f64`.

use crate::support::shadow::folding_gpu;
use crate::support::{POISON, Random, gpu, poisoned, read_padded, sizes_around, upload};
use oracle::reference::deep_map::{NO_PLACE, Steps, WHOLE};
use subpixel_shadows::frame::Frame;
use subpixel_shadows::gpu::{Buffer, Gpu};
use subpixel_shadows::stages::deep_map::{DeepMap, DeepMapOptions, ERROR_UNIT, MOST_NODES};
use test_support::gpu_test;

const PLAIN: DeepMapOptions = DeepMapOptions { sub_texels: 4, nodes: 7, error: 1.0 / 16.0 };
const ALL: [DeepMapOptions; 9] = [
    PLAIN,
    DeepMapOptions { error: 0.0, ..PLAIN },
    DeepMapOptions { nodes: 3, ..PLAIN },
    DeepMapOptions { nodes: MOST_NODES, error: 0.5, ..PLAIN },
    DeepMapOptions { sub_texels: 2, ..PLAIN },
    DeepMapOptions { sub_texels: 2, nodes: 2, error: 0.0 },
    DeepMapOptions { sub_texels: 8, ..PLAIN },
    DeepMapOptions { sub_texels: 8, nodes: 4, error: 0.1 },
    DeepMapOptions { sub_texels: 8, nodes: MOST_NODES, error: 0.0 },
];

/// Nodes (place, light) of each texel of a deep map.
pub fn decoded(words: &[u32], nodes: u32) -> Vec<Vec<(u32, f64)>> {
    let of = |texel: &[u32]| {
        let taken = (texel[0] & 0xffff).min(nodes) as usize;
        texel[1..=taken].iter().map(|node| (node >> 8, f64::from(node & 0xff))).collect()
    };
    words.chunks_exact(nodes as usize + 1).map(of).collect()
}

struct Ran {
    size: u32,
    options: DeepMapOptions,
    keys: Vec<u32>,
    deep: Vec<u32>,
    worst: Vec<u32>,
}

fn compress(gpu: &Gpu, size: u32, options: DeepMapOptions, keys: Vec<u32>) -> Ran {
    let frame = Buffer::uniform(&gpu.device, "test.frame", 1).expect("memory");
    frame.write(&gpu.queue, &[Frame { map_size: size, ..Frame::default() }]);
    let nearest_keys = upload(gpu, &keys);
    let stage = DeepMap::new(&gpu.device, options);
    assert_eq!(stage.memory(&gpu.device, size).expect("memory").len(), options.words(size));
    let made = poisoned(gpu, options.words(size));
    let worst = DeepMap::worst(&gpu.device).expect("memory");
    crate::support::run(gpu, |s| stage.record(s, &frame, &nearest_keys, (&made, &worst), size));
    let mut deep = read_padded(gpu, &made);
    assert!(deep[options.words(size)..].iter().all(|&word| word == POISON), "written past the end");
    deep.truncate(options.words(size));
    Ran { size, options, keys, deep, worst: worst.read(gpu).expect("readback") }
}

/// Where the stage departs from its definition; how many texels were compared and how many of them have the very nodes of it.
fn fault(ran: &Ran) -> Result<[usize; 2], String> {
    let Ran { size, options, keys, deep, worst } = ran;
    let depth = |&key: &u32| (key != 0).then(|| f64::from(f32::from_bits(!key)));
    let depths: Vec<Option<f64>> = keys.iter().map(depth).collect();
    let side = size.div_ceil(options.sub_texels);
    let most = options.nodes as usize;
    let asked = f64::from(options.error) * WHOLE;
    let all = decoded(deep, options.nodes);
    if all.len() != (side * side) as usize {
        return Err("another number of texels".to_owned());
    }
    let (mut greatest, mut raised, mut same) = (0, 0, 0);
    for (texel, (nodes, words)) in all.iter().zip(deep.chunks_exact(most + 1)).enumerate() {
        let at = [texel as u32 % side, texel as u32 / side];
        let wrong = |text: &str| Err(format!("texel {at:?}, {nodes:?}: {text}"));
        let steps = Steps::of(&depths, *size, options.sub_texels, at);
        let (taken, told) = ((words[0] & 0xffff) as usize, words[0] >> 16);
        if taken != nodes.len() || words[1 + taken..].iter().any(|word| *word != 0) {
            return wrong("more nodes than there may be, or something behind them");
        }
        greatest = greatest.max(told);
        let (Some(&first), Some(&last)) = (steps.places.first(), steps.places.last()) else {
            if words[0] != 0 {
                return wrong("there is no caster");
            }
            same += 1;
            continue;
        };
        let ends = [(first, WHOLE), (last + 1, steps.light(NO_PLACE))];
        if nodes.len() < 2 || [nodes[0], nodes[taken - 1]] != ends {
            return wrong(&format!("ends {ends:?} expected"));
        }
        if !nodes.is_sorted_by(|a, b| a.0 < b.0 && a.1 >= b.1) {
            return wrong("no falling line");
        }
        let difference = steps.difference(nodes);
        let units = difference / WHOLE * f64::from(ERROR_UNIT);
        if !(units - 0.5..=units + 1.5).contains(&f64::from(told)) {
            return wrong(&format!("{told} told, {units} away from the steps"));
        }
        let (want, error) = steps.compressed(asked, most);
        same += usize::from(*nodes == want);
        raised += u32::from(error != Some(asked));
        // Rounding of slopes may leave a line out that just fits: then the next error does.
        let next = error.and_then(|e| steps.errors(asked).find(|next| *next > e));
        if next.is_some_and(|next| difference > next + 0.5 + 1e-3) {
            return wrong(&format!("off by {difference}, {error:?} would do"));
        }
    }
    if worst[0] != greatest || worst[1].abs_diff(raised) as usize > all.len() - same {
        return Err(format!("worst {worst:?}, {:?} expected", [greatest, raised]));
    }
    Ok([all.len(), same])
}

#[track_caller]
fn check(size: u32, options: DeepMapOptions, keys: Vec<u32>) -> Ran {
    let ran = compress(gpu(), size, options, keys);
    match fault(&ran) {
        Ok([all, same]) => assert!((same + 2) * 20 >= all * 19, "{options:?}: {same} of {all} texels as defined"),
        Err(text) => panic!("{options:?}, a map of {size}: {text}"),
    }
    ran
}

fn key(depth: f32) -> u32 {
    !depth.to_bits()
}

/// Depths without order, or few different ones, or of three planes one behind the other with ragged borders; some texels have none.
fn keys(size: u32, kind: u32, random: &mut Random) -> Vec<u32> {
    let mut of = |k: u32| {
        let [x, y] = [k % size, k / size];
        let chance = random.below(1 << 20);
        let loose = chance as f32 / (1 << 20) as f32;
        match kind {
            0 if chance.is_multiple_of(5) => 0,
            0 => key(loose),
            1 => key([0.25, 0.5, 0.500_000_3, 0.75][chance as usize % 4]),
            _ if (x / 3 + y / 5 + chance % 2).is_multiple_of(7) => 0,
            _ => {
                let plane = (x / 5 + y / 3 + u32::from(chance.is_multiple_of(8))) % 3;
                let [near, across] = [[0.1, 2e-3], [0.4, -1e-4], [0.8, 1e-5]][plane as usize];
                key((near + across * (x as f32 + 0.3 * y as f32)).clamp(0.0, 4.5))
            }
        }
    };
    (0..size * size).map(&mut of).collect()
}

#[gpu_test]
fn empty() {
    for options in ALL {
        let ran = check(24, options, vec![0; 24 * 24]);
        assert!(ran.deep.iter().all(|word| *word == 0) && ran.worst == [0; 2]);
    }
}

/// A wall in the left half of a texel, and behind it nothing, or something.
#[gpu_test]
fn one() {
    let wall = [0.5, 0.5, 0.0, 0.0].repeat(4);
    let of = |behind: f32| wall.iter().map(|&d| if d > 0.0 { key(d) } else { key(behind) }).collect::<Vec<u32>>();
    let node = |depth: f32, off: u32, light: u32| ((depth * 4_194_304.0) as u32 + off) << 8 | light;
    let exact = DeepMapOptions { error: 0.0, ..PLAIN };
    let ran = check(4, exact, of(0.75));
    let nodes = [node(0.5, 0, 128), node(0.5, 1, 64), node(0.75, 0, 64), node(0.75, 1, 0)];
    assert_eq!(ran.deep[..6], [&[4][..], &nodes, &[0]].concat());
    assert_eq!(ran.worst, [0; 2]);
    let alone = check(4, exact, wall.iter().map(|&d| if d > 0.0 { key(d) } else { 0 }).collect());
    assert_eq!(alone.deep[..4], [2, nodes[0], nodes[1], 0]);
    // Depths beyond all others shadow nothing.
    assert_eq!(check(4, exact, of(4.0)).deep, alone.deep);
    // Three nodes do not do: a single line is off by half, and says so.
    let few = check(4, DeepMapOptions { nodes: 3, ..PLAIN }, of(0.75));
    assert_eq!(few.worst, [ERROR_UNIT / 2, 1]);
}

#[gpu_test]
fn every_size_around_workgroup() {
    let mut random = Random::new(1);
    for options in ALL {
        for size in sizes_around(16) {
            check(size as u32, options, keys(size as u32, 2, &mut random));
        }
    }
}

#[gpu_test]
fn random_seeded() {
    let mut random = Random::new(2);
    for options in ALL {
        for (kind, size) in [(0, 64), (1, 40), (2, 128), (2, 61), (0, 1), (1, 3)] {
            check(size, options, keys(size, kind, &mut random));
        }
    }
}

/// Nodes are fewer than steps where surfaces are even: ramps of a slope take two.
#[gpu_test]
fn degenerate() {
    for sub_texels in [2, 4, 8] {
        // Steps one behind the other, evenly, and a little more than one of them.
        let down = 1e-3 / sub_texels as f32;
        let ramp = (0..64 * 64).map(|k| key(0.2 + 1e-3 * (k % 64) as f32 + down * (k / 64) as f32)).collect();
        let error = 1.01 / (sub_texels * sub_texels) as f32;
        let ran = check(64, DeepMapOptions { sub_texels, error, nodes: 7 }, ramp);
        let taken = ran.deep.chunks_exact(8).map(|texel| texel[0] & 0xffff).max();
        assert!(taken <= Some(3) && ran.worst[1] == 0, "{sub_texels}: {taken:?} nodes, worst {:?}", ran.worst);
    }
    // All at one place, at the least and the greatest depth, and neighbours.
    for depth in [0.0f32, 1e-30, 1.0, 3.999_999, 0.5] {
        let texels = (0..64).map(|k| key(if k % 3 == 0 { depth.next_up() } else { depth })).collect();
        check(8, DeepMapOptions { error: 0.0, ..PLAIN }, texels);
    }
}

/// More texels than one dimension of a dispatch holds workgroups; the stage has no list.
#[gpu_test]
fn beyond_one_dimension() {
    let options = DeepMapOptions { sub_texels: 8, nodes: 2, error: 0.5 };
    let size = 257 * 8;
    let made = compress(gpu(), size, options, keys(size, 2, &mut Random::new(4)));
    assert!(made.deep.len() / 3 > 65_535 && !made.deep.contains(&POISON));
    // The last row is that of a map of its own.
    let rows = (size * 8) as usize;
    let mut alone = vec![0; made.keys.len()];
    alone[..rows].copy_from_slice(&made.keys[made.keys.len() - rows..]);
    let first = compress(gpu(), size, options, alone).deep;
    assert!(first[..257 * 3] == made.deep[made.deep.len() - 257 * 3..], "another last row");
}

#[gpu_test]
fn two_d_dispatch() {
    // Nine workgroups in three rows.
    let keys = keys(24, 2, &mut Random::new(5));
    let of = |gpu| {
        let ran = compress(gpu, 24, PLAIN, keys.clone());
        (ran.deep, ran.worst)
    };
    assert!(of(folding_gpu()) == of(gpu()), "the fold changes the result");
}

#[gpu_test]
fn detects_corruption() {
    let made = keys(64, 2, &mut Random::new(6));
    let of = || compress(gpu(), 64, PLAIN, made.clone());
    let ran = check(64, PLAIN, made.clone());
    assert!(ran.deep == of().deep && ran.worst == of().worst, "another result in a second run");
    let spoilt = |spoil: &dyn Fn(&mut Ran)| {
        let mut off = of();
        spoil(&mut off);
        fault(&off).is_err()
    };
    let texel = ran.deep.chunks_exact(8).position(|t| t[0] & 0xffff > 3).expect("a texel of several nodes") * 8;
    // A node higher, nearer, farther; one fewer; another order.
    assert!(spoilt(&|r| r.deep[texel + 2] += 8) && spoilt(&|r| r.deep[texel + 2] -= 8));
    assert!(spoilt(&|r| r.deep[texel + 1] -= 1 << 8) && spoilt(&|r| r.deep[texel + 3] += 40 << 8));
    assert!(spoilt(&|r| r.deep[texel] -= 1) && spoilt(&|r| r.deep.swap(texel + 2, texel + 3)));
    // The difference that is told; of all the greatest, and how many.
    assert!(spoilt(&|r| r.deep[texel] += 2 << 16));
    assert!(spoilt(&|r| r.worst[0] += 1) && spoilt(&|r| r.worst[1] += 400));
    assert!(spoilt(&|r| r.deep.rotate_right(8)) && spoilt(&|r| r.deep.truncate(8)));
    assert!(spoilt(&|r| r.keys.rotate_right(1)));
    // Nodes that would fit a lesser error are no longer they.
    let loose = DeepMapOptions { error: 0.25, ..PLAIN };
    assert!(fault(&Ran { options: PLAIN, ..compress(gpu(), 64, loose, made.clone()) }).is_err());
}
