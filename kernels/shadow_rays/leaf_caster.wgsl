// Triangles as the leaves of the tree hold them.

//@import frame shadow_ray alpha
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> casters: array<vec4<f32>>;
//@needs var<storage, read> triangles: array<vec4<u32>>;

const TESTED = 0x80000000u;  // of an alpha-tested one there is its number in place of the first vertex's

fn caster_of(k: u32) -> Caster {
    let a = casters[3u * k];
    let ab = casters[3u * k + 1u];
    let ac = casters[3u * k + 2u];
    var c: Caster;
    c.at = ((a.xyz - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w;
    c.ab = ab.xyz * frame.eye.w;
    c.ac = ac.xyz * frame.eye.w;
    c.vertices = vec3(bitcast<u32>(a.w), bitcast<u32>(ab.w), bitcast<u32>(ac.w));
    if ALPHA != 0u && (c.vertices.x & TESTED) != 0u {
        let given = triangles[c.vertices.x & ~TESTED];
        c.vertices = given.xyz;
        c.word = given.w;
    }
    return c;
}
