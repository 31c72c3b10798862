//! Facets of pixels in any state, with any masks.

use super::Random;
use super::shadow::full_word;
use oracle::reference::facet_classify::FacetState;
use oracle::reference::resolve::FacetBits;
use oracle::truth::{join_mask, split_mask};
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::stages::facet_classify::{Facet, Facets};

/// All states.
pub const STATES: [FacetState; 5] =
    [FacetState::Empty, FacetState::Dark, FacetState::Lit, FacetState::Shadowed, FacetState::Undecided];
/// Facets of each pixel.
pub fn any(pixels: usize, count: u32, most: u32, random: &mut Random) -> Vec<Vec<FacetBits>> {
    let full = (0..count.div_ceil(32)).map(|w| full_word(count, w)).collect::<Vec<_>>();
    let mask = |random: &mut Random| {
        let mut words = [0; 4];
        for (w, &full) in words.iter_mut().zip(&full) {
            *w = [0, full, random.word() & full][random.below(3) as usize];
        }
        join_mask(words)
    };
    let one = |random: &mut Random| FacetBits {
        state: STATES[random.below(5) as usize],
        coverage: mask(random),
        occluded: mask(random),
        invalid: mask(random),
    };
    (0..pixels).map(|_| (0..random.below(most + 1)).map(|_| one(random)).collect()).collect()
}

/// The same in buffers.
pub fn uploaded(gpu: &Gpu, count: u32, pixels: &[Vec<FacetBits>]) -> Facets {
    let words = count.div_ceil(32) as usize;
    let all: Vec<FacetBits> = pixels.iter().flatten().copied().collect();
    let memory = Facets::new(&gpu.device, all.len(), pixels.len(), words).expect("memory");
    let state = |m: &FacetBits| STATES.iter().position(|s| *s == m.state).expect("a state") as u32;
    let facets: Vec<Facet> = all.iter().map(|m| Facet { state: state(m), ..Facet::default() }).collect();
    memory.list.write(&gpu.queue, &facets);
    let masks = |m: &FacetBits| [m.coverage, m.occluded, m.invalid].map(|m| split_mask(m)[..words].to_vec()).concat();
    memory.masks.write(&gpu.queue, &all.iter().flat_map(masks).collect::<Vec<_>>());
    let mut firsts = vec![0];
    pixels.iter().for_each(|p| firsts.push(firsts.last().unwrap_or(&0) + p.len() as u32));
    memory.pixel_facets.write(&gpu.queue, &firsts);
    memory
}
