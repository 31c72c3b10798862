//! `explain`: the plan of a scene.

use super::args::Options;
use super::table::{Report, grouped};
use subpixel_shadows::Result;
use subpixel_shadows::methods::Prepared;
use subpixel_shadows::plan::Plan;

/// Prints what would run and what would be left out, and why. Runs nothing.
pub fn run(scene: Option<&str>, options: &Options) -> Result<()> {
    let settings = options.settings()?;
    let scene = options.open(scene)?;
    let prepared = Prepared::new(&scene.mesh);
    let plan = Plan::of_method(options.method, &prepared, &scene.camera, &scene.light, &settings, options.force_all)?;
    let mut report = Report::default();
    report.line("scene", &scene.name);
    report.line("mesh", &mesh_line(&prepared));
    let mut rows = vec![["step", "", "why"].map(String::from).to_vec()];
    for step in &plan.steps {
        let (what, why) = match &step.left_out {
            None => ("runs", step.purpose.to_owned()),
            Some(reason) => ("left out", reason.clone()),
        };
        rows.push(vec![step.name.to_owned(), what.to_owned(), why]);
    }
    report.table(&rows, &[]);
    report.text("\nStages also run on lists that may turn out empty; `render` prints what they ran on.");
    report.print();
    Ok(())
}

/// Triangles, vertices, edges, closed or open.
pub fn mesh_line(prepared: &Prepared) -> String {
    format!(
        "{} triangles, {} vertices, {} edges, {}",
        grouped(prepared.mesh.triangles.len() as u64),
        grouped(prepared.mesh.positions.len() as u64),
        grouped(prepared.edges.len() as u64),
        if prepared.closed { "closed" } else { "open" }
    )
}
