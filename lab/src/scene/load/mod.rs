//! Loaders: glTF, OBJ, PLY and the project's scene files.
//!
//! Each reads bytes that may be anything. Whatever is wrong with them comes back as one line that names the file, the
//! object and the numbers; counts that a file declares are held against its size before memory is taken for them.

mod files;
mod gltf;
mod obj;
mod ply;
mod text;
mod toml;

use self::files::Beside;
pub use self::files::Files;
pub use self::toml::scene_file;
use super::{AlphaTested, Base, Camera, Light, Mesh};
use std::path::{Component, Path, PathBuf};
use subpixel_shadows::{Error, Result};

/// Contents of a file.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// All its triangles, in world space.
    pub mesh: Mesh,
    /// Its triangles that are alpha-tested.
    pub alpha: AlphaTested,
    /// Its first camera, if it has one.
    pub camera: Option<Camera>,
    /// Its first light, if it has one.
    pub light: Option<Light>,
    /// Whether it asks for a ground plane.
    pub ground: bool,
    /// The mesh, as a scene file that is beside this file names it.
    pub base: Option<Base>,
    /// Parts that are not read, each kind with its number, such as `2 skins`.
    pub ignored: Vec<String>,
}

/// Extensions of the files that [`load`] reads.
pub const EXTENSIONS: [&str; 5] = ["glb", "gltf", "obj", "ply", "toml"];

/// The largest file that is read, in bytes.
const MAX_FILE_BYTES: u64 = 1 << 32;

/// Error of the readers: the line without the file's name, which [`load`] adds.
type Parsed<T> = std::result::Result<T, String>;

/// Reads a `.glb`, `.gltf`, `.obj`, `.ply` or `.toml` file; the extension says which.
///
/// # Errors
/// [`Error::File`], one line, if the file cannot be read, is something else than its extension says, is damaged, or
/// holds a mesh, camera or light that cannot be used.
pub fn load(path: &Path) -> Result<Loaded> {
    load_among(path, &Files::default())
}

/// As [`load`], of a file among others: those that it names are looked for there first.
///
/// # Errors
/// As [`load`].
pub fn load_among(path: &Path, files: &Files) -> Result<Loaded> {
    let extension = extension(path)?;
    let bytes = &files.read(path)?[..];
    let beside = Beside { folder: path.parent().unwrap_or(Path::new("")), files };
    if bytes.is_empty() {
        return Err(Error::file(path, "is empty (0 bytes)"));
    }
    let loaded = sniff(bytes, &extension).and_then(|()| match extension.as_str() {
        "toml" => toml::load(beside, bytes),
        "obj" => obj::parse(bytes),
        "ply" => ply::parse(bytes),
        _ => gltf::parse(beside, bytes),
    });
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let named = |loaded: Loaded| Loaded { base: loaded.base.or(Some(Base::Mesh(name))), ..loaded };
    loaded.and_then(Loaded::checked).map(named).map_err(|message| Error::file(path, one_line(&message)))
}

impl Loaded {
    /// One line for people on what is not read; `None` if all is.
    pub fn note(&self) -> Option<String> {
        const SHOWN: usize = 10;
        let mut parts: Vec<String> = self.ignored.iter().take(SHOWN).cloned().collect();
        parts.extend(numbered([(self.ignored.len().saturating_sub(SHOWN), "other kind", "other kinds")]));
        let last = parts.pop()?;
        let all = if parts.is_empty() { last } else { format!("{} and {last}", parts.join(", ")) };
        Some(format!("not read: {all}"))
    }

    fn checked(self) -> Parsed<Self> {
        self.mesh.check("all").map_err(|e| without_name(&e))?;
        self.alpha.check(&self.mesh).map_err(|e| without_name(&e))?;
        if let Some(camera) = &self.camera {
            camera.check().map_err(|e| without_name(&e))?;
        }
        if let Some(light) = &self.light {
            light.check().map_err(|e| without_name(&e))?;
        }
        Ok(self)
    }
}

/// The text of an error without the object it was found in.
fn without_name(error: &Error) -> String {
    match error {
        Error::Mesh { message, .. } | Error::File { message, .. } | Error::Scene(message) => message.clone(),
        other => other.to_string(),
    }
}

/// The extension of a file that is read, in lower case.
fn extension(path: &Path) -> Result<String> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !EXTENSIONS.contains(&extension.as_str()) {
        return Err(Error::file(path, format!("has no extension that is read: {}", EXTENSIONS.join(", "))));
    }
    Ok(extension)
}

/// Refuses a file that starts as something else than `extension` says.
fn sniff(bytes: &[u8], extension: &str) -> Parsed<()> {
    const SIGNATURES: [(&[u8], &str, &[&str]); 12] = [
        (b"\x89PNG", "a PNG image", &[]),
        (b"\xff\xd8\xff", "a JPEG image", &[]),
        (b"GIF8", "a GIF image", &[]),
        (b"PK\x03\x04", "a ZIP archive", &[]),
        (b"\x1f\x8b", "gzip data", &[]),
        (b"%PDF", "a PDF document", &[]),
        (b"\x7fELF", "an ELF program", &[]),
        (b"\xff\xfe", "UTF-16 text; UTF-8 is read", &[]),
        (b"\xfe\xff", "UTF-16 text; UTF-8 is read", &[]),
        (b"glTF", "a binary glTF file", &["glb", "gltf"]),
        (b"ply\n", "a PLY mesh", &["ply"]),
        (b"ply\r", "a PLY mesh", &["ply"]),
    ];
    match SIGNATURES.iter().find(|(signature, ..)| bytes.starts_with(signature)) {
        Some((_, what, extensions)) if !extensions.contains(&extension) => {
            Err(format!("is named .{extension} but holds {what}"))
        }
        _ => Ok(()),
    }
}

/// `relative` below `folder`, for paths that files name.
fn inside(folder: &Path, relative: &str) -> Parsed<PathBuf> {
    let path = Path::new(relative);
    let stays = path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    // A colon would be a scheme or a Windows drive, a backslash a separator on some systems only.
    if relative.is_empty() || !stays || relative.contains([':', '\\', '\0']) {
        return Err(format!("path {} is not a relative path that stays in the folder", quoted(relative)));
    }
    Ok(folder.join(path))
}

/// A number of things, each with its name for one and for many; none of those that are not there.
fn numbered<const N: usize>(things: [(usize, &str, &str); N]) -> Vec<String> {
    let there = things.into_iter().filter(|(n, ..)| *n > 0);
    there.map(|(n, one, many)| format!("{n} {}", if n == 1 { one } else { many })).collect()
}

/// A name from a file in quotes, with nothing in it that could break the line, cut to a sensible length.
fn quoted(name: &str) -> String {
    let mut shown: String = name.chars().take(60).flat_map(char::escape_debug).collect();
    if name.chars().nth(60).is_some() {
        shown.push('…');
    }
    format!("'{shown}'")
}

/// A message as one line of sensible length; messages of other libraries may quote the file.
fn one_line(message: &str) -> String {
    let words: Vec<&str> = message.split_whitespace().collect();
    let mut line = words.join(" ");
    if let Some((cut, _)) = line.char_indices().nth(300) {
        line.truncate(cut);
        line.push('…');
    }
    line.replace(|c: char| c.is_control(), "?")
}
