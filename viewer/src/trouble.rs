//! Reports of the device that no call returns: errors, and its loss.

use std::sync::{Arc, Mutex};
use subpixel_shadows::wgpu;

#[derive(Debug, Default)]
struct Reports {
    error: Option<String>,
    lost: Option<String>,
}

/// The device's reports so far.
#[derive(Clone, Debug, Default)]
pub struct Trouble(Arc<Mutex<Reports>>);

impl Trouble {
    /// Begins to listen; the window wakes up at each report.
    pub fn of(device: &wgpu::Device, context: &egui::Context) -> Self {
        let trouble = Self::default();
        let keep = |put: fn(&mut Reports, String)| {
            let (reports, context) = (trouble.0.clone(), context.clone());
            move |text: String| {
                if let Ok(mut reports) = reports.lock() {
                    put(&mut reports, text.split_whitespace().collect::<Vec<_>>().join(" "));
                }
                context.request_repaint();
            }
        };
        let error = keep(|reports, text| _ = reports.error.get_or_insert(text));
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| error(e.to_string())));
        let lost = keep(|reports, text| _ = reports.lost.get_or_insert(text));
        device.set_device_lost_callback(move |reason, text| {
            let told = if text.is_empty() { format!("{reason:?}") } else { text };
            lost(format!("the GPU was lost: {told}"));
        });
        trouble
    }

    /// The first error since the last call.
    pub fn take_error(&self) -> Option<String> {
        self.0.lock().ok()?.error.take()
    }

    /// Why the device is gone, if it is.
    pub fn lost(&self) -> Option<String> {
        self.0.lock().ok()?.lost.clone()
    }
}
