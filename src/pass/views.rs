//! The light's views of a pass's casters, those of casters that stand kept while the light is.

use super::ShadowPass;
use super::casters::CasterSet;
use super::gbuffer::GBuffer;
use super::inputs::{Inputs, LightReach};
use crate::Result;
use crate::light_view::{LightView, OmniMaps, PartBy, Receivers};
use crate::methods::{FacetMode, Settings};
use crate::scene::Light;
use glam::DVec3;

/// The last views of casters that stand, and what they were fitted to: the light, how far it is asked, and whether to all casters.
#[derive(Default)]
pub struct Views(Option<(Fitted, Vec<LightView>)>);

type Fitted = (Light, LightReach, bool);

impl ShadowPass {
    /// Boxes that hold the casters, one an object, where the light's views are of clusters of them; none where nothing is known.
    pub(super) fn objects_of(&self, inputs: &Inputs, settings: &Settings) -> Vec<(DVec3, DVec3)> {
        let casters = &self.casters;
        match (&casters.parts, settings.partition) {
            (_, plan) if plan.is_none_or(|plan| plan.by != PartBy::ReceiverClusters) => Vec::new(),
            (Some(parts), _) => parts.boxes(inputs.parts, false),
            _ if casters.are_known() => casters.prepared.objects().to_vec(),
            _ => Vec::new(),
        }
    }

    /// Views cut to what the camera may see in the shadow of casters between `bounds`, where [`Settings::focus`] says so.
    pub(super) fn focused(&self, views: Vec<LightView>, inputs: &Inputs, bounds: (DVec3, DVec3)) -> Vec<LightView> {
        let settings = &self.settings;
        if !settings.focus || settings.partition.is_some() || self.image.method.is_fixed() {
            return views;
        }
        // The pass sees no other triangles, of which facets then hold no more than is seen.
        let within = matches!(inputs.gbuffer, GBuffer::None) && settings.facets == FacetMode::All;
        LightView::focused(
            views,
            inputs.camera,
            settings.size,
            bounds,
            (within, self.keeps_maps && self.casters.stand()),
        )
    }
}

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
        let LightReach { cone, range } = inputs.reach;
        let range = f64::from(range);
        if settings.omni == OmniMaps::Paraboloids {
            let outside = match &casters.parts {
                Some(parts) => parts.backs_add_nothing(light),
                None => casters.are_known() && prepared.backs_add_nothing(light),
            };
            let views = LightView::paraboloids(bounds, light, map, cone)?;
            return Ok(views.into_iter().map(|view| LightView { outside, ..view }).collect());
        }
        if !casters.are_known() {
            let outside = casters.parts.as_ref().is_some_and(|parts| parts.backs_add_nothing(light));
            let boxes = casters.parts.as_ref().map_or_else(|| vec![bounds], |parts| parts.boxes(inputs.parts, true));
            let around = Self::around(bounds, &boxes, light, map, cone)?;
            return Ok(around.into_iter().map(|view| LightView { outside, ..view }).collect());
        }
        // What shadows no caster may shadow what is none.
        let all = matches!(inputs.gbuffer, GBuffer::Surfaces(_));
        let fitted = (*light, inputs.reach, all);
        if let Some((of, views)) = &self.0
            && *of == fitted
        {
            return Ok(views.clone());
        }
        let of = prepared.casting();
        let whole = |view: LightView| LightView { outside: prepared.backs_add_nothing(light), ..view };
        let in_cone = if cone { LightView::cone_of(of, light, map, range)? } else { None };
        let views = if let Some(view) = in_cone {
            vec![whole(view)]
        } else if all {
            let view = LightView::fit_casters(of, of, light, map, Receivers::Anything)?;
            let views = if view.complete { vec![view] } else { LightView::cube_within(of, light, map, range)? };
            views.into_iter().map(whole).collect()
        } else {
            let view = settings.light_view(prepared, light)?;
            match view.complete {
                true => vec![view],
                false => {
                    let cube = LightView::cube_within(of, light, map, range)?;
                    cube.into_iter().map(|side| LightView { outside: view.outside, ..side }).collect()
                }
            }
        };
        self.0 = Some((fitted, views.clone()));
        Ok(views)
    }

    /// The views of boxes, which lie between `bounds`.
    fn around(
        bounds: (DVec3, DVec3),
        boxes: &[(DVec3, DVec3)],
        light: &Light,
        map: u32,
        cone: bool,
    ) -> Result<Vec<LightView>> {
        if cone && let Some(view) = LightView::cone_around(bounds, light, map)? {
            return Ok(vec![view]);
        }
        let view = LightView::around_boxes(boxes, light, map)?;
        if view.complete { Ok(vec![view]) } else { LightView::cube_around_boxes(boxes, light, map) }
    }
}
