//! Instances: meshes in many places by transforms, without work of the CPU a vertex.

use super::*;
use subpixel_shadows::pass::{CasterMesh, Placed, Transforms};

pub type Transform = [[f32; 4]; 3];

/// A scale by a power of two, a turn by quarters around the up direction, and a place on a grid: exact in single precision.
pub fn exact(k: u32) -> Transform {
    let scale = [1.0, 2.0, 0.5][k as usize % 3];
    let [c, s] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][k as usize % 4];
    let [x, z] = [(k % 4) as f32 * 2.5 - 4.0, (k / 4) as f32 * 2.5 - 4.0];
    [[c * scale, 0.0, s * scale, x], [0.0, scale, 0.0, 0.25 * (k % 2) as f32], [-s * scale, 0.0, c * scale, z]]
}

/// Boxes and a floor.
pub fn meshes() -> [Mesh; 2] {
    let corner = |k: u32| [(k & 1) as f32 - 0.5, (k >> 1 & 1) as f32 * 1.5 + 0.0625, (k >> 2 & 1) as f32 - 0.5];
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let body = Mesh { positions: (0..8).map(corner).collect(), triangles };
    let positions = vec![[-8.0, 0.0, -8.0], [8.0, 0.0, -8.0], [8.0, 0.0, 8.0], [-8.0, 0.0, 8.0]];
    [body, Mesh { positions, triangles: vec![[0, 2, 1], [0, 3, 2]] }]
}

pub const SAME: Transform = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// The same as one mesh.
pub fn expanded(meshes: &[Mesh], instances: &[u32], transforms: &[Transform]) -> Mesh {
    let mut all = Mesh::default();
    for (&of, transform) in instances.iter().zip(transforms) {
        let (mesh, first) = (&meshes[of as usize], all.positions.len() as u32);
        let place = |p: &[f32; 3]| transform.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3]);
        all.positions.extend(mesh.positions.iter().map(place));
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

pub fn uploaded(transforms: &[Transform], before: usize) -> wgpu::Buffer {
    let mut words = vec![f32::NAN; before];
    words.extend(transforms.iter().flatten().flatten());
    let buffer = buffer(words.len() as u64 * 4, BufferUsages::STORAGE | BufferUsages::COPY_DST);
    gpu().queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&words));
    buffer
}

pub fn camera() -> Camera {
    Camera { eye: [6.0, 6.0, 8.0], target: [0.0, 0.0, 0.0], ..scene("spheres").camera }
}

/// Instances by exact transforms are the mesh of all of them, to the bit: moved, with one facet and all, in strips, by other methods, and by a
/// light among them; their triangles have the numbers that are promised.
#[gpu_test]
fn instances_are_the_mesh_of_all_of_them() {
    let meshes = meshes();
    let given = meshes.each_ref().map(|m| CasterMesh::new(&m.positions, &m.triangles));
    let instances: Vec<u32> = (0..14).map(|k| u32::from(k == 5)).collect();
    let casters = Casters::Instanced { meshes: &given, instances: &instances };
    let sun = Light::Directional { direction: [0.5, 1.0, 0.2] };
    let among = Light::Point { position: [-1.5, 1.25, -1.5] };
    let camera = camera();
    let pixels = (SIZE[0] * SIZE[1]) as usize;
    for (facets, light, strips) in [(FacetMode::All, &sun, 1), (FacetMode::One, &sun, 3), (FacetMode::All, &among, 1)] {
        let settings = settings(facets);
        let config = PassConfig { strips, ..PassConfig::new(settings.clone(), casters) };
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let mut seen = Vec::new();
        for moved in 0..2u32 {
            let of = |k: u32| if k == 5 { SAME } else { exact(k + 3 * moved) };
            let transforms: Vec<Transform> = (0..14).map(of).collect();
            let all = expanded(&meshes, &instances, &transforms);
            let (want, _) = rendered(&all, &camera, light, &settings);
            let buffer = uploaded(&transforms, 3);
            let placed = Placed { transforms: Transforms { buffer: &buffer, offset: 12 }, bounds: bounds(&all) };
            let inputs = Inputs { placed: Some(placed), ..Inputs::new(&camera, light) };
            let (got, _) = complete_within(6, &mut pass, &inputs);
            let bits: Vec<u32> = want.visibility.iter().map(|v| v.to_bits()).collect();
            let dark = want.visibility.iter().filter(|v| **v == 0.0).count();
            assert!(dark > 50 && dark < pixels - 1000, "{dark} dark pixels");
            let differ = got.0[..pixels].iter().zip(&bits).filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "{facets:?}, {light:?}, moved {moved}");
            seen.push(bits);
        }
        let changed = seen[0].iter().zip(&seen[1]).filter(|(a, b)| a != b).count();
        assert!(changed > 80, "{facets:?}, {light:?}: {changed} pixels changed as the instances moved");
    }
}

