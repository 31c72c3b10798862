// A triangle as the rays of one pixel see it: edge functions and inverse depth, linear in the offset from the
// pixel centre, with bounds of their doubt.

//@import frame facing eye_edges
//@needs var<uniform> frame: Frame;

struct View {
    at: vec3<f32>,      // the three edge functions at the pixel centre
    right: vec3<f32>,   // what a pixel to the right adds, and one down
    down: vec3<f32>,
    doubt: vec3<f32>,   // how far one may be off anywhere in the pixel, and `eye_edge_near` too
    high: f32,          // upper bound of the inverse depth at the centre
    low: f32,           // lower bound likewise
    slopes: vec2<f32>,  // what a pixel to the right adds to the inverse depth, and one down
    highest: f32,       // bounds of it over the whole triangle, if that is ahead of the eye
    lowest: f32,
    turn: f32,          // which sign of the edge functions is inside; 0: not known
}

// Edge function at the pixel centre, per pixel right, per pixel down, and doubt; `from_i` and `from_j` as
// from_ray has the corners. Evaluated from the end that is nearer to the ray, so that small triangles far
// away are as certain as large ones nearby.
fn edge_over(i: u32, j: u32, at_i: vec3<f32>, at_j: vec3<f32>, from_i: vec3<f32>, from_j: vec3<f32>,
    centre: vec3<f32>) -> vec4<f32> {
    let p = select(at_j, at_i, i <= j);
    let along = select(at_i, at_j, i <= j) - p;
    let d = select(from_i, from_j, dot(from_j, from_j) < dot(from_i, from_i));
    let turn = select(-1.0, 1.0, i <= j);
    let m = turn * cross(p, along);
    let v = vec3(turn * dot(cross(d, along), centre), dot(m, frame.ray_x.xyz), dot(m, frame.ray_y.xyz));
    // Rounding of the ray, of the way from it to the corner, and of the products; of the sum over a pixel.
    let reach = max(largest(at_i), largest(at_j));
    let shift = max(largest(frame.ray_x.xyz), largest(frame.ray_y.xyz));
    let off = (1.6e-6 * reach + 6e-6 * largest(d)) * largest(centre) + 4e-6 * reach * shift;
    return vec4(v, off * largest(along) + 6e-7 * (abs(v.x) + abs(v.y) + abs(v.z)));
}

// Inverse depth of the plane `normal`, in which `d` leads from the ray to a corner (xyz) at a depth (w);
// its doubt is 3e38 where rounding leaves nothing of it. Away from the triangle it is another.
fn plane_over(normal: vec3<f32>, sides: f32, reach: f32, d: vec4<f32>, centre: vec3<f32>) -> vec4<f32> {
    let over = dot(normal, centre);
    // The normal's rounding, in what is made of it; that of corners and rays moves the plane along it.
    let off = 1e-6 * sides * largest(centre);
    let per_over = 1.0 / abs(over);
    let ahead = dot(normal, d.xyz) / over;
    let depth = d.w + ahead;
    let moved = 1e-6 * (sides * largest(d.xyz) + reach * largest(normal) * largest(centre))
        + abs(ahead) * off;
    let doubt = 2.0 * moved * per_over + 1e-6 * reach;
    let inverse = 1.0 / depth;
    let slopes = vec2(dot(normal, frame.ray_x.xyz), dot(normal, frame.ray_y.xyz)) * (inverse / over);
    let shift = largest(frame.ray_x.xyz) + largest(frame.ray_y.xyz);
    // Over half a pixel each way; of the inverse depth, which the slopes share, twice its relative doubt.
    let steep = abs(slopes.x) + abs(slopes.y);
    let tilt = 2.0 * per_over * (1e-6 * sides * shift * inverse + steep * off) + steep * doubt * inverse;
    let known = abs(over) > 2.0 * off && depth > 2.0 * doubt;
    return vec4(inverse, slopes, select(3.0e38, 2.0 * doubt * inverse * inverse + tilt, known));
}

fn view_of(t: Corners, centre: vec3<f32>) -> View {
    let a = from_ray(t.a, centre);
    let b = from_ray(t.b, centre);
    let c = from_ray(t.c, centre);
    let e = edge_over(t.i.x, t.i.y, t.a, t.b, a.xyz, b.xyz, centre);
    let f = edge_over(t.i.y, t.i.z, t.b, t.c, b.xyz, c.xyz, centre);
    let g = edge_over(t.i.z, t.i.x, t.c, t.a, c.xyz, a.xyz, centre);
    let ab = t.b - t.a;
    let ac = t.c - t.a;
    let reach = max(largest(t.a), max(largest(t.b), largest(t.c)));
    let nearer = dot(b.xyz, b.xyz) < dot(a.xyz, a.xyz);
    let first = select(a, b, nearer);
    let d = select(first, c, dot(c.xyz, c.xyz) < dot(first.xyz, first.xyz));
    let normal = cross(ab, ac);
    let plane = plane_over(normal, largest(ab) * largest(ac), reach, d, centre);
    let distance = dot(normal, t.a);
    let moved = reach * (2e-6 * largest(ab) * largest(ac) + 6e-7 * reach * (largest(ab) + largest(ac)));
    let nearest = min(a.w, min(b.w, c.w));
    let farthest = max(a.w, max(b.w, c.w));
    let slack = 1e-6 * reach;
    // Else rays that meet it behind the eye lie inside the same edges: only the plane says that it is ahead.
    let ahead = nearest > slack + 1e-30;
    // Where the plane is mostly doubt, nothing but the corners bounds the depth.
    let known = plane.w < 1e38;
    return View(
        vec3(e.x, f.x, g.x), vec3(e.y, f.y, g.y), vec3(e.z, f.z, g.z), vec3(e.w, f.w, g.w),
        select(3.0e38, plane.x + plane.w, known), select(-3.0e38, plane.x - plane.w, known),
        select(vec2(0.0), plane.yz, known),
        select(3.0e38, 1.0 / (nearest - slack), ahead),
        select(0.0, 1.0 / (farthest + slack), ahead),
        select(0.0, sign(distance), abs(distance) > moved));
}
