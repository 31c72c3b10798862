//! Error against run time: scenes × methods × settings, measured in interleaved repeats and held against both truths.
//!
//! A *row* is one method with one setting on one scene. Rows are measured in groups: in every round each row of the group
//! renders one frame, and a reference row with them, so that what disturbs the machine disturbs every row, and ratios
//! to the reference are taken within a round. Each finished row is written to a journal; a run that was interrupted goes
//! on from there.

pub mod figures;
pub mod html;
pub mod journal;
pub mod measure;
pub mod page;
pub mod pictures;
pub mod plots;
pub mod row;
pub mod variant;

pub use journal::Journal;
pub use measure::{Measuring, SceneCase};
pub use row::{Machine, Row, Spread};
pub use variant::{ReportVariant, Scope, variants};
