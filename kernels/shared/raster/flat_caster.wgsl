// A caster in the light's map, and its depth at places there.

//@import front_split

struct FlatCaster {
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
    area: f32,      // twice that of the triangle; its sign is its turn
    turn: f32,
    // Lines of its edges, grown by a guard: not below 0 where the triangle may be.
    cut_ab: vec3<f32>,
    cut_bc: vec3<f32>,
    cut_ca: vec3<f32>,
}

// `guarded`: texels by which edges are grown.
fn flat_caster(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, guarded: f32) -> FlatCaster {
    let ab = b.xy - a.xy;
    let bc = c.xy - b.xy;
    let ac = c.xy - a.xy;
    let area = ab.x * ac.y - ab.y * ac.x;
    let guard = guarded * vec3(abs(ab.x) + abs(ab.y), abs(bc.x) + abs(bc.y), abs(ac.x) + abs(ac.y));
    let turn = select(-1.0, 1.0, area > 0.0);
    return FlatCaster(a, b, c, area, turn,
        vec3(turn * vec2(-ab.y, ab.x), turn * (ab.y * a.x - ab.x * a.y) + guard.x),
        vec3(turn * vec2(-bc.y, bc.x), turn * (bc.y * b.x - bc.x * b.y) + guard.y),
        vec3(turn * vec2(ac.y, -ac.x), turn * (ac.x * a.y - ac.y * a.x) + guard.z));
}

// The key of its depth at a place; 0 where it does not lie.
fn key_at(f: FlatCaster, at: vec2<f32>) -> u32 {
    let ab = f.b.xy - f.a.xy;
    let bc = f.c.xy - f.b.xy;
    let ac = f.c.xy - f.a.xy;
    let pa = at - f.a.xy;
    let pb = at - f.b.xy;
    let v = f.turn * vec3(ab.x * pa.y - ab.y * pa.x, bc.x * pb.y - bc.y * pb.x, ac.y * pa.x - ac.x * pa.y);
    if any(v < vec3(0.0)) { return 0u; }
    var depth = f.a.z;
    if f.area != 0.0 {
        let nearest = min(f.a.z, min(f.b.z, f.c.z));
        let farthest = max(f.a.z, max(f.b.z, f.c.z));
        depth = f.a.z + ((f.b.z - f.a.z) * v.z + (f.c.z - f.a.z) * v.x) / abs(f.area);
        depth = clamp(depth, nearest, farthest);
    }
    return key_of_depth(depth);
}
