// work_owners: which owner every eighth work item belongs to, so that the kernels that go through the
// items need not search all owners for each. Reads `work_offsets` (exclusive scan of the items in each
// slot, the total, the overflow flag). Writes behind these where the list of clusters begins (0: there
// is none), how many slots are in use, how many places the table has, as far as there is room, and the
// table: the slot of item 8 k at place k, that of the last item at the last (see work_items).
// `list_clusters` copies the clusters of `part` that are kept. Bounds: an invocation of `list` loops as
// often as there are places for each.
//@bindings Lists: list, list_clusters

//@import dispatch work_items clusters

struct WorkOwnersParams {
    owners: u32,
    // Places behind the head; `arrayLength` would count the buffer's padding, which no invocation fills
    room: u32,
    clusters: u32,  // where the list of clusters begins; 0: there is none
    part: u32,
}

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> params: WorkOwnersParams;
@group(0) @binding(1) var<storage, read_write> work_offsets: array<u32>;
@group(0) @binding(2) var<storage, read> kept_clusters: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn list(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    let table = params.owners + HEAD;
    var slots = params.owners;
    if params.clusters != 0u { slots = kept_clusters[2u * PARTS + params.part]; }
    let total = work_offsets[params.owners];
    let last = (max(total, 1u) - 1u) / STRIDE + 1u;
    let places = min(params.room, select(last + 1u, 0u, total == 0u));
    if k == 0u {
        work_offsets[table - 1u] = places;
        work_offsets[table - 2u] = select(slots, 0u, params.clusters == 0u);
        work_offsets[table - 3u] = params.clusters;
    }
    for (var place = k; place < places; place += WORKGROUP * groups.x * groups.y) {
        let item = select(STRIDE * place, total - 1u, place == last);
        work_offsets[table + place] = slot_between(item, 0u, slots);
    }
}

@compute @workgroup_size(WORKGROUP)
fn list_clusters(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    if k >= kept_clusters[params.part] { return; }
    work_offsets[params.clusters + k] = kept_clusters[first_kept(params.part) + k];
}
