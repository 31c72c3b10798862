//! Parts of a glTF document that are not read.

use super::super::{numbered, quoted};
use super::alpha::is_read;
use super::is_understood;
use super::json::Root;

/// Each kind of thing that is there and not read, with how many; `unread`: alpha-tested materials by images in other formats.
pub(super) fn ignored(root: &Root, unread: usize) -> Vec<String> {
    let primitives = || root.meshes.iter().flat_map(|m| &m.primitives);
    let morphed = primitives().filter(|p| !p.targets.is_empty()).count();
    let thin = primitives().filter(|p| p.mode.is_some_and(|mode| mode < 4)).count();
    let opaque = |mode: &Option<String>| mode.as_deref().is_none_or(|mode| mode == "OPAQUE");
    let clear = root.materials.iter().filter(|m| !opaque(&m.alpha_mode) && !is_read(m)).count();
    let mut asked: Vec<usize> = root
        .materials
        .iter()
        .filter(|m| is_read(m))
        .filter_map(|m| m.pbr.base_color_texture.as_ref().map(|of| of.index))
        .collect();
    asked.sort_unstable();
    asked.dedup();
    let flat = root.cameras.iter().filter(|c| c.perspective.is_none()).count();
    let beyond_first = |all: usize| all.saturating_sub(1);
    let mut found = numbered([
        (root.skins.len(), "skin", "skins"),
        (root.animations.len(), "animation", "animations"),
        (morphed, "primitive's morph targets", "primitives' morph targets"),
        (thin, "primitive of points or lines", "primitives of points or lines"),
        (root.textures.len().saturating_sub(asked.len()), "texture", "textures"),
        (
            unread,
            "alpha-tested material by an image that is no PNG",
            "alpha-tested materials by images that are no PNG",
        ),
        (clear, "see-through material, taken as opaque", "see-through materials, taken as opaque"),
        (beyond_first(root.scenes.len()), "other scene", "other scenes"),
        (beyond_first(root.cameras.len() - flat), "further camera", "further cameras"),
        (flat, "camera without perspective", "cameras without perspective"),
        (beyond_first(root.extensions.lights.lights.len()), "further light", "further lights"),
    ]);
    let unknown = root.extensions_used.iter().filter(|e| !is_understood(e));
    found.extend(unknown.map(|e| format!("extension {}", quoted(e))));
    found
}
