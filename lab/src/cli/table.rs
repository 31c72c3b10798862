//! Plain tables on standard output.

use std::io::Write;
use subpixel_shadows::{Error, Result};

/// Lines of a report, written at once.
#[derive(Debug, Default)]
pub struct Report {
    text: String,
}

impl Report {
    /// A heading with its value.
    pub fn line(&mut self, name: &str, value: &str) {
        self.text += &format!("{name:<10} {value}\n");
    }

    /// Text as it is.
    pub fn text(&mut self, text: &str) {
        self.text += text;
        self.text.push('\n');
    }

    /// An empty line and a table, first column to the left, those in `right` to the right; rows may be of unequal length.
    pub fn table(&mut self, rows: &[Vec<String>], right: &[usize]) {
        let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |c: usize| rows.iter().filter_map(|r| r.get(c)).map(|t| t.chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        self.text.push('\n');
        for row in rows {
            let cells = row.iter().enumerate().map(|(c, cell)| {
                let w = widths[c];
                if right.contains(&c) { format!("{cell:>w$}") } else { format!("{cell:<w$}") }
            });
            let line = cells.collect::<Vec<_>>().join("  ");
            self.text += line.trim_end();
            self.text.push('\n');
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// [`Error::File`] if standard output cannot be written to; a closed pipe is no fault.
    pub fn print(&self) -> Result<()> {
        let mut out = std::io::stdout();
        told(out.write_all(self.text.as_bytes()).and_then(|()| out.flush()))
    }
}

/// The outcome of writing to standard output. Who closes it has seen enough.
pub fn told(written: std::io::Result<()>) -> Result<()> {
    match written {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Error::file("standard output", format!("cannot be written: {e}")))
        }
        _ => Ok(()),
    }
}

/// Digits in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// A share in percent, with enough digits to tell it from 0 and 100; of nothing a dash.
pub fn percent(part: u64, whole: u64) -> String {
    if whole == 0 { "–".to_owned() } else { format!("{:.2} %", 100.0 * part as f64 / whole as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped() {
        assert_eq!([0, 12, 999, 1000, 1_234_567].map(grouped), ["0", "12", "999", "1,000", "1,234,567"]);
        assert_eq!(percent(1, 8), "12.50 %");
        assert_eq!((percent(0, 0), percent(0, 8)), ("–".to_owned(), "0.00 %".to_owned()));
    }

    #[test]
    fn columns_line_up() {
        let mut report = Report::default();
        report.table(&[vec!["a".into(), "1.5".into(), "x".into()], vec!["long".into(), "10.25".into()]], &[1]);
        assert_eq!(report.text, "\na       1.5  x\nlong  10.25\n");
    }
}
