//! Images in strips, and maps in parts.

use super::*;

/// A map that is more than a binding holds, which is 128 MiB of a device that has no more than WebGPU's defaults.
#[gpu_test]
fn a_map_larger_than_a_binding_is_cut() {
    let scene = scene("plane");
    let small = settings(FacetMode::One);
    let (output, _) = rendered(&scene.mesh, &scene.camera, &scene.light, &small);
    let settings = Settings { map: 5800, ..small };
    let parts = MapTiles::within(settings.map, &gpu().device.limits()).across();
    let bound = gpu().device.limits().max_storage_buffer_binding_size;
    assert!(parts == 2 || bound > 128 << 20, "{parts} parts a side where {bound} bytes are bound");
    let visibility: Vec<u32> = output.visibility.iter().map(|v| v.to_bits()).collect();
    let dark = output.visibility.iter().filter(|&&v| v < 1.0).count();
    assert!(dark > 100 && dark < visibility.len() - 100, "{dark} pixels in shadow");
    let buffer = vertex_buffer(&scene.mesh.positions);
    let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
    let still = Inputs::new(&scene.camera, &scene.light);
    let moving = Inputs { moved: Some(Moved { vertices, bounds: bounds(&scene.mesh) }), ..still };
    let moving_casters = Casters::Moving { rest: &scene.mesh.positions, triangles: &scene.mesh.triangles };
    for (what, casters, inputs) in [("still", casters(&scene.mesh), still), ("moving", moving_casters, moving)] {
        let mut pass = pass(settings.clone(), casters);
        let (got, _) = complete_within(4, &mut pass, &inputs);
        // Which samples of a pixel settled as lit see other surfaces is not looked at, and another map settles others.
        assert!(got.0[..visibility.len()] == visibility, "{what}: a pixel differs");
        assert_eq!((pass.capacities().views, pass.settings()), (parts.pow(2), &settings), "{what}");
    }
}

/// In strips of rows, as many as there may be, the picture is that of one piece: also of moved casters, with a cube of views, with
/// lists that grow from nothing, in another size, and with triangle numbers, whose faults are counted once.
#[gpu_test]
fn strips_are_the_whole() {
    let scene = scene("spheres");
    let mesh = &scene.mesh;
    let buffer = vertex_buffer(&mesh.positions);
    let vertices = Vertices { buffer: &buffer, offset: 16, stride: 32 };
    let moved = Some(Moved { vertices, bounds: bounds(mesh) });
    let moving = Casters::Moving { rest: &mesh.positions, triangles: &mesh.triangles };
    let still = Inputs::new(&scene.camera, &scene.light);
    let among = Light::Point { position: [0.8, 1.9, 0.9] };
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = settings(facets);
        let strips_of = |strips: u32, casters, start| {
            let budget = Budget { start, ..Budget::default() };
            let config = PassConfig { strips, budget, timing: true, ..PassConfig::new(settings.clone(), casters) };
            ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass")
        };
        for (what, casters, inputs, cuts) in [
            ("still", casters(mesh), still, &[2, 3, 61][..]),
            ("moving", moving, Inputs { moved, ..still }, &[4]),
            ("a light among them", casters(mesh), Inputs { light: &among, ..still }, &[3]),
        ] {
            let mut whole = strips_of(1, casters, None);
            let (want, in_one) = complete(&mut whole, &inputs);
            assert_eq!(whole.strips(), 1);
            for &strips in cuts {
                let mut pass = strips_of(strips, casters, None);
                assert_eq!(pass.strips(), strips);
                let (got, status) = complete(&mut pass, &inputs);
                assert_same(&format!("{facets:?}, {what}, {strips} strips"), &got, &want);
                assert_eq!(status.counts.silhouette_edges, in_one.counts.silhouette_edges, "{facets:?}, {what}");
                // Strips share one map, made whole; what takes no map from another makes what its own facets ask of it.
                let [texels, asked] = [&status, &in_one].map(|s: &FrameStatus| s.counts.silhouette_texels);
                let right = match what {
                    "still" => texels == asked,
                    "moving" => texels > asked,
                    _ => texels > 0 && texels <= u64::from(strips) * asked,
                };
                assert!(right, "{facets:?}, {what}: {texels} marks, {asked} in one");
                assert!(status.counts.facets >= in_one.counts.facets);
                if strips == 3 && what == "still" {
                    let names = |s: &FrameStatus| s.stages.iter().map(|t| t.name).collect::<Vec<_>>();
                    assert_eq!(names(&status), names(&in_one), "every stage is timed once");
                    let bytes = |pass: &ShadowPass| (pass.visibility().size(), pass.lit().map(|lit| lit.size()));
                    assert_eq!(bytes(&pass), bytes(&whole));
                }
            }
        }
        // Pair lists in bands of facets, and sorted.
        let (want, _) = complete(&mut strips_of(1, casters(mesh), None), &still);
        for pairs in [PairVariant::Tiled, PairVariant::Sorted] {
            let settings = Settings { pairs, ..settings.clone() };
            let budget = Budget { start: Some(64), bytes: 1 << 16 };
            let config = PassConfig { strips: 3, budget, ..PassConfig::new(settings, casters(mesh)) };
            let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
            let (got, _) = complete_within(9, &mut pass, &still);
            assert!(pass.capacities().bands > 1 && pass.strips() == 3, "{:?}", pass.capacities());
            assert_same(&format!("{facets:?}, {pairs:?}, in bands"), &got, &want);
        }
        // Every list short, of every strip.
        let (got, _) = complete_within(7, &mut strips_of(3, casters(mesh), Some(1)), &still);
        assert_same(&format!("{facets:?}, from nothing"), &got, &want);
        let mut pass = strips_of(2, casters(mesh), None);
        // From another size, there and back.
        pass.set_size([20, 90]).expect("another size");
        assert_eq!(pass.strips(), 2);
        pass.set_size(SIZE).expect("the first size");
        assert_same(&format!("{facets:?}, back"), &complete(&mut pass, &still).0, &want);
    }
    let settings = settings(FacetMode::One);
    let (want, prepared) = rendered(mesh, &scene.camera, &scene.light, &settings);
    let config = PassConfig { strips: 4, ..PassConfig::new(settings, casters(mesh)) };
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let number = |t: &u32| prepared.given.get(*t as usize).map_or(u32::MAX, |g| *g);
    let mut ids: Vec<u32> = want.triangles.iter().map(number).collect();
    let mut ask = |ids: &[u32]| {
        let texture = id_texture(ids);
        let gbuffer = GBuffer::TriangleIds(TriangleTexture { texture: &texture, first: 0, none: u32::MAX });
        complete_or_faulty(&mut pass, &Inputs { gbuffer, ..still })
    };
    let (got, status) = ask(&ids);
    assert!(status.complete, "{status:?}");
    assert_same("numbers", &got, &picture(&want));
    // One in each row, of which the last strip shares some with the one before.
    (0..SIZE[1]).for_each(|y| ids[(y * SIZE[0] + 7 * y % SIZE[0]) as usize] = 1 << 30);
    assert_eq!(ask(&ids).1.faults, Faults { unknown_triangles: SIZE[1], ..Faults::default() });
}

