//! Casters in parts: standing, moving and instances in one pass, added and removed one by one.

use super::instances::{Transform, camera, exact, meshes, uploaded};
use super::*;
use oracle::truth::{SceneTruth, Tracer, join_mask};
use subpixel_shadows::gpu::program::made_here;
use subpixel_shadows::pass::{CasterMesh, CasterPart, PartAt, PartPlace, Placed, Transforms};
use subpixel_shadows::scene::AlphaTested;
use subpixel_shadows::scene::Roles;

/// As instances are placed.
fn at(mesh: &Mesh, transforms: &[Transform]) -> Mesh {
    super::instances::expanded(std::slice::from_ref(mesh), &vec![0; transforms.len()], transforms)
}

fn joined(meshes: &[&Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for mesh in meshes {
        let first = all.positions.len() as u32;
        all.positions.extend(&mesh.positions);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

pub fn of(mesh: &Mesh) -> CasterMesh<'_> {
    CasterMesh::new(&mesh.positions, &mesh.triangles)
}

/// Pixels whose visibility is another.
fn apart(got: &Picture, want: &Output) -> usize {
    want.visibility.iter().zip(&got.0).filter(|(a, b)| a.to_bits() != **b).count()
}

/// Where everything is in a frame: a floor and two towers stand, six boxes are instances, and one is bent by the application.
struct World {
    floor: Mesh,
    towers: Mesh,
    body: Mesh,
    transforms: Vec<Transform>,
    bent: Mesh,
}

impl World {
    fn new(time: u32) -> Self {
        let [body, floor] = meshes();
        let towers = at(&body, &[exact(0), exact(15)]);
        let mut bent = at(&body, &[exact(6)]);
        // Its upper side is moved, and it with time.
        bent.positions.iter_mut().filter(|p| p[1] > 0.75).for_each(|p| p[0] += 0.25 * time as f32 - 0.5);
        bent.positions.iter_mut().for_each(|p| p[2] += 0.5 * time as f32);
        let transforms = [1, 3, 4, 9, 11, 14].map(|k| exact(k + 3 * time)).to_vec();
        Self { floor, towers, body, transforms, bent }
    }

    fn parts(&self) -> [CasterPart<'_>; 4] {
        let [floor, towers, body, bent] = [&self.floor, &self.towers, &self.body, &self.bent].map(of);
        [
            CasterPart::standing(floor),
            CasterPart::instances(body, self.transforms.len() as u32),
            CasterPart::standing(towers),
            CasterPart::moving(bent),
        ]
    }

    fn boxes(&self) -> Mesh {
        at(&self.body, &self.transforms)
    }

    fn all(&self) -> Mesh {
        joined(&[&self.floor, &self.boxes(), &self.towers, &self.bent])
    }

    /// Buffers of its transforms and of its vertices.
    fn buffers(&self) -> [wgpu::Buffer; 2] {
        [uploaded(&self.transforms, 1), vertex_buffer(&self.bent.positions)]
    }

    fn places<'a>(&self, [transforms, vertices]: &'a [wgpu::Buffer; 2]) -> [PartPlace<'a>; 2] {
        let placed = Placed { transforms: Transforms { buffer: transforms, offset: 4 }, bounds: bounds(&self.boxes()) };
        let vertices = Vertices { buffer: vertices, offset: 16, stride: 32 };
        let moved = Moved { vertices, bounds: bounds(&self.bent) };
        [PartPlace { part: 3, at: PartAt::Moved(moved) }, PartPlace { part: 1, at: PartAt::Placed(placed) }]
    }
}

/// Samples that differ from traced truth outside its ambiguity band.
fn wrong(lit: &[u32], mesh: &Mesh, camera: &Camera, light: &Light, samples: &Samples) -> u32 {
    let prepared = Prepared::new(mesh).expect("a sound mesh");
    let tracer = Tracer::of(&prepared).expect("a tracer");
    let truth = SceneTruth::new(&tracer, camera, light, samples, SIZE[0], SIZE[1]).expect("a truth");
    let off = |(k, (&lit, p)): (usize, (&u32, &oracle::truth::PixelTruth))| {
        let around = truth.ambiguous_mask(k as u32);
        let unsure = join_mask(std::array::from_fn(|w| p.ambiguous[w] | around[w]));
        if p.seen_count == 0 { 0 } else { ((u128::from(lit) ^ join_mask(p.lit)) & !unsure).count_ones() }
    };
    lit.iter().zip(&truth.image(None).pixels).enumerate().map(off).sum()
}

fn made(settings: &Settings, parts: &[CasterPart], room: usize) -> ShadowPass {
    pass(settings.clone(), Casters::Parts { parts, room })
}

/// In two frames, with one facet and all, in strips, by a light over them and by one among them: the bits of the mesh of all of them, and no
/// sample wrong against traced truth.
#[gpu_test]
fn parts_are_the_mesh_of_all_of_them() {
    let sun = Light::Directional { direction: [0.5, 1.0, 0.2] };
    let among = Light::Point { position: [-1.5, 1.25, -1.5] };
    let (camera, pixels) = (camera(), (SIZE[0] * SIZE[1]) as usize);
    let first = World::new(0);
    for (facets, light, strips) in [(FacetMode::All, &sun, 1), (FacetMode::One, &sun, 3), (FacetMode::All, &among, 1)] {
        let settings = settings(facets);
        let casters = Casters::Parts { parts: &first.parts(), room: 0 };
        let config = PassConfig { strips, ..PassConfig::new(settings.clone(), casters) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let mut seen: Vec<(Picture, Mesh)> = Vec::new();
        for time in 0..2 {
            let world = World::new(time);
            let (all, buffers) = (world.all(), world.buffers());
            let (want, _) = rendered(&all, &camera, light, &settings);
            let inputs = Inputs { parts: &world.places(&buffers), ..Inputs::new(&camera, light) };
            let (got, _) = complete_within(6, &mut pass, &inputs);
            assert_eq!(apart(&got, &want), 0, "{facets:?}, {light:?}, time {time}");
            let dark = want.visibility.iter().filter(|v| **v == 0.0).count();
            assert!(dark > 50 && dark < pixels - 1000, "{dark} dark pixels");
            if facets == FacetMode::All {
                assert_eq!(
                    wrong(&got.0[pixels..], &all, &camera, light, &settings.samples),
                    0,
                    "{light:?}, time {time}"
                );
            }
            seen.push((got, all));
        }
        // The other time's picture is told apart, by truth as well.
        let off = wrong(&seen[0].0.0[pixels..], &seen[1].1, &camera, light, &settings.samples);
        assert!(seen[0].0 != seen[1].0 && off > 1000, "{facets:?}, {light:?}: {off} samples changed");
    }
}

/// A lamp between parts has views of the sides in which there are some, in one with a part all six; a floor under it has a part of its own.
#[gpu_test]
fn lamps_among_parts_have_views_of_parts() {
    let (camera, settings) = (camera(), settings(FacetMode::All));
    let [body, floor] = meshes();
    let boxes = [0, 3, 6, 13].map(|k| at(&body, &[exact(k)]));
    let mut all = joined(&boxes.each_ref());
    let parts: Vec<CasterPart> = boxes.iter().chain([&floor]).map(|mesh| CasterPart::standing(of(mesh))).collect();
    let mut pass = made(&settings, &parts, 0);
    all = joined(&[&all, &floor]);
    let mut seen = Vec::new();
    // Over the floor between the boxes, in one of them, and over all of them.
    for (position, views) in [([-1.5, 1.0, -2.75], 3..6), ([1.0, 0.5, -1.5], 6..7), ([0.5, 9.0, 0.0], 1..2)] {
        let light = Light::Point { position };
        let (want, _) = rendered(&all, &camera, &light, &settings);
        let (got, _) = complete_within(6, &mut pass, &Inputs::new(&camera, &light));
        assert_eq!(apart(&got, &want), 0, "{position:?}");
        let (pixels, made) = (want.visibility.len(), pass.capacities().views);
        assert_eq!(wrong(&got.0[pixels..], &all, &camera, &light, &settings.samples), 0, "{position:?}");
        assert!(views.contains(&made), "{position:?}: {made} views");
        seen.push(got);
    }
    assert!(seen[0] != seen[1] && seen[1] != seen[2]);
}

/// A method of depth maps takes them as it takes casters that all move.
#[gpu_test]
fn depth_maps_take_parts() {
    let (world, camera) = (World::new(1), camera());
    let light = Light::Directional { direction: [0.5, 1.0, 0.2] };
    let settings = Settings { map: 256, ..settings(FacetMode::One) };
    let picture = |casters: Casters, inputs: &Inputs| {
        let method = subpixel_shadows::methods::MethodName::Pcf;
        let config = PassConfig { method, ..PassConfig::new(settings.clone(), casters) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        pass.record_and_read(inputs)
    };
    let buffers = world.buffers();
    let inputs = Inputs { parts: &world.places(&buffers), ..Inputs::new(&camera, &light) };
    let got = picture(Casters::Parts { parts: &world.parts(), room: 77 }, &inputs);
    // The views are those of the same boxes.
    let boxes = world.boxes();
    let meshes = [&world.floor, &boxes, &world.towers, &world.bent];
    let buffers = meshes.map(|mesh| vertex_buffer(&mesh.positions));
    let parts = meshes.map(|mesh| CasterPart::moving(of(mesh)));
    let place = |k: usize| {
        let vertices = Vertices { buffer: &buffers[k], offset: 16, stride: 32 };
        PartPlace { part: k as u32, at: PartAt::Moved(Moved { vertices, bounds: bounds(meshes[k]) }) }
    };
    let places: Vec<PartPlace> = (0..4).map(place).collect();
    let moving = Casters::Parts { parts: &parts, room: 0 };
    let want = picture(moving, &Inputs { parts: &places, ..Inputs::new(&camera, &light) });
    assert!(got == want && got.iter().filter(|v| **v == 0).count() > 50);
}

trait RecordAndRead {
    fn record_and_read(&mut self, inputs: &Inputs) -> Vec<u32>;
}

impl RecordAndRead for ShadowPass {
    fn record_and_read(&mut self, inputs: &Inputs) -> Vec<u32> {
        let mut encoder = gpu().encoder();
        self.record(&mut encoder, inputs, &Target::default()).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frame runs");
        assert!(status_of(self).complete);
        test_support::refused::words(gpu(), self.visibility(), Some(self.visibility())).expect("a picture")
    }
}

/// Parts that are added and removed, within the room and beyond it: each frame has those of its time, no pipeline is compiled, and within the room
/// no memory is made but the part's own.
#[gpu_test]
fn parts_come_and_go() {
    let (world, camera) = (World::new(0), camera());
    let (light, settings) = (Light::Directional { direction: [0.5, 1.0, 0.2] }, settings(FacetMode::All));
    let [body, floor] = meshes();
    let boxes: Vec<Mesh> = (0..12).map(|k| at(&body, &[exact(k)])).collect();
    let want = |with: &[&Mesh]| rendered(&joined(with), &camera, &light, &settings).0;
    let mut pass = made(&settings, &[CasterPart::standing(of(&floor))], 40);
    let compiled = made_here();
    let plain = Inputs::new(&camera, &light);
    let frame = |pass: &mut ShadowPass, inputs: &Inputs, want: &Output, what: &str| {
        let (got, status) = complete_within(6, pass, inputs);
        assert_eq!(apart(&got, want), 0, "{what}");
        status
    };
    let empty = want(&[&floor]);
    frame(&mut pass, &plain, &empty, "the floor alone");
    let held = |pass: &ShadowPass| pass.memory().iter().filter(|b| b.label != "uploads").map(|b| b.bytes).sum::<u64>();
    let bytes = held(&pass);
    let first = pass.add_part(&CasterPart::standing(of(&boxes[10]))).expect("a part");
    let with_first = want(&[&floor, &boxes[10]]);
    assert!(apart(&picture(&with_first), &empty) > 20);
    frame(&mut pass, &plain, &with_first, "a box more");
    // It stands: light maps are kept, and made anew once another comes.
    assert!(frame(&mut pass, &plain, &with_first, "again").maps_kept);
    let second = pass.add_part(&CasterPart::standing(of(&boxes[5]))).expect("a part");
    let with_both = want(&[&floor, &boxes[10], &boxes[5]]);
    assert!(!frame(&mut pass, &plain, &with_both, "two boxes").maps_kept);
    assert_eq!((pass.part_triangles(first), pass.part_triangles(second)), (Some(2..14), Some(14..26)));
    pass.remove_part(first).expect("it is there");
    let with_second = want(&[&floor, &boxes[5]]);
    assert!(apart(&picture(&with_both), &with_second) > 20);
    frame(&mut pass, &plain, &with_second, "the first is gone");
    assert_eq!(held(&pass), bytes, "memory within the room");
    // One that moves comes to where the first was.
    let buffers = world.buffers();
    let moving = pass.add_part(&CasterPart::moving(of(&world.bent))).expect("a part");
    assert_eq!((moving, pass.part_triangles(moving), pass.part_triangles(first)), (3, Some(2..14), None));
    let places = [PartPlace { part: moving, ..world.places(&buffers)[0] }];
    let moved = Inputs { parts: &places, ..plain };
    frame(&mut pass, &moved, &want(&[&floor, &boxes[5], &world.bent]), "one moves");
    // Beyond the room.
    let instances = pass.add_part(&CasterPart::instances(of(&body), 6)).expect("a part");
    let places = [places[0], PartPlace { part: instances, ..world.places(&buffers)[1] }];
    let placed = Inputs { parts: &places, ..plain };
    let (all, rest) = (world.boxes(), [&floor, &boxes[5], &world.bent]);
    frame(&mut pass, &placed, &want(&[&rest[..], &[&all]].concat()), "beyond the room");
    for (part, left) in [(second, vec![&floor, &world.bent, &all]), (moving, vec![&floor, &all])] {
        pass.remove_part(part).expect("it is there");
        let places = if part == moving { &places[1..] } else { &places[..] };
        frame(&mut pass, &Inputs { parts: places, ..plain }, &want(&left), "fewer");
    }
    pass.remove_part(instances).expect("it is there");
    frame(&mut pass, &plain, &empty, "the floor alone again");
    pass.remove_part(0).expect("it is there");
    let (nothing, _) = complete(&mut pass, &plain);
    assert!(nothing.0[..empty.visibility.len()].iter().all(|v| *v == 1.0f32.to_bits()), "nothing is seen");
    assert_eq!(made_here(), compiled, "pipelines");
}

/// Frames have the parts of when they were recorded, also where they are submitted together; what a frame that is dropped would have written,
/// the next one writes.
#[gpu_test]
fn frames_have_the_parts_of_their_time() {
    let camera = camera();
    let (light, settings) = (Light::Directional { direction: [0.5, 1.0, 0.2] }, settings(FacetMode::All));
    let [body, floor] = meshes();
    let boxes = [0, 10].map(|k| at(&body, &[exact(k)]));
    let want = |with: &[&Mesh]| rendered(&joined(with), &camera, &light, &settings).0;
    let pictures = [want(&[&floor, &boxes[0]]), want(&[&floor, &boxes[1]])];
    let mut pass = made(&settings, &[CasterPart::standing(of(&floor))], 24);
    let inputs = Inputs::new(&camera, &light);
    let mut part = pass.add_part(&CasterPart::standing(of(&boxes[0]))).expect("a part");
    for k in [1, 0, 1, 0] {
        // Lists grow, and the memory is that of the part before.
        complete_within(6, &mut pass, &inputs);
        let targets = [Targets::new(), Targets::new()];
        let mut encoder = gpu().encoder();
        pass.record(&mut encoder, &inputs, &targets[0].target()).expect("recorded");
        pass.remove_part(part).expect("it is there");
        part = pass.add_part(&CasterPart::standing(of(&boxes[k]))).expect("a part");
        let mut dropped = gpu().encoder();
        pass.record(&mut dropped, &inputs, &Target::default()).expect("recorded");
        drop(dropped);
        pass.record(&mut encoder, &inputs, &targets[1].target()).expect("recorded");
        gpu().submit_and_wait(encoder).expect("the frames run");
        let both = [status_of(&mut pass).complete, status_of(&mut pass).complete];
        assert_eq!(both, [true; 2]);
        for (targets, want) in targets.iter().zip([&pictures[1 - k], &pictures[k]]) {
            assert_eq!(apart(&targets.read(), want), 0, "box {k}");
        }
        assert!(apart(&targets[0].read(), &pictures[k]) > 20);
    }
}

/// Triangle numbers of a G-buffer: those of parts that are there, with the bits of the pass's own search; those of a part that is gone show nothing.
#[gpu_test]
fn parts_have_numbers() {
    let (world, camera) = (World::new(0), camera());
    let (light, settings) = (Light::Directional { direction: [0.5, 1.0, 0.2] }, settings(FacetMode::One));
    let mut pass = made(&settings, &world.parts(), 0);
    let (all, buffers) = (world.all(), world.buffers());
    let (want, prepared) = rendered(&all, &camera, &light, &settings);
    let number = |&t: &u32| prepared.given.get(t as usize).copied().unwrap_or(u32::MAX);
    let ids: Vec<u32> = want.triangles.iter().map(number).collect();
    let texture = id_texture(&ids);
    let gbuffer = GBuffer::TriangleIds(TriangleTexture { texture: &texture, first: 0, none: u32::MAX });
    let places = world.places(&buffers);
    let inputs = Inputs { gbuffer, parts: &places, ..Inputs::new(&camera, &light) };
    let (got, _) = complete_within(6, &mut pass, &inputs);
    assert_eq!(apart(&got, &want), 0);
    let towers = pass.part_triangles(2).expect("it is there");
    pass.remove_part(2).expect("it is there");
    let (got, _) = complete_within(6, &mut pass, &inputs);
    let of_towers: Vec<bool> = ids.iter().map(|id| towers.contains(id)).collect();
    let seen = |k: &usize| of_towers[*k];
    assert!((0..ids.len()).filter(seen).all(|k| got.0[k] == 1.0f32.to_bits()), "what is gone is not seen");
    assert!((0..ids.len()).filter(seen).count() > 30 && apart(&got, &want) > 50);
}

/// Parts with holes, of which one is added later, with and without room for receivers between the triangles and what is told of their holes.
#[gpu_test]
fn parts_have_holes() {
    let Scene { mesh, alpha, camera, light, .. } = scene("leaves");
    let settings = Settings { alpha_tested: true, ..settings(FacetMode::All) };
    let [_, floor] = meshes();
    let both = joined(&[&floor, &mesh]);
    let shifted = |by: u32| AlphaTested {
        maps: alpha.maps.clone(),
        triangles: alpha
            .triangles
            .iter()
            .map(|t| {
                let mut t = *t;
                t.triangle += by;
                t
            })
            .collect(),
    };
    let known = Prepared::with_alpha(&both, &shifted(2)).expect("a sound mesh");
    let want = Renderer::new(gpu(), &known, &settings, Budget::default())
        .and_then(|mut renderer| renderer.render(&camera, &light))
        .expect("a frame");
    let tree = CasterPart::standing(CasterMesh { alpha: Some(&alpha), ..of(&mesh) });
    let inputs = Inputs::new(&camera, &light);
    for (receivers, room) in [(false, 0), (true, 0), (true, 2 * mesh.triangles.len())] {
        let casters = Casters::Parts { parts: &[CasterPart::standing(of(&floor))], room };
        let config = PassConfig { receivers, ..PassConfig::new(settings.clone(), casters) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let added = pass.add_part(&tree).expect("a part");
        let (got, _) = complete_within(6, &mut pass, &inputs);
        assert_eq!(apart(&got, &want), 0, "receivers {receivers}, room {room}");
        // Another in its place.
        pass.remove_part(added).expect("it is there");
        let (without, _) = complete_within(6, &mut pass, &inputs);
        assert!(apart(&without, &want) > 300);
        pass.add_part(&tree).expect("a part");
        let (got, _) = complete_within(6, &mut pass, &inputs);
        assert_eq!(apart(&got, &want), 0, "again, receivers {receivers}, room {room}");
    }
    let mut without = made(&self::settings(FacetMode::All), &[CasterPart::standing(of(&floor))], 0);
    let told = without.add_part(&tree).expect_err("refused").to_string();
    assert!(told.contains("alpha_tested"), "{told}");
}

/// Parts and places that do not go together are refused in one line, and a box that is too tight makes a frame incomplete.
#[gpu_test]
fn parts_that_do_not_fit_are_refused() {
    let (world, camera) = (World::new(0), camera());
    let light = Light::Directional { direction: [0.5, 1.0, 0.2] };
    let mut pass = made(&settings(FacetMode::One), &world.parts(), 0);
    let buffers = world.buffers();
    let [moved, placed] = world.places(&buffers);
    let plain = Inputs::new(&camera, &light);
    let refused = |pass: &mut ShadowPass, inputs: &Inputs, part: &str| {
        let told = pass.record(&mut gpu().encoder(), inputs, &Target::default()).expect_err(part).to_string();
        assert!(told.contains(part) && !told.contains('\n'), "{told}");
    };
    let PartAt::Moved(of_bent) = moved.at else { panic!("it moves") };
    let upside_down = Moved { bounds: [[1.0; 3], [0.0; 3]], ..of_bent };
    let short = Moved { vertices: Vertices { offset: 4096, ..of_bent.vertices }, ..of_bent };
    for (parts, part) in [
        (vec![], "part 1 moves, and the frame does not say where it is"),
        (vec![placed], "part 3 moves"),
        (vec![moved, placed, moved], "part 3: the frame says twice"),
        (vec![moved, PartPlace { part: 1, ..moved }], "part 1: transforms place it"),
        (vec![PartPlace { part: 3, ..placed }], "part 3: a vertex buffer moves it"),
        (vec![PartPlace { part: 0, ..moved }], "part 0: it stands"),
        (vec![PartPlace { part: 9, ..moved }], "part 9: the casters have none"),
        (vec![PartPlace { part: 3, at: PartAt::Moved(upside_down) }], "part 3: no box"),
        (vec![PartPlace { part: 3, at: PartAt::Moved(short) }], "do not hold 8 positions"),
    ] {
        refused(&mut pass, &Inputs { parts: &parts, ..plain }, part);
    }
    let of_all = Inputs { moved: Some(of_bent), parts: &[moved, placed], ..plain };
    refused(&mut pass, &of_all, "by part");
    let mut still = self::pass(settings(FacetMode::One), casters(&world.body));
    refused(&mut still, &Inputs { parts: &[moved], ..plain }, "not in parts");
    let errors = [
        still.add_part(&world.parts()[0]).expect_err("no parts"),
        still.remove_part(0).expect_err("no parts"),
        pass.remove_part(7).expect_err("no such part"),
        pass.add_part(&CasterPart::standing(CasterMesh::new(&[[f32::NAN; 3]; 3], &[[0, 1, 2]]))).expect_err("no mesh"),
        pass.add_part(&CasterPart::instances(of(&world.body), u32::MAX)).expect_err("too many"),
    ];
    let expected = ["in no parts", "in no parts", "part 7", "vertex 0", "4294967295 instances of 12 triangles"];
    for (told, part) in errors.map(|e| e.to_string()).into_iter().zip(expected) {
        assert!(told.contains(part) && !told.contains('\n'), "{told}");
    }
    let parts = world.parts();
    let broken = [parts[0], CasterPart::moving(CasterMesh::new(&[[0.0; 3]; 3], &[[0, 1, 3]]))];
    let config = PassConfig::new(settings(FacetMode::One), Casters::Parts { parts: &broken, room: 0 });
    let told = ShadowPass::new(&gpu().device, &gpu().queue, &config).err().expect("refused").to_string();
    assert!(told.contains("part 1 of the casters") && told.contains("vertex 3"), "{told}");
    // Nothing was harmed.
    let (want, _) = rendered(&world.all(), &camera, &light, &settings(FacetMode::One));
    let (got, _) = complete_within(6, &mut pass, &Inputs { parts: &[moved, placed], ..plain });
    assert_eq!(apart(&got, &want), 0);
    let tight = Moved { bounds: [of_bent.bounds[0], [of_bent.bounds[1][0], 0.5, of_bent.bounds[1][2]]], ..of_bent };
    let tight = [PartPlace { part: 3, at: PartAt::Moved(tight) }, placed];
    let (_, status) = frame(&mut pass, &Inputs { parts: &tight, ..plain });
    assert!(!status.complete && status.faults.outside == 4, "{status:?}");
}

/// A part that moves, or stands, and casts nothing lies outside the light's view, and receives all the same.
#[gpu_test]
fn parts_that_cast_nothing_receive() {
    let Scene { mut mesh, camera, .. } = scene("spheres");
    let light = Light::Directional { direction: [0.5, 1.0, 0.3] };
    let settings = Settings { alpha_tested: true, ..settings(FacetMode::All) };
    // Balls without their slab, over a wide terrain; what no triangle uses would widen their box.
    mesh.triangles.drain(..12);
    mesh = Mesh {
        positions: mesh.triangles.iter().flatten().map(|v| mesh.positions[*v as usize]).collect(),
        triangles: (0..mesh.triangles.len() as u32).map(|t| [0, 1, 2].map(|v| 3 * t + v)).collect(),
    };
    let mut terrain = Mesh::default();
    for k in 0..400u32 {
        let [x, z] = [k % 20, k / 20].map(|c| 1.5 * (c as f32 - 10.0));
        terrain.positions.extend([[x, -0.6, z], [x, -0.6, z + 1.5], [x + 1.5, -0.6, z]]);
        terrain.triangles.push([0, 1, 2].map(|v| 3 * k + v));
    }
    let buffer = vertex_buffer(&terrain.positions);
    let moved = Moved { vertices: Vertices { buffer: &buffer, offset: 16, stride: 32 }, bounds: bounds(&terrain) };
    let both = joined(&[&mesh, &terrain]);
    let (first, end) = (mesh.triangles.len() as u32, both.triangles.len() as u32);
    let inputs = Inputs::new(&camera, &light);
    let mut needs = Vec::new();
    for roles in [Roles::RECEIVE_ONLY, Roles::ALL] {
        let [mut own, mut of_both] = [AlphaTested::default(), AlphaTested::default()];
        own.set_roles(0..end - first, roles);
        of_both.set_roles(first..end, roles);
        let known = Prepared::with_alpha(&both, &of_both).expect("a sound mesh");
        let want = Renderer::new(gpu(), &known, &settings, Budget::default())
            .and_then(|mut renderer| renderer.render(&camera, &light))
            .expect("a frame");
        let terrain = CasterMesh { alpha: Some(&own), ..of(&terrain) };
        let places = [PartPlace { part: 1, at: PartAt::Moved(moved) }];
        for (part, places) in [(CasterPart::standing(terrain), &[][..]), (CasterPart::moving(terrain), &places[..])] {
            let mut pass = made(&settings, &[CasterPart::standing(of(&mesh)), part], 0);
            let (got, status) = complete_within(6, &mut pass, &Inputs { parts: places, ..inputs });
            assert_eq!(apart(&got, &want), 0, "{roles:?}, {:?}", part.kind);
            let shadowed = want.visibility.iter().filter(|v| **v < 1.0).count();
            assert!(shadowed > 300, "{roles:?}: {shadowed} pixels in shadow");
            needs.push(status.lists.iter().find(|l| l.name == "pixel_texel_pairs").map_or(0, |l| l.needed));
        }
    }
    assert!(needs[0] != needs[2] && needs[1] != needs[3], "the view is as wide: {needs:?} pairs");
}
