//! Memory that depends on the image size and on the strips of rows in which the image is rendered: that of one strip, which all strips use
//! in turn, and beside it the whole image where there is more than one strip.

use super::casters::CasterSet;
use super::gbuffer_stage::HALO;
use super::inputs::Target;
use super::textures::one_level;
use crate::gpu::{Buffer, Profile, Recorder, TexelRows};
use crate::light_view::MapTiles;
use crate::methods::facet_masks::Capacities;
use crate::methods::output::Budget;
use crate::methods::prepared::MeshBuffers;
use crate::methods::strip_method::{MethodPipelines, StripMethod};
use crate::methods::strips::{Rows, Strips};
use crate::methods::{Settings, list_sizing};
use crate::stages::pixel_counts::PixelCounts;
use crate::stages::pixel_receivers::ReceiverKeys;
use crate::stages::visibility_texture::{MeanVisibility, PackedVisibility, Packing, VisibilityTexture};
use crate::{Error, Result};

/// Maker of strips.
pub struct StripMaker {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub pipelines: MethodPipelines,
    pub parts: MapTiles,
    pub budget: Budget,
    /// Room for surfaces that are no casters.
    pub receivers: bool,
    /// About so many strips to begin with.
    pub strips: u32,
}

/// An image in strips.
pub struct ImageStrips {
    pub strips: Strips,
    pub method: StripMethod,
    whole: Option<Whole>,
    /// Rows on their way to a texture.
    packed: Option<Buffer<u32>>,
}

/// The ways to an application's texture, and to the mean over points of a light.
pub struct Stores {
    place: VisibilityTexture,
    packed: PackedVisibility,
    pub mean: MeanVisibility,
}

impl Stores {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let (place, packed) = (VisibilityTexture::new(device), PackedVisibility::new(device));
        Self { place, packed, mean: MeanVisibility::new(device) }
    }
}

struct Whole {
    visibility: Buffer<f32>,
    lit: Option<Buffer<u32>>,
}

/// Result of [`StripMaker::make`].
pub struct NewStrips {
    pub image: ImageStrips,
    /// The casters, with room behind them for a triangle a pixel of a strip.
    pub surfaces: Option<MeshBuffers>,
    /// Triangle keys of a strip.
    pub keys: Option<ReceiverKeys>,
}

impl StripMaker {
    /// An image in no more strips than it takes to begin with.
    pub fn first_strips(&self, settings: &Settings) -> Strips {
        let halo = if self.receivers { HALO } else { 0 };
        Strips::with_halo(settings.size, self.strips, halo.max(settings.filter.reach()))
    }

    /// Memory for an image in about as many `strips`, or as many more as it takes; lists as long as `start` says, or as for a first
    /// frame. Results go on in those of the image before, if it had the same size.
    ///
    /// # Errors
    /// [`Error::Memory`] if not even the thinnest strips fit, [`Error::Gpu`].
    pub fn make(
        &self,
        settings: &Settings,
        casters: &CasterSet,
        mut strips: Strips,
        before: Option<(&ImageStrips, Capacities)>,
    ) -> Result<NewStrips> {
        let mut made = loop {
            let start = before.map(|(image, wanted)| {
                let share = f64::from(strips.size()[1]) / f64::from(image.strips.size()[1]);
                list_sizing::of_rows(wanted, share, settings.facets)
            });
            match self.make_strips(settings, casters, strips, start) {
                Err(error @ Error::Memory { .. }) if !self.pipelines.is_fixed() => {
                    strips = strips.more().ok_or(error)?;
                }
                made => break made?,
            }
        };
        if made.image.strips.count() > 1 {
            let whole = before.map_or_else(
                || Whole::new(&self.device, settings, &made.image.method),
                |(image, _)| Ok(image.results()),
            );
            made.image.whole = Some(whole?);
        }
        Ok(made)
    }

    fn make_strips(
        &self,
        settings: &Settings,
        casters: &CasterSet,
        strips: Strips,
        start: Option<Capacities>,
    ) -> Result<NewStrips> {
        let (device, queue) = (&self.device, &self.queue);
        let of_strip = Settings { size: strips.size(), ..settings.of_part(self.parts) };
        let pixels = of_strip.pixels();
        let first = list_sizing::first_for(&of_strip, self.budget, casters.buffers.triangles.len());
        let first = first.in_turns(Profile::of(device));
        let first = start.map_or(first, |start| list_sizing::larger(first, start));
        let first = list_sizing::within(&device.limits(), &of_strip, self.budget, first);
        let mesh = (&*casters.prepared, &casters.buffers);
        let method = StripMethod::new(device, queue, &self.pipelines, mesh, &of_strip, first)?;
        let room = |_| casters.surfaces(device, queue, pixels);
        Ok(NewStrips {
            image: ImageStrips { strips, method, whole: None, packed: None },
            surfaces: self.receivers.then_some(()).map(room).transpose()?,
            keys: self.receivers.then(|| ReceiverKeys::new(device, pixels)).transpose()?,
        })
    }
}

