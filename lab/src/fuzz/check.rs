//! Rendering a case on the GPU, with all that is needed to judge the frame.

use super::{FuzzCase, How};
use crate::report::{FacetSet, Promise};
use crate::scene::Scene;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::{Gpu, KeptPrograms};
use subpixel_shadows::methods::{MethodName, Prepared};
use subpixel_shadows::plan::Plan;
use subpixel_shadows::render::{Output, Renderer};

/// A device with the programs that its frames share.
pub struct FuzzDevice<'a> {
    gpu: &'a Gpu,
    programs: KeptPrograms,
}

/// A case that was rendered.
pub struct Shot {
    /// The scene, ground included.
    pub scene: Scene,
    /// Its mesh, prepared.
    pub prepared: Prepared,
    /// Its plan.
    pub plan: Plan,
    /// The picture.
    pub output: Output,
    /// The facets behind it, with their masks.
    pub facets: FacetSet,
    /// The picture of a second frame, of a method of texels.
    pub again: Option<Output>,
    /// The picture of everything run and nothing settled, and its facets, where it was asked for.
    pub forced: Option<(Output, FacetSet)>,
}

impl<'a> FuzzDevice<'a> {
    /// A bench on this device.
    pub fn new(gpu: &'a Gpu) -> Self {
        Self { gpu, programs: KeptPrograms::default() }
    }

    /// The device.
    pub fn gpu(&self) -> &'a Gpu {
        self.gpu
    }

    /// Programs compiled up to now.
    pub fn programs(&self) -> usize {
        self.programs.len()
    }

    /// Renders a case as `render` does.
    ///
    /// # Errors
    /// The program's error for a scene or settings that it refuses; [`subpixel_shadows::Error::Gpu`].
    pub fn render(&self, case: &FuzzCase) -> Result<Shot> {
        self.programs.within(|| self.render_with(case))
    }

    fn render_with(&self, case: &FuzzCase) -> Result<Shot> {
        let how = &case.how;
        let scene = case.world.scene()?;
        let prepared = scene.prepared()?;
        let planned = |force| Plan::of_method(how.method, &prepared, &scene.camera, &scene.light, &how.settings, force);
        let plan = planned(how.force_all)?;
        let mut again = None;
        let (output, facets) = self.frame(how, &plan, &scene, &prepared, Some(&mut again))?;
        let forced = || self.frame(how, &planned(true)?, &scene, &prepared, None);
        let forced = how.both.then(forced).transpose()?;
        Ok(Shot { scene, prepared, plan, output, facets, again, forced })
    }

    fn frame(
        &self,
        how: &How,
        plan: &Plan,
        scene: &Scene,
        prepared: &Prepared,
        again: Option<&mut Option<Output>>,
    ) -> Result<(Output, FacetSet)> {
        let (gpu, settings) = (self.gpu, &plan.settings);
        let (words, width) = (settings.samples.words(), settings.size[0]);
        let mut set = FacetSet { words, ..FacetSet::default() };
        let mut renderer = Renderer::of_plan(gpu, prepared, how.method, plan, how.budget)?;
        if how.promise() == Promise::Texels {
            let output = renderer.render(&scene.camera, &scene.light)?;
            if let Some(again) = again {
                *again = Some(renderer.render(&scene.camera, &scene.light)?);
            }
            return Ok((output, set));
        }
        let output = renderer.render_and(&scene.camera, &scene.light, &mut |method, rows| {
            if rows.first == 0 {
                set = FacetSet { words, ..FacetSet::default() };
            }
            set.add(gpu, method.facets(), words, width, rows)
        })?;
        if how.method != MethodName::FacetMasks
            && let Some(facets) = renderer.facets()
        {
            set = FacetSet::read(gpu, facets, words)?;
        }
        Ok((output, set))
    }
}
