// Surfaces of the samples of complex pixels, and their grouping (sample_surfaces).

//@import frame surface_step nearest_sample
//@needs override WORDS: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> step: SurfaceStep;
//@needs var<storage, read> points: array<vec4<f32>>;
//@needs var<storage, read> complex_pixels: array<u32>;
//@needs var<storage, read> complex_total: array<u32>;
//@needs var<storage, read_write> sample_keys: array<u32>;
//@needs var<storage, read> seen_keys: array<u32>;
//@needs var<storage, read> group_keys: array<u32>;

// Complex pixels of the band.
fn slot_count() -> u32 {
    let all = min(complex_total[0], frame.complex_capacity);
    return min(all - min(all, step.first_slot), step.slots);
}

fn complex_pixel(slot: u32) -> u32 {
    return complex_pixels[step.first_slot + slot];
}

// View depth of the farthest corner.
fn far_corner(t: u32) -> f32 {
    let i = corners_of(t);
    return max(dot(points[i.x].xyz, frame.forward.xyz),
        max(dot(points[i.y].xyz, frame.forward.xyz), dot(points[i.z].xyz, frame.forward.xyz)));
}

// Of the triangles that these samples see.
fn farthest_corner(slot: u32, those: vec4<u32>) -> f32 {
    var far = 0.0;
    for (var w = 0u; w < WORDS; w++) {
        var left = those[w];
        while left != 0u {
            far = max(far, far_corner(~sample_keys[place(slot, 32u * w + firstTrailingBit(left))]));
            left &= left - 1u;
        }
    }
    return far;
}

// Surfaces of a pixel's samples, where one word holds them: loaded once, and only indexed by what compilers
// know.
var<private> own_groups: array<u32, 32>;
var<private> own_seen: array<u32, 32>;

fn load_groups(slot: u32) {
    if WORDS > 1u { return; }
    for (var k = 0u; k < 32u; k++) { own_groups[k] = group_keys[place(slot, k)]; }
}

fn load_seen(slot: u32) {
    if WORDS > 1u { return; }
    for (var k = 0u; k < 32u; k++) { own_seen[k] = seen_keys[place(slot, k)]; }
}

// The samples of a complex pixel whose surface is named `key`.
fn samples_of(slot: u32, key: u32) -> vec4<u32> {
    var found = vec4(0u);
    if WORDS == 1u {
        for (var k = 0u; k < 32u; k++) { found.x |= select(0u, 1u << k, own_groups[k] == key); }
        return found;
    }
    for (var w = 0u; w < WORDS; w++) {
        var bits = 0u;
        var at = place(slot, 32u * w);
        for (var k = 0u; k < 32u; k++) {
            bits |= select(0u, 1u << k, group_keys[at] == key);
            at += step.slots;
        }
        found[w] = bits;
    }
    return found;
}

// Those that see the triangle `key`.
fn samples_that_see(slot: u32, key: u32) -> vec4<u32> {
    var found = vec4(0u);
    if WORDS == 1u {
        for (var k = 0u; k < 32u; k++) { found.x |= select(0u, 1u << k, own_seen[k] == key); }
        return found;
    }
    for (var w = 0u; w < WORDS; w++) {
        var bits = 0u;
        var at = place(slot, 32u * w);
        for (var k = 0u; k < 32u; k++) {
            bits |= select(0u, 1u << k, seen_keys[at] == key);
            at += step.slots;
        }
        found[w] = bits;
    }
    return found;
}

fn lowest_sample(mask: vec4<u32>) -> u32 {
    var w = 0u;
    while mask[w] == 0u { w += 1u; }
    return 32u * w + firstTrailingBit(mask[w]);
}

fn size_of(mask: vec4<u32>) -> u32 {
    let n = countOneBits(mask);
    return n.x + n.y + n.z + n.w;
}

// Of some samples those that see one triangle, the one that most of them see; of several, that of the first
// sample.
fn most_seen(slot: u32, mask: vec4<u32>) -> vec4<u32> {
    var most = vec4(0u);
    for (var left = mask; any(left != vec4(0u)); ) {
        let some = samples_that_see(slot, seen_keys[place(slot, lowest_sample(left))]);
        left &= ~some;
        if size_of(some) > size_of(most) { most = some; }
    }
    return most;
}

// The samples of a complex pixel that see a surface.
fn samples_left(slot: u32) -> vec4<u32> {
    let none = samples_of(slot, 0u);
    var left = vec4(0u);
    for (var w = 0u; w < WORDS; w++) { left[w] = ~none[w]; }
    return left;
}
