//! Rows on disk, one JSON object a line, so that a run can go on where it stopped.

use super::row::{Machine, Row};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use subpixel_shadows::{Error, Result};

/// The journal: its first line is the machine, each other line a row.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    rows: BTreeMap<String, Row>,
}

impl Journal {
    /// Opens the journal of this machine, or begins one. A last line that was cut off is dropped: its run was ended
    /// while it wrote. A line before it that is no row is damage, which no run does, and is refused rather than
    /// measured again unasked. What rows of earlier versions say of no pixels, or of one sample, is not taken
    /// ([`SceneErrors::honest`](crate::report::SceneErrors::honest)).
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read or written, is of another machine or version, or a line is no row; with
    /// the line's number.
    pub fn open(path: &Path, machine: &Machine) -> Result<Self> {
        let fault = |e: std::io::Error| Error::file(path, e.to_string());
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(fault)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(fault)?;
        let whole = bytes.iter().rposition(|&b| b == b'\n').map_or(0, |end| end + 1);
        let mut journal = Self { path: path.to_owned(), file, rows: BTreeMap::new() };
        journal.read(&bytes[..whole], machine)?;
        journal.file.set_len(whole as u64).map_err(fault)?;
        if whole == 0 {
            journal.write(machine)?;
        }
        Ok(journal)
    }

    /// The machine and the rows of a journal, as they were added. It is not changed; a last line that was cut off is not read.
    ///
    /// # Errors
    /// As [`Journal::open`].
    pub fn read_rows(path: &Path) -> Result<(Machine, Vec<Row>)> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::file(path, e.to_string()))?;
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines().enumerate();
        let fault = |n: usize, what: &str, e: serde_json::Error| {
            Error::file(path, format!("line {} is no {what} ({e})", n + 1))
        };
        let Some((_, first)) = lines.next() else { return Err(Error::file(path, "holds no machine")) };
        let machine = serde_json::from_str(first).map_err(|e| fault(0, "machine", e))?;
        let rows = lines.map(|(n, line)| serde_json::from_str(line).map_err(|e| fault(n, "row", e)));
        Ok((machine, rows.collect::<Result<_>>()?))
    }

    fn read(&mut self, bytes: &[u8], machine: &Machine) -> Result<()> {
        for (n, line) in bytes.split_inclusive(|&b| b == b'\n').enumerate() {
            let what = if n == 0 { "machine" } else { "row" };
            let fault = |e: serde_json::Error| {
                let why = format!("line {} is no {what} ({e}); without it, or with --fresh, the report goes on", n + 1);
                Error::file(&self.path, if n == 0 { why.replace("without it, or ", "") } else { why })
            };
            if n == 0 {
                let found: Machine = serde_json::from_slice(line).map_err(fault)?;
                if found != *machine {
                    let (was, is) = (found.line(), machine.line());
                    let why = format!("rows of another machine ({was}, now {is}); --fresh begins anew");
                    return Err(Error::file(&self.path, why));
                }
            } else {
                let mut row: Row = serde_json::from_slice(line).map_err(fault)?;
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
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|e| fault(format!("cannot be written: {e}")))
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
        std::fs::remove_file(path).unwrap();
    }

    /// Cut anywhere, it has the rows of its whole lines, and after those that are missing it is the same again.
    #[test]
    fn half_a_line_at_the_end_is_dropped_wherever_it_was_cut() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-journal-cut-{}.jsonl", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let machine = Machine { adapter: "Grafikkarte für alle".to_owned(), ..Machine::default() };
        let row = |n| Row { scene: "größe".to_owned(), samples: n, ..Row::default() };
        let mut journal = Journal::open(&path, &machine).unwrap();
        [1, 8, 16].into_iter().for_each(|n| journal.add(row(n)).unwrap());
        drop(journal);
        let whole = std::fs::read(&path).unwrap();
        // Everywhere about the ends of lines and within a letter, and here and there between.
        let near =
            |k: usize| whole[k.saturating_sub(2)..(k + 2).min(whole.len())].iter().any(|&b| b == b'\n' || b >= 128);
        for length in (0..=whole.len()).filter(|&k| k % 41 == 0 || near(k)) {
            std::fs::write(&path, &whole[..length]).unwrap();
            let mut journal = Journal::open(&path, &machine).unwrap();
            let lines = whole[..length].iter().filter(|&&b| b == b'\n').count();
            let had = [1, 8, 16].map(|n| journal.has(&row(n).key()));
            assert_eq!(had.iter().filter(|&&h| h).count(), lines.saturating_sub(1), "cut at {length}");
            for (n, _) in [1, 8, 16].into_iter().zip(had).filter(|(_, had)| !had) {
                journal.add(row(n)).unwrap();
            }
            drop(journal);
            assert_eq!(std::fs::read(&path).unwrap(), whole, "cut at {length}");
        }
        std::fs::remove_file(path).unwrap();
    }

    /// Damage before the end is refused with its line, and the file is left as it is.
    #[test]
    fn half_a_line_in_the_middle_is_refused() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-journal-mid-{}.jsonl", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let machine = Machine::default();
        let mut journal = Journal::open(&path, &machine).unwrap();
        [1, 8].into_iter().for_each(|n| journal.add(Row { samples: n, ..Row::default() }).unwrap());
        drop(journal);
        let whole = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = whole.lines().collect();
        let half = |n: usize| {
            let mut cut: Vec<&str> = lines.clone();
            cut[n] = &cut[n][..cut[n].len() / 2];
            cut.join("\n") + "\n{\"half"
        };
        for (n, part) in [(0, "line 1 is no machine ("), (1, "line 2 is no row (")] {
            let text = half(n);
            std::fs::write(&path, &text).unwrap();
            let error = Journal::open(&path, &machine).unwrap_err().to_string();
            assert!(error.contains(part) && error.contains("--fresh") && error.contains("journal-mid"), "{error}");
            assert_eq!(error.contains("without it"), n > 0, "{error}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        std::fs::write(&path, [whole.as_bytes(), b"\xff\xfe\n"].concat()).unwrap();
        assert!(Journal::open(&path, &machine).unwrap_err().to_string().contains("line 4 is no row"));
        std::fs::remove_file(path).unwrap();
    }
}