/// Turned by any angle they cast the shadows that the same turn on the CPU gives, but where rounding moves an edge over a sample.
#[gpu_test]
fn instances_turn() {
    let meshes = meshes();
    let given = meshes.each_ref().map(|m| CasterMesh::new(&m.positions, &m.triangles));
    let instances = [1, 0, 0, 0, 0];
    let transforms: Vec<Transform> = (0..5)
        .map(|k| {
            let ((s, c), at) = ((0.7 * k as f32).sin_cos(), 2.0 * k as f32 - 4.5);
            [[c, 0.0, s, at], [0.0, 1.0, 0.0, 0.0], [-s, 0.0, c, 0.3 * at]]
        })
        .map(|t| if t[0][3] == -4.5 { SAME } else { t })
        .collect();
    let all = expanded(&meshes, &instances, &transforms);
    let light = Light::Directional { direction: [0.4, 1.0, -0.3] };
    let settings = settings(FacetMode::All);
    let (want, _) = rendered(&all, &camera(), &light, &settings);
    let config = PassConfig::new(settings, Casters::Instanced { meshes: &given, instances: &instances });
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
    let buffer = uploaded(&transforms, 0);
    let [low, high] = bounds(&all);
    let wider = [low.map(|c| c - 1e-3), high.map(|c| c + 1e-3)];
    let camera = camera();
    let frame = |pass: &mut ShadowPass, bounds| {
        let placed = Placed { transforms: Transforms { buffer: &buffer, offset: 0 }, bounds };
        complete_within(6, pass, &Inputs { placed: Some(placed), ..Inputs::new(&camera, &light) }).0
    };
    let got = frame(&mut pass, wider);
    let off = got.0.iter().zip(&want.visibility).filter(|(a, b)| (f32::from_bits(**a) - **b).abs() > 0.04).count();
    assert!(off <= 3, "{off} pixels are off by more than a sample");
    assert!(want.visibility.iter().filter(|v| **v == 0.0).count() > 100);
    // A box that is too tight is told of.
    let placed =
        Placed { transforms: Transforms { buffer: &buffer, offset: 0 }, bounds: [low, [high[0], 0.5, high[2]]] };
    let inputs = Inputs { placed: Some(placed), ..Inputs::new(&camera, &light) };
    let mut encoder = gpu().encoder();
    let targets = Targets::new();
    pass.record(&mut encoder, &inputs, &targets.target()).expect("recorded");
    gpu().queue.submit([encoder.finish()]);
    gpu().wait(None).expect("the frame runs");
    let status = status_of(&mut pass);
    assert!(!status.complete && status.faults.outside > 0, "{status:?}");
}

