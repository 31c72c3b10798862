// polygon_ids: shadows by whose polygon lies nearest to the light at a texel's centre, without depths and
// without a bias (Hourcade, Nicolas 1985). A polygon is a surface: triangles that hang together by edges in
// one plane (`surfaces`: the lowest triangle of each). A sample is lit where its texel keeps none, or where
// one of LOOKUPS x LOOKUPS texels around it keeps its receiver's polygon, or a triangle at an edge of the
// receiver's on the other side of it seen from the light, neither of which can shadow it. Samples beside the
// receiver's triangle see another one, so they count only where no sample meets it. Writes `visibility`: the
// mean over those that count.

//@import frame dispatch facing receiver beside

override LOOKUPS: u32 = 1u;
const WORKGROUP = 64u;
const NAME = 0x7fffffffu;  // of a word of `surfaces`: without its mark of several triangles

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> triangle_keys: array<u32>;
@group(0) @binding(6) var<storage, read> surfaces: array<u32>;
@group(0) @binding(7) var<storage, read_write> visibility: array<f32>;

// The triangle that was asked last, and whether it shadows none of the receiver.
struct Known {
    t: u32,
    own: bool,
}

fn is_lit(own: Own, name: u32, texel: vec2<i32>, known: ptr<function, Known>) -> bool {
    if kept_in(texel) == frame.triangle_count { return true; }
    var lit = false;
    for (var n = 0u; n < LOOKUPS * LOOKUPS && !lit; n++) {
        let step = vec2(n % LOOKUPS, n / LOOKUPS);
        let t = kept_in(texel + vec2<i32>(step) - vec2(i32(LOOKUPS / 2u)));
        if t == frame.triangle_count { continue; }
        // Few texels keep another triangle than the one before them.
        if t != (*known).t {
            let same = (surfaces[t] & NAME) == name;
            *known = Known(t, same || is_beside(own, corners_of(t)));
        }
        lit = (*known).own;
    }
    return lit;
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
    let t = ~id_keys[pixel];
    let own = own_of(r, t);
    let name = surfaces[t] & NAME;
    var known = Known(t, true);
    // Of all that meet the plane, of those that meet the triangle.
    var lit = vec2(0.0);
    var seen = vec2(0.0);
    for (var k = 0u; k < frame.sample_count; k++) {
        let ray = sample_ray(pixel, k);
        let at = place_of(r, ray);
        if at.w == 0.0 { continue; }
        let counts = vec2(1.0, select(0.0, 1.0, meets_triangle(r, ray)));
        seen += counts;
        lit += select(vec2(0.0), counts, is_lit(own, name, texel_of(at), &known));
    }
    let share = select(lit.x / seen.x, lit.y / seen.y, seen.y > 0.0);
    visibility[pixel] = select(share, 1.0, seen.x == 0.0);
}
