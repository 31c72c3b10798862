// The blocks of texels that casters are rasterized in for the sub-pixel shadow map.

//@import spsm_bindings rect work_items cover_cells spsm_record spsm_cut seen_texels
//@needs fn held_depth(cell: u32) -> u32;

const TIE = 1e-5;   // of depth
const LIFT = 2.0;   // times its own range of depths by which a triangle may count as nearer than it is
const PASS_AGAIN = 1u;  // the triangles at depths already found
const PASS_LAST = 2u;   // of the texels asked for last

// Where the bits of the texels begin that this run makes.
fn run_bits() -> u32 {
    return SEEN_BITS + select(0u, seen_words(), (step.index & PASS_LAST) != 0u);
}

// Least depth of the plane over the texel as a key that falls with it, whatever its sign. The plane of a
// triangle that is almost edge-on is nearest: it is at the border of what it belongs to, and the texel shall
// hold the border. LIFT keeps what is far behind from coming before what hides it.
fn least_at(shape: Cover, centre: vec2<f32>) -> f32 {
    let least = dot(shape.depth, vec3(centre, 1.0)) - shape.half_range;
    let first = shape.nearest - LIFT * (shape.farthest - shape.nearest);
    return select(max(least, first), first, shape.thin);
}

fn key_of(depth: f32) -> u32 {
    let bits = bitcast<u32>(depth);
    return select(bits, ~(bits | 0x80000000u), (bits >> 31u) == 0u);
}

fn cover_of(t: u32) -> Cover {
    let i = triangles[t];
    let a = map_points[i.x];
    let b = map_points[i.y];
    let c = map_points[i.z];
    var shape = cover_triangle_by(a, b, c, place_noise());
    // Corners that are cut off at the light have no code: only lines hold the rest. A loop that few enter.
    let held = shape.in_front && ENCODING == 1u;
    for (var cut = shape.cut && held; cut; cut = false) {
        let part = cut_shape(a, b, c);
        let slope = abs(part.depth.x) + abs(part.depth.y);
        shape.depth = part.depth;
        shape.half_range = shape.reach * slope + frame.depth_margin;
        shape.nearest = part.nearest;
        shape.farthest = part.farthest;
    }
    shape.in_front = !shape.cut || held;
    return shape;
}

// A triangle in a block, and the texels there that it touches and that are asked for.
struct Task {
    t: u32,
    corner: vec2<u32>,
    shape: Cover,
    left: vec2<u32>,
}

fn task_of(item: u32) -> Task {
    let slot = slot_of(item, frame.triangle_count);
    let t = owner_in(slot, frame.triangle_count);
    let block = block_of(light_rects[t], item - work_offsets[slot]);
    let shape = cover_of(t);
    let corner = block.low & vec2(~7u);
    let word = run_bits() + seen_place(corner).x;
    let asked = vec2(atomicLoad(&seen[word]), atomicLoad(&seen[word + 1u]));
    var left = vec2(0u);
    if shape.in_front { left = cover_cells(shape, block, rows_of(asked)) & asked; }
    return Task(t, corner, shape, left);
}

// Of the texels those in which the triangle may be nearest of all that have come; another of the same depth
// may have a lower index. Keys are raised in a loop of their own, of few turns: its depths may be rounded
// otherwise, by far less than TIE.
fn may_win(task: Task) -> vec2<u32> {
    var left = task.left;
    var bits = vec2(0u);
    while any(left != vec2(0u)) {
        let place = take_texel(&left);
        let at = task.corner + place;
        let centre = vec2<f32>(at) + 0.5;
        if !covers(task.shape, centre) { continue; }
        if held_depth(at.y * frame.map_size + at.x) <= key_of(least_at(task.shape, centre) - TIE) {
            add_texel(&bits, place);
        }
    }
    return bits;
}
