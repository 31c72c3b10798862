// summed_area: summed-area table of a map of counts or of bits.
// Reads `texels`: one u32 a texel, or (override PACKED) one bit a texel, bit x % 32 of word x / 32 of its
// row, each row padded to whole words (padding bits may hold anything). Writes `sat`, see summed_area.wgsl.
// `rows` sums along each row, but stores only one partial sum a word (or 4 texels); `strips` sums each column
// over each strip of rows; `columns` runs down the strips from the sums above them and writes the table once.
// With one strip, `strips` is left out; `columns_ragged` is `columns` for widths that are no multiple of
// four. `query` reads `rects` and writes the sum over each into `rect_sums`. A table above the binding limit
// is bound in bands of whole strips. Bounds: an invocation loops over a row's words, or over a strip's rows
// and the strips above: at most 4,096 each.

//@import dispatch summed_area

struct SummedAreaParams {
    width: u32,
    height: u32,
    row_words: u32,     // partial sums a row: words of a packed row, else quads of texels
    strip_rows: u32,
    first_row: u32,     // first row of the bound band
    rows: u32,          // rows of the bound band
    rects: u32,         // rectangles to query
    pad: u32,
}

const WORKGROUP = 64u;
const MAX_STRIP_ROWS = 4096u;
const MAX_SIDE = 16384u;

override PACKED: bool = true;

@group(0) @binding(0) var<uniform> params: SummedAreaParams;
@group(0) @binding(1) var<storage, read> texels: array<u32>;
@group(0) @binding(2) var<storage, read_write> row_sums: array<u32>;
@group(0) @binding(3) var<storage, read_write> strip_sums: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> sat: array<u32>;
@group(0) @binding(4) var<storage, read_write> sat_quads: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> rects: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read_write> rect_sums: array<u32>;

// Texels 4 * quad .. 4 * quad + 3 of a row of the bound band; 0 beyond the width.
fn quad_texels(row: u32, quad: u32) -> vec4<u32> {
    let x = quad * 4u;
    let at = row * params.width + x;
    var t = vec4(texels[at], 0u, 0u, 0u);
    if x + 3u < params.width { return vec4(t.x, texels[at + 1u], texels[at + 2u], texels[at + 3u]); }
    if x + 1u < params.width { t.y = texels[at + 1u]; }
    if x + 2u < params.width { t.z = texels[at + 2u]; }
    return t;
}

// Sums along a row of the bound band, from its begin to each of the four texels of a quad.
fn row_prefix(row: u32, quad: u32) -> vec4<u32> {
    let partial = (params.first_row + row) * params.row_words;
    if PACKED {
        let word = texels[row * params.row_words + quad / 8u];
        let shift = quad % 8u * 4u;
        let bits = (vec3(word) >> vec3(shift + 1u, shift + 2u, shift + 3u)) & vec3(1u);
        let x = row_sums[partial + quad / 8u] + countOneBits(word & ((2u << shift) - 1u));
        return vec4(x, x + bits.x, x + bits.x + bits.y, x + bits.x + bits.y + bits.z);
    }
    let t = quad_texels(row, quad);
    let x = row_sums[partial + quad] + t.x;
    return vec4(x, x + t.y, x + t.y + t.z, x + t.y + t.z + t.w);
}

@compute @workgroup_size(WORKGROUP)
fn rows(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) local: u32) {
    let row = flat_invocation(group, groups, WORKGROUP, local);
    if row >= params.rows { return; }
    let partial = (params.first_row + row) * params.row_words;
    var sum = 0u;
    for (var i = 0u; i < params.row_words; i++) {
        row_sums[partial + i] = sum;
        if PACKED {
            sum += countOneBits(texels[row * params.row_words + i]);
        } else {
            let t = quad_texels(row, i);
            sum += t.x + t.y + t.z + t.w;
        }
    }
}

@compute @workgroup_size(WORKGROUP)
fn strips(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) local: u32) {
    let quads = (params.width + 3u) / 4u;
    let id = flat_invocation(group, groups, WORKGROUP, local);
    let begin = id / quads * params.strip_rows;
    if begin >= params.rows { return; }
    var sum = vec4(0u);
    for (var row = begin; row < min(begin + params.strip_rows, params.rows); row++) {
        sum += row_prefix(row, id % quads);
    }
    strip_sums[params.first_row / params.strip_rows * quads + id] = sum;
}

// The strip and quad of columns that an invocation runs down.
struct Column {
    begin: u32,         // first row in the bound band
    end: u32,
    quad: u32,
    above: vec4<u32>,   // sums over the strips above
}

fn column(id: u32) -> Column {
    let quads = (params.width + 3u) / 4u;
    let begin = id / quads * params.strip_rows;
    var c = Column(begin, min(begin + params.strip_rows, params.rows), id % quads, vec4(0u));
    for (var strip = 0u; strip < (params.first_row + begin) / params.strip_rows; strip++) {
        c.above += strip_sums[strip * quads + c.quad];
    }
    return c;
}

// For widths that are multiples of 4.
@compute @workgroup_size(WORKGROUP)
fn columns(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) local: u32) {
    let c = column(flat_invocation(group, groups, WORKGROUP, local));
    var sum = c.above;
    for (var row = c.begin; row < c.end; row++) {
        sum += row_prefix(row, c.quad);
        sat_quads[row * (params.width / 4u) + c.quad] = sum;
    }
}

// For all other widths.
@compute @workgroup_size(WORKGROUP)
fn columns_ragged(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) local: u32) {
    let c = column(flat_invocation(group, groups, WORKGROUP, local));
    var sum = c.above;
    let x = c.quad * 4u;
    for (var row = c.begin; row < c.end; row++) {
        sum += row_prefix(row, c.quad);
        let at = row * params.width + x;
        sat[at] = sum.x;
        if x + 1u < params.width { sat[at + 1u] = sum.y; }
        if x + 2u < params.width { sat[at + 2u] = sum.z; }
        if x + 3u < params.width { sat[at + 3u] = sum.w; }
    }
}

// Sums over inclusive rectangles (x0, y0, x1, y1).
@compute @workgroup_size(WORKGROUP)
fn query(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) local: u32) {
    let id = flat_invocation(group, groups, WORKGROUP, local);
    if id >= params.rects { return; }
    rect_sums[id] = rect_sum(vec2(params.width, params.height), rects[id].xy, rects[id].zw);
}
