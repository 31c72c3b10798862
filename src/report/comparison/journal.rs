//! Rows on disk, one JSON object a line, so that a run can go on where it stopped.

use super::row::{Machine, Row};
use crate::{Error, Result};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// The journal: its first line is the machine, each other line a row.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    rows: BTreeMap<String, Row>,
}

impl Journal {
    /// Opens the journal of this machine, or begins one. A last line that was cut off is dropped. What rows of earlier versions say of
    /// no pixels, or of one sample, is not taken ([`SceneErrors::honest`](crate::report::SceneErrors::honest)).
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read or written, is of another machine or version, or a line is no row.
    pub fn open(path: &Path, machine: &Machine) -> Result<Self> {
        let fault = |e: std::io::Error| Error::file(path, e.to_string());
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(fault)?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(fault)?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        file.set_len(whole as u64).map_err(fault)?;
        let mut journal = Self { path: path.to_owned(), file, rows: BTreeMap::new() };
        journal.read(&text[..whole], machine)?;
        if whole == 0 {
            journal.write(machine)?;
        }
        Ok(journal)
    }

    fn read(&mut self, text: &str, machine: &Machine) -> Result<()> {
        for (n, line) in text.lines().enumerate() {
            let fault = |e: serde_json::Error| Error::file(&self.path, format!("line {}: {e}", n + 1));
            if n == 0 {
                let found: Machine = serde_json::from_str(line).map_err(fault)?;
                if found != *machine {
                    let (was, is) = (found.line(), machine.line());
                    let why = format!("rows of another machine ({was}, now {is}); --fresh begins anew");
                    return Err(Error::file(&self.path, why));
                }
            } else {
                let mut row: Row = serde_json::from_str(line).map_err(fault)?;
                (row.matched, row.converged) = (row.matched.honest(row.samples), row.converged.honest(row.samples));
                self.rows.insert(row.key(), row);
            }
        }
        Ok(())
    }

    fn write(&mut self, value: &impl serde::Serialize) -> Result<()> {
        use std::io::Seek;
        let fault = |e: String| Error::file(&self.path, e);
        let mut line = serde_json::to_string(value).map_err(|e| fault(e.to_string()))?;
        line.push('\n');
        self.file.seek(std::io::SeekFrom::End(0)).map_err(|e| fault(e.to_string()))?;
        self.file.write_all(line.as_bytes()).map_err(|e| fault(e.to_string()))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be written.
    pub fn add(&mut self, row: Row) -> Result<()> {
        self.write(&row)?;
        self.rows.insert(row.key(), row);
        Ok(())
    }

    /// Whether the row of this key is there.
    pub fn has(&self, key: &str) -> bool {
        self.rows.contains_key(key)
    }

    /// The row of a key.
    pub fn get(&self, key: &str) -> Option<&Row> {
        self.rows.get(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goes_on_where_it_stopped_and_drops_what_was_cut_off() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-journal-{}.jsonl", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let machine = Machine { adapter: "a".to_owned(), ..Machine::default() };
        let row = |n| Row { scene: "plane".to_owned(), samples: n, ..Row::default() };
        let mut journal = Journal::open(&path, &machine).unwrap();
        journal.add(row(1)).unwrap();
        journal.add(row(8)).unwrap();
        drop(journal);
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();
        let mut journal = Journal::open(&path, &machine).unwrap();
        assert!(journal.has(&row(1).key()) && !journal.has(&row(8).key()));
        journal.add(row(8)).unwrap();
        drop(journal);
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        // A row of an earlier version, with a perfect score of an empty band.
        let mut old = serde_json::to_value(row(32)).unwrap();
        for key in ["scene_band_rmse", "scene_band_pixel_match", "scene_one_plane_match"] {
            (old["matched"][key], old["converged"][key]) = (1.0.into(), 1.0.into());
        }
        std::fs::write(&path, [&whole[..], old.to_string().as_bytes(), b"\n"].concat()).unwrap();
        assert_eq!(Journal::open(&path, &machine).unwrap().get(&row(32).key()), Some(&row(32)));
        let other = Machine { adapter: "b".to_owned(), ..Machine::default() };
        assert!(Journal::open(&path, &other).is_err());
        std::fs::write(&path, b"{}\nnonsense\n").unwrap();
        assert!(Journal::open(&path, &machine).is_err());
        std::fs::remove_file(path).unwrap();
    }
}
