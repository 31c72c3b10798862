// light_lists: for each tile of 8 x 8 pixels a list of the lights that reach it and are not dark in all of
// it, each with the visibility of its pixels, as clustered and forward shading take it (Olsson, Billeter,
// Assarsson 2012). Entries are linked by tile (Yang, Hensley, Gruen, Thibieroz 2010), and placed by a scan,
// so that they are the same in every run.
// `share` reads the facets of a frame whose last stage has run, and writes `shares`, 16 words a tile: a byte
// a pixel, row by row, the nearest 255th of the share of its seen samples that are lit and within reach
// (`part`: range and cone); 0 where none sees a surface. `share_centres` takes `visibility` in its place,
// where the surface at the pixel's centre is within reach. Of a strip of rows they write its own.
// `begin` makes `lists` of a frame empty. Then, light by light: `mark` writes into `counts` how many entries
// there are, then a 1 for each tile that some light reaches; prefix_scan makes `offsets` of them; `emit`
// appends an entry for each such tile and links it. What has no room is not written: its tile says so, and
// `need` how many entries there are.
//
// `lists`: needed entries, their capacity, tiles across, tiles; two words a tile: its first entry (from 1 on,
// 0: none; TILE_LACKS: one had no room) and its last; ENTRY words an entry: number of the light, next
// entry of its tile (0: none), 16 words as in `shares`.

//@import frame dispatch facet facing vertex strip light_part light_reach

override WORDS: u32 = 1u;
const WORKGROUP = 64u;
const LIST_HEAD = 4u;
const LIST_ENTRY = 18u;
const TILE_LACKS = 0x80000000u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> part: LightPart;
// Two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> samples: array<vec4<f32>, 64>;
@group(0) @binding(3) var<storage, read> facets: array<Facet>;
@group(0) @binding(4) var<storage, read> masks: array<u32>;
@group(0) @binding(5) var<storage, read> pixel_facets: array<u32>;
@group(0) @binding(6) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(8) var<storage, read_write> shares: array<u32>;
@group(0) @binding(9) var<storage, read> id_keys: array<u32>;
@group(0) @binding(10) var<storage, read> visibility: array<f32>;
@group(0) @binding(11) var<storage, read> given: array<u32>;
@group(0) @binding(12) var<storage, read_write> counts: array<u32>;
@group(0) @binding(13) var<storage, read> marks: array<u32>;
@group(0) @binding(14) var<storage, read> offsets: array<u32>;
@group(0) @binding(15) var<storage, read_write> lists: array<u32>;
@group(0) @binding(16) var<storage, read_write> need: array<u32>;

// Lit samples of a facet within reach, and seen ones.
fn facet_share(f: u32, pixel: u32) -> vec2<u32> {
    let state = facets[f].state;
    if state == STATE_EMPTY { return vec2(0u); }
    var seen = 0u;
    var bright = 0u;
    var open = vec4(0u);
    for (var w = 0u; w < WORDS; w++) {
        let base = 3u * WORDS * f + w;
        var counted = masks[base];
        if state == STATE_UNDECIDED { counted &= ~masks[base + 2u * WORDS]; }
        seen += countOneBits(counted);
        if state == STATE_LIT { open[w] = counted; }
        if state == STATE_UNDECIDED { open[w] = counted & ~masks[base + WORDS]; }
        bright += countOneBits(open[w]);
    }
    if bright == 0u || part.everywhere != 0u { return vec2(bright, seen); }
    let plane = plane_of(facets[f].triangle);
    let reach = reach_of(plane, pixel);
    if reach == REACH_ALL { return vec2(bright, seen); }
    bright = 0u;
    if reach == REACH_SOME {
        for (var w = 0u; w < WORDS; w++) {
            bright += countOneBits(reached_in(plane, pixel, w, open[w]));
        }
    }
    return vec2(bright, seen);
}

// Byte of a pixel.
fn pixel_share(pixel: u32) -> u32 {
    var sum = vec2(0u);
    let end = min(pixel_facets[pixel + 1u], arrayLength(&facets));
    for (var f = pixel_facets[pixel]; f < end; f++) { sum += facet_share(f, pixel); }
    if sum.x == 0u { return 0u; }
    // The nearest 255th, of two the greater.
    return (510u * sum.x + sum.y) / (2u * sum.y);
}

