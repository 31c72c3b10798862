//! Alpha-tested casters in an application's frame: at rest, moved by a vertex buffer, placed as instances.

use super::instances::{SAME, Transform, exact, expanded, uploaded};
use super::*;
use subpixel_shadows::pass::{CasterMesh, CasterUpload, Placed, Transforms};
use subpixel_shadows::scene::{AlphaFilter, AlphaMap, AlphaTested, AlphaWrap, Roles, TestedTriangle};

/// The renderer's picture of casters with holes.
fn wanted(mesh: &Mesh, alpha: &AlphaTested, of: (&Camera, &Light), settings: &Settings) -> Output {
    let prepared = Prepared::with_alpha(mesh, alpha).expect("a sound mesh");
    let mut renderer = Renderer::new(gpu(), &prepared, settings, Budget::default()).expect("a renderer");
    renderer.render(of.0, of.1).expect("a frame")
}

fn made(config: &PassConfig) -> ShadowPass {
    ShadowPass::new(&gpu().device, &gpu().queue, config).expect("a pass")
}

/// Pixels whose visibility is another.
fn apart(got: &Picture, want: &Output) -> usize {
    want.visibility.iter().zip(&got.0).filter(|(a, b)| a.to_bits() != **b).count()
}

/// The renderer's bits: with facets of both kinds, in strips, with room for receivers between the triangles and what is told of their holes;
/// and of casters in a vertex buffer.
#[gpu_test]
fn casters_have_holes() {
    let Scene { mesh, alpha, camera, light, .. } = scene("leaves");
    let whole = casters(&mesh);
    let moving = Casters::Moving { rest: &mesh.positions, triangles: &mesh.triangles };
    let vertices = buffer(12 * mesh.positions.len() as u64, BufferUsages::STORAGE | BufferUsages::COPY_DST);
    gpu().queue.write_buffer(&vertices, 0, bytemuck::cast_slice(&mesh.positions));
    let moved = Moved { vertices: Vertices { buffer: &vertices, offset: 0, stride: 12 }, bounds: bounds(&mesh) };
    for (facets, receivers, strips) in
        [(FacetMode::All, false, 1), (FacetMode::All, true, 3), (FacetMode::One, true, 1)]
    {
        let settings = settings(facets);
        let want = wanted(&mesh, &alpha, (&camera, &light), &settings);
        let without = rendered(&mesh, &camera, &light, &settings).0;
        let tested = Casters::AlphaTested { casters: &whole, tested: &alpha };
        let mut pass = made(&PassConfig { receivers, strips, ..PassConfig::new(settings.clone(), tested) });
        let (got, _) = complete_within(6, &mut pass, &Inputs::new(&camera, &light));
        assert_eq!(apart(&got, &want), 0, "{facets:?}, receivers {receivers}, {strips} strips");
        assert!(apart(&got, &without) > 300);
        let tested = Casters::AlphaTested { casters: &moving, tested: &alpha };
        let mut pass = made(&PassConfig { receivers, strips, ..PassConfig::new(settings, tested) });
        let inputs = Inputs { moved: Some(moved), ..Inputs::new(&camera, &light) };
        let (got, _) = complete_within(6, &mut pass, &inputs);
        let off = apart(&got, &want);
        assert!(off <= 2, "moving, {facets:?}, receivers {receivers}, {strips} strips: {off} pixels");
    }
}

