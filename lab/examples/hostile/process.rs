//! Runs of the built program, with a limit of time.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use subpixel_shadows::{Error, Result};

/// The longest that a case may take, unless another limit is asked for.
pub const LIMIT: Duration = Duration::from_secs(60);

/// The built program, and a folder for what it writes.
pub struct Program {
    path: PathBuf,
    folder: PathBuf,
    limit: Duration,
}

/// How a run ended.
pub struct Ended {
    /// `None` if it was ended by a signal, or by the limit of time.
    pub status: Option<i32>,
    pub seconds: f64,
    /// The first line of the program itself; drivers may say more.
    pub line: String,
    /// Why it is not as it must be.
    pub fault: Option<String>,
}

impl Program {
    /// The program beside the folder of the examples; its runs may take `limit`.
    pub fn find(limit: Duration) -> Result<Self> {
        let own = std::env::current_exe().map_err(|e| Error::file("hostile", e.to_string()))?;
        let name = format!("subpixel-shadows{}", std::env::consts::EXE_SUFFIX);
        let path = own.ancestors().skip(2).map(|p| p.join(&name)).find(|p| p.is_file());
        let path = path.ok_or_else(|| Error::file(&own, "is not beside the program: cargo build --release"))?;
        let folder = std::env::temp_dir().join(format!("subpixel-shadows-hostile-runs-{}", std::process::id()));
        std::fs::create_dir_all(&folder).map_err(|e| Error::file(&folder, e.to_string()))?;
        Ok(Self { path, folder, limit })
    }

    /// The adapter that a plain run takes; `None` without one.
    pub fn adapter(&self) -> Option<String> {
        let done = Command::new(&self.path).arg("adapters").output().ok()?;
        let checked = Command::new(&self.path).args(["adapters", "--check"]).output().ok()?.status.success();
        let text = String::from_utf8_lossy(&done.stdout).into_owned();
        text.lines().next().filter(|_| checked).map(|l| l.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    /// Runs it into a folder that is not there before, and holds the outcome against `allowed` and the rules for all
    /// runs.
    pub fn run(&self, arguments: &[String], allowed: &[i32]) -> Result<Ended> {
        let (out, log) = (self.folder.join("out"), self.folder.join("stderr"));
        let _ = std::fs::remove_dir_all(&out);
        let errors = File::create(&log).map_err(|e| Error::file(&log, e.to_string()))?;
        let start = Instant::now();
        let mut child = Command::new(&self.path)
            .args(arguments)
            .arg("--out")
            .arg(&out)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(errors)
            .spawn()
            .map_err(|e| Error::file(&self.path, e.to_string()))?;
        let mut late = false;
        let status = loop {
            match child.try_wait().map_err(|e| Error::file(&self.path, e.to_string()))? {
                Some(status) => break status,
                None if start.elapsed() > self.limit => {
                    late = true;
                    let _ = child.kill();
                    let _ = child.wait();
                    break std::process::ExitStatus::default();
                }
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let text = std::fs::read(&log).map(|b| String::from_utf8_lossy(&b).into_owned()).unwrap_or_default();
        let status = status.code().filter(|_| !late);
        let own: Vec<&str> = text.lines().filter_map(|l| l.strip_prefix("subpixel-shadows: ")).collect();
        let usage = text.lines().find_map(|l| l.strip_prefix("error: ").filter(|l| !l.contains("XDG_RUNTIME_DIR")));
        let line = own.first().copied().or(usage).unwrap_or_default().to_owned();
        let fault = if late {
            Some(format!("takes longer than {} s", self.limit.as_secs()))
        } else if text.contains("panicked at") {
            Some("panics".to_owned())
        } else {
            match status {
                None => Some("is ended by a signal".to_owned()),
                Some(code) if !allowed.contains(&code) => Some(format!("has status {code}, not {allowed:?}")),
                Some(0) => incomplete(&out),
                Some(code) if out.exists() => Some(format!("has status {code} and left {}", listed(&out))),
                Some(2) => usage.is_none().then(|| "says nothing about its usage".to_owned()),
                Some(_) if own.len() != 1 => Some(format!("says {} lines", own.len())),
                Some(_) if own[0].chars().count() > 700 => Some("says a line of more than 700 letters".to_owned()),
                Some(_) => None,
            }
        };
        Ok(Ended { status, seconds, line, fault })
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn listed(folder: &Path) -> String {
    names(folder).join(", ")
}

/// The faults of the files of a finished run.
fn incomplete(out: &Path) -> Option<String> {
    let expected = ["frame.json", "shaded.png", "visibility.exr", "visibility.png"];
    (names(out) != expected).then(|| format!("is done and left {}", listed(out)))
}
