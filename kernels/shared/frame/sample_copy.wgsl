// A copy of the samples' offsets. Entry points that ask for `samples` begin with take_samples.

//@needs override WORDS: u32;
//@needs var<uniform> samples_given: array<vec4<f32>, 64>;

override SAMPLES: u32 = 32u;  // samples a pixel; code for more of a word is left out

// A copy of `samples_given`, made before the flow diverges and never asked for by a variable: elsewhere
// vector machines read a uniform lane by lane.
var<private> samples: array<vec4<f32>, 64>;

fn take_word(word: u32) {
    let k = word << 4u;
    samples[k] = samples_given[k];
    samples[k + 1u] = samples_given[k + 1u];
    samples[k + 2u] = samples_given[k + 2u];
    samples[k + 3u] = samples_given[k + 3u];
    samples[k + 4u] = samples_given[k + 4u];
    samples[k + 5u] = samples_given[k + 5u];
    samples[k + 6u] = samples_given[k + 6u];
    samples[k + 7u] = samples_given[k + 7u];
    samples[k + 8u] = samples_given[k + 8u];
    samples[k + 9u] = samples_given[k + 9u];
    samples[k + 10u] = samples_given[k + 10u];
    samples[k + 11u] = samples_given[k + 11u];
    samples[k + 12u] = samples_given[k + 12u];
    samples[k + 13u] = samples_given[k + 13u];
    samples[k + 14u] = samples_given[k + 14u];
    samples[k + 15u] = samples_given[k + 15u];
}

fn take_samples() {
    take_word(0u);
    if WORDS > 1u { take_word(1u); }
    if WORDS > 2u {
        take_word(2u);
        take_word(3u);
    }
}
