// The segment from a sample's point on a facet to the light against one triangle: Moeller and Trumbore (1997)
// with a bound for what rounding may do, and with 46 bits where that leaves it open.

//@import frame pixel_ray facing facing_46 shadow_lines shadow_lines_46 alpha roles
//@needs var<uniform> frame: Frame;
//@needs var<uniform> samples: array<vec4<f32>, 64>;
//@needs fn caster_of(k: u32) -> Caster;

const FREE = 0u;
const BLOCKED = 1u;
const DOUBTFUL = 2u;

struct Ray {
    meets: bool,        // whether the sample's own ray meets the facet's plane before the eye
    offset: vec2<f32>,  // of the sample from the pixel centre
    at: vec3<f32>,      // its point on the plane
    moved: f32,         // how far rounding may have moved that
    light: vec3<f32>,   // from there to the light
    reach: f32,         // bound of light, largest component
    error: f32,         // of l . (e x a) relative to e: error + grow * largest(a)
    grow: f32,
}

struct Caster {
    at: vec3<f32>,      // a vertex, relative to the eye
    ab: vec3<f32>,      // edges from there
    ac: vec3<f32>,
    vertices: vec3<u32>,
    word: u32,          // tells of holes
}

// Heights of its vertices over the facet.
fn heights_of(g: Ground, c: Caster) -> vec3<f32> {
    return vec3(
        height_of(g, is_own(c.vertices.x, g.own), c.at),
        height_of(g, is_own(c.vertices.y, g.own), c.at + c.ab),
        height_of(g, is_own(c.vertices.z, g.own), c.at + c.ac));
}

fn offset_of(k: u32) -> vec2<f32> {
    let pair = samples[k >> 1u];
    return select(pair.xy, pair.zw, (k & 1u) == 1u);
}

// Whether a sample is the pixel centre of the one facet of that, whose triangle is what the centre sees.
fn is_centre(offset: vec2<f32>) -> bool {
    return all(offset == vec2(0.0)) & ((frame.flags & FLAG_CLAMP) == 0u);
}

fn ray_of_sample(g: Ground, k: u32) -> Ray {
    var r: Ray;
    r.offset = offset_of(k);
    let away = r.offset - g.origin;
    let over = g.over.x + away.x * g.over.y + away.y * g.over.z;
    r.meets = over < 0.0;
    let step = (away.x * g.along_x + away.y * g.along_y) / over;
    r.at = g.at + step;
    let size = largest(r.at);
    let off = g.doubt + TINY * (dot(g.tilts, abs(step)) + 8.0 * largest(step));
    aim(&r, largest(ray_at(g.pixel, r.offset)) / abs(over) * off + 4.0 * TINY * size);
    return r;
}

// Points the ray from `at` to the light; rounding may have moved `at` by `moved`.
fn aim(r: ptr<function, Ray>, moved: f32) {
    (*r).moved = moved;
    (*r).light = frame.light.xyz - frame.light.w * (*r).at;
    (*r).reach = largest((*r).light);
    let light_moved = 2.0 * TINY * (largest(frame.light.xyz) + (*r).reach) + frame.light.w * moved;
    (*r).error = 6.0 * (*r).reach * (moved + 2.0 * TINY * largest((*r).at));
    (*r).grow = 54.0 * TINY * (*r).reach + 6.0 * light_moved;
}

// Whether the line to the light surely passes by the triangle: it lies on different sides of two edges, seen
// along it.
fn passes(r: Ray, c: Caster) -> bool {
    let a = c.at - r.at;
    let m = cross(r.light, a);
    let over = dot(cross(c.ab, c.ac), r.light);
    let x = dot(c.ab, m);
    let z = -dot(c.ac, m);
    let v = vec3(x, over - x - z, z);
    let lb = largest(c.ab);
    let lc = largest(c.ac);
    let noise = r.error + r.grow * largest(a);
    let doubt = vec3(lb * noise, (lb + lc) * noise + lb * lc * r.grow, lc * noise);
    return any(v < -doubt) && any(v > doubt);
}

fn misses(r: Ray, k: u32) -> bool {
    return passes(r, caster_of(k));
}

