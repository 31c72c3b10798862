//! Positions of instances, from those of their meshes and a transform each.
//!
//! - **Reads** the vertices of the meshes, for each place its vertex and its instance, and the transforms ([`Transforms`]).
//! - **Writes** `positions`, 16 bytes a place: three `f32`, and a word that is left alone; counts into `faults` the places outside the box or
//!   without a number ([`FAULT_OUTSIDE`]), which are moved into the box.
//! - **Guarantee.** A vertex of one mesh and transform comes out at the same bits wherever it is used; as near to the exact place as four
//!   products and their sum in single precision are, in an order of the device's own.
//! - **Cost.** One dispatch; 24 bytes read and 12 written a place, and 48 an instance.

use crate::Result;
use crate::gpu::bindings::Read;
use crate::gpu::given::GivenElements;
use crate::gpu::kernels::instance_positions as kernel;
pub use crate::gpu::kernels::instance_positions::FAULT_OUTSIDE;
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::scene::Homography;
use crate::shared_struct;

shared_struct! {
    /// Parameters of the kernel.
    "instance_positions" => pub struct InstancePositionsParams {
        /// Lowest corner of the box that holds all positions.
        pub box_low: [f32; 3],
        /// Places.
        pub count: u32,
        /// Its highest corner.
        pub box_high: [f32; 3],
        /// Word of the first transform.
        pub offset: u32,
        /// Map of the transformed positions.
        pub homography: Homography,
    }
}

/// Transforms of instances in a buffer: 48 bytes each, three rows of four `f32`, of which the last is added to the product of the other three
/// with a position (the layout of instances in acceleration structures).
#[derive(Clone, Copy, Debug)]
pub struct Transforms<'a> {
    /// A buffer of usage `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// Byte of the first transform, a multiple of 4.
    pub offset: u64,
}

impl<'a> Transforms<'a> {
    /// Bytes of a transform.
    pub const BYTES: u64 = 48;

    /// Checks that `count` transforms can be read on a device with `limits`.
    ///
    /// # Errors
    /// [`crate::Error::Config`] for a wrong usage, offset or size, with the numbers; [`crate::Error::Memory`] if what holds the transforms is above the limit
    /// of one binding.
    pub fn check(&self, count: usize, limits: &wgpu::Limits) -> Result<()> {
        self.elements().check(count, limits)
    }

    /// A box that holds instances of what lies between two corners, by transforms of rows as those of the buffer: for what
    /// [`Placed::bounds`](crate::pass::Placed::bounds) asks, from as many numbers as there are instances and none a vertex. It is wider than they are by
    /// what rounding on a device may add. A point at the origin without transforms.
    pub fn bounds([low, high]: [[f32; 3]; 2], transforms: &[[[f32; 4]; 3]]) -> [[f32; 3]; 2] {
        let at = |k: usize| [low[k], high[k]].map(f64::from);
        let of_row = |row: &[f32; 4]| {
            let row = row.map(f64::from);
            let (mut ends, mut size) = ([row[3]; 2], row[3].abs());
            for (k, by) in row[..3].iter().enumerate() {
                let products = at(k).map(|p| by * p);
                ends = [ends[0] + products[0].min(products[1]), ends[1] + products[0].max(products[1])];
                size += products[0].abs().max(products[1].abs());
            }
            // Four products and three sums in any order, and the corners' own rounding.
            let slack = size * f64::from(f32::EPSILON) * 8.0;
            [(ends[0] - slack) as f32, (ends[1] + slack) as f32]
        };
        let boxes = transforms.iter().map(|rows| rows.each_ref().map(of_row));
        let join =
            |a: [[f32; 2]; 3], b: [[f32; 2]; 3]| std::array::from_fn(|k| [a[k][0].min(b[k][0]), a[k][1].max(b[k][1])]);
        let all = boxes.reduce(join).unwrap_or([[0.0; 2]; 3]);
        [all.map(|ends| ends[0]), all.map(|ends| ends[1])]
    }

    fn elements(&self) -> GivenElements<'a> {
        let (buffer, offset, bytes) = (self.buffer, self.offset, Self::BYTES);
        GivenElements { what: ["transform buffer", "transforms"], buffer, offset, stride: bytes, each: bytes }
    }
}

/// The pipeline.
#[derive(Debug)]
pub struct InstancePositions {
    transform: kernel::TransformProgram,
    uniforms: Uniforms,
}

impl InstancePositions {
    /// Builds the pipeline.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { transform: kernel::TransformProgram::new(device, ()), uniforms: Uniforms::default() }
    }

    /// Records the places of all vertices of `instances` instances, the first as element `first` of `positions`, which a binding can begin at.
    /// `sources` has the vertex and the instance of each place; `bounds` are the lowest and the highest corner of a box that holds them, mapped by the homography.
    ///
    /// # Errors
    /// As [`Transforms::check`]; [`crate::Error::Config`] if `faults` or `positions` is too short.
    #[expect(clippy::too_many_arguments, reason = "one argument a thing it depends on")]
    pub fn record(
        &self,
        stage: &mut Stage,
        (transforms, instances): (Transforms, usize),
        sources: &Buffer<[u32; 2]>,
        vertices: &Buffer<[f32; 4]>,
        (bounds, homography): ([[f32; 3]; 2], Homography),
        (positions, first): (&Buffer<[f32; 4]>, usize),
        faults: &Buffer<u32>,
    ) -> Result<()> {
        super::holds("instance_positions", "faults", faults.len(), 1)?;
        super::holds("instance_positions", "positions", positions.len(), first + sources.len())?;
        let limits = stage.device.limits();
        transforms.check(instances, &limits)?;
        if sources.is_empty() {
            return Ok(());
        }
        let bound = transforms.elements().first_bound(&limits);
        let params = InstancePositionsParams {
            box_low: bounds[0],
            count: sources.len() as u32,
            box_high: bounds[1],
            offset: ((transforms.offset - bound) / 4) as u32,
            homography,
        };
        let params = self.uniforms.get(stage.device, &params)?;
        let bindings = kernel::Transform {
            params: params.as_uniform(),
            sources: sources.as_read(),
            vertices: vertices.as_read(),
            transforms: Read::from(transforms.buffer, bound),
            positions: positions.write_range(first, sources.len()),
            faults: faults.as_write(),
        };
        stage.run(&self.transform, bindings, Groups::Items(sources.len() as u64));
        Ok(())
    }
}
