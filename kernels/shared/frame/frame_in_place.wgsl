// In place of `frame_copy` on a GPU, where `frame` is the uniform itself.

fn take_frame(local: u32) {}
