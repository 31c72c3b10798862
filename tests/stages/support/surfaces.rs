//! A run of the stages that find every surface a pixel's samples see, with everything they wrote.

use super::geometry::Case;
use super::{POISON, poisoned, read_padded, run, upload};
use std::collections::BTreeMap;
use subpixel_shadows::frame::{Frame, sample_box, sample_words};
use subpixel_shadows::gpu::kernels::sample_surfaces::STATE_MERGED;
use subpixel_shadows::gpu::recorder::fold_within;
use subpixel_shadows::gpu::{Buffer, Gpu, Groups, kernels};
use subpixel_shadows::methods::prepared::{marked_triangles, padded};
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::Mesh as Scene;
use subpixel_shadows::stages::camera_visibility::Blocks;
use subpixel_shadows::stages::compact::{Compact, Flags};
use subpixel_shadows::stages::facet_classify::{Facet, Facets};
use subpixel_shadows::stages::pixel_coverage::{self, Covering, PairCoverage, PixelCoverage};
use subpixel_shadows::stages::pixel_triangles::{PixelLists, PixelTriangles};
use subpixel_shadows::stages::sample_surfaces::{ComplexPixels, SampleSurfaces, SurfaceInputs, WORKGROUP};
use subpixel_shadows::stages::triangle_setup::{TriangleFacts, TriangleSetup};
use subpixel_shadows::stages::vertex_project::VertexProject;
use subpixel_shadows::stages::{Count, PrefixScan};
use subpixel_shadows::status_word;

/// Elements the lists can hold: triangles of pixels, complex pixels, facets.
pub type Room = [usize; 3];

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    pub image: [u32; 2],
    /// Needed elements of the three lists.
    pub needed: [usize; 3],
    /// Longest list of a complex pixel.
    pub longest: u32,
    /// Keys of the depths behind which a pixel is hidden, and behind them those of blocks.
    pub cover_keys: Vec<u32>,
    /// Triangles of each pixel, rising.
    pub lists: Vec<Vec<u32>>,
    /// Pixels whose samples were looked at one by one.
    pub complex: Vec<bool>,
    /// Surfaces of each pixel: triangle and mask.
    pub surfaces: Vec<Vec<(u32, u128)>>,
    /// Offset of the sample that each facet is placed at, facet by facet.
    pub origins: Vec<[f32; 2]>,
    /// Box around the samples of each facet, packed.
    pub spans: Vec<[u32; 2]>,
    pub id_keys: Vec<u32>,
    /// Samples that triangles cover, by pixel and triangle: what covers none is not there.
    pub covered: BTreeMap<(u32, u32), (u128, Covering)>,
    /// Of facets of several triangles how far off those reach at most, facet by facet.
    pub reach: Vec<Option<f32>>,
}

impl Found {
    /// What each sample of a pixel sees, or why its facets are none.
    pub fn samples(&self, pixel: usize, count: u32) -> Result<Vec<Option<u32>>, String> {
        let mut out = vec![None; count as usize];
        for &(triangle, mask) in &self.surfaces[pixel] {
            if mask == 0 || mask >> (count - 1) > 1 {
                return Err(format!("a facet of pixel {pixel} has mask {mask:x}"));
            }
            for (k, seen) in out.iter_mut().enumerate().filter(|(k, _)| mask >> k & 1 == 1) {
                if seen.replace(triangle).is_some() {
                    return Err(format!("sample {k} of pixel {pixel} lies in two facets"));
                }
            }
        }
        Ok(out)
    }
}

/// Whether a packed box is that around samples, a 256th of a pixel wider, and no more than what packing takes.
pub fn is_span(packed: [u32; 2], samples: &Samples, mask: u128) -> bool {
    let mut inside = samples.offsets().iter().enumerate().filter(|(k, _)| mask >> k & 1 == 1).map(|(_, o)| o);
    let unpack = |word: u32| [word as u16, (word >> 16) as u16].map(|half| f32::from(half as i16) / 32767.0);
    let [low, high] = packed.map(unpack);
    let first = inside.next().map_or([0.5; 2], |o| *o);
    let around = inside.fold([first; 2], |[low, high], o| {
        [[low[0].min(o[0]), low[1].min(o[1])], [high[0].max(o[0]), high[1].max(o[1])]]
    });
    let beyond = (0..2).flat_map(|axis| [around[0][axis] - 0.5 - low[axis], high[axis] + 0.5 - around[1][axis]]);
    beyond.into_iter().all(|more| (0.00390625..0.0041).contains(&more))
}

