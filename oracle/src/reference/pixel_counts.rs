//! The work of each pixel in numbers.

use super::facet_classify::FacetState;

/// A facet as it is counted.
#[derive(Clone, Debug)]
pub struct Counted {
    /// Its pixel.
    pub pixel: usize,
    /// Its state.
    pub state: FacetState,
    /// Texels that each of its pixel-texel pairs names.
    pub texels: Vec<u32>,
    /// Candidates of it.
    pub candidates: u32,
}

/// Class, facets, texels and pairs of each pixel. Facets of state [`FacetState::Empty`] are no facets.
pub fn pixel_counts(pixels: usize, facets: &[Counted]) -> Vec<[u32; 4]> {
    let mut counts = vec![[0; 4]; pixels];
    for facet in facets {
        let [class, seen, texels, pairs] = &mut counts[facet.pixel];
        *class = (*class).max(facet.state as u32);
        *seen += u32::from(facet.state != FacetState::Empty);
        *texels += facet.texels.iter().sum::<u32>();
        *pairs += facet.candidates;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_add_up_at_their_pixel() {
        let facet =
            |pixel, state, texels: &[u32], candidates| Counted { pixel, state, texels: texels.to_vec(), candidates };
        let facets = [
            facet(2, FacetState::Undecided, &[4, 1], 3),
            facet(0, FacetState::Lit, &[], 0),
            facet(2, FacetState::Dark, &[], 0),
            facet(2, FacetState::Undecided, &[2], 0),
            facet(1, FacetState::Empty, &[], 0),
        ];
        assert_eq!(pixel_counts(3, &facets), [[2, 1, 0, 0], [0; 4], [4, 3, 7, 3]]);
    }
}
