//! Lines, words and numbers of text files, read as bytes: names and comments need not be UTF-8.

use super::{Parsed, quoted};

/// `bytes` without a UTF-8 byte order mark.
pub(super) fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
}

/// A word for a message.
pub(super) fn shown(word: &[u8]) -> String {
    quoted(&String::from_utf8_lossy(&word[..word.len().min(256)]))
}

/// A number as written. Spellings of infinity and NaN, and numbers too large for `f32`, are refused.
pub(super) fn coordinate(word: &[u8]) -> Parsed<f32> {
    let value: Option<f32> = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
    match value {
        Some(v) if v.is_finite() => Ok(v),
        Some(v) => Err(format!("{} is {v}, not a finite number", shown(word))),
        None => Err(format!("{} is not a number", shown(word))),
    }
}

/// A whole number as written.
pub(super) fn integer(word: &[u8]) -> Parsed<i64> {
    std::str::from_utf8(word)
        .ok()
        .and_then(|w| w.parse().ok())
        .ok_or_else(|| format!("{} is not a whole number", shown(word)))
}