/// A pattern of the default kind.
pub fn pattern(count: u32) -> Samples {
    Samples::new(Pattern::default(), count).expect("a pattern")
}

/// The frame of a case, for lists of these sizes.
pub fn frame(case: &Case, samples: &Samples, room: Room) -> Frame {
    let mut frame = case.frame();
    frame.sample_count = samples.count();
    [frame.sample_low, frame.sample_high] = sample_box(samples);
    frame.flags |= Frame::CLAMP;
    [frame.pixel_triangle_capacity, frame.complex_capacity, frame.facets_total] = room.map(|n| n as u32);
    frame
}

/// Runs with as much room as is needed.
pub fn find(gpu: &Gpu, case: &Case, samples: &Samples) -> Found {
    let pixels = (case.image[0] * case.image[1]) as usize;
    let mut room = [pixels * 4 + 16, pixels, pixels * 2 + 16];
    let mut most = 1;
    loop {
        let found = find_within(gpu, case, samples, room, most);
        if found.needed.iter().zip(room).all(|(&needed, room)| needed <= room) && found.longest <= most {
            return found;
        }
        most = found.longest;
        room = std::array::from_fn(|k| room[k].max(found.needed[k]));
    }
}

/// Runs with this much room. Fails if anything is written beyond it.
pub fn find_within(gpu: &Gpu, case: &Case, samples: &Samples, room: Room, most: u32) -> Found {
    find_by(gpu, case, samples, room, most, How { merge: false, stale: &[] })
}

/// As [`find_within`], after the next pixel has taken the place of that of some pairs (pixel, triangle) in the list, as if
/// an older frame had left them.
pub fn find_with_stale(gpu: &Gpu, case: &Case, samples: &Samples, room: Room, stale: &[(u32, u32)]) -> Found {
    find_by(gpu, case, samples, room, 1, How { merge: false, stale })
}

#[derive(Clone, Copy)]
struct How<'a> {
    merge: bool,
    stale: &'a [(u32, u32)],
}

/// The same with one facet for the triangles of a surface.
pub fn find_merged(gpu: &Gpu, case: &Case, samples: &Samples, room: Room, most: u32) -> Found {
    find_by(gpu, case, samples, room, most, How { merge: true, stale: &[] })
}

