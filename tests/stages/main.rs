//! The standard cases of every stage, against its CPU definition, on one shared device.

mod support;

mod camera_visibility;
mod candidate_pairs;
mod caster_positions;
mod compact;
mod dispatch_args;
mod facet_classify;
mod front_layer;
mod gbuffer_triangles;
mod light_layers;
mod pixel_receivers;
mod pixel_texel_pairs;
mod pixel_triangles;
mod prefix_scan;
mod radix_sort;
mod resolve;
mod sample_bins;
mod sample_surfaces;
mod seen_texels;
mod shadow_map;
mod shadow_rays;
mod silhouette_mask;
mod smsr;
mod sorted_pairs;
mod spsm_map;
mod spsm_query;
mod summed_area;
mod texel_group;
mod triangle_ids;
mod triangle_setup;
mod triangle_texel_pairs;
mod vertex_project;
mod visibility_masks;
mod visibility_texture;
mod work_owners;
