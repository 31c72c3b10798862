// kept_triangles: shadows of the triangles that a light-view map keeps (Dai, Yang, Feng 2008): each texel
// the one that is nearest at its centre (light_layers with NEAREST_TRIANGLE). A sample asks the triangles of
// LOOKUPS x LOOKUPS texels around its own, and is in shadow where the line from its point on the receiver to
// the light meets one of them, but the receiver's own, by more than BIAS nearer to the light. A triangle at
// an edge of the receiver's, on the other side of it seen from the light, shadows none of it: beside an edge
// the receiver's plane may run below. Writes `visibility`: the mean over the samples whose rays meet the
// receiver.

//@import frame dispatch facing receiver beside alpha mapped_view roles

override LOOKUPS: u32 = 5u;
override BIAS: f32 = 0.00001;
override WORDS: u32 = 1u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> triangle_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> visibility: array<f32>;

// The side on which a line along `way` passes an edge, whose ends are relative to a point of it.
fn side_of(a: vec3<f32>, b: vec3<f32>, way: vec3<f32>) -> f32 { return dot(cross(a, b), way); }

// Whether a triangle lies between a point at some depth and the light; `given`: its corners as they are
// given, and its fourth word.
fn meets(c: Corners, given: vec4<u32>, point: vec3<f32>, depth: f32) -> bool {
    let a = c.a - point;
    let b = c.b - point;
    let d = c.c - point;
    let way = to_light(point);
    let v = vec3(side_of(b, d, way), -side_of(a, d, way), side_of(a, b, way));
    let all_of = v.x + v.y + v.z;
    if !(all(v >= vec3(0.0)) || all(v <= vec3(0.0))) || all_of == 0.0 { return false; }
    let shares = v / all_of;
    let at = point + shares.x * a + shares.y * b + shares.z * d;
    if !(depth_of(at) < depth - BIAS) { return false; }
    if ALPHA == 0u || !is_tested(given.w) { return true; }
    if !casts(given.w) { return false; }
    let card = Card(points[given.x].xyz, points[given.y].xyz, points[given.z].xyz, mapped_ahead());
    return is_solid(given.w, card, point, way);
}

// Samples of `group`, all in one texel, that are in shadow.
fn shadowed_of(r: Receiver, own: Own, pixel: u32, texel: vec2<i32>, group: vec4<u32>) -> vec4<u32> {
    var dark = vec4(0u);
    var last = own.t;
    var n = 0u;
    while n < LOOKUPS * LOOKUPS && any(dark != group) {
        // Few texels keep another triangle than the one before them: a loop that the others do not enter.
        var t = last;
        while n < LOOKUPS * LOOKUPS && (t == last || t == own.t || t == frame.triangle_count) {
            let step = vec2(n % LOOKUPS, n / LOOKUPS);
            t = kept_in(texel + vec2<i32>(step) - vec2(i32(LOOKUPS / 2u)));
            n++;
        }
        if t == last || t == own.t || t == frame.triangle_count { break; }
        last = t;
        let c = corners_of(t);
        if is_beside(own, c) { continue; }
        let given = triangles[t];
        for (var w = 0u; w < WORDS; w++) {
            for (var left = group[w] & ~dark[w]; left != 0u; left &= left - 1u) {
                let point = plane_point(r, sample_ray(pixel, 32u * w + firstTrailingBit(left)));
                let hit = meets(c, given, point.xyz, place_at(point).z);
                dark[w] |= select(0u, left & (0u - left), hit);
            }
        }
    }
    return dark;
}

@compute @workgroup_size(WORKGROUP)
fn look_up(
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
    let own = own_of(r, ~id_keys[pixel]);
    var open = vec4(0u);    // samples still to be judged: those whose rays meet the plane
    for (var k = 0u; k < frame.sample_count; k++) {
        open[k >> 5u] |= select(0u, 1u << (k & 31u), sample_place(r, pixel, k).w != 0.0);
    }
    let counted = open;
    var dark = vec4(0u);
    for (var w = 0u; w < WORDS; w++) {
        while open[w] != 0u {
            let texel = texel_of(sample_place(r, pixel, 32u * w + firstTrailingBit(open[w])));
            var here = vec4(0u);
            for (var v = w; v < WORDS; v++) {
                for (var left = open[v]; left != 0u; left &= left - 1u) {
                    let other = texel_of(sample_place(r, pixel, 32u * v + firstTrailingBit(left)));
                    here[v] |= select(0u, left & (0u - left), all(other == texel));
                }
            }
            open &= ~here;
            dark |= shadowed_of(r, own, pixel, texel, here);
        }
    }
    let judged = countOneBits(counted);
    let bright = countOneBits(counted & ~dark);
    let all_seen = judged.x + judged.y + judged.z + judged.w;
    let share = f32(bright.x + bright.y + bright.z + bright.w) / f32(all_seen);
    visibility[pixel] = select(share, 1.0, all_seen == 0u);
}
