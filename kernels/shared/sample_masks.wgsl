// From lines of the image to masks of samples. Needs `frame`, the uniform `samples`, the array `table`, and the overrides
// WORDS, ANGLES and OFFSETS.

// Four half-planes as matrices: column k holds what line k is at the centre, per pixel right, per pixel down.
struct Lines {
    centre: vec4<f32>,
    right: vec4<f32>,
    down: vec4<f32>,
}

// Samples inside all four lines. A sample on a line is inside for one of the two triangles that share it.
fn word_mask(word: u32, l: Lines) -> u32 {
    var out = 0u;
    let count = (min(frame.sample_count, 32u) + 1u) >> 1u;
    let first = word << 4u;
    for (var k = 0u; k < count; k++) {
        let s = samples[first + k];
        let a = l.centre + s.x * l.right + s.y * l.down;
        let b = l.centre + s.z * l.right + s.w * l.down;
        let ma = min(min(a.x, a.y), min(a.z, a.w));
        let mb = min(min(b.x, b.y), min(b.z, b.w));
        out |= ((bitcast<u32>(ma) >> 31u) | ((bitcast<u32>(mb) >> 31u) << 1u)) << (2u * k);
    }
    return ~out;
}

// Samples inside one line, from the table: the mask of the nearest tabulated direction and distance from the centre.
fn table_mask(line: vec3<f32>) -> vec4<u32> {
    let sum = abs(line.y) + abs(line.z);
    // The angle as its place on a diamond, -1 to 3.
    let part = line.z / sum;
    let turn = select(2.0 - part, part, line.y >= 0.0) + 1.0;
    let distance = -line.x / length(line.yz);
    let a = min(u32(turn * 0.25 * f32(ANGLES)), ANGLES - 1u);
    let o = u32(clamp((distance * 0.70710678 + 0.5) * f32(OFFSETS), 0.0, f32(OFFSETS) - 1.0));
    let at = (a * OFFSETS + o) * WORDS;
    var m = vec4(table[at], 0u, 0u, 0u);
    if WORDS > 1u { m.y = table[at + 1u]; }
    if WORDS > 2u {
        m.z = table[at + 2u];
        m.w = table[at + 3u];
    }
    return m;
}

fn inside(l: Lines) -> vec4<u32> {
    let reach = 0.501 * (abs(l.right) + abs(l.down));
    if any(l.centre < -reach) { return vec4(0u); }
    let crossing = l.centre <= reach;
    if !any(crossing) { return vec4(0xffffffffu); }
    if ANGLES != 0u {
        var t = vec4(0xffffffffu);
        if crossing.x { t &= table_mask(vec3(l.centre.x, l.right.x, l.down.x)); }
        if crossing.y { t &= table_mask(vec3(l.centre.y, l.right.y, l.down.y)); }
        if crossing.z { t &= table_mask(vec3(l.centre.z, l.right.z, l.down.z)); }
        if crossing.w { t &= table_mask(vec3(l.centre.w, l.right.w, l.down.w)); }
        return t;
    }
    var m = vec4(0u);
    m.x = word_mask(0u, l);
    if WORDS > 1u { m.y = word_mask(1u, l); }
    if WORDS > 2u {
        m.z = word_mask(2u, l);
        m.w = word_mask(3u, l);
    }
    return m;
}
