//! Options of a frame: as the command line takes them, a frame.json records them, and the viewer changes them.

mod choices;
mod recorded;

pub use choices::{
    Compare, DensityBy, Encoding, EngineName, FacetsPerPixel, FilterBy, MaskChoice, OmniBy, PagesBy, PairsBy,
    PartitionBy, PatternName, Projection, RayChoice, Search, Shape, Switch, WarpBy,
};
pub use recorded::{camera_text, is_on_line, light_text, parsed, reason, refusal};

use crate::scene::{Scene, SceneOptions, light_from_text};
use clap::{Args, Parser};
use std::path::PathBuf;
use subpixel_shadows::light_view::{PartBy, SplitPlan, Warp};
use subpixel_shadows::mask_table::MaskVariant;
use subpixel_shadows::methods::facet_masks::{PairVariant, Settings};
use subpixel_shadows::methods::{
    AxisSettings, DeepSettings, DiscFilter, HistorySettings, MethodName, MomentSettings, PageSettings,
    PolygonIdSettings, ProjectionVariant, RayTracedSettings, ReconstructableSettings, ShadowMapSettings, SmsrSettings,
    SmsrShape, SpsmEncoding, SpsmSettings,
};
use subpixel_shadows::render::Budget;
use subpixel_shadows::samples::Samples;
use subpixel_shadows::scene::{AreaLight, Light, Mesh};
use subpixel_shadows::{Error, Result};

/// The built-in scene that is opened where none is named.
pub const DEFAULT_SCENE: &str = "windmill";

/// A scene and options: the arguments of `render` and `explain`.
#[derive(Clone, Debug, Parser)]
#[command(name = "subpixel-shadows")]
pub struct FrameArguments {
    /// Built-in scene, or a .glb, .gltf, .obj, .ply or .toml file [default: windmill]
    pub scene: Option<String>,
    /// Options.
    #[command(flatten)]
    pub options: RenderOptions,
}

