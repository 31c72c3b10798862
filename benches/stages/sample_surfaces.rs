//! As `pixel_coverage` with 32 samples a pixel: both stages, as this one uses up what that one leaves.

use super::pixel_coverage::case;
use crate::harness::Case;
use subpixel_shadows::Result;
use subpixel_shadows::gpu::Gpu;

pub fn cases(gpu: &Gpu, size: usize) -> Result<Vec<Case<'_>>> {
    Ok(case(gpu, size, 32)?.into_iter().collect())
}
