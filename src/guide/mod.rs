//! Guides: the program, use in an application, what was measured, limits, the other methods, departures from the papers, words, adding a stage.

#[doc = include_str!("adding_a_stage.md")]
pub mod adding_a_stage {}

#[doc = include_str!("application.md")]
pub mod application {}

#[doc = include_str!("glossary.md")]
pub mod glossary {}

#[doc = include_str!("limits.md")]
pub mod limits {}

#[doc = include_str!("measured.md")]
pub mod measured {}

#[doc = include_str!("methods.md")]
pub mod methods {}

#[doc = include_str!("papers.md")]
pub mod papers {}

#[doc = include_str!("program.md")]
pub mod program {}
