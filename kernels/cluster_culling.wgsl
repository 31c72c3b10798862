// cluster_culling: which clusters of 64 triangles, edges or vertices a view may hold something of.
// `test_camera` and `test_light` read `boxes` (world units, those of triangles first, then of edges and
// of vertices) and write `marks`, a bit for each that is kept, and their number in each word,
// `mark_counts`; the prefix_scan of those gives `offsets`; `emit` writes `kept_clusters`: a head and
// those that are kept of each part, in order (see clusters); and adds to the counter of kept triangles.
// A cluster is dropped where its box lies beyond one side of the view, behind the camera's near plane or
// behind the light, or where no block of texels that it may touch is requested. Margins grow from edges
// to triangles to vertices: an edge in the view has triangles that are kept, and what is kept has its
// vertices, as the box of a cluster of vertices holds those of all clusters that use one. Bounds: an
// invocation of `emit` loops 32 times.

//@import frame dispatch status rect view_sides map_ends requested_part clusters cluster_box

struct ClusterParams {
    // x: of triangles, y: of edges, z: of vertices
    clusters: vec4<u32>,
    first_words: vec4<u32>,  // where their marks begin, and at which word those of all end: whole workgroups
    elements: vec4<u32>,     // that the clusters hold
}

const WORKGROUP = 64u;
const WORDS = 2u;  // of marks, that a workgroup writes

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> params: ClusterParams;
@group(0) @binding(2) var<storage, read> boxes: array<ClusterBox>;
@group(0) @binding(3) var<storage, read> requested: array<u32>;
@group(0) @binding(4) var<storage, read_write> marks: array<u32>;
@group(0) @binding(5) var<storage, read_write> mark_counts: array<u32>;
@group(0) @binding(6) var<storage, read> offsets: array<u32>;
@group(0) @binding(7) var<storage, read_write> kept_clusters: array<u32>;
@group(0) @binding(8) var<storage, read_write> status: Status;

//@import frame_copy

var<workgroup> bits: array<atomic<u32>, WORDS>;

// The part that a word of marks belongs to.
fn part_of(word: u32) -> u32 {
    return select(0u, 1u, word >= params.first_words.y) + select(0u, 1u, word >= params.first_words.z);
}

// A box as the frame has points: each step is rounded the same way for all that lies in it.
struct Box { low: vec3<f32>, high: vec3<f32> }

