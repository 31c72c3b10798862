//! The viewer: one place by any two methods, or by one and traced truth, in a window and in a web page.
//!
//! [`Viewer`] is an [egui](https://www.egui.rs) application on the device that draws the window: both halves are
//! [`ShadowPass`]es, recorded as any application would record them. Passes are made beside the window; a
//! half is shown when its frames are complete, the left one before the right one has a pass, and the last picture stays until then.

#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::todo,
        clippy::unimplemented,
        clippy::unreachable
    )
)]

pub mod beside;
pub mod control;
pub mod half;
pub mod job;
pub mod level;
pub mod making;
pub mod overlay;
mod panel;
pub mod picture;
pub mod read;
pub mod trouble;
pub mod truth;
pub mod view;
mod viewer;
#[cfg(target_family = "wasm")]
pub mod web;

pub use view::{View, ViewArguments};
pub use viewer::Viewer;

use egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use std::sync::Arc;
use subpixel_shadows::{ShadowPass, wgpu};

/// The device that the viewer asks for: all that the adapter allows of what passes can use.
pub fn configuration() -> WgpuConfiguration {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.power_preference = wgpu::PowerPreference::HighPerformance;
    setup.device_descriptor = Arc::new(|adapter| wgpu::DeviceDescriptor {
        label: Some("viewer"),
        required_features: ShadowPass::required_features() | (adapter.features() & ShadowPass::optional_features()),
        required_limits: adapter.limits(),
        ..Default::default()
    });
    WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup), ..Default::default() }
}

#[cfg(not(target_family = "wasm"))]
const TYPEFACE: &[u8] = epaint_default_fonts::UBUNTU_LIGHT;
/// The letters of it that `build.rs` keeps for a page.
#[cfg(target_family = "wasm")]
const TYPEFACE: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/typeface.ttf"));

/// The one typeface of the viewer: egui's others would be read over the net for nothing.
fn fonts() -> egui::FontDefinitions {
    let mut fonts = egui::FontDefinitions::empty();
    let name = "Ubuntu-Light";
    fonts.font_data.insert(name.to_owned(), Arc::new(egui::FontData::from_static(TYPEFACE)));
    for family in [egui::FontFamily::Proportional, egui::FontFamily::Monospace] {
        fonts.families.insert(family, vec![name.to_owned()]);
    }
    fonts
}

/// Writes an image as a PNG file, or in a browser offers it to be kept.
///
/// # Errors
/// One line, if it cannot be written.
pub fn save_png(name: &str, image: &egui::ColorImage) -> Result<(), String> {
    let [width, height] = image.size.map(|side| side as u32);
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
    // The browser encodes it: an encoder of its own would make a page longer.
    #[cfg(target_family = "wasm")]
    return web::offer_png(name, [width, height], &bytes);
    #[cfg(not(target_family = "wasm"))]
    {
        let mut png = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        let written = image::ImageEncoder::write_image(encoder, &bytes, width, height, image::ExtendedColorType::Rgba8);
        written.map_err(|e| format!("{name}: {e}"))?;
        std::fs::write(name, png).map_err(|e| format!("{name}: {e}"))
    }
}
