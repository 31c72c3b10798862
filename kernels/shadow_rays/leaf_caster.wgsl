// Triangles as the leaves of the tree hold them.

//@import frame shadow_ray
//@needs var<uniform> frame: Frame;
//@needs var<storage, read> casters: array<vec4<f32>>;

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
