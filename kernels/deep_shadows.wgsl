// deep_shadows: shadows by a deep shadow map (Lokovic and Veach 2000): the share of light that the four
// texels around a sample let pass to its receiver (`deep`, of `deep_map`), bilinearly. The receiver's depth
// is that of its plane at a texel's middle, less the bias: BIAS_CONSTANT, and BIAS_SLOPE times what the plane
// rises from a texel's middle to its corner, without which a texel's own steps would darken it. A texel is
// SUB x SUB of the map's. Writes `visibility`: the mean over the samples whose rays meet the receiver.

//@import frame dispatch facing receiver deep_nodes

override SUB: u32 = 4u;
override NODES: u32 = 7u;
override BIAS_CONSTANT: f32 = 0.00005;
override BIAS_SLOPE: f32 = 1.05;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> deep: array<u32>;
@group(0) @binding(6) var<storage, read_write> visibility: array<f32>;

// Light in a texel at a place of depth, of WHOLE.
fn light_in(texel: vec2<i32>, place: u32) -> f32 {
    let side = i32((frame.map_size + SUB - 1u) / SUB);
    if any(texel < vec2(0)) || any(texel >= vec2(side)) { return f32(WHOLE); }
    let at = u32(texel.y * side + texel.x) * (NODES + 1u);
    let count = deep[at] & 0xffffu;
    var before = deep[at + 1u];
    if count == 0u || place <= (before >> 8u) { return f32(WHOLE); }
    for (var k = 2u; k <= count; k++) {
        let node = deep[at + k];
        if place <= (node >> 8u) { return light_between(before, node, place); }
        before = node;
    }
    return f32(before & 0xffu);
}

fn lit_share(r: Receiver, at: vec3<f32>) -> f32 {
    let width = f32(SUB);
    let rise = 0.5 * width * (abs(r.slope.x) + abs(r.slope.y));
    let depth = at.z - BIAS_CONSTANT - BIAS_SLOPE * rise;
    let place = clamp(at.xy / width, vec2(-8.0), vec2(65536.0)) - 0.5;
    let low = vec2<i32>(floor(place));
    let part = place - floor(place);
    var light = 0.0;
    var whole = true;
    for (var k = 0; k < 4; k++) {
        let step = vec2(k & 1, k >> 1u);
        let texel = low + step;
        let weights = select(1.0 - part, part, step == vec2(1));
        let away = middle_of(texel) * width - at.xy;
        let found = light_in(texel, deep_place(depth + dot(r.slope, away)));
        light += weights.x * weights.y * found;
        whole = whole && found == f32(WHOLE);
    }
    // Rounding of the weights leaves no little dark in the light.
    return select(light / f32(WHOLE), 1.0, whole);
}

@compute @workgroup_size(WORKGROUP)
fn ask(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    if r.seen != SEEN_OPEN {
        visibility[pixel] = select(0.0, 1.0, r.seen == SEEN_NONE);
        return;
    }
    var sum = 0.0;
    var seen = 0.0;
    for (var k = 0u; k < frame.sample_count; k++) {
        let at = sample_place(r, pixel, k);
        if at.w == 0.0 { continue; }
        seen += 1.0;
        sum += lit_share(r, at.xyz);
    }
    visibility[pixel] = select(sum / seen, 1.0, seen == 0.0);
}
