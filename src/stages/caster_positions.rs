//! Positions of the casters, from a vertex buffer that the application rewrites each frame.
//!
//! - **Reads** a vertex buffer (positions of three `f32`, world units, at any stride of whole words) and the place of each of
//!   its vertices among those of the casters.
//! - **Writes** `positions`, 16 bytes a place: three `f32`, and a word that is left alone; counts into `faults` the places outside the box or without a number
//!   ([`FAULT_OUTSIDE`]; they are moved into the box), and the vertices that are no longer at the point they share with the
//!   vertex of their place ([`FAULT_PARTED`]).
//! - **Guarantee.** Without a homography bits are copied (−0 as +0), else a position is mapped in single precision; no place outside the box is ever written.
//! - **Cost.** One dispatch; two positions read and one written a vertex.

use crate::Result;
use crate::gpu::bindings::Read;
use crate::gpu::given::GivenElements;
use crate::gpu::kernels::caster_positions as kernel;
pub use crate::gpu::kernels::caster_positions::{FAULT_OUTSIDE, FAULT_PARTED, NO_PLACE};
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::scene::Homography;
use crate::shared_struct;

shared_struct! {
    /// Parameters of the kernel.
    "caster_positions" => pub struct CasterPositionsParams {
        /// Lowest corner of the box that holds all positions.
        pub box_low: [f32; 3],
        /// Vertices of the buffer.
        pub count: u32,
        /// Its highest corner.
        pub box_high: [f32; 3],
        /// Word of the first position.
        pub offset: u32,
        /// Words from one position to the next.
        pub stride: u32,
        /// Unused.
        pub pad_0: u32,
        /// Unused.
        pub pad_1: u32,
        /// Unused.
        pub pad_2: u32,
        /// Map of the positions.
        pub homography: Homography,
    }
}

/// Positions in a vertex buffer.
#[derive(Clone, Copy, Debug)]
pub struct Vertices<'a> {
    /// A buffer of usage `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// Byte of the first position, a multiple of 4.
    pub offset: u64,
    /// Bytes from one position to the next, a multiple of 4, at least 12.
    pub stride: u64,
}

impl<'a> Vertices<'a> {
    /// Positions one after the other, three `f32` each, from the start of `buffer`.
    pub fn packed(buffer: &'a wgpu::Buffer) -> Self {
        Self { buffer, offset: 0, stride: 12 }
    }

    /// Checks that `count` positions can be read on a device with `limits`.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for a wrong usage, stride, offset or size, with the numbers; [`crate::Error::Memory`] if what holds the
    /// positions is above the limit of one binding.
    pub fn check(&self, count: usize, limits: &wgpu::Limits) -> Result<()> {
        self.elements().check(count, limits)
    }

    fn elements(&self) -> GivenElements<'a> {
        let Self { buffer, offset, stride } = *self;
        GivenElements { what: ["vertex buffer", "positions"], buffer, offset, stride, each: 12 }
    }
}

/// The pipeline.
#[derive(Debug)]
pub struct CasterPositions {
    gather: kernel::GatherProgram,
    uniforms: Uniforms,
}

impl CasterPositions {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { gather: kernel::GatherProgram::new(device, ()), uniforms: Uniforms::default() }
    }

    /// Records the copy of all vertices that `places` names (place and source vertex of each). `bounds` are the lowest and
    /// the highest corner of a box that holds them, mapped by the homography.
    ///
    /// # Errors
    /// As [`Vertices::check`]; [`crate::Error::Config`] if `faults` is too short.
    pub fn record(
        &self,
        stage: &mut Stage,
        vertices: Vertices,
        places: &Buffer<[u32; 2]>,
        (bounds, homography): ([[f32; 3]; 2], Homography),
        positions: &Buffer<[f32; 4]>,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        super::holds("caster_positions", "faults", faults.len(), 2)?;
        let limits = stage.device.limits();
        vertices.check(places.len(), &limits)?;
        if places.is_empty() {
            return Ok(());
        }
        let first = vertices.elements().first_bound(&limits);
        let params = CasterPositionsParams {
            box_low: bounds[0],
            count: places.len() as u32,
            box_high: bounds[1],
            offset: ((vertices.offset - first) / 4) as u32,
            stride: (vertices.stride / 4) as u32,
            homography,
            ..CasterPositionsParams::default()
        };
        let params = self.uniforms.get(stage.device, &params)?;
        let bindings = kernel::Gather {
            params: params.as_uniform(),
            vertices: Read::from(vertices.buffer, first),
            places: places.as_read(),
            positions: positions.as_write(),
            faults: faults.as_write(),
        };
        stage.run(&self.gather, bindings, Groups::Items(places.len() as u64));
        Ok(())
    }
}
