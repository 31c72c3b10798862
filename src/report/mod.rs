//! What is reported about a picture: error metrics and image files.

pub mod flip;
pub mod metrics;
pub mod picture;

pub use flip::{flip, mean_flip};
pub use metrics::{Errors, Metrics, Truth, wrong_samples};
pub use picture::{write_difference, write_exr, write_png_grey, write_png_rgb};