fn box_of(cluster: u32) -> Box {
    let given = boxes[cluster];
    return Box(((given.low.xyz - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w,
        ((given.high.xyz - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w);
}

fn corner_of(box: Box, k: u32) -> vec3<f32> {
    return select(box.low, box.high, (vec3(k) & vec3(1u, 2u, 4u)) != vec3(0u));
}

// How far it reaches from the eye along an axis.
fn reach_of(box: Box) -> f32 {
    let out = max(abs(box.low), abs(box.high));
    return max(out.x, max(out.y, out.z));
}

// Whether some pixel may see part of the box.
fn is_in_camera(box: Box) -> bool {
    var low = vec2(1e30);
    var high = vec2(-1e30);
    var nearest = 1e30;
    var farthest = -1e30;
    for (var k = 0u; k < 8u; k++) {
        let p = corner_of(box, k);
        let depth = dot(p, frame.forward.xyz);
        let at = vec2(dot(p, frame.pixel_x.xyz), dot(p, frame.pixel_y.xyz)) / depth
            + vec2(frame.pixel_x.w, frame.pixel_y.w);
        low = min(low, at);
        high = max(high, at);
        nearest = min(nearest, depth);
        farthest = max(farthest, depth);
    }
    let doubt = 1e-6 * reach_of(box);
    if farthest < frame.forward.w - doubt { return false; }
    if !(nearest > frame.forward.w) { return true; }
    let middle = abs(vec2(frame.pixel_x.w, frame.pixel_y.w));
    let out = max(max(abs(low), abs(high)), middle);
    let slack = 0.0625 + 4e-6 * max(out.x, out.y);
    let first = f32(frame.first_row);
    let size = vec2<f32>(frame.image_size);
    return !(high.x + slack < 0.0 || low.x - slack > size.x
        || high.y + slack < first || low.y - slack > first + size.y);
}

// Whether some texel may be touched by what lies in the box; `times` the margins of a triangle.
fn is_in_light(box: Box, times: f32) -> bool {
    var beyond = vec4(1e30);
    var low = vec2(1e30);
    var high = vec2(-1e30);
    var nearest = 1e30;
    var farthest = -1e30;
    var noise = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let seen = in_view(corner_of(box, k));
        beyond = min(beyond, seen.beyond);
        let at = -seen.beyond.xy / seen.w;
        low = min(low, at);
        high = max(high, at);
        nearest = min(nearest, seen.w);
        farthest = max(farthest, seen.w);
        noise = max(noise, seen.noise);
    }
    let reach = frame.map_margin * max(1.0, reach_of(box));
    let slack = times * (reach * max(abs(nearest), abs(farthest)) + noise);
    let perspective = (frame.flags & FLAG_PERSPECTIVE) != 0u;
    // Of divisors; that of texels is of a whole map times the divisor.
    let doubt = times * noise / f32(frame.map_size);
    if perspective && farthest < -2.0 * frame.light_low.w - doubt { return false; }
    let in_front = !perspective || nearest > frame.light_low.w + doubt;
    let out = max(abs(low), abs(high));
    let wide = times * (frame.map_margin + 4e-6 * max(out.x, out.y));
    // A triangle that goes on beyond an end takes the whole map; one not in front of the light may.
    low = select(vec2(-1e30), low - wide, in_front);
    high = select(vec2(1e30), high + wide, in_front);
    if ends_beyond(low, high) != 0u { return true; }
    if any(beyond > vec4(slack)) { return false; }
    return !in_front || !is_empty(requested_part(cells_touched(low, high, vec2(frame.map_size))));
}

// The cluster of an invocation by its part, and its place among all.
struct Cluster { part: u32, place: u32, some: bool }

fn cluster_of(group: u32, local: u32) -> Cluster {
    let part = part_of(group * WORDS);
    let place = (group * WORDS - params.first_words[part]) * 32u + local;
    let before = select(0u, params.clusters.x, part > 0u) + select(0u, params.clusters.y, part > 1u);
    return Cluster(part, before + place, place < params.clusters[part]);
}

// Writes the marks of a workgroup.
fn mark(group: u32, local: u32, keeps: bool) {
    if keeps { atomicOr(&bits[local / 32u], 1u << (local % 32u)); }
    workgroupBarrier();
    if local < WORDS {
        let word = atomicLoad(&bits[local]);
        marks[group * WORDS + local] = word;
        mark_counts[group * WORDS + local] = countOneBits(word);
    }
}

@compute @workgroup_size(WORKGROUP)
fn test_camera(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let at = flat_group(group, groups);
    if at * WORDS >= params.first_words.w { return; }
    let cluster = cluster_of(at, local);
    mark(at, local, cluster.some && is_in_camera(box_of(cluster.place)));
}

@compute @workgroup_size(WORKGROUP)
fn test_light(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let at = flat_group(group, groups);
    if at * WORDS >= params.first_words.w { return; }
    let cluster = cluster_of(at, local);
    let times = vec3(4.0, 2.0, 8.0)[cluster.part];
    mark(at, local, cluster.some && is_in_light(box_of(cluster.place), times));
}

// Elements of the kept clusters of a part: the last cluster may hold fewer.
fn elements_of(part: u32, count: u32) -> u32 {
    if params.clusters[part] == 0u { return 0u; }
    let last = params.clusters[part] - 1u;
    let marked = (marks[params.first_words[part] + last / 32u] >> (last % 32u)) & 1u;
    return CLUSTER_SIZE * count - marked * (CLUSTER_SIZE * params.clusters[part] - params.elements[part]);
}

@compute @workgroup_size(WORKGROUP)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let word = flat_invocation(group, groups, WORKGROUP, local);
    if word < PARTS {
        let first = offsets[params.first_words[word]];
        let count = offsets[params.first_words[word + 1u]] - first;
        kept_clusters[word] = count;
        kept_clusters[PARTS + word] = first;
        let elements = elements_of(word, count);
        if word < PART_VERTICES { kept_clusters[2u * PARTS + word] = elements; }
        if word == PART_TRIANGLES { atomicAdd(&status.head.kept_triangles, elements); }
    }
    if word >= params.first_words.w { return; }
    var left = marks[word];
    let first = (word - params.first_words[part_of(word)]) * 32u;
    for (var at = KEPT_HEAD + offsets[word]; left != 0u; at++) {
        kept_clusters[at] = first + firstTrailingBit(left);
        left &= left - 1u;
    }
}
