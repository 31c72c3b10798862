//! Checks of textures, and views of them.

use crate::{Error, Result};

/// Checks that the first level and layer of a texture can be used.
pub(super) fn check_texture(
    what: &str,
    texture: &wgpu::Texture,
    formats: &[wgpu::TextureFormat],
    usage: wgpu::TextureUsages,
    part: ImagePart,
) -> Result<()> {
    check_sampled(what, texture, formats, usage, part, (0, 1))
}

/// The part of a texture that an image is.
#[derive(Clone, Copy)]
pub(super) struct ImagePart {
    /// Width and height of the image.
    pub size: [u32; 2],
    /// Texel of its top left pixel; `None` if it is the whole texture.
    pub origin: Option<[u32; 2]>,
}

/// As [`check_texture`], of that level of a texture of so many samples.
pub(super) fn check_sampled(
    what: &str,
    texture: &wgpu::Texture,
    formats: &[wgpu::TextureFormat],
    usage: wgpu::TextureUsages,
    part: ImagePart,
    (level, samples): (u32, u32),
) -> Result<()> {
    let wrong = |text: String| Err(Error::Config(format!("{what} texture: {text}")));
    if !formats.contains(&texture.format()) {
        let needed: Vec<_> = formats.iter().map(|f| format!("{f:?}")).collect();
        return wrong(format!("format {:?}, {} is needed", texture.format(), needed.join(" or ")));
    }
    let ([width, height], have) = (part.size, [texture.width(), texture.height()].map(|side| (side >> level).max(1)));
    match part.origin {
        None if have != part.size => {
            return wrong(format!("{}x{} texels, the image has {width}x{height}", have[0], have[1]));
        }
        Some([x, y]) if (0..2).any(|k| [x, y][k].saturating_add(part.size[k]) > have[k]) => {
            return wrong(format!(
                "{}x{} texels do not hold an image of {width}x{height} at ({x}, {y})",
                have[0], have[1]
            ));
        }
        _ => {}
    }
    if texture.dimension() != wgpu::TextureDimension::D2 || texture.sample_count() != samples {
        return wrong(format!(
            "dimension {:?} and {} samples, D2 and {samples} are needed",
            texture.dimension(),
            texture.sample_count()
        ));
    }
    if !texture.usage().contains(usage) {
        return wrong(format!("its usage {:?} lacks {usage:?}", texture.usage()));
    }
    Ok(())
}

/// The first level and layer of a texture.
pub(super) fn first_level(texture: &wgpu::Texture) -> wgpu::TextureView {
    one_level(texture, 0, 0)
}

/// One level of one layer of a texture.
pub(super) fn one_level(texture: &wgpu::Texture, level: u32, layer: u32) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("shadow_pass"),
        dimension: Some(wgpu::TextureViewDimension::D2),
        base_mip_level: level,
        mip_level_count: Some(1),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..Default::default()
    })
}

/// The first level of all layers of a texture.
pub(super) fn all_layers(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("shadow_pass"),
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        mip_level_count: Some(1),
        ..Default::default()
    })
}
