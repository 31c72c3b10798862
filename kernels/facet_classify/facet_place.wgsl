// Classes of facets that their place in the light view tells (facet_classify).

//@import frame rect facet facing roles front_split only_receiver summed_area facet_samples facet_extent
//@needs override RECEIVERS: u32;
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> splits: array<f32>;
//@needs var<storage, read_write> facets: array<Facet>;
//@needs var<storage, read_write> undecided: array<Undecided>;
//@needs var<storage, read_write> facet_items: array<atomic<u32>>;

// Geometry of a facet.
struct Found {
    extent: FacetExtent,
    low: vec2<f32>,    // box of its outline, margins included
    high: vec2<f32>,
    farthest: f32,
    rect: vec2<u32>,
    span: vec2<u32>,
    here: bool,
}

// Finds where a facet of a triangle lies that turns to light and eye as told, and what is known of it. What
// is stored is stored in one place: vector machines pay for each store in the text, whichever lanes take it.
fn place(f: u32, shape: Shape, turns: vec2<f32>) {
    var found: Found;
    let merged = is_merged(f);
    var state = state_of(f, shape, turns, merged, &found);
    if (frame.flags & FLAG_FURTHER_VIEW) != 0u {
        // Settled in one view it is so; to be evaluated in one, though there is nothing before it in another.
        let known = facets[f].state & ~WAS_MERGED;
        if (known & (WAS_SETTLED | WAS_HELD)) != 0u || state == STATE_LIT {
            state = known;
            found.here = false;
        }
    }
    // To be evaluated in this view.
    let is_here = ((state & STATE_BITS) == STATE_UNDECIDED) & found.here;
    let rect = select(EMPTY_RECT, found.rect, is_here);
    if (frame.flags & FLAG_MORE_VIEWS) != 0u {
        if merged { state |= WAS_MERGED; }
    } else {
        state &= STATE_BITS;
    }
    facets[f].state = state;
    atomicStore(&facet_items[f], block_count(rect));
    if !is_here { return; }
    let e = found.extent;
    let a = shape.a;
    let normal = e.plane.xyz;
    // One Newton step takes the rounding of the quotient out of the point.
    let over = dot(normal, e.ray);
    let raw = e.ray * e.depth;
    let at = raw - e.ray * (dot(normal, raw - a) / over);
    // Products that each component of the normal is the difference of. Of two million normals of random
    // triangles none was farther off, along any direction, than 3.3 times the rounding of these.
    let products = abs(shape.ab.yzx * shape.ac.zxy) + abs(shape.ab.zxy * shape.ac.yzx);
    let tilts = (4.0 * power_of_two(cross(shape.ab, shape.ac))) * products;
    let tilt = largest(tilts);
    let alone = is_clamped() & !merged & ((frame.flags & FLAG_BEYOND) == 0u);
    let doubt = 5.9604645e-8 * (3.0 * largest(at) + dot(tilts, abs(at - a)));
    let shares = select(vec3(0u), vec3<u32>(tilts / tilt * 254.0) + 1u, tilts > vec3(0.0));
    let flags = select(0u, FACET_ALONE, alone) | select(0u, FACET_AWAY, turns.x < 0.0);
    undecided[f] = Undecided(e.plane, facets[f].pixel, shape.triangle, rect, found.farthest, e.limit,
        facets[f].origin, at, doubt, found.low, found.high, light_slope(e.plane), tilt,
        shares.x | (shares.y << 8u) | (shares.z << 16u) | flags, found.span);
}

// Whether the light may shine along a triangle in the world, to what rounding mapped corners leaves open.
fn is_grazed(shape: Shape) -> bool {
    let way = frame.light.xyz - frame.light.w * shape.a;
    let reach = max(largest(shape.a), max(largest(shape.b), largest(shape.c)));
    let la = largest(shape.ab);
    let lc = largest(shape.ac);
    let bound = largest(way) * (1e-6 * la * lc + 2e-7 * reach * (la + lc));
    return abs(dot(cross(shape.ab, shape.ac), way)) <= bound;
}

