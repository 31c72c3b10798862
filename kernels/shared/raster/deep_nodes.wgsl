// Nodes of a visibility function over depth: a depth in 24 bits above a share of light in 8.

// Places of depth: from 0 to 4, which is none.
const PLACES = 4194304.0;      // of depth 1: 2^22
const NO_PLACE = 0xffffffu;
const WHOLE = 128u;            // all light

// The place of a depth, away from the light: no depth comes before itself.
fn deep_place(depth: f32) -> u32 {
    return min(u32(ceil(clamp(depth, 0.0, 4.0) * PLACES)), NO_PLACE);
}

// Light at a place that is behind node `a` and not behind node `b`, of WHOLE.
fn light_between(a: u32, b: u32, place: u32) -> f32 {
    let part = f32(place - (a >> 8u)) / f32(max(b >> 8u, (a >> 8u) + 1u) - (a >> 8u));
    let from_a = f32(a & 0xffu);
    return from_a + (f32(b & 0xffu) - from_a) * part;
}
