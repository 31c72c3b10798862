//! The facets of a pixel list, and which of them need no evaluation (Pan 2009, sections 3.1 and 3.3).
//!
//! - **Reads** the triangle at each pixel centre (or a list made elsewhere), triangles, positions, the summed-area table of the
//!   mask, the split depths.
//! - **Writes** [`Facet`]s, of undecided ones what evaluation asks ([`Undecided`]), their coverage masks, `pixel_facets` (first
//!   facet of each pixel, and the end), and `facet_items`: the 8 × 8 blocks of an undecided facet's rectangle, 0 for all others.
//! - **Guarantee.** A facet is settled only on proof (see `front_layer`); no depth bias exists. Which side of it light and
//!   eye see is decided with 46 bits where 24 leave it open; edge-on to either within 2^-40, it is dark.
//! - **Cost.** Three dispatches; 24 bytes a facet, 112 more if it is undecided.

use crate::Result;
use crate::frame::Frame;
use crate::gpu::kernels::facet_classify as kernel;
use crate::gpu::{Buffer, Groups, Stage};
use crate::shared_struct;
pub use crate::status::FacetState;

shared_struct! {
    /// Stands for a surface inside one pixel.
    "shared/facet/facet" => pub struct Facet {
        /// The pixel.
        pub pixel: u32,
        /// The triangle whose plane it is; `u32::MAX` if the pixel sees none.
        pub triangle: u32,
        /// One of [`FacetState`].
        pub state: u32,
        /// View depth that the triangles of a facet merged of several reach.
        pub limit: f32,
        /// A sample of its coverage, relative to the pixel centre.
        pub origin: [f32; 2],
        /// Box around its coverage, a 256th of a pixel wider: two corners, each two signed 16-bit shares. Read with
        /// [`Frame::CLAMP`](crate::frame::Frame::CLAMP) alone.
        pub span: [u32; 2],
    }
}

shared_struct! {
    /// Inputs of evaluation, of one facet.
    "shared/facet/facet" => pub struct Undecided {
        /// Plane: `dot(xyz, point) = w` on it, more on the side of the light and the eye.
        pub plane: [f32; 4],
        /// The pixel.
        pub pixel: u32,
        /// The triangle whose plane it is.
        pub triangle: u32,
        /// Texels its outline touches, packed corners.
        pub rect: [u32; 2],
        /// Largest depth from the light.
        pub farthest: f32,
        /// View depth beyond which the plane is not followed.
        pub limit: f32,
        /// A sample of its coverage, relative to the pixel centre: where `at` is.
        pub origin: [f32; 2],
        /// Point of the plane at the sample `origin`.
        pub at: [f32; 3],
        /// How far rounding may have moved the point along its ray, times `-dot(plane.xyz, ray)`.
        pub doubt: f32,
        /// Box of the light-view outline, texels.
        pub box_low: [f32; 2],
        /// Its other corner.
        pub box_high: [f32; 2],
        /// Depth from the light over texels: per x, per y, at 0, and how far it may be off.
        pub slope: [f32; 4],
        /// Largest component of the normal's rounding, in units of 2^-24.
        pub tilt: f32,
        /// Shares of that of the three components, 8 bits each; above them `FACET_ALONE` (all samples lie on the facet's own triangle) and
        /// `FACET_AWAY` (that turns away from the light, its vertices by rising index).
        pub tilts: u32,
        /// Box around the samples it covers, relative to the pixel centre: lowest and highest corner, each two 16-bit
        /// fractions; 0 is the whole pixel.
        pub span: [u32; 2],
    }
}

/// The pipelines for one number of mask words.
#[derive(Debug)]
pub struct FacetClassify {
    one: kernel::OneProgram,
    begin: kernel::BeginProgram,
    classify: kernel::ClassifyProgram,
    unsure: kernel::ClassifyUnsureProgram,
}

/// Buffers of the facets.
#[derive(Debug)]
pub struct Facets {
    /// The facets.
    pub list: Buffer<Facet>,
    /// Inputs of evaluation for those that are undecided; of others, nothing that counts.
    pub undecided: Buffer<Undecided>,
    /// Coverage, occluded and invalid mask of each facet, `words` words each.
    pub masks: Buffer<u32>,
    /// Blocks of each facet; then how many facets single precision could not place, and which.
    pub items: Buffer<u32>,
    /// First facet of each pixel, the end, and a flag: more than 2^32.
    pub pixel_facets: Buffer<u32>,
}

