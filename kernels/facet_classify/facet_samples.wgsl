// The samples of a facet that lie on its own triangle.

//@import frame facet vertex
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