/// The options of `render` and `explain`.
#[derive(Clone, Debug, Args)]
pub struct RenderOptions {
    /// Shadow method
    #[arg(long, default_value = "facet-masks", value_name = "NAME", value_parser = method_name)]
    pub method: MethodName,
    /// Facets per pixel of facet-masks: one, as in the paper, or one for every surface that its samples see
    #[arg(long, value_enum, default_value_t, value_name = "HOW_MANY")]
    pub facets: FacetsPerPixel,
    /// Samples per pixel: 1, 8, 16, 32, 64 or 128
    #[arg(long, default_value_t = 32, value_name = "N")]
    pub samples: u32,
    /// Where the samples of a pixel lie
    #[arg(long, value_enum, default_value_t)]
    pub pattern: PatternName,
    /// Light-view map size, texels a side
    #[arg(long, default_value_t = 512, value_name = "N")]
    pub map: u32,
    /// Image size, pixels
    #[arg(long, default_value = "800x600", value_name = "WxH", value_parser = size)]
    pub size: [u32; 2],
    /// Keep the validity mask, which drops samples that see another surface than the pixel centre
    #[arg(long, value_enum, default_value_t, value_name = "SWITCH")]
    pub validity: Switch,
    /// How spsm packs a triangle into a texel: the paper's code, or edge lines
    #[arg(long, value_enum, default_value_t, value_name = "CODE")]
    pub encoding: Encoding,
    /// Texels that spsm searches around a sample's: near (3 x 3), wide (5 x 5), or along (3 x 3, and two more to either side
    /// along the shadow's border)
    #[arg(long, value_enum, default_value_t, value_name = "WHERE")]
    pub search: Search,
    /// Judge what no triangle around covers by the border that their edges link (spsm); without, it is lit
    #[arg(long, value_enum, default_value_t, value_name = "SWITCH")]
    pub recovery: Switch,
    /// Power by which the paper's code of spsm keeps slopes: 1 for even steps of the angle, 3, 5 (the paper's), 7 or 9
    #[arg(long, default_value_t = 5, value_name = "N")]
    pub slope_power: u32,
    /// Texels a side around a sample's that are asked, 1, 3, 5 or 7: by reconstructable for the triangles that they keep, by polygon-ids for one that
    /// keeps the receiver's polygon [default: 5 of reconstructable, 1 of polygon-ids]
    #[arg(long, value_name = "N")]
    pub lookups: Option<u32>,
    /// Rays of ray-traced: from all pixels, or from those that are not proved lit or shadowed
    #[arg(long, value_enum, default_value_t, value_name = "WHICH")]
    pub rays: RayChoice,
    /// Texels a side of the filter of pcf: 2, 3, 5 or 7
    #[arg(long, default_value_t = 3, value_name = "N")]
    pub kernel: u32,
    /// Taps of pcf in a disc around the sample in place of its square, 1 to 64, spread evenly and in no pattern; 0 for the square
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub taps: u32,
    /// Radius of that disc, texels: 0 to 16
    #[arg(long, default_value_t = 1.5, value_name = "TEXELS")]
    pub radius: f32,
    /// Turn that disc by an angle of each pixel's own
    #[arg(long, value_enum, default_value_t = Switch::Off, value_name = "SWITCH")]
    pub turned: Switch,
    /// The depth of a texel that samples are compared with by the methods of single depths: the nearest with a bias, or without one half way
    /// to the second, the second, or half way but not far beyond the nearest
    #[arg(long, value_enum, default_value_t, value_name = "DEPTH")]
    pub compare: Compare,
    /// Depth by which a receiver is moved towards the light before it is compared; 1 is the extent of the casters along the light
    #[arg(long, default_value_t = 5e-5, value_name = "DEPTH")]
    pub bias: f32,
    /// Times its steeper slope per texel by which a receiver is moved besides
    #[arg(long, default_value_t = 1.05, value_name = "TIMES")]
    pub slope_bias: f32,
    /// Sub-texels a side of a texel of deep, each with a depth of its own: 2, 4 or 8
    #[arg(long, default_value_t = 4, value_name = "N")]
    pub sub_texels: u32,
    /// Nodes at most of the light of a texel over depth (deep): 3 to 15
    #[arg(long, default_value_t = 7, value_name = "N")]
    pub nodes: u32,
    /// Share of light by which the lines between those nodes may be off the sub-texels: 0 to 0.5; more where they do not suffice
    #[arg(long, default_value_t = 0.125, value_name = "SHARE")]
    pub error: f32,
    /// How smsr draws the steps of a map anew: from corners, as in the paper, or through the middles of the steps
    #[arg(long, value_enum, default_value_t, value_name = "WHERE")]
    pub shape: Shape,
    /// Texels to either side that smsr follows a border, its search distance: 1 to 64
    #[arg(long, default_value_t = 16, value_name = "N")]
    pub reach: u32,
    /// Parts of what the camera sees, each with a view of the light: slices by depth, or by the faces of the view frustum that light passes,
    /// one to four
    #[arg(long, value_enum, default_value_t, value_name = "PARTS")]
    pub partition: PartitionBy,
    /// Slices of what the camera sees, each with a view of the light, 1 to 4: 3 of parallel-split and remix if nothing is said, of the
    /// others one view for all, or with a warp one slice
    #[arg(long, value_name = "N")]
    pub splits: Option<u32>,
    /// Where slices end: 1 for depths that grow by a factor, 0 for slices of one length, 0.5 for the mean of both
    #[arg(long, default_value_t = 0.5, value_name = "SHARE")]
    pub split_weight: f64,
    /// How the texels of a map lie over its slice: evenly, evenly and standing while the camera moves, over a trapezoid by the 80 % rule, by light-space perspective, by that from the
    /// eye itself, or as makes them smallest beside pixels [default: fitted]
    #[arg(long, value_enum, value_name = "HOW")]
    pub warp: Option<WarpBy>,
    /// Share of a slice's depth, nearest the eye, that gets 80 % of a trapezoid's rows (trapezoidal, --warp trapezoid)
    #[arg(long, default_value_t = 0.6, value_name = "SHARE")]
    pub focus: f64,
    /// Maps of a light at a point: on planes, one or around a light among its casters those of a cube; or on one or two paraboloids
    #[arg(long, value_enum, default_value_t, value_name = "MAPS")]
    pub omni: OmniBy,
    /// Share of light that the methods of moments take off against leaks; 0 as in the papers, up to 0.9
    #[arg(long, default_value_t = 0.0, value_name = "SHARE")]
    pub bleeding: f32,
    /// Degrees of elevation of the light over a surface below which the methods of moments take half of it as lit: 5 in the
    /// paper of remix, 0 for none
    #[arg(long, default_value_t = 0.0, value_name = "DEGREES")]
    pub grazing: f32,
    /// Exponent over the depths of a map (exponential, exponential-variance): 1 to 42; the steeper, the less light leaks, and the narrower are
    /// what it filters
    #[arg(long, default_value_t = 40.0, value_name = "C")]
    pub exponent: f32,
    /// Layers of depth of layered-variance: 2 to 8; the more, the less light leaks
    #[arg(long, default_value_t = 4, value_name = "N")]
    pub layers: u32,
    /// Terms of the series of convolution: 1 to 16; the more, the nearer to casters shadows begin
    #[arg(long, default_value_t = 16, value_name = "N")]
    pub terms: u32,
    /// Frames, each with the light's texels elsewhere, of which each is mixed into those before where it is surest (temporal reprojection); 1 for
    /// none. Of methods of maps of depths
    #[arg(long, default_value_t = 1, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub history: u32,
    /// Power by which frames of a history count the more the nearer a place lies to its texel's centre: 1 to 64
    #[arg(long, default_value_t = HistorySettings::POWER, value_name = "N")]
    pub confidence_power: u32,
    /// Pages of 32 x 32 texels of resolution-matched, 4 KiB each: 1 to 32768 [default: as many texels as the map has]
    #[arg(long, value_name = "N")]
    pub pages: Option<u32>,
    /// Levels of pages beyond that whose texels are no longer than a pixel on its receiver (resolution-matched): 0 to 4
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub finer: u32,
    /// Rule by which pages of resolution-matched are asked for: by pixels, by those near silhouettes (adaptive shadow maps), by cells of the view (fitted virtual shadow maps), by shares for them (tiled shadow maps), or by what finer ones change (queried virtual shadow maps)
    #[arg(long, value_enum, default_value_t, value_name = "BY")]
    pub page_rule: PagesBy,
    /// Pixels that have to change in a page for a finer one, by `--page-rule queried`
    #[arg(long, default_value_t = PageSettings::CHANGED, value_name = "N")]
    pub changed: u32,
    /// Rule for the width of texels along either axis of rectilinear: the pixels that want the most of an axis, or its distance from the eye
    #[arg(long, value_enum, default_value_t, value_name = "BY")]
    pub density: DensityBy,
    /// How many times narrower than those of an even map texels of rectilinear may be: 2 to 256
    #[arg(long, default_value_t = AxisSettings::STRETCH, value_name = "N")]
    pub stretch: u32,
    /// How half-planes become masks: every sample tested, or looked up in a table of 256 directions and distances
    #[arg(long, value_enum, default_value_t, value_name = "VARIANT")]
    pub masks: MaskChoice,
    /// How facet-masks brings pairs together: by tiles of 2 x 2 texels or by texels, counted and written to their places, or by
    /// texels sorted, as in the paper
    #[arg(long, value_enum, default_value_t, value_name = "VARIANT")]
    pub pairs: PairsBy,
    /// How facet-masks turns shadows into lines of the image: planes through the eye, or the paper's two projections, which
    /// bound no rounding
    #[arg(long, value_enum, default_value_t, value_name = "VARIANT")]
    pub projection: Projection,
    /// How facet-masks weighs the samples around a pixel into its visibility: a box of its own, or a filter that reaches its neighbours'
    #[arg(long, value_enum, default_value_t, value_name = "FILTER")]
    pub filter: FilterBy,
    /// Everything as in the frame of a frame.json: the picture is the same bit for bit. Scene and options beside it override
    #[arg(long, value_name = "FRAME.json")]
    pub from: Option<PathBuf>,
    /// Where to compute; without an adapter, and if not asked for, the CPU takes over and says so [default: gpu]
    #[arg(long, value_enum)]
    pub engine: Option<EngineName>,
    /// Pick an adapter whose name contains TEXT
    #[arg(long, value_name = "TEXT")]
    pub adapter: Option<String>,
    /// eye=X,Y,Z;target=X,Y,Z;up=X,Y,Z;fov=DEGREES;shift=X,Y;pixel_aspect=RATIO;mirrored=true;near_plane=A,B,C,D, each part optional
    #[arg(long, value_name = "PARTS")]
    pub camera: Option<String>,
    /// directional=X,Y,Z (towards the light), point=X,Y,Z, or spot=X,Y,Z;target=X,Y,Z;angle=DEGREES
    #[arg(long, value_name = "PARTS")]
    pub light: Option<String>,
    /// Radius of the light, whose shadows are then soft: world units, of a directional light degrees (the sun's is 0.27)
    #[arg(long, default_value_t = 0.0, value_name = "RADIUS")]
    pub light_radius: f64,
    /// Points of a light that has a radius: its visibility is the mean of theirs, and takes as long as so many lights
    #[arg(long, default_value_t = 16, value_name = "N")]
    pub light_points: u32,
    /// Add a ground plane under the scene
    #[arg(long)]
    pub ground: bool,
    /// Also compute facet truth and scene truth, and print the error
    #[arg(long)]
    pub truth: bool,
    /// With --truth, also the error against 1024 rays a pixel, in which that of the samples is included
    #[arg(long, requires = "truth")]
    pub converged: bool,
    /// Also write classes.png (what was known of each pixel) and light-view.png (the map), as far as the method has them
    #[arg(long)]
    pub looks: bool,
    /// Run every stage, also those the plan would leave out, and settle no pixel early
    #[arg(long)]
    pub force_all: bool,
    /// Frames that are timed, after one that is not: the times are their medians. No further one begins after 5 seconds
    #[arg(long, default_value_t = 3, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub frames: u32,
    /// MiB that the lists of pairs and candidates may take together; a frame that needs more is split into bands of facets
    #[arg(long, default_value_t = 1024, value_name = "MIB", value_parser = clap::value_parser!(u64).range(1..))]
    pub memory_limit: u64,
    /// Elements each list that may grow starts with [default: from the image size]
    #[arg(long, value_name = "N")]
    pub list_start: Option<usize>,
    /// Folder for the files that are written
    #[arg(long, default_value = "out", value_name = "DIR")]
    pub out: PathBuf,
    /// No progress, no notes
    #[arg(long)]
    pub quiet: bool,
}

