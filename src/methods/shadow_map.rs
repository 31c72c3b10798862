//! A map of nearest depths, asked four ways: by comparing every sample with its texel (`shadow-map`: Williams 1978), with a box of texels
//! or the taps of a disc (`pcf`: Reeves, Salesin, Cook 1987), with borders drawn anew (`smsr`: Bondarev 2014), or by the moments of the depths in the pixel's
//! footprint (`variance`: Donnelly, Lauritzen 2006), or of exponentials of them (`exponential`: Annen et al. 2008; `exponential-variance`:
//! Lauritzen, McCool 2008), or by four moments (`four-moments`: Peters, Klein 2015).
//!
//! In slices and warps of its own the first is `trapezoidal` (Martin, Tan 2004), `lispsm` (Wimmer, Scherzer, Purgathofer 2004),
//! `perspective` (Stamminger, Drettakis 2002) or `parallel-split` (Zhang et al. 2006), and the last `remix` (Oliveira 2009): see [`MethodRow::partition`](super::MethodRow::partition).
//! The first three may compare another depth than the nearest: [`ShadowMapSettings::compared`].
//! Memory is fixed: 4 bytes a texel, where another depth is compared 8, of moments 2.7 more, of two exponentials or four moments 5.3.

use super::debug_views::DebugViews;
use super::fixed_memory::{AskedViews, FixedMethod, FrameInputs, MethodParts, StageInputs};
use super::names::MapQuery;
use super::settings::{DiscFilter, MomentSettings, Settings, ShadowMapSettings, SmsrSettings, SmsrShape};
use crate::gpu::{Buffer, Gpu, Recorder, Uploads};
use crate::light_view::OmniMaps;
use crate::stages::PrimaryHits;
use crate::stages::compared_depths::ComparedDepths;
use crate::stages::light_layers::{Layers, LightLayers};
use crate::stages::map_moments::{MapLevels, MapMoments, MomentMeasures};
use crate::stages::moment_shadows::{MapWithMoments, MomentShadows, MomentShadowsOptions};
use crate::stages::paraboloid_casters::{CurvedWork, ParaboloidCasters};
use crate::stages::shadow_map::{ShadowMap, ShadowMapOptions};
use crate::stages::smsr::{Smsr, SmsrOptions};
use crate::tap_disc::{DiscWords, disc_words};
use crate::{Error, Result};

/// Where the texels lie that casters come to.
#[derive(Debug)]
enum Casters {
    Plane(LightLayers),
    Paraboloid(Box<(ParaboloidCasters, CurvedWork)>),
}

#[derive(Debug)]
enum Ask {
    Depths(Box<OfDepths>),
    Borders(Smsr),
    Moments(Box<OfMoments>),
}

#[derive(Debug)]
struct OfDepths {
    compare: ShadowMap,
    taps: DiscWords,
    disc: Buffer<[f32; 4]>,
}

#[derive(Debug)]
struct OfMoments {
    reduce: MapMoments,
    levels: Buffer<MapLevels>,
    moments: Buffer<[f32; 2]>,
    filter: MomentShadows,
}

impl Ask {
    fn new(device: &wgpu::Device, settings: &Settings, query: MapQuery) -> Result<Self> {
        let ShadowMapSettings { kernel, disc, .. } = settings.shadow_map;
        let [constant, slope] = settings.shadow_map.bias();
        let depths = |options, taps: DiscWords| {
            let disc = Buffer::uniform(device, "shadow_map.disc", taps.len())?;
            Ok::<_, Error>(Self::Depths(Box::new(OfDepths { compare: ShadowMap::new(device, options), taps, disc })))
        };
        let plain = ShadowMapOptions { kernel: 1, constant, slope, receiver_plane: false, taps: 0, turned: false };
        let filter = ShadowMapOptions { kernel, slope: 0.0, receiver_plane: true, ..plain };
        Ok(match (query, disc) {
            (MapQuery::Nearest, _) => depths(plain, DiscWords::default())?,
            (MapQuery::Filtered, None) => depths(filter, DiscWords::default())?,
            (MapQuery::Filtered, Some(DiscFilter { taps, radius, turned })) => {
                depths(ShadowMapOptions { taps, turned, ..filter }, disc_words(taps, radius))?
            }
            (MapQuery::Revectorized, _) => {
                let SmsrSettings { shape, reach, slope } = settings.smsr;
                let midpoints = shape == SmsrShape::Midpoints;
                Self::Borders(Smsr::new(device, SmsrOptions { reach, midpoints, constant, slope }))
            }
            _ => {
                let constant = settings.shadow_map.constant;
                let MomentSettings { bleeding, grazing, exponent, layers, terms } = settings.moments;
                let measures = match query {
                    MapQuery::Exponentials => MomentMeasures::Rising(exponent),
                    MapQuery::ExponentialMoments => MomentMeasures::Both(exponent),
                    MapQuery::FourMoments => MomentMeasures::Four,
                    MapQuery::LayeredMoments => MomentMeasures::Layers(layers),
                    MapQuery::Waves => MomentMeasures::Waves(terms),
                    _ => MomentMeasures::Depths,
                };
                let grazing = grazing.to_radians().sin();
                let options = MomentShadowsOptions { constant, bleeding, grazing, measures };
                let reduce = MapMoments::new(device, measures);
                Self::Moments(Box::new(OfMoments {
                    levels: Buffer::uniform(device, "map_moments.levels", 1)?,
                    moments: reduce.memory(device, settings.map)?,
                    reduce,
                    filter: MomentShadows::new(device, options),
                }))
            }
        })
    }
}

