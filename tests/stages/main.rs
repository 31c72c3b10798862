//! The standard cases of every stage, against its CPU definition, on one shared device.

mod support;

mod candidate_pairs;
mod compact;
mod dispatch_args;
mod facet_classify;
mod pixel_texel_pairs;
mod prefix_scan;
mod radix_sort;
mod resolve;
mod summed_area;
mod texel_group;
mod triangle_texel_pairs;
mod visibility_masks;