/// Mirrored instances, one squeezed flat, one shrunk to a point, and one of a mesh without triangles; and no instance at all.
#[gpu_test]
fn odd_instances_are_the_mesh_of_all_of_them() {
    let [body, floor] = meshes();
    let none = Mesh::default();
    let meshes = [body, floor, none];
    let given = meshes.each_ref().map(|m| CasterMesh::new(&m.positions, &m.triangles));
    let instances = [1, 0, 0, 0, 2];
    let diagonal = |[x, y, z]: [f32; 3], at: f32| [[x, 0.0, 0.0, at], [0.0, y, 0.0, 0.5], [0.0, 0.0, z, 0.25]];
    let transforms =
        [SAME, diagonal([-2.0, 1.0, 2.0], -2.0), diagonal([2.0, 0.0, 2.0], 1.0), diagonal([0.0; 3], 3.0), SAME];
    let all = expanded(&meshes, &instances, &transforms);
    let light = Light::Directional { direction: [0.5, 1.0, 0.2] };
    let camera = camera();
    for facets in [FacetMode::One, FacetMode::All] {
        let settings = settings(facets);
        let (want, _) = rendered(&all, &camera, &light, &settings);
        let config = PassConfig::new(settings, Casters::Instanced { meshes: &given, instances: &instances });
        let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &config).expect("a pass");
        let buffer = uploaded(&transforms, 0);
        let placed = Placed { transforms: Transforms { buffer: &buffer, offset: 0 }, bounds: bounds(&all) };
        let inputs = Inputs { placed: Some(placed), ..Inputs::new(&camera, &light) };
        let got = complete_within(6, &mut pass, &inputs).0;
        let differ = got.0.iter().zip(&want.visibility).filter(|(a, b)| **a != b.to_bits()).count();
        assert_eq!(differ, 0, "{facets:?}");
        assert!(want.visibility.iter().filter(|v| **v == 0.0).count() > 20, "{facets:?}: something is dark");
        pass.set_casters(&Casters::Instanced { meshes: &given, instances: &[] }).expect("none");
        let got = complete_within(6, &mut pass, &inputs).0;
        assert!(got.0[..want.visibility.len()].iter().all(|v| *v == 1.0f32.to_bits()), "{facets:?}: nothing is seen");
    }
}

/// Meshes, instances and transforms that do not fit together are refused in one line.
#[gpu_test]
fn instances_that_do_not_fit_are_refused() {
    let meshes = meshes();
    let given = meshes.each_ref().map(|m| CasterMesh::new(&m.positions, &m.triangles));
    let of = |meshes, instances| PassConfig::new(settings(FacetMode::One), Casters::Instanced { meshes, instances });
    let refused =
        |config: &PassConfig| ShadowPass::new(&gpu().device, &gpu().queue, config).err().expect("refused").to_string();
    let told = refused(&of(&given, &[0, 2]));
    assert!(told.contains("instance 1 is of mesh 2, there are 2"), "{told}");
    let broken = [CasterMesh::new(&[[f32::NAN; 3]; 3], &[[0, 1, 2]])];
    let told = refused(&of(&broken, &[0]));
    assert!(told.contains("mesh 0 of the casters"), "{told}");
    let mut pass = ShadowPass::new(&gpu().device, &gpu().queue, &of(&given, &[0, 1])).expect("a pass");
    let buffer = uploaded(&[SAME], 0);
    let light = Light::Directional { direction: [0.5, 1.0, 0.2] };
    let camera = camera();
    let plain = Inputs::new(&camera, &light);
    let bounds = [[-9.0; 3], [9.0; 3]];
    let of = |offset, bounds| Some(Placed { transforms: Transforms { buffer: &buffer, offset }, bounds });
    for (placed, part) in [
        (None, "no transforms"),
        (of(0, bounds), "48 bytes do not hold 2"),
        (of(0, [[1.0; 3], [0.0; 3]]), "do not hold"),
    ] {
        let told = pass.record(&mut gpu().encoder(), &Inputs { placed, ..plain }, &Target::default());
        let told = told.expect_err("refused").to_string();
        assert!(told.contains(part) && !told.contains('\n'), "{told}");
    }
    let mut still = self::pass(settings(FacetMode::One), self::casters(&meshes[0]));
    let told = still.record(&mut gpu().encoder(), &Inputs { placed: of(0, bounds), ..plain }, &Target::default());
    assert!(told.expect_err("refused").to_string().contains("not placed by transforms"));
}
