// pixel_views: which of several views of the light each pixel asks, for methods that ask one.
// `choose`: that of `chosen_view`; a pixel without a lit side asks the first. `keep`: the triangle of each
// pixel that asks view `step.index`, and 0, as where nothing is seen, for all others. `take`: what a method
// left of those pixels, STRIDE words each, behind SKIP words a pixel.

//@import frame dispatch pass facing receiver view_choice

override REACH: f32 = 1.0;   // texels
override STRIDE: u32 = 1u;
override SKIP: u32 = 0u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> step: Pass;
@group(0) @binding(3) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(4) var<storage, read> id_keys: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> view_of: array<u32>;
@group(0) @binding(8) var<storage, read_write> view_keys: array<u32>;
@group(0) @binding(9) var<storage, read> left: array<u32>;
@group(0) @binding(10) var<storage, read_write> taken: array<u32>;

fn pixel_count() -> u32 { return frame.image_size.x * frame.image_size.y; }

@compute @workgroup_size(WORKGROUP)
fn choose(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= pixel_count() { return; }
    let r = receiver_of(pixel);
    var chosen = 0u;
    if r.seen == SEEN_OPEN { chosen = chosen_view(r, pixel); }
    view_of[pixel] = chosen;
}

@compute @workgroup_size(WORKGROUP)
fn keep(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= pixel_count() { return; }
    view_keys[pixel] = select(0u, id_keys[pixel], view_of[pixel] == step.index);
}

@compute @workgroup_size(WORKGROUP)
fn take(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let word = flat_invocation(group, groups, WORKGROUP, local);
    if word >= STRIDE * pixel_count() { return; }
    if view_of[word / STRIDE] == step.index { taken[word] = left[SKIP * pixel_count() + word]; }
}
