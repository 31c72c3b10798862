//! Which method takes which of the program's options.

use super::MethodName;

/// An option of `render` and `explain` that not every method takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodOption {
    /// Its name, without the dashes before it.
    pub name: &'static str,
    /// The methods that take it.
    pub methods: &'static [MethodName],
}

/// The options that not every method takes; all others are of all methods.
pub const METHOD_OPTIONS: [MethodOption; 19] = {
    use MethodName::{
        FacetMasks, Lispsm, ParallelSplit, Pcf, RayTraced, Remix, ShadowMap, Smsr, Spsm, Supersampled, Trapezoidal,
        Variance,
    };
    const fn of(name: &'static str, methods: &'static [MethodName]) -> MethodOption {
        MethodOption { name, methods }
    }
    [
        of("facets", &[FacetMasks]),
        of("validity", &[FacetMasks, RayTraced, Supersampled]),
        of("masks", &[FacetMasks]),
        of("pairs", &[FacetMasks]),
        of("projection", &[FacetMasks]),
        of("memory-limit", &[FacetMasks]),
        of("list-start", &[FacetMasks]),
        of("encoding", &[Spsm]),
        of("search", &[Spsm]),
        of("rays", &[RayTraced]),
        of("kernel", &[Pcf]),
        of("shape", &[Smsr]),
        of("reach", &[Smsr]),
        of("splits", &[FacetMasks, Spsm, ShadowMap, Pcf, Smsr, Variance, ParallelSplit, Remix, Supersampled]),
        of("warp", &[FacetMasks, Spsm, ShadowMap, Pcf, Smsr, Variance, Remix, Supersampled]),
        of("focus", &[FacetMasks, Spsm, ShadowMap, Pcf, Smsr, Variance, Trapezoidal, Remix, Supersampled]),
        of("bleeding", &[Variance, Remix]),
        of("grazing", &[Variance, Remix]),
        // As [`MethodName::keeps`].
        of("looks", &[FacetMasks, Spsm, ShadowMap, Pcf, Smsr, Variance, Trapezoidal, Lispsm, ParallelSplit, Remix]),
    ]
};

impl MethodName {
    /// The options that it takes of those that not every method takes, in the order of [`METHOD_OPTIONS`].
    pub fn options(self) -> impl Iterator<Item = &'static str> {
        METHOD_OPTIONS.iter().filter(move |option| option.methods.contains(&self)).map(|option| option.name)
    }

    /// Whether it takes an option; one that is not among [`METHOD_OPTIONS`] is of all methods.
    pub fn takes(self, option: &str) -> bool {
        METHOD_OPTIONS.iter().find(|o| o.name == option).is_none_or(|o| o.methods.contains(&self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_option_is_there_once_and_is_of_some_methods() {
        for (k, option) in METHOD_OPTIONS.iter().enumerate() {
            assert!(METHOD_OPTIONS[..k].iter().all(|o| o.name != option.name), "{} twice", option.name);
            assert!((1..MethodName::ALL.len()).contains(&option.methods.len()), "{}", option.name);
            for method in MethodName::ALL {
                assert_eq!(method.takes(option.name), method.options().any(|name| name == option.name));
                // A method has slices of its own, or takes all options of them, or asks no view.
                let all = ["splits", "warp", "focus"].iter().all(|option| method.takes(option));
                assert!(method.row().partition.is_some() || all || method == MethodName::RayTraced);
            }
        }
        assert!(
            MethodName::ALL.into_iter().all(|m| m.takes("samples") && m.takes("looks") == (m.keeps() != [false; 2]))
        );
    }
}
