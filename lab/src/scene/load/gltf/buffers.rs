//! The bytes of a glTF document's buffers: from the binary chunk, from a file beside it, or from a data URI.

use super::super::{Beside, MAX_FILE_BYTES, Parsed, quoted};
use super::json::Root;
use std::borrow::Cow;

/// The bytes of all buffers of `root`, in order.
pub(super) fn load<'a>(root: &Root, beside: Beside<'a>, chunk: Option<&'a [u8]>) -> Parsed<Vec<Cow<'a, [u8]>>> {
    let mut total = 0u64;
    let mut buffers = Vec::new();
    for (i, buffer) in root.buffers.iter().enumerate() {
        let data: Cow<'a, [u8]> = match (&buffer.uri, chunk) {
            (Some(uri), _) => from_uri(uri, beside).map_err(|e| format!("glTF: buffer {i}: {e}"))?,
            (None, Some(chunk)) if i == 0 => chunk.into(),
            (None, _) => return Err(format!("glTF: buffer {i} of {} bytes has no data", buffer.byte_length)),
        };
        if buffer.byte_length > data.len() as u64 {
            return Err(format!("glTF: buffer {i} declares {} bytes, has {}", buffer.byte_length, data.len()));
        }
        // Many buffers may name one file.
        total += data.len() as u64;
        if total > MAX_FILE_BYTES {
            return Err(format!(
                "glTF: the buffers up to {i} take {total} bytes, at most {MAX_FILE_BYTES} may be used"
            ));
        }
        buffers.push(data);
    }
    Ok(buffers)
}

/// The bytes that a data URI holds, or a file beside the document.
pub(super) fn from_uri<'a>(uri: &str, beside: Beside<'a>) -> Parsed<Cow<'a, [u8]>> {
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data
            .split_once(',')
            .and_then(|(kind, encoded)| kind.ends_with(";base64").then_some(encoded))
            .ok_or_else(|| format!("data URI {} is not base64", quoted(data)))?;
        return base64(encoded.as_bytes()).map(Cow::Owned);
    }
    // Escapes are undone before the check, so that they cannot hide a way out of the folder.
    beside.read(&percent_decoded(uri)?)
}

fn percent_decoded(uri: &str) -> Parsed<String> {
    let mut decoded = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        if *first == b'%' {
            let hex = |b: u8| (b as char).to_digit(16);
            let byte = match tail {
                [a, b, ..] => hex(*a).zip(hex(*b)).map(|(a, b)| (a * 16 + b) as u8),
                _ => None,
            };
            decoded.push(byte.ok_or_else(|| format!("{} has a '%' without two hex digits", quoted(uri)))?);
            rest = &tail[2..];
        } else {
            decoded.push(*first);
            rest = tail;
        }
    }
    String::from_utf8(decoded).map_err(|_| format!("{} is not UTF-8", quoted(uri)))
}

fn base64(encoded: &[u8]) -> Parsed<Vec<u8>> {
    let digits = encoded.strip_suffix(b"==").or(encoded.strip_suffix(b"=")).unwrap_or(encoded);
    let mut decoded = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    let (mut bits, mut held) = (0u32, 0);
    for (at, &digit) in digits.iter().enumerate() {
        let value = match digit {
            b'A'..=b'Z' => digit - b'A',
            b'a'..=b'z' => digit - b'a' + 26,
            b'0'..=b'9' => digit - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return Err(format!("data URI has byte {digit} at place {at} of its base64")),
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            decoded.push((bits >> held) as u8);
        }
    }
    if digits.len() % 4 == 1 {
        return Err(format!("data URI has {} base64 digits, which is no whole number of bytes", digits.len()));
    }
    Ok(decoded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_back_what_was_encoded() {
        for (encoded, decoded) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmE", "fooba")] {
            assert_eq!(base64(encoded.as_bytes()).as_deref(), Ok(decoded.as_bytes()));
        }
        assert!(base64(b"Zm9v!A==").unwrap_err().contains("place 4"));
        assert!(base64(b"Zm9vY").unwrap_err().contains('5'));
    }

    #[test]
    fn percent_escapes_are_undone() {
        assert_eq!(percent_decoded("a%20b%2Fc").as_deref(), Ok("a b/c"));
        assert!(percent_decoded("a%2").is_err());
        assert!(percent_decoded("a%zz").is_err());
        assert!(percent_decoded("%ff").is_err());
    }
}