/// The method of a name, for the command line.
///
/// # Errors
/// A line with all names.
pub fn method_name(text: &str) -> std::result::Result<MethodName, String> {
    let names = MethodName::ALL.map(MethodName::name);
    let found = MethodName::ALL.into_iter().find(|m| m.name() == text);
    found.ok_or_else(|| format!("no such method; there are {}", names.join(", ")))
}

/// Width and height of `WxH`.
///
/// # Errors
/// A line that says what is expected.
pub fn size(text: &str) -> std::result::Result<[u32; 2], String> {
    let (w, h) = text.split_once(['x', 'X']).ok_or("expected WIDTHxHEIGHT, such as 800x600")?;
    let side = |s: &str| s.parse::<u32>().map_err(|e| format!("'{s}': {e}"));
    Ok([side(w)?, side(h)?])
}

impl RenderOptions {
    /// Settings that are asked for; the plan may leave out more.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Config`] for impossible values.
    pub fn settings(&self) -> Result<Settings> {
        let samples = Samples::new(self.pattern.into(), self.samples)?;
        let encoding = match self.encoding {
            Encoding::Paper => SpsmEncoding::Paper,
            Encoding::Lines => SpsmEncoding::Lines,
        };
        let [radius, stretch] = match self.search {
            Search::Near => [1, 0],
            Search::Wide => [2, 0],
            Search::Along => [1, 2],
        };
        let settings = Settings {
            facets: self.facets.into(),
            validity: self.validity == Switch::On,
            cull_back: true,
            masks: match self.masks {
                MaskChoice::Exact => MaskVariant::Exact,
                MaskChoice::Table => MaskVariant::TABLE,
            },
            pairs: match self.pairs {
                PairsBy::Tiled => PairVariant::Tiled,
                PairsBy::Grouped => PairVariant::Grouped,
                PairsBy::Sorted => PairVariant::Sorted,
            },
            projection: match self.projection {
                Projection::Pencil => ProjectionVariant::Pencil,
                Projection::TwoStep => ProjectionVariant::TwoStep,
            },
            filter: self.filter.into(),
            spsm: SpsmSettings {
                encoding,
                exponent: self.slope_power,
                radius,
                stretch,
                recovery: self.recovery == Switch::On,
                ..SpsmSettings::default()
            },
            reconstructable: match self.lookups {
                Some(lookups) => ReconstructableSettings { lookups, ..ReconstructableSettings::default() },
                None => ReconstructableSettings::default(),
            },
            polygon_ids: self.lookups.map_or_else(PolygonIdSettings::default, |lookups| PolygonIdSettings { lookups }),
            deep: DeepSettings { sub_texels: self.sub_texels, nodes: self.nodes, error: self.error },
            smsr: SmsrSettings {
                shape: match self.shape {
                    Shape::Corners => SmsrShape::Corners,
                    Shape::Midpoints => SmsrShape::Midpoints,
                },
                reach: self.reach,
                ..SmsrSettings::default()
            },
            partition: self.parts(),
            omni: self.omni.into(),
            moments: MomentSettings {
                bleeding: self.bleeding,
                grazing: self.grazing,
                exponent: self.exponent,
                layers: self.layers,
                terms: self.terms,
            },
            pages: PageSettings {
                pages: self.pages,
                finer: self.finer,
                rule: self.page_rule.into(),
                changed: self.changed,
            },
            axes: AxisSettings { density: self.density.into(), stretch: self.stretch },
            ray_traced: RayTracedSettings { silhouettes: self.rays == RayChoice::Silhouettes },
            history: self.history(),
            shadow_map: ShadowMapSettings {
                kernel: self.kernel,
                disc: self.disc(),
                compared: self.compare.into(),
                constant: self.bias,
                slope: self.slope_bias,
            },
            ..Settings::new(self.size, self.map, samples)
        };
        settings.check()?;
        let (own, usual) = (settings.shadow_map, ShadowMapSettings::default());
        if own.compared.is_some() && [own.constant, own.slope] != [usual.constant, usual.slope] {
            let text = "another depth is compared in place of a bias: --compare goes without --bias and --slope-bias";
            return Err(Error::Config(text.to_owned()));
        }
        Ok(settings)
    }

