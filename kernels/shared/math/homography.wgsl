// Places of a world that a homography maps, so that parallel rays meet in an eye at the origin.

struct Homography {
    origin: vec4<f32>,   // xyz: subtracted from a place first; w: the depth, 0 for no homography
    right: vec4<f32>,    // rows: the product with a place, and what is added
    up: vec4<f32>,
    divisor: vec4<f32>,
}

fn mapped(h: Homography, place: vec3<f32>) -> vec3<f32> {
    if h.origin.w == 0.0 { return place; }
    let p = vec4(place - h.origin.xyz, 1.0);
    return vec3(dot(h.right, p), dot(h.up, p), -h.origin.w) / dot(h.divisor, p);
}
