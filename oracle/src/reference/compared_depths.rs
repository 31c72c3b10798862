//! The depth by which a texel of a shadow map is compared.

/// Which of a texel's two nearest depths, or what between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compared {
    /// Half way between the two.
    Midpoint,
    /// The second.
    Second,
    /// Half way between the two, but no more than this beyond the nearest.
    Dual(f64),
}

/// The depth by which a texel with these two nearest depths is compared; `None`: it shadows nothing.
pub fn compared(rule: Compared, nearest: Option<f64>, second: Option<f64>) -> Option<f64> {
    let nearest = nearest?;
    match rule {
        Compared::Midpoint => second.map(|second| (nearest + second) / 2.0),
        Compared::Second => second,
        Compared::Dual(farthest) => Some(
            second.map_or(nearest + farthest, |second| (nearest + (second - nearest) / 2.0).min(nearest + farthest)),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rules_lie_between_the_layers() {
        let of = |rule| compared(rule, Some(0.25), Some(0.75));
        assert_eq!(of(Compared::Midpoint), Some(0.5));
        assert_eq!(of(Compared::Second), Some(0.75));
        assert_eq!([of(Compared::Dual(0.125)), of(Compared::Dual(1.0))], [Some(0.375), Some(0.5)]);
        let alone = |rule| compared(rule, Some(0.25), None);
        assert_eq!([alone(Compared::Midpoint), alone(Compared::Second)], [None; 2]);
        assert_eq!(alone(Compared::Dual(0.125)), Some(0.375));
        assert_eq!(compared(Compared::Dual(1.0), None, None), None);
    }
}
