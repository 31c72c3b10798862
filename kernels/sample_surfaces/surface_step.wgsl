// The part of its work that a run of sample_surfaces does.

struct SurfaceStep {
    round: u32,
    word: u32,  // of the masks; of `nearest` and `settle` alone
}
