//! Many small lights in one frame, listed by tiles of the image, against traced truth.

use super::spots::{points, sixteen_spots, truth};
use super::*;
use oracle::reference::light_lists::{LightVolume, listed};
use oracle::truth::join_mask;
use subpixel_shadows::pass::{LightReach, LightTarget, ListedTarget, light_list_bytes, light_lists_wgsl};

const REACH: LightReach = LightReach { cone: true, range: 6.0 };

fn lists(entries: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let size = light_list_bytes(SIZE, entries);
    gpu().device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
}

fn listing(settings: Settings, mesh: &Mesh, method: MethodName, strips: u32) -> ShadowPass {
    let casters = Casters::Static { positions: &mesh.positions, triangles: &mesh.triangles };
    let config = PassConfig { method, strips, light_lists: true, ..PassConfig::new(settings, casters) };
    ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
}

/// Lists of lights once all frames but for lists that are too short are complete, and the statuses.
fn frames(
    pass: &mut ShadowPass,
    camera: &Camera,
    lights: &[LightTarget],
    lists: &wgpu::Buffer,
) -> (Vec<u32>, Vec<Option<FrameStatus>>) {
    let inputs = Inputs::new(camera, &lights[0].light);
    for _ in 0..6 {
        let mut encoder = gpu().encoder();
        let frames = pass.record_light_lists(&mut encoder, &inputs, lights, lists).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        let statuses: Vec<_> = frames.iter().map(|frame| frame.map(|_| status_of(pass))).collect();
        gpu().check().expect("no error of the device");
        let short = |status: &FrameStatus| status.lists.iter().any(|list| list.needed > list.capacity);
        if !statuses.iter().flatten().any(|status| short(status) || status.error.is_some()) {
            return (read(lists), statuses);
        }
    }
    panic!("no lists of the pass that suffice");
}

fn targets(lights: &[Light]) -> Vec<LightTarget<'static>> {
    lights.iter().map(|light| LightTarget { reach: REACH, ..LightTarget::new(*light, Target::default()) }).collect()
}

/// The words that an application's shader reads: visibility by light of every pixel, and how many lights its tile has.
fn shaded(lists: &wgpu::Buffer, lights: usize) -> (Vec<f32>, Vec<u32>) {
    let device = &gpu().device;
    let [width, height] = SIZE;
    let text = format!(
        "{}
        @group(0) @binding(0) var<storage, read_write> shown: array<f32>;
        @compute @workgroup_size(64) fn show(@builtin(global_invocation_id) id: vec3<u32>) {{
            let pixel = vec2<u32>(id.x % {width}u, id.x / {width}u);
            if pixel.y >= {height}u {{ return; }}
            var count = 0.0;
            for (var entry = first_light(pixel); entry != 0u;) {{
                let one = listed_light(entry, pixel);
                shown[id.x * {}u + one.light] = one.visibility;
                entry = one.next;
                count += 1.0;
            }}
            shown[id.x * {}u + {lights}u] = select(-1.0, count, lists_all_lights(pixel));
        }}",
        light_lists_wgsl(0, 1),
        lights + 1,
        lights + 1,
    );
    let source = wgpu::ShaderSource::Wgsl(text.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: None,
        compilation_options: Default::default(),
        cache: None,
    });
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let size = 4 * (PIXELS * (lights + 1)) as u64;
    let shown = device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
    let entries =
        [&shown, lists].map(|buffer| wgpu::BindingResource::Buffer(buffer.as_entire_buffer_binding())).into_iter();
    let entries: Vec<_> =
        entries.zip(0..).map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource }).collect();
    let layout = &pipeline.get_bind_group_layout(0);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries });
    let mut encoder = gpu().encoder();
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups((PIXELS as u32).div_ceil(64), 1, 1);
    }
    gpu().submit_and_wait(encoder).expect("it runs");
    let all: Vec<f32> = bytemuck::cast_vec(read(&shown));
    let counts = all.chunks(lights + 1).map(|pixel| pixel[lights] as i32 as u32).collect();
    (all.chunks(lights + 1).flat_map(|pixel| pixel[..lights].to_vec()).collect(), counts)
}

