// Which side of a triangle the light sees.

//@import frame

const FRONT = 0u;
const BACK = 1u;
const UNSURE = 2u;   // edge-on within rounding: counts as both
const DROPPED = 3u;  // a vertex is repeated, missing or not finite: no triangle at all

fn largest(v: vec3<f32>) -> f32 {
    let m = abs(v);
    return max(m.x, max(m.y, m.z));
}

fn facing_of(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, light: vec4<f32>) -> u32 {
    let ab = b - a;
    let ac = c - a;
    let to_light = light.xyz - light.w * a;
    let side = dot(cross(ab, ac), to_light);
    // Rounding of the products, and of the vertices themselves (half an ulp of the largest coordinate each).
    let reach = max(largest(a), max(largest(b), largest(c)));
    let la = largest(ab);
    let lc = largest(ac);
    let bound = largest(to_light) * (2e-6 * la * lc + 6e-7 * reach * (la + lc));
    if side > bound { return FRONT; }
    if side < -bound { return BACK; }
    return UNSURE;
}

// The vertices of a triangle by rising index.
fn rising(given: vec3<u32>) -> vec3<u32> {
    var i = given;
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    return i;
}

// Whether three vertices in rising order run around the other way than as given.
fn is_reversed(given: vec3<u32>, rising: vec3<u32>) -> bool {
    return !(all(given == rising) || all(given == rising.yzx) || all(given == rising.zxy));
}

// Whether a triangle's fourth word tells of holes in it.
fn is_tested(word: u32) -> bool { return word > 1u; }

// Whether a triangle is no caster: it turns away from the light, and is one of a closed body where such are
// left out by the frame's flags.
fn is_culled(flags: u32, of_body: u32, side: u32) -> bool {
    return ((flags & FLAG_CULL_BACK) != 0u) & (of_body == 1u) & (side == BACK);
}
