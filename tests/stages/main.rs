//! The standard cases of every stage, against its CPU definition, on one shared device.

mod support;

mod prefix_scan;
mod summed_area;
