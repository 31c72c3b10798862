// Paraboloid views of a light at a point (Brabec, Annen, Seidel 2002), in which a frame is that has
// FLAG_PARABOLOID. Of a point `rel` away from the light, as far as D, the rows u, v and w of the view tell
// how far it is along three axes, x and y times texels. It lies at (x, y) / (D + z) from the place that the
// fourth of u and v tell, and its depth is D times the fourth of map_z.

//@import frame
//@needs var<uniform> frame: Frame;

const POLE = 0.0001;  // 1 and the cosine of the angle to the axis: from there on nothing is in front

override PARABOLOIDS: u32 = 1u;  // 0 leaves out the code for such views

fn is_paraboloid() -> bool { return PARABOLOIDS != 0u && (frame.flags & FLAG_PARABOLOID) != 0u; }

// Away from the light.
fn from_light(point: vec3<f32>) -> vec3<f32> { return (point - frame.light.xyz) - frame.light_low.xyz; }

fn paraboloid_depth(rel: vec3<f32>) -> f32 { return length(rel) * frame.map_z.w; }

// Texel x and y, and D + z; that 0 where it is not in front.
fn paraboloid_texel(u: vec4<f32>, v: vec4<f32>, w: vec4<f32>, rel: vec3<f32>) -> vec3<f32> {
    let apart = length(rel);
    let front = apart + dot(w.xyz, rel);
    if !(front > POLE * apart) { return vec3(0.0); }
    return vec3(vec2(u.w, v.w) + vec2(dot(u.xyz, rel), dot(v.xyz, rel)) / front, front);
}

// Change of depth for a texel to the right and down along the plane with this normal at a point of it.
fn paraboloid_slope(normal: vec3<f32>, rel: vec3<f32>) -> vec2<f32> {
    let texels = vec2(length(frame.map_u.xyz), length(frame.map_v.xyz));
    let apart = length(rel);
    let x = frame.map_u.xyz / texels.x;
    let y = frame.map_v.xyz / texels.y;
    let d = vec3(dot(x, rel), dot(y, rel), dot(frame.map_w.xyz, rel)) / apart;
    let n = vec3(dot(x, normal), dot(y, normal), dot(frame.map_w.xyz, normal));
    // How the direction d of a place changes with it.
    let g = 1.0 + d.z;
    let across = dot(n, vec3(g - d.x * d.x, -d.x * d.y, -g * d.x));
    let down = dot(n, vec3(-d.x * d.y, g - d.y * d.y, -g * d.y));
    return -apart * frame.map_z.w / dot(n, d) * vec2(across, down) / texels;
}

// Depth of the plane with this normal through a point at a place of the map; not above 0 where its ray
// misses it.
fn paraboloid_plane(normal: vec3<f32>, rel: vec3<f32>, place: vec2<f32>) -> f32 {
    let texels = vec2(length(frame.map_u.xyz), length(frame.map_v.xyz));
    let at = (place - vec2(frame.map_u.w, frame.map_v.w)) / texels;
    let square = dot(at, at);
    let d = (2.0 * at.x / texels.x) * frame.map_u.xyz + (2.0 * at.y / texels.y) * frame.map_v.xyz
        + (1.0 - square) * frame.map_w.xyz;
    // The direction is 1 + square long.
    return dot(normal, rel) / dot(normal, d) * (1.0 + square) * frame.map_z.w;
}

// Change of texel x and y for a change of a point.
fn paraboloid_step(rel: vec3<f32>, change: vec3<f32>) -> vec2<f32> {
    let apart = length(rel);
    let front = apart + dot(frame.map_w.xyz, rel);
    let at = vec2(dot(frame.map_u.xyz, rel), dot(frame.map_v.xyz, rel)) / front;
    let farther = dot(frame.map_w.xyz, change) + dot(rel, change) / apart;
    return (vec2(dot(frame.map_u.xyz, change), dot(frame.map_v.xyz, change)) - at * farther) / front;
}
