//! Recording what an application's G-buffer says of the surfaces seen.

use super::casters::CasterSet;
use super::gbuffer::{GBuffer, SampleTexture, SurfacePosition, SurfaceTextures, TriangleTexture};
use super::textures::{all_layers, first_level};
use crate::Result;
use crate::frame::Frame;
use crate::gpu::{Buffer, Recorder, StagedUploads};
use crate::methods::every_surface::SampleIds;
use crate::methods::facet_masks::{Extent, FacetSource, MapSource};
use crate::methods::strip_method::StripMethod;
use crate::methods::{FacetMode, Settings};
use crate::stages::PrefixScan;
use crate::stages::gbuffer_triangles::{GbufferTriangles, SampleGbuffer, Texture, nearest_of};
use crate::stages::pixel_receivers::{
    GIVEN_IDS, GIVEN_NORMAL_SAMPLES, GIVEN_NORMALS, GIVEN_POSITIONS, GIVEN_SAMPLES, GivenTexture, MOST_STEPS,
    PixelReceivers, PixelReceiversParams, ReceiverKeys, ReceiverRoom, SeenCasters, Textures, unread_samples,
};
use crate::stages::surface_receivers::GivenSurfaces;
use crate::stages::triangle_ids::{self, TriangleIds};

/// The pipelines, and memory for an image.
pub struct GbufferStage {
    ids: TriangleIds,
    receivers: Option<Receivers>,
    /// With a facet for every surface.
    samples: Option<GbufferTriangles>,
}

/// Inputs of a strip of rows.
#[derive(Clone, Copy)]
pub struct With<'a> {
    pub method: &'a StripMethod,
    /// Width and height of the whole image.
    pub size: [u32; 2],
    pub casters: &'a CasterSet,
    pub faults: &'a Buffer<u32>,
    /// Whether the strip before has found what the light sees.
    pub maps: MapSource,
    /// How much of the method runs.
    pub extent: Extent,
    /// Whether the frame before found what pixels show, and kept it.
    pub kept: bool,
    /// Uniforms of further views of the light.
    pub further: &'a [StagedUploads],
}

/// Rows of neighbours on either side in which `pixel_receivers` looks for what a pixel shows, and `surface_receivers` for what its neighbours do.
pub const HALO: u32 = MOST_STEPS + 2;

struct Receivers {
    stage: PixelReceivers,
    keys: ReceiverKeys,
    /// Bound where no triangle numbers are given.
    no_ids: wgpu::TextureView,
    /// Bound where all samples of pixels are, or none.
    no_place: [wgpu::TextureView; 2],
}

impl GbufferStage {
    /// With the keys of the pixels of which surfaces that are no casters are told apart, if the pass has room for them.
    ///
    /// # Errors
    /// [`Error::Gpu`](crate::Error::Gpu) if the device has no memory.
    pub fn new(device: &wgpu::Device, settings: &Settings, keys: Option<ReceiverKeys>) -> Result<Self> {
        let every = settings.facets == FacetMode::All;
        let samples = every.then(|| GbufferTriangles::new(device, &PrefixScan::new(device)));
        let receivers = keys.map(|keys| Receivers::new(device, keys, settings.alpha_tested));
        Ok(Self { ids: TriangleIds::new(device), receivers, samples })
    }

    /// Uses other memory from now on.
    pub fn take(&mut self, keys: Option<ReceiverKeys>) {
        if let (Some(receivers), Some(keys)) = (&mut self.receivers, keys) {
            receivers.keys = keys;
        }
    }

    /// Records the method with what the G-buffer says.
    pub fn record(&self, rec: &mut Recorder, gbuffer: &GBuffer, ours: &[[f32; 2]], with: With) -> Result<()> {
        let With { method, casters, maps, extent, further, .. } = with;
        let buffers = &casters.buffers;
        match (gbuffer, &self.receivers) {
            _ if with.kept => method.record(rec, buffers, FacetSource::Kept, (maps, extent), further),
            (GBuffer::TriangleIds(given), _) => {
                let ids = |rec: &mut Recorder, frame: &Buffer<Frame>| self.record_ids(rec, frame, *given, with);
                method.record(rec, buffers, FacetSource::Centres(&ids), (maps, extent), further)
            }
            (GBuffer::Surfaces(given), Some(receivers)) => {
                let textures = GivenTextures::new(given, with.size);
                let surfaces = |rec: &mut Recorder, frame: &Buffer<Frame>| {
                    if given.ids.is_none() {
                        method.record_camera(rec, buffers)?;
                    }
                    receivers.record(rec, frame, &textures, with)
                };
                let keys = &receivers.keys.keys;
                if self.samples.is_some() {
                    let place = receivers.given(&textures.place);
                    let given = GivenSurfaces { params: textures.params, place, keys };
                    return method.record(
                        rec,
                        buffers,
                        FacetSource::Receivers(&surfaces, given),
                        (maps, extent),
                        further,
                    );
                }
                let centres = |rec: &mut Recorder, frame: &Buffer<Frame>| {
                    surfaces(rec, frame)?;
                    rec.copy(keys.raw(), method.id_keys().raw(), keys.len() as u64 * 4);
                    Ok(())
                };
                method.record(rec, buffers, FacetSource::Centres(&centres), (maps, extent), further)
            }
            (GBuffer::SampleIds(given), _) => self.record_samples(rec, given, ours, with),
            _ => method.record(rec, buffers, FacetSource::Found, (maps, extent), further),
        }
    }

