//! Masks of facets held against facet truth, and the cases that the tests of their stages share.

use super::Random;
use super::shadow::{
    World, add_box, add_triangle, append, camera, doubled, random_light, random_scene, sheet, soup, unit, vector,
};
use oracle::reference::front_layer::Split;
use oracle::truth::{FacetInput, FacetResult, FacetTruth, Tracer, full_mask, join_mask, split_mask};
use subpixel_shadows::Result;
use subpixel_shadows::frame::Frame;
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::samples::{Pattern, Samples};
use subpixel_shadows::scene::{Camera, Light, Mesh};
use subpixel_shadows::stages::facet_classify::{FacetState, Facets};

/// Facets: pixel and triangle.
pub type List = Vec<(u32, Option<u32>)>;

/// What was compared.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    pub evaluations: usize,
    pub samples: usize,
    pub occluded: usize,
    pub ambiguous: usize,
    pub wrong_occluded: usize,
    pub wrong_valid: usize,
    pub leaks: usize,
}

impl Tally {
    pub fn add(&mut self, other: Self) {
        self.evaluations += other.evaluations;
        self.samples += other.samples;
        self.occluded += other.occluded;
        self.ambiguous += other.ambiguous;
        self.wrong_occluded += other.wrong_occluded;
        self.wrong_valid += other.wrong_valid;
        self.leaks += other.leaks;
    }

    #[track_caller]
    pub fn assert_right(&self, what: &str) {
        assert_eq!((self.wrong_occluded, self.wrong_valid, self.leaks), (0, 0, 0), "{what}: {self:?}");
    }
}

/// Masks of facets: state, then coverage, occluded and invalid.
pub type Masks = Vec<(u32, [u128; 3])>;

/// The triangle of a listed facet.
pub fn list_triangle(listed: &List, f: usize) -> u32 {
    listed[f].1.unwrap_or(u32::MAX)
}

/// Facets that are classified with nothing settled by the light's map.
pub fn classify(world: &World, listed: &List) -> Facets {
    let texels = (world.view.map.map_size as usize).pow(2);
    world.classify(listed, &vec![true; texels], &vec![Split::Marked; texels])
}

/// A world of which no facet is settled at all.
pub fn undecided_world(
    gpu: &'static Gpu,
    mesh: &Mesh,
    camera: Camera,
    light: Light,
    size: [u32; 2],
    samples: Samples,
) -> World {
    let mut world = World::new(gpu, mesh, camera, light, size, 1, samples);
    world.frame.flags |= Frame::ALL_UNDECIDED;
    world
}

/// What a stage left of the facets.
pub fn read(world: &World, facets: &Facets) -> Masks {
    let list = facets.list.read(world.gpu).expect("readback");
    let masks = facets.masks.read(world.gpu).expect("readback");
    let full = full_mask(world.samples.count());
    let one = |f: usize| [0, 1, 2].map(|part| mask_of(&masks, world.words(), f, part) & full);
    list.iter().enumerate().map(|(f, facet)| (facet.state, one(f))).collect()
}

/// A mask of facet `f`, of so many words: coverage, occluded or invalid.
pub fn mask_of(masks: &[u32], words: usize, f: usize, part: usize) -> u128 {
    let mut all = [0; 4];
    all[..words].copy_from_slice(&masks[(3 * f + part) * words..][..words]);
    join_mask(all)
}

/// The first undecided facet with this occluded mask.
pub fn undecided_with(got: &Masks, occluded: u128) -> usize {
    got.iter().position(|m| m.0 == FacetState::Undecided as u32 && m.1[1] == occluded).expect("a facet")
}

/// The listed facets that have a triangle, with all their samples.
fn inputs(world: &World, listed: &List) -> Vec<FacetInput> {
    let coverage = split_mask(full_mask(world.samples.count()));
    listed.iter().filter_map(|&(pixel, t)| Some(FacetInput { pixel, triangle: t?, coverage })).collect()
}

fn truth<'a>(world: &World, tracer: &'a Tracer) -> FacetTruth<'a> {
    let [w, h] = world.view.image;
    FacetTruth::new(tracer, &world.camera, &world.light, &world.samples, w, h).expect("a truth")
}

/// Fails unless a definition finds at least as many shadowed samples as the undecided facets have, which are some.
pub fn assert_defined(
    world: &World,
    listed: &List,
    got: &Masks,
    definition: fn(&FacetTruth, &[FacetInput]) -> Result<Vec<FacetResult>>,
) {
    let tracer = Tracer::new(world.prepared.mesh()).expect("a tracer");
    let wanted = definition(&truth(world, &tracer), &inputs(world, listed)).expect("masks");
    let wanted: u32 = wanted.iter().map(|r| r.occluded[0].count_ones()).sum();
    let ours: u32 = got.iter().filter(|m| m.0 == FacetState::Undecided as u32).map(|m| m.1[1].count_ones()).sum();
    assert!(ours > 100 && wanted >= ours, "{ours}, {wanted}");
}

