// The picture: the mesh with flat shading times visibility, of the left half on one side of the wipe and of the right half on the other.

struct View {
    clip: mat4x4<f32>,
    eye: vec4<f32>,
    // Towards the light, or its place with 1 in w.
    light: vec4<f32>,
    // Axis of a spot light and the cosine of half its angle; -2 there for others.
    cone: vec4<f32>,
    size: vec2<f32>,
    // Pixels left of it show the left half.
    wipe: f32,
    overlay: u32,
    // Whether the left and the right half have counts, and which of them is shown: 0 classes.
    counted: vec4<u32>,
    palette: array<vec4<f32>, 12>,
}

const SHADED = 0u;
const VISIBILITY = 1u;
const DIFFERENCE = 2u;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> triangles: array<vec4<u32>>;  // w: 2 or more of one with holes, see alpha
@group(1) @binding(0) var left_visibility: texture_2d<f32>;
// Below 0: not known yet.
@group(1) @binding(1) var right_visibility: texture_2d<f32>;
@group(1) @binding(2) var<storage, read> left_counts: array<vec4<u32>>;
@group(1) @binding(3) var<storage, read> right_counts: array<vec4<u32>>;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) place: vec3<f32>,
    @location(1) @interpolate(flat, either) normal: vec3<f32>,
    @location(2) shares: vec2<f32>,
    @location(3) @interpolate(flat, either) holes: u32,
}

@vertex
fn draw(@builtin(vertex_index) i: u32) -> Corner {
    let given = triangles[i / 3u];
    let k = i % 3u;
    let a = positions[given.x].xyz;
    let normal = cross(positions[given.y].xyz - a, positions[given.z].xyz - a);
    let place = positions[given[k]].xyz;
    let shares = select(vec2(0.0), vec2(1.0), vec2(k == 1u, k == 2u));
    return Corner(view.clip * vec4(place, 1.0), place, normal, shares, given.w);
}

// Tells halves apart: their visibility, and by how much it differs.
struct Halves { shown: f32, known: bool, difference: f32 }

fn halves(at: vec2<f32>) -> Halves {
    let texel = vec2<u32>(at);
    let left = textureLoad(left_visibility, texel, 0).x;
    let right = textureLoad(right_visibility, texel, 0).x;
    let known = right >= 0.0;
    let of_right = at.x >= view.wipe;
    let shown = select(left, right, of_right && known);
    return Halves(shown, known || !of_right, select(0.0, right - left, known));
}

fn spot(to_light: vec3<f32>) -> f32 {
    if view.cone.w < -1.0 { return 1.0; }
    let rim = view.cone.w;
    let t = clamp((dot(view.cone.xyz, to_light) - rim) / max(0.1 * (1.0 - rim), 1e-9), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// Places of the samples of a pixel, from its centre.
const SAMPLES = array(vec2(-0.125, -0.375), vec2(0.375, -0.125), vec2(-0.375, 0.125), vec2(0.125, 0.375));

// Samples of a pixel at which the triangle is there.
fn solid(holes: u32, shares: vec2<f32>, right: vec2<f32>, down: vec2<f32>) -> u32 {
    if holes < 2u { return 15u; }
    var samples = SAMPLES;
    var mask = 0u;
    for (var k = 0u; k < 4u; k++) {
        let at = shares + samples[k].x * right + samples[k].y * down;
        mask |= select(0u, 1u << k, is_solid_by(holes, at));
    }
    return mask;
}

struct Painted {
    @location(0) colour: vec4<f32>,
    @builtin(sample_mask) samples: u32,
}

@fragment
fn shade(at: Corner) -> Painted {
    let samples = solid(at.holes, at.shares, dpdx(at.shares), dpdy(at.shares));
    return Painted(colour_of(at), samples);
}

fn colour_of(at: Corner) -> vec4<f32> {
    let seen = halves(at.clip.xy);
    if view.overlay == VISIBILITY {
        return vec4(vec3(seen.shown * seen.shown), 1.0);
    }
    let squared = max(dot(at.normal, at.normal), 1e-30);
    var normal = at.normal * inverseSqrt(squared);
    if dot(normal, view.eye.xyz - at.place) < 0.0 { normal = -normal; }
    let to_light = normalize(view.light.xyz - at.place * view.light.w);
    let diffuse = max(dot(normal, to_light), 0.0) * spot(to_light);
    let ambient = mix(vec3(0.16, 0.15, 0.13), vec3(0.30, 0.36, 0.45), 0.5 + 0.5 * normal.y);
    var colour = vec3(0.70, 0.67, 0.62) * (ambient + vec3(0.95, 0.90, 0.80) * diffuse * seen.shown);
    // A half without counts.
    if view.overlay > DIFFERENCE { return vec4(vec3(0.25 * dot(colour, vec3(0.3, 0.6, 0.1))), 1.0); }
    if view.overlay == DIFFERENCE {
        let grey = vec3(0.15 * dot(colour, vec3(0.3, 0.6, 0.1)));
        let more = vec3(1.0, 0.45, 0.05) * max(seen.difference, 0.0);
        colour = grey + more + vec3(0.05, 0.5, 1.0) * max(-seen.difference, 0.0);
    }
    // Not traced yet: the left half, bluish.
    if !seen.known { colour *= vec3(0.55, 0.65, 0.85); }
    return vec4(colour, 1.0);
}

struct Sky { @builtin(position) clip: vec4<f32> }

@vertex
fn sky_corner(@builtin(vertex_index) i: u32) -> Sky {
    return Sky(vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0));
}

@fragment
fn sky(at: Sky) -> @location(0) vec4<f32> {
    let colour = mix(vec3(0.42, 0.47, 0.54), vec3(0.70, 0.73, 0.76), at.clip.y / view.size.y);
    return vec4(colour * select(1.0, 0.15, view.overlay >= DIFFERENCE), 1.0);
}

// The step of the scale that a number is on: 0, 1, 2, then up to each power of two.
fn step_of(n: u32) -> u32 {
    if n == 0u { return 0u; }
    return min(33u - countLeadingZeros(n - 1u), 10u);
}

@fragment
fn counted(at: Sky) -> @location(0) vec4<f32> {
    let of_right = at.clip.x >= view.wipe;
    if select(view.counted.x, view.counted.y, of_right) == 0u { discard; }
    let texel = vec2<u32>(at.clip.xy);
    let pixel = texel.y * u32(view.size.x) + texel.x;
    var counts = vec4(0u);
    if of_right { counts = right_counts[pixel]; } else { counts = left_counts[pixel]; }
    let n = counts[view.counted.z];
    return view.palette[select(step_of(n), min(n, 4u), view.counted.z == 0u)];
}
