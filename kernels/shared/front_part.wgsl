// The part of a triangle or an edge that lies in front of the light. Needs `frame`.
// Of a vertex that does not, `map_points` holds texel x, y and depth times the divisor, and the divisor less its least.

struct Front {
    a: vec4<f32>,  // corners in order around; `d` is `c` unless a corner was cut off: then the cut goes from `c` to `d`
    b: vec4<f32>,
    c: vec4<f32>,
    d: vec4<f32>,
    whole: bool,   // nothing is cut off
    any: bool,
}

// Where the edge from `a`, in front of the light, to `b`, which is not, leaves what is. All triangles at the edge find the same.
fn cut_edge(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    let near = frame.light_low.w;
    let at = mix(a.xyz * a.w, b.xyz, (a.w - near) / (a.w - near - b.w));
    return vec4(at / near, near);
}

// Where two corners are kept, the side between them goes as it was given.
fn cut_part(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, ahead: vec3<bool>) -> Front {
    if !any(ahead) || (frame.flags & FLAG_PERSPECTIVE) == 0u { return Front(a, b, c, c, false, false); }
    if ahead.x && ahead.y { return Front(a, b, cut_edge(b, c), cut_edge(a, c), false, true); }
    if ahead.x && ahead.z { return Front(a, c, cut_edge(c, b), cut_edge(a, b), false, true); }
    if ahead.y && ahead.z { return Front(b, c, cut_edge(c, a), cut_edge(b, a), false, true); }
    var kept = a;
    var p = b;
    var q = c;
    if ahead.y { kept = b; p = a; }
    if ahead.z { kept = c; p = a; q = b; }
    let end = cut_edge(kept, q);
    return Front(kept, cut_edge(kept, p), end, end, false, true);
}

fn front_part(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> Front {
    let ahead = vec3(a.w, b.w, c.w) > vec3(0.0);
    var out = Front(a, b, c, c, true, true);
    // Few triangles are cut: a loop that the others do not enter.
    for (var cut = !all(ahead); cut; cut = false) { out = cut_part(a, b, c, ahead); }
    return out;
}