/// Compares masks with the truth.
pub fn judge(world: &World, listed: &List, got: &Masks, validity: bool) -> Tally {
    let tracer = Tracer::new(world.prepared.mesh()).expect("a tracer");
    let full = full_mask(world.samples.count());
    let known: Vec<usize> = (0..listed.len()).filter(|&f| listed[f].1.is_some()).collect();
    let inputs = inputs(world, listed);
    let shadows = truth(world, &tracer).without_validity().judge(&inputs, None).expect("judged");
    // A facet that stands for a part of its samples only is cut by nothing: the truth is asked with the coverage in use.
    let covered = |(&f, input): (&usize, &FacetInput)| FacetInput { coverage: split_mask(got[f].1[0]), ..*input };
    let partial: Vec<_> = known.iter().zip(&inputs).map(covered).collect();
    let cuts = validity.then(|| truth(world, &tracer).judge(&partial, None).expect("judged"));
    let mut tally = Tally::default();
    for (k, &f) in known.iter().enumerate() {
        let (state, [coverage, occluded, invalid]) = got[f];
        let truth = &shadows[k];
        let met = join_mask(truth.valid) & !join_mask(truth.ambiguous_valid);
        let sure = coverage & met & !join_mask(truth.ambiguous_occluded);
        let shadowed = join_mask(truth.occluded);
        let ours = match state {
            1 => full,
            // Settled only where the light's map leaves a facet out. A map cannot hold all around a light among the casters.
            2 if is_outside(world) => 0,
            4 => occluded,
            _ => continue,
        };
        let facing_is_open =
            state == FacetState::Dark as u32 && join_mask(truth.ambiguous_occluded) == join_mask(truth.valid);
        if facing_is_open || (state == FacetState::Dark as u32 && is_edge_on(world, list_triangle(listed, f))) {
            continue;
        }
        // Evaluation ends at a facet that has no open sample left: why each of them is closed is then not told.
        if validity && state == FacetState::Undecided as u32 && coverage & !occluded & !invalid == 0 {
            let cut = cuts.as_ref().map_or(0, |c| !join_mask(c[k].valid) | join_mask(c[k].ambiguous_valid));
            let open = sure & !shadowed & !cut;
            tally.samples += sure.count_ones() as usize;
            tally.occluded += (shadowed & sure).count_ones() as usize;
            tally.wrong_occluded += open.count_ones() as usize;
            continue;
        }
        let wrong = (ours ^ shadowed) & sure;
        if wrong != 0 && std::env::var_os("SHADOW_TRACE").is_some() {
            eprintln!("facet {:?} state {state}: wrong {wrong:x} of {sure:x}", listed[f]);
        }
        tally.samples += sure.count_ones() as usize;
        tally.occluded += (shadowed & sure).count_ones() as usize;
        tally.ambiguous += (coverage & met & !sure).count_ones() as usize;
        tally.wrong_occluded += wrong.count_ones() as usize;
        tally.leaks += (shadowed & !ours & sure).count_ones() as usize;
        if let Some(cuts) = &cuts
            && state == FacetState::Undecided as u32
        {
            let sure = coverage & met & !join_mask(cuts[k].ambiguous_valid);
            tally.wrong_valid += (((!invalid) ^ join_mask(cuts[k].valid)) & sure).count_ones() as usize;
        }
    }
    tally
}

/// Whether the light is directional or well outside the scene.
fn is_outside(world: &World) -> bool {
    match world.light {
        Light::Point { position } => Vec3::from(position).length() > 4.0,
        _ => true,
    }
}

/// Edge-on to the light within 2^-19: unlit by definition, whatever the truth says.
fn is_edge_on(world: &World, t: u32) -> bool {
    let Some(corners @ [a, b, c]) = world.triangles[t as usize].corners else { return true };
    let to_light = world.view.light.truncate() - a * world.view.light.w;
    let size = (b - a).length() * (c - a).length();
    let noise = 4e-6 * (b - a).cross(c - a).length() + 1e-6 * size;
    world.view.side(corners).abs() <= noise * to_light.length()
}

/// A floor and two boxes seen from above.
fn boxes() -> Mesh {
    let mut mesh = sheet(2, 3.0, |_, _| 0.0, |p| p);
    add_box(&mut mesh, DVec3::new(-0.5, 0.25, -0.5), DVec3::new(0.5, 0.75, 0.5));
    add_box(&mut mesh, DVec3::new(0.9, -0.1, -0.3), DVec3::new(1.4, 0.4, 0.7));
    mesh
}

/// Mesh, camera and light.
pub type Case = (Mesh, Camera, Light);

/// The patterns of samples.
pub const PATTERNS: [Pattern; 3] = [Pattern::Grid, Pattern::Rotated, Pattern::LowDiscrepancy];

