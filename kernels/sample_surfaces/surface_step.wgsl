// The part of its work that a run of sample_surfaces does.

//@needs var<uniform> step: SurfaceStep;

struct SurfaceStep {
    round: u32,
    first_slot: u32,  // of the band
    slots: u32,       // of the band at most
    word: u32,        // of the masks; of `nearest` and `settle_crowds` alone
}

// Where what is known of sample `k` of the band's pixel `slot` is kept.
fn place(slot: u32, k: u32) -> u32 {
    return k * step.slots + slot;
}
