// Edges of a triangle seen from the eye. Needs `frame`, `facing` (for `largest`) and the array `points`.
// An edge is evaluated from its lower vertex index, so that both triangles at it get one value with two signs.

// Edge function at `ray`, per pixel right, per pixel down, and how far it may be off anywhere near.
fn eye_edge(i: u32, j: u32, ray: vec3<f32>) -> vec4<f32> {
    let low = min(i, j);
    let p = points[low].xyz;
    let along = points[max(i, j)].xyz - p;
    let m = cross(p, along) * select(-1.0, 1.0, i == low);
    let v = vec3(dot(m, ray), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
    return vec4(v, 0.0078125 * (abs(v.y) + abs(v.z)) + 2e-6 * largest(p) * largest(along) * largest(ray));
}

// From the eye's ray to a corner at the corner's depth (xyz), and that depth (w). Small near the corner, and the same for
// all triangles around it.
fn from_ray(v: u32, ray: vec3<f32>) -> vec4<f32> {
    let p = points[v].xyz;
    let depth = dot(p, frame.forward.xyz);
    return vec4(p - depth * ray, depth);
}

// The edge function at a ray, from the end that is nearer to it: around a vertex all edges agree on where the ray is.
fn eye_edge_near(i: u32, j: u32, ray: vec3<f32>) -> f32 {
    let low = min(i, j);
    let high = max(i, j);
    let a = from_ray(low, ray).xyz;
    let b = from_ray(high, ray).xyz;
    var d = a;
    if dot(b, b) < dot(a, a) { d = b; }
    let v = dot(cross(d, points[high].xyz - points[low].xyz), ray);
    return select(-v, v, i == low);
}

// View depth of a triangle's plane at a ray, between the depths of its corners; -1 where it is edge-on. Corners are taken
// in the order of their indices, so triangles of the same corners have the same depth.
fn eye_depth(given: vec3<u32>, ray: vec3<f32>) -> f32 {
    var i = given;
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let p = points[i.x].xyz;
    let normal = cross(points[i.y].xyz - p, points[i.z].xyz - p);
    let over = dot(normal, ray);
    if !(abs(over) > 0.0) { return -1.0; }
    let a = from_ray(i.x, ray);
    let b = from_ray(i.y, ray);
    let c = from_ray(i.z, ray);
    var d = a;
    if dot(b.xyz, b.xyz) < dot(d.xyz, d.xyz) { d = b; }
    if dot(c.xyz, c.xyz) < dot(d.xyz, d.xyz) { d = c; }
    let depth = d.w + dot(normal, d.xyz) / over;
    return clamp(depth, min(a.w, min(b.w, c.w)), max(a.w, max(b.w, c.w)));
}
