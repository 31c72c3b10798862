// The samples of a facet: which lie on its own triangle, and the part of the pixel they lie in.

//@import frame facet vertex sample_copy
//@needs override WORDS: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> samples_given: array<vec4<f32>, 64>;
//@needs var<storage, read_write> facets: array<Facet>;
//@needs var<storage, read_write> masks: array<u32>;

fn sample_offset(k: u32) -> vec2<f32> {
    let pair = samples_given[k >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 1u);
}

// Edge function through the eye at the pixel centre, per pixel right, per pixel down; from the lower index.
fn edge(i: u32, j: u32, ray: vec3<f32>) -> vec3<f32> {
    let low = min(i, j);
    let m = cross(point_of(low), edge_of(low, max(i, j))) * select(-1.0, 1.0, i == low);
    return vec3(dot(m, ray), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
}

// Widens a box (its lowest and its highest corner) by those of two samples that the lowest bits of a mask
// have.
fn span_two(box: vec4<f32>, two: vec4<f32>, mask: u32) -> vec4<f32> {
    let first = (mask & 1u) != 0u;
    let second = (mask & 2u) != 0u;
    let low = min(select(vec2(1.0), two.xy, first), select(vec2(1.0), two.zw, second));
    let high = max(select(vec2(-1.0), two.xy, first), select(vec2(-1.0), two.zw, second));
    return vec4(min(box.xy, low), max(box.zw, high));
}

fn span_eight(given: vec4<f32>, at: u32, mask: u32) -> vec4<f32> {
    var box = span_two(given, samples[at], mask);
    box = span_two(box, samples[at + 1u], mask >> 2u);
    box = span_two(box, samples[at + 2u], mask >> 4u);
    return span_two(box, samples[at + 3u], mask >> 6u);
}

// Takes in the samples of a word.
fn span_word(given: vec4<f32>, f: u32, word: u32) -> vec4<f32> {
    let mask = masks[3u * WORDS * f + word];
    let at = word << 4u;
    var box = span_eight(given, at, mask);
    if SAMPLES > 8u { box = span_eight(box, at + 4u, mask >> 8u); }
    if SAMPLES > 16u {
        box = span_eight(box, at + 8u, mask >> 16u);
        box = span_eight(box, at + 12u, mask >> 24u);
    }
    return box;
}

// The box around the samples that a facet covers, and a 256th of a pixel beyond.
fn span_of_samples(f: u32) -> vec2<u32> {
    var box = span_word(vec4(1.0, 1.0, -1.0, -1.0), f, 0u);
    if WORDS > 1u { box = span_word(box, f, 1u); }
    if WORDS > 2u {
        box = span_word(box, f, 2u);
        box = span_word(box, f, 3u);
    }
    // And what packing may take away.
    let more = 0.00390625 + 0.00006103515625;
    return vec2(pack2x16snorm(box.xy - more), pack2x16snorm(box.zw + more));
}

fn keep_own_triangle(f: u32, i: vec3<u32>, ray: vec3<f32>) {
    let e0 = edge(i.x, i.y, ray);
    let e1 = edge(i.y, i.z, ray);
    let e2 = edge(i.z, i.x, ray);
    for (var w = 0u; w < WORDS; w++) {
        // The centre is, if it was seen there
        var inside = select(0u, 1u, w == 0u && all(facets[f].origin == vec2(0.0)));
        for (var k = 0u; k < 32u; k++) {
            let at = vec3(1.0, sample_offset(32u * w + k));
            let v = vec3(dot(e0, at), dot(e1, at), dot(e2, at));
            if all(v >= vec3(0.0)) || all(v <= vec3(0.0)) { inside |= 1u << k; }
        }
        masks[3u * WORDS * f + w] &= inside;
    }
}
