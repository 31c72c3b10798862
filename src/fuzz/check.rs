//! Rendering a case on the GPU, with all that is needed to judge the frame.

use super::{FuzzCase, How};
use crate::Result;
use crate::gpu::{Gpu, KeptPrograms};
use crate::methods::fixed_memory::{FixedMethod, FixedRenderer};
use crate::methods::ray_traced::RayTraced;
use crate::methods::render::{Output, Renderer};
use crate::methods::supersampled::Supersampled;
use crate::methods::{MethodName, Prepared, unshadowed};
use crate::plan::{Extent, Plan};
use crate::report::FacetSet;
use crate::scene::Scene;
use crate::stages::facet_classify::Facets;

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
    /// The program's error for a scene or settings that it refuses; [`crate::Error::Gpu`].
    pub fn render(&self, case: &FuzzCase) -> Result<Shot> {
        self.programs.within(|| self.render_with(case))
    }

    fn render_with(&self, case: &FuzzCase) -> Result<Shot> {
        let how = &case.how;
        let scene = case.world.scene()?;
        let prepared = Prepared::new(&scene.mesh)?;
        let planned = |force| Plan::of_method(how.method, &prepared, &scene.camera, &scene.light, &how.settings, force);
        let plan = planned(how.force_all)?;
        let (output, facets) = self.frame(how, &plan, &scene, &prepared)?;
        let forced = || self.frame(how, &planned(true)?, &scene, &prepared);
        let forced = how.both.then(forced).transpose()?;
        Ok(Shot { scene, prepared, plan, output, facets, forced })
    }

    fn frame(&self, how: &How, plan: &Plan, scene: &Scene, prepared: &Prepared) -> Result<(Output, FacetSet)> {
        let (gpu, settings) = (self.gpu, &plan.settings);
        let (words, width) = (settings.samples.words(), settings.size[0]);
        let mut set = FacetSet { words, ..FacetSet::default() };
        let output = match (plan.extent, how.method) {
            (Extent::Nothing, _) => unshadowed::nothing_seen(settings),
            (Extent::Facing, _) => {
                unshadowed::render_and(gpu, prepared, settings, &scene.camera, &scene.light, &mut |facets, rows| {
                    if rows.first == 0 {
                        set = FacetSet { words, ..FacetSet::default() };
                    }
                    set.add(gpu, facets, words, width, rows)
                })?
            }
            (Extent::Everything, MethodName::RayTraced) => {
                let made = |casters: &_| RayTraced::new(gpu, prepared, casters, settings);
                let renderer = FixedRenderer::new(gpu, prepared, settings, made)?;
                return self.fixed(renderer, scene, words, RayTraced::facets);
            }
            (Extent::Everything, MethodName::Supersampled) => {
                let made = |casters: &_| Supersampled::new(gpu, prepared, casters, settings);
                let renderer = FixedRenderer::new(gpu, prepared, settings, made)?;
                return self.fixed(renderer, scene, words, Supersampled::facets);
            }
            (Extent::Everything, _) => {
                let mut renderer = Renderer::new(gpu, prepared, settings, how.budget)?;
                renderer.render_and(&scene.camera, &scene.light, &mut |method, rows| {
                    if rows.first == 0 {
                        set = FacetSet { words, ..FacetSet::default() };
                    }
                    set.add(gpu, method.facets(), words, width, rows)
                })?
            }
        };
        Ok((output, set))
    }

    fn fixed<M: FixedMethod>(
        &self,
        mut renderer: FixedRenderer<M>,
        scene: &Scene,
        words: u32,
        facets: fn(&M) -> &Facets,
    ) -> Result<(Output, FacetSet)> {
        let output = renderer.render(&scene.camera, &scene.light)?;
        let set = FacetSet::read(self.gpu, facets(renderer.method()), words)?;
        Ok((output, set))
    }
}
