//! Something that is being made beside the window.

use std::sync::mpsc::{Receiver, channel};

/// Something that is being made.
#[derive(Debug)]
pub struct Job<T>(Receiver<T>);

impl<T: 'static> Job<T> {
    /// Begins `work` on a thread of its own; the window wakes up when it is done.
    #[cfg(not(target_family = "wasm"))]
    pub fn new(context: &egui::Context, work: impl FnOnce() -> T + Send + 'static) -> Self
    where
        T: Send,
    {
        let (send, made) = channel();
        let context = context.clone();
        std::thread::spawn(move || {
            // Nobody hears it where the job was dropped meanwhile.
            let _ = send.send(work());
            context.request_repaint();
        });
        Self(made)
    }

    /// The same of something that a page waits for.
    #[cfg(target_family = "wasm")]
    pub fn of(context: &egui::Context, work: impl Future<Output = T> + 'static) -> Self {
        let (send, made) = channel();
        let context = context.clone();
        wasm_bindgen_futures::spawn_local(async move {
            let _ = send.send(work.await);
            context.request_repaint();
        });
        Self(made)
    }

    /// The result, once.
    pub fn take(&self) -> Option<T> {
        self.0.try_recv().ok()
    }
}
