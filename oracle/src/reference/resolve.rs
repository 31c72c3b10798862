//! From masks to visibility.

use super::facet_classify::FacetState;

/// A facet's part in its pixel: samples as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FacetBits {
    /// Its state.
    pub state: FacetState,
    /// Samples it covers.
    pub coverage: u128,
    /// Samples in shadow; counts for undecided facets.
    pub occluded: u128,
    /// Samples that do not count; likewise.
    pub invalid: u128,
}

/// The lit share of the samples that count (1 where none does), and which samples are lit (all where none counts).
pub fn pixel(facets: &[FacetBits]) -> (f32, u128) {
    let (mut seen, mut bright, mut lit) = (0, 0, 0u128);
    for f in facets.iter().filter(|f| f.state != FacetState::Empty) {
        let (counted, open) = match f.state {
            FacetState::Undecided => (f.coverage & !f.invalid, f.coverage & !f.invalid & !f.occluded),
            FacetState::Lit => (f.coverage, f.coverage),
            _ => (f.coverage, 0),
        };
        seen += counted.count_ones();
        bright += open.count_ones();
        lit |= open;
    }
    if seen == 0 { (1.0, u128::MAX) } else { (bright as f32 / seen as f32, lit) }
}

/// The samples that see a surface and count.
pub fn seen(facets: &[FacetBits]) -> u128 {
    facets.iter().fold(0, |seen, f| match f.state {
        FacetState::Empty => seen,
        FacetState::Undecided => seen | (f.coverage & !f.invalid),
        _ => seen | f.coverage,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_count_as_they_should() {
        let mask = |state| FacetBits { state, coverage: 0b1111, occluded: 0b0011, invalid: 0b0001 };
        assert_eq!(pixel(&[]), (1.0, u128::MAX));
        assert_eq!(pixel(&[mask(FacetState::Empty)]), (1.0, u128::MAX));
        assert_eq!(pixel(&[mask(FacetState::Dark)]), (0.0, 0));
        assert_eq!(pixel(&[mask(FacetState::Shadowed)]), (0.0, 0));
        assert_eq!(pixel(&[mask(FacetState::Lit)]), (1.0, 0b1111));
        assert_eq!(pixel(&[mask(FacetState::Undecided)]), (2.0 / 3.0, 0b1100));
        let none = FacetBits { state: FacetState::Undecided, coverage: 1, occluded: 1, invalid: 1 };
        assert_eq!(pixel(&[none]), (1.0, u128::MAX));
    }
}