/// Sixteen spots and two that the image does not show: every byte of which truth is sure is that of truth, nothing is listed that is dark in its
/// tile, and lists that are too short hold nothing wrong.
#[gpu_test]
fn sixteen_spots_are_listed() {
    let (scene, mut lights) = sixteen_spots();
    // Behind the camera, and far to the side.
    let away = |position| Light::Spot { position, target: [0.0, 0.0, 40.0], angle_degrees: 30.0 };
    lights.insert(5, away([0.0, 6.0, 20.0]));
    lights.push(away([60.0, 1.0, 0.0]));
    let settings = settings(FacetMode::All, 32);
    let lit_at = points(&scene, &settings.samples);
    let mut pass = listing(settings.clone(), &scene.mesh, MethodName::FacetMasks, 1);
    let buffer = lists(2000);
    let (words, statuses) = frames(&mut pass, &scene.camera, &targets(&lights), &buffer);
    let missed: Vec<usize> = (0..18).filter(|k| statuses[*k].is_none()).collect();
    assert_eq!(missed, [5, 17]);
    assert!(statuses.iter().flatten().all(|status| status.complete), "{statuses:?}");
    let last = statuses[16].as_ref().and_then(|status| status.light_lists.clone()).expect("lists");
    assert_eq!((last.needed, last.capacity), (u64::from(words[0]), 2000));
    let of = |words: &[u32], pixel: usize| listed(words, [pixel % SIZE[0] as usize, pixel / SIZE[0] as usize]);
    let bytes: Vec<_> = (0..PIXELS).map(|pixel| of(&words, pixel)).collect();
    let tiles = (words[3] as usize, 17.0);
    assert!((last.needed as f64) < 0.5 * tiles.0 as f64 * tiles.1, "{} entries of {tiles:?}", last.needed);
    let [mut sure, mut wrong, mut lit] = [0; 3];
    for (k, light) in lights.iter().enumerate().filter(|(k, _)| !missed.contains(k)) {
        let Light::Spot { target, angle_degrees, .. } = *light else { unreachable!() };
        let at = light.homogeneous().truncate();
        let axis = (Vec3::from(target).as_dvec3() - at).normalize();
        let cone = Some((axis, (f64::from(angle_degrees).to_radians() / 2.0).cos()));
        let reach = LightVolume { at, range: f64::from(REACH.range), cone };
        let truth = truth(&scene, light, &settings.samples);
        for (pixel, p) in truth.pixels.iter().enumerate() {
            let within = |k: usize| lit_at[32 * pixel + k].map_or(-1.0, |point| reach.within(point));
            let ends = (0..32).any(|k| within(k).abs() < 1e-4);
            if ends || join_mask(p.ambiguous) != 0 {
                continue;
            }
            let reached = (0..32).filter(|k| within(*k) > 0.0).fold(0u128, |mask, k| mask | 1 << k);
            let (seen, bright) = (join_mask(p.seen).count_ones(), (join_mask(p.lit) & reached).count_ones());
            let want = if bright == 0 { 0 } else { ((510 * bright + seen) / (2 * seen)) as u8 };
            let got = bytes[pixel].0.iter().find(|(light, _)| *light == k as u32).map_or(0, |(_, byte)| *byte);
            sure += 1;
            wrong += usize::from(got != want);
            lit += usize::from(want > 0 && want < 255);
        }
    }
    eprintln!("{sure} pixels of lights, {lit} of them in part lit, {wrong} wrong; {} entries", last.needed);
    assert!(wrong == 0 && sure > 70_000 && lit > 500, "{wrong} of {sure} wrong, {lit} in part lit");
    // As a shader reads it.
    let (shown, counts) = shaded(&buffer, 18);
    for pixel in 0..PIXELS {
        let mut want = [0.0; 18];
        bytes[pixel].0.iter().for_each(|(light, byte)| want[*light as usize] = f32::from(*byte) / 255.0);
        let off = |(a, b): (&f32, &f32)| (a - b).abs() > 1e-6;
        assert!(!shown[18 * pixel..][..18].iter().zip(&want).any(off), "pixel {pixel}");
        assert!(counts[pixel] as usize >= bytes[pixel].0.len() && counts[pixel] <= 16, "{}", counts[pixel]);
    }
    // Half the room, and none.
    for entries in [last.needed - 1, last.needed / 2, 0] {
        let short = lists(entries);
        let (words, statuses) = frames(&mut pass, &scene.camera, &targets(&lights), &short);
        let told = statuses[16].as_ref().expect("a frame");
        let list = told.light_lists.clone().expect("lists");
        assert!(told.overflowed && !told.complete, "{told:?}");
        assert_eq!([list.needed, list.capacity], [last.needed, entries]);
        let mut lacking = 0;
        for (pixel, all) in bytes.iter().enumerate() {
            let (got, complete) = of(&words, pixel);
            assert_eq!(got[..], all.0[..got.len()], "pixel {pixel} of lists of {entries}");
            assert!(!complete || got.len() == all.0.len(), "pixel {pixel} of lists of {entries}");
            lacking += usize::from(!complete);
        }
        assert!(lacking > 0 && shaded(&short, 18).1.iter().filter(|c| **c == u32::MAX).count() == lacking);
    }
    // Strips of rows, and rays.
    for (method, strips) in [(MethodName::FacetMasks, 4), (MethodName::RayTraced, 1)] {
        let mut other = listing(settings.clone(), &scene.mesh, method, strips);
        let (got, _) = frames(&mut other, &scene.camera, &targets(&lights), &buffer);
        assert_eq!(got[..last.needed as usize * 18], words[..last.needed as usize * 18], "{method:?}, {strips} strips");
    }
}

