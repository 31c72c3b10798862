// pixel_filter: visibility weighted over the samples of a pixel and of those around it (Pan 2009, section
// 5.1, which leaves that as future work).
// Reads which samples are `lit` and which see a surface (`seen`), WORDS words a pixel, and `weights`: for
// each pixel of a square of 2 REACH + 1 a side, row by row, the weights of 32 samples a word, then each
// word's sum.
// Writes `visibility`: the weight of the lit over that of the seen, 0 to 1. Where the seen weigh hardly
// anything, as they may where weights are negative, the pixel's own samples count alike; 1 where nothing is
// seen. What lies outside the image is not seen. A word whose samples all count takes its sum: what is lit
// all around is exactly 1.

//@import frame dispatch

override WORDS: u32 = 1u;
override REACH: u32 = 1u;
const WORKGROUP = 64u;
const NOWHERE = 0xffffffffu;
/// Share of all weight below which what is seen weighs hardly anything.
const HARDLY = 0.125;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> lit: array<u32>;
@group(0) @binding(2) var<storage, read> seen: array<u32>;
@group(0) @binding(3) var<storage, read> weights: array<f32>;
@group(0) @binding(4) var<storage, read_write> visibility: array<f32>;

/// First mask word of pixel `k` of those around `at`, NOWHERE outside the image.
fn words_of(at: vec2<i32>, k: u32) -> u32 {
    let side = 2u * REACH + 1u;
    let other = at + vec2(i32(k % side), i32(k / side)) - i32(REACH);
    let size = vec2<i32>(frame.image_size);
    let inside = all(other >= vec2(0)) && all(other < size);
    return select(NOWHERE, WORDS * u32(other.y * size.x + other.x), inside);
}

/// The samples that a word of a mask has.
fn samples_of(word: u32) -> u32 {
    return 0xffffffffu >> (32u - min(frame.sample_count - 32u * word, 32u));
}

/// Weight of a word's samples: `all` are those there are.
fn weight_of(bits: u32, all: u32, first: u32, sum: u32) -> f32 {
    if bits == all { return weights[sum]; }
    var weight = 0.0;
    for (var left = bits; left != 0u; left &= left - 1u) {
        weight += weights[first + firstTrailingBit(left)];
    }
    return weight;
}

@compute @workgroup_size(WORKGROUP)
fn pixel_filter(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let at = vec2(i32(pixel % frame.image_size.x), i32(pixel / frame.image_size.x));
    let around = (2u * REACH + 1u) * (2u * REACH + 1u);
    // A pixel that is lit or dark all around needs no weights.
    var all_lit = true;
    var none_lit = true;
    for (var k = 0u; k < around; k++) {
        let base = words_of(at, k);
        if base != NOWHERE {
            for (var w = 0u; w < WORDS; w++) {
                let there = samples_of(w);
                let surface = seen[base + w] & there;
                let bright = lit[base + w] & surface;
                all_lit = all_lit && bright == there;
                none_lit = none_lit && bright == 0u && surface == there;
            }
        }
    }
    var open = 0.0;
    var total = 0.0;
    let turns = select(around, 0u, all_lit || none_lit);
    for (var k = 0u; k < turns; k++) {
        let base = words_of(at, k);
        if base != NOWHERE {
            for (var w = 0u; w < WORDS; w++) {
                let there = samples_of(w);
                let surface = seen[base + w] & there;
                let first = 33u * WORDS * k + 32u * w;
                let sum = 33u * WORDS * k + 32u * WORDS + w;
                total += weight_of(surface, there, first, sum);
                open += weight_of(lit[base + w] & surface, there, first, sum);
            }
        }
    }
    var share = open / total;
    if turns == 0u {
        share = select(0.0, 1.0, all_lit);
    } else if total <= HARDLY {
        var own = 0u;
        var bright = 0u;
        for (var w = 0u; w < WORDS; w++) {
            own += countOneBits(seen[WORDS * pixel + w]);
            bright += countOneBits(seen[WORDS * pixel + w] & lit[WORDS * pixel + w]);
        }
        share = select(f32(bright) / f32(own), 1.0, own == 0u);
    }
    visibility[pixel] = clamp(share, 0.0, 1.0);
}
