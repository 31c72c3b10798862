//! Masks of facets held against facet truth.

use super::shadow::{World, add_box, sheet};
use subpixel_shadows::glam::{DVec3, Vec3};
use subpixel_shadows::scene::{Light, Mesh};
use subpixel_shadows::stages::facet_classify::State;
use subpixel_shadows::truth::{FacetInput, FacetTruth, Tracer, full_mask, join_mask, split_mask};

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

/// Compares masks with the truth.
pub fn judge(world: &World, listed: &List, got: &Masks, validity: bool) -> Tally {
    let tracer = Tracer::new(&world.prepared.mesh).expect("a tracer");
    let [w, h] = world.view.image;
    let make = || FacetTruth::new(&tracer, &world.camera, &world.light, &world.samples, w, h).expect("truth");
    let full = full_mask(world.samples.count());
    let known: Vec<usize> = (0..listed.len()).filter(|&f| listed[f].1.is_some()).collect();
    let input =
        |&f: &usize| FacetInput { pixel: listed[f].0, triangle: list_triangle(listed, f), coverage: split_mask(full) };
    let inputs: Vec<_> = known.iter().map(input).collect();
    let shadows = make().without_validity().judge(&inputs, None).expect("judged");
    // A facet that stands for a part of its samples only is cut by nothing: the truth is asked with the coverage in use.
    let covered = |(&f, input): (&usize, &FacetInput)| FacetInput { coverage: split_mask(got[f].1[0]), ..*input };
    let partial: Vec<_> = known.iter().zip(&inputs).map(covered).collect();
    let cuts = validity.then(|| make().judge(&partial, None).expect("judged"));
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
            state == State::Dark as u32 && join_mask(truth.ambiguous_occluded) == join_mask(truth.valid);
        if facing_is_open || (state == State::Dark as u32 && is_edge_on(world, list_triangle(listed, f))) {
            continue;
        }
        // Evaluation ends at a facet that has no open sample left: why each of them is closed is then not told.
        if validity && state == State::Undecided as u32 && coverage & !occluded & !invalid == 0 {
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
            && state == State::Undecided as u32
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
pub fn boxes() -> Mesh {
    let mut mesh = sheet(2, 3.0, |_, _| 0.0, |p| p);
    add_box(&mut mesh, DVec3::new(-0.5, 0.25, -0.5), DVec3::new(0.5, 0.75, 0.5));
    add_box(&mut mesh, DVec3::new(0.9, -0.1, -0.3), DVec3::new(1.4, 0.4, 0.7));
    mesh
}
