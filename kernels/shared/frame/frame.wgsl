// Everything that is the same for all invocations of a frame. Lengths are eye-relative and scaled by a power
// of two, so that the scene is about as large as 1: `point = (position - eye) * scale`. The camera's eye is
// the origin.

struct Frame {
    eye: vec4<f32>,          // xyz: eye in world units; w: scale
    // xyz: what f32 leaves out of the eye; w: no caster is nearer along the light view's axis
    eye_low: vec4<f32>,
    light: vec4<f32>,        // homogeneous: direction towards the light and 0, or its point and 1
    // xyz: what f32 leaves out of the light; w: nearest distance along the light view's axis
    light_low: vec4<f32>,
    lamp: vec4<f32>,         // xyz: a light's point, of a directional one 0
    ray_corner: vec4<f32>,   // direction through the image's top left corner
    ray_x: vec4<f32>,        // change of direction for one pixel to the right
    ray_y: vec4<f32>,        // change of direction for one pixel down
    forward: vec4<f32>,      // xyz: view direction; w: near distance
    near_plane: vec4<f32>,   // inverse depth of the oblique near plane on a ray = dot(ray, xyz) + w
    pixel_x: vec4<f32>,      // image x of a point = dot(point, xyz) / dot(point, forward) + w
    pixel_y: vec4<f32>,
    map_u: vec4<f32>,        // light view: texel x = dot(from_lamp(point), map_u) / light w
    map_v: vec4<f32>,
    map_z: vec4<f32>,        // depth from the light, 0 at the nearest caster, growing away from the light
    map_w: vec4<f32>,
    back_u: vec4<f32>,       // columns of the inverse of the rows map_u, map_v, map_z, map_w
    back_v: vec4<f32>,
    back_z: vec4<f32>,
    back_w: vec4<f32>,
    image_size: vec2<u32>,
    map_size: u32,
    sample_count: u32,
    triangle_count: u32,
    edge_count: u32,
    vertex_count: u32,
    flags: u32,
    map_margin: f32,         // texels by which conservative tests reach out
    depth_margin: f32,       // depth by which they do
    first_facet: u32,        // the facets of this band
    facet_count: u32,
    pixel_texel_capacity: u32,
    triangle_texel_capacity: u32,
    candidate_capacity: u32,
    maps: u32,               // number of the light maps that the frame uses; 0 if it needs none
    facets_total: u32,
    pixel_triangle_capacity: u32,
    complex_capacity: u32,
    first_row: u32,          // of the image: pixels are those of a strip of rows
    rows_above: u32,         // at its top: they belong to the strip above
    rows_below: u32,         // likewise at its bottom
    seal: u32,               // always 0, and no condition asks for it: see double_float
    stamp: u32,              // which frame it is; no condition asks for it
    given_origin: vec2<u32>,   // texel of the application's G-buffer that the image's first pixel is
    target_origin: vec2<u32>,  // likewise of its target
    sample_low: vec2<f32>,   // box around the samples of a pixel, relative to its centre
    sample_high: vec2<f32>,
}

// Triangles of closed bodies that face away from the light are no casters; they may cut facets
const FLAG_CULL_BACK = 1u;
const FLAG_VALIDITY = 2u;       // keep the validity mask
const FLAG_PERSPECTIVE = 4u;    // the light is at a point: divide by the light's w
const FLAG_ALL_UNDECIDED = 8u;  // settle no facet before evaluation
const FLAG_CLAMP = 16u;         // a facet covers only its own triangle
const FLAG_BEYOND = 32u;        // with it: but may also cover samples beyond
// The mesh is closed, the light outside: what turns away from the light is dark on both sides
const FLAG_CLOSED = 64u;
const FLAG_MORE_VIEWS = 128u;   // another view of the light follows
const FLAG_FURTHER_VIEW = 256u; // this is not the first: what was found of facets is kept
const FLAG_CUT_LAYERS = 65536u; // layers hold casters that reach behind the light, where these cover a texel
// Four, one a side of the map (low x, high x, low y, high y): beyond it casters were left out
const FLAG_ENDS = 1024u;
// The view is a paraboloid one, of a light at a point
const FLAG_PARABOLOID = 262144u;
// A homography maps the world: texture coordinates of casters are those of the world
const FLAG_MAPPED = 524288u;
const FLAG_NOTHING_CASTS = 16384u; // a facet that faces the light is lit
// Triangles of closed bodies that face away from the eye lie behind others of these: no pixel sees them
const FLAG_BACKS_HIDDEN = 131072u;
const FLAG_NO_VIEW = 32768u;    // what lies outside the view may be in shadow, too
// The view is one of several: facets are settled only where all of them lies in it
const FLAG_ONE_OF_SEVERAL = 512u;

const NO_TRIANGLE = 0xffffffffu;
const FAR = 0x7f800000u;        // bits of +infinity: no surface at a texel
