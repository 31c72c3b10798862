// spsm_map: the sub-pixel shadow map (Lecocq 2013, sections 3.2 and 3.3): of each texel the closest triangle that touches it.
// Only texels that are asked for (`seen`, see seen_texels) are made.
// `raster` finds over the casters' 8 x 8 blocks of texels the least depth that any triangle's plane has over each texel
// (conservative), and lists in `won` each block in which its triangle was nearest when it came, with the texels where it was.
// `choose` goes through that list alone and finds the lowest triangle index at the least depth. `encode` writes the record of
// each texel, and says if one has a depth but no triangle: the list was too short, or `choose`, which is compiled for itself,
// rounds otherwise than `raster`. Then `again` has `raster` run once more over all blocks, and `encode` over all texels.
// A triangle that is not wholly in front of the light is left out.

//@import frame
//@import dispatch
//@import pass
//@import work_items
//@import cover_cells
//@import spsm_record
//@import seen_texels

override ENCODING: u32 = 1u;
override SPLIT: u32 = 1u;
const WORKGROUP = 64u;
const TIE = 1e-5;   // of depth
const LIFT = 2.0;   // times its own range of depths by which a triangle may count as nearer than it is

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<uniform> slopes: array<vec4<f32>, 256>;
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
@group(0) @binding(4) var<storage, read> map_points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(7) var<storage, read_write> depth_keys: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> id_keys: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read_write> upper_records: array<vec4<u32>>;
@group(0) @binding(10) var<storage, read_write> lower_records: array<vec4<u32>>;
@group(0) @binding(11) var<storage, read_write> won: array<vec4<u32>>;              // triangle, block, texels of it
@group(0) @binding(12) var<storage, read_write> seen: array<atomic<u32>>;

const PASS_AGAIN = 1u;  // the triangles at depths already found
const PASS_LAST = 2u;   // of the texels asked for last

// Where the bits of the texels begin that this run makes.
fn run_bits() -> u32 {
    return SEEN_BITS + select(0u, seen_words(), (step.index & PASS_LAST) != 0u);
}

// Least depth of the plane over the texel as a key that falls with it, whatever its sign. The plane of a triangle that is
// almost edge-on is nearest: it is at the border of what it belongs to, and the texel shall hold the border. LIFT keeps what
// is far behind from coming before what hides it.
fn key_at(shape: Cover, centre: vec2<f32>) -> u32 {
    return key_of(least_at(shape, centre));
}

fn least_at(shape: Cover, centre: vec2<f32>) -> f32 {
    let least = dot(shape.depth, vec3(centre, 1.0)) - shape.half_range;
    let first = shape.nearest - LIFT * (shape.farthest - shape.nearest);
    return select(max(least, first), first, shape.thin);
}

fn key_of(depth: f32) -> u32 {
    let bits = bitcast<u32>(depth);
    return select(bits, ~(bits | 0x80000000u), (bits >> 31u) == 0u);
}

@compute @workgroup_size(WORKGROUP)
fn raster(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= work_offsets[frame.triangle_count] { return; }
    let t = owner_of(item, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[t]);
    let shape = cover_triangle_by(
        map_points[triangles[3u * t]], map_points[triangles[3u * t + 1u]], map_points[triangles[3u * t + 2u]], place_noise());
    if !shape.in_front { return; }
    let second = (step.index & PASS_AGAIN) != 0u;
    let corner = block.low & vec2(~7u);
    let word = run_bits() + seen_place(corner).x;
    let asked = vec2(atomicLoad(&seen[word]), atomicLoad(&seen[word + 1u]));
    var left = cover_cells(shape, block, rows_of(asked)) & asked;
    // Where it may be nearest of all that have come; another of the same depth may have a lower index. The keys are raised in a
    // loop of their own, of few turns: its depths may be rounded otherwise, by far less than TIE.
    var bits = vec2(0u);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let at = corner + place;
        let centre = vec2<f32>(at) + 0.5;
        if !covers(shape, centre) { continue; }
        let held = atomicLoad(&depth_keys[at.y * frame.map_size + at.x]);
        if held <= key_of(least_at(shape, centre) - TIE) { add_texel(&bits, place); }
    }
    left = bits;
    while any(left != vec2(0u)) {
        let at = corner + take_texel(&left);
        let key = key_at(shape, vec2<f32>(at) + 0.5);
        let texel = at.y * frame.map_size + at.x;
        if !second {
            atomicMax(&depth_keys[texel], key);
        } else if atomicLoad(&depth_keys[texel]) == key {
            atomicMax(&id_keys[texel], ~t);
        }
    }
    if !second && any(bits != vec2(0u)) {
        let slot = atomicAdd(&seen[SEEN_WON], 1u);
        if slot < arrayLength(&won) {
            won[slot] = vec4(t, (block.low.x >> BLOCK_SHIFT) | ((block.low.y >> BLOCK_SHIFT) << 16u), bits);
        }
    }
}

