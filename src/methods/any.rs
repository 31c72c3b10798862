//! Any of the methods behind one door, as the program and the report take them.

use super::fixed::FixedRenderer;
use super::prepared::Prepared;
use super::render::{Budget, Output, Renderer};
use super::settings::Settings;
use super::spsm::Spsm;
use crate::Result;
use crate::gpu::Gpu;
use crate::scene::{Camera, Light};

/// The methods by their names, the same in API, program, reports and files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MethodName {
    /// `facet-masks`: Pan 2009, and with several facets a pixel beyond it.
    #[default]
    FacetMasks,
    /// `spsm`: Lecocq 2013.
    Spsm,
}

impl MethodName {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::FacetMasks, Self::Spsm];

    /// The one name of the method.
    pub fn name(self) -> &'static str {
        match self {
            Self::FacetMasks => "facet-masks",
            Self::Spsm => "spsm",
        }
    }
}

/// A method set up for one mesh and one setting, to be rendered again and again.
pub enum AnyRenderer<'a> {
    /// `facet-masks`.
    FacetMasks(Box<Renderer<'a>>),
    /// `spsm`.
    Spsm(Box<FixedRenderer<'a, Spsm>>),
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
        match method {
            MethodName::FacetMasks => Ok(Self::FacetMasks(Box::new(Renderer::new(gpu, prepared, settings, budget)?))),
            MethodName::Spsm => {
                let renderer = FixedRenderer::new(gpu, prepared, settings, |_| Spsm::new(gpu, settings))?;
                Ok(Self::Spsm(Box::new(renderer)))
            }
        }
    }

    /// Renders one frame.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render(&mut self, camera: &Camera, light: &Light) -> Result<Output> {
        match self {
            Self::FacetMasks(renderer) => renderer.render(camera, light),
            Self::Spsm(renderer) => renderer.render(camera, light),
        }
    }
}
