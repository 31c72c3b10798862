// The view direction in a world that a homography maps; 0 in one that none does.

//@import frame
//@needs var<uniform> frame: Frame;

fn mapped_ahead() -> vec3<f32> {
    return select(vec3(0.0), frame.forward.xyz, (frame.flags & FLAG_MAPPED) != 0u);
}
