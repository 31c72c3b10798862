// surface_receivers: surfaces of an application's depth or position texture that cast nothing
// (pixel_receivers), among the triangles that samples of a pixel may see (pixel_triangles). A receiver is
// the triangle behind the casters' that a pixel has by `keys`. `own` begins the lists: of a pixel that
// shows a receiver `pixel_counts` is 1, `id_keys` has its key, and `cover_keys` its farthest depth over
// the square if it holds all of that, so that casters behind it are passed over; its vertices get
// `points`. `choose` runs when casters are counted: a pixel that shows a caster, and may show more, takes
// the receivers of the eight pixels around it, or if they show none of the sixteen around those, whose
// planes do not run before that caster at its centre: one of each plane, eight at most; one in which no
// caster was counted keeps the one that it shows. It adds them to `pixel_counts`; `chosen` has a bit for
// each of five times five pixels, row by row, the pixel's own in the middle. `list` fills `pixel_list`
// behind the casters with pairs of the next pixel, which pixel_coverage passes over; `cover` appends
// receivers to the `coverings` of complex pixels, with their samples: all of its own, else those that are
// nearest to the pixel of that receiver, unless the receiver runs before what the nearest neighbour pixel
// shows. Near is as the eye sees it, give or take `tolerance` of the view depth.

//@import frame dispatch strip finite pixel_ray vertex facing near_distance eye_edges eye_view given_place
//@import covering pixel_pair neighbour_pixels

override WORDS: u32 = 1u;
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> params: PixelReceiversParams;
@group(0) @binding(2) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the centre each
@group(0) @binding(3) var place: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> keys: array<u32>;
@group(0) @binding(5) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(6) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> made_points: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read_write> cover_keys: array<u32>;
@group(0) @binding(9) var<storage, read_write> id_keys: array<u32>;
@group(0) @binding(10) var<storage, read_write> pixel_counts: array<u32>;
@group(0) @binding(11) var<storage, read_write> chosen: array<u32>;
@group(0) @binding(12) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(13) var<storage, read_write> pixel_list: array<PixelPair>;
@group(0) @binding(14) var<storage, read> complex_pixels: array<u32>;
@group(0) @binding(15) var<storage, read> complex_total: array<u32>;
@group(0) @binding(16) var<storage, read_write> coverings: array<Covering>;
@group(0) @binding(17) var<storage, read_write> covering_masks: array<u32>;
@group(0) @binding(18) var place_samples: texture_multisampled_2d<f32>;

fn is_outside(pixel: u32) -> bool {
    return pixel >= frame.image_size.x * frame.image_size.y;
}

// Whether a key is that of a surface that casts nothing.
fn is_receiver(key: u32) -> bool {
    return key != 0u && ~key >= frame.triangle_count;
}

fn receiver_corners(pixel: u32) -> Corners {
    let v = frame.vertex_count + 3u * pixel;
    return corners_at(vec3(v, v + 1u, v + 2u));
}

// View depth of a triangle's plane on a ray; not above 0 where the ray does not meet it ahead of the eye.
fn plane_depth(u: Corners, ray: vec3<f32>) -> f32 {
    let n = cross(u.b - u.a, u.c - u.a);
    return dot(n, u.a) / dot(n, ray);
}

// Whether a plane runs before something at a view depth on a ray.
fn runs_before(u: Corners, ray: vec3<f32>, depth: f32) -> bool {
    let here = plane_depth(u, ray);
    return here > 0.0 && here < (1.0 - params.tolerance) * depth;
}

// Complement of the bits of the farthest depth of a triangle over the square of a pixel; 0 where it does not
// surely hold all of it, beyond the near distance.
fn cover_key(view: View, ray: vec3<f32>) -> u32 {
    let least = view.turn * view.at - 0.51 * (abs(view.right) + abs(view.down)) - view.doubt;
    let slope = 0.51 * (abs(view.slopes.x) + abs(view.slopes.y));
    let low = view.low - slope;
    let high = view.high + slope;
    let beyond = high * frame.forward.w < 0.99999 && high < 0.99999 * least_inverse_near(ray);
    return select(0u, ~bitcast<u32>(1.0 / low), all(least > vec3(0.0)) && low > 1e-30 && beyond);
}

@compute @workgroup_size(WORKGROUP)
fn own(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if is_outside(pixel) { return; }
    let key = keys[pixel];
    chosen[pixel] = select(0u, 1u << OWN, is_receiver(key));
    if !is_receiver(key) { return; }
    let v = frame.vertex_count + 3u * pixel;
    let u = Corners(vec3(v, v + 1u, v + 2u), point_of(v), point_of(v + 1u), point_of(v + 2u));
    made_points[v] = vec4(u.a, 1.0);
    made_points[v + 1u] = vec4(u.b, 1.0);
    made_points[v + 2u] = vec4(u.c, 1.0);
    let ray = pixel_ray(pixel);
    pixel_counts[pixel] = 1u;
    id_keys[pixel] = key;
    cover_keys[pixel] = cover_key(view_of(u, ray), ray);
}

