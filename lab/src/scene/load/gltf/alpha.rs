//! Materials of a glTF document that are alpha-tested (`alphaMode` `MASK`): alpha of their base colour texture.

use super::super::{Beside, Parsed};
use super::accessor::Source;
use super::buffers::from_uri;
use super::json::{Material, TextureInfo};
use image::{ImageFormat, ImageReader, Limits};
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Cursor;
use subpixel_shadows::scene::{AlphaFilter, AlphaMap, AlphaWrap};

/// Cutoff of a material that tells none.
const CUTOFF: f64 = 0.5;

/// Texels of all maps together.
const MOST_TEXELS: u64 = 1 << 28;

/// The maps of a document's materials, made as they are asked for.
#[derive(Default)]
pub(super) struct Materials {
    pub(super) maps: Vec<AlphaMap>,
    /// Map of each material that was asked for; `None` for one without holes.
    known: HashMap<usize, Option<u32>>,
    texels: u64,
    /// Materials whose texture is in a format that is not read.
    pub(super) unread: usize,
}

/// How the texture coordinates of a triangle with holes are found.
pub(super) struct Tested {
    /// Number of the map.
    pub(super) map: u32,
    /// Set of texture coordinates.
    pub(super) set: u32,
    /// Offset and two columns of what they are transformed by (`KHR_texture_transform`).
    transform: [[f64; 2]; 3],
}

impl Tested {
    /// Texture coordinates as they are transformed.
    pub(super) fn moved(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let [offset, x, y] = self.transform;
        [0, 1].map(|k| (offset[k] + x[k] * f64::from(u) + y[k] * f64::from(v)) as f32)
    }
}

/// Whether a material has holes by a texture that is read.
pub(super) fn is_read(material: &Material) -> bool {
    material.alpha_mode.as_deref() == Some("MASK")
}

impl Materials {
    /// Map and texture coordinates of a material; `None` for one without holes.
    pub(super) fn tested(&mut self, source: &Source, beside: Beside, material: usize) -> Parsed<Option<Tested>> {
        let all = &source.root.materials;
        let of =
            all.get(material).ok_or_else(|| format!("glTF: material {material} is used, there are {}", all.len()))?;
        if !is_read(of) {
            return Ok(None);
        }
        let map = match self.known.get(&material) {
            Some(&known) => known,
            None => {
                let made = self.map(source, beside, of).map_err(|e| format!("glTF: material {material}: {e}"))?;
                let number = made.map(|map| {
                    self.maps.push(map);
                    self.maps.len() as u32 - 1
                });
                self.known.insert(material, number);
                number
            }
        };
        let info = of.pbr.base_color_texture.as_ref();
        Ok(map.map(|map| Tested {
            map,
            set: info.map_or(0, TextureInfo::set),
            transform: info.map_or([[0.0; 2], [1.0, 0.0], [0.0, 1.0]], TextureInfo::transform),
        }))
    }

    /// The map of an alpha-tested material; `None` where it has no hole.
    fn map(&mut self, source: &Source, beside: Beside, of: &Material) -> Parsed<Option<AlphaMap>> {
        let factor = of.pbr.base_color_factor.map_or(1.0, |factor| factor[3]);
        let cutoff = of.alpha_cutoff.unwrap_or(CUTOFF);
        if !factor.is_finite() || !cutoff.is_finite() || factor < 0.0 || cutoff < 0.0 {
            return Err(format!("alpha of {factor} times its texture's, cut off at {cutoff}"));
        }
        let Some((size, mut alpha, filter, wrap)) = (match &of.pbr.base_color_texture {
            Some(info) => self.texture(source, beside, info.index)?,
            None => Some(([1, 1], vec![255], AlphaFilter::Nearest, [AlphaWrap::Repeat; 2])),
        }) else {
            self.unread += 1;
            return Ok(None);
        };
        // The texture's alpha times the factor against the cutoff.
        let mut cutoff = if factor > 0.0 {
            cutoff / factor
        } else if cutoff > 0.0 {
            2.0
        } else {
            0.0
        };
        if cutoff > 1.0 {
            alpha.fill(0);
            cutoff = 1.0;
        }
        let map = AlphaMap { size, alpha, cutoff: cutoff as f32, filter, wrap };
        let whole = map.alpha.iter().all(|&a| f32::from(a) >= map.threshold());
        Ok((!whole).then_some(map))
    }

    /// Size, alpha, filter and wraps of a texture; `None` if it is in a format that is not read.
    #[expect(clippy::type_complexity, reason = "the parts of a map, asked for in one place")]
    fn texture(
        &mut self,
        source: &Source,
        beside: Beside,
        index: usize,
    ) -> Parsed<Option<([u32; 2], Vec<u8>, AlphaFilter, [AlphaWrap; 2])>> {
        let root = source.root;
        let texture = root
            .textures
            .get(index)
            .ok_or_else(|| format!("texture {index} is used, there are {}", root.textures.len()))?;
        let sampler = match texture.sampler {
            Some(sampler) => root
                .samplers
                .get(sampler)
                .ok_or_else(|| format!("sampler {sampler} is used, there are {}", root.samplers.len()))?,
            None => &Default::default(),
        };
        let wrap = |code: Option<u32>| match code.unwrap_or(10497) {
            10497 => Ok(AlphaWrap::Repeat),
            33071 => Ok(AlphaWrap::Clamp),
            33648 => Ok(AlphaWrap::Mirror),
            other => Err(format!("sampler wraps by {other}")),
        };
        let wraps = [wrap(sampler.wrap_s)?, wrap(sampler.wrap_t)?];
        let filter = if sampler.mag_filter == Some(9728) { AlphaFilter::Nearest } else { AlphaFilter::Bilinear };
        let Some(image) = texture.source else { return Ok(None) };
        let read = self.image(source, beside, image).map_err(|e| format!("image {image}: {e}"))?;
        Ok(read.map(|(size, alpha)| (size, alpha, filter, wraps)))
    }

    /// Size of an image and alpha of its pixels; `None` if it is in a format that is not read.
    fn image(&mut self, source: &Source, beside: Beside, index: usize) -> Parsed<Option<([u32; 2], Vec<u8>)>> {
        let images = &source.root.images;
        let image = images.get(index).ok_or_else(|| format!("is used, there are {}", images.len()))?;
        let bytes: Cow<[u8]> = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => from_uri(uri, beside)?,
            (None, Some(view)) => source.view(view)?.into(),
            (None, None) => return Err("has no data".to_owned()),
        };
        if bytes.starts_with(b"\xff\xd8\xff") {
            // A JPEG image has no alpha.
            return Ok(Some(([1, 1], vec![255])));
        }
        if !bytes.starts_with(b"\x89PNG") {
            return Ok(None);
        }
        let mut reader = ImageReader::new(Cursor::new(&bytes[..]));
        reader.set_format(ImageFormat::Png);
        let mut limits = Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(AlphaMap::LARGEST), Some(AlphaMap::LARGEST));
        reader.limits(limits);
        let decoded = reader.decode().map_err(|e| e.to_string())?;
        let size = [decoded.width(), decoded.height()];
        self.texels += u64::from(size[0]) * u64::from(size[1]);
        if self.texels > MOST_TEXELS {
            return Err(format!("the maps up to it have {} texels, at most {MOST_TEXELS} may be read", self.texels));
        }
        if !decoded.color().has_alpha() {
            return Ok(Some((size, vec![255; (size[0] * size[1]) as usize])));
        }
        Ok(Some((size, decoded.into_rgba8().pixels().map(|p| p.0[3]).collect())))
    }
}
