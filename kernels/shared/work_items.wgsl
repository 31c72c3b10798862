// Which owner a work item belongs to: `work_offsets` is the exclusive scan of the items of each owner,
// and the total after the last.

fn owner_of(item: u32, owners: u32) -> u32 {
    var low = 0u;
    var high = owners;
    while low < high {
        let middle = (low + high) >> 1u;
        if work_offsets[middle] <= item { low = middle + 1u; } else { high = middle; }
    }
    return low - 1u;
}