impl Facets {
    /// Memory for `count` facets of `pixels` pixels with masks of `words` words.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, count: usize, pixels: usize, words: usize) -> Result<Self> {
        Ok(Self {
            list: Buffer::storage(device, "facets.list", count)?,
            undecided: Buffer::storage(device, "facets.undecided", count)?,
            masks: Buffer::storage(device, "facets.masks", count * 3 * words)?,
            items: Buffer::storage(device, "facets.items", 2 * count + 1)?,
            pixel_facets: Buffer::storage(device, "facets.pixel_facets", pixels + 2)?,
        })
    }
}

/// Inputs of classification besides the facets.
#[derive(Clone, Copy, Debug)]
pub struct ClassifyInputs<'a> {
    /// Vertex indices, 16 bytes a triangle: three, and 1 for one of a closed body.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Positions, world units, 16 bytes a vertex: three `f32`, and a word that is not read.
    pub positions: &'a Buffer<[f32; 4]>,
    /// Summed-area table of the mask.
    pub sat: &'a Buffer<u32>,
    /// Split depths.
    pub splits: &'a Buffer<f32>,
}

impl FacetClassify {
    /// Builds the pipelines for masks of `words` words, for any frame.
    pub fn new(device: &wgpu::Device, words: u32) -> Self {
        Self::build(device, words, 2, true)
    }

    /// As [`FacetClassify::new`], for frames that set [`Frame::CLAMP`](crate::frame::Frame::CLAMP) as `clamp` says alone, and, without
    /// `receivers`, have no triangles behind those of the casters: less code to run.
    pub fn specialised(device: &wgpu::Device, words: u32, clamp: bool, receivers: bool) -> Self {
        Self::build(device, words, u32::from(clamp), receivers)
    }

    fn build(device: &wgpu::Device, words: u32, clamped: u32, receivers: bool) -> Self {
        let constants = kernel::Constants { words, clamped, receivers: u32::from(receivers) };
        Self {
            one: kernel::OneProgram::new(device, constants),
            begin: kernel::BeginProgram::new(device, constants),
            classify: kernel::ClassifyProgram::new(device, constants),
            unsure: kernel::ClassifyUnsureProgram::new(device, constants),
        }
    }

    /// Records the list of one facet a pixel.
    pub fn record_one(&self, stage: &mut Stage, frame: &Buffer<Frame>, id_keys: &Buffer<u32>, facets: &Facets) {
        let bindings = kernel::One {
            frame: frame.as_uniform(),
            id_keys: id_keys.as_read(),
            facets: facets.list.as_write(),
            masks: facets.masks.as_write(),
            pixel_facets: facets.pixel_facets.as_write(),
        };
        stage.run(&self.one, bindings, Groups::Items(facets.pixel_facets.len() as u64));
    }

    /// Records the classification of the listed facets, which take `groups`, one invocation each. What is beyond them must have
    /// no triangle, and its `items` be 0.
    pub fn record_classify(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        samples: &Buffer<[f32; 4]>,
        around: ClassifyInputs,
        facets: &Facets,
        groups: Groups,
    ) {
        let bindings = kernel::Classify {
            frame: frame.as_uniform(),
            samples: samples.as_uniform(),
            triangles: around.triangles.as_read(),
            positions: around.positions.as_read(),
            sat: around.sat.as_read(),
            splits: around.splits.as_read(),
            facets: facets.list.as_write(),
            masks: facets.masks.as_write(),
            facet_items: facets.items.as_write(),
            undecided: facets.undecided.as_write(),
        };
        stage.run(
            &self.begin,
            kernel::Begin { frame: frame.as_uniform(), facet_items: facets.items.as_write() },
            Groups::Workgroups(1),
        );
        stage.run(&self.classify, bindings, groups);
        // At most 64 an invocation: a device may cut loops off after 65,535 turns.
        let groups = (facets.list.len() as u64)
            .div_ceil(64 * u64::from(kernel::WORKGROUP))
            .max(u64::from(kernel::UNSURE_GROUPS));
        stage.run(&self.unsure, bindings, Groups::Strides(groups));
    }
}
