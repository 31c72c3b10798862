//! One token of one kernel changed at run time, to test the tests: `cargo run --release --features mutations --example mutations`.

/// The variable of the environment that names the change: `KERNEL:BYTE:LENGTH:TEXT`, in the kernel's joined text.
pub const VARIABLE: &str = "SUBPIXEL_SHADOWS_MUTATION";

/// The text of a kernel, with the change that [`VARIABLE`] names.
pub fn mutated(kernel: &str, source: String) -> String {
    let change = std::env::var(VARIABLE).ok();
    change.and_then(|change| apply(&change, kernel, &source)).unwrap_or(source)
}

/// `None` if the change is of another kernel, or none.
fn apply(change: &str, kernel: &str, source: &str) -> Option<String> {
    let mut parts = change.splitn(4, ':');
    if parts.next()? != kernel {
        return None;
    }
    let (first, length): (usize, usize) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
    let text = parts.next()?;
    let (before, rest) = source.split_at_checked(first)?;
    Some([before, text, rest.get(length..)?].concat())
}

#[cfg(test)]
mod tests {
    use super::apply;

    #[test]
    fn one_token_is_replaced() {
        assert_eq!(apply("k:2:1:<=", "k", "a < b").as_deref(), Some("a <= b"));
        assert_eq!(apply("k:4:1:", "k", "a < b").as_deref(), Some("a < "));
        assert_eq!(apply("k:2:1:<=", "other", "a < b"), None);
        assert_eq!(apply("k:9:1:<=", "k", "a < b"), None);
        assert_eq!(apply("k:2", "k", "a < b"), None);
    }
}
