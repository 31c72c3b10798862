//! The page of the figures.

use crate::families::Report;
use crate::limits::EXCEPTIONS;
use std::fmt::Write as _;
use std::time::{SystemTime, UNIX_EPOCH};

/// Today, as other pages say it.
fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let mut day = seconds / 86_400;
    let leap = |y: u64| y.is_multiple_of(4) && (!y.is_multiple_of(100) || y.is_multiple_of(400));
    let mut year = 1970;
    while day >= 365 + u64::from(leap(year)) {
        day -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while day >= lengths[month] {
        day -= lengths[month];
        month += 1;
    }
    format!("{year}-{:02}-{:02}", month + 1, day + 1)
}

/// The table of a family.
pub fn table(report: &Report) -> String {
    let mut out = format!(
        "{:<38} {:>5} {:>5} {:>6} {:>6} {:>7} {:>6} {:>6} {:>5} {:>5}  constants\n",
        report.device.trim_start_matches("Null hardware (").trim_end_matches(')'),
        "VGPR",
        "SGPR",
        "spillV",
        "spillS",
        "scratch",
        "LDS",
        "code",
        "waves",
        "alike"
    );
    for row in &report.rows {
        let f = &row.figures;
        let line = format!(
            "{:<38} {:>5} {:>5} {:>6} {:>6} {:>7} {:>6} {:>6} {:>5} {:>5}  {}",
            row.pipeline.name(),
            f.vector_registers,
            f.scalar_registers,
            f.spilled_vector,
            f.spilled_scalar,
            f.scratch,
            f.workgroup_memory,
            f.code,
            f.waves,
            row.alike,
            row.pipeline.constants()
        );
        let _ = writeln!(out, "{}", line.trim_end());
    }
    out
}

/// The whole page.
pub fn page(reports: &[Report]) -> String {
    let driver = reports.first().map_or("", |r| r.driver.as_str());
    let mut out = format!(
        "# Kernels as a GPU's compiler makes them\n\n\
         `cargo bench --bench occupancy -- --page data/reports/occupancy.md`\n\n\
         {driver}, on null hardware, {}. This compiler runs kernels on AMD's GPUs; no GPU was there. SPIR-V is made as wgpu makes it. A row is\n\
         a pipeline of the library; of an entry point that no method takes, that of its defaults. *alike* says how many pipelines have the SPIR-V\n\
         of the row. VGPR and SGPR are vector registers of an invocation and scalar registers of a wave. Scratch is bytes of memory a wave, LDS\n\
         bytes of workgroup memory, code bytes. Waves are how many of 32 invocations (vega10: of 64) a SIMD can hold at once: at most 32\n\
         (vega10: 10).\n\n\
         Limits, held by `benches/occupancy/tests/limits.rs`: no scratch, no spilled register, code under 16 KiB, 8 waves (vega10: 2, with the same\n\
         registers), twice as many where most of the time goes. Entry points that take more, and their worst pipelines:\n\n\
         | entry point | figure | navi21 | vega10 | why |\n|---|---|---|---|---|\n",
        today()
    );
    for e in EXCEPTIONS {
        let [navi, vega] = e.worst;
        let _ = writeln!(out, "| `{}` | {} | {navi} | {vega} | {} |", e.entry, e.figure.name(), e.why);
    }
    for report in reports {
        let _ = write!(out, "\n```text\n{}```\n", table(report));
    }
    out
}
