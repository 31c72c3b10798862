// Facets of surfaces that only receive: their triangles stand behind those of the casters and cast nothing.
// Proofs about the casters' own surfaces (front_split) do not hold for them: they may lie anywhere between
// two layers, cut through them, and lie far outside the box of the casters.

//@import frame pixel_ray facing facet rect front_split
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> splits: array<f32>;

fn only_receives(triangle: u32) -> bool {
    return triangle >= frame.triangle_count;
}

// How many times farther from the eye than the unit cube, to which the frame's margins belong, a facet
// reaches within its pixel; at least 1.
fn reach_beyond(pixel: u32, span: vec4<f32>, plane: vec4<f32>, limit: f32) -> f32 {
    var reach = 1.0;
    for (var k = 0u; k < 4u; k++) {
        let ray = ray_at(pixel, vec2(select(span.x, span.z, (k & 1u) != 0u), select(span.y, span.w, k > 1u)));
        let over = dot(plane.xyz, ray);
        let depth = select(limit, min(plane.w / over, limit), over < 0.0);
        reach = max(reach, depth * largest(ray));
    }
    return reach;
}

// The margin in texels of such a facet.
fn margin_beyond(reach: f32) -> f32 {
    return 0.015625 + (frame.map_margin - 0.015625) * reach;
}

const MOST_SPLITS = 256u;

// The state of a facet that only receives, none of whose texels is marked: lit where no caster is in any,
// shadowed where it lies behind the sheet in front of each; `inside` where all of it lies on the map.
fn behind_splits(rect: Rect, nearest: f32, inside: bool) -> u32 {
    let cells = rect.high - rect.low + 1u;
    if cells.x > MOST_SPLITS || cells.x * cells.y > MOST_SPLITS { return STATE_UNDECIDED; }
    var clear = true;
    var behind = inside;
    for (var k = 0u; k < cells.x * cells.y && (clear || behind); k++) {
        let split = splits[(rect.low.y + k / cells.x) * frame.map_size + rect.low.x + k % cells.x];
        clear = clear && split == UNCOVERED;
        behind = behind && split >= 0.0 && split < nearest;
    }
    return select(select(STATE_UNDECIDED, STATE_SHADOWED, behind), STATE_LIT, clear);
}
