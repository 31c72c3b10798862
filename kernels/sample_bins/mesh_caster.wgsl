// Triangles as the mesh holds them. Needs `frame`, vertex, shadow_ray, and the arrays `triangles` and
// `positions`.

fn caster_of(k: u32) -> Caster {
    var c: Caster;
    c.vertices = triangles[k];
    c.at = point_of(c.vertices.x);
    c.ab = edge_of(c.vertices.x, c.vertices.y);
    c.ac = edge_of(c.vertices.x, c.vertices.z);
    return c;
}
