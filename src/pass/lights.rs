//! Several lights in one frame, and several points of one light.

use super::mapped::mapped_points;
use super::{FramePart, Inputs, LightTarget, ShadowPass, Surfaces, Target};
use crate::gpu::Buffer;
use crate::methods::facet_masks::Extent;
use crate::scene::{AreaLight, Light};
use crate::{Error, Result};

impl ShadowPass {
    /// Appends a frame for each of several lights, each with a target and a status of its own, and returns their numbers. What the camera sees is found
    /// once: lights after the first take their own maps and shadows, and the pictures are those of [`ShadowPass::record`] with each light, to the bit. Light,
    /// layers and reach of `inputs` are not read.
    ///
    /// In strips of rows, and with other methods than `facet-masks`, each light finds it anew. Maps of the light are not kept from frame to frame. Lists grow before
    /// the first of the lights only; it takes 24 bytes more a facet.
    ///
    /// # Errors
    /// As [`ShadowPass::record`]; [`Error::Config`] for a pass that keeps the last complete picture ([`PassConfig::keep_last`](super::PassConfig::keep_last)), of which there is one.
    pub fn record_lights(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        lights: &[LightTarget],
    ) -> Result<Vec<u64>> {
        self.check_several(lights.len(), "lights")?;
        let mapped = |to| self.mapped(&of_light(inputs, to), &to.target);
        let mapped = lights.iter().map(mapped).collect::<Result<Vec<_>>>()?;
        let mut numbers = Vec::with_capacity(lights.len());
        let mut found = false;
        for (mapped, LightTarget { target, .. }) in mapped.iter().zip(lights) {
            let inputs = mapped.get();
            let extent = self.extent(&inputs);
            let part = FramePart { extent, strip: None, surfaces: surfaces(lights.len(), found), point: None };
            numbers.push(self.record_part(encoder, &inputs, target, part)?);
            found |= extent != Extent::Nothing;
        }
        Ok(numbers)
    }

    /// Appends a frame for each point of a light of some extent, and returns their numbers: what goes to `target`, and to
    /// [`ShadowPass::visibility`], is the mean of their visibility, right where each has a complete status. The light of `inputs` is not read.
    ///
    /// The surfaces that the camera sees are found once, as by [`ShadowPass::record_lights`]; the points cost what as many lights do, and 4 bytes a pixel.
    ///
    /// # Errors
    /// As [`ShadowPass::record_lights`]; [`Error::Scene`] for a light that cannot be; [`Error::Config`] where lit masks are asked for, which several
    /// points have not.
    pub fn record_area(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        light: &AreaLight,
        target: &Target,
    ) -> Result<Vec<u64>> {
        light.check()?;
        self.check_several(light.points as usize, "points of a light")?;
        if target.lit.is_some() {
            return Err(Error::Config("lit masks: a light of some extent has none, its points have".to_owned()));
        }
        if target.listed.is_some() {
            return Err(Error::Config("lists of lights: a light of some extent is in none".to_owned()));
        }
        let inputs = &Inputs { light: &light.light, ..*inputs };
        let mapped = self.mapped(inputs, target)?;
        let points = light.points(self.middle_of(inputs)?);
        let points = mapped_points(inputs.map_of_places(), &points)?;
        self.record_points(encoder, &mapped.get(), &points, target, (None, None))
    }

    /// Refuses several lights where one picture, or frames before, are kept.
    pub(super) fn check_several(&self, count: usize, of: &str) -> Result<()> {
        if self.last.is_some() && count > 1 {
            return Err(Error::Config(format!("{count} {of}: a pass that keeps the last picture keeps that of one")));
        }
        self.check_history(count, of)
    }

    /// Refuses several lights where frames before are kept.
    fn check_history(&self, count: usize, of: &str) -> Result<()> {
        if count > 1 && self.image.method.keeps_history() {
            return Err(Error::Config(format!("{count} {of}: a history of frames is that of one light")));
        }
        Ok(())
    }

    /// Forgets the frames that [`Settings::history`](crate::methods::Settings::history) keeps: the next begins anew.
    pub fn forget_history(&mut self) {
        self.image.method.forget_history();
    }

    /// Makes room for sums over points where there is none.
    pub(super) fn make_sums(&mut self) -> Result<()> {
        let pixels = self.image.strips.count() as usize * self.image.method.visibility().len();
        if self.sums.as_ref().is_none_or(|sums| sums.len() != pixels) {
            self.sums = Some(Buffer::storage(&self.maker.device, "shadow_pass.point_sums", pixels)?);
            self.bind_groups.forget();
        }
        Ok(())
    }

    /// As [`ShadowPass::record_area`], of these points, in a strip of rows if one is named; without an extent each point has what is proved of
    /// it.
    pub(crate) fn record_points(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        inputs: &Inputs,
        points: &[Light],
        target: &Target,
        (strip, extent): (Option<u32>, Option<Extent>),
    ) -> Result<Vec<u64>> {
        self.check_history(points.len(), "points of a light")?;
        for light in points {
            self.check(&Inputs { light, ..*inputs }, target)?;
        }
        let count = points.len() as u32;
        let (mut numbers, mut found) = (Vec::with_capacity(points.len()), false);
        for (point, light) in (0..).zip(points) {
            let inputs = Inputs { light, ..*inputs };
            let extent = extent.unwrap_or_else(|| self.extent(&inputs));
            let surfaces = surfaces(points.len(), found);
            let target = if point + 1 == count { *target } else { Target::default() };
            let part = FramePart { extent, strip, surfaces, point: (count > 1).then_some([point, count]) };
            numbers.push(self.record_part(encoder, &inputs, &target, part)?);
            found |= extent != Extent::Nothing;
        }
        Ok(numbers)
    }
}

/// Inputs of a frame, of one of several lights.
pub(super) fn of_light<'a>(inputs: &Inputs<'a>, to: &'a LightTarget) -> Inputs<'a> {
    Inputs { light: &to.light, layers: to.layers, reach: to.reach, ..*inputs }
}

/// Who finds what the camera sees, for one of so many lights; `found`: one before has.
fn surfaces(lights: usize, found: bool) -> Surfaces {
    match (lights, found) {
        (1, _) => Surfaces::Own,
        (_, false) => Surfaces::Shared,
        (_, true) => Surfaces::Kept,
    }
}
