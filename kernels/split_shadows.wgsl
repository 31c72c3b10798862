// split_shadows: shadows by the maps of `split_maps`, each pixel by that of its slice.
// `compare`: depth comparison with the nearest texel for every sample, as in shadow_map. `filter_moments`:
// one lookup a pixel in the moments of its footprint, anisotropic: squares as wide as the footprint is
// across, along it up to MOST_PROBES of them. Of the depths there at most the share variance / (variance + (t
// - mean)^2) lies behind a receiver of depth t behind their mean (Chebyshev; Donnelly and Lauritzen 2006),
// which is taken as lit, less BLEEDING; t is that of the receiver's plane at the very place that is looked
// up. Where the receiver turns less than GRAZING (sine of its elevation) to the light, half of it is lit
// (Oliveira 2009, section 4.2.2). Writes `visibility`.
//@bindings Ask: compare, filter_moments

//@import frame split_views dispatch facing receiver front_split moments

override BIAS_CONSTANT: f32 = 0.00005;
override BIAS_SLOPE: f32 = 1.05;
override BLEEDING: f32 = 0.0;
override GRAZING: f32 = 0.0;
const MOST_PROBES = 16u;
const LONGEST_STEP = 65536.0;  // texels: a plane seen edge-on has no end
const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(3) var<storage, read> id_keys: array<u32>;
@group(0) @binding(4) var<storage, read> triangles: array<vec3<u32>>;
@group(0) @binding(5) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> map_keys: array<u32>;
@group(0) @binding(7) var<storage, read> moments: array<vec2<f32>>;
@group(0) @binding(8) var<storage, read_write> visibility: array<f32>;

// Where a point of the receiver lies in the map of its slice.
struct Place {
    view: u32,
    at: vec2<f32>,      // texels
    divisor: f32,       // not above 0 where it is not in the view
    slope: vec2<f32>,   // depth of the receiver per texel
    whole: vec2<f32>,   // the texel of the whole view
}

fn place_in_split(r: Receiver, p: vec3<f32>, whole: vec2<f32>) -> Place {
    var place: Place;
    place.whole = whole;
    place.view = split_of(dot(frame.forward.xyz, p));
    let q = in_split(place.view, vec4(p, 1.0));
    place.at = q.xy / q.z;
    place.divisor = q.z;
    // Change of the map's texels with those of the whole view, by which the slope there becomes one here.
    let k = 3u * place.view;
    let by = splits.warps[k + 2u];
    let over = dot(by.xyz, vec3(whole, 1.0));
    let x = (splits.warps[k].xy - place.at.x * by.xy) / over;
    let y = (splits.warps[k + 1u].xy - place.at.y * by.xy) / over;
    let area = x.x * y.y - x.y * y.x;
    place.slope = vec2(r.slope.x * y.y - r.slope.y * y.x, r.slope.y * x.x - r.slope.x * x.y) / area;
    return place;
}

fn in_map(place: Place) -> bool {
    return place.divisor > 0.0 && all(place.at >= vec2(0.0)) && all(place.at < vec2(f32(frame.map_size)));
}

// 1 where nothing lies before the receiver in the nearest texel.
fn is_lit(r: Receiver, p: vec3<f32>, at: vec4<f32>) -> f32 {
    let place = place_in_split(r, p, at.xy);
    if !in_map(place) { return 1.0; }
    let texel = vec2<u32>(place.at);
    let key = map_keys[(place.view * frame.map_size + texel.y) * frame.map_size + texel.x];
    let depth = at.z - BIAS_CONSTANT - BIAS_SLOPE * max(abs(place.slope.x), abs(place.slope.y));
    return select(0.0, 1.0, key == 0u || depth_of_key(key) >= depth);
}

fn cell_moments(view: u32, level: u32, cell: vec2<u32>) -> vec2<f32> {
    if level == 0u { return texel_moments(map_keys[(view * frame.map_size + cell.y) * frame.map_size + cell.x]); }
    return moments[view * splits.level_stride + level_start(level) + cell.y * level_side(level) + cell.x];
}

// Between the four cells of a level around a place.
fn bilinear(view: u32, level: u32, at: vec2<f32>) -> vec2<f32> {
    let last = f32(level_side(level) - 1u);
    let place = clamp(at / f32(1u << level) - 0.5, vec2(0.0), vec2(last));
    let low = vec2<u32>(place);
    let high = min(low + 1u, vec2(level_side(level) - 1u));
    let f = place - floor(place);
    let a = cell_moments(view, level, low);
    let b = cell_moments(view, level, vec2(high.x, low.y));
    let c = cell_moments(view, level, vec2(low.x, high.y));
    let d = cell_moments(view, level, high);
    let shares = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    return mixed(vec4(a.x, b.x, c.x, d.x), vec4(a.y, b.y, c.y, d.y), shares);
}

