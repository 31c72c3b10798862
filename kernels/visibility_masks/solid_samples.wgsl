// Samples that an alpha-tested caster shadows (visibility_masks).

//@import frame facing vertex shadow_lines alpha mapped_view roles
//@needs override WORDS: u32;
//@needs override TWO_STEP: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> samples_given: array<vec4<f32>, 64>;
//@needs var<storage, read_write> masks: array<atomic<u32>>;

// The three planes through the light and an edge, as lines of the image: edges ab, bc, ca of the corners by
// rising index, positive inside. At a sample each is proportional to the share of the corner opposite.
struct EdgeLines { centre: vec3<f32>, right: vec3<f32>, down: vec3<f32> }

fn card_of(caster: vec4<u32>) -> Card {
    return Card(point_of(caster.x), point_of(caster.y), point_of(caster.z), mapped_ahead());
}

// Shares of the second and the third corner as given, at an offset.
fn shares_of(l: EdgeLines, caster: vec4<u32>, offset: vec2<f32>) -> vec2<f32> {
    let at = max(l.centre + offset.x * l.right + offset.y * l.down, vec3(0.0));
    let i = rising(caster.xyz);
    let parts = at.yzx / max(at.x + at.y + at.z, 1e-37);
    let share = vec2(dot(parts, select(vec3(0.0), vec3(1.0), i == vec3(caster.y))),
        dot(parts, select(vec3(0.0), vec3(1.0), i == vec3(caster.z))));
    return world_shares(share, card_of(caster));
}

// Of the samples that a caster lies before all, or if it is alpha-tested those that are open still and before
// which it is solid. The point that the light would cross is told by `edges`, whose error is a share of a
// pixel even where facet, caster and light nearly lie in one plane; by two projections from the corners.
fn solid_samples(f: u32, g: Ground, caster: vec4<u32>, edges: EdgeLines, mask: vec4<u32>) -> vec4<u32> {
    if ALPHA == 0u || !is_tested(caster.w) { return mask; }
    if !casts(caster.w) { return vec4(0u); }
    var found = vec4(0u);
    for (var w = 0u; w < WORDS; w++) {
        let at = 3u * WORDS * f + w;
        var left = mask[w] & atomicLoad(&masks[at]) & ~atomicLoad(&masks[at + WORDS]);
        var solid = 0u;
        for (; left != 0u; left &= left - 1u) {
            let k = 32u * w + firstTrailingBit(left);
            let pair = samples_given[k >> 1u];
            let offset = select(pair.xy, pair.zw, (k & 1u) == 1u);
            var there = false;
            if TWO_STEP == 0u {
                there = is_solid_by(caster.w, shares_of(edges, caster, offset));
            } else {
                // From the sample that the facet's point is at.
                let away = offset - g.origin;
                let moved = away.x * g.along_x + away.y * g.along_y;
                let point = g.at + moved / (g.over.x + away.x * g.over.y + away.y * g.over.z);
                let way = frame.light.xyz - frame.light.w * point;
                there = is_solid(caster.w, card_of(caster), point, way);
            }
            if there { solid |= left & (0u - left); }
        }
        found[w] = solid;
    }
    return found;
}
