// The nearest triangle of each cell (texel or pixel) in the array `keys`: of a cell two words, complement of
// the triangle and a key that falls with its depth, both 0 where there is none. Found in two runs: the first
// finds the depth, the second the lowest triangle at that depth. Where a device has 64-bit atomics keys_64
// stands in its place.

@group(0) @binding(7) var<storage, read_write> keys: array<atomic<u32>>;

fn held_depth(cell: u32) -> u32 { return atomicLoad(&keys[2u * cell + 1u]); }

fn held_triangle(cell: u32) -> u32 { return atomicLoad(&keys[2u * cell]); }

// Of callers that have looked whether the cell holds a depth farther away, or as far.
fn raise(cell: u32, depth_key: u32, triangle: u32, second: bool) {
    if !second {
        atomicMax(&keys[2u * cell + 1u], depth_key);
    } else if held_depth(cell) == depth_key {
        atomicMax(&keys[2u * cell], ~triangle);
    }
}
