//! How pixels ask the light's texels: parts of methods.

/// How a pixel asks the light's texels. It works in any views of the light, warped or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelQuery {
    /// Facets against the casters of their texels.
    Facets,
    /// Borders of the closest triangles around.
    Triangles,
    /// The triangles that are nearest at the centres of the texels around.
    Centres,
    /// Whose polygon is nearest at the centres of texels.
    Polygons,
    /// The light that the texels around let pass to each depth.
    Deep,
    /// Nearest depths, and between them points of the silhouette.
    Silhouettes,
    /// Nearest depths.
    Map(MapQuery),
    /// Nearest depths, of a level of its own.
    Pages,
    /// Nearest depths, of texels as wide as a function of either axis makes them.
    Axes,
    /// No texels: rays.
    Rays,
    /// Every sample, kept by its texel, against every caster there.
    Samples,
}

/// How a map of nearest depths is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapQuery {
    /// Every sample with its texel.
    Nearest,
    /// Every sample with a box of texels.
    Filtered,
    /// Every sample with its texel, whose borders are drawn anew.
    Revectorized,
    /// The pixel's footprint with mean and variance of the depths in it.
    Moments,
    /// The same in layers of depth.
    LayeredMoments,
    /// The same with the means of sines and cosines of them.
    Waves,
    /// The same with the mean of an exponential of them.
    Exponentials,
    /// The same with mean and variance of a rising and a falling exponential of them.
    ExponentialMoments,
    /// The same with the first four moments of them.
    FourMoments,
}

impl MapQuery {
    /// Whether single depths are compared, which may be others than the nearest ([`ShadowMapSettings::compared`](super::ShadowMapSettings::compared)).
    pub fn compares_depths(self) -> bool {
        matches!(self, Self::Nearest | Self::Filtered | Self::Revectorized)
    }
}
