//! Several lights in one frame.

use super::{FramePart, Inputs, ShadowPass, Surfaces, Target};
use crate::methods::facet_masks::Extent;
use crate::scene::Light;
use crate::{Error, Result};

impl ShadowPass {
    /// Appends a frame for each of several lights, each with a target and a status of its own, and returns their numbers. What the camera sees is found
    /// once: lights after the first take their own maps and shadows, and the pictures are those of [`ShadowPass::record`] with each light, to the bit. The light
    /// of `inputs` is not read.
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
        lights: &[(Light, Target)],
    ) -> Result<Vec<u64>> {
        if self.last.is_some() && lights.len() > 1 {
            let count = lights.len();
            return Err(Error::Config(format!("{count} lights: a pass that keeps the last picture keeps that of one")));
        }
        for (light, target) in lights {
            self.check(&Inputs { light, ..*inputs }, target)?;
        }
        let mut numbers = Vec::with_capacity(lights.len());
        let mut found = false;
        for (light, target) in lights {
            let inputs = Inputs { light, ..*inputs };
            let extent = self.extent(&inputs);
            let surfaces = match (lights.len(), found) {
                (1, _) => Surfaces::Own,
                (_, false) => Surfaces::Shared,
                (_, true) => Surfaces::Kept,
            };
            numbers.push(self.record_part(encoder, &inputs, target, FramePart { extent, strip: None, surfaces })?);
            found |= extent != Extent::Nothing;
        }
        Ok(numbers)
    }
}
