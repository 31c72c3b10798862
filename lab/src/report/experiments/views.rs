//! Pictures of an experiment tinted by the view of the light that each pixel asks.

use super::{Experiment, Place};
use crate::report::comparison::figures::slug;
use crate::report::comparison::{ReportVariant, Row};
use crate::report::looks::write_views;
use crate::report::shaded::{Shading, shade};
use std::path::Path;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Budget, Renderer};

/// The file of the picture of a row, such as `variance splits=3`.
pub fn views_file(place: &Place, series: &str) -> String {
    format!("views-{}-{}.png", slug(place.label), slug(series))
}

impl Experiment {
    /// Renders the rows at the first map and number of samples once more, and writes a picture of each in which pixels ask one of several
    /// views, where [`Experiment::views`] is set.
    ///
    /// # Errors
    /// As [`Experiment::open`] and [`Renderer::render_and_look`]; [`subpixel_shadows::Error::File`] if a picture cannot be written.
    pub fn write_views(&self, gpu: &Gpu, size: [u32; 2], out: &Path) -> Result<()> {
        for place in self.places.iter().filter(|_| self.views) {
            for variant in self.variants(size)? {
                let settings = &variant.settings;
                if (settings.map, settings.samples.count()) == (self.maps[0], self.samples[0]) {
                    write_picture(gpu, place, &variant, out)?;
                }
            }
        }
        Ok(())
    }
}

/// Writes the picture of a row, where pixels ask one of several views.
fn write_picture(gpu: &Gpu, place: &Place, variant: &ReportVariant, out: &Path) -> Result<()> {
    let (scene, settings) = (Experiment::open(place)?, &variant.settings);
    let (prepared, camera, light) = (scene.prepared()?, &scene.camera, &scene.light);
    let plan = Plan::of_method(variant.method, &prepared, camera, light, settings, false)?;
    let mut renderer = Renderer::of_plan(gpu, &prepared, variant.method, &plan, Budget::default())?;
    let (output, looks) = renderer.render_and_look(camera, light)?;
    let Some(looks) = looks.filter(|looks| !looks.views.is_empty()) else {
        return Ok(());
    };
    let (triangles, visibility) = (&output.triangles[..], &output.visibility[..]);
    let shaded = shade(&Shading { mesh: prepared.mesh(), camera, light, size: settings.size, triangles, visibility });
    let row = Row { method: variant.method.name().to_owned(), setting: variant.setting.clone(), ..Row::default() };
    write_views(&out.join(views_file(place, &row.series())), settings.size, &shaded, triangles, &looks.views)
}
