//! Surface of each pixel, from an application's depth or position texture: casters, and surfaces that cast nothing.
//!
//! - **Reads** a texture of depths (of a multisampled one a sample of each pixel) or world positions, if given world normals and triangle numbers. Where none are given, the casters' triangle at
//!   each pixel centre (`camera_visibility`), and the blocks of pixels that casters may touch: a pixel shows a caster if its surface lies on one, seen
//!   or not, give or take a tolerance.
//! - **Writes** `keys`: complement of each pixel's triangle, 0 where there is none. Of a pixel that shows no caster it is number
//!   `triangle_count + pixel`, whose three vertices, from `vertex_count + 3 * pixel` on, the stage writes around the pixel's
//!   surface: on the plane of its normal, as far from it as its coordinates are large, so that rounding turns it by less than
//!   2^-20. Without normals the plane is that of the nearest pixels in its row and column that show no caster, at most 4
//!   away, of two the one whose depth differs less. Counts into `faults` texels that name no triangle ([`FAULT_UNKNOWN`]) and those that are no place or
//!   normal ([`FAULT_UNUSABLE`]); both count as none.
//! - **Strips.** Of a strip of rows ([`Frame::first_row`](crate::frame::Frame)) textures are still the whole image's, pixels and keys the
//!   strip's. Neighbours are looked for in the strip alone: it must hold [`MOST_STEPS`] rows of other strips around its own.
//!   Faults count in its own rows.
//! - **Guarantee.** Same inputs, same bits.
//! - **Cost.** One dispatch over pixels: without normals five texels or more; 52 bytes a pixel are written. Without numbers another, and one over
//!   blocks of casters, which look at pixels that show no caster at their centre.

use super::camera_visibility::Blocks;
use crate::Result;
use crate::frame::Frame;
use crate::gpu::bindings::{TextureFloat, TextureFloatSamples, TextureUint};
use crate::gpu::kernels::pixel_receivers as kernel;
pub use crate::gpu::kernels::pixel_receivers::{
    FAULT_UNKNOWN, FAULT_UNUSABLE, GIVEN_IDS, GIVEN_NORMAL_SAMPLES, GIVEN_NORMALS, GIVEN_POSITIONS, GIVEN_SAMPLES,
    MOST_STEPS,
};
use crate::gpu::{Buffer, Groups, Stage, Uniforms};
use crate::shared_struct;

shared_struct! {
    /// Contents of an application's textures.
    "shared/frame/given_place" => pub struct PixelReceiversParams {
        /// At view depth `z`, world units, the texture holds `([0] * z + [1]) / ([2] * z + [3])`; `[0]` is that of the image's top left corner.
        pub depth: [f32; 4],
        /// The depth for no surface.
        pub nothing: f32,
        /// How far from a caster's plane its surface may be said to be, in view depths.
        pub tolerance: f32,
        /// [`GIVEN_POSITIONS`], [`GIVEN_NORMALS`], [`GIVEN_IDS`]; of multisampled textures [`GIVEN_SAMPLES`], [`GIVEN_NORMAL_SAMPLES`].
        pub given: u32,
        /// The number of the application's first triangle.
        pub first: u32,
        /// Its number for no triangle of the casters.
        pub none: u32,
        /// Of multisampled textures the sample that is read.
        pub sample: u32,
        /// By how much `depth[0]` grows per pixel right and per pixel down: of an oblique near plane.
        pub tilt: [f32; 2],
        /// Where in a pixel its surface is given: `[0, 1)`, x to the right, y down.
        pub at: [f32; 2],
        /// Unused.
        pub pad: [f32; 2],
    }
}

impl PixelReceiversParams {
    /// Parameters of surfaces that are given at pixel centres.
    pub fn at_centres() -> Self {
        Self { at: [0.5; 2], ..Self::default() }
    }
}

/// A texture of one sample a texel, or a multisampled one; the other is bound but not read.
#[derive(Clone, Copy, Debug)]
pub struct GivenTexture<'a> {
    /// Of one sample.
    pub single: &'a wgpu::TextureView,
    /// Of several.
    pub samples: &'a wgpu::TextureView,
}

/// Makes a multisampled texture to be bound where none is given.
pub fn unread_samples(device: &wgpu::Device) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("pixel_receivers.unread_samples"),
        size: wgpu::Extent3d::default(),
        mip_level_count: 1,
        sample_count: 4,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Texture views, all of the size of the image; what `given` does not name is bound but not read.
#[derive(Clone, Copy, Debug)]
pub struct Textures<'a> {
    /// Depth (`Depth32Float`, `R32Float`) or positions (`Rgba32Float`, of one sample).
    pub place: GivenTexture<'a>,
    /// Normals (`Rgba16Float`, `Rgba32Float`, this one of one sample).
    pub normals: GivenTexture<'a>,
    /// Triangle numbers (`R32Uint`).
    pub ids: &'a wgpu::TextureView,
}