fn find_by(gpu: &Gpu, case: &Case, samples: &Samples, room: Room, most: u32, how: How) -> Found {
    let device = &gpu.device;
    let words = samples.words();
    let uniform = Buffer::uniform(device, "frame", 1).expect("memory");
    uniform.write(&gpu.queue, &[frame(case, samples, room)]);
    let offsets_of_samples = Buffer::uniform(device, "samples", 64).expect("memory");
    offsets_of_samples.write(&gpu.queue, &sample_words(samples));
    let frame = &uniform;
    let positions = upload(gpu, &padded(case.positions()));
    let triangles = upload(gpu, &marked_triangles(&case.prepared, case.prepared.mesh().triangles.len()));
    let (vertices, count) = (positions.len(), triangles.len());
    let pixels = (case.image[0] * case.image[1]) as usize;
    let memory = "memory";
    let points = Buffer::storage(device, "test.points", vertices).expect(memory);
    let facts = TriangleFacts::new(device, count).expect(memory);
    run(gpu, |s| {
        VertexProject::new(device).record_place(s, frame, &positions, &points);
        TriangleSetup::new(device).record_camera(s, frame, &triangles, &points, &facts, count)
    });
    let scan = PrefixScan::new(device);
    let scratch = PrefixScan::scratch(device, pixels.max(count)).expect(memory);
    let work = Buffer::storage(device, "test.work", count + 5).expect(memory);
    let args = [(); 3].map(|()| Buffer::<u32>::indirect(device, "test.args", 6).expect(memory));
    // Arguments are made here: the stage that makes them does not know of a device's smaller limits.
    let cover = |args: &Buffer<u32>, groups: [u32; 2]| {
        let most = device.limits().max_compute_workgroups_per_dimension;
        args.write(&gpu.queue, &groups.map(|g| fold_within(u64::from(g), most)).concat());
    };
    // What blocks touch is kept from counting to emitting for none, few or many of them.
    let touched = Buffer::storage(device, "test.touched", [0, 7, 1 << 16][count % 3]).expect(memory);
    let lists =
        PixelLists { list: poisoned(gpu, room[0]), touched, ..PixelLists::new(device, pixels, 1).expect(memory) };
    let coverage = PairCoverage { list: poisoned(gpu, room[0]), masks: poisoned(gpu, room[0] * words as usize) };
    let complex = ComplexPixels {
        pixels: poisoned(gpu, room[1]),
        contested: poisoned(gpu, room[1] * words as usize),
        slots: poisoned(gpu, room[1]),
        ..ComplexPixels::new(device, room[1], words as usize).expect(memory)
    };
    let facets = Facets {
        masks: poisoned(gpu, room[2] * 3 * words as usize),
        ..Facets::new(device, room[2], pixels, words as usize).expect(memory)
    };
    let id_keys = Buffer::storage(device, "test.id_keys", pixels).expect(memory);
    let status = Buffer::storage(device, "test.status", 32).expect(memory);
    let compact = Compact::new(device, &scan);
    let compact_scratch = Compact::scratch(device, pixels).expect(memory);
    run(gpu, |s| scan.record(s, &facts.camera_items, &work, (&work, count), &scratch, Count::Exactly(count)));
    cover(&args[0], [work.read(gpu).expect("readback")[count].div_ceil(kernels::pixel_triangles::WORKGROUP), 0]);
    let blocks = Blocks {
        triangles: &triangles,
        points: &points,
        rects: &facts.camera_rects,
        facing: &facts.facing,
        offsets: &work,
        args: (args[0].raw(), 0),
    };
    let find = PixelTriangles::new(device, &scan);
    run(gpu, |s| find.record(s, frame, blocks, blocks.args, &lists, &id_keys, &scratch, &status));
    if !how.stale.is_empty() {
        let mut list = lists.list.read(gpu).expect("readback");
        for pair in list.iter_mut().filter(|pair| how.stale.contains(&(pair.pixel, pair.triangle))) {
            pair.pixel = (pair.pixel + 1) % pixels as u32;
        }
        lists.list.write(&gpu.queue, &list);
    }
    let (flags, kept) = (Flags::Words(&lists.complex_flags), &complex.pixels);
    run(gpu, |s| compact.record(s, flags, None, kept, (&complex.total, 0), &compact_scratch, Count::Exactly(pixels)));
    let found = complex.total.read(gpu).expect("readback")[0].min(room[1] as u32);
    cover(&args[1], [found.div_ceil(WORKGROUP), 0]);
    let casters = case.prepared.upload(device, &gpu.queue).expect(memory);
    let holes = !case.prepared.alpha().is_empty();
    let mesh = SurfaceInputs {
        samples: &offsets_of_samples,
        triangles: if holes { &casters.triangles } else { &triangles },
        points: &points,
        positions: &positions,
        surfaces: casters.surfaces.as_ref(),
    };
    let build = if how.merge { SampleSurfaces::merging } else { SampleSurfaces::new };
    let stage = build(device, &scan, samples.count());
    let per_pixel = (args[1].raw(), 0);
    let pairs = lists.offsets.read(gpu).expect("readback")[pixels].min(room[0] as u32);
    cover(&args[2], [pairs.div_ceil(pixel_coverage::WORKGROUP), 0]);
    let groups = Groups::Indirect(args[2].raw(), 0);
    run(gpu, |s| PixelCoverage::new(device, samples.count(), holes).record(s, frame, mesh, &lists, &coverage, groups));
    let list = lists.list.read(gpu).expect("readback");
    let covered = covered(gpu, &lists, &coverage, words as usize);
    run(gpu, |s| {
        stage.record(s, frame, mesh, &lists, &coverage, &complex, per_pixel, most, &scratch, &facets, &id_keys)
    });

    let padded = |words: Vec<u32>, len: usize, label: &str| {
        assert!(words[len..].iter().all(|&w| w == POISON), "written past {len} words of '{label}'");
    };
    let wide = words as usize;
    padded(read_padded(gpu, &complex.pixels), room[1], complex.pixels.label());
    padded(read_padded(gpu, &complex.contested), room[1] * wide, complex.contested.label());
    padded(read_padded(gpu, &coverage.masks), room[0] * wide, coverage.masks.label());
    padded(read_padded(gpu, &facets.masks), facets.masks.len(), facets.masks.label());
    padded(read_padded(gpu, &lists.list), 2 * room[0], lists.list.label());
    padded(read_padded(gpu, &coverage.list), 5 * room[0], coverage.list.label());
    padded(read_padded(gpu, &complex.slots), 5 * room[1], complex.slots.label());
    let readback = "readback";
    let counts = lists.counts.read(gpu).expect(readback);
    let all = complex.total.read(gpu).expect(readback)[0] as usize <= room[1];
    assert!(counts.iter().all(|&c| c == 0) || pixels == 0 || !all, "counts left over");
    let offsets: Vec<usize> = lists.offsets.read(gpu).expect(readback).iter().map(|&o| o as usize).collect();
    let pixel_facets: Vec<usize> = facets.pixel_facets.read(gpu).expect(readback).iter().map(|&f| f as usize).collect();
    let made = facets.list.read(gpu).expect(readback);
    let masks = facets.masks.read(gpu).expect(readback);
    let within = |all: &[usize], pixel: usize, room: usize| all[pixel].min(room)..all[pixel + 1].min(room);
    let mask = |f: usize| {
        let first = f * 3 * words as usize;
        masks[first..first + words as usize].iter().rev().fold(0u128, |mask, &w| mask << 32 | u128::from(w))
    };
    let needed = [offsets[pixels], complex.total.read(gpu).expect(readback)[0] as usize, pixel_facets[pixels]];
    let fits = needed.iter().zip(room).all(|(&needed, room)| needed <= room);
    let keys = id_keys.read(gpu).expect(readback);
    let flags: Vec<bool> = lists.complex_flags.read(gpu).expect(readback).iter().map(|&f| f != 0).collect();
    // The one triangle of a single pixel is not in the list.
    let listed = |pixel: usize| {
        let all = &list[within(&offsets, pixel, room[0])];
        let own = all.iter().all(|pair| pair.pixel as usize == pixel);
        assert!(own || !fits || !how.stale.is_empty(), "the pixel of a listed triangle");
        let mut listed: Vec<_> = all.iter().map(|pair| pair.triangle).collect();
        listed.sort_unstable();
        if !flags[pixel] && keys[pixel] != 0 {
            listed.push(!keys[pixel]);
        }
        listed
    };
    let surfaces = |pixel| {
        let facet = |f: usize| {
            assert!(made[f].pixel as usize == pixel || !fits, "the pixel of facet {f}");
            (made[f].triangle, mask(f))
        };
        within(&pixel_facets, pixel, room[2]).map(facet).collect()
    };
    assert!(made[pixel_facets[pixels].min(room[2])..].iter().all(|f| f.triangle == u32::MAX), "a facet too many");
    let reach = |f: &Facet| (f.state == STATE_MERGED).then_some(f.limit);
    Found {
        image: case.image,
        reach: made[..pixel_facets[pixels].min(room[2])].iter().map(reach).collect(),
        needed,
        longest: status.read(gpu).expect(readback)[status_word!(longest_pixel)],
        cover_keys: lists.cover_keys.read(gpu).expect(readback),
        lists: (0..pixels).map(listed).collect(),
        complex: flags.clone(),
        surfaces: (0..pixels).map(surfaces).collect(),
        origins: made[..pixel_facets[pixels].min(room[2])].iter().map(|f| f.origin).collect(),
        spans: made[..pixel_facets[pixels].min(room[2])].iter().map(|f| f.span).collect(),
        id_keys: keys.clone(),
        covered,
    }
}

