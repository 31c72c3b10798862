// Alpha-tested casters, which have holes. The fourth word of a triangle is 0, 1 for one of a closed body, or
// one more than the place of an element behind the triangles where such a one is told of: texture coordinates
// of its corners (x, y; x, y), then (x, y, place of its map, its roles). A map is its width, height, cutoff
// (of 255) and how it is asked; then alpha, 16 texels an element.

//@needs var<storage, read> triangles: array<vec4<u32>>;

override ALPHA: u32 = 0u;  // 0: no triangle is tested

const ALPHA_BILINEAR = 1u;
const ALPHA_WRAP_X = 1u;  // bits of the flags from which on, two each: 0 repeats, 1 mirrors, 2 clamps
const ALPHA_WRAP_Y = 3u;

fn wrapped(at: i32, size: u32, how: u32) -> u32 {
    let n = i32(size);
    if how == 2u { return u32(clamp(at, 0, n - 1)); }
    let period = select(n, 2 * n, how == 1u);
    // The quotient may be off by one.
    var turn = at - i32(floor(f32(at) / f32(period))) * period;
    turn = select(turn, turn + period, turn < 0);
    turn = select(turn, turn - period, turn >= period);
    return u32(min(turn, select(turn, 2 * n - 1 - turn, how == 1u)));
}

fn alpha_of(map: u32, head: vec4<u32>, at: vec2<i32>) -> f32 {
    let x = wrapped(at.x, head.x, (head.w >> ALPHA_WRAP_X) & 3u);
    let y = wrapped(at.y, head.y, (head.w >> ALPHA_WRAP_Y) & 3u);
    let texel = y * head.x + x;
    let word = triangles[map + 1u + texel / 16u][(texel >> 2u) & 3u];
    return f32((word >> (8u * (texel & 3u))) & 0xffu);
}

// Whether a map is solid at texture coordinates.
fn is_solid_at(map: u32, uv: vec2<f32>) -> bool {
    let head = triangles[map];
    let bilinear = (head.w & ALPHA_BILINEAR) != 0u;
    let at = uv * vec2<f32>(head.xy) - select(0.0, 0.5, bilinear);
    let first = floor(at);
    let texel = vec2<i32>(first);
    var alpha = alpha_of(map, head, texel);
    if bilinear {
        let between = at - first;
        let right = alpha_of(map, head, texel + vec2(1, 0));
        let below = alpha_of(map, head, texel + vec2(0, 1));
        let last = alpha_of(map, head, texel + vec2(1, 1));
        alpha = mix(mix(alpha, right, between.x), mix(below, last, between.x), between.y);
    }
    return alpha >= bitcast<f32>(head.z);
}

// Whether a tested triangle is there at a point of it, by the shares of the second and the third corner.
fn is_solid_by(word: u32, shares: vec2<f32>) -> bool {
    let told = triangles[word - 1u];
    let more = triangles[word];
    let first = bitcast<vec2<f32>>(told.xy);
    let uv = first + shares.x * (bitcast<vec2<f32>>(told.zw) - first)
        + shares.y * (bitcast<vec2<f32>>(more.xy) - first);
    return is_solid_at(more.z, uv);
}

// The corners of a triangle, and the view direction in a mapped world, else 0.
struct Card { a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, ahead: vec3<f32> }

// Shares of the second and the third corner where the triangle is in the world, by those in a world that a
// homography maps, and view depths of the corners: these, relative to the eye, go as one by their divisors.
fn shares_by_depths(shares: vec2<f32>, depths: vec3<f32>) -> vec2<f32> {
    let parts = vec3(1.0 - shares.x - shares.y, shares) * depths;
    return parts.yz / (parts.x + parts.y + parts.z);
}

// The same by the corners; in a world that none maps they are what they are.
fn world_shares(shares: vec2<f32>, card: Card) -> vec2<f32> {
    if all(card.ahead == vec3(0.0)) { return shares; }
    let depths = vec3(dot(card.a, card.ahead), dot(card.b, card.ahead), dot(card.c, card.ahead));
    return shares_by_depths(shares, depths);
}

// Whether a tested triangle with these corners is there where the line from a point along `way` crosses it
// (Moeller, Trumbore 1997). Edge-on it counts as whole.
fn is_solid(word: u32, card: Card, point: vec3<f32>, way: vec3<f32>) -> bool {
    let ab = card.b - card.a;
    let ac = card.c - card.a;
    let over = cross(way, ac);
    let scale = dot(ab, over);
    if scale == 0.0 { return true; }
    let from_a = point - card.a;
    let across = cross(from_a, ab);
    let shares = vec2(dot(from_a, over), dot(way, across)) / scale;
    return is_solid_by(word, world_shares(shares, card));
}
