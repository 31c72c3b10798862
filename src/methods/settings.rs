//! Uniform of a frame.

pub use super::axis_settings::{AxisSettings, DensityRule};
use super::history::HistorySettings;
pub use super::page_settings::PageSettings;
use super::prepared::Prepared;
pub use super::texel_settings::{
    DeepSettings, DiscFilter, MomentSettings, PolygonIdSettings, ReconstructableSettings, ShadowMapSettings,
    SmsrSettings, SmsrShape,
};
use crate::light_view::{LightView, MapTiles, OmniMaps, PartBy, Receivers, SplitPlan};
use crate::mask_table::MaskVariant;
use crate::pixel_filter::PixelFilter;
use crate::samples::Samples;
use crate::scene::{Camera, Light};
use crate::stages::pixel_texel_pairs::PairTiles;
use crate::{Error, Result};
use glam::DVec3;

/// How many facets a pixel has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FacetMode {
    /// One, for the surface at its centre (Pan 2009).
    One,
    /// One for each surface that its samples see. Their coverage replaces the validity mask.
    #[default]
    All,
}

/// How pairs are brought together by texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PairVariant {
    /// By tiles of 2 × 2 texels: counted, scanned, written to their places.
    #[default]
    Tiled,
    /// By texels: counted, scanned, written to their places.
    Grouped,
    /// By texels: listed as they come and sorted (Pan 2009, section 3.3).
    Sorted,
}

impl PairVariant {
    /// Where pairs meet.
    pub fn places(self) -> PairTiles {
        match self {
            Self::Tiled => PairTiles::Tiles,
            Self::Grouped | Self::Sorted => PairTiles::Texels,
        }
    }
}

/// How the shadow of a triangle on a facet becomes lines of the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectionVariant {
    /// From planes through the eye, without division; what single precision leaves open, 46 bits decide.
    #[default]
    Pencil,
    /// The triangle onto the facet's plane, then onto the screen, in single precision (Pan 2009, section 3.4). For
    /// comparison: it bounds no rounding.
    TwoStep,
}

/// How a texel of `spsm` packs a triangle into 128 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpsmEncoding {
    /// Lecocq 2013, section 3.3: three vertices of 2 × 16 bits over the map, 16 bits of depth at the texel's centre, two
    /// slopes of 8 bits through the arctangent.
    Paper,
    /// Three edge lines relative to the texel (12 bits of direction, 12 of distance), 24 bits of depth, two slopes of
    /// 16 bits. An edge keeps its place whatever the map's size and however far its vertices lie.
    #[default]
    Lines,
}

/// Options of `spsm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpsmSettings {
    /// How texels are packed.
    pub encoding: SpsmEncoding,
    /// Odd power `n` of the paper's slope code (equations 2 to 4), 1 to 9.
    pub exponent: u32,
    /// Depth by which a caster must lie before a receiver to shadow it, beyond what the code itself may be off; depth 1 is
    /// the extent of the casters along the light.
    pub bias: f32,
    /// Texels around the sample's own that are searched: 1 for 3 × 3 as in the paper, 2 for 5 × 5 (section 6.4).
    pub radius: u32,
    /// Texels beyond these that are searched along the border's tangents, to either side, 0 to 2: the anisotropic kernel of
    /// section 6.4, beside a radius of 1.
    pub stretch: u32,
    /// Whether what no triangle around a sample covers is judged by the border that their outer edges link (section 4.2). Without, as in the
    /// middle of figure 2, it is lit.
    pub recovery: bool,
    /// Make only the texels of the map that pixels ask for. The picture is the same; with a map of many more texels than the
    /// image has pixels it costs less, with others more.
    pub seen_only: bool,
}

impl Default for SpsmSettings {
    fn default() -> Self {
        Self {
            encoding: SpsmEncoding::Lines,
            exponent: 5,
            bias: 1e-5,
            radius: 1,
            stretch: 2,
            recovery: true,
            seen_only: true,
        }
    }
}

