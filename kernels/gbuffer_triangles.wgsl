// gbuffer_triangles: lists, pixel by pixel, the triangles that an application's G-buffer of several samples a
// pixel shows, in place of pixel_triangles. The samples are layers of a texture (`count_layers` ...) or those
// of a multisampled one (`count_samples` ...); a texel is a triangle as the application counts them, its high
// half in the second channel if there is one. `count` writes `pixel_counts` (different triangles), and marks
// in `complex_flags` the pixels that show several, or one and something else; `facet_counts` is 1 where all
// samples show one triangle, else 0: then `id_keys` has the triangle's complement, and nothing is listed. It
// keeps the longest list of a marked pixel in `status`, and counts into `faults` the samples that name no
// triangle, which count as none. `emit` writes the triangles of marked pixels to `pixel_list` at
// `pixel_offsets`, in the order of their first samples, never beyond the capacity, and takes the counts down
// to 0. `fill` gives each sample of a marked pixel that no triangle covers to the one that the nearest
// sample of the G-buffer shows (pixel_coverage).

//@import frame dispatch status divide strip pixel_pair covering word_masks

const WORKGROUP = 64u;
const FAULT_UNKNOWN = 2u;
const MOST = 128u;

struct GbufferTrianglesParams {
    count: u32,       // samples of the G-buffer
    first: u32,       // number of the application's first triangle
    none: u32,        // its number for no triangle
    pad_0: u32,
    nearest: array<vec4<u32>, 32>,  // of each of the pixel's samples the nearest of the G-buffer
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> params: GbufferTrianglesParams;
@group(0) @binding(2) var layers: texture_2d_array<u32>;
@group(0) @binding(3) var multisampled: texture_multisampled_2d<u32>;
@group(0) @binding(4) var<storage, read> numbers: array<u32>;
@group(0) @binding(5) var<storage, read_write> pixel_counts: array<u32>;
@group(0) @binding(6) var<storage, read_write> complex_flags: array<u32>;
@group(0) @binding(7) var<storage, read_write> facet_counts: array<u32>;
@group(0) @binding(8) var<storage, read_write> status: Status;
@group(0) @binding(9) var<storage, read_write> faults: array<atomic<u32>>;
@group(0) @binding(10) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(11) var<storage, read_write> pixel_list: array<PixelPair>;
@group(0) @binding(12) var<storage, read> complex_pixels: array<u32>;
@group(0) @binding(13) var<storage, read> complex_total: array<u32>;
@group(0) @binding(14) var<storage, read_write> covering_masks: array<u32>;
@group(0) @binding(15) var<storage, read_write> id_keys: array<u32>;
@group(0) @binding(16) var<storage, read_write> coverings: array<Covering>;

var<private> different: u32;  // triangles of a pixel
var<private> misses: u32;
var<private> unknown: u32;

//@import listed_samples

fn number_of(texel: vec4<u32>) -> u32 {
    return texel.x | (texel.y << 16u);
}

fn triangle_of(texel: vec4<u32>) -> u32 {
    let id = number_of(texel);
    let given = id - params.first;
    if id == params.none || id < params.first || given >= frame.triangle_count { return NO_TRIANGLE; }
    return numbers[given];
}

fn place_of(pixel: u32) -> vec2<u32> {
    return given_texel(place_in_strip(pixel));
}

fn sample_count() -> u32 {
    return min(params.count, MOST);
}

// Whether sample `s` shows a triangle that no sample before it shows; `last` is that of the sample before.
// Samples are read again in place of being kept in an array, which GPUs would put into memory: most often the
// one before or one of the first shows the same.
fn is_new_in_layers(at: vec2<u32>, s: u32, t: u32, last: u32) -> bool {
    var fresh = t != NO_TRIANGLE && t != last;
    for (var n = 0u; n < s && fresh; n++) { fresh = triangle_of(textureLoad(layers, at, n, 0)) != t; }
    return fresh;
}

fn is_new_in_samples(at: vec2<u32>, s: u32, t: u32, last: u32) -> bool {
    var fresh = t != NO_TRIANGLE && t != last;
    for (var n = 0u; n < s && fresh; n++) { fresh = triangle_of(textureLoad(multisampled, at, n)) != t; }
    return fresh;
}

fn note(texel: vec4<u32>, t: u32, fresh: bool) {
    different += select(0u, 1u, fresh);
    misses += select(0u, 1u, t == NO_TRIANGLE);
    unknown += select(0u, 1u, t == NO_TRIANGLE && number_of(texel) != params.none);
}

// `last`: what the last sample shows.
fn write_counts(pixel: u32, last: u32) {
    let single = different == 1u && misses == 0u;
    let many = different != 0u && !single;
    pixel_counts[pixel] = select(0u, different, many);
    if single { id_keys[pixel] = ~last; }
    complex_flags[pixel] = select(0u, 1u, many);
    facet_counts[pixel] = select(0u, 1u, single);
    if many && atomicLoad(&status.head.longest_pixel) < different {
        atomicMax(&status.head.longest_pixel, different);
    }
    if unknown != 0u && is_own(place_in_strip(pixel).y) { atomicAdd(&faults[FAULT_UNKNOWN], unknown); }
}

fn write(pixel: u32, t: u32, fresh: bool) {
    if !fresh { return; }
    let place = pixel_offsets[pixel] + different;
    if place < min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity) {
        pixel_list[place] = PixelPair(t, pixel);
    }
    different += 1u;
}

