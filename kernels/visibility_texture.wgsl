// visibility_texture: writes the visibility of every pixel into a texture of the application's.
// Reads `visibility` (row by row from the top). `store` writes `target_texture` (r32float, a texel a pixel),
// of a strip of rows those that are its own. `pack` writes `packed`, rows of `rows.words` words that a copy
// takes into a texture of BITS bits a texel; `pack_channel` a byte of each word, the others stay.
//
// Where the last complete picture is to stand until the next, `judge` looks at what a frame left in its
// counters (`status`, `faults`) and sets `verdict` if anything is missing; it is cleared before. Then `hold`
// copies what the frame made (`latest`) to `held` if nothing is: of the picture as of any words.
//
// Of several points of one light `add` sums the visibility of each (`share`) in `sums`; that of the last
// becomes the mean of all.

//@import frame dispatch status divide strip

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> visibility: array<f32>;
@group(0) @binding(2) var target_texture: texture_storage_2d<r32float, write>;

struct Lists {
    bands: u32,          // of all views
    most_at_place: u32,  // triangles over a place of the map
    most_at_pixel: u32,  // triangles over a pixel
    pad_0: u32,
}

@group(0) @binding(3) var<uniform> lists: Lists;
@group(0) @binding(4) var<storage, read_write> status: Status;
@group(0) @binding(5) var<storage, read> faults: array<u32>;
@group(0) @binding(6) var<storage, read_write> verdict: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read> latest: array<u32>;
@group(0) @binding(8) var<storage, read_write> held: array<u32>;

struct PackedRows {
    words: u32,    // of a row
    channel: u32,
    pad_0: u32,
    pad_1: u32,
}

@group(0) @binding(9) var<uniform> rows: PackedRows;
@group(0) @binding(10) var<storage, read_write> packed: array<u32>;

struct PointShare {
    offset: u32,  // of the first pixel, in `sums`
    point: u32,
    points: u32,
    pad_0: u32,
}

@group(0) @binding(11) var<uniform> part: PointShare;
@group(0) @binding(12) var<storage, read_write> share: array<f32>;
@group(0) @binding(13) var<storage, read_write> sums: array<f32>;

override BITS: u32 = 32u;

// Whether a list was too short.
fn is_short(need: Need, capacity: u32) -> bool { return need.items > capacity || need.over != 0u; }

fn is_band_short(band: u32) -> bool {
    let pixels = is_short(status.bands[band].pixel_pairs, frame.pixel_texel_capacity);
    let triangles = is_short(status.bands[band].triangle_pairs, frame.triangle_texel_capacity);
    let candidates = status.bands[band].candidates > frame.candidate_capacity;
    return pixels || triangles || candidates || status.bands[band].longest > lists.most_at_place;
}

fn is_camera_short() -> bool {
    if (frame.flags & FLAG_CLAMP) == 0u { return false; }
    let listed = is_short(status.head.pixel_triangles, frame.pixel_triangle_capacity);
    let longest = atomicLoad(&status.head.longest_pixel) > lists.most_at_pixel;
    let complex = is_short(status.head.complex_pixels, frame.complex_capacity);
    return listed || longest || complex || is_short(status.head.facets_needed, frame.facets_total);
}

@compute @workgroup_size(WORKGROUP)
fn judge(@builtin(local_invocation_index) local: u32) {
    var wrong = false;
    if local == 0u {
        wrong = atomicLoad(&status.head.finished) != frame.stamp || is_camera_short();
        wrong = wrong || status.head.maps != frame.maps;
        for (var k = 0u; k < arrayLength(&faults); k++) { wrong = wrong || faults[k] != 0u; }
    }
    for (var band = local; band < lists.bands; band += WORKGROUP) { wrong = wrong || is_band_short(band); }
    if wrong { atomicOr(&verdict[0], 1u); }
}

@compute @workgroup_size(WORKGROUP)
fn hold(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let word = flat_invocation(group, groups, WORKGROUP, local);
    if word < min(arrayLength(&latest), arrayLength(&held)) && atomicLoad(&verdict[0]) == 0u {
        held[word] = latest[word];
    }
}

@compute @workgroup_size(WORKGROUP)
fn store(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let at = place_in_strip(pixel);
    if !is_own(at.y) { return; }
    let texel = frame.target_origin + texel_of_image(at);
    textureStore(target_texture, texel, vec4(visibility[pixel], 0.0, 0.0, 1.0));
}

fn visibility_at(x: u32, y: u32) -> f32 {
    return visibility[y * frame.image_size.x + min(x, frame.image_size.x - 1u)];
}

// The nearest number of 16 bits, of two the even one, to a value between 0 and 1: pack2x16float is no part of
// what every device can.
fn half_of(value: f32) -> u32 {
    let v = clamp(value, 0.0, 1.0);
    if v < 6.1035156e-5 { return u32(round(v * 16777216.0)); }
    let bits = bitcast<u32>(v);
    return ((bits + 0xfffu + ((bits >> 13u) & 1u)) >> 13u) - (112u << 10u);
}

@compute @workgroup_size(WORKGROUP)
fn pack(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let word = flat_invocation(group, groups, WORKGROUP, local);
    if word >= rows.words * frame.image_size.y { return; }
    let at = divided(word, rows.words);
    let x = at.y * (32u / BITS);
    let y = at.x;
    if x >= frame.image_size.x { return; }
    let first = visibility_at(x, y);
    if BITS == 32u {
        packed[word] = bitcast<u32>(first);
    } else if BITS == 16u {
        packed[word] = half_of(first) | (half_of(visibility_at(x + 1u, y)) << 16u);
    } else {
        let rest = vec3(visibility_at(x + 1u, y), visibility_at(x + 2u, y), visibility_at(x + 3u, y));
        packed[word] = pack4x8unorm(vec4(first, rest));
    }
}

@compute @workgroup_size(WORKGROUP)
fn pack_channel(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let at = place_in_strip(pixel);
    let word = at.y * rows.words + at.x;
    let shift = 8u * rows.channel;
    let byte = pack4x8unorm(vec4(visibility[pixel], 0.0, 0.0, 0.0));
    packed[word] = (packed[word] & ~(255u << shift)) | (byte << shift);
}

@compute @workgroup_size(WORKGROUP)
fn add(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let at = part.offset + pixel;
    let sum = share[pixel] + select(sums[at], 0.0, part.point == 0u);
    sums[at] = sum;
    if part.point + 1u < part.points { return; }
    // All lit is 1, however devices divide.
    let all = f32(part.points);
    share[pixel] = select(sum / all, 1.0, sum == all);
}
