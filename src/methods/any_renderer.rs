//! Any of the methods behind one door, as the program and the report take them.

use super::debug_views::DebugViews;
use super::facet_masks::FacetMasks;
use super::fixed_memory::FixedRenderer;
use super::names::MethodName;
use super::prepared::{CasterBuffers, Prepared};
use super::ray_traced::RayTraced;
use super::render::{Budget, Output, Renderer};
use super::settings::Settings;
use super::shadow_map::{MapQuery, ShadowMapping};
use super::split_mapping::{Recipe, SplitMapping};
use super::spsm::Spsm;
use super::supersampled::Supersampled;
use crate::Result;
use crate::gpu::{Gpu, KeptPrograms};
use crate::scene::{Camera, Light};
use crate::stages::facet_classify::Facets;

/// A method set up for one mesh and one setting, to be rendered again and again.
pub enum AnyRenderer<'a> {
    /// `facet-masks`.
    FacetMasks(Box<Renderer<'a>>),
    /// `spsm`.
    Spsm(Box<FixedRenderer<'a, Spsm>>),
    /// `shadow-map`, `pcf` and `smsr`.
    ShadowMapping(Box<FixedRenderer<'a, ShadowMapping>>),
    /// `variance`, `trapezoidal`, `lispsm`, `parallel-split` and `remix`.
    SplitMapping(Box<FixedRenderer<'a, SplitMapping>>),
    /// `ray-traced`.
    RayTraced(Box<FixedRenderer<'a, RayTraced>>),
    /// `supersampled`.
    Supersampled(Box<FixedRenderer<'a, Supersampled>>),
}

impl<'a> AnyRenderer<'a> {
    /// Uploads the mesh, builds pipelines and memory.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn new(
        gpu: &'a Gpu,
        prepared: &'a Prepared,
        method: MethodName,
        settings: &Settings,
        budget: Budget,
    ) -> Result<Self> {
        KeptPrograms::once(|| Self::made(gpu, prepared, method, settings, budget))
    }

    fn made(
        gpu: &'a Gpu,
        prepared: &'a Prepared,
        method: MethodName,
        settings: &Settings,
        budget: Budget,
    ) -> Result<Self> {
        match method {
            MethodName::FacetMasks => Ok(Self::FacetMasks(Box::new(Renderer::new(gpu, prepared, settings, budget)?))),
            MethodName::Spsm => {
                let renderer = FixedRenderer::new(gpu, prepared, settings, |_| Spsm::new(gpu, settings))?;
                Ok(Self::Spsm(Box::new(renderer)))
            }
            MethodName::ShadowMap | MethodName::Pcf | MethodName::Smsr => {
                let ask = match method {
                    MethodName::Pcf => MapQuery::Filtered,
                    MethodName::Smsr => MapQuery::Revectorized,
                    _ => MapQuery::Nearest,
                };
                let make = |_: &CasterBuffers| ShadowMapping::new(gpu, settings, ask);
                Ok(Self::ShadowMapping(Box::new(FixedRenderer::new(gpu, prepared, settings, make)?)))
            }
            MethodName::Variance => Self::split_mapping(gpu, prepared, settings, Recipe::Variance),
            MethodName::Trapezoidal => Self::split_mapping(gpu, prepared, settings, Recipe::Trapezoidal),
            MethodName::Lispsm => Self::split_mapping(gpu, prepared, settings, Recipe::LightSpace),
            MethodName::ParallelSplit => Self::split_mapping(gpu, prepared, settings, Recipe::ParallelSplit),
            MethodName::Remix => Self::split_mapping(gpu, prepared, settings, Recipe::Remix),
            MethodName::RayTraced => {
                let make = |casters: &CasterBuffers| RayTraced::new(gpu, prepared, casters, settings);
                Ok(Self::RayTraced(Box::new(FixedRenderer::new(gpu, prepared, settings, make)?)))
            }
            MethodName::Supersampled => {
                let make = |casters: &CasterBuffers| Supersampled::new(gpu, prepared, casters, settings);
                Ok(Self::Supersampled(Box::new(FixedRenderer::new(gpu, prepared, settings, make)?)))
            }
        }
    }

    fn split_mapping(gpu: &'a Gpu, prepared: &'a Prepared, settings: &Settings, recipe: Recipe) -> Result<Self> {
        let make = |casters: &CasterBuffers| SplitMapping::new(gpu, prepared, casters, settings, recipe);
        Ok(Self::SplitMapping(Box::new(FixedRenderer::new(gpu, prepared, settings, make)?)))
    }

    /// Renders one frame.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render(&mut self, camera: &Camera, light: &Light) -> Result<Output> {
        match self {
            Self::FacetMasks(renderer) => renderer.render(camera, light),
            Self::Spsm(renderer) => renderer.render(camera, light),
            Self::ShadowMapping(renderer) => renderer.render(camera, light),
            Self::SplitMapping(renderer) => renderer.render(camera, light),
            Self::RayTraced(renderer) => renderer.render(camera, light),
            Self::Supersampled(renderer) => renderer.render(camera, light),
        }
    }

    /// The facets of the last frame, of `ray-traced` and `supersampled`: one strip of rows, so all there are. Those of `facet-masks` are
    /// read strip by strip ([`Renderer::render_and`]); the others have none.
    pub fn facets(&self) -> Option<&Facets> {
        match self {
            Self::RayTraced(renderer) => Some(renderer.method().facets()),
            Self::Supersampled(renderer) => Some(renderer.method().facets()),
            _ => None,
        }
    }

    /// As [`AnyRenderer::render`], and what there is to look at besides the picture; `None` where the method keeps neither
    /// classes nor a map.
    ///
    /// # Errors
    /// As [`AnyRenderer::render`].
    pub fn render_and_look(&mut self, camera: &Camera, light: &Light) -> Result<(Output, Option<DebugViews>)> {
        if let Self::FacetMasks(renderer) = self {
            let (gpu, width, mut looks) = (renderer.gpu(), renderer.settings().size[0], DebugViews::default());
            let look = &mut |method: &FacetMasks, rows| looks.add_rows(gpu, method, width, rows);
            let output = renderer.render_and(camera, light, look)?;
            return Ok((output, Some(looks)));
        }
        let output = self.render(camera, light)?;
        let looks = match self {
            Self::Spsm(renderer) => renderer.looks()?,
            Self::ShadowMapping(renderer) => renderer.looks()?,
            Self::SplitMapping(renderer) => renderer.looks()?,
            Self::FacetMasks(_) | Self::RayTraced(_) | Self::Supersampled(_) => None,
        };
        Ok((output, looks))
    }
}
