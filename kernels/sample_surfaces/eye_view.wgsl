// A triangle as the rays of one pixel see it: edge functions and inverse depth, linear in the offset from the
// pixel centre, with bounds of their doubt. Needs `frame`, eye_edges.

const INVERSE_SLACK = 0.00002;

struct View {
    at: vec3<f32>,      // the three edge functions at the pixel centre
    right: vec3<f32>,   // what a pixel to the right adds, and one down
    down: vec3<f32>,
    doubt: vec3<f32>,   // how far one may be off anywhere in the pixel, and `eye_edge_near` too
    high: vec3<f32>,    // upper bound of the inverse depth at the centre, per pixel right and down
    low: vec3<f32>,     // lower bound likewise
    highest: f32,       // bounds of it over the whole triangle
    lowest: f32,
}

// Edge function at the pixel centre, per pixel right, per pixel down, and doubt. Evaluated from the end that
// is nearer to the ray, so that small triangles far away are as certain as large ones nearby.
fn edge_over(i: u32, j: u32, at_i: vec3<f32>, at_j: vec3<f32>, centre: vec3<f32>) -> vec4<f32> {
    let p = select(at_j, at_i, i <= j);
    let q = select(at_i, at_j, i <= j);
    let a = p - dot(p, frame.forward.xyz) * centre;
    let b = q - dot(q, frame.forward.xyz) * centre;
    let d = select(a, b, dot(b, b) < dot(a, a));
    let along = q - p;
    let turn = select(-1.0, 1.0, i <= j);
    let m = turn * cross(p, along);
    let v = vec3(turn * dot(cross(d, along), centre), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
    // Rounding of the ray, of the way from it to the corner, and of the products; of the sum over a pixel.
    let reach = max(largest(p), largest(q));
    let shift = max(largest(frame.ray_x.xyz), largest(frame.ray_y.xyz));
    let off = (1.6e-6 * reach + 6e-6 * largest(d)) * largest(centre) + 4e-6 * reach * shift;
    return vec4(v, off * largest(along) + 6e-7 * (abs(v.x) + abs(v.y) + abs(v.z)));
}

fn view_of(t: Corners, centre: vec3<f32>) -> View {
    let a = t.a;
    let b = t.b;
    let c = t.c;
    let e = edge_over(t.i.x, t.i.y, a, b, centre);
    let f = edge_over(t.i.y, t.i.z, b, c, centre);
    let g = edge_over(t.i.z, t.i.x, c, a, centre);
    let normal = cross(b - a, c - a);
    // Rounding of the normal and of its products with a corner and with a ray, here and in `eye_depth`;
    // corners are exact.
    let reach = max(largest(a), max(largest(b), largest(c)));
    let doubt = 3e-6 * largest(b - a) * largest(c - a);
    let distance = dot(normal, a);
    let over = sign(distance) * vec3(dot(normal, centre), dot(normal, frame.ray_x.xyz),
        dot(normal, frame.ray_y.xyz));
    let over_doubt = vec3(2.0 * doubt * largest(centre), 0.0, 0.0);
    let distance_doubt = doubt * reach;
    let depths = vec3(dot(a, frame.forward.xyz), dot(b, frame.forward.xyz), dot(c, frame.forward.xyz));
    let nearest = min(depths.x, min(depths.y, depths.z));
    let farthest = max(depths.x, max(depths.y, depths.z));
    let most = (1.0 + INVERSE_SLACK) / (abs(distance) - distance_doubt);
    let least = (1.0 - INVERSE_SLACK) / (abs(distance) + distance_doubt);
    // Where the plane's distance is mostly doubt, nothing but the corners bounds the depth.
    let known = abs(distance) > 2.0 * distance_doubt && most < 1e30;
    return View(
        vec3(e.x, f.x, g.x), vec3(e.y, f.y, g.y), vec3(e.z, f.z, g.z), vec3(e.w, f.w, g.w),
        select(vec3(3.0e38, 0.0, 0.0), (over + over_doubt) * most, known),
        select(vec3(0.0), (over - over_doubt) * least, known),
        select(3.0e38, (1.0 + INVERSE_SLACK) / nearest, nearest > 1e-30),
        select(0.0, (1.0 - INVERSE_SLACK) / farthest, farthest > 1e-30));
}