// The blocks won in this run, if all are listed.
@compute @workgroup_size(1)
fn divide() {
    let blocks = atomicLoad(&seen[SEEN_WON]);
    let first = atomicLoad(&seen[SEEN_BASE + 1u]);
    atomicStore(&seen[SEEN_BASE], first);
    atomicStore(&seen[SEEN_BASE + 1u], blocks);
    atomicStore(&seen[SEEN_CHOSEN], select(0u, blocks - first, blocks <= arrayLength(&won)));
    atomicStore(&seen[SEEN_AGAIN], 0u);
}

// All blocks and all texels, if any texel lacks its triangle.
@compute @workgroup_size(1)
fn again() {
    if atomicLoad(&seen[SEEN_LOST]) == 0u {
        atomicStore(&seen[SEEN_CHOSEN], 0u);
        return;
    }
    atomicStore(&seen[SEEN_CHOSEN], seen_words());
    atomicStore(&seen[SEEN_AGAIN], work_offsets[frame.triangle_count]);
}

@compute @workgroup_size(WORKGROUP)
fn choose(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let item = flat_invocation(group, groups, WORKGROUP, local);
    if item >= atomicLoad(&seen[SEEN_CHOSEN]) { return; }
    let block = won[atomicLoad(&seen[SEEN_BASE]) + item];
    let t = block.x;
    let corner = vec2(block.y & 0xffffu, block.y >> 16u) << vec2(BLOCK_SHIFT);
    let shape = cover_triangle_by(
        map_points[triangles[3u * t]], map_points[triangles[3u * t + 1u]], map_points[triangles[3u * t + 2u]], place_noise());
    var left = block.zw;
    var nearest = vec2(0u);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let at = corner + place;
        let texel = at.y * frame.map_size + at.x;
        if atomicLoad(&depth_keys[texel]) == key_at(shape, vec2<f32>(at) + 0.5) { add_texel(&nearest, place); }
    }
    while any(nearest != vec2(0u)) {
        let at = corner + take_texel(&nearest);
        atomicMax(&id_keys[at.y * frame.map_size + at.x], ~t);
    }
}

fn store(texel: u32, record: vec4<u32>) {
    let upper = frame.map_size * upper_rows();
    if SPLIT == 0u || texel < upper { upper_records[texel] = record; } else { lower_records[texel - upper] = record; }
}

// The record of a texel.
fn made(texel: u32, centre: vec2<f32>) -> vec4<u32> {
    let t = ~atomicLoad(&id_keys[texel]);
    if t >= frame.triangle_count {
        if atomicLoad(&depth_keys[texel]) != 0u { atomicStore(&seen[SEEN_LOST], 1u); }
        return vec4(0u, 0u, 0u, EMPTY_WORD);
    }
    // Vertices in order of index, so that an edge has one code in both of its triangles.
    var i = vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
    if i.x > i.y { i = i.yxz; }
    if i.y > i.z { i = i.xzy; }
    if i.x > i.y { i = i.yxz; }
    let shift = vec3(centre, 0.0);
    return encode_record(Corners(map_points[i.x].xyz - shift, map_points[i.y].xyz - shift, map_points[i.z].xyz - shift), centre);
}

// One invocation the texels of a word of bits: 8 x 4.
@compute @workgroup_size(WORKGROUP)
fn encode(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let word = flat_invocation(group, groups, WORKGROUP, local);
    if word >= seen_words() { return; }
    let block = divided(word >> 1u, (frame.map_size + 7u) >> 3u);
    let corner = vec2(8u * block.y, 8u * block.x + 4u * (word & 1u));
    for (var left = atomicLoad(&seen[run_bits() + word]); left != 0u; left &= left - 1u) {
        let bit = firstTrailingBit(left);
        let at = corner + vec2(bit & 7u, bit >> 3u);
        if any(at >= vec2(frame.map_size)) { continue; }
        let texel = at.y * frame.map_size + at.x;
        store(texel, made(texel, vec2<f32>(at) + 0.5));
    }
}
