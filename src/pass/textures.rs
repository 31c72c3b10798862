//! Checks of textures, and views of them.

use crate::{Error, Result};

/// Checks that the first level and layer of a texture can be used.
pub(super) fn check_texture(
    what: &str,
    texture: &wgpu::Texture,
    formats: &[wgpu::TextureFormat],
    usage: wgpu::TextureUsages,
    size: [u32; 2],
) -> Result<()> {
    check_sampled(what, texture, formats, usage, size, 1)
}

/// As [`check_texture`], of a texture of so many samples.
pub(super) fn check_sampled(
    what: &str,
    texture: &wgpu::Texture,
    formats: &[wgpu::TextureFormat],
    usage: wgpu::TextureUsages,
    [width, height]: [u32; 2],
    samples: u32,
) -> Result<()> {
    let wrong = |text: String| Err(Error::Config(format!("{what} texture: {text}")));
    if !formats.contains(&texture.format()) {
        let needed: Vec<_> = formats.iter().map(|f| format!("{f:?}")).collect();
        return wrong(format!("format {:?}, {} is needed", texture.format(), needed.join(" or ")));
    }
    if (texture.width(), texture.height()) != (width, height) {
        return wrong(format!("{}x{} texels, the image has {width}x{height}", texture.width(), texture.height()));
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
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("shadow_pass"),
        dimension: Some(wgpu::TextureViewDimension::D2),
        mip_level_count: Some(1),
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
