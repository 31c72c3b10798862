// silhouette_map: shadows by depths at the centres of texels, and between four of them by the silhouette
// that crosses their cell (Sen, Cammarano, Hanrahan 2003). Where the four agree they tell. Else the cell's
// point (silhouette_points; its middle where there is none) is joined with those of the cells beside it, and
// the corner tells in whose part of the cell the sample lies. A corner is lit where its depth is not less
// than that of the receiver's plane there less the bias: BIAS_CONSTANT and BIAS_SLOPE times the steeper of
// the receiver's two slopes per texel, as surfaces bend. Writes `visibility`: the mean over the samples
// whose rays meet the receiver.

//@import frame dispatch facing receiver

override BIAS_CONSTANT: f32 = 0.00005;
override BIAS_SLOPE: f32 = 1.05;
const WORKGROUP = 64u;
const STEPS = 65534.0;  // across a cell

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> nearest_keys: array<u32>;
@group(0) @binding(6) var<storage, read> point_keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> visibility: array<f32>;

fn lit_at(texel: vec2<i32>, depth: f32) -> bool {
    let side = i32(frame.map_size);
    if any(texel < vec2(0)) || any(texel >= vec2(side)) { return true; }
    let key = nearest_keys[u32(texel.y * side + texel.x)];
    return key == 0u || bitcast<f32>(~key) >= depth;
}

// The point of a cell.
fn point_of(cell: vec2<i32>) -> vec2<f32> {
    let side = i32(frame.map_size) + 1;
    let middle = vec2<f32>(cell);
    if any(cell < vec2(0)) || any(cell >= vec2(side)) { return middle; }
    let key = point_keys[u32(cell.y * side + cell.x)];
    let place = (vec2(f32(key & 0xffffu), f32(key >> 16u)) - 1.0) / STEPS - 0.5;
    return middle + select(place, vec2(0.0), key == 0u);
}

// Positive where `p` lies clockwise of `way` in the image of the map, which runs right and down.
fn turn(way: vec2<f32>, p: vec2<f32>) -> f32 { return way.x * p.y - way.y * p.x; }

// The corner in whose part of a cell a place lies: 0 and 1 above, 2 and 3 below.
fn corner_of(cell: vec2<i32>, at: vec2<f32>) -> u32 {
    let middle = point_of(cell);
    let p = at - middle;
    let left = turn(point_of(cell - vec2(1, 0)) - middle, p);
    let above = turn(point_of(cell - vec2(0, 1)) - middle, p);
    let right = turn(point_of(cell + vec2(1, 0)) - middle, p);
    let below = turn(point_of(cell + vec2(0, 1)) - middle, p);
    if left > 0.0 && above <= 0.0 { return 0u; }
    if above > 0.0 && right <= 0.0 { return 1u; }
    if right > 0.0 && below <= 0.0 { return 3u; }
    if below > 0.0 && left <= 0.0 { return 2u; }
    // Two of the lines open by more than a half turn, or it is the point itself.
    return select(0u, 1u, p.x > 0.0) + select(0u, 2u, p.y > 0.0);
}

fn is_lit(r: Receiver, at: vec3<f32>) -> bool {
    let cell = vec2<i32>(floor(clamp(at.xy, vec2(-16.0), vec2(65536.0)) + 0.5));
    let bias = BIAS_CONSTANT + BIAS_SLOPE * max(abs(r.slope.x), abs(r.slope.y));
    var lit = 0u;
    for (var k = 0u; k < 4u; k++) {
        let texel = cell + vec2<i32>(vec2(k & 1u, k >> 1u)) - 1;
        let depth = at.z - bias + dot(r.slope, middle_of(texel) - at.xy);
        lit |= select(0u, 1u << k, lit_at(texel, depth));
    }
    var corner = 0u;
    // Few lie between: a loop that the others do not enter.
    for (var mixed = lit != 0u && lit != 15u; mixed; mixed = false) { corner = corner_of(cell, at.xy); }
    return ((lit >> corner) & 1u) != 0u;
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
        let meets = at.w != 0.0;
        seen += select(0.0, 1.0, meets);
        sum += select(0.0, 1.0, meets && is_lit(r, at.xyz));
        continuing {
            k++;
            break if k >= frame.sample_count;
        }
    }
    visibility[pixel] = select(sum / seen, 1.0, seen == 0.0);
}
