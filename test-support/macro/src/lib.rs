//! The attribute of tests that need a GPU.

use proc_macro::{Delimiter, Group, TokenStream, TokenTree};

/// A test that needs a GPU: it fails without one, and is listed as ignored where `SUBPIXEL_SHADOWS_NO_GPU=1` was set at build time. It takes
/// pipelines that another test of the binary has compiled for the same device (`test_support::within_programs`), unless it is `alone`.
#[proc_macro_attribute]
pub fn gpu_test(how: TokenStream, function: TokenStream) -> TokenStream {
    let without = std::env::var("SUBPIXEL_SHADOWS_NO_GPU").is_ok_and(|v| v == "1");
    let ignore = if without { r#"#[ignore = "built for a machine without a GPU"]"# } else { "" };
    // The constant tells cargo what to build again when the variable changes.
    let text = format!(r#"const _: Option<&str> = option_env!("SUBPIXEL_SHADOWS_NO_GPU"); #[test] {ignore}"#);
    let mut test: TokenStream = text.parse().unwrap_or_default();
    let alone = how.to_string() == "alone";
    test.extend(function.into_iter().map(|token| match token {
        TokenTree::Group(body) if body.delimiter() == Delimiter::Brace && !alone => {
            let mut call: TokenStream = "::test_support::within_programs".parse().unwrap_or_default();
            let mut closure: TokenStream = "||".parse().unwrap_or_default();
            closure.extend([TokenTree::Group(body)]);
            call.extend([TokenTree::Group(Group::new(Delimiter::Parenthesis, closure))]);
            TokenTree::Group(Group::new(Delimiter::Brace, call))
        }
        other => other,
    }));
    test
}

/// A test that opens a window on a screen of its own: it fails where it cannot, and is listed as ignored where
/// `SUBPIXEL_SHADOWS_NO_WINDOW=1` or `SUBPIXEL_SHADOWS_NO_GPU=1` was set at build time.
#[proc_macro_attribute]
pub fn window_test(_: TokenStream, function: TokenStream) -> TokenStream {
    let variables = ["SUBPIXEL_SHADOWS_NO_WINDOW", "SUBPIXEL_SHADOWS_NO_GPU"];
    let without = variables.iter().any(|name| std::env::var(name).is_ok_and(|v| v == "1"));
    let ignore = if without { r#"#[ignore = "built for a machine without a screen"]"# } else { "" };
    let [window, gpu] = variables.map(|name| format!("const _: Option<&str> = option_env!({name:?});"));
    let mut test: TokenStream = format!("{window} {gpu} #[test] {ignore}").parse().unwrap_or_default();
    test.extend(function);
    test
}
