// pixel_triangles: lists, pixel by pixel, the triangles that some sample in the pixel's square may see.
// Over blocks of 8 x 8 pixels: `cover` finds the nearest "farthest depth over the square" of the triangles
// that surely cover the whole square (`cover_keys`, complement of its bits, 0 without one); `count` counts
// the triangles that touch the square no farther than that (`pixel_counts`); `emit` and `emit_rest` write
// them to `pixel_list` at `pixel_offsets`, never beyond the capacity, and take the counts down to 0 again;
// order inside a pixel is not defined. The pixels of the first `step.index` blocks are kept in `touched` from
// counting to emitting, those of the rest are found anew. `judge` runs before the counts are scanned. A pixel
// with one triangle, which covers it, is single; a pixel without any is empty; the others are marked in
// `complex_flags`. It writes `facet_counts` (1 for single pixels, else 0) and keeps the longest list in
// `status`. All tests are conservative: margins are far above the rounding of what they are made of.
//@bindings Raster: cover, count, emit, emit_rest

//@import frame dispatch status pass rect work_items facing eye_edges block_bits

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> step: Pass;
@group(0) @binding(2) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(3) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> camera_rects: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(6) var<storage, read_write> cover_keys: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> pixel_counts: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> pixel_offsets: array<u32>;
@group(0) @binding(9) var<storage, read_write> pixel_list: array<u32>;
@group(0) @binding(10) var<storage, read_write> complex_flags: array<u32>;
@group(0) @binding(11) var<storage, read_write> facet_counts: array<u32>;
@group(0) @binding(12) var<storage, read_write> status: Status;
@group(0) @binding(13) var<storage, read_write> touched: array<vec2<u32>>;

const MARGIN = 1.00001;

// State of a triangle over the square of a pixel.
struct Over {
    touches: bool,
    covers: bool,
    nearest: f32,
    farthest: f32,
}

struct Seen {
    edges: array<vec4<f32>, 3>,  // at the image's middle, per pixel right and down, and doubt
    plane: vec4<f32>,            // normal . ray likewise, and doubt
    distance: f32,
    distance_doubt: f32,
    nearest: f32,
    farthest: f32,
    turn: f32,                   // which sign is inside; 0: not known
}

fn middle() -> vec2<f32> {
    return vec2(0.0, f32(frame.first_row)) + 0.5 * vec2<f32>(frame.image_size);
}

fn seen_triangle(t: u32) -> Seen {
    var s: Seen;
    let i = triangles[t];
    let ray = frame.ray_corner.xyz + middle().x * frame.ray_x.xyz + middle().y * frame.ray_y.xyz;
    let a = points[i.x].xyz;
    let b = points[i.y].xyz;
    let c = points[i.z].xyz;
    s.edges[0] = eye_edge(i.x, i.y, a, b, ray);
    s.edges[1] = eye_edge(i.y, i.z, b, c, ray);
    s.edges[2] = eye_edge(i.z, i.x, c, a, ray);
    let normal = cross(b - a, c - a);
    // Rounding of the normal, of the corners themselves, and of the products with a ray anywhere in the
    // image.
    let wide = largest(frame.ray_corner.xyz) + largest(ray);
    let reach = max(largest(a), max(largest(b), largest(c)));
    let doubt = 2e-6 * largest(b - a) * largest(c - a) + 6e-7 * reach * (largest(b - a) + largest(c - a));
    s.plane = vec4(dot(normal, ray), dot(normal, frame.ray_x.xyz), dot(normal, frame.ray_y.xyz),
        doubt * wide);
    s.distance = dot(normal, a);
    s.distance_doubt = doubt * reach;
    s.turn = select(0.0, sign(s.distance), abs(s.distance) > s.distance_doubt);
    let depths = vec3(dot(a, frame.forward.xyz), dot(b, frame.forward.xyz), dot(c, frame.forward.xyz));
    s.nearest = min(depths.x, min(depths.y, depths.z));
    s.farthest = max(depths.x, max(depths.y, depths.z));
    return s;
}

fn over_square(s: Seen, x: u32, y: u32) -> Over {
    var out = Over(true, s.turn != 0.0, s.nearest, s.farthest);
    let at = vec3(1.0, vec2(f32(x), f32(frame.first_row + y)) + 0.5 - middle());
    let v = vec3(dot(s.edges[0].xyz, at), dot(s.edges[1].xyz, at), dot(s.edges[2].xyz, at));
    var half = vec3(0.0);
    for (var k = 0u; k < 3u; k++) { half[k] = 0.5 * (abs(s.edges[k].y) + abs(s.edges[k].z)) + s.edges[k].w; }
    let ahead = all(v >= -half);
    let behind = all(v <= half);
    if s.turn > 0.0 {
        out.touches = ahead;
    } else if s.turn < 0.0 {
        out.touches = behind;
    } else {
        out.touches = ahead || behind;
    }
    out.covers = out.covers && all(s.turn * v > half);
    if s.turn != 0.0 {
        let over = s.turn * dot(s.plane.xyz, at);
        let reach = 0.5 * (abs(s.plane.y) + abs(s.plane.z)) + s.plane.w;
        let distance = abs(s.distance);
        if over + reach > 0.0 {
            out.nearest = max(out.nearest, (distance - s.distance_doubt) / ((over + reach) * MARGIN));
        }
        if over - reach > 0.0 {
            out.farthest = min(out.farthest, (distance + s.distance_doubt) / (over - reach) * MARGIN);
        }
    }
    out.nearest = out.nearest - 2e-6 * abs(out.nearest);
    out.farthest = out.farthest + 2e-6 * abs(out.farthest);
    out.covers = out.covers && out.nearest > frame.forward.w * MARGIN;
    return out;
}

