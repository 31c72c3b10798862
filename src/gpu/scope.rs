//! Errors of a device, heard where they arise.

/// Runs `work` and says which error of a kind it caused on the device, if any. In a browser the answer comes only after the page's own
/// task has ended, so none is waited for: what fails there reaches the device's own handler
/// ([`wgpu::Device::on_uncaptured_error`]), and a frame that never ran is not [`complete`](crate::pass::FrameStatus::complete).
pub(crate) fn caught<T>(
    device: &wgpu::Device,
    filter: wgpu::ErrorFilter,
    work: impl FnOnce() -> T,
) -> (T, Option<wgpu::Error>) {
    if cfg!(target_family = "wasm") {
        return (work(), None);
    }
    let scope = device.push_error_scope(filter);
    let out = work();
    (out, futures::executor::block_on(scope.pop()))
}
