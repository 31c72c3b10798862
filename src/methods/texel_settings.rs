//! Options of the methods whose texels keep depths, or what is made of them, or triangles.

use crate::stages::compared_depths::DepthRule;
use crate::stages::deep_map::{DeepMapOptions, MOST_NODES};
use crate::stages::map_moments::MomentMeasures;
use crate::tap_disc::MOST_TAPS;
use crate::{Error, Result};

/// Options of `reconstructable`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReconstructableSettings {
    /// Texels a side whose triangles a sample asks, its own in the middle: 1, 3, 5 (Lecocq 2013, figure 13) or 7.
    pub lookups: u32,
    /// Depth by which a triangle must lie before a sample to shadow it; depth 1 is the extent of the casters along the light.
    pub bias: f32,
}

impl Default for ReconstructableSettings {
    fn default() -> Self {
        Self { lookups: 5, bias: 1e-5 }
    }
}

impl ReconstructableSettings {
    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let Self { lookups, bias } = *self;
        check_lookups(lookups)?;
        if !(0.0..=1.0).contains(&bias) {
            return Err(Error::Config(format!("reconstructable: bias {bias}; 0 to 1 are possible")));
        }
        Ok(())
    }
}

/// Options of `polygon-ids`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PolygonIdSettings {
    /// Texels a side around a sample's of which one must keep its receiver's polygon for it to be lit: 1, 3, 5 or 7. More than 1 takes false
    /// shadows of what is smaller than a texel away, and as much from the rims of shadows.
    pub lookups: u32,
}

impl Default for PolygonIdSettings {
    fn default() -> Self {
        Self { lookups: 1 }
    }
}

impl PolygonIdSettings {
    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        check_lookups(self.lookups)
    }
}

/// Options of `deep`, whose bias is [`ShadowMapSettings::constant`], and [`ShadowMapSettings::slope`] times what the receiver's plane rises from a
/// texel's middle to its corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeepSettings {
    /// Sub-texels a side of a texel, whose nearest depths make its steps: 2, 4 or 8. The map has so many times as many a side, up to
    /// [`LARGEST_MAP`](crate::light_view::LightView::LARGEST_MAP).
    pub sub_texels: u32,
    /// Nodes of a texel at most: 3 to [`MOST_NODES`].
    pub nodes: u32,
    /// Share of light by which the nodes' lines may be off the steps, 0 to 0.5; it is more in texels whose nodes do not suffice.
    pub error: f32,
}

impl Default for DeepSettings {
    fn default() -> Self {
        Self { sub_texels: 4, nodes: 7, error: 1.0 / 8.0 }
    }
}

impl DeepSettings {
    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let Self { sub_texels, nodes, error } = *self;
        if !matches!(sub_texels, 2 | 4 | 8) {
            return Err(Error::Config(format!(
                "deep: {sub_texels} x {sub_texels} sub-texels; 2, 4 and 8 a side are possible"
            )));
        }
        if !(3..=MOST_NODES).contains(&nodes) {
            return Err(Error::Config(format!("deep: {nodes} nodes a texel; 3 to {MOST_NODES} are possible")));
        }
        if !(0.0..=0.5).contains(&error) {
            return Err(Error::Config(format!("deep: an error of {error} of the light; 0 to 0.5 are possible")));
        }
        Ok(())
    }
}

impl From<DeepSettings> for DeepMapOptions {
    fn from(settings: DeepSettings) -> Self {
        let DeepSettings { sub_texels, nodes, error } = settings;
        Self { sub_texels, nodes, error }
    }
}

/// Checks how many texels a side are asked around a sample's.
fn check_lookups(lookups: u32) -> Result<()> {
    if !matches!(lookups, 1 | 3 | 5 | 7) {
        return Err(Error::Config(format!("{lookups} x {lookups} look-ups; 1, 3, 5 and 7 are possible")));
    }
    Ok(())
}

/// Options of the methods that compare depths: which depth of a texel they compare, and the bias, without which a surface shadows itself
/// where that is the nearest. `shadow-map`, `silhouette-map`, `deep`, `trapezoidal`, `lispsm`, `perspective` and `parallel-split` take both parts of the bias, `pcf`, `smsr`, `variance`
/// and `remix` the constant alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowMapSettings {
    /// Texels a side of the filter of `pcf`: 2, 3, 5 or 7.
    pub kernel: u32,
    /// In place of these texels a disc of taps around the sample (`pcf`).
    pub disc: Option<DiscFilter>,
    /// The depth of a texel that is compared, which then takes the place of the bias; `None`: the nearest, with the bias. Of all that compare
    /// single depths, so of none that filters moments.
    pub compared: Option<DepthRule>,
    /// Depth that a receiver is moved towards the light; depth 1 is the extent of the casters along the light.
    pub constant: f32,
    /// Times the steeper slope of the receiver per texel: what it is moved besides, by the methods that take both parts.
    pub slope: f32,
}

/// Taps in a disc, in no pattern: single texels at places around a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscFilter {
    /// How many: 1 to [`MOST_TAPS`].
    pub taps: u32,
    /// Radius of the disc, texels: 0 to [`DiscFilter::WIDEST`].
    pub radius: f32,
    /// Whether each pixel has the disc at an angle of its own, which makes noise of what would be bands.
    pub turned: bool,
}

impl DiscFilter {
    /// The greatest radius, texels.
    pub const WIDEST: f32 = 16.0;
}

impl Default for DiscFilter {
    fn default() -> Self {
        Self { taps: 9, radius: 1.5, turned: false }
    }
}

