// Where the samples of the word `step.word` lie in a pixel.

//@import surface_step
//@needs override WORDS: u32;
//@needs var<uniform> samples_given: array<vec4<f32>, 64>;
//@needs var<uniform> step: SurfaceStep;

// Offsets of the word's samples, two each, taken before the flow diverges: elsewhere vector machines read a
// uniform lane by lane.
var<private> offsets: array<vec4<f32>, 16>;

fn take_offsets() {
    // Of one word the place is known to compilers.
    let at = select(16u * step.word, 0u, WORDS == 1u);
    offsets[0] = samples_given[at + 0u];
    offsets[1] = samples_given[at + 1u];
    offsets[2] = samples_given[at + 2u];
    offsets[3] = samples_given[at + 3u];
    offsets[4] = samples_given[at + 4u];
    offsets[5] = samples_given[at + 5u];
    offsets[6] = samples_given[at + 6u];
    offsets[7] = samples_given[at + 7u];
    offsets[8] = samples_given[at + 8u];
    offsets[9] = samples_given[at + 9u];
    offsets[10] = samples_given[at + 10u];
    offsets[11] = samples_given[at + 11u];
    offsets[12] = samples_given[at + 12u];
    offsets[13] = samples_given[at + 13u];
    offsets[14] = samples_given[at + 14u];
    offsets[15] = samples_given[at + 15u];
}