// Of a square of 2^level texels a side around a place: between two levels.
fn trilinear(view: u32, level: f32, at: vec2<f32>) -> vec2<f32> {
    let low = u32(level);
    let fine = bilinear(view, low, at);
    let f = level - f32(low);
    if f == 0.0 { return fine; }
    let coarse = bilinear(view, min(low + 1u, splits.levels), at);
    return mixed(vec4(fine.x, coarse.x, fine.xx), vec4(fine.y, coarse.y, 0.0, 0.0), vec4(1.0 - f, f, 0.0, 0.0));
}

// Depth that the receiver at `place` gains up to another texel of the map: along its plane, which a warp
// bends.
fn rise_to(r: Receiver, place: Place, at: vec2<f32>) -> f32 {
    let k = 3u * place.view;
    let q = vec3(at, 1.0);
    let whole = vec2(dot(splits.backs[k].xyz, q), dot(splits.backs[k + 1u].xyz, q)) / dot(splits.backs[k + 2u].xyz, q);
    return dot(r.slope, whole - place.whole);
}

// Share of light in a square of 2^level texels a side around a place, of a receiver that has this depth at
// `place`.
fn lit_share(r: Receiver, place: Place, depth: f32, wanted: vec2<f32>, level: f32) -> f32 {
    // Where cells of the level above are whole all around; the middle of the map where none is whole.
    let cell = min(exp2(ceil(level)), f32(frame.map_size));
    let last = (floor(f32(frame.map_size) / cell) - 0.5) * cell;
    let at = clamp(wanted, vec2(0.5 * cell), vec2(last));
    let found = trilinear(place.view, level, at);
    let off = depth + rise_to(r, place, at) - BIAS_CONSTANT - found.x;
    if off <= 0.0 { return 1.0; }
    return max(found.y / (found.y + off * off) - BLEEDING, 0.0) / (1.0 - BLEEDING);
}

// Change of a place for a change of the ray by a pixel.
fn step_of(r: Receiver, ray: vec3<f32>, step: vec3<f32>, place: Place) -> vec2<f32> {
    let over = dot(r.normal, ray);
    let change = (step - ray * (dot(r.normal, step) / over)) * (r.height / over);
    let q = in_split(place.view, vec4(change, 0.0));
    return clamp((q.xy - place.at * q.z) / place.divisor, vec2(-LONGEST_STEP), vec2(LONGEST_STEP));
}

fn filtered(r: Receiver, ray: vec3<f32>) -> f32 {
    let p = plane_point(r, ray);
    let at = place_at(p);
    if at.w == 0.0 { return 1.0; }
    let place = place_in_split(r, p.xyz, at.xy);
    if !in_map(place) { return 1.0; }
    let x = step_of(r, ray, frame.ray_x.xyz, place);
    let y = step_of(r, ray, frame.ray_y.xyz, place);
    // Axes of the ellipse that the pixel's circle is there.
    let a = x.x * x.x + y.x * y.x;
    let b = x.x * x.y + y.x * y.y;
    let c = x.y * x.y + y.y * y.y;
    let root = sqrt(0.25 * (a - c) * (a - c) + b * b);
    let long = sqrt(max(0.5 * (a + c) + root, 1e-12));
    let short = abs(x.x * y.y - x.y * y.x) / long;
    var along = select(vec2(b, 0.5 * (c - a) + root), vec2(0.5 * (a - c) + root, b), a >= c);
    along *= long * inverseSqrt(max(dot(along, along), 1e-30));
    let probes = u32(clamp(ceil(long / max(short, 1.0)), 1.0, f32(MOST_PROBES)));
    let level = clamp(log2(max(max(short, long / f32(probes)), 1.0)), 0.0, f32(splits.levels));
    var sum = 0.0;
    for (var k = 0u; k < probes; k++) {
        sum += lit_share(r, place, at.z, place.at + along * ((f32(k) + 0.5) / f32(probes) - 0.5), level);
    }
    return sum / f32(probes);
}

@compute @workgroup_size(WORKGROUP)
fn compare(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    if r.seen != SEEN_OPEN {
        visibility[pixel] = select(0.0, 1.0, r.seen == SEEN_NONE);
        return;
    }
    var sum = 0.0;
    var seen = 0.0;
    for (var k = 0u; k < frame.sample_count; k++) {
        let p = plane_point(r, sample_ray(pixel, k));
        let at = place_at(p);
        if at.w == 0.0 { continue; }
        seen += 1.0;
        sum += is_lit(r, p.xyz, at);
    }
    visibility[pixel] = select(sum / seen, 1.0, seen == 0.0);
}

@compute @workgroup_size(WORKGROUP)
fn filter_moments(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let pixel = flat_invocation(group, groups, WORKGROUP, local);
    if pixel >= frame.image_size.x * frame.image_size.y { return; }
    let r = receiver_of(pixel);
    var share = select(0.0, 1.0, r.seen == SEEN_NONE);
    if r.seen == SEEN_OPEN {
        let to_light = frame.light.xyz - frame.light.w * r.at;
        let grazes = dot(r.normal, to_light) < GRAZING * length(r.normal) * length(to_light);
        if grazes { share = 0.5; } else { share = filtered(r, pixel_ray(pixel)); }
    }
    visibility[pixel] = share;
}
