// Which owner a work item belongs to: `work_offsets` is the exclusive scan of the items of each owner, the total after the
// last, a flag, and then what work_owners made of them: the places of a table, 0 where there is none, and the table.

fn owner_of(item: u32, owners: u32) -> u32 {
    var low = 0u;
    var high = owners;
    let k = item >> 3u;
    if k + 1u < work_offsets[owners + 2u] {
        low = work_offsets[owners + 3u + k];
        high = work_offsets[owners + 4u + k] + 1u;
    }
    while low < high {
        let middle = (low + high) >> 1u;
        if work_offsets[middle] <= item { low = middle + 1u; } else { high = middle; }
    }
    return low - 1u;
}