fn is_outside(pixel: u32) -> bool {
    return pixel >= frame.image_size.x * frame.image_size.y;
}

@compute @workgroup_size(WORKGROUP)
fn count_layers(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if is_outside(pixel) { return; }
    let at = place_of(pixel);
    var last = NO_TRIANGLE;
    for (var s = 0u; s < sample_count(); s++) {
        let texel = textureLoad(layers, at, s, 0);
        let t = triangle_of(texel);
        note(texel, t, is_new_in_layers(at, s, t, last));
        last = t;
    }
    write_counts(pixel, last);
}

@compute @workgroup_size(WORKGROUP)
fn count_samples(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if is_outside(pixel) { return; }
    let at = place_of(pixel);
    var last = NO_TRIANGLE;
    for (var s = 0u; s < sample_count(); s++) {
        let texel = textureLoad(multisampled, at, s);
        let t = triangle_of(texel);
        note(texel, t, is_new_in_samples(at, s, t, last));
        last = t;
    }
    write_counts(pixel, last);
}

@compute @workgroup_size(WORKGROUP)
fn emit_layers(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if is_outside(pixel) { return; }
    let at = place_of(pixel);
    pixel_counts[pixel] = 0u;
    var last = NO_TRIANGLE;
    for (var s = 0u; s < sample_count(); s++) {
        let t = triangle_of(textureLoad(layers, at, s, 0));
        write(pixel, t, is_new_in_layers(at, s, t, last));
        last = t;
    }
}

@compute @workgroup_size(WORKGROUP)
fn emit_samples(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if is_outside(pixel) { return; }
    let at = place_of(pixel);
    pixel_counts[pixel] = 0u;
    var last = NO_TRIANGLE;
    for (var s = 0u; s < sample_count(); s++) {
        let t = triangle_of(textureLoad(multisampled, at, s));
        write(pixel, t, is_new_in_samples(at, s, t, last));
        last = t;
    }
}

fn nearest_to(k: u32) -> u32 {
    return params.nearest[k >> 2u][k & 3u];
}

// The complex pixel of a slot; NO_TRIANGLE beyond the last.
fn complex_pixel(slot: u32) -> u32 {
    if slot >= min(complex_total[0], frame.complex_capacity) { return NO_TRIANGLE; }
    return complex_pixels[slot];
}

@compute @workgroup_size(WORKGROUP)
fn fill_layers(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = complex_pixel(flat_invocation(group, groups, WORKGROUP, local));
    if pixel == NO_TRIANGLE { return; }
    for (var left = samples_left(pixel); any(left != vec4(0u)); left = without_lowest(left)) {
        let k = lowest_bit(left);
        let t = triangle_of(textureLoad(layers, place_of(pixel), nearest_to(k), 0));
        if t != NO_TRIANGLE { give(pixel, k, t); }
    }
}

@compute @workgroup_size(WORKGROUP)
fn fill_samples(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = complex_pixel(flat_invocation(group, groups, WORKGROUP, local));
    if pixel == NO_TRIANGLE { return; }
    for (var left = samples_left(pixel); any(left != vec4(0u)); left = without_lowest(left)) {
        let k = lowest_bit(left);
        let t = triangle_of(textureLoad(multisampled, place_of(pixel), nearest_to(k)));
        if t != NO_TRIANGLE { give(pixel, k, t); }
    }
}
