//! glTF 2.0, as `.gltf` with its buffers or as `.glb`: the triangles of its scene in world space, its first camera and
//! its first light (`KHR_lights_punctual`).
//!
//! Materials whose `alphaMode` is `MASK` are alpha-tested by the alpha of their base colour, textures of which are read from PNG.
//! Skins, morph targets and animations are not applied, points, lines and cameras without perspective are left out;
//! [`Loaded::ignored`] names them.
//! Read from the JSON directly, so that every index, count and length is held against what is there before it is used.

mod accessor;
mod alpha;
mod buffers;
mod ignored;
mod json;
mod nodes;
mod primitives;

use super::text::without_bom;
use super::{Beside, Loaded, Parsed, quoted};
use json::Root;

/// Reads a `.gltf` or `.glb` file; `beside` it lie its buffers and images.
pub(super) fn parse(beside: Beside, bytes: &[u8]) -> Parsed<Loaded> {
    let (text, chunk) = if bytes.starts_with(b"glTF") { split_glb(bytes)? } else { (without_bom(bytes), None) };
    let root: Root = serde_json::from_slice(text).map_err(|e| format!("glTF: {e}"))?;
    check_asset(&root)?;
    let buffers = buffers::load(&root, beside, chunk)?;
    nodes::assemble(&root, &buffers, beside)
}

/// The JSON and the binary chunk of a GLB file.
fn split_glb(bytes: &[u8]) -> Parsed<(&[u8], Option<&[u8]>)> {
    let word = |at: usize| -> Parsed<u32> {
        bytes
            .get(at..at + 4)
            .and_then(|b| b.try_into().ok())
            .map(u32::from_le_bytes)
            .ok_or_else(|| format!("GLB: the file ends at byte {}, inside a header", bytes.len()))
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(format!("GLB: version {version}, version 2 is read"));
    }
    if length < 12 || length > bytes.len() {
        return Err(format!("GLB: declared length {length}, the file has {} bytes, its header takes 12", bytes.len()));
    }
    let (mut text, mut binary) = (None, None);
    let mut at = 12;
    while at < length {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let data = bytes[..length].get(at + 8..).and_then(|rest| rest.get(..size)).ok_or_else(|| {
            format!("GLB: chunk at byte {at} declares {size} bytes, {} are left", length.saturating_sub(at + 8))
        })?;
        match &kind.to_le_bytes() {
            b"JSON" if text.is_none() => text = Some(data),
            b"BIN\0" if binary.is_none() => binary = Some(data),
            _ => {}
        }
        at += 8 + size;
    }
    Ok((text.ok_or("GLB: has no JSON chunk")?, binary))
}

/// Extensions that may be required of a reader of triangles: those say where surfaces are, or only how they look.
fn is_understood(extension: &str) -> bool {
    const READ: [&str; 2] = ["KHR_lights_punctual", "KHR_mesh_quantization"];
    const LOOKS: [&str; 4] = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_"];
    READ.contains(&extension) || LOOKS.iter().any(|prefix| extension.starts_with(prefix))
}

fn check_asset(root: &Root) -> Parsed<()> {
    let version = root.asset.version.as_str();
    if version != "2" && !version.starts_with("2.") {
        return Err(format!("glTF: version {}, version 2 is read", quoted(version)));
    }
    match root.extensions_required.iter().find(|e| !is_understood(e)) {
        Some(e) => Err(format!("glTF: requires extension {}, which is not read", quoted(e))),
        None => Ok(()),
    }
}
