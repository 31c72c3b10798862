//! As `build.rs` of the root: tests that need a driver are listed `ignored` with `SUBPIXEL_SHADOWS_NO_GPU=1`.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-check-cfg=cfg(no_gpu)");
    println!("cargo:rerun-if-env-changed=SUBPIXEL_SHADOWS_NO_GPU");
    if std::env::var("SUBPIXEL_SHADOWS_NO_GPU").is_ok_and(|v| v == "1") {
        println!("cargo:rustc-cfg=no_gpu");
    }
}
