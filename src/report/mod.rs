//! What is reported about a picture: error metrics and files.

pub mod errors;
pub mod flip;
pub mod frame_json;
pub mod metrics;
pub mod picture;
pub mod shaded;

pub use errors::{FacetErrors, FacetSet, SceneErrors};
pub use flip::{flip, mean_flip};
pub use frame_json::FrameReport;
pub use metrics::{Errors, Metrics, Truth, wrong_samples};
pub use picture::{write_difference, write_exr, write_png_grey, write_png_rgb};
pub use shaded::shade;
