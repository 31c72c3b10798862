// The triangle of a surface that casts nothing.

//@import frame facing given_place
//@needs var<uniform> frame: Frame;
//@needs var<storage, read_write> positions: array<vec3<f32>>;
//@needs var<storage, read_write> made_triangles: array<vec3<u32>>;

const REACH = 3.0; // pixels: samples of the pixels two away from one, whose surface is given anywhere in it

// The power of two that is not below a number, 1 to 32.
fn power_above(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(clamp(x, 1.0, 32.0)) + 0x7fffffu) & 0x7f800000u);
}

// A triangle around the place, large beside its coordinates, so that their rounding turns it little, and so
// large that it holds what rays REACH pixels away meet of its plane, where that is not too far off.
fn write_triangle(pixel: u32, at: vec2<i32>, p: Place, n: vec3<f32>) {
    let size = max(largest(p.world), p.depth / frame.eye.w);
    let over = abs(dot(n, ray_of(at)));
    let less = REACH * (abs(dot(n, frame.ray_x.xyz)) + abs(dot(n, frame.ray_y.xyz)));
    let farther = less / max(over - less, over / 16.0);
    let leg = bitcast<f32>(bitcast<u32>(size) & 0x7f800000u) * 2.0 * power_above(2.5 * farther);
    let m = abs(n);
    let k = select(select(2u, 1u, m.y >= m.z), 0u, m.x >= m.y && m.x >= m.z);
    let i = (k + 1u) % 3u;
    let j = (k + 2u) % 3u;
    var corners = array<vec2<f32>, 3>(vec2(-1.0, -1.0), vec2(1.0, 0.0), vec2(0.0, 1.0));
    for (var c = 0u; c < 3u; c++) {
        var q = p.world;
        q[i] += corners[c].x * leg;
        q[j] += corners[c].y * leg;
        q[k] -= (n[i] * (q[i] - p.world[i]) + n[j] * (q[j] - p.world[j])) / n[k];
        let v = frame.vertex_count + 3u * pixel + c;
        positions[v] = q;
        made_triangles[frame.triangle_count + pixel][c] = v;
    }
}
