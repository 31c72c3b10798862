// Doubts of shadow rays that single precision left open, as they lie in `work`.

//@import frame
//@needs override WORDS: u32;
//@needs const WORK_HEAD: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read_write> work: array<atomic<u32>>;

// First word of the doubts, and how many there is room for.
fn doubts() -> vec2<u32> {
    let first = WORK_HEAD + WORDS * frame.facets_total;
    return vec2(first, (arrayLength(&work) - first) / 2u);
}

// Notes a triangle in doubt of a sample; false if there is no room.
fn note(sample: u32, k: u32) -> bool {
    let n = atomicAdd(&work[3], 1u);
    let room = doubts();
    if n >= room.y { return false; }
    atomicStore(&work[room.x + 2u * n], sample);
    atomicStore(&work[room.x + 2u * n + 1u], k);
    return true;
}
