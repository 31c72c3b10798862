//! Frames of a mapped world, as orthographic cameras need them.

use super::gbuffer::{GBuffer, SurfacePosition};
use super::inputs::{Inputs, LightReach, Moved, PartAt, PartPlace, Placed};
use super::{ShadowPass, Target};
use crate::scene::{Homography, Light};
use crate::{Error, Result};

/// Inputs of a frame in its mapped world.
pub struct MappedInputs<'a> {
    inputs: Inputs<'a>,
    light: Light,
    parts: Vec<PartPlace<'a>>,
}

impl<'a> MappedInputs<'a> {
    /// Maps the light and the boxes of what moves; places are mapped when they are written.
    pub fn new(inputs: &Inputs<'a>) -> Result<Self> {
        let homography = inputs.map_of_places();
        let light = homography.light(inputs.light)?;
        let moved = |moved: Moved<'a>| Ok::<_, Error>(Moved { bounds: homography.bounds(moved.bounds)?, ..moved });
        let placed =
            |placed: Placed<'a>| Ok::<_, Error>(Placed { bounds: homography.bounds(placed.bounds)?, ..placed });
        let part = |part: &PartPlace<'a>| {
            let at = match part.at {
                PartAt::Moved(at) => PartAt::Moved(moved(at)?),
                PartAt::Placed(at) => PartAt::Placed(placed(at)?),
            };
            Ok::<_, Error>(PartPlace { at, ..*part })
        };
        let parts = inputs.parts.iter().map(part).collect::<Result<_>>()?;
        let (moved, placed) = (inputs.moved.map(moved).transpose()?, inputs.placed.map(placed).transpose()?);
        let reach = if homography.is_none() { inputs.reach } else { LightReach::EVERYWHERE };
        Ok(Self { inputs: Inputs { moved, placed, reach, parts: &[], ..*inputs }, light, parts })
    }

    /// The inputs.
    pub fn get(&self) -> Inputs<'_> {
        Inputs { light: &self.light, parts: &self.parts, ..self.inputs }
    }
}

/// Where points of a light come to.
pub fn mapped_points(homography: Homography, points: &[Light]) -> Result<Vec<Light>> {
    points.iter().map(|point| homography.light(point)).collect()
}

impl ShadowPass {
    /// Inputs of a frame in its mapped world, checked.
    pub(super) fn mapped<'a>(&self, inputs: &Inputs<'a>, target: &Target) -> Result<MappedInputs<'a>> {
        self.check_mapped(inputs, target)?;
        let mapped = MappedInputs::new(inputs)?;
        let (_, high) = self.check(&mapped.get(), target)?;
        let near = f64::from(inputs.camera.near);
        if inputs.homography.is_some_and(|map| !map.is_none()) && -high.z < near {
            return Err(Error::Scene(format!(
                "an orthographic camera: the casters' box begins at a view depth of {} of the mapped world, before the near distance {near}: the world was given as smaller",
                -high.z
            )));
        }
        Ok(mapped)
    }

    /// Refuses what a mapped world cannot have.
    fn check_mapped(&self, inputs: &Inputs, target: &Target) -> Result<()> {
        if inputs.homography.is_none_or(Homography::is_none) {
            return Ok(());
        }
        let refuse = |what: &str| Err(Error::Config(format!("an orthographic camera: {what}")));
        let standing = self.casters.are_known() || self.casters.parts.as_ref().is_some_and(|parts| parts.any_stands());
        if standing {
            return refuse("casters that stand are not mapped: they can be given as instances");
        }
        if self.image.method.keeps_history() {
            return refuse("a history of frames is of one world, and each frame's is mapped otherwise");
        }
        if target.listed.is_some() {
            return refuse("lists of lights go by distances, which a mapped world has not");
        }
        match inputs.gbuffer {
            GBuffer::Surfaces(given)
                if given.normals.is_some() || matches!(given.place, SurfacePosition::Position(_)) =>
            {
                refuse("positions and normals of a G-buffer are not mapped; depths and triangle numbers are")
            }
            _ => Ok(()),
        }
    }
}
