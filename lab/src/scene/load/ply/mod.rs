//! PLY: ascii, binary little endian and binary big endian, with properties of any type in any order.

mod header;
mod values;

use super::{Loaded, Mesh, Parsed};
use header::{Element, Header, Property, Scalar};
use values::Values;

/// Reads a PLY file.
pub(super) fn parse(bytes: &[u8]) -> Parsed<Loaded> {
    let (header, body) = Header::parse(bytes)?;
    let body = bytes.get(body..).unwrap_or_default();
    let mut values = Values::new(header.format, body);
    let (mut mesh, mut ignored) = (Mesh::default(), Vec::new());
    if !header.elements.iter().any(|e| e.name == "vertex") {
        return Err("has no element 'vertex'".into());
    }
    for element in &header.elements {
        check_size(element, header.format.min_bytes(element), values.left())?;
        let read = match element.name.as_str() {
            "vertex" => vertices(element, &mut values, &mut mesh),
            "face" => faces(element, &mut values, &mut mesh),
            "tristrips" => strips(element, &mut values, &mut mesh),
            name => {
                if element.count > 0 {
                    let rows = if element.count == 1 { "row" } else { "rows" };
                    ignored.push(format!("{} {rows} of element '{name}'", element.count));
                }
                skip(element, &mut values)
            }
        };
        read?;
    }
    let n = mesh.positions.len();
    match mesh.triangles.iter().enumerate().find(|(_, tri)| tri.iter().any(|&v| v as usize >= n)) {
        Some((t, tri)) => {
            Err(format!("triangle {t} uses vertex {}, the file has {n}", tri.iter().fold(0, |a, &b| a.max(b))))
        }
        None => Ok(Loaded { mesh, ignored, ..Loaded::default() }),
    }
}

/// Holds a declared number of rows against the bytes that are left.
fn check_size(element: &Element, row: u64, left: usize) -> Parsed<()> {
    // The last row of a text file may lack its end of line.
    if element.count.saturating_mul(row) > left as u64 + 1 {
        return Err(format!(
            "element '{}' declares {} rows of at least {row} bytes, {left} bytes are left",
            element.name, element.count
        ));
    }
    Ok(())
}

/// Reads `element` row by row and hands each value of the property at `wanted` places to `take(place, value)`.
fn vertices(element: &Element, values: &mut Values, mesh: &mut Mesh) -> Parsed<()> {
    let mut axes = [0usize; 3];
    for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
        *axis = element
            .properties
            .iter()
            .position(|p| p.name == name && p.count.is_none())
            .ok_or_else(|| format!("element 'vertex' has no scalar property '{name}'"))?;
    }
    if element.count > u64::from(u32::MAX) {
        return Err(format!("element 'vertex' declares {} rows, at most {} may be used", element.count, u32::MAX));
    }
    mesh.positions.reserve_exact(element.count as usize);
    for row in 0..element.count {
        let at = |e: String| format!("vertex {row}: {e}");
        let mut position = [0.0f32; 3];
        for (p, property) in element.properties.iter().enumerate() {
            if property.count.is_some() {
                skip_property(property, values).map_err(at)?;
                continue;
            }
            let value = values.number(property.kind).map_err(at)?;
            if let Some(axis) = axes.iter().position(|&a| a == p) {
                position[axis] = value as f32;
            }
        }
        if !position.iter().all(|c| c.is_finite()) {
            return Err(format!("vertex {row} ({}, {}, {}) is not finite", position[0], position[1], position[2]));
        }
        mesh.positions.push(position);
        values.end_row();
    }
    Ok(())
}

/// Reads the index lists of `element` row by row.
fn lists(element: &Element, values: &mut Values, mut take: impl FnMut(&[i64]) -> Parsed<()>) -> Parsed<()> {
    let wanted = element
        .properties
        .iter()
        .position(|p| p.count.is_some() && (p.name == "vertex_indices" || p.name == "vertex_index"))
        .ok_or_else(|| format!("element '{}' has no list property 'vertex_indices'", element.name))?;
    let mut list = Vec::new();
    for row in 0..element.count {
        let at = |e: String| format!("{} {row}: {e}", element.name);
        for (p, property) in element.properties.iter().enumerate() {
            if p != wanted {
                skip_property(property, values).map_err(at)?;
                continue;
            }
            list.clear();
            let n = list_length(property, values).map_err(at)?;
            for _ in 0..n {
                let value = values.number(property.kind).map_err(at)?;
                if value.fract() != 0.0 || value.abs() > f64::from(u32::MAX) {
                    return Err(at(format!("{value} is not a vertex index")));
                }
                list.push(value as i64);
            }
        }
        take(&list).map_err(at)?;
        values.end_row();
    }
    Ok(())
}

fn vertex(index: i64) -> Parsed<u32> {
    u32::try_from(index).map_err(|_| format!("uses vertex {index}"))
}

fn push(mesh: &mut Mesh, corners: [i64; 3]) -> Parsed<()> {
    if mesh.triangles.len() == Mesh::MAX_TRIANGLES {
        return Err(format!("is beyond {} triangles", Mesh::MAX_TRIANGLES));
    }
    mesh.triangles.push([vertex(corners[0])?, vertex(corners[1])?, vertex(corners[2])?]);
    Ok(())
}

/// Polygons become triangle fans.
fn faces(element: &Element, values: &mut Values, mesh: &mut Mesh) -> Parsed<()> {
    lists(element, values, |list| match list {
        [first, rest @ ..] if rest.len() >= 2 => rest.windows(2).try_for_each(|w| push(mesh, [*first, w[0], w[1]])),
        _ => Err(format!("has {} corners, needs 3", list.len())),
    })
}

/// Triangle strips, one after another in one list, with −1 between them.
fn strips(element: &Element, values: &mut Values, mesh: &mut Mesh) -> Parsed<()> {
    lists(element, values, |list| {
        for strip in list.split(|&v| v == -1) {
            for (k, w) in strip.windows(3).enumerate() {
                // Every other triangle of a strip winds the other way.
                push(mesh, if k % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })?;
            }
        }
        Ok(())
    })
}

fn skip(element: &Element, values: &mut Values) -> Parsed<()> {
    // Rows without properties take no bytes, and there may be any number of them.
    if element.properties.is_empty() {
        return Ok(());
    }
    for row in 0..element.count {
        for property in &element.properties {
            skip_property(property, values).map_err(|e| format!("{} {row}: {e}", element.name))?;
        }
        values.end_row();
    }
    Ok(())
}

fn skip_property(property: &Property, values: &mut Values) -> Parsed<()> {
    let n = list_length(property, values)?;
    (0..n).try_for_each(|_| values.number(property.kind).map(|_| ()))
}

/// How many values of a property follow: 1, or the length of its list.
fn list_length(property: &Property, values: &mut Values) -> Parsed<u64> {
    let Some(kind) = property.count else { return Ok(1) };
    let n = values.number(kind)?;
    if n < 0.0 || n.fract() != 0.0 || n > f64::from(u32::MAX) {
        return Err(format!("list '{}' has length {n}", property.name));
    }
    Ok(n as u64)
}

impl Scalar {
    /// Bytes of a value in a binary file.
    fn bytes(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}