/// Masks that `pixel_coverage` left, by pixel and triangle.
fn covered(
    gpu: &Gpu,
    lists: &PixelLists,
    coverage: &PairCoverage,
    words: usize,
) -> BTreeMap<(u32, u32), (u128, Covering)> {
    let readback = "readback";
    let (list, masks) = (coverage.list.read(gpu).expect(readback), coverage.masks.read(gpu).expect(readback));
    let counts = lists.counts.read(gpu).expect(readback);
    let offsets = lists.offsets.read(gpu).expect(readback);
    let mut out = BTreeMap::new();
    for (pixel, &count) in counts.iter().enumerate() {
        for n in offsets[pixel] as usize..(offsets[pixel] + count) as usize {
            let words = masks[n * words..(n + 1) * words].iter();
            let mask = words.rev().fold(0u128, |mask, &w| mask << 32 | u128::from(w));
            assert!(mask != 0, "pixel {pixel} has a triangle that covers nothing");
            assert!(
                out.insert((pixel as u32, list[n].triangle), (mask, list[n])).is_none(),
                "pixel {pixel} has a triangle twice"
            );
        }
    }
    out
}

/// A flat tessellated square seen from above, its lines through rows and columns of pixel centres, and through corners.
pub fn square(n: u32) -> Scene {
    let mut mesh = Scene::default();
    for j in 0..=n {
        for i in 0..=n {
            mesh.positions.push([2.0 * i as f32 / n as f32 - 1.0, 0.0, 2.0 * j as f32 / n as f32 - 1.0]);
        }
    }
    for j in 0..n {
        for i in 0..n {
            let at = |i: u32, j: u32| i + j * (n + 1);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
            mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
        }
    }
    mesh
}
