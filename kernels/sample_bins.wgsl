// sample_bins: alias-free hard shadows (Aila and Laine 2004; Johnson et al. 2005; Sintorn, Eisemann,
// Assarsson 2008): the samples themselves are sorted into the texels of the light view that they project to,
// casters are rasterized conservatively, and each is tested against the samples of the texels it touches.
// `bin` runs twice around a scan: pass 0 counts the samples of each texel, pass 1 writes them to `bins` with
// `texel_ends`, which begin as where each texel starts, as cursors. `occlude` tests them in single precision,
// LANES invocations a block of a caster's texels: it writes the occluded mask of their facets and notes what
// it cannot decide behind the samples in `bins`; `refine` decides that with 46 bits. Samples without room
// there are marked in the place of the invalid mask, and `refine_all` tests them again. Texels of more than
// CROWD samples are left to `occlude_crowds`, a workgroup a block, and tested again by `refine_crowds`. No
// invocation looks at more than one block, nor at more than 65,535 samples: `ask` writes into `wanted` how
// many blocks each of these runs has, none where it has nothing to do, and how many doubts there are. Whoever
// reads invalid masks has to make them afterwards. The model and its predicates are those of shadow_rays. The
// facets of a band are those listed from `frame.first_facet` on; a band without any costs nothing worth
// naming. Behind the texels in `texel_ends`: doubts; crowded texels; then the facets of the band. A sample
// whose point is not before the light, or outside its view, has no caster before it, but for beyond the ends
// of the map (FLAG_ENDS): there it is sorted into the texels at them, in which casters that go beyond are
// tested, too.
//@bindings Bins: bin, ask, occlude, occlude_crowds, refine, refine_all, refine_crowds

//@import frame dispatch pass rect work_items conservative span facet facing double_float vertex facing_46
//@import map_ends from_lamp

override WORDS: u32 = 1u;
const WORKGROUP = 64u;
const LANES = 8u;
const MOST_SAMPLES = 2097152u;  // of a band
const CROWD = 2048u;            // 64 texels of a block, LANES at a time, looked at twice

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<uniform> step: Pass;
@group(0) @binding(3) var<storage, read> undecided: array<Undecided>;
@group(0) @binding(4) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> positions: array<vec3<f32>>;
// Coverage, occluded, in doubt: WORDS words each
@group(0) @binding(6) var<storage, read_write> masks: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> texel_ends: array<atomic<u32>>;
// A point, `label`; doubts: which sample, triangle
@group(0) @binding(8) var<storage, read_write> bins: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read> light_rects: array<vec2<u32>>;
@group(0) @binding(10) var<storage, read> work_offsets: array<u32>;
@group(0) @binding(11) var<storage, read> listed: array<u32>;       // undecided facets
@group(0) @binding(12) var<storage, read> listed_total: array<u32>;
@group(0) @binding(13) var<storage, read_write> wanted: array<u32>;  // blocks of four runs, doubts

//@import frame_copy

//@import shadow_lines shadow_lines_46 shadow_ray mesh_caster bin_tests

// Texel x, y, depth of a point, and its distance along the axis of the light view; where that is not surely
// in front, as vertex_project has it: undivided, and how far it lies behind the nearest distance.
fn in_light_view(p: vec3<f32>) -> vec4<f32> {
    let q = from_lamp(p);
    let uvz = vec3(dot(frame.map_u, q), dot(frame.map_v, q), dot(frame.map_z, q));
    if (frame.flags & FLAG_PERSPECTIVE) == 0u { return vec4(uvz, 1.0); }
    let w = dot(frame.map_w, q);
    if w > frame.light_low.w { return vec4(uvz / w, w); }
    return vec4(uvz, min(w - frame.light_low.w, 0.0));
}

// A sample of the band in 22 bits, and above them how far rounding may have moved its point, rounded up.
fn label(index: u32, moved: f32) -> u32 {
    return index | (((bitcast<u32>(moved) >> 21u) + 1u) << 22u);
}

@compute @workgroup_size(WORKGROUP)
fn bin(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let index = flat_invocation(group, groups, WORKGROUP, local);
    let slot = index / frame.sample_count;
    let k = index % frame.sample_count;
    if slot >= frame.facet_count || frame.first_facet + slot >= listed_total[0] { return; }
    let f = listed[frame.first_facet + slot];
    if k == 0u { atomicStore(&texel_ends[facet_place(slot)], f); }
    if ((atomicLoad(&masks[3u * WORDS * f + (k >> 5u)]) >> (k & 31u)) & 1u) == 0u { return; }
    let r = ray_of_sample(ground_of(f), k);
    let at = in_light_view(r.at);
    let size = f32(frame.map_size);
    let over = select(vec4(0u), vec4(1u, 2u, 4u, 8u),
        !(vec4(at.x, -at.x, at.y, -at.y) > vec4(-1.0, -size - 1.0, -1.0, -size - 1.0)));
    let sides = (over.x | over.y | over.z | over.w) * FLAG_ENDS;
    if !r.meets || !(at.w > 0.0) || (sides & ~frame.flags) != 0u { return; }
    let cell = vec2<u32>(clamp(at.xy, vec2(0.0), vec2(size - 1.0)));
    let texel = cell.y * frame.map_size + cell.x;
    let place = atomicAdd(&texel_ends[texel], 1u);
    if step.index == 1u {
        bins[place] = vec4(bitcast<vec3<u32>>(r.at), label(index, r.moved));
    } else if place == CROWD {
        atomicAdd(&texel_ends[frame.map_size * frame.map_size + 1u], 1u);
    }
}