// State of a triangle on the ray, its holes taken in.
fn blocks(g: Ground, r: Ray, k: u32) -> u32 {
    let c = caster_of(k);
    let a = c.at - r.at;
    let m = cross(r.light, a);
    let n = cross(c.ab, c.ac);
    let over = dot(n, r.light);
    // The planes through the light and an edge; all three have the sign of `over` inside.
    var v = vec3(dot(c.ab, m), 0.0, -dot(c.ac, m));
    v.y = over - v.x - v.z;
    let lb = largest(c.ab);
    let lc = largest(c.ac);
    let noise = r.error + r.grow * largest(a);
    let area_noise = lb * lc * r.grow;
    let doubt = vec3(lb * noise, (lb + lc) * noise + area_noise, lc * noise);
    let outside = v < -doubt;
    let inside = v > doubt;
    if any(outside) && any(inside) { return FREE; }
    // Heights along n: of the vertex over the sample, and of the light over the vertex.
    let up = dot(n, a);
    let up_doubt = lb * lc * noise / r.reach;
    let beyond = over - up;
    let over_doubt = area_noise + frame.light.w * up_doubt;
    if (up > up_doubt && over < -area_noise) || (up < -up_doubt && over > area_noise) { return FREE; }
    let h = heights_of(g, c);
    let is_open = any(h == vec3(OPEN));
    if all(h <= vec3(0.0)) && !is_open { return FREE; }
    if is_open || !(all(outside) || all(inside)) { return DOUBTFUL; }
    let turn = sign(over);
    if frame.light.w != 0.0 {
        if turn * beyond < -over_doubt { return FREE; }
        if turn * beyond <= over_doubt { return DOUBTFUL; }
    }
    // Else wholly above the plane of the facet: between its point and the light.
    if !all(h > vec3(0.0)) {
        if turn * up < -up_doubt { return FREE; }
        if turn * up <= up_doubt { return DOUBTFUL; }
    }
    if ALPHA == 0u || c.word < 2u { return BLOCKED; }
    if !casts(c.word) { return FREE; }
    if is_tested(c.word) && is_place_open(g, r, c, doubt) { return DOUBTFUL; }
    return hole_by(c.word, vec2(v.z, v.x) / over);
}

// Whether rounding may move the point at which a ray meets a triangle as far as the sample moves it by
// LINE_TRUST pixels: `doubt` bounds the error of the volumes with ab, bc and ca.
fn is_place_open(g: Ground, r: Ray, c: Caster, doubt: vec3<f32>) -> bool {
    let away = r.offset - g.origin;
    let over = g.over.x + away.x * g.over.y + away.y * g.over.z;
    let a = c.at - r.at;
    let normal = frame.light.w * cross(c.ab, c.ac);
    var slope = vec3(0.0);
    for (var k = 0u; k < 2u; k++) {
        // Change of the sample's point for a pixel to the right, and one down, and of the volumes.
        let along = select(g.along_y, g.along_x, k == 0u);
        let step = (along - (r.at - g.at) * select(g.over.z, g.over.y, k == 0u)) / over;
        let m = cross(r.light, step) + frame.light.w * cross(step, a);
        let ab = dot(c.ab, m);
        let ca = dot(c.ac, m);
        slope += abs(vec3(ab, dot(normal, step) - ab + ca, ca));
    }
    return any(doubt > LINE_TRUST * slope);
}

// FREE where a triangle has a hole, by the shares of its second and third corner.
fn hole_by(word: u32, shares: vec2<f32>) -> u32 {
    return select(FREE, BLOCKED, !is_tested(word) || is_solid_by(word, shares));
}

fn blocks_46(g: Ground, offset: vec2<f32>, k: u32) -> u32 {
    let c = caster_of(k);
    let i = rising(c.vertices);
    let n = full_normal(g.own);
    let h = full_heights_of(g, n, i);
    if all(h <= vec3(0.0)) { return FREE; }
    let turn = full_turn_of(i);
    if turn == 0.0 { return FREE; }
    let owned = owned_by(i, g.own);
    let beside = is_centre(offset) && is_beside(g, i, owned, turn);
    let crosses = !all(h > vec3(0.0));
    let l = full_lines(g, n, i, turn, crosses);
    let at = vec3(1.0, offset);
    let ab_line = vec3(l.centre.x, l.right.x, l.down.x);
    let bc_line = vec3(l.centre.y, l.right.y, l.down.y);
    let ca_line = vec3(l.centre.z, l.right.z, l.down.z);
    // Of a, b, c: each the part of the edge opposite.
    var parts = vec3(dot(at, bc_line), dot(at, ca_line), dot(at, ab_line));
    let ab = dot(at, beyond_centre(ab_line, beside & !owned.z));
    let bc = dot(at, beyond_centre(bc_line, beside & !owned.x));
    let ca = dot(at, beyond_centre(ca_line, beside & !owned.y));
    var least = min(ab, min(bc, ca));
    if crosses {
        let own = vec3(l.centre.w, l.right.w, l.down.w);
        least = min(least, dot(at, beyond_centre(own, beside)));
    }
    if (bitcast<u32>(least) >> 31u) == 1u { return FREE; }
    if ALPHA == 0u || c.word < 2u { return BLOCKED; }
    if !casts(c.word) { return FREE; }
    parts = max(parts, vec3(0.0));
    let shares = parts / max(parts.x + parts.y + parts.z, 1e-37);
    return hole_by(c.word, vec2(dot(shares, select(vec3(0.0), vec3(1.0), i == vec3(c.vertices.y))),
        dot(shares, select(vec3(0.0), vec3(1.0), i == vec3(c.vertices.z)))));
}
