// Triangles as the mesh holds them.

//@import vertex shadow_ray
//@needs var<storage, read> triangles: array<vec4<u32>>;

fn caster_of(k: u32) -> Caster {
    var c: Caster;
    let given = triangles[k];
    c.vertices = given.xyz;
    c.word = given.w;
    c.at = point_of(c.vertices.x);
    c.ab = edge_of(c.vertices.x, c.vertices.y);
    c.ac = edge_of(c.vertices.x, c.vertices.z);
    return c;
}
