//! `kernels`: the WGSL that devices are given.

use super::output::OutFolder;
use super::table::Report;
use lab::report::write_text;
use std::path::Path;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::kernels::ALL;

/// Writes each kernel, joined with what it imports, as `STEM.wgsl`; all or none.
pub fn run(out: &Path) -> Result<()> {
    OutFolder::check(out)?;
    let files = OutFolder::fill(out, |out| {
        ALL.iter().try_for_each(|(stem, source, _)| write_text(&out.file(&format!("{stem}.wgsl")), &source.text()))
    })?;
    let entries: usize = ALL.iter().map(|(_, _, entries)| entries.len()).sum();
    let mut report = Report::default();
    report.text(&format!("wrote {} kernels with {entries} entry points into {}", files.len(), out.display()));
    report.print()
}
