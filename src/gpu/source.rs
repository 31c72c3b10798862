//! Texts of kernels.

/// Text of a kernel: its files, imports first. Kernels share files, which a program holds once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Source(pub &'static [&'static str]);

impl Source {
    /// The files, joined.
    pub fn text(self) -> String {
        self.0.concat()
    }
}

/// The text of a file of `kernels/`, by its path from there without `.wgsl`; [`bare`] in a web page, which is read over the net.
macro_rules! kernel_file {
    ($file:expr) => {{
        const WHOLE: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/kernels/", $file, ".wgsl"));
        #[cfg(target_family = "wasm")]
        const TEXT: &str = {
            const BARE: [u8; $crate::gpu::source::bare_length(WHOLE)] = $crate::gpu::source::bare(WHOLE);
            match core::str::from_utf8(&BARE) {
                Ok(text) => text,
                Err(_) => WHOLE,
            }
        };
        #[cfg(not(target_family = "wasm"))]
        const TEXT: &str = WHOLE;
        TEXT
    }};
}
pub(crate) use kernel_file;

/// Length of what [`bare`] gives, bytes.
pub const fn bare_length(text: &str) -> usize {
    write_bare(text, &mut [])
}

/// A text of WGSL without comments, and without the spaces and ends of lines that separate nothing; `N` is its [`bare_length`].
pub const fn bare<const N: usize>(text: &str) -> [u8; N] {
    let mut out = [0; N];
    write_bare(text, &mut out);
    out
}

/// Whether a space between these tells two words or two operators from one.
const fn are_apart(before: u8, after: u8) -> bool {
    const fn is_word(byte: u8) -> bool {
        byte.is_ascii_alphanumeric() || byte == b'_'
    }
    const fn is_operator(byte: u8) -> bool {
        matches!(byte, b'+' | b'-' | b'*' | b'/' | b'%' | b'&' | b'|' | b'^' | b'<' | b'>' | b'=' | b'!' | b'~' | b'.')
    }
    is_word(before) && is_word(after) || is_operator(before) && is_operator(after)
}

/// Writes what [`bare`] gives, as far as there is room. How many bytes it is.
pub const fn write_bare(text: &str, out: &mut [u8]) -> usize {
    let text = text.as_bytes();
    let (mut read, mut length, mut last) = (0, 0, b' ');
    while read < text.len() {
        let mut byte = text[read];
        if byte == b'/' && read + 1 < text.len() && text[read + 1] == b'/' {
            while read < text.len() && text[read] != b'\n' {
                read += 1;
            }
            byte = b' ';
        }
        read += 1;
        if byte == b'\n' {
            byte = b' ';
        }
        let next = if read < text.len() { text[read] } else { b' ' };
        if byte == b' ' && !are_apart(last, next) {
            continue;
        }
        last = byte;
        if length < out.len() {
            out[length] = byte;
        }
        length += 1;
    }
    length
}

#[cfg(test)]
mod tests {
    use super::{bare, bare_length};

    #[test]
    fn what_a_compiler_skips_is_left_out() {
        const TEXT: &str =
            "// A comment.\n\nfn a() {\n    b(1 / 2 - -x); // Its end.\n    return\n        c;\n}\n//@import c";
        const BARE: [u8; bare_length(TEXT)] = bare(TEXT);
        assert_eq!(std::str::from_utf8(&BARE), Ok("fn a(){b(1/2- -x);return c;}"));
        assert_eq!((bare_length(""), bare_length("// only"), bare_length("a/b")), (0, 0, 3));
    }
}
