//! The device, folders, frames and long runs that tests of several packages share.

mod device;
mod folder;
mod frames;
pub mod kept_light;
pub mod refused;
pub mod soak;

pub use device::{gpu, within_programs};
pub use folder::Folder;
pub use frames::status_of;
pub use gpu_test::{gpu_test, window_test};
