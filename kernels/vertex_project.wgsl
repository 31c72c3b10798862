// vertex_project: brings vertices into the frame's eye-relative, scaled space and into the light view.
// `place` reads `positions` (world units) and writes `points` (xyz; w 1 where finite, else 0); the
// subtraction of the eye is their only rounding: half an ulp of the difference. `project` reads `points` and
// writes `map_points` (texel x, y, depth, w; for a vertex that is not surely in front of the light the first
// three times w, and how much w is less than it would have to be, which is not above 0; 0 for one that
// projects to no number), of the vertices of `kept_clusters`.

//@import frame dispatch finite from_lamp clusters

const WORKGROUP = 64u;

@group(0) @binding(0) var<uniform> frame_given: Frame;
@group(0) @binding(1) var<storage, read> positions: array<vec3<f32>>;
@group(0) @binding(2) var<storage, read_write> points: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> map_points: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> kept_clusters: array<u32>;

//@import frame_copy

@compute @workgroup_size(WORKGROUP)
fn place(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let v = flat_invocation(group, groups, WORKGROUP, local);
    if v >= frame.vertex_count { return; }
    let world = positions[v];
    let point = ((world - frame.eye.xyz) - frame.eye_low.xyz) * frame.eye.w;
    points[v] = select(vec4(0.0), vec4(point, 1.0), all_finite(point));
}

@compute @workgroup_size(WORKGROUP)
fn project(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    take_frame(local);
    let v = member_of(PART_VERTICES, flat_group(group, groups), local).number;
    if v >= frame.vertex_count { return; }
    let p = points[v];
    if p.w == 0.0 {
        map_points[v] = vec4(0.0);
        return;
    }
    let q = from_lamp(p.xyz);
    let uvz = vec3(dot(frame.map_u, q), dot(frame.map_v, q), dot(frame.map_z, q));
    var seen = vec4(uvz, 1.0);
    if (frame.flags & FLAG_PERSPECTIVE) != 0u {
        let w = dot(frame.map_w, q);
        seen = vec4(uvz / w, w);
        if !(w > frame.light_low.w) { seen = vec4(uvz, min(w - frame.light_low.w, 0.0)); }
    }
    if !all_finite(seen.xyz) || !is_finite(seen.w) { seen = vec4(0.0); }
    map_points[v] = seen;
}