// A triangle and a block of pixels; beyond the last, NO_TRIANGLE for the triangle.
struct Item { triangle: u32, block: Rect }

fn item_of(item: u32) -> Item {
    if item >= work_offsets[frame.triangle_count] { return Item(NO_TRIANGLE, Rect()); }
    let t = owner_of(item, frame.triangle_count);
    return Item(t, block_of(camera_rects[t], item - work_offsets[t]));
}

// The pixels of the block, one bit each row by row, in which the triangle is listed.
fn pixels_of(item: Item) -> vec2<u32> {
    let s = seen_triangle(item.triangle);
    var found = vec2(0u);
    for (var y = item.block.low.y; y <= item.block.high.y; y++) {
        for (var x = item.block.low.x; x <= item.block.high.x; x++) {
            let over = over_square(s, x, y);
            if !over.touches { continue; }
            // Without a covering triangle the key is 0 and the depth no number: nothing is behind it.
            let cover = bitcast<f32>(min(~atomicLoad(&cover_keys[y * frame.image_size.x + x]), FAR));
            if !(over.nearest > cover) { add_texel(&found, vec2(x, y) - item.block.low); }
        }
    }
    return found;
}

// `anew`: `emit_rest` is compiled for itself and may round otherwise than `count` did, so it stays within
// what was counted.
fn write_triangle(item: Item, found: vec2<u32>, anew: bool) {
    var pixels = found;
    while any(pixels != vec2(0u)) {
        let at = item.block.low + take_texel(&pixels);
        let pixel = at.y * frame.image_size.x + at.x;
        let place = pixel_offsets[pixel] + atomicSub(&pixel_counts[pixel], 1u) - 1u;
        if anew && (place < pixel_offsets[pixel] || place >= pixel_offsets[pixel + 1u]) { continue; }
        if place < frame.pixel_triangle_capacity { pixel_list[place] = item.triangle; }
    }
}

@compute @workgroup_size(WORKGROUP)
fn cover(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = item_of(flat_invocation(group, groups, WORKGROUP, local));
    if item.triangle == NO_TRIANGLE { return; }
    let s = seen_triangle(item.triangle);
    if s.turn == 0.0 { return; }
    for (var y = item.block.low.y; y <= item.block.high.y; y++) {
        for (var x = item.block.low.x; x <= item.block.high.x; x++) {
            let over = over_square(s, x, y);
            if over.touches && over.covers {
                atomicMax(&cover_keys[y * frame.image_size.x + x], ~bitcast<u32>(over.farthest));
            }
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_invocation(group, groups, WORKGROUP, local);
    let item = item_of(index);
    if item.triangle == NO_TRIANGLE { return; }
    var pixels = pixels_of(item);
    if index < step.index { touched[index] = pixels; }
    while any(pixels != vec2(0u)) {
        let at = item.block.low + take_texel(&pixels);
        atomicAdd(&pixel_counts[at.y * frame.image_size.x + at.x], 1u);
    }
}

@compute @workgroup_size(WORKGROUP)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_invocation(group, groups, WORKGROUP, local);
    if index >= step.index { return; }
    let item = item_of(index);
    if item.triangle != NO_TRIANGLE { write_triangle(item, touched[index], false); }
}

@compute @workgroup_size(WORKGROUP)
fn emit_rest(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let item = item_of(step.index + flat_invocation(group, groups, WORKGROUP, local));
    if item.triangle != NO_TRIANGLE { write_triangle(item, pixels_of(item), true); }
}

@compute @workgroup_size(WORKGROUP)
fn judge(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let count = atomicLoad(&pixel_counts[pixel]);
    // The triangle that covers is always counted, so one triangle and a key mean that it is the one.
    let single = count == 1u && atomicLoad(&cover_keys[pixel]) != 0u;
    let many = count != 0u && !single;
    complex_flags[pixel] = select(0u, 1u, many);
    facet_counts[pixel] = select(0u, 1u, single);
    if many && atomicLoad(&status.head.longest_pixel) < count {
        atomicMax(&status.head.longest_pixel, count);
    }
}
