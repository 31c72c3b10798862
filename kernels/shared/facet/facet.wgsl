// Facets: surfaces inside one pixel each (Pan 2009, section 3.1). What only evaluation asks is apart: most
// facets are settled, and what is never touched costs no time.

//@import frame pixel_ray
//@needs var<uniform> frame: Frame;

struct Facet {
    pixel: u32,
    triangle: u32,      // the triangle whose plane it is
    state: u32,
    limit: f32,         // merged: view depth that its triangles reach
    origin: vec2<f32>,  // a sample of its coverage, relative to the pixel centre
    span: vec2<u32>,    // box around its coverage, packed as part_of reads it; with FLAG_CLAMP alone
}

// Undecided facet, as evaluation reads it.
struct Undecided {
    plane: vec4<f32>,   // dot(xyz, point) = w on it; the light and the eye lie where dot(xyz, point) > w
    pixel: u32,
    triangle: u32,
    rect: vec2<u32>,    // texels its light-view outline touches
    farthest: f32,      // its largest depth from the light
    limit: f32,         // view depth beyond which the plane is not followed
    origin: vec2<f32>,
    at: vec3<f32>,      // its point at the sample `origin`
    doubt: f32,         // how far rounding may have moved it along its ray, times -dot(plane.xyz, ray)
    box_low: vec2<f32>, // box of its outline, in texels
    box_high: vec2<f32>,
    slope: vec4<f32>,   // depth from the light = dot(slope.xyz, (x, y, 1)) in texels, give or take w
    tilt: f32,          // largest component of the normal's rounding, in units of 2^-24
    tilts: u32,         // shares of that of the three components, 8 bits each; FACET_ALONE, FACET_AWAY
    // Box around the samples it covers, lowest and highest corner packed; 0: the whole pixel
    span: vec2<u32>,
}

const FACET_ALONE = 0x1000000u;  // its samples all lie on its triangle
const FACET_AWAY = 0x2000000u;   // its triangle, the vertices by rising index, turns away from the light

// 1, or -1 where it turns away.
fn facet_turn(tilts: u32) -> f32 {
    return select(1.0, -1.0, (tilts & FACET_AWAY) != 0u);
}

// Rays to the corners of a part of the pixel, in order around.
struct PartRays { r0: vec3<f32>, r1: vec3<f32>, r2: vec3<f32>, r3: vec3<f32> }

fn part_rays(pixel: u32, span: vec4<f32>) -> PartRays {
    let centre = pixel_ray(pixel);
    let left = span.x * frame.ray_x.xyz;
    let right = span.z * frame.ray_x.xyz;
    let up = span.y * frame.ray_y.xyz;
    let down = span.w * frame.ray_y.xyz;
    return PartRays(centre + left + up, centre + right + up, centre + right + down, centre + left + down);
}

const STATE_EMPTY = 0u;      // no surface: counts as lit
const STATE_DARK = 1u;       // faces away from the light
const STATE_LIT = 2u;        // settled: nothing between it and the light
const STATE_SHADOWED = 3u;   // settled: one sheet covers all of it
const STATE_UNDECIDED = 4u;  // to be evaluated
// Before facets are classified: of several triangles, which reach no farther than `limit`
const STATE_MERGED = 5u;
const STATE_BITS = 7u;
const WAS_SETTLED = 16u;     // likewise: it is lit or shadowed whatever other views tell
const WAS_HELD = 32u;        // likewise: a view holds all of it, in which it is evaluated
const WAS_MERGED = 8u;       // beside the state, while views follow: it was STATE_MERGED

const PIXEL_REACH = 0.50390625;  // half a pixel and 1/256: samples lie well inside the outline

// A word of the mask of all samples.
fn full_word(word: u32) -> u32 {
    let left = frame.sample_count - 32u * word;
    return select((1u << left) - 1u, 0xffffffffu, left >= 32u);
}

// Lowest and highest corner of what a facet covers of its pixel, relative to the centre.
fn part_of(packed: vec2<u32>) -> vec4<f32> {
    if all(packed == vec2(0u)) { return vec4(-PIXEL_REACH, -PIXEL_REACH, PIXEL_REACH, PIXEL_REACH); }
    return vec4(unpack2x16snorm(packed.x), unpack2x16snorm(packed.y));
}
