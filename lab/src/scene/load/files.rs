//! Files that scenes name.

use super::{MAX_FILE_BYTES, Parsed, inside, one_line};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use subpixel_shadows::{Error, Result};

/// Files by their paths: those that are held in memory (a page that was given files has no disk), else those on the disk.
#[derive(Clone, Debug, Default)]
pub struct Files(BTreeMap<PathBuf, Arc<[u8]>>);

impl Files {
    /// Holds a file; one of this path that was held before is dropped.
    pub fn hold(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Arc<[u8]>>) {
        self.0.insert(path.into(), bytes.into());
    }

    /// Paths and contents of the files that are held.
    pub fn held(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.0.iter().map(|(path, bytes)| (&**path, &**bytes))
    }

    /// Whether a file of this path is held.
    pub fn holds(&self, path: &Path) -> bool {
        self.0.contains_key(path)
    }

    /// The bytes of a file of sensible size.
    pub(super) fn read(&self, path: &Path) -> Result<Cow<'_, [u8]>> {
        if let Some(bytes) = self.0.get(path) {
            return Ok(bytes[..].into());
        }
        let fault = |e: std::io::Error| match e.kind() {
            // A page has no disk.
            ErrorKind::Unsupported => {
                Error::file(path, "is not there: hand it over together with the file that names it")
            }
            _ => Error::file(path, one_line(&e.to_string())),
        };
        let metadata = std::fs::metadata(path).map_err(fault)?;
        if !metadata.is_file() {
            return Err(Error::file(path, "is not a file"));
        }
        if metadata.len() > MAX_FILE_BYTES {
            let bytes = metadata.len();
            return Err(Error::file(path, format!("has {bytes} bytes, files of at most {MAX_FILE_BYTES} are read")));
        }
        std::fs::read(path).map(Cow::Owned).map_err(fault)
    }
}

/// The folder of a file, and what lies in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside<'a> {
    pub(super) folder: &'a Path,
    pub(super) files: &'a Files,
}

impl<'a> Beside<'a> {
    /// The bytes of a file that is named by a path below the folder.
    pub(super) fn read(&self, relative: &str) -> Parsed<Cow<'a, [u8]>> {
        self.files.read(&inside(self.folder, relative)?).map_err(|e| e.to_string())
    }
}
