// One caster against the samples of one texel.

//@import frame shadow_lines shadow_ray
//@needs override WORDS: u32;
//@needs const WORKGROUP: u32;
//@needs const LANES: u32;
//@needs const CROWD: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read_write> masks: array<atomic<u32>>;
//@needs var<storage, read_write> texel_ends: array<atomic<u32>>;
//@needs var<storage, read_write> bins: array<vec4<u32>>;

fn is_set(f: u32, part: u32, k: u32) -> bool {
    return ((atomicLoad(&masks[3u * WORDS * f + part * WORDS + (k >> 5u)]) >> (k & 31u)) & 1u) != 0u;
}

fn mark(f: u32, part: u32, k: u32) {
    atomicOr(&masks[3u * WORDS * f + part * WORDS + (k >> 5u)], 1u << (k & 31u));
}

// Where the facets of the band stand, and that of a sample of the band.
fn facet_place(slot: u32) -> u32 {
    return frame.map_size * frame.map_size + 2u + slot;
}

fn facet_of(index: u32) -> u32 {
    return atomicLoad(&texel_ends[facet_place(index / frame.sample_count)]);
}

// The first place of doubts in `bins`, and how many there are: one for four samples.
fn doubts() -> vec2<u32> {
    let room = arrayLength(&bins) / 5u;
    return vec2(4u * room, room);
}

// Tests caster `t` against one sample of a texel that it may block.
fn test(index: u32, t: u32, exact: bool) {
    let f = facet_of(index);
    let k = index % frame.sample_count;
    if is_set(f, 1u, k) || (exact && !is_set(f, 2u, k)) { return; }
    let g = ground_of(f);
    let r = ray_of_sample(g, k);
    var what = blocks(g, r, t);
    if exact && what == DOUBTFUL { what = blocks_46(g, offset_of(k), t); }
    if what == BLOCKED { mark(f, 1u, k); }
    if what != DOUBTFUL { return; }
    let room = doubts();
    let n = atomicAdd(&texel_ends[frame.map_size * frame.map_size], 1u);
    if n < room.y { bins[room.x + n] = vec4(index, t, 0u, 0u); } else { mark(f, 2u, k); }
}

fn start_of(texel: u32) -> u32 {
    return select(atomicLoad(&texel_ends[max(texel, 1u) - 1u]), 0u, texel == 0u);
}

fn may_block(b: vec4<u32>, c: Caster) -> bool {
    var r: Ray;
    r.at = bitcast<vec3<f32>>(b.xyz);
    aim(&r, bitcast<f32>((b.w >> 22u) << 21u));
    return !passes(r, c);
}

// Tests caster `t` against the samples of one crowded texel, those from `local` on in steps of a workgroup.
fn test_crowd(texel: u32, t: u32, c: Caster, local: u32, exact: bool) {
    let start = start_of(texel);
    let end = atomicLoad(&texel_ends[texel]);
    if end - start <= CROWD { return; }
    for (var at = start + local; at < end; at += WORKGROUP) {
        let b = bins[at];
        if may_block(b, c) { test(b.w & 0x3fffffu, t, exact); }
    }
}

// Tests caster `t` against the samples of one texel, those from `lane` on in steps of LANES, 32 at a time:
// first they are sifted by their points alone.
fn test_texel(texel: u32, t: u32, c: Caster, lane: u32, exact: bool) {
    let start = start_of(texel);
    let end = atomicLoad(&texel_ends[texel]);
    if end - start > CROWD { return; }
    for (var first = start + lane; first < end; first += 32u * LANES) {
        var kept = 0u;
        for (var i = 0u; i < 32u && first + i * LANES < end; i++) {
            if may_block(bins[first + i * LANES], c) { kept |= 1u << i; }
        }
        for (; kept != 0u; kept &= kept - 1u) {
            test(bins[first + firstTrailingBit(kept) * LANES].w & 0x3fffffu, t, exact);
        }
    }
}
