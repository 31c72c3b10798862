// Samples that an alpha-tested caster shadows (visibility_masks).

//@import frame vertex shadow_lines alpha roles
//@needs override WORDS: u32;
//@needs var<uniform> frame: Frame;
//@needs var<uniform> samples_given: array<vec4<f32>, 64>;
//@needs var<storage, read_write> masks: array<atomic<u32>>;

// Of the samples that a caster lies before all, or if it is alpha-tested those that are open still and before
// which it is solid.
fn solid_samples(f: u32, g: Ground, caster: vec4<u32>, mask: vec4<u32>) -> vec4<u32> {
    if ALPHA == 0u || !is_tested(caster.w) { return mask; }
    if !casts(caster.w) { return vec4(0u); }
    let a = point_of(caster.x);
    let b = point_of(caster.y);
    let c = point_of(caster.z);
    var found = vec4(0u);
    for (var w = 0u; w < WORDS; w++) {
        let at = 3u * WORDS * f + w;
        var left = mask[w] & atomicLoad(&masks[at]) & ~atomicLoad(&masks[at + WORDS]);
        var solid = 0u;
        for (; left != 0u; left &= left - 1u) {
            let k = 32u * w + firstTrailingBit(left);
            let pair = samples_given[k >> 1u];
            // From the sample that the facet's point is at.
            let away = select(pair.xy, pair.zw, (k & 1u) == 1u) - g.origin;
            let moved = away.x * g.along_x + away.y * g.along_y;
            let point = g.at + moved / (g.over.x + away.x * g.over.y + away.y * g.over.z);
            let way = frame.light.xyz - frame.light.w * point;
            if is_solid(caster.w, a, b, c, point, way) { solid |= left & (0u - left); }
        }
        found[w] = solid;
    }
    return found;
}