impl Whole {
    fn new(device: &wgpu::Device, settings: &Settings, method: &StripMethod) -> Result<Self> {
        // They are copied to, and bound by nobody here.
        let words = settings.samples.words() as usize;
        Ok(Self {
            visibility: Buffer::banded(device, "shadow_pass.visibility", settings.pixels())?,
            lit: method
                .lit()
                .map(|_| Buffer::banded(device, "shadow_pass.lit", settings.pixels() * words))
                .transpose()?,
        })
    }
}

impl ImageStrips {
    /// Visibility of the whole image.
    pub fn visibility(&self) -> &Buffer<f32> {
        self.whole.as_ref().map_or(self.method.visibility(), |whole| &whole.visibility)
    }

    /// Lit masks of the whole image, where the method keeps them.
    pub fn lit(&self) -> Option<&Buffer<u32>> {
        self.whole.as_ref().map_or(self.method.lit(), |whole| whole.lit.as_ref())
    }

    /// The memory of both.
    fn results(&self) -> Whole {
        Whole { visibility: self.visibility().clone(), lit: self.lit().cloned() }
    }

    /// Makes memory for rows on their way to a target of another format, where there is none that suffices; says whether it did.
    pub fn make_packed(&mut self, device: &wgpu::Device, target: &Target) -> Result<bool> {
        let Some(packing) = target.visibility.and_then(|texture| texture.packing()) else { return Ok(false) };
        let [width, rows] = self.strips.size();
        let words = packing.row_bytes(width) as usize / 4 * rows as usize;
        if self.packed.as_ref().is_some_and(|packed| packed.len() >= words) {
            return Ok(false);
        }
        self.packed = Some(Buffer::storage(device, "shadow_pass.packed", words)?);
        Ok(true)
    }

    /// The visibility of a strip's own rows to where the application wants it.
    pub fn record_store(&self, rec: &mut Recorder, stores: &Stores, rows: Rows, target: &Target) -> Result<()> {
        let Some(texture) = target.visibility else { return Ok(()) };
        let method = &self.method;
        let (Some(packing), Some(packed)) = (texture.packing(), &self.packed) else {
            let view = one_level(texture.texture, texture.level, texture.layer);
            stores.place.record(&mut rec.stage("visibility_texture"), method.frame(), method.visibility(), &view);
            return Ok(());
        };
        let [width, height] = self.strips.size();
        let [x, y] = texture.origin.unwrap_or_default();
        let part = |first: u32, own: u32| TexelRows {
            texture: texture.texture,
            level: texture.level,
            origin: [x, y + rows.first + rows.known, texture.layer],
            size: [width, own],
            first,
            row_bytes: packing.row_bytes(width),
        };
        let own = part(rows.known, rows.own);
        if let Packing::Rgba8Channel(_) = packing {
            rec.copy_from_texture(own, packed.raw());
        }
        let (frame, visibility) = (method.frame(), method.visibility());
        {
            let stage = &mut rec.stage("visibility_texture");
            stores.packed.record(stage, frame, [width, height], visibility, packing, packed)?;
        }
        rec.copy_to_texture(packed.raw(), own);
        Ok(())
    }

    /// Copies a strip's own rows to where they belong, here and in the application's buffers of lit masks and counts.
    pub fn record_copies(&self, rec: &mut Recorder, rows: Rows, [target, counts]: [Option<&wgpu::Buffer>; 2]) {
        let (width, pixels) = (u64::from(self.strips.size()[0]), self.method.visibility().len() as u64);
        let lit = self.method.lit();
        let words = lit.map_or(0, |lit| lit.len() as u64 / pixels.max(1));
        let mut copy = |from: &wgpu::Buffer, to: &wgpu::Buffer, each: u64| {
            let [first, at, count] = rows.own_words(each);
            rec.copy_words(from, first, to, at, count);
        };
        if let Some(whole) = &self.whole {
            copy(self.method.visibility().raw(), whole.visibility.raw(), width);
            if let Some((lit, whole)) = lit.zip(whole.lit.as_ref()) {
                copy(lit.raw(), whole.raw(), width * words);
            }
        }
        if let Some((lit, target)) = lit.zip(target) {
            copy(lit.raw(), target, width * words);
        }
        if let Some((ours, target)) = self.method.counts().zip(counts) {
            copy(ours.raw(), target, width * size_of::<PixelCounts>() as u64 / 4);
        }
    }
}
