// Which owner a work item belongs to: `work_offsets` is the exclusive scan of the items of each place of
// a list, the total after the last, a flag, and then what work_owners made of them: where in it a list
// of clusters begins (0: there is none), how many slots are in use (0: all), the places of a table, 0
// where there is none, and the table. Without clusters the slot of an owner is its number, else the
// owners of each cluster of the list follow each other.

//@needs var<storage, read> work_offsets: array<u32>;

const STRIDE = 8u;    // items a place of the table
const HEAD = 5u;      // words between the offsets and the table
const OWNERS = 64u;   // of a cluster, with numbers in a row

// The slot of the owner.
fn slot_of(item: u32, owners: u32) -> u32 {
    var low = 0u;
    var high = owners;
    let k = item / STRIDE;
    let table = owners + HEAD;
    if k + 1u < work_offsets[table - 1u] {
        low = work_offsets[table + k];
        high = work_offsets[table + k + 1u] + 1u;
    } else if work_offsets[table - 2u] != 0u {
        high = work_offsets[table - 2u];
    }
    return slot_between(item, low, high);
}

// The slot is `first` at the least and lies before `end`.
fn slot_between(item: u32, first: u32, end: u32) -> u32 {
    var low = first;
    var high = end;
    while low < high {
        let middle = (low + high) >> 1u;
        if work_offsets[middle] <= item { low = middle + 1u; } else { high = middle; }
    }
    return low - 1u;
}

// The number of the owner in a slot.
fn owner_in(slot: u32, owners: u32) -> u32 {
    let list = work_offsets[owners + 2u];
    if list == 0u { return slot; }
    return OWNERS * work_offsets[list + slot / OWNERS] + slot % OWNERS;
}
