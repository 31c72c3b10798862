//! The attribute of tests that need a GPU.

use proc_macro::TokenStream;

/// A test that needs a GPU: it fails without one, and is listed as ignored where `SUBPIXEL_SHADOWS_NO_GPU=1` was set at build time.
#[proc_macro_attribute]
pub fn gpu_test(_: TokenStream, function: TokenStream) -> TokenStream {
    let attributes = r#"#[test] #[cfg_attr(no_gpu, ignore = "built for a machine without a GPU")]"#;
    let mut test: TokenStream = attributes.parse().unwrap_or_default();
    test.extend(function);
    test
}