fn centre_share(pixel: u32) -> u32 {
    let t = ~id_keys[pixel];
    if t == NO_TRIANGLE { return 0u; }
    let reached = part.everywhere != 0u || reaches(plane_of(t), pixel_ray(pixel));
    return select(0u, pack4x8unorm(vec4(visibility[pixel], 0.0, 0.0, 0.0)), reached);
}

// First pixel of four of one row that a word of `shares` holds, and whether there are such in the strip.
struct Four {
    pixel: u32,
    count: u32,  // 0: not of the strip
    word: u32,
}

fn four_of(index: u32) -> Four {
    let across = (frame.image_size.x + 3u) >> 2u;
    let at = divided(index, across);
    if at.x >= frame.image_size.y || !is_own(at.x) { return Four(0u, 0u, 0u); }
    let first = at.y << 2u;
    let texel = texel_of_image(vec2(first, at.x));
    let tile = (texel.y >> 3u) * part.tiles_across + (texel.x >> 3u);
    let word = (tile << 4u) + ((texel.y & 7u) << 1u) + ((texel.x >> 2u) & 1u);
    return Four(at.x * frame.image_size.x + first, min(4u, frame.image_size.x - first), word);
}

@compute @workgroup_size(WORKGROUP)
fn share(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let four = four_of(flat_invocation(group, groups, WORKGROUP, local));
    if four.count == 0u { return; }
    var bytes = 0u;
    for (var k = 0u; k < four.count; k++) { bytes |= pixel_share(four.pixel + k) << (8u * k); }
    shares[four.word] = bytes;
}

@compute @workgroup_size(WORKGROUP)
fn share_centres(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let four = four_of(flat_invocation(group, groups, WORKGROUP, local));
    if four.count == 0u { return; }
    var bytes = 0u;
    for (var k = 0u; k < four.count; k++) { bytes |= centre_share(four.pixel + k) << (8u * k); }
    shares[four.word] = bytes;
}

@compute @workgroup_size(WORKGROUP)
fn begin(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let tile = flat_invocation(group, groups, WORKGROUP, local);
    if tile >= part.tiles { return; }
    lists[LIST_HEAD + 2u * tile] = 0u;
    lists[LIST_HEAD + 2u * tile + 1u] = 0u;
    if tile != 0u { return; }
    lists[0] = 0u;
    lists[1] = part.capacity;
    lists[2] = part.tiles_across;
    lists[3] = part.tiles;
}

@compute @workgroup_size(WORKGROUP)
fn mark(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let tile = flat_invocation(group, groups, WORKGROUP, local);
    if tile >= part.tiles { return; }
    var any_lit = 0u;
    for (var w = 0u; w < 16u; w++) { any_lit |= given[(tile << 4u) + w]; }
    counts[tile + 1u] = select(0u, 1u, any_lit != 0u);
    if tile == 0u { counts[0] = lists[0]; }
}

// The scan begins at the number of entries that there are already.
@compute @workgroup_size(WORKGROUP)
fn emit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = flat_invocation(group, groups, WORKGROUP, local);
    let tile = index >> 4u;
    let word = index & 15u;
    if tile >= part.tiles { return; }
    let listed = marks[tile + 1u];
    let entry = offsets[tile + 1u];
    if word == 0u && tile + 1u == part.tiles {
        lists[0] = entry + listed;
        need[0] = entry + listed;
    }
    if listed == 0u { return; }
    let head = LIST_HEAD + 2u * tile;
    if entry >= part.capacity {
        if word == 0u { lists[head] |= TILE_LACKS; }
        return;
    }
    let entries = LIST_HEAD + 2u * part.tiles;
    let at = entries + LIST_ENTRY * entry;
    lists[at + 2u + word] = given[(tile << 4u) + word];
    if word != 0u { return; }
    lists[at] = part.light;
    lists[at + 1u] = 0u;
    let last = lists[head + 1u];
    lists[head + 1u] = entry + 1u;
    if last == 0u {
        lists[head] = entry + 1u;
    } else {
        lists[entries + LIST_ENTRY * (last - 1u) + 1u] = entry + 1u;
    }
}