fn state_of(f: u32, shape: Shape, turns: vec2<f32>, merged: bool, found: ptr<function, Found>) -> u32 {
    if !receives_any(shape.given.w) { return STATE_LIT; }
    let away = turns.x * select(1.0, -1.0, is_reversed(shape.given.xyz, shape.i)) < 0.0;
    if turns.x * turns.y <= 0.0 || (away && (frame.flags & FLAG_CLOSED) != 0u) { return STATE_DARK; }
    if (frame.flags & FLAG_MAPPED) != 0u && is_grazed(shape) { return STATE_DARK; }
    // Of what is no caster the splits know nothing.
    let hidden = away & (shape.given.w == 1u) & ((frame.flags & FLAG_CULL_BACK) != 0u);
    let pixel = facets[f].pixel;
    var span = vec2(0u);
    if is_clamped() { span = facets[f].span; }
    let e = extent_of(f, part_of(span), shape, turns.x, merged);
    let outline = e.outline;
    if !is_clamped() && !outline.whole { keep_own_triangle(f, shape.given.xyz, pixel_ray(pixel)); }
    if (frame.flags & FLAG_NOTHING_CASTS) != 0u { return STATE_LIT; }
    let low = select(vec2(-3.0e38), outline.low, outline.known);
    let high = select(vec2(3.0e38), outline.high, outline.known);
    var farthest = select(3.0e38, outline.farthest, outline.in_front & !hidden);
    var nearest = outline.nearest;
    var margin = frame.map_margin;
    let receives = RECEIVERS != 0u && only_receives(shape.triangle);
    if receives {
        let reach = reach_beyond(pixel, part_of(span), e.plane, e.limit);
        let perspective = (frame.flags & FLAG_PERSPECTIVE) != 0u;
        if perspective && outline.ahead + 2e-6 * reach < frame.eye_low.w { return STATE_LIT; }
        margin = margin_beyond(reach);
        farthest += frame.depth_margin * reach;
        nearest -= frame.depth_margin * (reach + 1.0);
    }
    let lit_outside = (frame.flags & FLAG_NO_VIEW) == 0u;
    if lies_beside(outline) && lit_outside { return STATE_LIT; }
    var rect = texels_of(outline, margin);
    if is_empty(rect) {
        if lit_outside { return STATE_LIT; }
        rect = pack_rect(Rect(vec2(0u), vec2(0u)));
    }
    // A facet partly beyond one of several views is not settled in that one.
    let inside = all((low >= vec2(margin)) & (high <= vec2(f32(frame.map_size) - margin)));
    let whole = inside || (frame.flags & FLAG_ONE_OF_SEVERAL) == 0u;
    if (frame.flags & FLAG_ALL_UNDECIDED) == 0u && outline.in_front && whole && !hidden {
        let r = unpack_rect(rect);
        let unmarked = rect_sum(vec2(frame.map_size), r.low, r.high) == 0u;
        if unmarked && receives {
            let state = behind_splits(r, nearest, inside);
            if state != STATE_UNDECIDED { return state | WAS_SETTLED; }
        } else if unmarked {
            let p = from_lamp(e.ray * e.depth);
            var uvz = vec3(dot(frame.map_u, p), dot(frame.map_v, p), dot(frame.map_z, p));
            if (frame.flags & FLAG_PERSPECTIVE) != 0u { uvz /= dot(frame.map_w, p); }
            let texel = floor(uvz.xy);
            if all((texel >= vec2(0.0)) & (texel < vec2(f32(frame.map_size)))) {
                let split = splits[u32(texel.y) * frame.map_size + u32(texel.x)];
                return WAS_SETTLED | select(STATE_SHADOWED, STATE_LIT,
                    (split == UNCOVERED) | (uvz.z < split));
            }
        }
    }
    *found = Found(e, low - margin, high + margin, farthest, rect, span, true);
    return select(STATE_UNDECIDED, STATE_UNDECIDED | WAS_HELD, inside && outline.known);
}

// Depth from the light over texels on a plane, as (per x, per y, at 0) and how far it may be off.
fn light_slope(plane: vec4<f32>) -> vec4<f32> {
    let p = vec4(plane.xyz, -plane.w);
    let z = dot(p, frame.back_z);
    let s = vec3(dot(p, frame.back_u), dot(p, frame.back_v), dot(p, frame.back_w)) / -z;
    // Rounding of the products, over a map's width, and of the texels of what is compared with it.
    let noise = 1e-6 * (dot(abs(p), abs(frame.back_u)) * f32(frame.map_size)
        + dot(abs(p), abs(frame.back_v)) * f32(frame.map_size)
        + dot(abs(p), abs(frame.back_w)) + dot(abs(p), abs(frame.back_z))) / abs(z);
    let off = noise + (abs(s.x) + abs(s.y)) * frame.map_margin + frame.depth_margin;
    return vec4(s, select(3.0e38, off, off < 3.0e38));
}
