//! From masks to visibility.

use super::facet_classify::State;

/// A facet's part in its pixel: samples as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Masks {
    /// Its state.
    pub state: State,
    /// Samples it stands for.
    pub coverage: u128,
    /// Samples in shadow; counts for undecided facets.
    pub occluded: u128,
    /// Samples that do not count; likewise.
    pub invalid: u128,
}

/// The lit share of the samples that count (1 where none does), and which samples are lit (all where none counts).
pub fn pixel(facets: &[Masks]) -> (f32, u128) {
    let (mut seen, mut bright, mut lit) = (0, 0, 0u128);
    for f in facets.iter().filter(|f| f.state != State::Empty) {
        let (counted, open) = match f.state {
            State::Undecided => (f.coverage & !f.invalid, f.coverage & !f.invalid & !f.occluded),
            State::Lit => (f.coverage, f.coverage),
            _ => (f.coverage, 0),
        };
        seen += counted.count_ones();
        bright += open.count_ones();
        lit |= open;
    }
    if seen == 0 { (1.0, u128::MAX) } else { (bright as f32 / seen as f32, lit) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_count_as_they_should() {
        let mask = |state| Masks { state, coverage: 0b1111, occluded: 0b0011, invalid: 0b0001 };
        assert_eq!(pixel(&[]), (1.0, u128::MAX));
        assert_eq!(pixel(&[mask(State::Empty)]), (1.0, u128::MAX));
        assert_eq!(pixel(&[mask(State::Dark)]), (0.0, 0));
        assert_eq!(pixel(&[mask(State::Shadowed)]), (0.0, 0));
        assert_eq!(pixel(&[mask(State::Lit)]), (1.0, 0b1111));
        assert_eq!(pixel(&[mask(State::Undecided)]), (2.0 / 3.0, 0b1100));
        let none = Masks { state: State::Undecided, coverage: 1, occluded: 1, invalid: 1 };
        assert_eq!(pixel(&[none]), (1.0, u128::MAX));
    }
}
