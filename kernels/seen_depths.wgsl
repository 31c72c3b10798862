// seen_depths: between which view depths the pixel centres of an image see triangles, so that slices of the
// view can be cut there (sample distribution shadow maps: Lauritzen, Salvi, Lefohn 2010). Reads the triangle
// of each pixel (`id_keys`); raises `status.head.nearest_key`, the complement of the bits of the least depth,
// and `status.head.farthest_depth`, the bits of the greatest, world units, both 0 before. What is no caster
// does not count, nor does what is seen edge-on.

//@import frame dispatch facing pixel_ray eye_edges status

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> id_keys: array<u32>;
@group(0) @binding(2) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> status: Status;

var<workgroup> wg_nearest: atomic<u32>;
var<workgroup> wg_farthest: atomic<u32>;

// View depth of what a pixel's centre sees; 0 where it sees nothing.
fn depth_at(pixel: u32) -> f32 {
    let t = ~id_keys[pixel];
    if t >= frame.triangle_count { return 0.0; }
    return max(eye_depth(corners_at(triangles[t].xyz), pixel_ray(pixel)).x, 0.0) / frame.eye.w;
}

@compute @workgroup_size(WORKGROUP)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    var depth = 0.0;
    if pixel < frame.image_size.x * frame.image_size.y { depth = depth_at(pixel); }
    if depth > 0.0 {
        atomicMax(&wg_nearest, ~bitcast<u32>(depth));
        atomicMax(&wg_farthest, bitcast<u32>(depth));
    }
    workgroupBarrier();
    if local != 0u { return; }
    let nearest = atomicLoad(&wg_nearest);
    let farthest = atomicLoad(&wg_farthest);
    // Most groups have nothing to add.
    if nearest > atomicLoad(&status.head.nearest_key) { atomicMax(&status.head.nearest_key, nearest); }
    let known = atomicLoad(&status.head.farthest_depth);
    if farthest > known { atomicMax(&status.head.farthest_depth, farthest); }
}
