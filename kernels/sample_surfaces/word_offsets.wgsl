// Where the samples of the word `step.word` lie in a pixel.

//@import surface_step
//@needs override WORDS: u32;
//@needs var<uniform> samples: array<vec4<f32>, 64>;
//@needs var<uniform> step: SurfaceStep;

// Offsets of the word's samples, two each, taken before the flow diverges: elsewhere vector machines read a
// uniform lane by lane.
var<private> offsets: array<vec4<f32>, 16>;

fn take_offsets() {
    // Of one word the place is known to compilers.
    let at = select(16u * step.word, 0u, WORDS == 1u);
    offsets[0] = samples[at + 0u];
    offsets[1] = samples[at + 1u];
    offsets[2] = samples[at + 2u];
    offsets[3] = samples[at + 3u];
    offsets[4] = samples[at + 4u];
    offsets[5] = samples[at + 5u];
    offsets[6] = samples[at + 6u];
    offsets[7] = samples[at + 7u];
    offsets[8] = samples[at + 8u];
    offsets[9] = samples[at + 9u];
    offsets[10] = samples[at + 10u];
    offsets[11] = samples[at + 11u];
    offsets[12] = samples[at + 12u];
    offsets[13] = samples[at + 13u];
    offsets[14] = samples[at + 14u];
    offsets[15] = samples[at + 15u];
}
