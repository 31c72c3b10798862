// Roles of triangles whose fourth word says that they are told of (alpha.wgsl): the fourth word of the second
// element has the layers of lights for which one casts nothing, those for which it receives nothing, and
// whether the eye does not see it. The frame has the layers that its light is not in.

//@import frame facing
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> triangles: array<vec4<u32>>;

const ROLE_UNSEEN = 0x10000u;

fn is_in_a_layer(none: u32) -> bool { return ((none | (frame.flags >> 24u)) & 0xffu) != 0xffu; }

// Whether a triangle shadows others in the frame's light.
fn casts(word: u32) -> bool { return !is_tested(word) || is_in_a_layer(triangles[word].w); }

// Whether others shadow it there.
fn receives_any(word: u32) -> bool { return !is_tested(word) || is_in_a_layer(triangles[word].w >> 8u); }

fn is_seen(word: u32) -> bool { return !is_tested(word) || (triangles[word].w & ROLE_UNSEEN) == 0u; }
