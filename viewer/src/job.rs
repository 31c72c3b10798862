//! Work beside the window.

use std::sync::mpsc::{Receiver, channel};

/// Something that is being made.
#[derive(Debug)]
pub struct Job<T>(Receiver<T>);

impl<T: Send + 'static> Job<T> {
    /// Begins `work` on a thread of its own, or in a browser, which has none, at once; the window wakes up when it is done.
    pub fn new(context: &egui::Context, work: impl FnOnce() -> T + Send + 'static) -> Self {
        let (send, made) = channel();
        let context = context.clone();
        let work = move || {
            // Nobody hears it where the job was dropped meanwhile.
            let _ = send.send(work());
            context.request_repaint();
        };
        if cfg!(target_family = "wasm") {
            work();
        } else {
            std::thread::spawn(work);
        }
        Self(made)
    }

    /// The result, once.
    pub fn take(&self) -> Option<T> {
        self.0.try_recv().ok()
    }
}
