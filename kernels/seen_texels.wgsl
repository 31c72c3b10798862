// seen_texels: which texels of the light-view map are asked for, so that no other need be made.
// `mark` marks for each pixel the texels that its footprint touches in the light view. `around` takes the
// list of the pixels that these do not settle by their planes, and marks REACH texels around them, too, but
// where their outlines do; what was not marked before stands in the second half of `seen` as well.
// `all_texels` marks everything. Footprints are grown by SLACK: whoever reads computes them anew and may
// round otherwise. What is still not marked is told by who reads it.

//@import frame dispatch facing receiver seen_texels spsm_record spsm_sheet spsm_border spsm_footprint
//@import spsm_settle

override ENCODING: u32 = 1u;
override SPLIT: u32 = 1u;
override RADIUS: i32 = 1;
override BIAS: f32 = 1e-5;
override MANY: u32 = 1u;      // 0: one sample a pixel, at its centre
override REACH: i32 = 0;
const WORKGROUP = 64u;
const SLACK = 0.02;           // texels

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;   // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
// As many as pixels, then how many there are
@group(0) @binding(5) var<storage, read> kept: array<u32>;
@group(0) @binding(6) var<storage, read_write> seen: array<atomic<u32>>;
@group(0) @binding(7) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(8) var<storage, read> upper_records: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read> lower_records: array<vec4<u32>>;

// Marks the texels from that of `low` to that of `high` and REACH around them. `last` says that they are
// asked for last.
fn ask(low: vec2<f32>, high: vec2<f32>, last: bool) {
    let side = f32(frame.map_size);
    let reach = f32(REACH);
    if any(high + reach < vec2(0.0)) || any(low - reach >= vec2(side)) { return; }
    let a = vec2<u32>(clamp(floor(low) - reach, vec2(0.0), vec2(side - 1.0)));
    let b = vec2<u32>(clamp(floor(high) + reach, vec2(0.0), vec2(side - 1.0)));
    for (var y = a.y >> 2u; y <= b.y >> 2u; y++) {
        let above = max(a.y, 4u * y) & 3u;
        let below = min(b.y, 4u * y + 3u) & 3u;
        let rows = (0xffffffffu << (8u * above)) & (0xffffffffu >> (24u - 8u * below));
        for (var x = a.x >> 3u; x <= b.x >> 3u; x++) {
            let left = max(a.x, 8u * x) & 7u;
            let right = min(b.x, 8u * x + 7u) & 7u;
            let bits = ((((0xffu << left) & (0xffu >> (7u - right))) & 0xffu) * 0x01010101u) & rows;
            let word = seen_place(vec2(8u * x, 4u * y)).x;
            if (atomicLoad(&seen[SEEN_BITS + word]) & bits) == bits { continue; }
            let fresh = bits & ~atomicOr(&seen[SEEN_BITS + word], bits);
            if last && fresh != 0u { atomicOr(&seen[SEEN_BITS + seen_words() + word], fresh); }
        }
    }
}

fn ask_for(f: Footprint, last: bool) {
    // Held to a texel: a footprint that goes on far outside the map shall not ask for all of it.
    let slack = min(SLACK + 0.001 * (f.high - f.low), vec2(1.0));
    ask(f.low - slack, f.high + slack, last);
}

@compute @workgroup_size(WORKGROUP)
fn mark(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    let f = footprint_of(r, pixel);
    if r.seen != SEEN_OPEN || f.class_known != CLASS_EMPTY { return; }
    ask_for(f, false);
}

@compute @workgroup_size(WORKGROUP)
fn around(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    let pixels = frame.image_size.x * frame.image_size.y;
    if item >= min(kept[pixels], pixels) { return; }
    let pixel = kept[item];
    let r = receiver_of(pixel);
    let f = footprint_of(r, pixel);
    if f.class_known == CLASS_EMPTY && any_before(r, f, true) { ask_for(f, true); }
    // A footprint without end, or a large one: its samples each for itself.
    let each = select(0u, frame.sample_count, f.class_known != CLASS_EMPTY);
    for (var k = 0u; k < each; k++) {
        let at = sample_place(r, pixel, k);
        if at.w != 0.0 { ask(at.xy - SLACK, at.xy + SLACK, true); }
    }
}

@compute @workgroup_size(WORKGROUP)
fn all_texels(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let word = flat_invocation(group, groups, WORKGROUP, local);
    if word < seen_words() { atomicStore(&seen[SEEN_BITS + word], 0xffffffffu); }
}
