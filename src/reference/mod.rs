//! What each stage computes, said as plainly as Rust allows: pure functions over slices, built on the standard library.
//! Nothing here knows of GPUs, kernels or how a stage splits its work; a test that compares with these compares with
//! the definition.

pub mod camera_visibility;
pub mod candidate_pairs;
pub mod caster_positions;
pub mod compact;
pub mod dispatch_args;
pub mod facet_classify;
pub mod front_layer;
pub mod gbuffer_triangles;
pub mod light_layers;
pub mod pixel_receivers;
pub mod pixel_texel_pairs;
pub mod pixel_triangles;
pub mod prefix_scan;
pub mod radix_sort;
pub mod resolve;
pub mod sample_bins;
pub mod sample_surfaces;
pub mod seen_texels;
pub mod shadow_map;
pub mod shadow_rays;
pub mod silhouette_mask;
pub mod sorted_pairs;
pub mod spsm_map;
pub mod spsm_query;
pub mod summed_area;
pub mod texel_group;
pub mod triangle_ids;
pub mod triangle_setup;
pub mod triangle_texel_pairs;
pub mod vertex_project;
pub mod view;
pub mod visibility_masks;
pub mod visibility_texture;
pub mod work_owners;