/// The casters, with room for a triangle and three vertices a pixel behind them.
#[derive(Clone, Copy, Debug)]
pub struct ReceiverRoom<'a> {
    /// The casters' number of each triangle of the application.
    pub numbers: &'a Buffer<u32>,
    /// Vertex indices.
    pub triangles: &'a Buffer<[u32; 4]>,
    /// Positions, world units.
    pub positions: &'a Buffer<[f32; 4]>,
}

/// Casters seen: their blocks of pixels, and the complement of that at each pixel centre. Not read where triangle numbers are given.
#[derive(Clone, Copy, Debug)]
pub struct SeenCasters<'a> {
    /// The blocks.
    pub blocks: Blocks<'a>,
    /// The keys.
    pub id_keys: &'a Buffer<u32>,
}

/// State of each pixel.
#[derive(Debug)]
pub struct ReceiverKeys {
    /// Complement of its triangle, 0 where there is none.
    pub keys: Buffer<u32>,
    /// Caster on which its surface lies, while it is looked for.
    pub claims: Buffer<u32>,
}

impl ReceiverKeys {
    /// Memory for so many pixels.
    ///
    /// # Errors
    /// As [`Buffer::storage`].
    pub fn new(device: &wgpu::Device, pixels: usize) -> Result<Self> {
        Ok(Self {
            keys: Buffer::storage(device, "pixel_receivers.keys", pixels)?,
            claims: Buffer::storage(device, "pixel_receivers.claims", pixels)?,
        })
    }
}

/// The pipelines.
#[derive(Debug)]
pub struct PixelReceivers {
    find: kernel::FindProgram,
    claim: kernel::ClaimProgram,
    take: kernel::TakeProgram,
    uniforms: Uniforms,
}

impl PixelReceivers {
    /// Builds the pipelines; `alpha`: casters may be alpha-tested.
    pub fn new(device: &wgpu::Device, alpha: bool) -> Self {
        let constants = kernel::Constants { alpha: u32::from(alpha) };
        Self {
            find: kernel::FindProgram::new(device, constants),
            claim: kernel::ClaimProgram::new(device, constants),
            take: kernel::TakeProgram::new(device, constants),
            uniforms: Uniforms::default(),
        }
    }

    /// Records the stage for as many pixels as `to` holds.
    ///
    /// # Errors
    /// [`crate::Error::Config`] if `faults` or the keys of casters are too short, or there is no room behind the casters.
    #[expect(clippy::too_many_arguments, reason = "one argument a group of buffers, inputs first")]
    pub fn record(
        &self,
        stage: &mut Stage,
        frame: &Buffer<Frame>,
        params: PixelReceiversParams,
        textures: Textures,
        surfaces: ReceiverRoom,
        casters: SeenCasters,
        to: &ReceiverKeys,
        faults: &Buffer<u32>,
    ) -> Result<()> {
        let ReceiverKeys { keys, claims } = to;
        let SeenCasters { blocks, id_keys } = casters;
        let pixels = keys.len();
        let room = |bytes: u64, element: usize, len: usize| (bytes as usize / element).saturating_sub(len);
        let (triangles, positions) = (surfaces.triangles, surfaces.positions);
        super::holds("pixel_receivers", "faults", faults.len(), FAULT_UNUSABLE as usize + 1)?;
        super::holds("pixel_receivers", "id_keys", id_keys.len(), pixels)?;
        super::holds("pixel_receivers", "triangles", room(triangles.bytes(), 16, triangles.len()), pixels)?;
        super::holds("pixel_receivers", "positions", room(positions.bytes(), 16, positions.len()), 3 * pixels)?;
        let numbers_given = params.given & GIVEN_IDS != 0;
        let params = self.uniforms.get(stage.device, &params)?;
        let (frame, params) = (frame.as_uniform(), params.as_uniform());
        let place = TextureFloat(textures.place.single);
        let place_samples = TextureFloatSamples(textures.place.samples);
        let (claims, places) = (claims.as_write(), positions.as_write());
        if !numbers_given {
            let id_keys = id_keys.as_read();
            let bindings = kernel::Find {
                frame,
                params,
                place,
                place_samples,
                id_keys,
                triangles: triangles.as_read(),
                positions: places,
                claims,
            };
            stage.run(&self.find, bindings, Groups::Items(pixels as u64));
            let bindings = kernel::Claim {
                frame,
                params,
                place,
                place_samples,
                triangles: triangles.as_read(),
                positions: places,
                claims,
                camera_rects: blocks.rects.as_read(),
                work_offsets: blocks.offsets.as_read(),
            };
            stage.run(&self.claim, bindings, Groups::Indirect(blocks.args.0, blocks.args.1));
        }
        let bindings = kernel::Take {
            frame,
            params,
            place,
            place_samples,
            normals: TextureFloat(textures.normals.single),
            normal_samples: TextureFloatSamples(textures.normals.samples),
            ids: TextureUint(textures.ids),
            numbers: surfaces.numbers.as_read(),
            made_triangles: triangles.as_write(),
            positions: places,
            keys: keys.as_write(),
            claims,
            faults: faults.as_write(),
        };
        stage.run(&self.take, bindings, Groups::Items(pixels as u64));
        Ok(())
    }
}
