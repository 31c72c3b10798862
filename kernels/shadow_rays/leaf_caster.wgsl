// Triangles as the leaves of the tree hold them. Needs `frame`, shadow_ray, and the array `casters`.

fn caster_of(k: u32) -> Caster {
    let a = casters[3u * k];
    let ab = casters[3u * k + 1u];
    let ac = casters[3u * k + 2u];
    var c: Caster;
    c.at = ((a.xyz - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w;
    c.ab = ab.xyz * frame.eye.w;
    c.ac = ac.xyz * frame.eye.w;
    c.vertices = vec3(bitcast<u32>(a.w), bitcast<u32>(ab.w), bitcast<u32>(ac.w));
    return c;
}
