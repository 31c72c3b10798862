// A triangle as the rays of one pixel see it: edge functions and depth, linear in the offset, with bounds of their doubt.
// Needs `frame`, `points`, eye_edges.

const DEPTH_SLACK = 0.00001;

struct View {
    edges: array<vec4<f32>, 3>,  // at the pixel centre, per pixel right and down, and doubt
    over: vec3<f32>,             // normal . ray likewise, positive where the plane is met before the eye's horizon
    over_doubt: f32,
    distance: f32,
    distance_doubt: f32,
    nearest: f32,
    farthest: f32,
}

fn view_of(i: vec3<u32>, centre: vec3<f32>) -> View {
    var s: View;
    s.edges[0] = eye_edge(i.x, i.y, centre);
    s.edges[1] = eye_edge(i.y, i.z, centre);
    s.edges[2] = eye_edge(i.z, i.x, centre);
    let a = points[i.x].xyz;
    let b = points[i.y].xyz;
    let c = points[i.z].xyz;
    let normal = cross(b - a, c - a);
    // Rounding of the normal, of the corners themselves, and of the products with a ray of the pixel.
    let reach = max(largest(a), max(largest(b), largest(c)));
    let doubt = 2e-6 * largest(b - a) * largest(c - a) + 6e-7 * reach * (largest(b - a) + largest(c - a));
    let distance = dot(normal, a);
    let turn = sign(distance);
    s.over = turn * vec3(dot(normal, centre), dot(normal, frame.ray_x.xyz), dot(normal, frame.ray_y.xyz));
    s.over_doubt = 2.0 * doubt * largest(centre);
    s.distance = abs(distance);
    s.distance_doubt = doubt * reach;
    let depths = vec3(dot(a, frame.forward.xyz), dot(b, frame.forward.xyz), dot(c, frame.forward.xyz));
    s.nearest = min(depths.x, min(depths.y, depths.z));
    s.farthest = max(depths.x, max(depths.y, depths.z));
    return s;
}

// Nearest and farthest that `eye_depth` may say at a ray with this value of `over`.
fn depth_bounds(s: View, over: f32) -> vec2<f32> {
    var near = s.nearest;
    var far = s.farthest;
    let most = over + s.over_doubt;
    let least = over - s.over_doubt;
    if most > 0.0 && s.distance > s.distance_doubt { near = max(near, (s.distance - s.distance_doubt) / most * (1.0 - DEPTH_SLACK)); }
    if least > 0.0 { far = min(far, (s.distance + s.distance_doubt) / least * (1.0 + DEPTH_SLACK)); }
    return vec2(near - DEPTH_SLACK * abs(near), far + DEPTH_SLACK * abs(far));
}