// Whether the surface of a pixel lies in the plane of one of the receivers around another.
fn lies_in_any(q: vec2<i32>, around: vec2<i32>, bits: u32) -> bool {
    let p = place_at(q);
    var lies = false;
    for (var left = bits; left != 0u && !lies; left &= left - 1u) {
        let u = receiver_corners(pixel_at(neighbour(around, firstTrailingBit(left))));
        let n = cross(u.b - u.a, u.c - u.a);
        lies = abs(dot(n, p.point - u.a)) <= params.tolerance * p.depth * length(n);
    }
    return lies;
}

@compute @workgroup_size(WORKGROUP)
fn choose(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if is_outside(pixel) { return; }
    let key = keys[pixel];
    let count = pixel_counts[pixel];
    if key == 0u || is_receiver(key) || (count == 1u && cover_keys[pixel] != 0u) { return; }
    if count == 0u {
        pixel_counts[pixel] = 1u;
        cover_keys[pixel] = 1u;
        id_keys[pixel] = key;
        return;
    }
    let at = vec2<i32>(place_in_strip(pixel));
    let shown = place_at(at);
    if shown.what != SURFACE { return; }
    let ray = ray_of(at);
    var bits = 0u;
    for (var n = 0u; n < AROUND && (n < NEXT || bits == 0u || any_beyond(bits)); n++) {
        let k = nth_neighbour(n);
        let q = neighbour(at, k);
        if !is_in_image(q) || !is_receiver(keys[pixel_at(q)]) || countOneBits(bits) == MOST { continue; }
        let before = runs_before(receiver_corners(pixel_at(q)), ray, shown.depth);
        if !before && !lies_in_any(q, at, bits) { bits |= 1u << k; }
    }
    chosen[pixel] = bits;
    pixel_counts[pixel] = count + countOneBits(bits);
}

@compute @workgroup_size(WORKGROUP)
fn list(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if is_outside(pixel) { return; }
    let first = pixel_offsets[pixel];
    let end = min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity);
    var next = first + pixel_counts[pixel];
    for (var left = chosen[pixel]; left != 0u && next > first; left &= left - 1u) {
        next--;
        if next < end { pixel_list[next] = PixelPair(NO_TRIANGLE, pixel + 1u); }
    }
    pixel_counts[pixel] = next - first;
}

// Bits for the pixels left, right, above and below of one before whose surfaces a receiver runs.
fn sides_before(u: Corners, pixel: u32) -> u32 {
    let at = vec2<i32>(place_in_strip(pixel));
    var sides = 0u;
    for (var side = 0u; side < 4u; side++) {
        let q = at + step_to(side);
        if !is_in_image(q) { continue; }
        let shown = place_at(q);
        let depth = select(shown.depth, 3.0e38, shown.what == NOTHING);
        if shown.what != FAULT && runs_before(u, ray_of(q), depth) { sides |= 1u << side; }
    }
    return sides;
}

@compute @workgroup_size(WORKGROUP)
fn cover(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = flat_invocation(group, groups, WORKGROUP, local);
    if slot >= min(complex_total[0], frame.complex_capacity) { return; }
    let pixel = complex_pixels[slot];
    let at = vec2<i32>(place_in_strip(pixel));
    let bits = chosen[pixel];
    let first = pixel_offsets[pixel] + pixel_counts[pixel];
    let end = min(pixel_offsets[pixel + 1u], frame.pixel_triangle_capacity);
    if bits == 0u || first + countOneBits(bits) > end { return; }
    // Four bits for each of them.
    var before = 0u;
    var place = first;
    for (var left = bits; left != 0u; left &= left - 1u) {
        let k = firstTrailingBit(left);
        let q = pixel_at(neighbour(at, k));
        let u = receiver_corners(q);
        let view = view_of(u, pixel_ray(pixel));
        coverings[place] =
            Covering(frame.triangle_count + q, view.high, view.low, view.slopes.x, view.slopes.y);
        for (var w = 0u; w < WORDS; w++) { covering_masks[place * WORDS + w] = 0u; }
        if k != OWN { before |= sides_before(u, pixel) << (4u * (place - first)); }
        place++;
    }
    pixel_counts[pixel] = place - pixel_offsets[pixel];
    for (var s = 0u; s < frame.sample_count; s++) {
        let pair = samples[s >> 1u];
        let offset = select(pair.xy, pair.zw, (s & 1u) == 1u);
        let k = nearest_of(bits, before, offset);
        if k == NONE { continue; }
        let u = receiver_corners(pixel_at(neighbour(at, k)));
        let ray = ray_at(pixel, offset);
        if !covers_ray(u, ray) || eye_depth(u, ray).x < near_along(ray) { continue; }
        let word = (first + rank_of(bits, k)) * WORDS + (s >> 5u);
        covering_masks[word] |= 1u << (s & 31u);
    }
}