impl Default for ShadowMapSettings {
    fn default() -> Self {
        Self { kernel: 3, disc: None, compared: None, constant: 5e-5, slope: 1.05 }
    }
}

impl ShadowMapSettings {
    /// Constant and slope of the bias that a depth of a map is compared with: 0 where [another](ShadowMapSettings::compared) takes its place.
    pub fn bias(&self) -> [f32; 2] {
        if self.compared.is_some() { [0.0; 2] } else { [self.constant, self.slope] }
    }

    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        if !matches!(self.kernel, 2 | 3 | 5 | 7) {
            return Err(Error::Config(format!("pcf: a kernel of {0} x {0}; 2, 3, 5 and 7 are possible", self.kernel)));
        }
        if let Some(DiscFilter { taps, radius, .. }) = self.disc {
            let (most, widest) = (MOST_TAPS, DiscFilter::WIDEST);
            if !(1..=most).contains(&taps) || !(0.0..=widest).contains(&radius) {
                return Err(Error::Config(format!(
                    "pcf: {taps} taps in a disc of {radius} texels; 1 to {most} in 0 to {widest} are possible"
                )));
            }
        }
        if let Some(DepthRule::Dual(farthest)) = self.compared
            && !(0.0..=1.0).contains(&farthest)
        {
            return Err(Error::Config(format!("a depth of {farthest} beyond the nearest; 0 to 1 are possible")));
        }
        let Self { constant, slope, .. } = *self;
        if !(0.0..=1.0).contains(&constant) || !(0.0..=100.0).contains(&slope) {
            return Err(Error::Config(format!(
                "a bias of {constant} and {slope} slopes; 0 to 1 and 0 to 100 are possible"
            )));
        }
        Ok(())
    }
}

/// How `smsr` draws the staircase borders of a map anew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SmsrShape {
    /// From the corners of dark texels to the far ends of borders (Bondarev 2014): shadows only grow.
    Corners,
    /// Through the middles of the steps, on both sides of the border (the patterns of Jimenez et al. 2011, which Bondarev, section
    /// 5.3, misses).
    #[default]
    Midpoints,
}

/// Options of `smsr`, whose bias is [`ShadowMapSettings::constant`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmsrSettings {
    /// Where lines run.
    pub shape: SmsrShape,
    /// Texels to either side that a border is followed: 1 to [`SmsrSettings::LONGEST`]. The paper's
    /// timings are with 8 (its largest search distance).
    pub reach: u32,
    /// Times the steeper slope of the receiver, for each texel away from the pixel: what the receiver is moved towards the light
    /// besides [`ShadowMapSettings::constant`].
    pub slope: f32,
}

impl Default for SmsrSettings {
    fn default() -> Self {
        Self { shape: SmsrShape::default(), reach: 16, slope: 0.5 }
    }
}

impl SmsrSettings {
    /// The longest reach, texels.
    pub const LONGEST: u32 = 64;

    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let (reach, longest) = (self.reach, Self::LONGEST);
        if !(1..=longest).contains(&reach) {
            return Err(Error::Config(format!("smsr: a reach of {reach} texels; 1 to {longest} are possible")));
        }
        if !(0.0..=100.0).contains(&self.slope) {
            return Err(Error::Config(format!("smsr: a bias of {} slopes a texel; 0 to 100 are possible", self.slope)));
        }
        Ok(())
    }
}

/// Options of the methods that filter maps by their moments, whose bias is [`ShadowMapSettings::constant`]: `variance`, `layered-variance`,
/// `convolution`, `exponential`, `exponential-variance`, `four-moments` and `remix`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentSettings {
    /// Share of light that is taken off against leaks; 0 in the papers.
    pub bleeding: f32,
    /// Degrees of elevation of the light over a surface below which half of it is taken as lit (Oliveira, section 4.2.2: 5); 0 for none.
    pub grazing: f32,
    /// Exponent of `exponential` and `exponential-variance` over the depths from the light to beyond the farthest caster: 1 to
    /// [`MomentMeasures::STEEPEST`].
    pub exponent: f32,
    /// Layers of depth of `layered-variance`: 2 to [`MomentMeasures::LAYERS`].
    pub layers: u32,
    /// Terms of the series of `convolution`: 1 to [`MomentMeasures::TERMS`].
    pub terms: u32,
}

impl Default for MomentSettings {
    fn default() -> Self {
        Self { bleeding: 0.0, grazing: 0.0, exponent: 40.0, layers: 4, terms: MomentMeasures::TERMS }
    }
}

impl MomentSettings {
    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let Self { bleeding, grazing, exponent, layers, terms } = *self;
        let refuse = |text: String| Err(Error::Config(text));
        if !(0.0..=0.9).contains(&bleeding) {
            return refuse(format!("{bleeding} of the light taken off against leaks; 0 to 0.9 are possible"));
        }
        if !(0.0..=90.0).contains(&grazing) {
            return refuse(format!("surfaces under {grazing} degrees half lit; 0 to 90 are possible"));
        }
        let steepest = MomentMeasures::STEEPEST;
        if !(1.0..=steepest).contains(&exponent) {
            return refuse(format!("an exponent of {exponent}; 1 to {steepest} are possible"));
        }
        let most = MomentMeasures::LAYERS;
        if !(2..=most).contains(&layers) {
            return refuse(format!("{layers} layers of depth; 2 to {most} are possible"));
        }
        let most = MomentMeasures::TERMS;
        if !(1..=most).contains(&terms) {
            return refuse(format!("{terms} terms of a series; 1 to {most} are possible"));
        }
        Ok(())
    }
}
