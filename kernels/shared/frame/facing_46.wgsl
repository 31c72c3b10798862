// Which side of a triangle light and eye are on, with 46 bits.

//@import frame facing double_float vertex
//@needs var<uniform> frame: Frame;

// 2^-40: above what 46-bit arithmetic makes of an exact zero, relative to the factors
const EDGE_ON = 9.094947e-13;

// A vertex with all bits: a difference of two f32 is the sum of two f32.
fn full_point_of(v: u32) -> Df3 {
    let w = world_of(v);
    let s = frame.eye.w;
    let x = df_sub(two_sum(w.x, -frame.eye.x), vec2(frame.eye_low.x, 0.0)) * s;
    let y = df_sub(two_sum(w.y, -frame.eye.y), vec2(frame.eye_low.y, 0.0)) * s;
    let z = df_sub(two_sum(w.z, -frame.eye.z), vec2(frame.eye_low.z, 0.0)) * s;
    return Df3(x, y, z);
}

// From vertex i to vertex j, exact.
fn full_edge_of(i: u32, j: u32) -> Df3 {
    let a = world_of(i);
    let b = world_of(j);
    let s = frame.eye.w;
    return Df3(two_sum(b.x, -a.x) * s, two_sum(b.y, -a.y) * s, two_sum(b.z, -a.z) * s);
}

fn full_to_light(a: Df3) -> Df3 {
    let l = Df3(vec2(frame.light.x, frame.light_low.x), vec2(frame.light.y, frame.light_low.y),
        vec2(frame.light.z, frame.light_low.z));
    // A direction, or from `a` to a point: w is 0 or 1.
    let w = frame.light.w;
    return df3_sub(l, Df3(w * a.x, w * a.y, w * a.z));
}

fn full_normal(i: vec3<u32>) -> Df3 {
    return df3_cross(full_edge_of(i.x, i.y), full_edge_of(i.x, i.z));
}

// 1 if the triangle in this order of its vertices faces where `to` points from its first, -1 if it faces
// away, 0 if it is edge-on.
fn full_turn_to(i: vec3<u32>, to: Df3) -> f32 {
    let ab = full_edge_of(i.x, i.y);
    let ac = full_edge_of(i.x, i.z);
    let s = df3_dot(df3_cross(ab, ac), to).x;
    if !(abs(s) > EDGE_ON * df3_size(ab) * df3_size(ac) * df3_size(to)) { return 0.0; }
    return sign(s);
}

fn full_turn_of(i: vec3<u32>) -> f32 {
    return full_turn_to(i, full_to_light(full_point_of(i.x)));
}

fn full_turn_to_eye(i: vec3<u32>) -> f32 {
    return full_turn_to(i, df3_negate(full_point_of(i.x)));
}

// Turns to light and eye of a triangle with first vertex `a` and edges `ab` and `ac` from it; 0 where single
// precision does not tell.
fn turns_in_single(a: vec3<f32>, ab: vec3<f32>, ac: vec3<f32>) -> vec2<f32> {
    let spread = cross(ab, ac);
    // Rounding of the products, and of the points.
    let products = 3e-6 * largest(ab) * largest(ac);
    let to_light = frame.light.xyz - frame.light.w * a;
    let to_light_noise = 6e-7 * (largest(frame.light.xyz) + frame.light.w * largest(a));
    let side = dot(spread, to_light);
    let height = dot(spread, a);
    let sure_side = abs(side) > products * largest(to_light) + largest(spread) * to_light_noise;
    let sure_height = abs(height) > (products + 6e-7 * largest(spread)) * largest(a);
    return vec2(select(0.0, sign(side), sure_side), select(0.0, -sign(height), sure_height));
}

// The same, with 46 bits where single precision leaves it open; 0 where those do, too.
fn turns_of(i: vec3<u32>, a: vec3<f32>, ab: vec3<f32>, ac: vec3<f32>) -> vec2<f32> {
    var turns = turns_in_single(a, ab, ac);
    if turns.x == 0.0 { turns.x = full_turn_of(i); }
    if turns.y == 0.0 { turns.y = full_turn_to_eye(i); }
    return turns;
}
