//! The light's views of a pass's casters, those of casters that stand kept while the light is.

use super::casters::CasterSet;
use super::gbuffer::GBuffer;
use super::inputs::Inputs;
use crate::Result;
use crate::light_view::LightView;
use crate::methods::Settings;
use crate::methods::settings::backs_add_nothing;
use crate::scene::Light;
use glam::DVec3;

/// The last views of casters that stand, and what they were fitted to: the light, and whether to all casters.
#[derive(Default)]
pub struct Views(Option<(Light, bool, Vec<LightView>)>);

impl Views {
    /// One view of the casters, which lie between `bounds`; a cube of them if the light stands among these.
    pub fn of(
        &mut self,
        inputs: &Inputs,
        casters: &CasterSet,
        settings: &Settings,
        bounds: (DVec3, DVec3),
    ) -> Result<Vec<LightView>> {
        let (light, map, mesh) = (inputs.light, settings.map, &casters.mesh);
        if inputs.moved.is_some() {
            let view = LightView::around(bounds, light, map)?;
            return if view.complete { Ok(vec![view]) } else { LightView::cube_around(bounds, light, map) };
        }
        // What shadows no caster may shadow what is none.
        let all = matches!(inputs.gbuffer, GBuffer::Surfaces(_));
        if let Some((of, of_all, views)) = &self.0
            && (of, *of_all) == (light, all)
        {
            return Ok(views.clone());
        }
        let views = if all {
            let view = LightView::fit_all(mesh, light, map)?;
            let views = if view.complete { vec![view] } else { LightView::cube(mesh, light, map)? };
            let outside = backs_add_nothing(mesh, &casters.bodies, light);
            views.into_iter().map(|view| LightView { outside, ..view }).collect()
        } else {
            settings.light_views(mesh, &casters.bodies, light)?
        };
        self.0 = Some((*light, all, views.clone()));
        Ok(views)
    }
}
