//! The folder that the files go to: all files, or none.

use super::held::FolderLock;
use std::path::{Path, PathBuf};
use std::time::Duration;
use subpixel_shadows::{Error, Result};

/// How long a run that has its files ready waits for another one that is writing into the same folder.
const PATIENCE: Duration = Duration::from_secs(60);

/// Files under way to a folder. They are written into a folder of their own inside it and moved when all are complete;
/// without [`OutFolder::fill`] coming to its end nothing is left behind, folders that were made for it included. Of
/// two runs that write into one folder, the second waits for the first.
#[derive(Debug)]
pub struct OutFolder {
    part: PathBuf,
    names: Vec<String>,
    finished: bool,
    held: FolderLock,
}

impl OutFolder {
    /// Refuses what can never become a folder, and one that another run holds, before any work is done.
    pub fn check(folder: &Path) -> Result<()> {
        FolderLock::check(folder)
    }

    /// Makes `folder` where it is missing, lets `write` write the files, and moves them to their places; returns these.
    pub fn fill(folder: &Path, write: impl FnOnce(&mut Self) -> Result<()>) -> Result<Vec<PathBuf>> {
        let mut out = Self::open(folder)?;
        write(&mut out).map_err(|e| out.renamed(e))?;
        out.finish()
    }

    /// Makes `folder` where it is missing, and holds it.
    pub fn open(folder: &Path) -> Result<Self> {
        FolderLock::check_kind(folder)?;
        let held = FolderLock::open(folder, PATIENCE)?;
        let mut out = Self { part: PathBuf::new(), names: Vec::new(), finished: false, held };
        out.part = out.begin().map_err(|e| Error::file(folder, format!("cannot be written into: {e}")))?;
        Ok(out)
    }

    /// Makes the folder of the unfinished files. Another one of this name is that of a process elsewhere, on a file
    /// system without locks.
    fn begin(&self) -> std::io::Result<PathBuf> {
        for k in 0u32.. {
            let part = self.held.folder().join(format!(".subpixel-shadows-{}-{k}.part", std::process::id()));
            match std::fs::create_dir(&part) {
                Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
                made => return made.map(|()| part),
            }
        }
        Err(std::io::ErrorKind::AlreadyExists.into())
    }

    /// Where to write the file `name`.
    pub fn file(&mut self, name: &str) -> PathBuf {
        self.names.push(name.to_owned());
        self.part.join(name)
    }

    /// An error with the name that the file was to have.
    fn renamed(&self, error: Error) -> Error {
        match error {
            Error::File { path, message } => match path.strip_prefix(&self.part) {
                Ok(name) => Error::file(self.held.folder().join(name), message),
                Err(_) => Error::file(path, message),
            },
            other => other,
        }
    }

    /// Moves all files to their places; returns these.
    pub fn finish(mut self) -> Result<Vec<PathBuf>> {
        let place = |name: &String| self.held.folder().join(name);
        if let Some(path) = self.names.iter().map(place).find(|p| p.is_dir()) {
            return Err(Error::file(path, "is a folder, no file can be written there"));
        }
        let mut done = Vec::new();
        for name in &self.names {
            let to = place(name);
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
        if !self.part.as_os_str().is_empty() {
            let _ = std::fs::remove_dir_all(&self.part);
        }
        if !self.finished {
            self.held.unmake();
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

    fn written(out: &mut OutFolder) -> Result<()> {
        std::fs::write(out.file("x.txt"), "x").map_err(|e| Error::file("x.txt", e.to_string()))
    }

    #[test]
    fn finished_files_appear_and_unfinished_ones_do_not() {
        let base = base("both");
        let target = base.join("a").join("b");
        let failed = OutFolder::fill(&target, |out| {
            written(out)?;
            Err(Error::file(out.file("y.txt"), "cannot be written"))
        });
        let line = failed.expect_err("refused").to_string();
        assert_eq!(line, format!("{}: cannot be written", target.join("y.txt").display()), "the name it was to have");
        assert!(!base.join("a").exists(), "folders that were made are gone again");
        assert_eq!(OutFolder::fill(&target, written).expect("finishes"), [target.join("x.txt")]);
        assert_eq!(std::fs::read_dir(&target).expect("there").count(), 1);
        std::fs::remove_dir_all(base).expect("removed");
    }

    #[test]
    fn a_file_in_the_way_is_named() {
        let base = base("file");
        std::fs::write(base.join("taken"), "").expect("writes");
        for target in [base.join("taken"), base.join("taken").join("below")] {
            assert!(OutFolder::check(&target).expect_err("refused").to_string().contains("taken"));
            assert!(OutFolder::fill(&target, written).expect_err("refused").to_string().contains("taken"));
        }
        std::fs::create_dir_all(base.join("out").join("x.txt")).expect("made");
        assert!(OutFolder::fill(&base.join("out"), written).is_err());
        assert_eq!(std::fs::read_dir(base.join("out")).expect("there").count(), 1);
        std::fs::remove_dir_all(base).expect("removed");
    }

    /// Two that write at once: each time all files are of one of them.
    #[test]
    fn files_of_two_writers_do_not_mix() {
        let base = base("two");
        let fill = |mark: &str| {
            OutFolder::fill(&base, |out| {
                for name in ["a", "b", "c", "d"] {
                    std::fs::write(out.file(name), mark).map_err(|e| Error::file(name, e.to_string()))?;
                }
                Ok(())
            })
        };
        std::thread::scope(|scope| {
            let one = scope.spawn(|| (0..200).for_each(|k| drop(fill(&format!("one {k}")).expect("written"))));
            for k in 0..200 {
                fill(&format!("two {k}")).expect("written");
                let held = FolderLock::open(&base, PATIENCE).expect("held");
                let texts = ["a", "b", "c", "d"].map(|n| std::fs::read_to_string(base.join(n)).expect("a file"));
                drop(held);
                assert!(texts.iter().all(|t| *t == texts[0]), "{texts:?}");
            }
            one.join().expect("no panic");
        });
        assert_eq!(std::fs::read_dir(&base).expect("there").count(), 4);
        std::fs::remove_dir_all(base).expect("removed");
    }
}
