// Vertices as they were given, relative to the eye and scaled.

//@import frame
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> positions: array<vec3<f32>>;

fn world_of(v: u32) -> vec3<f32> {
    return positions[v];
}

fn to_eye(world: vec3<f32>) -> vec3<f32> {
    return ((world - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w;
}

fn point_of(v: u32) -> vec3<f32> {
    return to_eye(world_of(v));
}

// From vertex i to vertex j, rounded once: a difference of points would carry their roundings.
fn edge_of(i: u32, j: u32) -> vec3<f32> {
    return (world_of(j) - world_of(i)) * frame.eye.w;
}
