//! Checks of textures, and views of them.

use crate::{Error, Result};

/// Checks that the first level and layer of a texture can be used.
pub(super) fn check_texture(
    what: &str,
    texture: &wgpu::Texture,
    formats: &[wgpu::TextureFormat],
    usage: wgpu::TextureUsages,
    [width, height]: [u32; 2],
) -> Result<()> {
    let wrong = |text: String| Err(Error::Config(format!("{what} texture: {text}")));
    if !formats.contains(&texture.format()) {
        let needed: Vec<_> = formats.iter().map(|f| format!("{f:?}")).collect();
        return wrong(format!("format {:?}, {} is needed", texture.format(), needed.join(" or ")));
    }
    if (texture.width(), texture.height()) != (width, height) {
        return wrong(format!("{}x{} texels, the image has {width}x{height}", texture.width(), texture.height()));
    }
    if texture.dimension() != wgpu::TextureDimension::D2 || texture.sample_count() != 1 {
        return wrong(format!(
            "dimension {:?} and {} samples, D2 and 1 are needed",
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
