// Masks of up to 128 samples, a word each 32 of them.

fn bit_of(k: u32) -> vec4<u32> {
    return select(vec4(0u), vec4(1u << (k & 31u)), vec4(k >> 5u) == vec4(0u, 1u, 2u, 3u));
}

// Of a mask that is not empty.
fn lowest_bit(mask: vec4<u32>) -> u32 {
    if mask.x != 0u { return firstTrailingBit(mask.x); }
    if mask.y != 0u { return 32u + firstTrailingBit(mask.y); }
    if mask.z != 0u { return 64u + firstTrailingBit(mask.z); }
    return 96u + firstTrailingBit(mask.w);
}

fn without_lowest(mask: vec4<u32>) -> vec4<u32> {
    return mask & ~bit_of(lowest_bit(mask));
}

fn size_of(mask: vec4<u32>) -> u32 {
    let n = countOneBits(mask);
    return n.x + n.y + n.z + n.w;
}

// The first `count` samples.
fn full_mask(count: u32) -> vec4<u32> {
    let left = vec4<i32>(i32(count)) - vec4(0, 32, 64, 96);
    let some = (vec4(1u) << (vec4<u32>(left) & vec4(31u))) - 1u;
    return select(select(some, vec4(0u), left <= vec4(0)), vec4(0xffffffffu), left >= vec4(32));
}
