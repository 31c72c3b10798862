// In place of `sample_copy` on a GPU, where `samples` is the uniform itself.

override SAMPLES: u32 = 32u;

fn take_samples() {}
