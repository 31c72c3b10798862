// Samples of one texel of the light view, judged by the triangles around it and the border that links their
// outer edges (Lecocq 2013, section 4.2).

//@import receiver spsm_record spsm_sheet spsm_border spsm_search
//@needs override WORDS: u32;
//@needs override MANY: u32;
//@needs override RADIUS: i32;
//@needs override STRETCH: i32;
//@needs override SQUARE: i32;
//@needs override RECOVERY: u32;
//@needs var<uniform> patterns: array<vec4<u32>, 512>;

// Parts of a pixel that the search needs: the place of its centre, which is on the triangle, and which
// samples are.
struct Around {
    middle: vec4<f32>,
    own: vec4<u32>,
}

// Samples for which the sheet of texel `here` counts. Beside its triangle a receiver's plane may run below
// the surface that is there, into a hollow: such a neighbour lies before the plane at the sample, but not at
// the pixel's centre.
fn counting(s: Sheet, r: Receiver, here: vec2<i32>, around: Around) -> vec4<u32> {
    if MANY == 0u { return vec4(0xffffffffu); }
    let there = around.middle.xy - middle_of(here);
    let doubt = doubt_at(s, there) + step_doubt(s.depth.xy - r.slope) + bias_of(r);
    return select(around.own, vec4(0xffffffffu), around.middle.z > dot(s.depth, vec3(there, 1.0)) + doubt);
}

// Samples of `open` that the sheet of the texel around `centre` shadows.
fn hits_of(
    s: Sheet,
    r: Receiver,
    pixel: u32,
    at: vec4<f32>,
    centre: vec2<f32>,
    open: vec4<u32>,
) -> vec4<u32> {
    var dark = vec4(0u);
    if MANY == 0u {
        dark.x = select(0u, open.x, s.held && shadows(s, vec3(at.xy - centre, at.z), r));
        return dark;
    }
    for (var w = 0u; w < WORDS; w++) {
        for (var left = select(0u, open[w], s.held); left != 0u; left &= left - 1u) {
            let place = sample_place(r, pixel, 32u * w + firstTrailingBit(left));
            let hit = shadows(s, vec3(place.xy - centre, place.z), r);
            dark[w] |= select(0u, left & (0u - left), hit);
        }
    }
    return dark;
}

fn add_piece(p: Piece, gap: vec3<f32>, offset: vec2<f32>) {
    // An edge behind the receiver throws no shadow on it.
    let nearer = dot(gap, vec3(0.5 * (p.start + p.end), 1.0)) < 0.0;
    if p.some && nearer {
        pieces[piece_count] = vec4(p.start + offset, p.end + offset);
        piece_count++;
    }
}

// Samples of `group`, all in one texel, that are in shadow; `at` is the place of sample `first` of them.
fn shadowed_of(
    r: Receiver,
    pixel: u32,
    texel: vec2<i32>,
    at: vec4<f32>,
    first: u32,
    group: vec4<u32>,
    around: Around,
) -> vec4<u32> {
    let bit = vec4(1u << (first & 31u))
        & select(vec4(0u), vec4(0xffffffffu), vec4(0u, 1u, 2u, 3u) == vec4(first >> 5u));
    var mask = 0u;
    for (var k = 0; k < 9; k++) {
        let here = texel + vec2(k % 3 - 1, k / 3 - 1);
        let s = sheet_at(here);
        let counts = any((bit & counting(s, r, here, around)) != vec4(0u));
        mask |= select(0u, 1u << u32(k), counts && before_place(s, r, at, middle_of(here)));
    }
    if (mask & 16u) == 0u { return vec4(0u); }
    let pattern = patterns[mask];
    var dark = vec4(0u);
    let centre = middle_of(texel);
    piece_count = 0u;
    for (var k = 0; k < SQUARE * SQUARE; k++) {
        let step = square_step(k);
        let here = texel + step;
        let s = sheet_at(here);
        dark |= hits_of(s, r, pixel, at, middle_of(here), group & ~dark & counting(s, r, here, around));
        let inner = max(abs(step.x), abs(step.y)) <= 1;
        var linked = s.held && (!inner || (pattern.z & (1u << u32(max(3 * step.y + step.x + 4, 0)))) != 0u);
        if RADIUS > 1 {
            let counts = any((bit & counting(s, r, here, around)) != vec4(0u));
            linked = linked && (inner || (counts && before_place(s, r, at, middle_of(here))));
        }
        if !linked { continue; }
        let offset = middle_of(here) - centre;
        let gap = s.depth - receiver_around(r, at, middle_of(here));
        add_piece(piece_of(s.edges[0], s.edges[1], s.edges[2], -offset, 1.5), gap, offset);
        add_piece(piece_of(s.edges[1], s.edges[2], s.edges[0], -offset, 1.5), gap, offset);
        add_piece(piece_of(s.edges[2], s.edges[0], s.edges[1], -offset, 1.5), gap, offset);
    }
    // Along the tangents triangles are only tested: linking their edges too makes the border too wide.
    if STRETCH > 0 {
        for (var k = 0; k < 2 * STRETCH * i32(pattern.y); k++) {
            let here = texel + tangent_step(k, pattern);
            let s = sheet_at(here);
            dark |= hits_of(s, r, pixel, at, middle_of(here), group & ~dark & counting(s, r, here, around));
        }
    }
    if RECOVERY == 1u && pattern.w == 1u { return group; }
    if RECOVERY == 0u || pattern.y == 0u { return dark; }
    for (var w = 0u; w < WORDS; w++) {
        for (var left = group[w] & ~dark[w]; left != 0u; left &= left - 1u) {
            let place = sample_place(r, pixel, 32u * w + firstTrailingBit(left)).xy - centre;
            var open = false;
            for (var n = 0u; n < pattern.y; n++) {
                open = open || beyond_border(place, normalize(vec2<f32>(towards_lit(pattern, n))));
            }
            dark[w] |= select(left & (0u - left), 0u, open);
        }
    }
    return dark;
}
