//! The device of all tests of a suite.

use std::sync::OnceLock;
use subpixel_shadows::gpu::Gpu;

/// Fails where there is none; build with `SUBPIXEL_SHADOWS_NO_GPU=1` to have these tests listed as ignored instead.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        let gpu = Gpu::open(None).expect("a GPU (or build with SUBPIXEL_SHADOWS_NO_GPU=1)");
        eprintln!("adapter: {} ({})", gpu.adapter.name, gpu.adapter.driver);
        gpu
    })
}
