//! Error metrics of a picture, tables and files.

pub mod comparison;
pub mod course;
pub mod experiments;
pub mod facet_errors;
pub mod flip;
pub mod frame_json;
pub mod looks;
pub mod metrics;
pub mod picture;
pub mod promise;
pub mod scene_errors;
pub mod seen_errors;
pub mod shaded;
pub mod stability;

pub use facet_errors::{Boundary, FacetErrors, FacetSet};
pub use flip::{flip, mean_flip};
pub use frame_json::FrameReport;
pub use metrics::{Errors, Metrics, Truth, wrong_samples};
#[cfg(not(target_family = "wasm"))]
pub use picture::write_exr;
pub use picture::{part_of_dead, write_difference, write_png_grey, write_png_rgb, write_text};
pub use promise::Promise;
pub use scene_errors::{ConvergedErrors, SceneErrors, TracedScene};
pub use seen_errors::SeenErrors;
pub use shaded::shade;

/// A figure with so many places behind the point; a dash where there is none.
pub fn or_dash(figure: Option<f64>, places: usize) -> String {
    figure.map_or("–".to_owned(), |value| format!("{value:.places$}"))
}

/// A share in percent, with three places; a dash where there is none.
pub fn percent_or_dash(share: Option<f64>) -> String {
    share.map_or("–".to_owned(), |share| format!("{:.3} %", 100.0 * share))
}
