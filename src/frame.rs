//! The uniform that all kernels of a frame share.

use crate::light_view::{LightView, power_of_two_below, unit_scale};
use crate::samples::Samples;
use crate::scene::{Camera, Light};
use crate::shared_struct;
use glam::DVec3;

shared_struct! {
    /// The uniform `frame` of every kernel. Lengths are eye-relative and scaled: `point = (position - eye) * scale`.
    "shared/frame/frame" => pub struct Frame {
        /// Eye in world units, and the scale, a power of two.
        pub eye: [f32; 4],
        /// Remainder of the eye beyond `f32`; `w`: lower bound of a caster's distance along the light view's axis.
        pub eye_low: [f32; 4],
        /// Direction towards the light and 0, or its point and 1.
        pub light: [f32; 4],
        /// Remainder of the light beyond `f32`; `w`: nearest distance along the light view's axis.
        pub light_low: [f32; 4],
        /// Point from which the rows of the light view take points: the light's, 0 of a directional one.
        pub lamp: [f32; 4],
        /// Direction through the image's top left corner; `w`: the largest component of any ray of the image.
        pub ray_corner: [f32; 4],
        /// Change of direction for one pixel to the right.
        pub ray_x: [f32; 4],
        /// Change of direction for one pixel down.
        pub ray_y: [f32; 4],
        /// View direction; `w`: near distance.
        pub forward: [f32; 4],
        /// Inverse view depth of the oblique near plane on a ray is `dot(ray, xyz) + w`; without such a plane at the eye.
        pub near_plane: [f32; 4],
        /// Image x of a point is `dot(point, xyz) / dot(point, forward) + w`.
        pub pixel_x: [f32; 4],
        /// Likewise image y.
        pub pixel_y: [f32; 4],
        /// Light view, row of texel x; of a paraboloid view see `LightView::paraboloid`.
        pub map_u: [f32; 4],
        /// Light view, row of texel y.
        pub map_v: [f32; 4],
        /// Light view, row of depth.
        pub map_z: [f32; 4],
        /// Light view, row of the divisor.
        pub map_w: [f32; 4],
        /// Inverse of the rows of the light view, column u.
        pub back_u: [f32; 4],
        /// Inverse of the rows of the light view, column v.
        pub back_v: [f32; 4],
        /// Inverse of the rows of the light view, column z.
        pub back_z: [f32; 4],
        /// Inverse of the rows of the light view, column w.
        pub back_w: [f32; 4],
        /// Pixels.
        pub image_size: [u32; 2],
        /// Texels a side.
        pub map_size: u32,
        /// Samples a pixel.
        pub sample_count: u32,
        /// Triangles.
        pub triangle_count: u32,
        /// Edges.
        pub edge_count: u32,
        /// Vertices.
        pub vertex_count: u32,
        /// Flags: see `Frame::CULL_BACK` and its neighbours.
        pub flags: u32,
        /// Texels by which conservative tests reach out.
        pub map_margin: f32,
        /// Depth by which they do.
        pub depth_margin: f32,
        /// First facet of this band.
        pub first_facet: u32,
        /// Facets of this band.
        pub facet_count: u32,
        /// Pixel-texel pairs the list can hold.
        pub pixel_texel_capacity: u32,
        /// Triangle-texel pairs the list can hold.
        pub triangle_texel_capacity: u32,
        /// Candidates the list can hold.
        pub candidate_capacity: u32,
        /// Number of the light maps that the frame uses; 0 if it needs none. No condition may ask for it.
        pub maps: u32,
        /// Facets of all bands; the capacity of their list where only the GPU knows their number.
        pub facets_total: u32,
        /// Triangles that the lists of all pixels can hold.
        pub pixel_triangle_capacity: u32,
        /// Most pixels with several surfaces that can be searched.
        pub complex_capacity: u32,
        /// First row of the image that the frame is a strip of.
        pub first_row: u32,
        /// Rows at its top that belong to the strip above.
        pub rows_above: u32,
        /// Rows at its bottom that belong to the strip below.
        pub rows_below: u32,
        /// Always 0. Arithmetic of two `f32` goes through it, so that no compiler takes it apart: nothing else may ask for it, for
        /// some drivers (llvmpipe) compile a kernel anew for the values that its conditions ask for.
        pub seal: u32,
        /// Which frame it is: the last stage writes it down when it has run. No condition may ask for it either.
        pub stamp: u32,
        /// Texel of the application's G-buffer that the image's first pixel is.
        pub given_origin: [u32; 2],
        /// Texel of its target that it is.
        pub target_origin: [u32; 2],
        /// Lowest corner of the box around a pixel's samples, relative to its centre, pixels.
        pub sample_low: [f32; 2],
        /// Highest corner of it.
        pub sample_high: [f32; 2],
    }
}

