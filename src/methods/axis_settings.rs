//! Options of the method of warped axes.

pub use crate::stages::axis_density::DensityRule;

use crate::stages::axis_density::AxisDensity;
use crate::{Error, Result};

/// Options of `rectilinear`, whose bias is that of [`ShadowMapSettings`](super::ShadowMapSettings).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisSettings {
    /// Rule for the texels that a part of an axis of the light's view takes.
    pub density: DensityRule,
    /// How many times narrower than texels of an even map those of an axis may be: 2 to 256.
    pub stretch: u32,
}

impl Default for AxisSettings {
    fn default() -> Self {
        Self { density: DensityRule::Requested, stretch: Self::STRETCH }
    }
}

impl AxisSettings {
    /// The limit of the stretch where none is told.
    pub const STRETCH: u32 = 64;

    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let (stretch, possible) = (self.stretch, AxisDensity::STRETCHES);
        if !possible.contains(&stretch) {
            let (least, most) = (possible.start(), possible.end());
            return Err(Error::Config(format!("texels stretched {stretch} times; {least} to {most} are possible")));
        }
        Ok(())
    }
}