/// One of the methods for one image, map and setting.
#[derive(Debug)]
pub struct ShadowMapping {
    /// Texels around a place that are asked.
    reach: f32,
    /// Texels of the map a side.
    size: u32,
    casters: Casters,
    compared: Option<ComparedDepths>,
    map: Layers,
    ask: Ask,
    visibility: Buffer<f32>,
}

impl ShadowMapping {
    /// Builds pipelines and memory.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for impossible settings; as [`Buffer::storage`].
    pub fn new(parts: MethodParts, query: MapQuery) -> Result<Self> {
        let MethodParts { device, queue, casters, settings, .. } = parts;
        settings.check()?;
        let compared = settings.shadow_map.compared.filter(|_| query.compares_depths());
        let size = settings.map as usize;
        let layers = if compared.is_some() { LightLayers::without_marks } else { LightLayers::nearest_only };
        Ok(Self {
            reach: match query {
                MapQuery::Nearest => 1.0,
                MapQuery::Filtered => {
                    let ShadowMapSettings { kernel, disc, .. } = settings.shadow_map;
                    disc.map_or(0.5 * kernel as f32, |disc| disc.radius) + 1.0
                }
                _ => 2.0,
            },
            size: settings.map,
            casters: match settings.omni {
                OmniMaps::Planes => Casters::Plane(layers(device, settings.alpha_tested)),
                OmniMaps::Paraboloids => {
                    let work = CurvedWork::new(device, queue, casters.triangles.len(), settings.map)?;
                    Casters::Paraboloid(Box::new((ParaboloidCasters::new(device, settings.alpha_tested), work)))
                }
            },
            map: if compared.is_some() {
                Layers::without_marks(device, size)?
            } else {
                Layers::nearest_only(device, size)?
            },
            compared: compared.map(|rule| ComparedDepths::new(device, rule)),
            ask: Ask::new(device, settings, query)?,
            visibility: Buffer::storage(device, "shadow_map.visibility", settings.pixels())?,
        })
    }

    /// The map: the depths that are compared, complements of their bits.
    pub fn map(&self) -> &Layers {
        &self.map
    }
}

impl FixedMethod for ShadowMapping {
    fn asks(&self) -> AskedViews {
        AskedViews::One(self.reach)
    }

    fn projects_casters(&self) -> bool {
        matches!(self.casters, Casters::Plane(_))
    }

    fn upload(&self, uploads: &mut Uploads, of: FrameInputs) -> Result<()> {
        match &self.ask {
            Ask::Depths(ask) => uploads.write(&ask.disc, &ask.taps),
            Ask::Borders(_) => {}
            Ask::Moments(of_moments) => {
                let FrameInputs { view, bounds, frame, .. } = of;
                let far = MapLevels::farthest(view, frame.light[3] == 0.0, bounds);
                uploads.write(&of_moments.levels, &[MapLevels::new(self.size, far)]);
            }
        }
        Ok(())
    }

    fn record(&self, rec: &mut Recorder, inputs: StageInputs) -> Result<()> {
        let (frame, geometry) = (inputs.frame, inputs.geometry);
        let (nearest_keys, visibility) = (&self.map.nearest_keys, &self.visibility);
        rec.clear(nearest_keys.raw());
        rec.clear(self.map.second_keys.raw());
        match &self.casters {
            Casters::Plane(layers) => {
                let blocks = geometry.in_light(inputs.casters);
                layers.record(&mut rec.stage("light_layers"), frame, blocks, &self.map);
            }
            Casters::Paraboloid(of) => {
                let (casters, work) = &**of;
                let mesh = (&inputs.casters.triangles, &geometry.points);
                let stage = &mut rec.stage("paraboloid_casters");
                casters.record(stage, frame, mesh, work, (nearest_keys, self.size))?;
            }
        }
        if let Some(compared) = &self.compared {
            compared.record(&mut rec.stage("compared_depths"), frame, &self.map, self.size);
        }
        let seen = PrimaryHits {
            samples: inputs.samples,
            id_keys: inputs.id_keys,
            triangles: &inputs.casters.triangles,
            points: &geometry.points,
        };
        match &self.ask {
            Ask::Depths(ask) => {
                let stage = &mut rec.stage("shadow_map");
                ask.compare.record(stage, frame, seen, (nearest_keys, &ask.disc), visibility);
            }
            Ask::Borders(ask) => ask.record(&mut rec.stage("smsr"), frame, seen, nearest_keys, visibility),
            Ask::Moments(of_moments) => {
                let OfMoments { reduce, levels, moments, filter } = &**of_moments;
                reduce.record(&mut rec.stage("map_moments"), frame, levels, nearest_keys, moments, self.size);
                let map = MapWithMoments { levels, nearest_keys, moments };
                filter.record(&mut rec.stage("moment_shadows"), frame, seen, map, visibility);
            }
        }
        Ok(())
    }

    fn visibility(&self) -> &Buffer<f32> {
        &self.visibility
    }

    fn looks(&self, gpu: &Gpu) -> Result<Option<DebugViews>> {
        DebugViews::of_depths(gpu, &self.map).map(Some)
    }
}