impl Frame {
    /// Triangles of closed bodies that face away from the light are no casters; with [`Frame::VALIDITY`] they may cut facets.
    pub const CULL_BACK: u32 = 1;
    /// Inverse depth of a near plane that nothing lies before.
    const NO_NEAR_PLANE: f32 = 1e30;
    /// The bit from which on eight tell the layers that the light is not in.
    pub const NO_LAYERS: u32 = 24;
    /// Keep the validity mask.
    pub const VALIDITY: u32 = 2;
    /// The light is at a point.
    pub const PERSPECTIVE: u32 = 4;
    /// Settle no facet before evaluation.
    pub const ALL_UNDECIDED: u32 = 8;
    /// A facet covers only its own triangle, and pixels count by their squares, not their centres.
    pub const CLAMP: u32 = 16;
    /// With it: a facet may also cover samples beyond its triangle.
    pub const BEYOND: u32 = 32;
    /// The mesh is closed, and the light outside: triangles that turn away from the light are dark on both sides.
    pub const CLOSED: u32 = 64;
    /// The view is one of several: see [`LightView::one_of_several`].
    pub const ONE_OF_SEVERAL: u32 = 512;
    /// The first of four flags, one a side of the map: see [`LightView::ends`].
    pub const ENDS: u32 = 1024;
    /// The view is a [paraboloid](LightView::paraboloids) one.
    pub const PARABOLOID: u32 = 262_144;
    /// A homography maps the world: texture coordinates of casters are those of the world.
    pub const MAPPED: u32 = 524_288;
    /// Another view of the light follows.
    pub const MORE_VIEWS: u32 = 128;
    /// Nothing casts a shadow: a facet that faces the light is lit.
    pub const NOTHING_CASTS: u32 = 16384;
    /// The eye and what is nearer than the near distance are outside all closed bodies: what faces away from the eye of these is hidden.
    pub const BACKS_HIDDEN: u32 = 131072;
    /// Nothing is known of what lies outside the light's view.
    pub const NO_VIEW: u32 = 32768;
    /// The two nearest layers hold casters that reach behind the light, where these cover a texel.
    pub const CUT_LAYERS: u32 = 65536;
    /// This is not the first view of the light: what was found of facets is kept.
    pub const FURTHER_VIEW: u32 = 256;

