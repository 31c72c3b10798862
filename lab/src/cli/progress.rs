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
    // A standard error that cannot be written to leaves nowhere to say so.
    let _ = writeln!(std::io::stderr(), "subpixel-shadows: {}", line(text));
}

/// Characters of a word, such as a path, and of a line; the middle of what is longer is left out.
const LONGEST: [usize; 2] = [300, 1500];

/// `text` as one line of bearable length.
fn line(text: &str) -> String {
    let words: Vec<String> = text.split_whitespace().map(|word| shortened(word, LONGEST[0])).collect();
    shortened(&words.join(" "), LONGEST[1])
}

/// `text` without its middle, if it has more than `most` characters.
fn shortened(text: &str, most: usize) -> String {
    let count = text.chars().count();
    if count <= most {
        return text.to_owned();
    }
    let (head, tail) = (most / 2, most - most / 2 - 1);
    text.chars().take(head).chain(['…']).chain(text.chars().skip(count - tail)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_bearable() {
        assert_eq!(line("a  b\n c"), "a b c");
        let long = format!("no scene '{}'; built in are", "é".repeat(5000));
        let short = line(&long);
        assert!(short.starts_with("no scene 'éé") && short.ends_with("éé'; built in are") && short.contains('…'));
        assert_eq!(short.split(' ').map(|w| w.chars().count()).max(), Some(300));
        let many = line(&"word ".repeat(1000));
        assert!(many.chars().count() == 1500 && many.starts_with("word ") && many.ends_with("word"), "{many}");
        let path = format!("/{}", "x".repeat(299));
        assert_eq!(line(&path), path);
    }
}
