// Appending as many pairs as there are texels to a list whose number stands in `appended`.

//@needs var<storage, read_write> appended: array<atomic<u32>>;

// Where as many pairs as there are texels may be written. Says so if there are more than 2^32 in all.
fn room_for(texels: vec2<u32>) -> u32 {
    let count = countOneBits(texels.x) + countOneBits(texels.y);
    if count == 0u { return 0u; }
    let place = atomicAdd(&appended[0], count);
    if place + count < place { atomicStore(&appended[1], 1u); }
    return place;
}