/// A method of one surface a pixel, and lights of two passes in one list: bytes are those of the visibility of each.
#[gpu_test]
fn passes_share_lists() {
    let (scene, lights) = sixteen_spots();
    let far = Settings { facets: FacetMode::One, ..settings(FacetMode::All, 32) };
    let first = &mut listing(settings(FacetMode::All, 32), &scene.mesh, MethodName::FacetMasks, 1);
    let second = &mut listing(far, &scene.mesh, MethodName::Pcf, 1);
    let buffer = lists(500);
    let sun = Light::Directional { direction: [0.4, 1.0, 0.3] };
    let inputs = Inputs::new(&scene.camera, &sun);
    for _ in 0..4 {
        let mut encoder = gpu().encoder();
        let to =
            |light, begin| Target { listed: Some(ListedTarget { lists: &buffer, light, begin }), ..Target::default() };
        let asked = [
            (0, LightTarget::new(sun, to(7, true))),
            (1, LightTarget { reach: REACH, ..LightTarget::new(lights[3], to(2, false)) }),
        ];
        // Passes are recorded one after the other.
        let mut passes = [&mut *first, &mut *second];
        ShadowPass::record_by_method(&mut passes, &mut encoder, &inputs, &asked).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        let [one, two] = [status_of(first), status_of(second)];
        if one.complete && two.complete {
            break;
        }
    }
    let words = read(&buffer);
    let visibility = |pass: &ShadowPass| bytemuck::cast_vec::<u32, f32>(read(pass.visibility()));
    let [sunlit, spotlit] = [visibility(first), visibility(second)];
    let seen = raster(&scene.mesh, &scene.camera);
    let mut listed_spot = 0;
    for pixel in 0..PIXELS {
        let (got, complete) = listed(&words, [pixel % SIZE[0] as usize, pixel / SIZE[0] as usize]);
        assert!(complete);
        let of = |light: u32| got.iter().find(|(k, _)| *k == light).map_or(0, |(_, byte)| *byte);
        let byte = |v: f32| (255.0 * v).round() as u8;
        if seen.triangles[pixel].is_some() {
            // Quotients half way between two bytes are rounded either way.
            assert!(of(7).abs_diff(byte(sunlit[pixel])) <= 1, "pixel {pixel}");
            assert!(of(2) == 0 || of(2) == byte(spotlit[pixel]), "pixel {pixel}");
        }
        listed_spot += usize::from(of(2) != 0);
    }
    assert!((40..PIXELS / 4).contains(&listed_spot), "{listed_spot}");
}

#[gpu_test]
fn bad_lists_are_refused() {
    let (scene, lights) = sixteen_spots();
    let settings = settings(FacetMode::All, 8);
    let mut with = listing(settings.clone(), &scene.mesh, MethodName::FacetMasks, 1);
    let mut encoder = gpu().encoder();
    let inputs = Inputs::new(&scene.camera, &lights[0]);
    let mut ask = |pass: &mut ShadowPass, lists: &wgpu::Buffer| {
        pass.record_light_lists(&mut encoder, &inputs, &targets(&lights[..2]), lists).map(|_| 0)
    };
    let buffer = |size, usage| {
        gpu().device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let least = light_list_bytes(SIZE, 0);
    refused("lacks STORAGE", ask(&mut with, &buffer(least, wgpu::BufferUsages::COPY_DST)));
    refused(&format!("{least} are needed"), ask(&mut with, &buffer(least - 4, wgpu::BufferUsages::STORAGE)));
    let good = buffer(least, wgpu::BufferUsages::STORAGE);
    refused("made without", ask(&mut pass(settings.clone(), &scene.mesh), &good));
    let casters = Casters::Static { positions: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    let config = PassConfig { light_lists: true, keep_last: true, ..PassConfig::new(settings.clone(), casters) };
    let mut keeps = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    refused("last picture", ask(&mut keeps, &good));
    let filter = subpixel_shadows::pixel_filter::PixelFilter::Tent;
    let settings = Settings { filter, ..settings };
    let config = PassConfig { light_lists: true, ..PassConfig::new(settings, casters) };
    let made = ShadowPass::new(&gpu().device, &gpu().queue, &config).map(|_| 0);
    refused("filter Tent", made);
}
