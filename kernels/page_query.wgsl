// page_query: depth comparison of every sample with the finest page that there is for it. A pixel asks the
// level that page_requests found for it in thirds, as much coarser as that had to take them; where
// rounding has put a sample beside the pages that were marked, the next coarser page that there is.
// `table` holds the exclusive scan of the pages that are made: the number of each, and by the next offset
// whether it is. A sample is lit where its texel's depth is not less than the receiver's less the bias:
// BIAS_CONSTANT, and BIAS_SLOPE times the steeper of the receiver's two slopes per texel of the page.
// Writes `visibility`: the mean over the samples whose rays meet the receiver.

//@import frame dispatch facing receiver page_tree

const WORKGROUP = 64u;
const THIRDS = 3u;
const TABLE_TAIL = 2u;

override BIAS_CONSTANT: f32 = 0.00002;
override BIAS_SLOPE: f32 = 1.0;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> samples: array<vec4<f32>, 64>;  // two offsets from the pixel centre each
@group(0) @binding(2) var<storage, read> id_keys: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> levels: array<u32>;
@group(0) @binding(6) var<storage, read> table: array<u32>;
@group(0) @binding(7) var<storage, read> pages: array<u32>;
@group(0) @binding(8) var<storage, read_write> visibility: array<f32>;

// 1 where nothing lies before a place on a level; `slope`: the receiver's, depth per texel of the map.
fn lit_at(at: vec3<f32>, asked: u32, slope: f32) -> f32 {
    if any(at.xy < vec2(0.0)) || any(at.xy >= vec2(f32(frame.map_size))) { return 1.0; }
    var level = asked;
    var texel = vec2<u32>(at.xy * scale_of(level));
    var node = node_of(level, texel >> vec2(PAGE_SHIFT));
    var number = table[node];
    while level > 0u && table[node + 1u] == number {
        level -= 1u;
        texel >>= vec2(1u);
        node = node_of(level, texel >> vec2(PAGE_SHIFT));
        number = table[node];
    }
    let depth = at.z - BIAS_CONSTANT - BIAS_SLOPE * slope / scale_of(level);
    let key = pages[number * PAGE_TEXELS + (texel.y % PAGE) * PAGE + texel.x % PAGE];
    return select(0.0, 1.0, key == 0u || bitcast<f32>(~key) >= depth);
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
    let nodes = finest_side() * tree_width();
    let asked = levels[pixel] + THIRDS - 1u;
    let level = (asked - min(asked, table[nodes + TABLE_TAIL])) / THIRDS;
    let slope = max(abs(r.slope.x), abs(r.slope.y));
    var sum = 0.0;
    var seen = 0.0;
    // There is one at least. The loop ends before it begins a turn of which nothing is kept: a vector would
    // wait for it.
    var k = 0u;
    loop {
        let at = sample_place(r, pixel, k);
        if at.w != 0.0 {
            seen += 1.0;
            sum += lit_at(at.xyz, level, slope);
        }
        continuing {
            k++;
            break if k >= frame.sample_count;
        }
    }
    visibility[pixel] = select(sum / seen, 1.0, seen == 0.0);
}