    /// Taps in a disc.
    fn disc(&self) -> Option<DiscFilter> {
        let Self { taps, radius, turned, .. } = *self;
        (taps > 0).then_some(DiscFilter { taps, radius, turned: turned == Switch::On })
    }

    /// Texels a side around a sample's that its method asks.
    pub fn asked_texels(&self) -> u32 {
        self.lookups.unwrap_or(self.asked_by_default())
    }

    /// How many these are where nothing is said.
    pub fn asked_by_default(&self) -> u32 {
        match self.method {
            MethodName::PolygonIds => PolygonIdSettings::default().lookups,
            _ => ReconstructableSettings::default().lookups,
        }
    }

    /// Frames before that are kept.
    fn history(&self) -> Option<HistorySettings> {
        let Self { history: frames, confidence_power: power, .. } = *self;
        (frames > 1).then_some(HistorySettings { frames, power })
    }

    /// Parts of what the camera sees: those of the method, with what is said of them.
    fn parts(&self) -> Option<SplitPlan> {
        let own = self.method.row().partition;
        let by = PartBy::from(self.partition);
        let warp = self.warp.map(|warp| match warp {
            WarpBy::Even => Warp::Box,
            WarpBy::Stable => Warp::Stable,
            WarpBy::Trapezoid => Warp::Trapezoid,
            WarpBy::Lispsm => Warp::LightSpace,
            WarpBy::Perspective => Warp::Perspective,
            WarpBy::Fitted => Warp::Fitted,
        });
        (self.splits.is_some() || warp.is_some() || own.is_some() || by != PartBy::Depth).then(|| SplitPlan {
            by,
            splits: self.splits.or(own.map(|plan| plan.splits)).unwrap_or(1),
            warp: warp.or(own.map(|plan| plan.warp)).unwrap_or_default(),
            focus: self.focus,
            weight: self.split_weight,
        })
    }

