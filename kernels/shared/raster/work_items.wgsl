// Which owner a work item belongs to: `work_offsets` is the exclusive scan of the items of each owner, the
// total after the last, a flag, and then what work_owners made of them: the places of a table, 0 where there
// is none, and the table.

//@needs var<storage, read> work_offsets: array<u32>;

const STRIDE = 8u;  // items a place of the table
const HEAD = 3u;    // words between the offsets and the table

fn owner_of(item: u32, owners: u32) -> u32 {
    var low = 0u;
    var high = owners;
    let k = item / STRIDE;
    let table = owners + HEAD;
    if k + 1u < work_offsets[table - 1u] {
        low = work_offsets[table + k];
        high = work_offsets[table + k + 1u] + 1u;
    }
    return owner_between(item, low, high);
}

// The owner is `first` at the least and lies before `end`.
fn owner_between(item: u32, first: u32, end: u32) -> u32 {
    var low = first;
    var high = end;
    while low < high {
        let middle = (low + high) >> 1u;
        if work_offsets[middle] <= item { low = middle + 1u; } else { high = middle; }
    }
    return low - 1u;
}
