//! `methods`: what there is to choose from.

use super::table::Report;
use serde_json::{Value, json};
use subpixel_shadows::methods::{METHODS, MethodRow};
use subpixel_shadows::{Error, Result};

/// Lists the methods, as a table or as JSON.
pub fn run(as_json: bool) -> Result<()> {
    let mut report = Report::default();
    if as_json {
        let rows: Vec<Value> = METHODS.iter().map(object).collect();
        report.text(&serde_json::to_string_pretty(&rows).map_err(|e| Error::Config(e.to_string()))?);
        return report.print();
    }
    let mut rows = vec![["method", "options of its own", "paper", "section"].map(String::from).to_vec()];
    for row in &METHODS {
        let options: Vec<String> = row.options.iter().map(|name| format!("--{name}")).collect();
        rows.push(vec![row.name.to_owned(), options.join(" "), row.paper.to_owned(), row.section.to_owned()]);
    }
    report.table(&rows, &[]);
    report.text("");
    let mut rows =
        vec![["method", "the light's texels lie", "a texel keeps", "a pixel asks"].map(String::from).to_vec()];
    for row in &METHODS {
        rows.push([row.name, row.parts[0], row.parts[1], row.parts[2]].map(str::to_owned).to_vec());
    }
    report.table(&rows, &[]);
    report.print()
}

/// `options`: the arguments of `render` that make it; `takes`: the options that it takes and not every method does.
fn object(row: &MethodRow) -> Value {
    let takes = row.options;
    json!({
        "name": row.name,
        "paper": row.paper,
        "section": row.section,
        "options": ["--method", row.name],
        "takes": takes,
        "views": row.parts[0],
        "texel": row.parts[1],
        "query": row.parts[2],
    })
}