@compute @workgroup_size(1)
fn ask() {
    take_frame(0u);
    let map = frame.map_size * frame.map_size;
    let doubtful = atomicLoad(&texel_ends[map]);
    let blocks = select(0u, work_offsets[frame.triangle_count], atomicLoad(&texel_ends[map - 1u]) != 0u);
    let crowded = select(0u, blocks, atomicLoad(&texel_ends[map + 1u]) != 0u);
    let overfull = doubtful > doubts().y;
    wanted[0] = blocks;
    wanted[1] = crowded;
    wanted[2] = min(doubtful, doubts().y);
    wanted[3] = select(0u, blocks, overfull);
    wanted[4] = select(0u, crowded, overfull);
}

fn raster(item: u32, lane: u32, exact: bool, crowds: bool) {
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[slot]);
    let c = caster_of(t);
    let p = in_light_view(c.at);
    let q = in_light_view(point_of(c.vertices.y));
    let r = in_light_view(point_of(c.vertices.z));
    let shape = cover_triangle(p, q, r);
    // Few blocks are at an end, and few triangles go beyond: a loop that the others do not enter.
    let at_ends = ends_at(block.low, block.high, frame.map_size) != 0u;
    for (var some = at_ends && ends_of_triangle(p, q, r) != 0u; some; some = false) {
        for (var y = block.low.y; y <= block.high.y; y++) {
            for (var x = block.low.x; x <= block.high.x; x++) {
                if ends_at(vec2(x, y), vec2(x, y), frame.map_size) == 0u { continue; }
                let texel = y * frame.map_size + x;
                if crowds {
                    test_crowd(texel, t, c, lane, exact);
                } else {
                    test_texel(texel, t, c, lane, exact);
                }
            }
        }
    }
    for (var y = block.low.y; y <= block.high.y; y++) {
        let row = f32(y) + 0.5;
        var span = span_of(block.low.x, block.high.x);
        if shape.in_front && !shape.thin {
            span = cut_span(cut_span(cut_span(span, shape.edges[0], row), shape.edges[1], row),
                shape.edges[2], row);
        }
        let cells = cells_of(span, block.low.x, block.high.x);
        for (var x = cells.x; x <= cells.y; x++) {
            if !covers(shape, vec2(f32(x) + 0.5, row)) { continue; }
            let texel = y * frame.map_size + x;
            if crowds { test_crowd(texel, t, c, lane, exact); } else { test_texel(texel, t, c, lane, exact); }
        }
    }
}

// The block of an invocation, LANES of which take one, or of all of a workgroup; none left: false.
fn is_block(item: u32) -> bool {
    return item < work_offsets[frame.triangle_count];
}

@compute @workgroup_size(WORKGROUP)
fn occlude(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_group(group, groups) * (WORKGROUP / LANES) + local / LANES;
    if is_block(item) { raster(item, local % LANES, false, false); }
}

@compute @workgroup_size(WORKGROUP)
fn occlude_crowds(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_group(group, groups);
    if is_block(item) { raster(item, local, false, true); }
}

@compute @workgroup_size(WORKGROUP)
fn refine(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let room = doubts();
    let n = flat_invocation(group, groups, WORKGROUP, local);
    if n >= min(atomicLoad(&texel_ends[frame.map_size * frame.map_size]), room.y) { return; }
    let doubt = bins[room.x + n];
    let index = doubt.x;
    let f = facet_of(index);
    let k = index % frame.sample_count;
    if is_set(f, 1u, k) { return; }
    let g = ground_of(f);
    if blocks_46(g, offset_of(k), doubt.y) == BLOCKED { mark(f, 1u, k); }
}

@compute @workgroup_size(WORKGROUP)
fn refine_all(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_group(group, groups) * (WORKGROUP / LANES) + local / LANES;
    if is_block(item) { raster(item, local % LANES, true, false); }
}

@compute @workgroup_size(WORKGROUP)
fn refine_crowds(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let item = flat_group(group, groups);
    if is_block(item) { raster(item, local, true, true); }
}