/// Instances of a mesh with holes are the mesh of all of them, to the bit.
#[gpu_test]
fn instances_have_holes() {
    let quad = |x: f32, z: f32| [[-x, 0.25, -z], [x, 0.25, z], [x, 1.75, z], [-x, 1.75, -z]];
    let cards = Mesh {
        positions: [quad(0.75, 0.25), quad(-0.25, 0.75)].concat(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
    };
    let map = |filter| AlphaMap {
        size: [4, 4],
        alpha: vec![255, 0, 255, 0, 0, 255, 40, 255, 255, 0, 200, 0, 0, 255, 0, 255],
        cutoff: 0.5,
        filter,
        wrap: [AlphaWrap::Repeat; 2],
    };
    let corner = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    let of = |triangle: u32| {
        let corners = [[0, 1, 2], [0, 2, 3]][triangle as usize % 2];
        TestedTriangle { triangle, map: triangle / 2, uv: corners.map(|k: usize| corner[k]), roles: Roles::ALL }
    };
    let alpha = AlphaTested {
        maps: vec![map(AlphaFilter::Nearest), map(AlphaFilter::Bilinear)],
        triangles: (0..4).map(of).collect(),
    };
    let floor = Mesh {
        positions: vec![[-8.0, 0.0, -8.0], [8.0, 0.0, -8.0], [8.0, 0.0, 8.0], [-8.0, 0.0, 8.0]],
        triangles: vec![[0, 2, 1], [0, 3, 2]],
    };
    let meshes = [cards, floor];
    let [cards, floor] = meshes.each_ref().map(|m| CasterMesh::new(&m.positions, &m.triangles));
    let given = [CasterMesh { alpha: Some(&alpha), ..cards }, floor];
    let instances = [0, 0, 1, 0, 0, 0];
    let transforms: Vec<Transform> = (0..6).map(|k| if k == 2 { SAME } else { exact(k) }).collect();
    let all = expanded(&meshes, &instances, &transforms);
    let tested = |of_all: &[u32]| {
        let mut tested = AlphaTested { maps: alpha.maps.clone(), triangles: Vec::new() };
        let mut first = 0;
        for &of in of_all {
            if of == 0 {
                tested
                    .triangles
                    .extend(alpha.triangles.iter().map(|t| TestedTriangle { triangle: t.triangle + first, ..*t }));
            }
            first += meshes[of as usize].triangles.len() as u32;
        }
        tested
    };
    let (camera, light) = (super::instances::camera(), Light::Directional { direction: [0.5, 1.0, 0.2] });
    let settings = settings(FacetMode::All);
    let want = wanted(&all, &tested(&instances), (&camera, &light), &settings);
    let without = rendered(&all, &camera, &light, &settings).0;
    let mut pass = made(&PassConfig::new(settings, Casters::Instanced { meshes: &given, instances: &instances }));
    let buffer = uploaded(&transforms, 0);
    let placed = Placed { transforms: Transforms { buffer: &buffer, offset: 0 }, bounds: bounds(&all) };
    let inputs = Inputs { placed: Some(placed), ..Inputs::new(&camera, &light) };
    let (got, _) = complete_within(6, &mut pass, &inputs);
    assert_eq!(apart(&got, &want), 0);
    assert!(apart(&got, &without) > 100);
}

/// Casters that are prepared already are the same ones, with their holes.
#[gpu_test]
fn prepared_casters_are_the_casters() {
    let mut seen = Vec::new();
    for name in ["leaves", "spheres"] {
        let scene = scene(name);
        let inputs = Inputs::new(&scene.camera, &scene.light);
        let (whole, prepared) = (casters(&scene.mesh), scene.prepared().expect("a sound mesh"));
        let given = Casters::AlphaTested { casters: &whole, tested: &scene.alpha };
        let (want, _) = complete(&mut pass(settings(FacetMode::All), given), &inputs);
        let ready = Casters::Prepared(&prepared);
        assert_eq!(ready.are_tested(), name == "leaves");
        assert_same(name, &complete(&mut pass(settings(FacetMode::All), ready), &inputs).0, &want);
        let mut other = pass(Settings { alpha_tested: true, ..settings(FacetMode::All) }, whole);
        let (without, _) = complete(&mut other, &inputs);
        assert_eq!(without != want, name == "leaves", "{name} without its holes");
        other.set_casters(&ready).expect("other casters");
        assert_same(name, &complete(&mut other, &inputs).0, &want);
        let twice = Casters::AlphaTested { casters: &ready, tested: &scene.alpha };
        let refused = other.set_casters(&twice).expect_err("it is said twice").to_string();
        assert!(refused.contains("prepared"), "{refused}");
        seen.push(want);
    }
    assert!(seen[0] != seen[1]);
}

/// Casters that are uploaded once, whole or piece by piece, are the casters of every pass that is given them, with their holes: in the same memory, which no
/// pass counts as its own. One that lacks the last pieces is another.
#[gpu_test]
fn uploaded_casters_are_the_casters() {
    let mut seen = Vec::new();
    for name in ["leaves", "spheres"] {
        let scene = scene(name);
        let inputs = Inputs::new(&scene.camera, &scene.light);
        let prepared = Arc::new(scene.prepared().expect("a sound mesh"));
        let mut own = pass(settings(FacetMode::All), Casters::Prepared(&prepared));
        let (want, _) = complete(&mut own, &inputs);
        let of_casters = |pass: &ShadowPass| -> u64 {
            pass.memory().iter().filter(|buffer| buffer.label.starts_with("casters.")).map(|buffer| buffer.bytes).sum()
        };
        let upload = || CasterUpload::new(&gpu().device, &gpu().queue, prepared.clone()).expect("memory");
        let whole = upload().finish();
        let mut pieces = upload();
        let (early, mut turns) = (pieces.casters().clone(), 1);
        let mut first = pass(settings(FacetMode::All), Casters::Uploaded(&early));
        let bytes = early.bytes();
        while !pieces.advance(bytes / 40) {
            turns += 1;
            if turns == 12 {
                let mut half = pass(settings(FacetMode::All), Casters::Uploaded(&early));
                assert_ne!(frame(&mut half, &inputs).0, want, "{name}: half of it");
            }
        }
        // Some lists are written at once.
        assert!((20..60).contains(&turns) && pieces.advance(1), "{name}: {turns} pieces");
        let casters = Casters::Uploaded(&whole);
        assert_eq!(casters.are_tested(), name == "leaves");
        let mut second = pass(settings(FacetMode::All), casters);
        assert_eq!([of_casters(&own), of_casters(&first), of_casters(&second)], [bytes, 0, 0], "{name}");
        for pass in [&mut first, &mut second] {
            assert_same(name, &complete(pass, &inputs).0, &want);
        }
        second.set_casters(&Casters::Uploaded(&pieces.finish())).expect("other casters");
        assert_same(name, &complete(&mut second, &inputs).0, &want);
        let twice = Casters::AlphaTested { casters: &casters, tested: &scene.alpha };
        let refused = second.set_casters(&twice).expect_err("it is said twice").to_string();
        assert!(refused.contains("prepared"), "{refused}");
        seen.push(want);
    }
    assert!(seen[0] != seen[1]);
}