impl SpsmSettings {
    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        if !matches!(self.exponent, 1 | 3 | 5 | 7 | 9) {
            return Err(Error::Config(format!("spsm: exponent {}; 1, 3, 5, 7 and 9 are possible", self.exponent)));
        }
        if !(0.0..=1.0).contains(&self.bias) {
            return Err(Error::Config(format!("spsm: bias {}; 0 to 1 are possible", self.bias)));
        }
        if !matches!(self.radius, 1 | 2) {
            return Err(Error::Config(format!("spsm: search radius {}; 1 and 2 are possible", self.radius)));
        }
        if self.stretch > if self.radius == 1 { 2 } else { 0 } {
            let Self { radius, stretch, .. } = *self;
            return Err(Error::Config(format!(
                "spsm: {stretch} texels along the tangent beside a search radius of {radius}; up to 2 beside 1 are possible"
            )));
        }
        Ok(())
    }
}

/// Options of `ray-traced`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayTracedSettings {
    /// Trace only pixels that are not proved lit or shadowed by the light view of `facet-masks`, whose map's size then
    /// matters; else all that face the light. Without [`Settings::settle`] nothing is proved.
    pub silhouettes: bool,
}

/// Uniform of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Image width and height, pixels.
    pub size: [u32; 2],
    /// Light-view map, texels a side.
    pub map: u32,
    /// Sample pattern.
    pub samples: Samples,
    /// Facets of a pixel.
    pub facets: FacetMode,
    /// Keep the validity mask.
    pub validity: bool,
    /// Leave out casters of closed bodies that face away from the light, if it is outside all of these ([`LightView::outside`]). With
    /// validity masks those that may cut a facet stay.
    pub cull_back: bool,
    /// Leave out of the camera's view triangles of closed bodies that face away from it, if it is outside all of these: each lies behind
    /// one that does not. Without, such a triangle may show at samples that rounding puts on this side of a silhouette, where it passes
    /// for the nearer one. Of casters that stand.
    pub hide_backs: bool,
    /// Make no blocks of the light's maps but those that the facets ask for, where the camera may see but a part of the scene, and there are
    /// many triangles beside the pixels. Maps that are kept for frames to come are made whole.
    pub request_blocks: bool,
    /// Cut the light's views to what the camera may see in shadow, where they are made anew for a frame all the same, as of casters that move and of a light
    /// among its casters, or where that leaves less than a sixteenth of a view. The picture is the same. Of `facet-masks`, without a
    /// [partition](Settings::partition), which tells for all methods how views lie over what is seen.
    pub focus: bool,
    /// Fewest triangles of which those outside a view are left out [by clusters](crate::stages::cluster_culling), before each is looked at; of
    /// casters that are not in parts. The picture is the same.
    pub least_culled: usize,
    /// Triangles may be [alpha-tested](crate::scene::AlphaTested); of all methods but `spsm`. A pass of casters of which some are has it set, and so has a
    /// renderer; a pass that shall take such casters later needs it from the beginning.
    pub alpha_tested: bool,
    /// How the samples of a pixel, and with all but a box those of the pixels around it, are weighted into its visibility. Of `facet-masks`,
    /// whose lit masks are the same with each; others take a box.
    pub filter: PixelFilter,
    /// How half-planes become masks.
    pub masks: MaskVariant,
    /// How pairs are brought together by texel.
    pub pairs: PairVariant,
    /// How shadows become lines of the image.
    pub projection: ProjectionVariant,
    /// Slices of what the camera sees, each with a view of the light of its own, whose texels a warp may lay more densely near the eye; `None`:
    /// those of the [method](super::MethodRow::partition), for most one view for all; what makes a method what it is stays. It changes no decision of `facet-masks`: a facet is evaluated
    /// in the first view that holds all of it, else in all that it touches. A light among its casters has a cube of views instead. With the
    /// methods of one receiver a pixel each pixel asks the first view that holds it.
    pub partition: Option<SplitPlan>,
    /// Maps of a light at a point, of the methods that take the option.
    pub omni: OmniMaps,
    /// Settle facets before evaluation; without it all go the exact way.
    pub settle: bool,
    /// Count the work of each pixel ([`PixelCounts`](crate::stages::pixel_counts::PixelCounts)), for [`Target::counts`](crate::pass::Target::counts): of
    /// `facet-masks` all of it, of `ray-traced` and `supersampled` classes and facets, of `spsm` classes, with 0 or 1 facets; others have nothing to
    /// count. No picture changes.
    pub count_pixels: bool,
    /// Options of `spsm`.
    pub spsm: SpsmSettings,
    /// Options of `reconstructable`.
    pub reconstructable: ReconstructableSettings,
    /// Options of `polygon-ids`.
    pub polygon_ids: PolygonIdSettings,
    /// Options of `deep`.
    pub deep: DeepSettings,
    /// Options of `smsr`.
    pub smsr: SmsrSettings,
    /// Options of the methods that compare depths.
    pub shadow_map: ShadowMapSettings,
    /// Options of the methods that filter maps by their moments.
    pub moments: MomentSettings,
    /// Options of `resolution-matched`.
    pub pages: PageSettings,
    /// Options of `rectilinear`.
    pub axes: AxisSettings,
    /// Options of `ray-traced`.
    pub ray_traced: RayTracedSettings,
    /// Temporal reprojection, of the methods of maps of depths; `None`: each frame by itself.
    pub history: Option<HistorySettings>,
}

