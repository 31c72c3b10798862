// The lines of shared/shadow_lines with 46 bits, from the vertices as they were given. Needs shared/facing_46.

const ZERO_46 = 3.6e-12;  // 2^-38: what 46-bit arithmetic leaves of an exact zero, relative

// 1 if the facet's normal points as g.normal does, -1 if it is opposite.
fn full_sense(g: Ground, n: Df3) -> f32 {
    return sign(dot(g.normal, vec3(n.x.x, n.y.x, n.z.x)));
}

// Height of a vertex over the facet of normal `n` towards the light; exactly 0 on the plane.
fn full_height_of(g: Ground, n: Df3, v: u32) -> f32 {
    if is_own(v, g.own) { return 0.0; }
    let d = df3_sub(full_point_of(v), full_point_of(g.own.x));
    let h = df3_dot(n, d).x;
    if abs(h) <= ZERO_46 * df3_size(n) * df3_size(d) { return 0.0; }
    return h * full_sense(g, n);
}

fn full_value(n: Df3, d: vec2<f32>, m: Df3, e: vec2<f32>, ray: vec3<f32>) -> f32 {
    let r = df3_of(ray);
    return df_sub(df_mul(d, df3_dot(m, r)), df_mul(e, df3_dot(n, r))).x;
}

// The line of the plane through `a` with normal `m` on the facet of normal `n`.
fn full_line(g: Ground, n: Df3, m: Df3, a: Df3) -> vec3<f32> {
    let d = df3_dot(n, full_point_of(g.own.x));
    let e = df3_dot(m, a);
    return full_sense(g, n) * vec3(
        full_value(n, d, m, e, pixel_ray(g.pixel)),
        full_value(n, d, m, e, frame.ray_x.xyz),
        full_value(n, d, m, e, frame.ray_y.xyz));
}

fn full_edge_line(g: Ground, n: Df3, i: vec2<u32>) -> vec3<f32> {
    let p = full_point_of(i.x);
    return full_line(g, n, df3_cross(full_edge_of(i.x, i.y), full_to_light(p)), p);
}