/// Where the eye is over the boxes.
const OVER_BOXES: DVec3 = DVec3::new(0.3, 2.0, 3.0);

fn under(mesh: Mesh, light: Light) -> Case {
    (mesh, camera(OVER_BOXES, DVec3::ZERO, 60.0), light)
}

/// The boxes in a light from above.
pub fn boxes_case() -> Case {
    under(boxes(), Light::Directional { direction: [0.4, 1.0, 0.3] })
}

/// A few triangles in a directional light, seen from above.
pub fn soup_case(n: usize, size: f64, random: &mut Random) -> Case {
    let (mesh, light) = (soup(n, size, random), random_light(true, random));
    (mesh, camera(DVec3::new(0.5, 1.5, 2.0), DVec3::ZERO, 50.0), light)
}

/// A floor and one caster; in even rounds the light is directional.
pub fn one_caster(round: usize, random: &mut Random) -> Case {
    let mut mesh = sheet(1, 1.0, |_, _| 0.0, |p| p);
    append(&mut mesh, soup(1, 0.7, random));
    let eye = DVec3::new(unit(random), 1.5, 2.0);
    (mesh, camera(eye, DVec3::ZERO, 50.0), random_light(round.is_multiple_of(2), random))
}

/// Eye and casters anywhere, also behind each other.
pub fn anywhere(round: usize, random: &mut Random) -> (Mesh, Camera) {
    let mesh = soup(40, [0.3, 1.0][round % 2], random);
    let (eye, target) = (vector(random), vector(random));
    (mesh, camera(eye, target, 70.0))
}

/// A light anywhere: directional, at a point outside the scene, then at one among the casters.
pub fn light_anywhere(round: usize, random: &mut Random) -> Light {
    match round {
        0 => Light::Directional { direction: vector(random).as_vec3().into() },
        1 => random_light(false, random),
        _ => Light::Point { position: (vector(random) * 1.2).as_vec3().into() },
    }
}

/// A scene of one of the kinds of [`random_scene`], seen from anywhere around.
pub fn scene_case(kind: u32, random: &mut Random) -> Case {
    let mesh = random_scene(kind, random);
    let eye = vector(random).normalize() * 2.5;
    (mesh, camera(eye, DVec3::ZERO, 50.0), random_light(random.below(2) == 0, random))
}

/// Degenerate cases, and what each is: light at these elevations over a floor; light in a caster's plane or beside it, at
/// these heights; slivers of aspect 10 to these powers; everything twice.
pub fn degenerate(elevations: &[f32], heights: &[f32], powers: &[i32]) -> Vec<(String, Case)> {
    let mut cases = Vec::new();
    for &elevation in elevations {
        let light = Light::Directional { direction: [1.0, elevation, 0.3] };
        cases.push((format!("light {elevation} over the floor"), under(boxes(), light)));
    }
    for &y in heights {
        // Beyond the caster, in a vertex of it, on the line of an edge.
        for position in [[3.0, y, 0.1], [0.5, y, 0.5], [0.5, y, 2.0]] {
            cases.push((format!("light at {position:?}"), under(boxes(), Light::Point { position })));
        }
    }
    let mut random = Random::new(65);
    for &power in powers {
        let mesh = slivers(power, &mut random);
        let light = random_light(power % 2 == 0, &mut random);
        cases.push((format!("slivers of aspect 1e{power}"), under(mesh, light)));
    }
    let (mesh, camera, light) = boxes_case();
    cases.push(("doubled".to_owned(), (doubled(mesh), camera, light)));
    cases
}

/// Slivers over a floor; every tenth is a triangle of no area at all.
fn slivers(power: i32, random: &mut Random) -> Mesh {
    let mut mesh = sheet(1, 2.0, |_, _| -0.5, |p| p);
    for (t, corners) in soup(60, 1.5, random).positions.chunks(3).enumerate() {
        let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(corners[k]));
        let c = a + (b - a) * 0.6 + (c - a) * 10f32.powi(-power);
        let c = if t % 10 == 0 { a } else { c };
        add_triangle(&mut mesh, [a, b, c].map(<[f32; 3]>::from));
    }
    mesh
}

/// The boxes in a light along an axis, and far from the origin; and what each is.
pub fn on_axis_and_far_away() -> [(String, Case); 2] {
    let on_axis = under(boxes(), Light::Directional { direction: [0.0, 1.0, 0.0] });
    let far = DVec3::new(1e3, -2e3, 5e2);
    let (mut mesh, _, light) = boxes_case();
    mesh.positions.iter_mut().for_each(|p| *p = (Vec3::from(*p) + far.as_vec3()).into());
    let far_away = (mesh, camera(OVER_BOXES + far, far, 60.0), light);
    [("light along an axis".to_owned(), on_axis), ("far away".to_owned(), far_away)]
}