impl Settings {
    /// Fewer triangles are set up, all of them, in the time that finding those outside a view takes.
    pub const LEAST_CULLED: usize = 65_536;

    /// The light's view of a mesh, as tight as what may be in shadow allows. Apart from the first time, which makes
    /// a tree of the mesh, it takes no walk over all triangles, so a light may move from frame to frame.
    ///
    /// # Errors
    /// As [`LightView::fit`].
    pub fn light_view(&self, prepared: &Prepared, light: &Light) -> Result<LightView> {
        light.check()?;
        let (casting, all) = (prepared.casting(), prepared.casters());
        let fit = |receivers| LightView::fit_casters(casting, all, light, self.map, receivers);
        let outside = prepared.backs_add_nothing(light);
        let beyond = self.facets == FacetMode::One && self.samples.count() > 1;
        if beyond && !self.validity {
            let view = fit(Receivers::Anything)?;
            if view.complete {
                return Ok(LightView { outside, ..view });
            }
            // The light stands over a wide floor, say: no view holds all of that.
        }
        let receivers = match beyond {
            true => Receivers::Planes,
            false if outside && prepared.bodies.iter().all(|body| *body) => Receivers::Outsides,
            false => Receivers::Surfaces,
        };
        Ok(LightView { outside, ..fit(receivers)? })
    }

    /// The light's views of a mesh: one, or of a light that stands among its casters a [cube](LightView::cube) of them.
    ///
    /// # Errors
    /// As [`Settings::light_view`].
    pub fn light_views(&self, prepared: &Prepared, light: &Light) -> Result<Vec<LightView>> {
        let view = self.light_view(prepared, light)?;
        if view.complete {
            return Ok(vec![view]);
        }
        let cube = LightView::cube_of(prepared.casting(), light, self.map)?;
        Ok(cube.into_iter().map(|side| LightView { outside: view.outside, ..side }).collect())
    }

    /// These views of the light, or those of the [slices](Settings::partition) of what a camera sees between two corners of a box. `beyond`:
    /// receivers may lie outside that box. `one`: a pixel asks one view, so slices overlap. `depths`: view depths between which pixels see anything,
    /// where that is known; `objects`: boxes that hold all receivers, or none.
    pub fn in_slices(
        &self,
        views: Vec<LightView>,
        camera: &Camera,
        bounds: (DVec3, DVec3),
        (beyond, one): (bool, bool),
        depths: Option<[f32; 2]>,
        objects: &[(DVec3, DVec3)],
    ) -> Vec<LightView> {
        let (Some(plan), &[view]) = (&self.partition, &views[..]) else { return views };
        // A cone is cut no further.
        if !view.complete || view.one_of_several {
            return views;
        }
        let overlap = if one { LightView::OVERLAP } else { 0.0 };
        let mut slices = match (plan.by, objects) {
            (PartBy::ReceiverClusters, [_, ..]) => view.clusters(camera, self.size, bounds, plan, objects),
            _ => view.slices(camera, self.size, bounds, plan, overlap, depths),
        };
        // The whole view holds what no slice does: one facet a pixel goes on beyond what is seen, and of facets what comes nearer to a light
        // at a point than its view tells apart is on no map.
        if beyond || (view.perspective && !one) || (self.facets == FacetMode::One && self.samples.count() > 1) {
            slices.push(LightView { one_of_several: true, ..view });
        }
        slices
    }

