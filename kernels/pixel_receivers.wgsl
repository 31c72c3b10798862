// pixel_receivers: what each pixel shows by an application's depth or position texture: a triangle of the
// casters, or a surface that casts nothing, which gets a triangle of its own behind the casters' triangles
// and vertices. Reads `place` (with GIVEN_POSITIONS world positions, nothing where alpha is 0; else depth,
// nothing at `nothing`), with GIVEN_NORMALS world normals, with GIVEN_IDS the application's triangle numbers,
// and `id_keys` (complement of the casters' triangle at each pixel centre). A number says that the pixel
// shows that caster. Without numbers it shows the caster at its centre if its surface lies on that one's
// plane, give or take `tolerance` of its view depth, else one that a neighbour pixel shows and whose edge is
// no farther than NEAR_EDGE pixels: two rasterizers differ there. Of all other surfaces it writes vertices to
// `positions` and their indices to `triangles`. Writes `keys` (complement of the triangle, 0 where there is
// none) and counts into `faults` texels that name no triangle or are no place, which count as none.

//@import frame dispatch divide strip facing finite vertex

const WORKGROUP = 64u;
const FAULT_UNKNOWN = 2u;
const FAULT_UNUSABLE = 3u;
const NEAR_EDGE = 0.03125;
const MOST_STEPS = 4u; // pixels to look for a neighbour on the same surface; rows that strips share

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> params: PixelReceiversParams;
@group(0) @binding(2) var place: texture_2d<f32>;
@group(0) @binding(3) var normals: texture_2d<f32>;
@group(0) @binding(4) var ids: texture_2d<u32>;
@group(0) @binding(5) var<storage, read> numbers: array<u32>;
@group(0) @binding(6) var<storage, read> id_keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> triangles: array<vec3<u32>>;
@group(0) @binding(8) var<storage, read_write> positions: array<vec3<f32>>;
@group(0) @binding(9) var<storage, read_write> keys: array<u32>;
@group(0) @binding(10) var<storage, read_write> faults: array<atomic<u32>>;

//@import given_place

// Whether the surface is that of triangle `t`: on its plane and, seen from the eye, in it, give or take
// `reach` pixels.
fn shows(t: u32, p: Place, ray: vec3<f32>, reach: f32) -> bool {
    let i = triangles[t];
    let normal = cross(edge_of(i.x, i.y), edge_of(i.x, i.z));
    let size = largest(normal);
    if !(size > 0.0) { return false; }
    let n = normal / size;
    if !(abs(dot(n, p.point - point_of(i.x))) <= params.tolerance * p.depth * length(n)) { return false; }
    var ahead = true;
    var behind = true;
    for (var k = 0u; k < 3u; k++) {
        let u = i[k];
        let m = cross(point_of(u), edge_of(u, i[(k + 1u) % 3u]));
        let v = dot(m, ray);
        let slack = reach * (abs(dot(m, frame.ray_x.xyz)) + abs(dot(m, frame.ray_y.xyz)));
        ahead = ahead && v >= -slack;
        behind = behind && v <= slack;
    }
    return ahead || behind;
}

// The caster that the pixel shows; NO_TRIANGLE if it shows none.
fn caster_at(at: vec2<i32>, p: Place) -> u32 {
    let ray = ray_of(at);
    let size = vec2<i32>(frame.image_size);
    for (var k = 0; k < 9; k++) {
        // The pixel itself is the first.
        let q = at + (vec2((k + 4) % 9 % 3, (k + 4) % 9 / 3) - 1);
        if any(q < vec2(0)) || any(q >= size) { continue; }
        let t = ~id_keys[u32(q.y * size.x + q.x)];
        if t < frame.triangle_count && shows(t, p, ray, select(NEAR_EDGE, 1.0, k == 0)) { return t; }
    }
    return NO_TRIANGLE;
}

// Place of a neighbour's surface, if it is no caster.
fn other_at(at: vec2<i32>) -> Place {
    var p = place_at(at);
    if p.what != SURFACE { return p; }
    var is_caster = false;
    if (params.given & GIVEN_IDS) != 0u {
        is_caster = textureLoad(ids, given_texel(vec2<u32>(at)), 0).x != params.none;
    } else {
        let t = ~id_keys[u32(at.y * i32(frame.image_size.x) + at.x)];
        is_caster = t < frame.triangle_count && shows(t, p, ray_of(at), 1.0);
    }
    if is_caster { p.what = NOTHING; }
    return p;
}

// From the surface to that of the nearest neighbour, of two the one whose depth differs less; 0 if there is
// none.
fn step_along(at: vec2<i32>, by: vec2<i32>, p: Place) -> vec3<f32> {
    for (var d = 1; d <= i32(MOST_STEPS); d++) {
        let q = other_at(at + by * d);
        let r = other_at(at - by * d);
        let ahead = select(3.0e38, abs(q.depth - p.depth), q.what == SURFACE);
        let behind = select(3.0e38, abs(r.depth - p.depth), r.what == SURFACE);
        if min(ahead, behind) < 3.0e38 {
            return select(p.point - r.point, q.point - p.point, ahead <= behind);
        }
    }
    return vec3(0.0);
}

fn normal_at(at: vec2<i32>, p: Place) -> vec3<f32> {
    if (params.given & GIVEN_NORMALS) != 0u {
        return textureLoad(normals, given_texel(vec2<u32>(at)), 0).xyz;
    }
    let a = step_along(at, vec2(1, 0), p);
    let b = step_along(at, vec2(0, 1), p);
    let n = cross(a / max(largest(a), 1e-30), b / max(largest(b), 1e-30));
    // Alone in its row or column, it faces the eye.
    return select(ray_of(at), n, largest(n) > 0.0);
}

// A triangle around the place, large beside its coordinates, so that their rounding turns it little.
fn write_triangle(pixel: u32, p: Place, n: vec3<f32>) {
    let size = max(largest(p.world), p.depth / frame.eye.w);
    let leg = bitcast<f32>(bitcast<u32>(size) & 0x7f800000u) * 2.0;
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
        triangles[frame.triangle_count + pixel][c] = v;
    }
}

fn count_fault(fault: u32, at: vec2<i32>) {
    if is_own(u32(at.y)) { atomicAdd(&faults[fault], 1u); }
}

fn key_at(pixel: u32, at: vec2<i32>) -> u32 {
    if (params.given & GIVEN_IDS) != 0u {
        let id = textureLoad(ids, given_texel(vec2<u32>(at)), 0).x;
        let given = id - params.first;
        if id != params.none && id >= params.first && given < frame.triangle_count { return ~numbers[given]; }
        if id != params.none {
            count_fault(FAULT_UNKNOWN, at);
            return 0u;
        }
    }
    let p = place_at(at);
    if p.what == NOTHING { return 0u; }
    if p.what == SURFACE && (params.given & GIVEN_IDS) == 0u {
        let t = caster_at(at, p);
        if t != NO_TRIANGLE { return ~t; }
    }
    let n = normal_at(at, p);
    let size = largest(n);
    if p.what == FAULT || !all_finite(n) || size == 0.0 {
        count_fault(FAULT_UNUSABLE, at);
        return 0u;
    }
    write_triangle(pixel, p, n / size);
    return ~(frame.triangle_count + pixel);
}

@compute @workgroup_size(WORKGROUP)
fn take(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    keys[pixel] = key_at(pixel, vec2<i32>(place_in_strip(pixel)));
}
