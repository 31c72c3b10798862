// Which of planes is nearer to the eye along a ray, with 46 bits.

//@import facing near_distance double_float facing_46

// Below 0 if the plane of `i` is nearer along the ray than that of `j`, above 0 if it is farther, 0 if that
// is not certain.
fn order_46(i: vec3<u32>, j: vec3<u32>, ray: vec3<f32>) -> f32 {
    let ab = full_edge_of(i.x, i.y);
    let ac = full_edge_of(i.x, i.z);
    let de = full_edge_of(j.x, j.y);
    let df = full_edge_of(j.x, j.z);
    let n = df3_cross(ab, ac);
    let m = df3_cross(de, df);
    let a = df3_dot(n, full_point_of(i.x));
    let b = df3_dot(m, full_point_of(j.x));
    let over = df3_along(n, ray);
    let under = df3_along(m, ray);
    let p = df_mul(a, under);
    let q = df_mul(b, over);
    let s = df_add_fast(p, -q).x;
    // By the factors of the normals, not by their sums: a sliver's may be nearly nothing.
    let left = df3_size(ab) * df3_size(ac) * df3_size(full_point_of(i.x)) * abs(under.x);
    let right = df3_size(de) * df3_size(df) * df3_size(full_point_of(j.x)) * abs(over.x);
    let noise = EDGE_ON * (left + right);
    return select(0.0, sign(s) * sign(over.x) * sign(under.x), abs(s) > noise);
}

// Whether the plane of `i` lies beyond the near distance along the ray; what is at it counts as beyond.
fn is_beyond_near_46(i: vec3<u32>, ray: vec3<f32>) -> bool {
    let n = full_normal(i);
    let over = df3_along(n, ray);
    let s = df_add_fast(df3_dot(n, full_point_of(i.x)), -df_scale(over, near_along(ray)));
    return s.x * sign(over.x) >= 0.0 && over.x != 0.0;
}

// How much nearer the triangle's plane is along the ray than `depth`, as a key that grows with that; not 0.
// Steps of 2^-40 of the depth: what 46 bits make of planes that meet there is within one.
fn key_46(given: vec3<u32>, ray: vec3<f32>, depth: f32) -> u32 {
    // Triangles of the same corners have the same key.
    let i = rising(given);
    let n = full_normal(i);
    let over = df_scale(df3_along(n, ray), depth);
    let rest = df_add_fast(over, -df3_dot(n, full_point_of(i.x)));
    let nearer = select(-3.0e38, round(rest.x / over.x * 1.0995116e12), over.x != 0.0);
    let bits = bitcast<u32>(nearer);
    return bits ^ select(0x80000000u, 0xffffffffu, (bits >> 31u) != 0u);
}
