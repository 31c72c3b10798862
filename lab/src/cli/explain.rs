//! `explain`: the plan of a scene, and which way its pixels take.

use super::engine::Engine;
use super::progress::Console;
use super::table::{Report, grouped, percent};
use super::{opened, planned};
use lab::options::RenderOptions;
use subpixel_shadows::Result;
use subpixel_shadows::methods::{FacetMode, MethodName, Prepared};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::Counts;

/// Prints what would run and what would be left out, and why. Of `facet-masks` it renders a frame, writes none of it, and
/// prints how many pixels took which way.
pub fn run(scene: Option<&str>, options: &RenderOptions) -> Result<()> {
    let console = Console::new(options.quiet);
    let scene = opened(options, scene, console)?;
    let prepared = scene.prepared()?;
    let (points, plan) = planned(options, &scene, &prepared)?;
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
    report.print()?;
    if options.method == MethodName::FacetMasks {
        let engine = Engine::open(options, console)?;
        let counts = engine.render(options, 0, &plan, (&scene, &points), &prepared, console)?.output.counts;
        let mut report = Report::default();
        ways(&mut report, &counts, &plan);
        report.print()?;
    }
    Ok(())
}

/// How many pixels and facets took which way.
fn ways(report: &mut Report, c: &Counts, plan: &Plan) {
    let pixels = plan.settings.pixels() as u64;
    let facets = c.facets.saturating_sub(c.empty_facets);
    let mut rows = Vec::new();
    let mut row = |way: &str, n: u64, whole: u64, what: &str| {
        rows.push(vec![way.to_owned(), grouped(n), percent(n, whole), what.to_owned()]);
    };
    let shown = pixels.saturating_sub(c.empty_facets);
    row("pixels that see nothing", c.empty_facets, pixels, "no facet");
    if plan.settings.facets == FacetMode::All {
        let proved = shown.saturating_sub(c.complex_pixels);
        row("pixels proved to show one surface", proved, pixels, "one facet, no sample looked at");
        row(
            "pixels that may show several",
            c.complex_pixels,
            pixels,
            "each sample looked at, a facet for each surface",
        );
    } else {
        row("pixels with one facet", shown, pixels, "for all they show: that of the centre");
    }
    row("facets turned from the light", c.dark_facets, facets, "dark");
    row("facets proved lit", c.lit_facets, facets, "no pairs");
    row("facets proved in shadow", c.shadowed_facets, facets, "no pairs");
    row("facets left undecided", c.silhouette_pixels, facets, "pairs, evaluated against casters");
    report.table(&rows, &[1, 2]);
}

/// Triangles, vertices, edges, closed or open.
pub fn mesh_line(prepared: &Prepared) -> String {
    format!(
        "{} triangles, {} vertices, {} edges, {}",
        grouped(prepared.mesh().triangles.len() as u64),
        grouped(prepared.mesh().positions.len() as u64),
        grouped(prepared.edges.len() as u64),
        if prepared.closed { "closed" } else { "open" }
    )
}
