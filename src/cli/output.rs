//! The folder that the files go to: all of them, or none.

use std::path::{Path, PathBuf};
use subpixel_shadows::{Error, Result};

/// Files under way to a folder. They are written into a folder of their own inside it and moved when all are complete;
/// without [`OutFolder::finish`] nothing is left behind, folders that were made for it included.
#[derive(Debug)]
pub struct OutFolder {
    folder: PathBuf,
    part: PathBuf,
    /// The folders that did not exist before, outermost first.
    made: Vec<PathBuf>,
    names: Vec<&'static str>,
    finished: bool,
}

impl OutFolder {
    /// Refuses what can never become a folder, before any work is done.
    pub fn check(folder: &Path) -> Result<()> {
        match folder.ancestors().find(|p| p.exists()) {
            Some(there) if !there.is_dir() => Err(Error::file(there, "is not a folder, no files can be written there")),
            _ if folder.as_os_str().is_empty() => Err(Error::file(folder, "--out '' names no folder")),
            _ => Ok(()),
        }
    }

    /// Makes `folder` where it is missing.
    pub fn open(folder: &Path) -> Result<Self> {
        Self::check(folder)?;
        let mut made: Vec<PathBuf> =
            folder.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).map(Path::to_owned).collect();
        made.reverse();
        let part = folder.join(format!(".subpixel-shadows-{}.part", std::process::id()));
        let out = Self { folder: folder.to_owned(), part, made, names: Vec::new(), finished: false };
        std::fs::create_dir_all(&out.part).map_err(|e| Error::file(folder, format!("cannot be made: {e}")))?;
        Ok(out)
    }

    /// Where to write the file `name`.
    pub fn file(&mut self, name: &'static str) -> PathBuf {
        self.names.push(name);
        self.part.join(name)
    }

    /// Moves all files to their places; returns these.
    pub fn finish(mut self) -> Result<Vec<PathBuf>> {
        let taken = self.names.iter().map(|n| self.folder.join(n)).find(|p| p.is_dir());
        if let Some(path) = taken {
            return Err(Error::file(path, "is a folder, no file can be written there"));
        }
        let mut done = Vec::new();
        for name in &self.names {
            let to = self.folder.join(name);
            std::fs::rename(self.part.join(name), &to)
                .map_err(|e| Error::file(&to, format!("cannot be written: {e}")))?;
            done.push(to);
        }
        self.finished = true;
        Ok(done)
    }
}

impl Drop for OutFolder {
    fn drop(&mut self) {
        // Nothing more can be done about what cannot be removed; the fault that led here is reported.
        let _ = std::fs::remove_dir_all(&self.part);
        if !self.finished {
            for folder in self.made.iter().rev() {
                let _ = std::fs::remove_dir(folder);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn base(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-out-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        path
    }

    #[test]
    fn finished_files_appear_and_unfinished_ones_do_not() {
        let base = base("both");
        let target = base.join("a").join("b");
        let mut out = OutFolder::open(&target).expect("opens");
        std::fs::write(out.file("x.txt"), "x").expect("writes");
        drop(out);
        assert!(!base.join("a").exists(), "folders that were made are gone again");
        let mut out = OutFolder::open(&target).expect("opens");
        std::fs::write(out.file("x.txt"), "x").expect("writes");
        assert_eq!(out.finish().expect("finishes"), [target.join("x.txt")]);
        assert_eq!(std::fs::read_dir(&target).expect("there").count(), 1);
        std::fs::remove_dir_all(base).expect("removed");
    }

    #[test]
    fn a_file_in_the_way_is_named() {
        let base = base("file");
        std::fs::write(base.join("taken"), "").expect("writes");
        for target in [base.join("taken"), base.join("taken").join("below")] {
            assert!(OutFolder::check(&target).expect_err("refused").to_string().contains("taken"));
        }
        std::fs::create_dir_all(base.join("out").join("x.txt")).expect("made");
        let mut out = OutFolder::open(&base.join("out")).expect("opens");
        std::fs::write(out.file("x.txt"), "x").expect("writes");
        assert!(out.finish().is_err());
        assert_eq!(std::fs::read_dir(base.join("out")).expect("there").count(), 1);
        std::fs::remove_dir_all(base).expect("removed");
    }
}
