// history: temporal reprojection with confidence (Scherzer, Jeschke, Wimmer 2007; Scherzer 2011, 4.6).
// Of each pixel the visibility of this frame, whose maps lie otherwise than those before, is mixed into that
// of the frames before at the same point: the more, the nearer the pixel's middle lies to the centre of its
// texel. It is the mean of all frames by their confidence, of which MOST at the most is remembered: not as in
// the paper, where the first frame counts in full. `blend` reads what was kept of the frame before (`past`:
// visibility, view depth or 0 where nothing lit is seen, sum of weights), changes `visibility` and writes
// `kept`, the same for the next frame.

//@import frame dispatch facing receiver view_choice

struct FrameBefore {
    // Of a point of this frame: to x and y in the image before, times the third, its view depth
    rows: array<vec4<f32>, 3>,
    eye: vec4<f32>,      // the eye before, a point of this frame; w: 1 if there is a frame before
    corner: vec4<f32>,   // directions of its rays in points of this frame, of view depth 1 before
    step_x: vec4<f32>,
    step_y: vec4<f32>,
}

override REACH: f32 = 1.0;   // texels
override POWER: u32 = 8u;    // of the confidence
const WORKGROUP = 64u;
const STEPS = 256.0;         // places in a pixel that are told apart: a camera at rest meets the same pixel
const MOST = 4.0;            // sum of weights
const LEAST = 1.0e-6;        // weight
const TOLERANCE = 0.01;      // share of its view depth by which a surface may be off its plane

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> before: FrameBefore;
@group(0) @binding(3) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(4) var<storage, read> id_keys: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> past: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> visibility: array<f32>;
@group(0) @binding(9) var<storage, read_write> kept: array<vec4<f32>>;

// The visibility that a point had before and the sum of its weights, bilinear over the pixels that saw its
// plane then, and their share.
fn past_at(r: Receiver, point: vec3<f32>) -> vec3<f32> {
    let p = vec4(point, 1.0);
    let depth = dot(before.rows[2], p);
    if !(before.eye.w * depth > 0.0) { return vec3(0.0); }
    let place = vec2(dot(before.rows[0], p), dot(before.rows[1], p)) / depth;
    let size = vec2<f32>(frame.image_size);
    if any(place < vec2(-1.0)) || any(place > size + 1.0) { return vec3(0.0); }
    let first = round(place * STEPS) / STEPS - 0.5;
    let low = floor(first);
    let part = first - low;
    var sum = vec3(0.0);
    for (var k = 0u; k < 4u; k++) {
        let corner = vec2<f32>(vec2(k & 1u, k >> 1u));
        let pixel = low + corner;
        let weights = mix(1.0 - part, part, corner);
        if any(pixel < vec2(0.0)) || any(pixel >= size) { continue; }
        let was = past[u32(pixel.y) * frame.image_size.x + u32(pixel.x)];
        let ray = before.corner + (pixel.x + 0.5) * before.step_x + (pixel.y + 0.5) * before.step_y;
        let expected = (r.height - dot(r.normal, before.eye.xyz)) / dot(r.normal, ray.xyz);
        if was.y > 0.0 && abs(was.y - expected) <= TOLERANCE * was.y {
            sum += weights.x * weights.y * vec3(was.x, was.z, 1.0);
        }
    }
    return vec3(sum.xy / max(sum.z, LEAST), sum.z);
}

// 1 at the centre of a texel, 0 at its sides; 1 outside the map, where all is lit.
fn confidence(r: Receiver, pixel: u32, point: vec4<f32>) -> f32 {
    let view = chosen_view(r, pixel);
    if inset(view, point) < 0.0 { return 1.0; }
    let off = abs(fract(texel_in(view, point.xyz).xy) - 0.5);
    return clamp(1.0 - 2.0 * max(off.x, off.y), 0.0, 1.0);
}

@compute @workgroup_size(WORKGROUP)
fn blend(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    var shown = visibility[pixel];
    var depth = 0.0;
    var total = LEAST;
    if r.seen == SEEN_OPEN {
        let point = plane_point(r, pixel_ray(pixel));
        depth = select(0.0, dot(frame.forward.xyz, point.xyz), point.w != 0.0);
        let was = past_at(r, point.xyz);
        let sure = confidence(r, pixel, point);
        var weight = 1.0;
        for (var k = 0u; k < POWER; k++) { weight *= sure; }
        total = max(weight, LEAST);
        if was.z > 0.0 && depth > 0.0 {
            total += was.y;
            // A value that is the same stays the same, to the bit.
            if was.x != shown { shown = was.x + max(weight, LEAST) / total * (shown - was.x); }
        }
    }
    visibility[pixel] = shown;
    kept[pixel] = vec4(shown, depth, min(total, MOST), 0.0);
}
