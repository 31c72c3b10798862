//! The light's views of a pass's casters, those of casters that stand kept while the light is.

use super::casters::CasterSet;
use super::gbuffer::GBuffer;
use super::inputs::Inputs;
use crate::Result;
use crate::light_view::LightView;
use crate::methods::Settings;
use crate::scene::Light;
use glam::DVec3;

/// What is known of casters and a light.
#[derive(Clone)]
pub struct OfLight {
    /// One view of the casters; a cube of them if the light stands among these.
    pub views: Vec<LightView>,
    /// Whether casters of closed bodies that turn away from the light add nothing.
    pub backs_add_nothing: bool,
}

/// The last of casters that stand, and what it was found for: the light, and whether for views of all casters.
#[derive(Default)]
pub struct Views(Option<(Light, bool, OfLight)>);

impl Views {
    /// Of the casters, which lie between `bounds`.
    pub fn of(
        &mut self,
        inputs: &Inputs,
        casters: &CasterSet,
        settings: &Settings,
        bounds: (DVec3, DVec3),
    ) -> Result<OfLight> {
        let (light, map, mesh) = (inputs.light, settings.map, &casters.mesh);
        if inputs.moved.is_some() {
            let view = LightView::around(bounds, light, map)?;
            let views = if view.complete { vec![view] } else { LightView::cube_around(bounds, light, map)? };
            return Ok(OfLight { views, backs_add_nothing: false });
        }
        // What shadows no caster may shadow what is none.
        let all = matches!(inputs.gbuffer, GBuffer::Surfaces(_));
        if let Some((of, of_all, known)) = &self.0
            && (of, *of_all) == (light, all)
        {
            return Ok(known.clone());
        }
        let views = if all {
            let view = LightView::fit_all(mesh, light, map)?;
            if view.complete { vec![view] } else { LightView::cube(mesh, light, map)? }
        } else {
            settings.light_views(mesh, casters.buffers.closed, light)?
        };
        let known = OfLight { views, backs_add_nothing: casters.backs_add_nothing(light) };
        self.0 = Some((*light, all, known.clone()));
        Ok(known)
    }
}
