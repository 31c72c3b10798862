//! The device of all tests of a suite.

use std::sync::OnceLock;
use subpixel_shadows::gpu::{Gpu, KeptPrograms};

/// Fails where there is none; build with `SUBPIXEL_SHADOWS_NO_GPU=1` to have these tests listed as ignored instead.
pub fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| {
        let gpu = Gpu::open(None).expect("a GPU (or build with SUBPIXEL_SHADOWS_NO_GPU=1)");
        eprintln!("adapter: {} ({})", gpu.adapter.name, gpu.adapter.driver);
        gpu
    })
}

/// Runs a test, in which no pipeline is compiled that another test of this binary has compiled for the same device.
pub fn within_programs<T>(test: impl FnOnce() -> T) -> T {
    static PROGRAMS: OnceLock<KeptPrograms> = OnceLock::new();
    PROGRAMS.get_or_init(KeptPrograms::default).within(test)
}
