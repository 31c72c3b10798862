//! The work of each pixel in numbers.

use super::*;
use subpixel_shadows::methods::{DebugViews, MethodName, PixelClass};
use subpixel_shadows::stages::pixel_counts::PixelCounts;

const PIXELS: usize = (SIZE[0] * SIZE[1]) as usize;

/// Picture and counts of the first complete frame.
fn counted(config: &PassConfig, inputs: &Inputs) -> (Vec<u32>, FrameStatus, Vec<PixelCounts>) {
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, config).expect("a pass");
    let counts = buffer(16 * PIXELS as u64, BufferUsages::COPY_DST | BufferUsages::COPY_SRC);
    let staging = buffer(counts.size(), BufferUsages::COPY_DST | BufferUsages::MAP_READ);
    for _ in 0..4 {
        let targets = Targets::new();
        let target = Target { lit: None, counts: Some(&counts), ..targets.target() };
        let mut encoder = gpu().encoder();
        pass.record(&mut encoder, inputs, &target).expect("recorded");
        encoder.copy_buffer_to_buffer(&counts, 0, &staging, 0, counts.size());
        gpu().submit_and_wait(encoder).expect("the frame runs");
        let status = status_of(&mut pass);
        if status.complete {
            staging.map_async(wgpu::MapMode::Read, .., |_| {});
            gpu().wait(None).expect("the copy runs");
            let counts = bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).expect("mapped"));
            return (targets.read().0[..PIXELS].to_vec(), status, counts);
        }
    }
    panic!("no frame is complete");
}

/// Results that the renderer reads back to be looked at.
fn looks(scene: &Scene, config: &PassConfig) -> DebugViews {
    let prepared = Prepared::new(&scene.mesh).expect("a sound mesh");
    let settings = Settings { count_pixels: false, ..config.settings.clone() };
    let renderer = Renderer::of_method(gpu(), &prepared, config.method, &settings, Budget::default());
    let looked = renderer.and_then(|mut renderer| renderer.render_and_look(&scene.camera, &scene.light));
    looked.expect("a frame").1.unwrap_or_default()
}

fn sum(counts: &[PixelCounts], of: fn(&PixelCounts) -> u32) -> u64 {
    counts.iter().map(|c| u64::from(of(c))).sum()
}

/// Counts are those of the frame's own counters and of what is read back; they change no bit, and strips change none of them.
#[gpu_test]
fn counts_are_the_frames() {
    let scene = scene("bicycle");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    for (facets, pairs) in [
        (FacetMode::All, PairVariant::Tiled),
        (FacetMode::All, PairVariant::Sorted),
        (FacetMode::One, PairVariant::Grouped),
    ] {
        let plain = Settings { pairs, ..settings(facets) };
        let (want, _) = complete(&mut pass(plain.clone(), casters(&scene.mesh)), &inputs);
        let with = Settings { count_pixels: true, ..plain };
        // Maps that are kept are wider, and settle other facets.
        let config = PassConfig { keep_maps: false, ..PassConfig::new(with, casters(&scene.mesh)) };
        let (picture, status, counts) = counted(&config, &inputs);
        let what = format!("{facets:?}, {pairs:?}");
        assert!(picture == want.0[..PIXELS], "{what}: the picture");
        let of = &status.counts;
        assert_eq!(sum(&counts, |c| c.facets), of.facets - of.empty_facets, "{what}");
        assert_eq!(sum(&counts, |c| c.pairs), of.visibility_evaluations, "{what}");
        if pairs != PairVariant::Tiled {
            assert_eq!(sum(&counts, |c| c.texels), of.pixel_texel_pairs, "{what}");
        }
        let classes: Vec<_> = counts.iter().map(|c| PixelClass::ALL[c.state as usize]).collect();
        let share = |class| classes.iter().filter(|c| **c == class).count() as u64;
        assert!(looks(&scene, &config).classes == classes, "{what}: classes");
        assert!(
            [PixelClass::Lit, PixelClass::Undecided].into_iter().all(|class| share(class) > 100),
            "{what}: classes"
        );
        // Only what is undecided touches texels.
        for pixel in &counts {
            let undecided = pixel.state == PixelClass::Undecided as u32;
            assert!(undecided || (pixel.texels, pixel.pairs) == (0, 0), "{what}: {pixel:?}");
        }
        assert!(counts.iter().any(|c| c.texels > 4 && c.pairs > 2), "{what}");
        assert_eq!(counts.iter().any(|c| c.facets > 1), facets == FacetMode::All, "{what}");
        let (in_strips, _, of_strips) = counted(&PassConfig { strips: 3, ..config }, &inputs);
        assert!(in_strips == picture, "{what}: the picture in strips");
        let fixed = |c: &PixelCounts| (c.state, c.facets, c.texels);
        assert!(of_strips.iter().map(fixed).eq(counts.iter().map(fixed)), "{what}: counts in strips");
    }
}

/// Other methods count what they have.
#[gpu_test]
fn other_methods_count_what_they_have() {
    let scene = scene("bicycle");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let config = |method, settings| PassConfig { method, ..PassConfig::new(settings, casters(&scene.mesh)) };
    let with = Settings { count_pixels: true, ..settings(FacetMode::All) };
    let (.., ours) = counted(&config(MethodName::FacetMasks, with.clone()), &inputs);
    for method in [MethodName::RayTraced, MethodName::Supersampled] {
        let (_, _, counts) = counted(&config(method, with.clone()), &inputs);
        let facets = |counts: &[PixelCounts]| counts.iter().map(|c| c.facets).collect::<Vec<_>>();
        assert!(facets(&counts) == facets(&ours), "{method:?}");
        assert_eq!((sum(&counts, |c| c.texels), sum(&counts, |c| c.pairs)), (0, 0), "{method:?}");
        assert!(counts.iter().any(|c| c.state == PixelClass::Undecided as u32), "{method:?}");
    }
    let spsm = config(MethodName::Spsm, with.clone());
    let (_, _, counts) = counted(&spsm, &inputs);
    let classes = looks(&scene, &spsm).classes;
    let seen = counts.iter().map(|c| PixelClass::ALL[c.state as usize]);
    assert!(classes.iter().copied().eq(seen), "spsm");
    assert!(classes.contains(&PixelClass::Undecided) && classes.contains(&PixelClass::Lit));
}

/// Settings that cannot be given are refused.
#[gpu_test]
fn counts_that_are_not_there_are_refused() {
    let scene = scene("plane");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let whole = buffer(16 * PIXELS as u64, BufferUsages::COPY_DST);
    let short = buffer(16 * PIXELS as u64 - 4, BufferUsages::COPY_DST);
    let other = buffer(16 * PIXELS as u64, BufferUsages::STORAGE);
    let with = |count_pixels| Settings { count_pixels, ..settings(FacetMode::One) };
    for (method, settings, counts, part) in [
        (MethodName::FacetMasks, with(false), &whole, "count_pixels"),
        (MethodName::Pcf, with(true), &whole, "facets or classes"),
        (MethodName::FacetMasks, with(true), &short, "are needed"),
        (MethodName::FacetMasks, with(true), &other, "COPY_DST"),
    ] {
        let config = PassConfig { method, ..PassConfig::new(settings, casters(&scene.mesh)) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let target = Target { counts: Some(counts), ..Target::default() };
        let refused = pass.record(&mut gpu().encoder(), &inputs, &target).expect_err(part).to_string();
        assert!(refused.contains(part), "{refused}");
        pass.record(&mut gpu().encoder(), &inputs, &Target::default()).expect("without counts it is one");
    }
}
