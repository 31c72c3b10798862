//! Stages that the plan leaves out of each half's frame, with the reasons.

use super::Viewer;
use crate::job::Job;
use crate::view::Against;
use egui::Ui;
use lab::options::RenderOptions;
use std::sync::Arc;
use subpixel_shadows::Result;
use subpixel_shadows::methods::{Prepared, Settings};
use subpixel_shadows::plan::Plan;

/// The scene as plans ask it: made when it is first looked at.
#[derive(Default)]
pub enum PlannedScene {
    /// Not yet.
    #[default]
    Unasked,
    /// Beside the window.
    Making(Job<Result<Prepared>>),
    /// It is there.
    Made(Arc<Prepared>),
    /// Why it is not.
    Refused(String),
}

impl PlannedScene {
    /// Takes it over if it is made.
    fn advance(&mut self) {
        if let Self::Making(job) = self
            && let Some(made) = job.take()
        {
            *self = match made {
                Ok(prepared) => Self::Made(Arc::new(prepared)),
                Err(error) => Self::Refused(error.to_string()),
            };
        }
    }
}

impl Viewer {
    /// A list for each half, of what the plan leaves out of its frames.
    pub(super) fn plans(&mut self, ui: &mut Ui) {
        let open = egui::CollapsingHeader::new("what is left out, and why").show(ui, |ui| self.lists(ui));
        crate::panel::keep(&open.header_response, &["left out"]);
    }

    fn lists(&mut self, ui: &mut Ui) {
        self.planned.advance();
        match &self.planned {
            PlannedScene::Unasked => {
                let scene = self.scene.clone();
                self.planned = PlannedScene::Making(Job::new(&self.context, move || scene.prepared()));
            }
            PlannedScene::Making(_) => {
                ui.label("looking at the mesh");
            }
            PlannedScene::Refused(why) => {
                ui.label(why);
            }
            PlannedScene::Made(prepared) => {
                let right = match &self.view.right {
                    Against::Method(options) => Some(&**options),
                    Against::Truth => None,
                };
                for (name, options) in [("left", Some(&self.view.left)), ("right", right)] {
                    let Some(options) = options else { continue };
                    ui.strong(name);
                    match self.left_out(prepared, options) {
                        Ok(steps) if steps.is_empty() => _ = ui.label("nothing"),
                        Ok(steps) => steps.iter().for_each(|step| _ = ui.label(step)),
                        Err(error) => _ = ui.label(error.to_string()),
                    }
                }
            }
        }
    }

    /// Lines of what the plan leaves out for the moment that is looked at.
    fn left_out(&self, prepared: &Prepared, options: &RenderOptions) -> Result<Vec<String>> {
        let (camera, light) = (&self.moment.camera, &self.moment.light);
        let size = self.full.as_ref().map_or(options.size, |level| level.picture.size);
        let settings = Settings { size, ..options.settings()? };
        let plan = Plan::of_method(options.method, prepared, camera, light, &settings, options.force_all)?;
        Ok(plan.left_out().map(|(step, why)| format!("{step}: {why}")).collect())
    }
}
