// pixel_views: which of several views of the light each pixel asks, for methods that ask one.
// `choose`: the first view that holds the pixel, that is its middle and its corners on the plane of its
// triangle, REACH texels within its map; where none does, that which holds most of it: in which the outermost
// of these points lies least far out. What is not in front of a view lies outside it by more than anything. A
// pixel without a lit side asks the first. `keep`: the triangle of each pixel that asks view `step.index`,
// and 0, as where nothing is seen, for all others. `take`: what a method left of those pixels, STRIDE words
// each, behind SKIP words a pixel.

//@import frame dispatch pass facing receiver

struct LightViews {
    rows: array<vec4<f32>, 24>,  // of each view: to texel x and y, times the third; least divisor in front
    count: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

override REACH: f32 = 1.0;   // texels
override STRIDE: u32 = 1u;
override SKIP: u32 = 0u;
const WORKGROUP = 64u;
const OUTSIDE = -3.0e38;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> views: LightViews;
@group(0) @binding(2) var<uniform> step: Pass;
@group(0) @binding(3) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(4) var<storage, read> id_keys: array<u32>;
@group(0) @binding(5) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(6) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> view_of: array<u32>;
@group(0) @binding(8) var<storage, read_write> view_keys: array<u32>;
@group(0) @binding(9) var<storage, read> left: array<u32>;
@group(0) @binding(10) var<storage, read_write> taken: array<u32>;

fn pixel_count() -> u32 { return frame.image_size.x * frame.image_size.y; }

// How far within the map of a view a point lies, texels; below 0 outside.
fn inset(view: u32, point: vec4<f32>) -> f32 {
    let k = 4u * view;
    let p = vec4(point.xyz, 1.0);
    let w = dot(views.rows[k + 2u], p);
    if !(w > views.rows[k + 3u].x) { return OUTSIDE; }
    let at = vec2(dot(views.rows[k], p), dot(views.rows[k + 1u], p)) / w;
    let within = min(at, vec2(f32(frame.map_size)) - at);
    return max(min(within.x, within.y), OUTSIDE);
}

// The same of a pixel's corner, which says nothing where its ray misses the plane.
fn corner_inset(view: u32, point: vec4<f32>) -> f32 {
    return select(inset(view, point), -OUTSIDE, point.w == 0.0);
}

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
    if r.seen == SEEN_OPEN {
        let middle = plane_point(r, pixel_ray(pixel));
        let a = plane_point(r, ray_at(pixel, vec2(-0.5)));
        let b = plane_point(r, ray_at(pixel, vec2(0.5, -0.5)));
        let c = plane_point(r, ray_at(pixel, vec2(0.5)));
        let d = plane_point(r, ray_at(pixel, vec2(-0.5, 0.5)));
        var best = OUTSIDE;
        for (var view = 0u; view < views.count && best < REACH; view++) {
            let sides = min(min(corner_inset(view, a), corner_inset(view, b)),
                min(corner_inset(view, c), corner_inset(view, d)));
            let least = min(inset(view, middle), sides);
            if least > best {
                best = least;
                chosen = view;
            }
        }
    }
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
