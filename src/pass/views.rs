//! The light's views of a pass's casters, those of casters that stand kept while the light is.

use super::casters::CasterSet;
use super::gbuffer::GBuffer;
use super::inputs::Inputs;
use crate::Result;
use crate::light_view::{LightView, Receivers};
use crate::methods::Settings;
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
        let (light, map, prepared) = (inputs.light, settings.map, &casters.prepared);
        if casters.moves.is_some() {
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
            let of = prepared.casters();
            let view = LightView::fit_casters(of, light, map, Receivers::Anything)?;
            let views = if view.complete { vec![view] } else { LightView::cube_of(of, light, map)? };
            let outside = prepared.backs_add_nothing(light);
            views.into_iter().map(|view| LightView { outside, ..view }).collect()
        } else {
            settings.light_views(prepared, light)?
        };
        self.0 = Some((*light, all, views.clone()));
        Ok(views)
    }
}
