// camera_visibility: the nearest triangle at every pixel centre, by compute rasterization of 8 x 8 blocks.
// `raster` raises the keys, with atomics, in two runs: pass 0 finds a depth that the nearest surely does not
// lie behind, pass 1 the lowest triangle that may lie before it. Where there are several, it marks the pixel
// in `id_keys` and lists all of them in `doubts`, and `settle` finds the nearest with 46 bits, in three runs:
// pass 0 brings in the bounds of what may lie nearer than the near distance and does not, pass 1 finds how
// near the nearest is (`id_keys`), pass 2 the lowest triangle there. If the list has not the room,
// `settle_all` does the same through all blocks; `ask` tells which of the two has something to do. `take`
// copies what was found. Reads the blocks of each triangle (`work_offsets`, `camera_rects`). Writes `keys`
// (of a pixel complement of the triangle, its upper bit 1 only if `settle` chose it; and complement of the
// bits of the view depth; 0 where nothing is seen) and the complement of the triangle as `id_keys`. Both must
// be 0 before, and so must the counts in `doubts`.

//@import frame dispatch pass pixel_ray facing double_float vertex facing_46 eye_order_46 camera_raster
//@import alpha mapped_view

const WORKGROUP = 64u;
const SETTLED = 0x80000000u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> keys: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> id_keys: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> doubts: Doubts;
@group(0) @binding(9) var<storage, read> positions: array<vec3<f32>>;

//@import frame_copy

// Pixels and triangles that single precision leaves open.
struct Doubts {
    needed: atomic<u32>,
    listed: u32,  // to settle by the list, or
    blocks: u32,  // by all blocks
    pad: u32,
    list: array<vec2<u32>>,
}

fn room() -> u32 { return frame.image_size.x * frame.image_size.y / 4u + 64u; }

fn note(pixel: u32, t: u32) {
    let at = atomicAdd(&doubts.needed, 1u);
    if at < room() { doubts.list[at] = vec2(pixel, t); }
}

@compute @workgroup_size(WORKGROUP)
fn raster(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let seen = seen_in(item);
    let named = ~seen.t & ~SETTLED;
    for (var y = seen.block.low.y; y <= seen.block.high.y; y++) {
        let cells = pixels_of_row(seen, y);
        for (var x = cells.x; x <= cells.y; x++) {
            let pixel = y * frame.image_size.x + x;
            let at = centre_at(x, y);
            if !covers_centre(seen, at) || is_hole(seen, at) { continue; }
            let key = keys_at(seen, at);
            if key.x == 0u || atomicLoad(&keys[2u * pixel + 1u]) > key.x { continue; }
            if step.index == 0u {
                if key.z == 0u { atomicMax(&keys[2u * pixel + 1u], key.y); }
            } else {
                let other = atomicMax(&keys[2u * pixel], named);
                // A triangle that may lie nearer than the near distance is in doubt by itself. Of several
                // each comes after another: all are noted.
                if key.z == 1u || other != 0u {
                    atomicStore(&id_keys[pixel], 1u);
                    note(pixel, seen.t);
                    if other != 0u { note(pixel, ~(other | SETTLED)); }
                }
            }
        }
    }
}

// Whether an alpha-tested triangle has a hole at a pixel's centre.
fn is_hole(seen: Seen, at: vec3<f32>) -> bool {
    if ALPHA == 0u { return false; }
    let i = triangles[seen.t];
    if !is_tested(i.w) { return false; }
    let ray = frame.ray_corner.xyz + at.y * frame.ray_x.xyz + at.z * frame.ray_y.xyz;
    let card = Card(points[i.x].xyz, points[i.y].xyz, points[i.z].xyz, mapped_ahead());
    return !is_solid(i.w, card, vec3(0.0), ray);
}

// Takes a triangle in at a pixel that it covers and that is in doubt.
fn settle_at(seen: Seen, at: vec2<u32>) {
    let pixel = at.y * frame.image_size.x + at.x;
    let key = keys_at(seen, centre_at(at.x, at.y));
    let least = atomicLoad(&keys[2u * pixel + 1u]);
    if key.x == 0u || least > key.x { return; }
    let i = triangles[seen.t].xyz;
    let ray = pixel_ray(pixel);
    if key.z == 1u && !is_beyond_near_46(i, ray) { return; }
    if step.index == 0u {
        if key.z == 1u { atomicMax(&keys[2u * pixel + 1u], key.y); }
        return;
    }
    let nearer = key_46(i, ray, bitcast<f32>(~least));
    if step.index == 1u {
        atomicMax(&id_keys[pixel], nearer);
    } else if atomicLoad(&id_keys[pixel]) == nearer {
        atomicMax(&keys[2u * pixel], ~seen.t);
    }
}

@compute @workgroup_size(1)
fn ask() {
    take_frame(0u);
    let needed = atomicLoad(&doubts.needed);
    let fits = needed <= room();
    doubts.listed = select(0u, needed, fits);
    doubts.blocks = select(work_offsets[frame.triangle_count], 0u, fits);
}

@compute @workgroup_size(WORKGROUP)
fn settle(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let k = flat_invocation(group, groups, WORKGROUP, local);
    if k >= doubts.listed { return; }
    let noted = doubts.list[k];
    let at = vec2(noted.x % frame.image_size.x, noted.x / frame.image_size.x);
    settle_at(seen_of(noted.y, Rect(at, at)), at);
}

@compute @workgroup_size(WORKGROUP)
fn settle_all(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= doubts.blocks { return; }
    let seen = seen_in(item);
    for (var y = seen.block.low.y; y <= seen.block.high.y; y++) {
        let cells = pixels_of_row(seen, y);
        for (var x = cells.x; x <= cells.y; x++) {
            let doubted = atomicLoad(&id_keys[y * frame.image_size.x + x]) != 0u;
            let at = centre_at(x, y);
            if doubted && covers_centre(seen, at) && !is_hole(seen, at) { settle_at(seen, vec2(x, y)); }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn take(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let key = atomicLoad(&keys[2u * pixel]);
    // Of what may lie nearer than the near distance nothing lies beyond it, and there is nothing else.
    let nothing = key == 0u || ((key & SETTLED) == 0u && atomicLoad(&keys[2u * pixel + 1u]) == 0u);
    if nothing { atomicStore(&keys[2u * pixel], 0u); }
    atomicStore(&id_keys[pixel], select(key | SETTLED, 0u, nothing));
}
