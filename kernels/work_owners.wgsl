// work_owners: which owner every eighth work item belongs to, so that the kernels that go through the items
// need not search all owners for each. Reads `work_offsets` (exclusive scan of the items of each owner, the
// total, the overflow flag). Writes behind these how many places the table has, as far as there is room, and
// the table: the owner of item 8 k at place k, that of the last item at the last (see work_items).

//@import dispatch work_items

struct WorkOwnersParams {
    owners: u32,
    // Places behind the head; `arrayLength` would count the buffer's padding, which no invocation fills
    room: u32,
    pad_0: u32,
    pad_1: u32,
}

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> params: WorkOwnersParams;
@group(0) @binding(1) var<storage, read_write> work_offsets: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn list(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let k = flat_invocation(group, groups, WORKGROUP, local);
    let table = params.owners + HEAD;
    let total = work_offsets[params.owners];
    let last = (max(total, 1u) - 1u) / STRIDE + 1u;
    let places = min(params.room, select(last + 1u, 0u, total == 0u));
    if k == 0u { work_offsets[table - 1u] = places; }
    if k >= places { return; }
    let item = select(STRIDE * k, total - 1u, k == last);
    work_offsets[table + k] = owner_between(item, 0u, params.owners);
}
