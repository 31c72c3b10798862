// The nearest triangle of each cell, as in keys, for 64-bit atomics: one key in one run, the depth above the
// triangle's complement.

@group(0) @binding(7) var<storage, read_write> keys: array<atomic<u64>>;

fn held_depth(cell: u32) -> u32 { return u32(atomicLoad(&keys[cell]) >> 32u); }

fn held_triangle(cell: u32) -> u32 { return u32(atomicLoad(&keys[cell])); }

fn raise(cell: u32, depth_key: u32, triangle: u32) {
    atomicMax(&keys[cell], (u64(depth_key) << 32u) | u64(~triangle));
}
