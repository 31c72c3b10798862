// warped_query: depth comparison of every sample with its texel of a map whose axes are warped (`axes`,
// `borders`; see axis_table). A sample is lit where its texel's depth is not less than the receiver's less
// the bias: BIAS_CONSTANT, and BIAS_SLOPE times the greater of the receiver's changes of depth across the
// texel, along its width and along its height. Writes `visibility`: the mean over the samples whose rays
// meet the receiver.

//@import frame dispatch facing receiver axis_table

const WORKGROUP = 64u;

override BIAS_CONSTANT: f32 = 0.00002;
override BIAS_SLOPE: f32 = 1.0;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> axes: array<u32>;
@group(0) @binding(6) var<storage, read> borders: array<f32>;
@group(0) @binding(7) var<storage, read> keys: array<u32>;
@group(0) @binding(8) var<storage, read_write> visibility: array<f32>;

fn width_of(axis: u32, texel: u32) -> f32 { return border_of(axis, texel + 1u) - border_of(axis, texel); }

// 1 where nothing lies before a place; `slope`: the receiver's, depth per texel of the map.
fn lit_at(at: vec3<f32>, slope: vec2<f32>) -> f32 {
    if any(at.xy < vec2(0.0)) || any(at.xy >= vec2(f32(frame.map_size))) { return 1.0; }
    let texel = vec2(warped_texel(0u, at.x), warped_texel(1u, at.y));
    let across = abs(slope) * vec2(width_of(0u, texel.x), width_of(1u, texel.y));
    let depth = at.z - BIAS_CONSTANT - BIAS_SLOPE * max(across.x, across.y);
    let key = keys[texel.y * frame.map_size + texel.x];
    return select(0.0, 1.0, key == 0u || bitcast<f32>(~key) >= depth);
}

@compute @workgroup_size(WORKGROUP)
fn compare(
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
    // There is one at least. The loop ends before it begins a turn of which nothing is kept: a vector would
    // wait for it.
    var k = 0u;
    loop {
        let at = sample_place(r, pixel, k);
        if at.w != 0.0 {
            seen += 1.0;
            sum += lit_at(at.xyz, r.slope);
        }
        continuing {
            k++;
            break if k >= frame.sample_count;
        }
    }
    visibility[pixel] = select(sum / seen, 1.0, seen == 0.0);
}
