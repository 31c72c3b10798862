//! Progress of long work: a bar on a terminal, plain lines elsewhere, nothing with `--quiet`.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Plain lines come at most this often, and none for work that is done sooner.
const PATIENCE: Duration = Duration::from_secs(3);

/// Where progress is shown.
#[derive(Clone, Copy, Debug)]
pub struct Console {
    quiet: bool,
}

impl Console {
    pub fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// One line on standard error that is no fault.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            complain(text);
        }
    }

    /// A task whose steps are counted.
    pub fn task(&self, name: &'static str) -> Task {
        let how = if self.quiet {
            Shown::Not
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::new(1);
            if let Ok(style) = ProgressStyle::with_template("{msg:16} {wide_bar} {percent:>3} % {eta:>4}") {
                bar.set_style(style);
            }
            bar.set_message(name);
            Shown::Bar(bar)
        } else {
            Shown::Lines(Mutex::new(Instant::now()))
        };
        Task { name, how }
    }
}

/// Work under way.
pub struct Task {
    name: &'static str,
    how: Shown,
}

enum Shown {
    Not,
    Bar(ProgressBar),
    Lines(Mutex<Instant>),
}

impl Task {
    /// `done` of `total` steps are done. May be called from any thread.
    pub fn at(&self, done: usize, total: usize) {
        match &self.how {
            Shown::Not => {}
            Shown::Bar(bar) => {
                bar.set_length(total as u64);
                // Threads report out of order; a bar does not go back.
                bar.set_position(bar.position().max(done as u64));
            }
            Shown::Lines(last) => {
                if let Ok(mut last) = last.try_lock()
                    && last.elapsed() >= PATIENCE
                {
                    *last = Instant::now();
                    complain(&format!("{}: {} %", self.name, done * 100 / total.max(1)));
                }
            }
        }
    }
}

impl Drop for Task {
    fn drop(&mut self) {
        if let Shown::Bar(bar) = &self.how {
            bar.finish_and_clear();
        }
    }
}

/// One line on standard error.
pub fn complain(text: &str) {
    let line: Vec<&str> = text.split_whitespace().collect();
    // A standard error that cannot be written to leaves nowhere to say so.
    let _ = writeln!(std::io::stderr(), "subpixel-shadows: {}", line.join(" "));
}
