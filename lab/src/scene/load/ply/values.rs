//! The values of a PLY body, one after another.

use super::super::Parsed;
use super::super::text::shown;
use super::header::{Format, Scalar};

/// Reads numbers from the body of a PLY file.
pub(super) struct Values<'a> {
    format: Format,
    bytes: &'a [u8],
    at: usize,
    /// Whether a number of the current row was read.
    in_row: bool,
}

impl<'a> Values<'a> {
    pub(super) fn new(format: Format, bytes: &'a [u8]) -> Self {
        Self { format, bytes, at: 0, in_row: false }
    }

    /// Bytes that are left.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next number. `f64` holds every value of every type.
    pub(super) fn number(&mut self, kind: Scalar) -> Parsed<f64> {
        match self.format {
            Format::Ascii => self.word(),
            Format::LittleEndian => self.binary(kind, false),
            Format::BigEndian => self.binary(kind, true),
        }
    }

    /// Goes to the next row. In a text file a row is a line; further words on it are left unread.
    pub(super) fn end_row(&mut self) {
        if self.format == Format::Ascii {
            let rest = &self.bytes[self.at..];
            self.at += rest.iter().position(|&b| b == b'\n').map_or(rest.len(), |n| n + 1);
            self.in_row = false;
        }
    }

    fn word(&mut self) -> Parsed<f64> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        if start == rest.len() {
            return Err(format!("the file ends in it, {} bytes into the data", self.bytes.len()));
        }
        if self.in_row && rest[..start].contains(&b'\n') {
            return Err("its line ends too early".into());
        }
        let word = &rest[start..];
        let word = &word[..word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len())];
        self.at += start + word.len();
        self.in_row = true;
        let text = std::str::from_utf8(word).ok();
        text.and_then(|w| w.parse().ok()).ok_or_else(|| format!("{} is not a number", shown(word)))
    }

    fn binary(&mut self, kind: Scalar, big: bool) -> Parsed<f64> {
        Ok(match kind {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take(big)?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take(big)?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take(big)?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take(big)?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take(big)?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take(big)?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take(big)?)),
            Scalar::F64 => f64::from_le_bytes(self.take(big)?),
        })
    }

    /// The next `N` bytes, in little-endian order.
    fn take<const N: usize>(&mut self, big: bool) -> Parsed<[u8; N]> {
        let mut bytes: [u8; N] = self
            .bytes
            .get(self.at..self.at + N)
            .and_then(|b| b.try_into().ok())
            .ok_or_else(|| format!("the file ends in it, {} bytes into the data", self.bytes.len()))?;
        self.at += N;
        if big {
            bytes.reverse();
        }
        Ok(bytes)
    }
}
