// As keys, in one run: both words of a cell are one key of 64 bits, the depth above the triangle.

alias Key = u64;

fn held_depth(cell: u32) -> u32 { return u32(atomicLoad(&keys[cell]) >> 32u); }

fn held_triangle(cell: u32) -> u32 { return u32(atomicLoad(&keys[cell])); }

fn raise(cell: u32, depth_key: u32, triangle: u32, second: bool) {
    atomicMax(&keys[cell], (u64(depth_key) << 32u) | u64(~triangle));
}