    fn record_samples(&self, rec: &mut Recorder, given: &SampleTexture, ours: &[[f32; 2]], with: With) -> Result<()> {
        let With { method, casters, faults, maps, extent, further, .. } = with;
        let Some(stage) = &self.samples else {
            return method.record(rec, &casters.buffers, FacetSource::Found, (maps, extent), further);
        };
        let multisampled = given.is_multisampled();
        let view = if multisampled { first_level(given.texture) } else { all_layers(given.texture) };
        let texture = if multisampled { Texture::Samples(&view) } else { Texture::Layers(&view) };
        let given = SampleGbuffer { texture, params: given.params(ours)?, numbers: &casters.numbers };
        let samples = SampleIds { stage, given, faults };
        method.record(rec, &casters.buffers, FacetSource::Samples(&samples), (maps, extent), further)
    }

    fn record_ids(&self, rec: &mut Recorder, frame: &Buffer<Frame>, given: TriangleTexture, with: With) -> Result<()> {
        let view = first_level(given.texture);
        let counted = triangle_ids::TriangleIdsParams { first: given.first, none: given.none };
        let With { method, casters, faults, .. } = with;
        let stage = &mut rec.stage("triangle_ids");
        self.ids.record(stage, frame, &view, counted, &casters.numbers, method.id_keys(), faults)
    }
}

impl Receivers {
    fn new(device: &wgpu::Device, keys: ReceiverKeys, alpha: bool) -> Self {
        let unread = |label: &str, format: wgpu::TextureFormat| {
            first_level(&device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d::default(),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            }))
        };
        let no_ids = unread("pixel_receivers.no_ids", wgpu::TextureFormat::R32Uint);
        let no_place = unread("pixel_receivers.no_place", wgpu::TextureFormat::R32Float);
        Self { stage: PixelReceivers::new(device, alpha), keys, no_ids, no_place: [no_place, unread_samples(device)] }
    }

    /// A texture as kernels take it.
    fn given<'a>(&'a self, (view, multisampled): &'a (wgpu::TextureView, bool)) -> GivenTexture<'a> {
        let [single, samples] = &self.no_place;
        if *multisampled { GivenTexture { single, samples: view } } else { GivenTexture { single: view, samples } }
    }

    /// Records what pixels show, by the method's own search among its casters.
    fn record(&self, rec: &mut Recorder, frame: &Buffer<Frame>, given: &GivenTextures, with: With) -> Result<()> {
        let With { method, casters, faults, .. } = with;
        let GivenTextures { params, place, normals, ids } = given;
        let textures = Textures {
            place: self.given(place),
            normals: self.given(normals.as_ref().unwrap_or(place)),
            ids: ids.as_ref().unwrap_or(&self.no_ids),
        };
        let buffers = &casters.buffers;
        let surfaces =
            ReceiverRoom { numbers: &casters.numbers, triangles: &buffers.triangles, positions: &buffers.positions };
        let Some(blocks) = method.in_camera(buffers) else { return Ok(()) };
        let seen = SeenCasters { blocks, id_keys: method.id_keys() };
        let stage = &mut rec.stage("pixel_receivers");
        self.stage.record(stage, frame, *params, textures, surfaces, seen, &self.keys, faults)
    }
}

/// Views of an application's textures, whether each is multisampled, and what they contain.
struct GivenTextures {
    params: PixelReceiversParams,
    place: (wgpu::TextureView, bool),
    normals: Option<(wgpu::TextureView, bool)>,
    ids: Option<wgpu::TextureView>,
}

impl GivenTextures {
    /// Those of an image of so many pixels.
    fn new(given: &SurfaceTextures, size: [u32; 2]) -> Self {
        let mut params = PixelReceiversParams { tolerance: given.tolerance, ..PixelReceiversParams::at_centres() };
        let texture = match given.place {
            SurfacePosition::Depth { texture, terms, nothing } => {
                (params.depth, params.tilt) = terms.over_image(size);
                params.nothing = nothing;
                texture
            }
            SurfacePosition::Position(texture) => {
                params.given = GIVEN_POSITIONS;
                texture
            }
        };
        let view = |texture: &wgpu::Texture| (first_level(texture), texture.sample_count() > 1);
        let flag = |on: bool, bit: u32| if on { bit } else { 0 };
        let (place, normals) = (view(texture), given.normals.map(view));
        if place.1 {
            params.sample = nearest_of([0.5; 2], given.places);
            params.at = given.places.get(params.sample as usize).copied().unwrap_or([0.5; 2]);
        }
        let several = normals.as_ref().is_some_and(|(_, several)| *several);
        params.given |=
            flag(place.1, GIVEN_SAMPLES) | flag(normals.is_some(), GIVEN_NORMALS) | flag(several, GIVEN_NORMAL_SAMPLES);
        let ids = given.ids.map(|ids| first_level(ids.texture));
        if let Some(ids) = given.ids {
            (params.first, params.none) = (ids.first, ids.none);
            params.given |= GIVEN_IDS;
        }
        Self { params, place, normals, ids }
    }
}
