//! Typed reads through accessors, with every bound checked first.

use super::super::Parsed;
use super::json::{Accessor, Root};
use std::borrow::Cow;

/// The document and the bytes of its buffers.
pub(super) struct Source<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: &'a [Cow<'a, [u8]>],
}

/// Equal elements at equal distances.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        // In bounds: `elements` checked the end of the last one.
        (0..self.count).map(move |i| &bytes[i * stride..i * stride + size])
    }
}

/// The type of a component.
#[derive(Clone, Copy)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value of up to four little-endian bytes.
    fn value(self, bytes: &[u8], normalized: bool) -> f64 {
        let bits = bytes.iter().rev().fold(0u32, |bits, &b| bits << 8 | u32::from(b));
        let (value, one) = match self {
            Self::I8 => (f64::from(bits as u8 as i8), 127.0),
            Self::U8 => (f64::from(bits), 255.0),
            Self::I16 => (f64::from(bits as u16 as i16), 32767.0),
            Self::U16 => (f64::from(bits), 65535.0),
            Self::U32 => (f64::from(bits), f64::from(u32::MAX)),
            Self::F32 => return f64::from(f32::from_bits(bits)),
        };
        if normalized { (value / one).max(-1.0) } else { value }
    }
}

impl Source<'_> {
    /// The accessor of this index.
    pub(super) fn accessor(&self, index: usize) -> Parsed<&Accessor> {
        let all = &self.root.accessors;
        all.get(index).ok_or_else(|| format!("glTF: accessor {index} is used, there are {}", all.len()))
    }

    /// Positions of vertices.
    pub(super) fn positions(&self, index: usize) -> Parsed<Vec<[f32; 3]>> {
        self.vectors(index, "positions")
    }

    /// Texture coordinates of vertices.
    pub(super) fn texture_coordinates(&self, index: usize) -> Parsed<Vec<[f32; 2]>> {
        self.vectors(index, "texture coordinates")
    }

    fn vectors<const N: usize>(&self, index: usize, what: &str) -> Parsed<Vec<[f32; N]>> {
        let accessor = self.accessor(index)?;
        if accessor.kind != format!("VEC{N}") {
            return Err(format!("glTF: accessor {index} of {what} is not VEC{N}"));
        }
        let component = self.component(index, &[5120, 5121, 5122, 5123, 5126])?;
        let size = component.size();
        let read = |element: &[u8]| {
            let mut vector = [0.0; N];
            for (c, bytes) in vector.iter_mut().zip(element.chunks_exact(size)) {
                *c = component.value(bytes, accessor.normalized) as f32;
            }
            vector
        };
        self.values(index, N * size, [0.0; N], read)
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, view: usize) -> Parsed<&[u8]> {
        let length = self.root.buffer_views.get(view).map_or(0, |v| v.byte_length);
        self.elements("an image", view, 0, length, 1, false).map(|all| all.bytes)
    }

    /// Indices of vertices.
    pub(super) fn indices(&self, index: usize) -> Parsed<Vec<u32>> {
        if self.accessor(index)?.kind != "SCALAR" {
            return Err(format!("glTF: accessor {index} of indices is not SCALAR"));
        }
        let component = self.component(index, &[5121, 5123, 5125])?;
        self.values(index, component.size(), 0, |bytes| component.value(bytes, false) as u32)
    }

    fn component(&self, index: usize, allowed: &[u32]) -> Parsed<Component> {
        let code = self.accessor(index)?.component_type;
        Component::of(code)
            .filter(|_| allowed.contains(&code))
            .ok_or_else(|| format!("glTF: accessor {index} has component type {code}, which cannot be used there"))
    }

    /// The elements of an accessor, its sparse ones put in place.
    fn values<T: Copy>(&self, index: usize, size: usize, zero: T, read: impl Fn(&[u8]) -> T) -> Parsed<Vec<T>> {
        let accessor = self.accessor(index)?;
        let what = format!("accessor {index}");
        let mut values: Vec<T> = match accessor.buffer_view {
            Some(view) => self
                .elements(&what, view, accessor.byte_offset, accessor.count, size, true)?
                .iter()
                .map(&read)
                .collect(),
            None => {
                // All zeros until sparse values replace them. Nothing in the file backs the count, so it is held
                // against the size of the file.
                let bytes: usize = self.buffers.iter().map(|b| b.len()).sum();
                if accessor.count > bytes as u64 {
                    return Err(format!(
                        "glTF: {what} has {} elements and no data, all buffers hold {bytes} bytes",
                        accessor.count
                    ));
                }
                vec![zero; accessor.count as usize]
            }
        };
        let Some(sparse) = &accessor.sparse else { return Ok(values) };
        if sparse.count > accessor.count {
            return Err(format!("glTF: {what} has {} elements and {} sparse ones", accessor.count, sparse.count));
        }
        let component = Component::of(sparse.indices.component_type)
            .filter(|c| matches!(c, Component::U8 | Component::U16 | Component::U32))
            .ok_or_else(|| format!("glTF: {what} has sparse indices of type {}", sparse.indices.component_type))?;
        let at = &sparse.indices;
        let places = self.elements(&what, at.buffer_view, at.byte_offset, sparse.count, component.size(), false)?;
        let from = &sparse.values;
        let replacements = self.elements(&what, from.buffer_view, from.byte_offset, sparse.count, size, false)?;
        for (place, replacement) in places.iter().zip(replacements.iter()) {
            let place = component.value(place, false) as usize;
            *values.get_mut(place).ok_or_else(|| {
                format!("glTF: {what} has a sparse value for element {place}, has {} elements", accessor.count)
            })? = read(replacement);
        }
        Ok(values)
    }

    /// `count` elements of `size` bytes from `offset` in a buffer view.
    fn elements(
        &self,
        what: &str,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
        strided: bool,
    ) -> Parsed<Elements<'_>> {
        let views = &self.root.buffer_views;
        let v = views.get(view).ok_or_else(|| format!("glTF: {what} uses view {view}, there are {}", views.len()))?;
        let buffer = self
            .buffers
            .get(v.buffer)
            .ok_or_else(|| format!("glTF: view {view} uses buffer {}, there are {}", v.buffer, self.buffers.len()))?;
        let bytes = usize::try_from(v.byte_offset)
            .ok()
            .and_then(|start| buffer.get(start..))
            .and_then(|rest| rest.get(..usize::try_from(v.byte_length).ok()?))
            .ok_or_else(|| {
                format!(
                    "glTF: view {view} takes {} bytes from {}, buffer {} has {}",
                    v.byte_length,
                    v.byte_offset,
                    v.buffer,
                    buffer.len()
                )
            })?;
        let stride = v.byte_stride.filter(|_| strided).unwrap_or(size as u64);
        if stride < size as u64 {
            return Err(format!("glTF: view {view} has stride {stride}, {what} has elements of {size} bytes"));
        }
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(last) => last.checked_mul(stride).and_then(|n| n.checked_add(size as u64)?.checked_add(offset)),
        };
        match needed {
            Some(n) if n <= bytes.len() as u64 => {}
            Some(n) => return Err(format!("glTF: {what} needs {n} bytes, view {view} has {}", bytes.len())),
            None => {
                return Err(format!(
                    "glTF: {what} has {count} elements at stride {stride}, view {view} has {} bytes",
                    bytes.len()
                ));
            }
        }
        // With no elements the offset was not checked, and nothing is read.
        let start = if count == 0 { 0 } else { offset as usize };
        Ok(Elements { bytes: &bytes[start..], stride: stride as usize, size, count: count as usize })
    }
}
