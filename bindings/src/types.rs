//! Types of WGSL as the host has them.

use naga::{
    ArraySize, ImageClass, ImageDimension, Module, Scalar, ScalarKind, StorageAccess, StorageFormat, TypeInner,
};
use std::collections::HashMap;
use std::path::Path;

/// Structs of `src/` that kernels share, by the kernel, or the imported file (`FOLDER/FILE`), that declares them and their name.
pub struct SharedStructs(HashMap<(String, String), String>);

/// Structs that the scene declares, which knows no kernel.
const OF_THE_SCENE: [(&str, &str); 1] = [("Edge", "crate::scene::Edge")];

impl SharedStructs {
    /// Those of all files under `src`.
    pub fn read(src: &Path) -> Result<Self, String> {
        let mut found = HashMap::new();
        let mut folders = vec![(src.to_owned(), "crate".to_owned())];
        while let Some((folder, module)) = folders.pop() {
            let fault = |e: std::io::Error| format!("{}: {e}", folder.display());
            for entry in std::fs::read_dir(&folder).map_err(fault)? {
                let path = entry.map_err(fault)?.path();
                let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
                let inner = if matches!(stem, "mod" | "lib") { module.clone() } else { format!("{module}::{stem}") };
                if path.is_dir() {
                    folders.push((path, inner));
                } else if path.extension().is_some_and(|e| e == "rs") {
                    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
                    for line in text.lines().map(str::trim) {
                        let Some((kernel, rest)) =
                            line.strip_prefix('"').and_then(|l| l.split_once("\" => pub struct "))
                        else {
                            continue;
                        };
                        let name = rest.split([' ', '{']).next().unwrap_or_default().to_owned();
                        let path = format!("{inner}::{name}");
                        found.insert((kernel.to_owned(), name), path);
                    }
                }
            }
        }
        Ok(Self(found))
    }

    /// The Rust path of a struct that kernel `stem` binds.
    fn path(&self, stem: &str, name: &str) -> Option<&str> {
        let of_the_scene = OF_THE_SCENE.iter().find(|(known, _)| *known == name).map(|(_, path)| *path);
        let own = self.0.get(&(stem.to_owned(), name.to_owned())).map(String::as_str);
        let shared = || self.0.iter().find(|((kernel, n), _)| kernel.contains('/') && n == name);
        own.or_else(|| shared().map(|(_, path)| path.as_str())).or(of_the_scene)
    }

    /// The element that a buffer of type `ty` holds, as the host has it: of an array its element, of a vector of three with its padding
    /// four numbers, of a struct with a list behind a header plain words.
    pub fn element(&self, module: &Module, stem: &str, ty: &TypeInner, name: Option<&str>) -> Result<String, String> {
        let scalar = |s: &Scalar| match (s.kind, s.width) {
            (ScalarKind::Uint, 4) => Ok("u32"),
            (ScalarKind::Uint, 8) => Ok("u64"),
            (ScalarKind::Sint, 4) => Ok("i32"),
            (ScalarKind::Float, 4) => Ok("f32"),
            _ => Err(format!("the host shares no {s:?}")),
        };
        match ty {
            TypeInner::Scalar(s) | TypeInner::Atomic(s) => scalar(s).map(str::to_owned),
            TypeInner::Vector { size, scalar: s } => {
                let padded = if *size as u8 == 3 { 4 } else { *size as u8 };
                Ok(format!("[{}; {padded}]", scalar(s)?))
            }
            TypeInner::Array { base, .. } => {
                let base = &module.types[*base];
                self.element(module, stem, &base.inner, base.name.as_deref())
            }
            TypeInner::Struct { members, .. } => {
                let last = members.last().map(|m| &module.types[m.ty].inner);
                if matches!(last, Some(TypeInner::Array { size: ArraySize::Dynamic, .. })) {
                    return Ok("u32".to_owned());
                }
                let name = name.unwrap_or_default();
                let missing = || format!("no `shared_struct!` declares '{name}'");
                self.path(stem, name).map(str::to_owned).ok_or_else(missing)
            }
            _ => Err(format!("the host shares no {ty:?}")),
        }
    }
}

/// The binding type of a texture; `None` if the host knows none.
pub fn texture(inner: &TypeInner) -> Option<&'static str> {
    let TypeInner::Image { dim: ImageDimension::D2, arrayed, class } = inner else { return None };
    match (*class, *arrayed) {
        (ImageClass::Sampled { kind: ScalarKind::Uint, multi: false }, false) => Some("TextureUint"),
        (ImageClass::Sampled { kind: ScalarKind::Uint, multi: false }, true) => Some("TextureUintLayers"),
        (ImageClass::Sampled { kind: ScalarKind::Uint, multi: true }, false) => Some("TextureUintSamples"),
        (ImageClass::Sampled { kind: ScalarKind::Float, multi: false }, false) => Some("TextureFloat"),
        (ImageClass::Sampled { kind: ScalarKind::Float, multi: true }, false) => Some("TextureFloatSamples"),
        (ImageClass::Storage { format: StorageFormat::R32Float, access }, false) if access == StorageAccess::STORE => {
            Some("TextureStoreR32Float")
        }
        _ => None,
    }
}
