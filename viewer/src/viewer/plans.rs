//! Stages that the plan leaves out of each half's frame, with the reasons.

use super::Viewer;
use crate::view::Against;
use egui::Ui;
use lab::options::RenderOptions;
use subpixel_shadows::Result;
use subpixel_shadows::methods::Settings;
use subpixel_shadows::plan::Plan;

impl Viewer {
    /// A list for each half, of what the plan leaves out of its frames.
    pub(super) fn plans(&mut self, ui: &mut Ui) {
        let open = egui::CollapsingHeader::new("what is left out, and why").show(ui, |ui| self.lists(ui));
        crate::panel::keep(&open.header_response, &["left out"]);
    }

    fn lists(&self, ui: &mut Ui) {
        let right = match &self.view.right {
            Against::Method(options) => Some(&**options),
            Against::Truth => None,
        };
        for (name, options) in [("left", Some(&self.view.left)), ("right", right)] {
            let Some(options) = options else { continue };
            ui.strong(name);
            match self.left_out(options) {
                Ok(steps) if steps.is_empty() => _ = ui.label("nothing"),
                Ok(steps) => steps.iter().for_each(|step| _ = ui.label(step)),
                Err(error) => _ = ui.label(error.to_string()),
            }
        }
    }

    /// Lines of what the plan leaves out for the moment that is looked at.
    fn left_out(&self, options: &RenderOptions) -> Result<Vec<String>> {
        let (camera, light) = (&self.moment.camera, &self.moment.light);
        let size = self.full.as_ref().map_or(options.size, |level| level.picture.size);
        let settings = Settings { size, ..options.settings()? };
        let plan = Plan::of_method(options.method, &self.prepared, camera, light, &settings, options.force_all)?;
        Ok(plan.left_out().map(|(step, why)| format!("{step}: {why}")).collect())
    }
}
