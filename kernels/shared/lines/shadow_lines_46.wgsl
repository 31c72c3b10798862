// The lines of shadow_lines with 46 bits, from the vertices as they were given.

//@import frame pixel_ray double_float facing_46 shadow_lines
//@needs var<uniform> frame: Frame;

const ZERO_46 = 3.6e-12;  // 2^-38: what 46-bit arithmetic leaves of an exact zero, relative

// 1 if the facet's normal points as g.normal does, -1 if it is opposite.
fn full_sense(g: Ground, n: Df3) -> f32 {
    return sign(dot(g.normal, vec3(n.x.x, n.y.x, n.z.x)));
}

// Height of a vertex over the facet of normal `n` towards the light; exactly 0 on the plane.
fn full_height_of(g: Ground, n: Df3, v: u32) -> f32 {
    if is_own(v, g.own) { return 0.0; }
    let d = full_edge_of(g.own.x, v);
    let h = df3_dot(n, d).x;
    if abs(h) <= ZERO_46 * df3_size(n) * df3_size(d) { return 0.0; }
    return h * full_sense(g, n);
}

// The line of the plane through vertex `v` with normal `m` on the facet of normal `n`. With m = k n + t, and
// h the height of the vertex, it is d t - (t . v + k h) n: where the two planes nearly coincide t is small,
// and with it what is lost to their distance from the eye.
fn full_line(g: Ground, n: Df3, m: Df3, v: u32) -> vec3<f32> {
    let along = vec3(n.x.x, n.y.x, n.z.x);
    let k = dot(vec3(m.x.x, m.y.x, m.z.x), along) / dot(along, along);
    let t = Df3(df_add_fast(m.x, -df_scale(n.x, k)), df_add_fast(m.y, -df_scale(n.y, k)),
        df_add_fast(m.z, -df_scale(n.z, k)));
    let d = df3_dot(n, full_point_of(g.own.x));
    let e = df_add_fast(df3_dot(t, full_point_of(v)), df_scale(df3_dot(n, full_edge_of(g.own.x, v)), k));
    let w = Df3(
        df_add_fast(df_mul(d, t.x), -df_mul(e, n.x)),
        df_add_fast(df_mul(d, t.y), -df_mul(e, n.y)),
        df_add_fast(df_mul(d, t.z), -df_mul(e, n.z)));
    return full_sense(g, n)
        * vec3(df3_along(w, pixel_ray(g.pixel)).x, df3_along(w, frame.ray_x.xyz).x,
            df3_along(w, frame.ray_y.xyz).x);
}

// Heights of a triangle's vertices. A loop, as below: copies of the arithmetic of 46 bits take registers, and
// compilers long.
fn full_heights_of(g: Ground, n: Df3, i: vec3<u32>) -> vec3<f32> {
    var h = vec3(0.0);
    for (var k = 0u; k < 3u; k++) {
        h = select(h, vec3(full_height_of(g, n, i[k])), vec3(0u, 1u, 2u) == vec3(k));
    }
    return h;
}

// The lines of edges xy, yz and xz, then of the triangle's own plane where that `crosses` the facet; positive
// inside for `turn`, that of the triangle to the light.
fn full_lines(g: Ground, n: Df3, i: vec3<u32>, turn: f32, crosses: bool) -> Lines {
    var l = Lines(vec4(0.0, 0.0, 0.0, 3.0e38), vec4(0.0), vec4(0.0));
    for (var k = 0u; k < select(3u, 4u, crosses); k++) {
        let start = select(i.x, i.y, k == 1u);
        var other = full_to_light(full_point_of(start));
        if k == 3u { other = full_edge_of(i.x, i.z); }
        let edge = full_edge_of(start, select(i.z, i.y, k == 0u || k == 3u));
        let line = select(turn, -turn, k == 2u) * full_line(g, n, df3_cross(edge, other), start);
        let here = vec4(0u, 1u, 2u, 3u) == vec4(k);
        l.centre = select(l.centre, vec4(line.x), here);
        l.right = select(l.right, vec4(line.y), here);
        l.down = select(l.down, vec4(line.z), here);
    }
    return l;
}
