//! The header of a PLY file.

use super::super::Parsed;
use super::super::text::{shown, words};

/// How the body is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A property of an element.
pub(super) struct Property {
    pub(super) name: String,
    /// The type of its values.
    pub(super) kind: Scalar,
    /// The type of its length, if it is a list.
    pub(super) count: Option<Scalar>,
}

/// A table of the file.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// Elements of the body, in order.
pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
}

/// Longest header that is read, in bytes.
const MAX_HEADER: usize = 1 << 20;

impl Format {
    /// The least number of bytes a row of `element` takes.
    pub(super) fn min_bytes(self, element: &Element) -> u64 {
        let of = |p: &Property| match self {
            // A digit and what ends the word.
            Self::Ascii => 2,
            _ => p.count.unwrap_or(p.kind).bytes(),
        };
        element.properties.iter().map(of).sum()
    }
}

impl Header {
    /// Reads the header; also returns where the body starts.
    pub(super) fn parse(bytes: &[u8]) -> Parsed<(Self, usize)> {
        let mut format = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut at = 0;
        for number in 1u32.. {
            let rest = &bytes[at..bytes.len().min(MAX_HEADER)];
            let Some(length) = rest.iter().position(|&b| b == b'\n') else {
                return Err(match number {
                    1 => "does not start with a line 'ply'".into(),
                    _ => format!("the header has no line 'end_header' in its first {} bytes", at + rest.len()),
                });
            };
            let line = rest[..length].trim_ascii();
            at += length + 1;
            if number == 1 && line != b"ply" {
                return Err("does not start with a line 'ply'".into());
            }
            let words: Vec<&[u8]> = words(line).collect();
            match words[..] {
                [b"end_header"] => {
                    let format = format.ok_or("the header has no line 'format'")?;
                    return Ok((Self { format, elements }, at));
                }
                [b"ply"] if number == 1 => {}
                [] | [b"comment" | b"obj_info", ..] => {}
                [b"format", name, _] => format = Some(self::format(name)?),
                [b"element", name, count] => elements.push(element(name, count, number)?),
                [b"property", ref rest @ ..] => {
                    let property =
                        property(rest).ok_or_else(|| format!("line {number}: {} cannot be read", shown(line)))?;
                    let element = elements.last_mut().ok_or_else(|| {
                        format!("line {number}: property '{}' comes before any element", property.name)
                    })?;
                    element.properties.push(property);
                }
                _ => return Err(format!("line {number}: {} is not a line of a PLY header", shown(line))),
            }
        }
        Err("the header does not end".into())
    }
}

fn format(name: &[u8]) -> Parsed<Format> {
    match name {
        b"ascii" => Ok(Format::Ascii),
        b"binary_little_endian" => Ok(Format::LittleEndian),
        b"binary_big_endian" => Ok(Format::BigEndian),
        _ => Err(format!("format {} is not known", shown(name))),
    }
}

fn element(name: &[u8], count: &[u8], line: u32) -> Parsed<Element> {
    let count = std::str::from_utf8(count)
        .ok()
        .and_then(|c| c.parse().ok())
        .ok_or_else(|| format!("line {line}: element {} has count {}", shown(name), shown(count)))?;
    let name = super::super::quoted(&String::from_utf8_lossy(name));
    Ok(Element { name: name.trim_matches('\'').into(), count, properties: Vec::new() })
}

fn property(words: &[&[u8]]) -> Option<Property> {
    let name = |w: &[u8]| String::from_utf8_lossy(w).into_owned();
    match *words {
        [b"list", count, kind, n] => Some(Property { name: name(n), kind: scalar(kind)?, count: Some(scalar(count)?) }),
        [kind, n] => Some(Property { name: name(n), kind: scalar(kind)?, count: None }),
        _ => None,
    }
}

fn scalar(name: &[u8]) -> Option<Scalar> {
    Some(match name {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        _ => return None,
    })
}
