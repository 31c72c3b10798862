// A copy of the frame. Every entry point begins with take_frame, before the flow diverges: after that, vector
// machines read a uniform lane by lane.

//@import frame
//@needs var<uniform> frame_given: Frame;

var<private> frame: Frame;

// `local` does nothing to the flags but hide where they come from: for values of uniforms that conditions ask
// for, llvmpipe compiles the kernel anew at every dispatch.
fn take_frame(local: u32) {
    frame = frame_given;
    frame.flags ^= local & frame.seal;
}
