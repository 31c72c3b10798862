// camera_visibility: the nearest triangle at every pixel centre, by compute rasterization of 8 x 8 blocks.
// `raster` raises the keys, with atomics, in two runs: pass 0 finds a depth that the nearest surely does not lie behind, pass 1 the
// lowest triangle that may lie before it, and marks in `doubts` the pixels where there are several (a bit each, two words for each 8 x 8
// pixels, behind the first word, which is then how many blocks there are: a dispatch over them has nothing to do where no pixel is in doubt). For those `settle`
// finds the nearest with 46 bits, in two runs: pass 0 how near it is (`id_keys`), pass 1 the lowest triangle there. `take` copies it.
// Reads the blocks of each triangle (`work_offsets`, `camera_rects`). Writes `keys` (of a pixel complement of the triangle, its upper bit
// 1 only if `settle` chose it; and complement of the bits of the view depth; 0 where nothing is seen) and the complement of the triangle
// as `id_keys`. All three must be 0 before.

//@import frame
//@import dispatch
//@import pass
//@import pixel_ray
//@import facing
//@import double_float
//@import vertex
//@import facing_46
//@import eye_order_46
//@import camera_raster
//@import block_bits

const WORKGROUP = 64u;
const SETTLED = 0x80000000u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> keys: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> id_keys: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> doubts: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read> positions: array<vec3<f32>>;

//@import frame_copy

// The first of the two words of a pixel's 8 x 8 block in `doubts`.
fn doubt_word(at: vec2<u32>) -> u32 {
    let across = (frame.image_size.x + BLOCK - 1u) >> BLOCK_SHIFT;
    return 1u + 2u * ((at.y >> BLOCK_SHIFT) * across + (at.x >> BLOCK_SHIFT));
}

@compute @workgroup_size(WORKGROUP)
fn raster(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    take_frame(local);
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let seen = seen_in(item);
    let named = ~seen.t & ~SETTLED;
    for (var y = seen.block.low.y; y <= seen.block.high.y; y++) {
        let cells = pixels_of_row(seen, y);
        for (var x = cells.x; x <= cells.y; x++) {
            let pixel = y * frame.image_size.x + x;
            let key = keys_at(seen, x, y);
            if key.x == 0u || atomicLoad(&keys[2u * pixel + 1u]) > key.x { continue; }
            if step.index == 0u {
                atomicMax(&keys[2u * pixel + 1u], key.y);
            } else {
                // A triangle that may lie nearer than the near distance is in doubt by itself.
                var other = ~named;
                if key.y != 0u { other = atomicMax(&keys[2u * pixel], named); }
                if other != 0u && other != named {
                    atomicOr(&doubts[doubt_word(vec2(x, y)) + ((y >> 2u) & 1u)], 1u << ((y & 3u) * 8u + (x & 7u)));
                    atomicStore(&doubts[0], work_offsets[frame.triangle_count]);
                }
            }
        }
    }
}

// How much nearer the triangle's plane is along the ray than `depth`, as a key that grows with that; not 0. Steps of 2^-40 of the
// depth: what 46 bits make of planes that meet there is within one.
fn key_46(i: vec3<u32>, ray: vec3<f32>, depth: f32) -> u32 {
    let n = full_normal(i);
    let over = df_scale(df3_along(n, ray), depth);
    let rest = df_add_fast(over, -df3_dot(n, full_point_of(i.x)));
    let nearer = select(-3.0e38, round(rest.x / over.x * 1.0995116e12), over.x != 0.0);
    let bits = bitcast<u32>(nearer);
    return bits ^ select(0x80000000u, 0xffffffffu, (bits >> 31u) != 0u);
}

@compute @workgroup_size(WORKGROUP)
fn settle(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    take_frame(local);
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let t = owner_of(item, frame.triangle_count);
    let block = block_of(camera_rects[t], item - work_offsets[t]);
    let word = doubt_word(block.low);
    let doubted = vec2(atomicLoad(&doubts[word]), atomicLoad(&doubts[word + 1u]));
    // Few blocks have pixels in doubt: a loop that the others do not enter.
    for (var some = any(doubted != vec2(0u)); some; some = false) { settle_in(seen_of(t, block), doubted); }
}

// Looks at the pixels of a block that are in doubt.
fn settle_in(seen: Seen, doubted: vec2<u32>) {
    let corner = seen.block.low & vec2(~7u);
    var left = doubted;
    var found = vec2(0u);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let at = corner + place;
        if any(at < seen.block.low) || any(at > seen.block.high) { continue; }
        let key = keys_at(seen, at.x, at.y);
        if key.x == 0u || atomicLoad(&keys[2u * (at.y * frame.image_size.x + at.x) + 1u]) > key.x { continue; }
        add_texel(&found, place);
    }
    while any(found != vec2(0u)) {
        let at = corner + take_texel(&found);
        let pixel = at.y * frame.image_size.x + at.x;
        let least = atomicLoad(&keys[2u * pixel + 1u]);
        let i = triangles[seen.t];
        let ray = pixel_ray(pixel);
        if keys_at(seen, at.x, at.y).y == 0u && !is_beyond_near_46(i, ray) { continue; }
        let nearer = key_46(i, ray, select(bitcast<f32>(~least), frame.forward.w, least == 0u));
        if step.index == 0u {
            atomicMax(&id_keys[pixel], nearer);
        } else if atomicLoad(&id_keys[pixel]) == nearer {
            atomicMax(&keys[2u * pixel], ~seen.t);
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn take(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    take_frame(local);
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let key = atomicLoad(&keys[2u * pixel]);
    atomicStore(&id_keys[pixel], select(key | SETTLED, 0u, key == 0u));
    // Of what is seen only where 46 bits tell so no depth is known but this.
    if key != 0u && atomicLoad(&keys[2u * pixel + 1u]) == 0u { atomicStore(&keys[2u * pixel + 1u], ~bitcast<u32>(frame.forward.w)); }
}
