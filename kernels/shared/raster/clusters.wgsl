// Which elements (triangles, edges, vertices) a workgroup takes: those of a cluster that is kept, 64 with
// numbers in a row, or of the cluster of its own number where all are. `kept_clusters` says of each of the
// three parts how many clusters are kept, then where they begin in the list behind the head, then of the
// first two how many elements they hold.

//@needs var<storage, read> kept_clusters: array<u32>;

const CLUSTER_SIZE = 64u;
const PART_TRIANGLES = 0u;
const PART_EDGES = 1u;
const PART_VERTICES = 2u;
const PARTS = 3u;
const KEPT_HEAD = 8u;              // words before the list
const ALL_CLUSTERS = 0xffffffffu;  // as the first word: there is no list

// An element and its slot among those that are taken; the number is that of none beyond the last.
struct Member { slot: u32, number: u32 }

fn first_kept(part: u32) -> u32 {
    return KEPT_HEAD + kept_clusters[PARTS + part];
}

fn member_of(part: u32, group: u32, local: u32) -> Member {
    let slot = CLUSTER_SIZE * group + local;
    if kept_clusters[0] == ALL_CLUSTERS { return Member(slot, slot); }
    if group >= kept_clusters[part] { return Member(slot, 0xffffffffu); }
    return Member(slot, CLUSTER_SIZE * kept_clusters[first_kept(part) + group] + local);
}
