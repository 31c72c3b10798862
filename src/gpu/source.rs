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

/// A text of WGSL without comments, indents and empty lines; `N` is its [`bare_length`].
pub const fn bare<const N: usize>(text: &str) -> [u8; N] {
    let mut out = [0; N];
    write_bare(text, &mut out);
    out
}

/// Writes what [`bare`] gives, as far as there is room. How many bytes it is.
pub const fn write_bare(text: &str, out: &mut [u8]) -> usize {
    let text = text.as_bytes();
    let (mut read, mut length, mut begins) = (0, 0, true);
    while read < text.len() {
        let mut byte = text[read];
        if byte == b'/' && read + 1 < text.len() && text[read + 1] == b'/' {
            while read < text.len() && text[read] != b'\n' {
                read += 1;
            }
            byte = b'\n';
        }
        read += 1;
        // Of a line that has begun its end is kept, too.
        if begins && (byte == b' ' || byte == b'\n') {
            continue;
        }
        begins = byte == b'\n';
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
        const TEXT: &str = "// A comment.\n\nfn a() {\n    b(1 / 2); // Its end.\n\n}\n//@import c";
        const BARE: [u8; bare_length(TEXT)] = bare(TEXT);
        assert_eq!(std::str::from_utf8(&BARE), Ok("fn a() {\nb(1 / 2); \n}\n"));
        assert_eq!((bare_length(""), bare_length("// only"), bare_length("a/b")), (0, 0, 3));
    }
}
