//! The attribute of tests that need a GPU.

use proc_macro::TokenStream;

/// A test that needs a GPU: it fails without one, and is listed as ignored where `SUBPIXEL_SHADOWS_NO_GPU=1` was set at build time.
#[proc_macro_attribute]
pub fn gpu_test(_: TokenStream, function: TokenStream) -> TokenStream {
    let without = std::env::var("SUBPIXEL_SHADOWS_NO_GPU").is_ok_and(|v| v == "1");
    let ignore = if without { r#"#[ignore = "built for a machine without a GPU"]"# } else { "" };
    // The constant tells cargo what to build again when the variable changes.
    let text = format!(r#"const _: Option<&str> = option_env!("SUBPIXEL_SHADOWS_NO_GPU"); #[test] {ignore}"#);
    let mut test: TokenStream = text.parse().unwrap_or_default();
    test.extend(function);
    test
}
