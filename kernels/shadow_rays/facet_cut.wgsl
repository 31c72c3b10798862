// Triangles that cut a facet within its pixel (Pan 2009, section 3.4, figure 7), and where to look for them.
// `masks` holds coverage, occluded, invalid: WORDS words each.

//@import frame facet facing vertex facing_46 shadow_lines shadow_lines_46 shadow_ray caster_tree leaf_caster
//@needs override WORDS: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> tree: TreePlace;
//@needs var<storage, read> undecided: array<Undecided>;
//@needs var<storage, read_write> masks: array<atomic<u32>>;

// Takes in a triangle that may cut the facet: the samples on the other side of its line than the pixel centre
// see another surface.
fn cut_by(f: u32, g: Ground, k: u32) {
    let c = caster_of(k);
    let near = heights_of(g, c);
    if all(near > vec3(0.0)) || (all(near <= vec3(0.0)) && !any(near == vec3(OPEN))) { return; }
    let rough = own_line(g, c.at, c.ab, c.ac);
    if abs(rough.x) > 0.51 * (abs(rough.y) + abs(rough.z)) + rough.w { return; }
    let i = rising(c.vertices);
    let n = full_normal(g.own);
    let h = vec3(full_height_of(g, n, i.x), full_height_of(g, n, i.y), full_height_of(g, n, i.z));
    if all(h <= vec3(0.0)) || all(h > vec3(0.0)) { return; }
    let turn = full_turn_of(i);
    let turned = select(turn, 1.0, turn == 0.0) * full_line(g, n, full_normal(i), i.x);
    let line = beyond_centre(turned, (turn != 0.0) & is_beside(g, i, owned_by(i, g.own), turn));
    if line.x == 0.0 || !meets_pixel(line, point_of(i.x), point_of(i.y), point_of(i.z), h, g.pixel) {
        return;
    }
    let far = -sign(line.x) * line;
    for (var word = 0u; word < WORDS; word++) {
        var lost = 0u;
        for (var b = 0u; b < min(frame.sample_count, 32u); b++) {
            let side = dot(far, vec3(1.0, offset_of(32u * word + b)));
            lost |= ((bitcast<u32>(side) >> 31u) ^ 1u) << b;
        }
        atomicOr(&masks[3u * WORDS * f + 2u * WORDS + word], lost);
    }
}

// Whether the coverage mask already says which samples the facet represents: then nothing cuts it.
fn is_partial(f: u32) -> bool {
    var seen = 0u;
    for (var w = 0u; w < WORDS; w++) { seen += countOneBits(atomicLoad(&masks[3u * WORDS * f + w])); }
    return seen != frame.sample_count;
}

fn corner_of(k: u32) -> vec2<f32> {
    return 0.51 * vec2(select(-1.0, 1.0, (k & 1u) != 0u), select(-1.0, 1.0, (k & 2u) != 0u));
}

// The part of the pixel's pencil of rays in which the facet lies.
fn pencil_of(f: u32, g: Ground) -> Walk {
    let centre = pixel_ray(g.pixel);
    var near = undecided[f].limit;
    var far = 0.0;
    var wide = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let ray = ray_at(g.pixel, corner_of(k));
        let over = dot(g.normal, ray);
        let depth = select(undecided[f].limit, min(undecided[f].plane.w / over, undecided[f].limit),
            over < 0.0);
        near = min(near, depth);
        far = max(far, depth);
        wide = max(wide, largest(ray - centre));
    }
    near *= 0.9999;
    far *= 1.0001;
    return walk_of(centre * near, centre * (far - near), false,
        tree.slack + 1.001 * wide * far * tree.place.w);
}
