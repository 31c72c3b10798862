// cluster_bounds: boxes of clusters of triangles and edges whose vertices move. `of_vertices` reads
// `positions` and writes `vertex_boxes`, one of each 64 vertices in a row; `of_users` reads `uses`,
// where the list of each cluster of triangles, then of edges, begins (and where the last one ends), and
// behind these the lists, of clusters of vertices that it uses; and writes `boxes`, each around those of
// its list. Bounds: an invocation of `of_users` loops three times for each of 64 triangles, or twice for
// each edge, at most.

//@import dispatch cluster_box

struct ClusterBoundsParams {
    vertices: u32,
    clusters: u32,  // of triangles and edges
    pad_0: u32,
    pad_1: u32,
}

const WORKGROUP = 64u;
const SIDE = 8u;  // SIDE * SIDE = WORKGROUP

@group(0) @binding(0) var<uniform> params: ClusterBoundsParams;
@group(0) @binding(1) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(2) var<storage, read_write> vertex_boxes: array<ClusterBox>;
@group(0) @binding(3) var<storage, read> uses: array<u32>;
@group(0) @binding(4) var<storage, read_write> boxes: array<ClusterBox>;

var<workgroup> lows: array<vec3<f32>, WORKGROUP>;
var<workgroup> highs: array<vec3<f32>, WORKGROUP>;

// The box of `SIDE` entries, each `step` after the other, goes into the first.
fn gather(first: u32, step: u32) {
    var low = lows[first];
    var high = highs[first];
    for (var k = 1u; k < SIDE; k++) {
        low = min(low, lows[first + k * step]);
        high = max(high, highs[first + k * step]);
    }
    lows[first] = low;
    highs[first] = high;
}

@compute @workgroup_size(WORKGROUP)
fn of_vertices(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let cluster = flat_group(group, groups);
    if cluster * WORKGROUP >= params.vertices { return; }
    // The last cluster may hold fewer: its last vertex stands for the rest.
    let at = positions[min(cluster * WORKGROUP + local, params.vertices - 1u)];
    lows[local] = at;
    highs[local] = at;
    workgroupBarrier();
    if local < SIDE { gather(local * SIDE, 1u); }
    workgroupBarrier();
    if local == 0u {
        gather(0u, SIDE);
        vertex_boxes[cluster] = ClusterBox(vec4(lows[0], 0.0), vec4(highs[0], 0.0));
    }
}

@compute @workgroup_size(WORKGROUP)
fn of_users(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let cluster = flat_invocation(group, groups, WORKGROUP, local);
    if cluster >= params.clusters { return; }
    let end = uses[cluster + 1u];
    var box = ClusterBox(vec4(3.0e38), vec4(-3.0e38));
    for (var k = uses[cluster]; k < end; k++) {
        let used = vertex_boxes[uses[k]];
        box = ClusterBox(min(box.low, used.low), max(box.high, used.high));
    }
    boxes[cluster] = box;
}
