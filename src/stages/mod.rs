//! The stages: each is a WGSL kernel, its host side here, and its CPU definition, by the same name, in `oracle/src/reference/`.
//!
//! A stage is made once per device (`new` compiles its pipelines), is given scratch memory made once per capacity, and
//! then only records dispatches: it never allocates list memory, submits, waits or reads back.

pub mod axis_density;
pub mod camera_visibility;
pub mod candidate_pairs;
pub mod caster_positions;
pub mod cluster_bounds;
pub mod cluster_culling;
pub mod compact;
pub mod compared_depths;
pub mod deep_map;
pub mod deep_shadows;
pub mod dispatch_args;
pub mod facet_classify;
pub mod front_layer;
pub mod gbuffer_triangles;
pub mod history;
pub mod instance_positions;
pub mod kept_triangles;
pub mod light_layers;
pub mod light_lists;
pub mod map_moments;
pub mod moment_shadows;
pub mod page_casters;
pub mod page_query;
pub mod page_refinement;
pub mod page_requests;
pub mod paraboloid_casters;
pub mod pixel_counts;
pub mod pixel_coverage;
pub mod pixel_filter;
pub mod pixel_receivers;
pub mod pixel_texel_pairs;
pub mod pixel_triangles;
pub mod pixel_views;
pub mod polygon_ids;
pub mod prefix_scan;
pub mod radix_sort;
pub mod requested_blocks;
pub mod resolve;
pub mod sample_bins;
pub mod sample_surfaces;
pub mod seen_depths;
pub mod seen_texels;
pub mod shadow_map;
pub mod shadow_rays;
pub mod silhouette_map;
pub mod silhouette_mask;
pub mod silhouette_points;
pub mod smsr;
pub mod sorted_pairs;
pub mod spsm_map;
pub mod spsm_query;
pub mod summed_area;
pub mod surface_receivers;
pub mod texel_group;
pub mod triangle_ids;
pub mod triangle_setup;
pub mod triangle_texel_pairs;
pub mod vertex_project;
pub mod visibility_masks;
pub mod visibility_texture;
pub mod warped_casters;
pub mod warped_query;
pub mod work_owners;

pub use cluster_bounds::ClusterBounds;
pub use cluster_culling::ClusterCulling;
pub use compact::Compact;
pub use dispatch_args::DispatchArgs;
pub use prefix_scan::PrefixScan;
pub use radix_sort::RadixSort;
pub use sorted_pairs::SortedPairs;
pub use summed_area::SummedArea;
pub use texel_group::TexelGroup;
pub use work_owners::WorkOwners;

use crate::gpu::Buffer;
use crate::gpu::bindings::Read;
use crate::{Error, Result};
use bytemuck::Pod;

/// Primary hits and their triangles, for stages that look shadows up in a map.
#[derive(Clone, Copy, Debug)]
pub struct PrimaryHits<'a> {
    /// Sample offsets.
    pub samples: &'a Buffer<[f32; 4]>,
    /// Complement of the triangle at each pixel centre.
    pub id_keys: &'a Buffer<u32>,
    /// Vertex indices.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Vertices relative to the eye, scaled.
    pub points: &'a Buffer<[f32; 4]>,
}

/// How many items of a list count.
#[derive(Clone, Copy, Debug)]
pub enum Count<'a> {
    /// The host knows.
    Exactly(usize),
    /// This word of a buffer says; what exceeds the stage's capacity is left out. The work is sized by the capacity.
    At(&'a Buffer<u32>, usize),
    /// The same, where nobody reads what lies beyond the count: it may be left as it is, and the work is sized by the count.
    Only(&'a Buffer<u32>, usize),
}

impl From<usize> for Count<'_> {
    fn from(count: usize) -> Self {
        Self::Exactly(count)
    }
}

impl<'a> Count<'a> {
    /// Most items there may be, given the stage's capacity.
    ///
    /// # Errors
    /// [`Error::Config`] if the host asks for more than the capacity, or the word lies outside the buffer.
    pub(crate) fn limit(&self, stage: &str, capacity: usize) -> Result<usize> {
        match *self {
            Self::Exactly(n) if n > capacity => {
                Err(Error::Config(format!("{stage}: {n} items, but the scratch memory is for {capacity}")))
            }
            Self::Exactly(n) => Ok(n),
            Self::At(buffer, word) | Self::Only(buffer, word) => {
                holds(stage, "count", buffer.len(), word + 1).map(|()| capacity)
            }
        }
    }

    /// Which word to read: of the buffer, or of the parameters (where the limit must come first).
    pub(crate) fn word(&self) -> u32 {
        match *self {
            Self::Exactly(_) => 0,
            Self::At(_, word) | Self::Only(_, word) => word as u32,
        }
    }

    /// The words that hold the count: the caller's, or the parameters themselves.
    pub(crate) fn words<T: Pod>(&self, params: &'a Buffer<T>) -> Read<'a, u32> {
        match *self {
            Self::Exactly(_) => params.as_read().cast(),
            Self::At(buffer, _) | Self::Only(buffer, _) => buffer.as_read(),
        }
    }
}

/// Checks that the buffer a stage calls `what` has `len` elements, at least `needed`.
pub(crate) fn holds(stage: &str, what: &str, len: usize, needed: usize) -> Result<()> {
    if len < needed {
        return Err(Error::Config(format!("{stage}: '{what}' holds {len} elements, {needed} are needed")));
    }
    Ok(())
}
