// The surface at a pixel by an application's texture of depths or positions, or by a sample of a multisampled
// one of depths (GIVEN_SAMPLES).

//@import frame facing finite strip
//@needs var<uniform> frame: Frame;
//@needs var<uniform> params: PixelReceiversParams;
//@needs var place: texture_2d<f32>;
//@needs var place_samples: texture_multisampled_2d<f32>;

const FARTHEST = 1e9;  // times the casters' distance: beyond it squares of squares leave f32

const GIVEN_POSITIONS = 1u;
const GIVEN_NORMALS = 2u;
const GIVEN_IDS = 4u;
const GIVEN_SAMPLES = 8u;         // depths are multisampled
const GIVEN_NORMAL_SAMPLES = 16u;  // normals are, too

struct PixelReceiversParams {
    // At view depth z, world units, the texture holds (x * z + y) / (z' * z + w), z' being its third; x is
    // that of the image's top left corner
    depth: vec4<f32>,
    nothing: f32,
    tolerance: f32,
    given: u32,
    first: u32,        // number of the application's first triangle
    none: u32,         // its number for no triangle
    sample: u32,       // of multisampled textures the one that is read
    tilt: vec2<f32>,   // what x gains per pixel right, per pixel down
    at: vec2<f32>,     // where in a pixel its surface is given
    pad: vec2<f32>,
}

const NOTHING = 0u;
const SURFACE = 1u;
const FAULT = 2u;

struct Place {
    point: vec3<f32>,  // relative to the eye, scaled
    world: vec3<f32>,
    depth: f32,        // view depth, scaled
    what: u32,
}

// The ray on which the surface of a pixel is given.
fn ray_of(at: vec2<i32>) -> vec3<f32> {
    let v = vec2<f32>(at) + params.at;
    return frame.ray_corner.xyz + v.x * frame.ray_x.xyz + (v.y + f32(frame.first_row)) * frame.ray_y.xyz;
}

fn place_at(at: vec2<i32>) -> Place {
    var p: Place;
    if any(at < vec2(0)) || any(at >= vec2<i32>(frame.image_size)) { return p; }
    let there = given_texel(vec2<u32>(at));
    var texel: vec4<f32>;
    if (params.given & GIVEN_SAMPLES) != 0u {
        texel = textureLoad(place_samples, there, params.sample);
    } else {
        texel = textureLoad(place, there, 0);
    }
    p.what = FAULT;
    if (params.given & GIVEN_POSITIONS) != 0u {
        if texel.w == 0.0 { p.what = NOTHING; }
        if p.what == NOTHING || !all_finite(texel.xyz) || !is_finite(texel.w) { return p; }
        p.world = texel.xyz;
        p.point = ((p.world - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w;
        p.depth = dot(p.point, frame.forward.xyz);
    } else {
        if texel.x == params.nothing { p.what = NOTHING; }
        let v = vec2<f32>(at) + vec2(params.at.x, params.at.y + f32(frame.first_row));
        let under = texel.x * params.depth.z - (params.depth.x + dot(v, params.tilt));
        if p.what == NOTHING || !is_finite(texel.x) || under == 0.0 { return p; }
        let depth = (params.depth.y - texel.x * params.depth.w) / under;
        p.depth = depth * frame.eye.w;
        let away = ray_of(at) * depth;
        p.point = away * frame.eye.w;
        p.world = frame.eye.xyz + (frame.eye_low.xyz + away);
    }
    if is_finite(p.depth) && p.depth > 0.0 && largest(p.point) < FARTHEST { p.what = SURFACE; }
    return p;
}