/// A device whose bindings do not hold the image has it in strips, from the start, or once its lists do not fit any more.
#[gpu_test]
fn a_device_that_binds_little_has_strips() {
    let scene = scene("windmill");
    let inputs = Inputs::new(&scene.camera, &scene.light);
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 19, ..wgpu::Limits::default() };
    // Facets of all pixels do not fit; with all surfaces the lists start small enough and grow.
    for (facets, start, map) in
        [(FacetMode::One, None, 64), (FacetMode::One, None, 512), (FacetMode::All, Some(1000), 64)]
    {
        let settings = Settings { size: [160, 120], map, ..settings(facets) };
        let mesh = Mesh { triangles: scene.mesh.triangles[..2500].to_vec(), ..scene.mesh.clone() };
        let (want, _) = rendered(&mesh, &scene.camera, &scene.light, &settings);
        let small = Gpu::open_with_limits(None, Some(limits.clone())).expect("a GPU");
        let budget = Budget { start, ..Budget::default() };
        let config = PassConfig { budget, ..PassConfig::new(settings, casters(&mesh)) };
        let mut pass = ShadowPass::new(&small.device, &small.queue, &config).expect("a pass");
        assert_eq!(pass.strips() > 1, start.is_none(), "{facets:?}");
        // An application may bind the results once.
        let results = (pass.visibility().clone(), pass.lit().cloned());
        let mut frames = 0;
        let visibility = loop {
            let mut encoder = small.encoder();
            pass.record(&mut encoder, &inputs, &Target::default()).expect("recorded");
            small.submit_and_wait(encoder).expect("the frame runs");
            small.check().expect("no error of the device");
            let status = status_of(&mut pass);
            frames += 1;
            if status.complete {
                break read_words(&small, pass.visibility());
            }
            assert!(status.overflowed && frames < 9, "{facets:?}: {status:?}");
        };
        assert!(pass.strips() > 1, "{facets:?}: one binding was enough");
        assert_eq!(pass.capacities().views > 1, map > 64, "{facets:?}");
        assert!(results == (pass.visibility().clone(), pass.lit().cloned()), "{facets:?}: other buffers");
        let wanted: Vec<u32> = want.visibility.iter().map(|v| v.to_bits()).collect();
        let dark = want.visibility.iter().filter(|&&v| v < 1.0).count();
        assert!(dark > 300 && visibility[..wanted.len()] == wanted, "{facets:?}: a pixel differs");
    }
}

fn read_words(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<u32> {
    let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
    let descriptor =
        wgpu::BufferDescriptor { label: Some("test"), size: buffer.size(), usage, mapped_at_creation: false };
    let staging = gpu.device.create_buffer(&descriptor);
    let mut encoder = gpu.encoder();
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
    gpu.queue.submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.wait(None).expect("the copy runs");
    bytemuck::pod_collect_to_vec(&staging.get_mapped_range(..).expect("mapped"))
}
