// The samples of a facet: which lie on its own triangle, and the part of the pixel they lie in. Needs `frame`, vertex, facet, the
// uniform `samples`, the arrays `facets` and `masks`, and the override WORDS.

fn sample_offset(k: u32) -> vec2<f32> {
    let pair = samples[k >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 1u);
}

// Edge function through the eye at the pixel centre, per pixel right, per pixel down; from the lower index.
fn edge(i: u32, j: u32, ray: vec3<f32>) -> vec3<f32> {
    let low = min(i, j);
    let m = cross(point_of(low), edge_of(low, max(i, j))) * select(-1.0, 1.0, i == low);
    return vec3(dot(m, ray), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
}

// The box around the samples that a facet covers, and a 256th of a pixel beyond.
fn span_of_samples(f: u32) -> vec2<u32> {
    var low = vec2(1.0);
    var high = vec2(-1.0);
    for (var w = 0u; w < WORDS; w++) {
        let mask = masks[3u * WORDS * f + w];
        for (var k = 0u; k < 32u && 32u * w + k < frame.sample_count; k++) {
            if ((mask >> k) & 1u) == 0u { continue; }
            let at = sample_offset(32u * w + k);
            low = min(low, at);
            high = max(high, at);
        }
    }
    // And what packing may take away.
    let more = 0.00390625 + 0.00006103515625;
    return vec2(pack2x16snorm(low - more), pack2x16snorm(high + more));
}

fn keep_own_triangle(f: u32, i: vec3<u32>, ray: vec3<f32>) {
    let e0 = edge(i.x, i.y, ray);
    let e1 = edge(i.y, i.z, ray);
    let e2 = edge(i.z, i.x, ray);
    for (var w = 0u; w < WORDS; w++) {
        var inside = select(0u, 1u, w == 0u && all(facets[f].origin == vec2(0.0)));  // the centre is, if it was seen there
        for (var k = 0u; k < 32u; k++) {
            let at = vec3(1.0, sample_offset(32u * w + k));
            let v = vec3(dot(e0, at), dot(e1, at), dot(e2, at));
            if all(v >= vec3(0.0)) || all(v <= vec3(0.0)) { inside |= 1u << k; }
        }
        masks[3u * WORDS * f + w] &= inside;
    }
}
