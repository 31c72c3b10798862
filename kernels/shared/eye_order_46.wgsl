// Which of two planes is nearer to the eye along a ray, with 46 bits. Needs `frame` and facing_46.

// Below 0 if the plane of `i` is nearer along the ray than that of `j`, above 0 if it is farther, 0 if that is not certain.
fn order_46(i: vec3<u32>, j: vec3<u32>, ray: vec3<f32>) -> f32 {
    let n = full_normal(i);
    let m = full_normal(j);
    let a = df3_dot(n, full_point_of(i.x));
    let b = df3_dot(m, full_point_of(j.x));
    let over = df3_along(n, ray);
    let under = df3_along(m, ray);
    let p = df_mul(a, under);
    let q = df_mul(b, over);
    let s = df_add_fast(p, -q).x;
    let noise = EDGE_ON * (df3_size(n) * df3_size(full_point_of(i.x)) * abs(under.x) + df3_size(m) * df3_size(full_point_of(j.x)) * abs(over.x));
    return select(0.0, sign(s) * sign(over.x) * sign(under.x), abs(s) > noise);
}
