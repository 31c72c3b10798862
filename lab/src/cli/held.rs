//! A folder that one run at a time writes into.

use lab::report::part_of_dead;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use subpixel_shadows::{Error, Result};

/// Time between two tries of a lock.
const PAUSE: Duration = Duration::from_millis(20);

/// A folder that is locked against other runs of the program until this is dropped. The system lifts the lock when the process
/// ends, however it ends.
#[derive(Debug)]
pub struct FolderLock {
    folder: PathBuf,
    /// The folders that did not exist before, outermost first.
    made: Vec<PathBuf>,
    /// `None` on a file system that knows no locks.
    lock: Option<File>,
}

impl FolderLock {
    /// Refuses what can never become a folder, and one that another run holds, before any work is done.
    pub fn check(folder: &Path) -> Result<()> {
        Self::check_kind(folder)?;
        if folder.exists() { Self::lock(folder, Duration::from_secs(2)).map(drop) } else { Ok(()) }
    }

    /// Refuses what can never become a folder.
    pub fn check_kind(folder: &Path) -> Result<()> {
        match folder.ancestors().find(|p| p.exists()) {
            Some(there) if !there.is_dir() => Err(Error::file(there, "is not a folder, no files can be written there")),
            _ if folder.as_os_str().is_empty() => Err(Error::file(folder, "--out '' names no folder")),
            _ => Ok(()),
        }
    }

    /// Makes `folder` where it is missing, locks it, and removes what runs left in it that ended before they were done.
    /// A folder that another run holds is waited for as long as `patience`.
    pub fn open(folder: &Path, patience: Duration) -> Result<Self> {
        let start = Instant::now();
        loop {
            let missing = folder.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists());
            let mut made: Vec<PathBuf> = missing.map(Path::to_owned).collect();
            made.reverse();
            std::fs::create_dir_all(folder).map_err(|e| Error::file(folder, format!("cannot be made: {e}")))?;
            let lock = Self::lock(folder, patience.saturating_sub(start.elapsed()))?;
            // The run that held it may have taken it away again, since it was its own and nothing came to be in it.
            if lock.as_ref().map_or_else(|| folder.is_dir(), |lock| is_still(lock, folder)) {
                let held = Self { folder: folder.to_owned(), made, lock };
                held.clear();
                return Ok(held);
            }
            if start.elapsed() >= patience {
                return Err(Error::file(folder, "goes away again and again; another run may be removing it"));
            }
        }
    }

    /// The lock of a folder that is there; `None` where there are no locks.
    fn lock(folder: &Path, patience: Duration) -> Result<Option<File>> {
        let start = Instant::now();
        loop {
            // A folder that is gone, or that only may be written into, is for the caller to meet.
            let Ok(file) = lock_file(folder) else { return Ok(None) };
            match file.try_lock() {
                Ok(()) => return Ok(Some(file)),
                Err(TryLockError::Error(_)) => return Ok(None),
                Err(TryLockError::WouldBlock) if start.elapsed() >= patience => {
                    let why = "another run is writing there; wait for it, or name another folder with --out";
                    return Err(Error::file(folder, why));
                }
                Err(TryLockError::WouldBlock) => std::thread::sleep(PAUSE),
            }
        }
    }

    /// Removes unfinished files and folders. Whoever began them is dead: the living hold the lock.
    fn clear(&self) {
        let Some(entries) = self.lock.as_ref().and_then(|_| std::fs::read_dir(&self.folder).ok()) else { return };
        for entry in entries.flatten().filter(|e| e.file_name().to_str().is_some_and(part_of_dead)) {
            let (path, is_folder) = (entry.path(), entry.file_type().is_ok_and(|t| t.is_dir()));
            // What cannot be removed is in nobody's way.
            let _ = if is_folder { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
        }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Removes the folders that were made for it, as far as nothing is in them.
    pub fn unmake(&self) {
        for folder in self.made.iter().rev() {
            let _ = std::fs::remove_dir(folder);
        }
    }
}

/// The folder itself carries the lock, so none is left behind.
#[cfg(unix)]
fn lock_file(folder: &Path) -> std::io::Result<File> {
    File::open(folder)
}

/// Elsewhere folders cannot be locked: a file in it carries the lock, and stays.
#[cfg(not(unix))]
fn lock_file(folder: &Path) -> std::io::Result<File> {
    File::options().write(true).create(true).truncate(false).open(folder.join(".subpixel-shadows.lock"))
}

/// Whether `folder` is still the one that `lock` was opened on.
#[cfg(unix)]
fn is_still(lock: &File, folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |m: std::io::Result<std::fs::Metadata>| m.ok().map(|m| (m.dev(), m.ino()));
    place(lock.metadata()).is_some_and(|of_lock| place(std::fs::metadata(folder)) == Some(of_lock))
}

#[cfg(not(unix))]
fn is_still(_: &File, folder: &Path) -> bool {
    folder.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOON: Duration = Duration::from_millis(100);

    fn base(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-held-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        path
    }

    #[test]
    fn one_at_a_time() {
        let base = base("one");
        let first = FolderLock::open(&base, SOON).expect("opens");
        let refused = FolderLock::open(&base, SOON).expect_err("is held").to_string();
        assert!(refused.contains(base.to_str().expect("UTF-8")) && refused.contains("another run"), "{refused}");
        assert!(FolderLock::check(&base).is_err());
        drop(first);
        FolderLock::check(&base).expect("is free");
        drop(FolderLock::open(&base, SOON).expect("is free"));
        std::fs::remove_dir_all(base).expect("removed");
    }

    #[test]
    fn a_folder_that_goes_away_while_waiting_is_made_again() {
        let base = base("gone");
        let folder = base.join("a");
        let first = FolderLock::open(&folder, SOON).expect("opens");
        let waiting = std::thread::spawn({
            let folder = folder.clone();
            move || FolderLock::open(&folder, Duration::from_secs(20)).expect("opens")
        });
        std::thread::sleep(10 * PAUSE);
        first.unmake();
        drop(first);
        let second = waiting.join().expect("no panic");
        assert!(folder.exists());
        second.unmake();
        drop(second);
        assert!(!folder.exists());
        std::fs::remove_dir_all(base).expect("removed");
    }

    #[test]
    fn what_the_dead_left_is_cleared_and_nothing_else() {
        let base = base("dead");
        let keep = [".subpixel-shadows-x.part", "a.part", ".frame.json.7-0.part", "frame.json", ".hidden"];
        keep.into_iter().for_each(|name| std::fs::write(base.join(name), "x").expect("writes"));
        let own = format!(".subpixel-shadows-{}.part", std::process::id());
        for folder in [".subpixel-shadows-7.part", ".subpixel-shadows-8-2.part", own.as_str()] {
            std::fs::create_dir(base.join(folder)).expect("made");
            std::fs::write(base.join(folder).join("shaded.png"), "half").expect("writes");
        }
        std::fs::write(base.join(".report.md.subpixel-shadows-9-3.part"), "half").expect("writes");
        drop(FolderLock::open(&base, SOON).expect("opens"));
        let mut left: Vec<String> = std::fs::read_dir(&base)
            .expect("there")
            .map(|e| e.expect("an entry").file_name().into_string().expect("UTF-8"))
            .collect();
        left.sort();
        let mut keep = keep.map(str::to_owned);
        keep.sort();
        assert_eq!(left, keep);
        std::fs::remove_dir_all(base).expect("removed");
    }
}
