// From lines of the image to masks of samples.

//@import shadow_lines sample_copy
//@needs override WORDS: u32;
//@needs override ANGLES: u32;
//@needs override OFFSETS: u32;
//@needs var<storage, read> table: array<u32>;

// Of the samples of a word: which lie outside a line, and how near any comes to changing that, in the lines'
// own units.
struct Sides {
    outside: u32,
    nearest: f32,
}

// Takes in two samples. One on a line is inside for one of the two triangles that share it.
fn take_two(at: u32, k: u32, l: Lines, sides: ptr<function, Sides>) {
    let s = samples[at + k];
    let a = l.centre + s.x * l.right + s.y * l.down;
    let b = l.centre + s.z * l.right + s.w * l.down;
    let ma = min(min(a.x, a.y), min(a.z, a.w));
    let mb = min(min(b.x, b.y), min(b.z, b.w));
    (*sides).outside |= ((bitcast<u32>(ma) >> 31u) | ((bitcast<u32>(mb) >> 31u) << 1u)) << (2u * k);
    (*sides).nearest = min((*sides).nearest, min(abs(ma), abs(mb)));
}

fn sides_of(word: u32, l: Lines) -> Sides {
    let at = word << 4u;
    var sides = Sides(0u, 3.0e38);
    take_two(at, 0u, l, &sides);
    if SAMPLES > 2u {
        take_two(at, 1u, l, &sides);
        take_two(at, 2u, l, &sides);
        take_two(at, 3u, l, &sides);
    }
    if SAMPLES > 8u {
        take_two(at, 4u, l, &sides);
        take_two(at, 5u, l, &sides);
        take_two(at, 6u, l, &sides);
        take_two(at, 7u, l, &sides);
    }
    if SAMPLES > 16u {
        take_two(at, 8u, l, &sides);
        take_two(at, 9u, l, &sides);
        take_two(at, 10u, l, &sides);
        take_two(at, 11u, l, &sides);
        take_two(at, 12u, l, &sides);
        take_two(at, 13u, l, &sides);
        take_two(at, 14u, l, &sides);
        take_two(at, 15u, l, &sides);
    }
    return sides;
}

// Samples inside all four lines.
fn word_mask(word: u32, l: Lines) -> u32 { return ~sides_of(word, l).outside; }

// Samples inside one line, from the table: the mask of the nearest tabulated direction and distance from the
// centre.
fn table_mask(line: vec3<f32>) -> vec4<u32> {
    let sum = abs(line.y) + abs(line.z);
    // The angle as its place on a diamond, -1 to 3.
    let part = line.z / sum;
    let turn = select(2.0 - part, part, line.y >= 0.0) + 1.0;
    let distance = -line.x / length(line.yz);
    let a = min(u32(turn * 0.25 * f32(ANGLES)), ANGLES - 1u);
    let o = u32(clamp((distance * 0.70710678 + 0.5) * f32(OFFSETS), 0.0, max(f32(OFFSETS) - 1.0, 0.0)));
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

struct Told {
    mask: vec4<u32>,
    open: bool,  // rounding may have put a sample on the wrong side
}

// Samples inside four lines each of which may be off by `error` anywhere in the pixel.
fn told(l: Lines, error: vec4<f32>) -> Told {
    let slope = abs(l.right) + abs(l.down);
    let reach = 0.501 * slope;
    if any(l.centre + error < -reach) { return Told(vec4(0u), false); }
    if all(l.centre - error > reach) { return Told(vec4(0xffffffffu), false); }
    // In units of its error, with room for the roundings of that, each line is off by at most 1.
    let unit = 1.0 / max(error + 1e-6 * slope, vec4(1e-37));
    let scaled = Lines(unit * l.centre, unit * l.right, unit * l.down);
    let first = sides_of(0u, scaled);
    var outside = vec4(first.outside, 0xffffffffu, 0xffffffffu, 0xffffffffu);
    var nearest = first.nearest;
    if WORDS > 1u {
        let second = sides_of(1u, scaled);
        outside.y = second.outside;
        nearest = min(nearest, second.nearest);
    }
    if WORDS > 2u {
        let third = sides_of(2u, scaled);
        let fourth = sides_of(3u, scaled);
        outside.z = third.outside;
        outside.w = fourth.outside;
        nearest = min(nearest, min(third.nearest, fourth.nearest));
    }
    return Told(~outside, nearest < 1.0);
}
