// pixel_receivers: what each pixel shows by an application's depth or position texture: a triangle of the
// casters, or a surface that casts nothing, which gets a triangle of its own behind the casters' triangles
// and vertices. Reads `place` (with GIVEN_POSITIONS world positions, nothing where alpha is 0; else depth,
// nothing at `nothing`; with GIVEN_SAMPLES that of one sample of `place_samples`), with GIVEN_NORMALS world
// normals (with GIVEN_NORMAL_SAMPLES of that sample), with GIVEN_IDS the application's triangle numbers,
// which say that a pixel shows that caster. Without numbers it shows a caster on whose plane its surface
// lies, give or take `tolerance` of its view depth, and whose edges are no farther outside than NEAR_EDGE
// pixels: two rasterizers differ there. `find` takes for it the caster at the pixel centre (`id_keys`,
// complement) if it is one, `claim` looks through the blocks of all casters (`camera_rects`, `work_offsets`)
// at the pixels that are left, of several for the lowest; `claims` has OPEN for surfaces that are no caster,
// 0 for none. `take` writes of these vertices to `positions` and their indices to `triangles`, for all
// pixels `keys` (complement of the triangle, 0 where there is none), and counts into `faults` texels that
// name no triangle or are no place, which count as none.

//@import frame dispatch divide strip facing finite vertex rect work_items alpha mapped_view

const WORKGROUP = 64u;
const FAULT_UNKNOWN = 2u;
const FAULT_UNUSABLE = 3u;
const NEAR_EDGE = 0.03125;
const OPEN = 0xffffffffu;
const CLAIMED = 0x40000000u;  // set in a claim of another caster than that at the centre
const MOST_STEPS = 4u; // pixels to look for a neighbour on the same surface; rows that strips share

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> params: PixelReceiversParams;
@group(0) @binding(2) var place: texture_2d<f32>;
@group(0) @binding(3) var normals: texture_2d<f32>;
@group(0) @binding(4) var ids: texture_2d<u32>;
@group(0) @binding(5) var<storage, read> numbers: array<u32>;
@group(0) @binding(6) var<storage, read> id_keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> made_triangles: array<vec3<u32>>;
@group(0) @binding(8) var<storage, read_write> positions: array<vec3<f32>>;
@group(0) @binding(9) var<storage, read_write> keys: array<u32>;
@group(0) @binding(10) var<storage, read_write> faults: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read_write> claims: array<atomic<u32>>;
@group(0) @binding(12) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(13) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(14) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(15) var place_samples: texture_multisampled_2d<f32>;
@group(0) @binding(16) var normal_samples: texture_multisampled_2d<f32>;

//@import given_place receiver_triangle

// A caster's plane, for each edge what is 0 on rays through it, and its fourth word.
struct Outline { normal: vec3<f32>, corner: vec3<f32>, edges: array<vec3<f32>, 3>, card: Card, word: u32 }

fn outline_of(t: u32) -> Outline {
    let i = triangles[t];
    let normal = cross(edge_of(i.x, i.y), edge_of(i.x, i.z));
    var o: Outline;
    o.word = i.w;
    o.card = Card(point_of(i.x), point_of(i.y), point_of(i.z), mapped_ahead());
    o.normal = select(vec3(0.0), normal / largest(normal), largest(normal) > 0.0);
    o.corner = point_of(i.x);
    o.edges[0] = cross(o.corner, edge_of(i.x, i.y));
    o.edges[1] = cross(point_of(i.y), edge_of(i.y, i.z));
    o.edges[2] = cross(point_of(i.z), edge_of(i.z, i.x));
    return o;
}

// Whether a surface is that of a caster: on its plane and, seen from the eye, in it, give or take `reach`
// pixels, and not in a hole. A caster without a normal has none.
fn shows(o: Outline, p: Place, ray: vec3<f32>, reach: f32) -> bool {
    let off = abs(dot(o.normal, p.point - o.corner));
    // Positions are as exact as their coordinates are large.
    let rounded = select(0.0, 4e-7 * largest(p.world) * frame.eye.w, (params.given & GIVEN_POSITIONS) != 0u);
    let most = (params.tolerance * p.depth + rounded) * length(o.normal);
    if off > most || largest(o.normal) == 0.0 { return false; }
    var ahead = true;
    var behind = true;
    for (var k = 0u; k < 3u; k++) {
        let m = o.edges[k];
        let v = dot(m, ray);
        let slack = reach * (abs(dot(m, frame.ray_x.xyz)) + abs(dot(m, frame.ray_y.xyz)));
        ahead = ahead && v >= -slack;
        behind = behind && v <= slack;
    }
    let hole = ALPHA != 0u && is_tested(o.word) && !is_solid(o.word, o.card, vec3(0.0), ray);
    return (ahead || behind) && !hole;
}

// Place of a neighbour's surface, if it is no caster.
fn other_at(at: vec2<i32>) -> Place {
    var p = place_at(at);
    if p.what != SURFACE { return p; }
    var is_caster = false;
    if (params.given & GIVEN_IDS) != 0u {
        is_caster = textureLoad(ids, given_texel(vec2<u32>(at)), 0).x != params.none;
    } else {
        is_caster = atomicLoad(&claims[u32(at.y) * frame.image_size.x + u32(at.x)]) != OPEN;
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
    let there = given_texel(vec2<u32>(at));
    if (params.given & GIVEN_NORMAL_SAMPLES) != 0u {
        return textureLoad(normal_samples, there, params.sample).xyz;
    }
    if (params.given & GIVEN_NORMALS) != 0u { return textureLoad(normals, there, 0).xyz; }
    let a = step_along(at, vec2(1, 0), p);
    let b = step_along(at, vec2(0, 1), p);
    let n = cross(a / max(largest(a), 1e-30), b / max(largest(b), 1e-30));
    // Alone in its row or column, it faces the eye.
    return select(ray_of(at), n, largest(n) > 0.0);
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
        let claim = atomicLoad(&claims[pixel]);
        if claim != OPEN { return ~((claim & ~CLAIMED) - 1u); }
    }
    let n = normal_at(at, p);
    let size = largest(n);
    if p.what == FAULT || !all_finite(n) || size == 0.0 {
        count_fault(FAULT_UNUSABLE, at);
        return 0u;
    }
    write_triangle(pixel, at, p, n / size);
    return ~(frame.triangle_count + pixel);
}

@compute @workgroup_size(WORKGROUP)
fn find(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let at = vec2<i32>(place_in_strip(pixel));
    let p = place_at(at);
    let t = ~id_keys[pixel];
    var claim = select(0u, OPEN, p.what == SURFACE);
    if claim == OPEN && t < frame.triangle_count {
        if shows(outline_of(t), p, ray_of(at), 1.0) { claim = t + 1u; }
    }
    atomicStore(&claims[pixel], claim);
}

@compute @workgroup_size(WORKGROUP)
fn claim(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    let block = block_of(camera_rects[t], item - work_offsets[slot]);
    let outline = outline_of(t);
    for (var y = block.low.y; y <= block.high.y; y++) {
        for (var x = block.low.x; x <= block.high.x; x++) {
            let pixel = y * frame.image_size.x + x;
            if atomicLoad(&claims[pixel]) < CLAIMED { continue; }
            let at = vec2<i32>(vec2(x, y));
            if shows(outline, place_at(at), ray_of(at), NEAR_EDGE) {
                atomicMin(&claims[pixel], CLAIMED | (t + 1u));
            }
        }
    }
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