    /// The settings of each of the views that a map is cut into.
    pub(crate) fn of_part(&self, parts: MapTiles) -> Self {
        Self { map: parts.texels(), ..self.clone() }
    }

    /// Whether frames tell between which depths pixels see triangles.
    pub(crate) fn tells_depths(&self) -> bool {
        self.partition.is_some_and(|plan| plan.by == PartBy::SeenDepth)
    }

    /// Whether validity masks are kept: of several samples in one facet.
    pub fn keeps_validity(&self) -> bool {
        self.validity && self.samples.count() > 1 && self.facets == FacetMode::One
    }

    /// Whether casters of closed bodies that face away from the light are left out of everything.
    pub fn leaves_backs_out(&self) -> bool {
        self.cull_back && !self.keeps_validity()
    }

    /// Refuses what goes with maps on planes alone.
    fn check_omni(&self) -> Result<()> {
        let refused = match self.omni {
            OmniMaps::Planes => None,
            OmniMaps::Paraboloids if self.partition.is_some() => Some("slices and warps are"),
            OmniMaps::Paraboloids if self.shadow_map.compared.is_some() => Some("another depth than the nearest is"),
            OmniMaps::Paraboloids if self.history.is_some() => Some("a history of frames is"),
            OmniMaps::Paraboloids => None,
        };
        match refused {
            Some(what) => Err(Error::Config(format!("paraboloid maps: {what} of maps on planes"))),
            None => Ok(()),
        }
    }

    /// Texels of the light-view map.
    pub fn texels(&self) -> usize {
        (self.map as usize).pow(2)
    }

    /// Pixels of the image.
    pub fn pixels(&self) -> usize {
        self.size.iter().map(|&s| s as usize).product()
    }

    /// The settings for an image of `size` pixels and a map of `map` texels a side: a facet for every surface, as in the program,
    /// exact masks, every facet settled early that can be, no caster left out. With [`FacetMode::One`] in place they are those of
    /// the paper, with validity masks.
    pub fn new(size: [u32; 2], map: u32, samples: Samples) -> Self {
        Self {
            size,
            map,
            samples,
            facets: FacetMode::default(),
            validity: true,
            cull_back: false,
            hide_backs: true,
            request_blocks: true,
            focus: true,
            least_culled: Self::LEAST_CULLED,
            alpha_tested: false,
            filter: PixelFilter::Box,
            masks: MaskVariant::Exact,
            pairs: PairVariant::default(),
            projection: ProjectionVariant::Pencil,
            partition: None,
            omni: OmniMaps::default(),
            settle: true,
            count_pixels: false,
            spsm: SpsmSettings::default(),
            reconstructable: ReconstructableSettings::default(),
            polygon_ids: PolygonIdSettings::default(),
            deep: DeepSettings::default(),
            smsr: SmsrSettings::default(),
            shadow_map: ShadowMapSettings::default(),
            moments: MomentSettings::default(),
            pages: PageSettings::default(),
            axes: AxisSettings::default(),
            ray_traced: RayTracedSettings::default(),
            history: None,
        }
    }

    /// Checks sizes, the table of masks and the options of all methods against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let [w, h] = self.size;
        if w == 0 || h == 0 || w > 16384 || h > 16384 {
            return Err(Error::Config(format!("an image of {w}x{h} pixels; sides of 1 to 16384 are possible")));
        }
        if !(1..=LightView::LARGEST_MAP).contains(&self.map) {
            return Err(Error::Config(format!(
                "a map of {} texels a side; 1 to {} are possible",
                self.map,
                LightView::LARGEST_MAP
            )));
        }
        if let MaskVariant::Table { angles, offsets } = self.masks {
            let most = MaskVariant::LARGEST;
            if !(1..=most).contains(&angles) || !(1..=most).contains(&offsets) {
                return Err(Error::Config(format!("a table of {angles} x {offsets} masks; 1 to {most} are possible")));
            }
        }
        self.partition.map_or(Ok(()), |plan| plan.check())?;
        self.check_omni()?;
        self.spsm.check()?;
        self.reconstructable.check()?;
        self.polygon_ids.check()?;
        self.deep.check()?;
        self.smsr.check()?;
        self.moments.check()?;
        self.history.map_or(Ok(()), |history| history.check())?;
        self.pages.check()?;
        self.axes.check()?;
        self.shadow_map.check()
    }
}