    /// Opens a scene, `windmill` if none is named, with what the options change of it; and a line on what its file holds that is not read.
    ///
    /// # Errors
    /// As [`Scene::open`], and for a camera or light that cannot be read.
    pub fn open(&self, scene: Option<&str>) -> Result<(Scene, Option<String>)> {
        Scene::open_and_note(scene.unwrap_or(DEFAULT_SCENE), &self.of_scene()?)
    }

    /// Changes of a scene: ground, camera and light.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Scene`] for a camera or light that cannot be read.
    pub fn of_scene(&self) -> Result<SceneOptions> {
        Ok(SceneOptions {
            ground: self.ground,
            camera: self.camera.as_deref().map(str::parse).transpose()?,
            light: self.light.as_deref().map(light_from_text).transpose()?,
        })
    }

    /// The points of the light of a scene with these casters: itself where it has no radius.
    ///
    /// # Errors
    /// [`subpixel_shadows::Error::Scene`] for a radius or a number of points that cannot be, [`subpixel_shadows::Error::Config`] for `looks` of several.
    pub fn points(&self, light: &Light, casters: &Mesh) -> Result<Vec<Light>> {
        let Self { light_radius: radius, light_points: points, .. } = *self;
        let area = AreaLight { light: *light, radius, points };
        area.check()?;
        if radius == 0.0 {
            return Ok(vec![*light]);
        }
        if self.looks {
            return Err(Error::Config(format!(
                "--looks shows one point of a light, not {points} within a radius of {radius}"
            )));
        }
        let (low, high) = casters.bounds().unwrap_or_default();
        Ok(area.points(0.5 * (low + high)))
    }

    /// Memory of the lists.
    pub fn budget(&self) -> Budget {
        Budget { start: self.list_start, bytes: self.memory_limit.saturating_mul(1 << 20) }
    }
}