    /// The frame of a camera, a light and its view of a scene that lies between two corners.
    /// Counts of the mesh, lists and bands are left at 0.
    pub fn new(
        camera: &Camera,
        light: &Light,
        view: &LightView,
        bounds: (DVec3, DVec3),
        [width, height]: [u32; 2],
        samples: &Samples,
    ) -> Self {
        let rays = camera.rays(width, height);
        let eye = rays.eye;
        let scale = unit_scale(eye, bounds);
        let v = view.relative_to(eye, scale);
        let back = glam::DMat4::from_cols(v.u, v.v, v.z, v.w).transpose().inverse();
        let l = light.homogeneous();
        let to_light = if l.w == 0.0 {
            l.truncate() * power_of_two_below(1.0 / l.truncate().abs().max_element())
        } else {
            (l.truncate() - eye) * scale
        };
        let across = |step: DVec3| {
            let axis = step / step.length_squared();
            axis.extend(-axis.dot(rays.corner))
        };
        let margins = v.margins();
        let [sample_low, sample_high] = sample_box(samples);
        let widest = rays.corners(width, height).map(|ray| ray.abs().max_element()).into_iter().fold(0.0, f64::max);
        let (eye_high, eye_low) = split(eye);
        let (light_high, light_low) = split(to_light);
        Self {
            eye: eye_high.extend(scale).as_vec4().into(),
            eye_low: eye_low.extend(v.clear_of_rounding()).as_vec4().into(),
            light: light_high.extend(l.w).as_vec4().into(),
            light_low: light_low.extend(v.near).as_vec4().into(),
            lamp: v.lamp_of_rows().extend(0.0).as_vec4().into(),
            ray_corner: rays.corner.extend(widest).as_vec4().into(),
            ray_x: rays.step_x.extend(0.0).as_vec4().into(),
            ray_y: rays.step_y.extend(0.0).as_vec4().into(),
            forward: rays.forward.extend(f64::from(camera.near) * scale).as_vec4().into(),
            near_plane: match camera.near_plane {
                Some(_) => (rays.near_plane / scale).extend(0.0).as_vec4().into(),
                None => [0.0, 0.0, 0.0, Self::NO_NEAR_PLANE],
            },
            pixel_x: across(rays.step_x).as_vec4().into(),
            pixel_y: across(rays.step_y).as_vec4().into(),
            map_u: v.row_from_lamp(v.u).as_vec4().into(),
            map_v: v.row_from_lamp(v.v).as_vec4().into(),
            map_z: v.row_from_lamp(v.z).as_vec4().into(),
            map_w: v.row_from_lamp(v.w).as_vec4().into(),
            back_u: back.x_axis.as_vec4().into(),
            back_v: back.y_axis.as_vec4().into(),
            back_z: back.z_axis.as_vec4().into(),
            back_w: back.w_axis.as_vec4().into(),
            image_size: [width, height],
            map_size: view.map_size,
            sample_count: samples.count(),
            sample_low,
            sample_high,
            flags: if view.perspective { Self::PERSPECTIVE } else { 0 }
                | if view.paraboloid.is_some() { Self::PARABOLOID } else { 0 }
                | if view.closed { Self::CLOSED } else { 0 }
                | if view.one_of_several { Self::ONE_OF_SEVERAL } else { 0 }
                | (0..4).map(|side| u32::from(view.ends[side]) * (Self::ENDS << side)).sum::<u32>(),
            map_margin: margins.texels as f32,
            depth_margin: margins.depth as f32,
            ..Self::default()
        }
    }
}

/// A vector as `f32` values and the remainder.
fn split(v: DVec3) -> (DVec3, DVec3) {
    let high = v.as_vec3().as_dvec3();
    (high, v - high)
}

/// The sample offsets as the kernels take them: relative to the pixel centre, two to a vector, 128 in all.
pub fn sample_words(samples: &Samples) -> [[f32; 4]; 64] {
    let mut words = [[0.0; 4]; 64];
    for (k, o) in samples.offsets().iter().enumerate() {
        words[k / 2][k % 2 * 2] = o[0] - 0.5;
        words[k / 2][k % 2 * 2 + 1] = o[1] - 0.5;
    }
    words
}

/// Lowest and highest corner of the box around the samples, relative to the pixel centre, pixels.
pub fn sample_box(samples: &Samples) -> [[f32; 2]; 2] {
    let along = |axis: usize| samples.offsets().iter().map(move |o| o[axis] - 0.5);
    [[0, 1].map(|axis| along(axis).fold(0.5, f32::min)), [0, 1].map(|axis| along(axis).fold(-0.5, f32::max))]
}
