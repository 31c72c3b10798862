// The triangles that cover samples of a complex pixel, and their masks (sample_surfaces).

//@import frame surface_step covering word_masks
//@needs override WORDS: u32;
//@needs override MERGE: u32;
//@needs override ROUND_LENGTH: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> samples_given: array<vec4<f32>, 64>;
//@needs var<uniform> step: SurfaceStep;
//@needs var<storage, read> triangles: array<vec4<u32>>;
//@needs var<storage, read> points: array<vec4<f32>>;
//@needs var<storage, read_write> coverings: array<Covering>;
//@needs var<storage, read_write> covering_masks: array<u32>;
//@needs var<storage, read> surfaces: array<u32>;

// A complex pixel: where its list begins and ends.
struct PixelSlot {
    pixel: u32,
    first: u32,
    end: u32,
    kept: u32,  // triangles in front that see anything, of the rounds before
    far: f32,   // view depth of their farthest corner, if one of their surfaces has several triangles
}

// Those that a round looks at: some in front, and a part of the list.
struct Entries { first: u32, kept: u32, part: u32, count: u32 }

fn entries_of(slot: PixelSlot) -> Entries {
    let part = min(slot.first + step.round * ROUND_LENGTH, slot.end);
    return Entries(slot.first, slot.kept, part, slot.kept + min(slot.end - part, ROUND_LENGTH));
}

// Where the n-th of them stands in the list.
fn place_of(e: Entries, n: u32) -> u32 {
    return select(e.part + n - e.kept, e.first + n, n < e.kept);
}

fn mask_at(n: u32) -> vec4<u32> {
    var mask = vec4(covering_masks[n * WORDS], 0u, 0u, 0u);
    if WORDS > 1u { mask.y = covering_masks[n * WORDS + 1u]; }
    if WORDS > 2u {
        mask.z = covering_masks[n * WORDS + 2u];
        mask.w = covering_masks[n * WORDS + 3u];
    }
    return mask;
}

// The first of them from the n-th on that sees anything, or the count.
fn next_seen(e: Entries, first: u32) -> u32 {
    var n = first;
    while n < e.count && all(mask_at(place_of(e, n)) == vec4(0u)) { n++; }
    return n;
}

// Of the entries from `first` on the one with sample `k`; `end - 1` if no other has it.
fn entry_with(first: u32, end: u32, k: u32) -> u32 {
    let word = k >> 5u;
    var n = first;
    while n + 1u < end && ((covering_masks[n * WORDS + word] >> (k & 31u)) & 1u) == 0u { n++; }
    return n;
}

// The surface of a triangle, of those behind the casters' (surface_receivers) itself.
fn surface_of(triangle: u32) -> u32 {
    if triangle >= frame.triangle_count { return triangle; }
    return surfaces[triangle];
}

// The surface of an entry.
fn name_of(n: u32) -> u32 {
    if MERGE == 0u { return n; }
    return surface_of(coverings[n].triangle);
}

// The next entry of a surface, or `end`.
fn next_named(first: u32, end: u32, name: u32) -> u32 {
    var n = first;
    while n < end && name_of(n) != name { n++; }
    return n;
}

// View depth of the farthest corner.
fn far_corner(t: u32) -> f32 {
    let i = triangles[t].xyz;
    return max(dot(points[i.x].xyz, frame.forward.xyz),
        max(dot(points[i.y].xyz, frame.forward.xyz), dot(points[i.z].xyz, frame.forward.xyz)));
}

fn sample_offset(k: u32) -> vec2<f32> {
    let pair = samples_given[k >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 1u);
}
