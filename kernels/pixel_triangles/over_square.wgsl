// A triangle over the squares of pixels: whether it touches one, covers it, and how far off it is there.

//@import frame facing near_distance eye_edges
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read> points: array<vec4<f32>>;

const MARGIN = 1.00001;

// State of a triangle over the square of a pixel.
struct Over {
    touches: bool,
    covers: bool,
    nearest: f32,
    farthest: f32,
}

struct Seen {
    edges: array<vec4<f32>, 3>,  // at the image's middle, per pixel right and down, and doubt
    plane: vec4<f32>,            // normal . ray likewise, and doubt
    distance: f32,
    distance_doubt: f32,
    nearest: f32,
    farthest: f32,
    turn: f32,                   // which sign is inside; 0: not known
    near: vec4<f32>,             // inverse_near likewise, and how much less it may be over a square
}

fn middle() -> vec2<f32> {
    return vec2(0.0, f32(frame.first_row)) + 0.5 * vec2<f32>(frame.image_size);
}

fn seen_triangle(t: u32) -> Seen {
    var s: Seen;
    let i = triangles[t].xyz;
    let ray = frame.ray_corner.xyz + middle().x * frame.ray_x.xyz + middle().y * frame.ray_y.xyz;
    let a = points[i.x].xyz;
    let b = points[i.y].xyz;
    let c = points[i.z].xyz;
    s.edges[0] = eye_edge(i.x, i.y, a, b, ray);
    s.edges[1] = eye_edge(i.y, i.z, b, c, ray);
    s.edges[2] = eye_edge(i.z, i.x, c, a, ray);
    let normal = cross(b - a, c - a);
    // Rounding of the normal, of the corners themselves, and of the products with a ray anywhere in the
    // image.
    let wide = frame.ray_corner.w + largest(ray);
    let reach = max(largest(a), max(largest(b), largest(c)));
    let doubt = 2e-6 * largest(b - a) * largest(c - a) + 6e-7 * reach * (largest(b - a) + largest(c - a));
    s.plane = vec4(dot(normal, ray), dot(normal, frame.ray_x.xyz), dot(normal, frame.ray_y.xyz),
        doubt * wide);
    s.distance = dot(normal, a);
    s.distance_doubt = doubt * reach;
    s.turn = select(0.0, sign(s.distance), abs(s.distance) > s.distance_doubt);
    let depths = vec3(dot(a, frame.forward.xyz), dot(b, frame.forward.xyz), dot(c, frame.forward.xyz));
    s.nearest = min(depths.x, min(depths.y, depths.z));
    s.farthest = max(depths.x, max(depths.y, depths.z));
    let n = frame.near_plane.xyz;
    let across = vec2(dot(n, frame.ray_x.xyz), dot(n, frame.ray_y.xyz));
    s.near = vec4(inverse_near(ray), across,
        0.5 * (abs(across.x) + abs(across.y)) + 2e-6 * largest(n) * (wide + largest(ray)));
    return s;
}

fn over_square(s: Seen, x: u32, y: u32) -> Over {
    var out = Over(true, s.turn != 0.0, s.nearest, s.farthest);
    let at = vec3(1.0, vec2(f32(x), f32(frame.first_row + y)) + 0.5 - middle());
    let v = vec3(dot(s.edges[0].xyz, at), dot(s.edges[1].xyz, at), dot(s.edges[2].xyz, at));
    var half = vec3(0.0);
    for (var k = 0u; k < 3u; k++) { half[k] = 0.5 * (abs(s.edges[k].y) + abs(s.edges[k].z)) + s.edges[k].w; }
    let ahead = all(v >= -half);
    let behind = all(v <= half);
    if s.turn > 0.0 {
        out.touches = ahead;
    } else if s.turn < 0.0 {
        out.touches = behind;
    } else {
        out.touches = ahead || behind;
    }
    out.covers = out.covers && all(s.turn * v > half);
    if s.turn != 0.0 {
        let over = s.turn * dot(s.plane.xyz, at);
        let reach = 0.5 * (abs(s.plane.y) + abs(s.plane.z)) + s.plane.w;
        let distance = abs(s.distance);
        if over + reach > 0.0 {
            out.nearest = max(out.nearest, (distance - s.distance_doubt) / ((over + reach) * MARGIN));
        }
        if over - reach > 0.0 {
            out.farthest = min(out.farthest, (distance + s.distance_doubt) / (over - reach) * MARGIN);
        }
    }
    out.nearest = out.nearest - 2e-6 * abs(out.nearest);
    out.farthest = out.farthest + 2e-6 * abs(out.farthest);
    out.covers = out.covers && out.nearest > frame.forward.w * MARGIN
        && out.nearest * (dot(s.near.xyz, at) - s.near.w) > MARGIN;
    return out;
}
