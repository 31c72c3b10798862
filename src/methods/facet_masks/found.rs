//! Facets that the camera sees, found once and used for several lights.

use super::Memory;
use crate::Result;
use crate::gpu::{Buffer, Recorder};
use crate::stages::facet_classify::Facet;
use crate::status::{Status, StatusHead};
use std::mem::offset_of;

/// First word of what the camera's stages count.
const COUNTED: usize = offset_of!(StatusHead, longest_pixel) / 4;

/// Facets as they were before a light classified them, and what was counted when they were found.
pub struct FoundFacets {
    facets: Buffer<Facet>,
    counted: Buffer<u32>,
}

impl FoundFacets {
    /// Memory for so many facets.
    pub fn new(device: &wgpu::Device, facets: usize) -> Result<Self> {
        Ok(Self {
            facets: Buffer::storage(device, "facet_masks.found", facets)?,
            counted: Buffer::storage(device, "facet_masks.counted", Status::band(0) - COUNTED)?,
        })
    }

    /// Facets there is room for.
    pub fn len(&self) -> usize {
        self.facets.len()
    }

    /// Keeps what was found.
    pub fn record_keep(&self, rec: &mut Recorder, m: &Memory) {
        rec.copy(m.facets.list.raw(), self.facets.raw(), (self.len() * size_of::<Facet>()) as u64);
        rec.copy_words(m.status.raw(), COUNTED as u64, self.counted.raw(), 0, self.counted.len() as u64);
    }

    /// Brings it back: masks are cleared by what classifies facets.
    pub fn record_restore(&self, rec: &mut Recorder, m: &Memory) {
        rec.copy(self.facets.raw(), m.facets.list.raw(), (self.len() * size_of::<Facet>()) as u64);
        rec.copy_words(self.counted.raw(), 0, m.status.raw(), COUNTED as u64, self.counted.len() as u64);
    }
}
