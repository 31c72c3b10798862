// Numbers of about 46 bits as unevaluated sums of two f32 (Dekker 1971, Knuth 1969). WGSL lets a compiler
// fuse a multiplication into an addition. Sums alone are safe from that; products are split by integer masks
// so that every partial product is exact, fused or not, and the rounded product passes through `seal`, which
// no compiler can see through, so that it is not computed a second time with another rounding. Some drivers
// compile a kernel anew for the values of uniforms that its conditions ask for, and then take sums apart: no
// condition asks for `seal`.

//@import frame
//@needs var<uniform> frame: Frame;

fn seal(x: f32) -> f32 { return bitcast<f32>(bitcast<u32>(x) ^ frame.seal); }

fn two_sum(a: f32, b: f32) -> vec2<f32> {
    let s = seal(a + b);
    let bb = seal(s - a);
    return vec2(s, (a - seal(s - bb)) + (b - bb));
}

fn two_product(a: f32, b: f32) -> vec2<f32> {
    let p = seal(a * b);
    let ah = bitcast<f32>(bitcast<u32>(a) & 0xfffff000u);
    let al = a - ah;
    let bh = bitcast<f32>(bitcast<u32>(b) & 0xfffff000u);
    let bl = b - bh;
    return vec2(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl);
}

fn df_add(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let s = two_sum(a.x, b.x);
    let t = two_sum(a.y, b.y);
    let u = two_sum(s.x, s.y + t.x);
    return two_sum(u.x, u.y + t.y);
}

// As df_add, at half the cost: its error is relative to the numbers added, not to their sum (the sloppy sum
// of Joldes, Muller and Popescu 2017).
fn df_add_fast(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let s = two_sum(a.x, b.x);
    return two_sum(s.x, s.y + (a.y + b.y));
}

fn df_sub(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> { return df_add(a, -b); }

fn df_mul(a: vec2<f32>, b: vec2<f32>) -> vec2<f32> {
    let p = two_product(a.x, b.x);
    return two_sum(p.x, p.y + (a.x * b.y + a.y * b.x));
}

fn df_scale(a: vec2<f32>, b: f32) -> vec2<f32> {
    let p = two_product(a.x, b);
    return two_sum(p.x, p.y + a.y * b);
}

struct Df3 { x: vec2<f32>, y: vec2<f32>, z: vec2<f32> }

fn df3_sub(a: Df3, b: Df3) -> Df3 {
    return Df3(df_sub(a.x, b.x), df_sub(a.y, b.y), df_sub(a.z, b.z));
}

fn df3_negate(a: Df3) -> Df3 {
    return Df3(-a.x, -a.y, -a.z);
}

fn df3_cross(a: Df3, b: Df3) -> Df3 {
    return Df3(
        df_add_fast(df_mul(a.y, b.z), -df_mul(a.z, b.y)),
        df_add_fast(df_mul(a.z, b.x), -df_mul(a.x, b.z)),
        df_add_fast(df_mul(a.x, b.y), -df_mul(a.y, b.x)));
}

fn df3_dot(a: Df3, b: Df3) -> vec2<f32> {
    return df_add_fast(df_add_fast(df_mul(a.x, b.x), df_mul(a.y, b.y)), df_mul(a.z, b.z));
}

fn df3_along(a: Df3, ray: vec3<f32>) -> vec2<f32> {
    return df_add_fast(df_add_fast(df_scale(a.x, ray.x), df_scale(a.y, ray.y)), df_scale(a.z, ray.z));
}

fn df3_size(a: Df3) -> f32 {
    return max(abs(a.x.x), max(abs(a.y.x), abs(a.z.x)));
}
