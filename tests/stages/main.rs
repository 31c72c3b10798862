//! The standard cases of every stage, against its CPU definition, on one shared device.

mod support;

mod camera_visibility;
mod compact;
mod dispatch_args;
mod front_layer;
mod light_layers;
mod pixel_triangles;
mod prefix_scan;
mod radix_sort;
mod sample_surfaces;
mod silhouette_mask;
mod summed_area;
mod texel_group;
mod triangle_setup;
mod vertex_project;
