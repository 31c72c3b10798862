//! `report everything`: all that is measured, by one command.

use super::args::{EverythingOptions, FigureOptions, ReportOptions, RowOptions, StabilityOptions};
use super::rows::RowPart;
use super::{figure, report, stability};
use clap::Parser;
use subpixel_shadows::{Error, Result};

/// Options as the command line has them where nothing else is said.
fn plain<T: clap::Args>() -> Result<T> {
    #[derive(Parser)]
    struct Plain<T: clap::Args> {
        #[command(flatten)]
        options: T,
    }
    let parsed = Plain::try_parse_from(["subpixel-shadows"]);
    parsed.map(|plain| plain.options).map_err(|e| Error::Config(lab::options::reason(&e)))
}

/// Measures the report, the figures and, as part of the first part, the stability cases.
pub fn run(options: &EverythingOptions) -> Result<()> {
    let EverythingOptions { quick, ref rows, ref out } = *options;
    let names = vec!["all".to_owned()];
    let mut figures = FigureOptions { names, out: out.join("figures"), rows: rows.clone(), ..plain()? };
    if quick {
        (figures.size, figures.repeats, figures.row_seconds) = ([160, 120], 2, 1);
    }
    figure::run(&figures)?;
    report::run(&ReportOptions { quick, out: out.join("comparison"), rows: rows.clone(), ..plain()? })?;
    let RowOptions { part, ref adapter, quiet } = *rows;
    if part.is_none_or(RowPart::is_first) {
        let adapter = adapter.clone();
        stability::run(&StabilityOptions { adapter, out: out.join("stability"), quiet, ..plain()? })?;
    }
    Ok(())
}
