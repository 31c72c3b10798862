//! Shadows by whose polygon lies nearest to the light, without depths and bias (Hourcade, Nicolas 1985).
//!
//! - **Reads** the triangle at each pixel centre, triangles, projected vertices, sample offsets, of each triangle the lowest of its surface, and
//!   of each texel the complement of the triangle that is nearest at its centre
//!   ([`LightLayers::with_triangles`](super::light_layers::LightLayers::with_triangles)).
//! - **Writes** `visibility`: the mean over the samples that meet the receiver's triangle, or where none does its plane; 1 where the pixel sees
//!   nothing.
//! - **Guarantee.** Bit-equal from run to run. A surface does not shadow itself, nor one across an edge of the receiver's triangle on its other
//!   side, at any angle; what is smaller than a texel may shadow and be shadowed wrongly.
//! - **Cost.** One dispatch over pixels; per sample one texel read, or as many as there are look-ups, and of another triangle than the one
//!   before its corners.
//! - **Source.** Scherzer 2011, section 5.1, describes the method.

use super::PrimaryHits;
use crate::frame::Frame;
use crate::gpu::kernels::polygon_ids as kernel;
use crate::gpu::{Buffer, Groups, Stage};

/// A map of triangles, and the surfaces they are of.
#[derive(Clone, Copy, Debug)]
pub struct PolygonMap<'a> {
    /// Complement of the triangle of each texel.
    pub triangle_keys: &'a Buffer<u32>,
    /// Lowest triangle of each triangle's surface; the highest bit means nothing.
    pub surfaces: &'a Buffer<u32>,
}

/// The pipeline.
#[derive(Debug)]
pub struct PolygonIds {
    compare: kernel::CompareProgram,
}

impl PolygonIds {
    /// Builds the pipeline. `lookups`: texels a side around a sample's of which one must keep its receiver's polygon: 1, 3, 5 or 7.
    pub fn new(device: &wgpu::Device, lookups: u32) -> Self {
        Self { compare: kernel::CompareProgram::new(device, kernel::Constants { paraboloids: 0, lookups }) }
    }

    /// Records the comparison of every pixel.
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        seen: PrimaryHits,
        map: PolygonMap,
        visibility: &Buffer<f32>,
    ) {
        let bindings = kernel::Compare {
            frame: frame.as_uniform(),
            samples: seen.samples.as_uniform(),
            id_keys: seen.id_keys.as_read(),
            triangles: seen.triangles.as_read(),
            points: seen.points.as_read(),
            triangle_keys: map.triangle_keys.as_read(),
            surfaces: map.surfaces.as_read(),
            visibility: visibility.as_write(),
        };
        stage.run(&self.compare, bindings, Groups::Items(visibility.len() as u64));
    }
}
