// The boundaries of a triangle's shadow on a facet as Pan 2009, section 3.4, finds them, in single precision:
// corners are thrown from the light onto the facet's plane, and from there projected to the screen. A
// half-plane stays one under each of the two, bounded by the line through two projected points, and holds the
// projection of a third point unless that lies beyond the projection's centre (the paper's figure 6, point C;
// there it flips). Divides by heights over light and eye, and bounds no rounding: for comparison with
// shadow_lines, whose `Ground` and `crossings` it uses.

//@import frame pixel_ray shadow_lines sample_masks
//@needs var<uniform> frame: Frame;

// A point `h` over the facet's plane, thrown onto it; w: -1 if the light is not above the point, else 1.
fn thrown(g: Ground, p: vec3<f32>, h: f32) -> vec4<f32> {
    let l = frame.light.xyz - frame.light.w * p;
    let rise = dot(g.normal, l);
    return vec4(p - l * (h / rise), select(-1.0, 1.0, rise > 0.0));
}

// A point on the screen, in pixels from a pixel's centre; z: -1 if it lies behind the eye, else 1.
fn on_screen(p: vec3<f32>, pixel: u32) -> vec3<f32> {
    let depth = dot(p, frame.forward.xyz);
    let at = vec2(dot(p, frame.pixel_x.xyz), dot(p, frame.pixel_y.xyz)) / depth
        + vec2(frame.pixel_x.w, frame.pixel_y.w);
    return vec3(at - (pixel_corner(pixel) + 0.5), select(-1.0, 1.0, depth > 0.0));
}

// The half-plane bounded by the line through p and q that holds r, or if `sense` is -1 does not: what it is
// at the pixel centre, per pixel right, per pixel down. Nothing lies in it if r is on the line.
fn half_plane(p: vec2<f32>, q: vec2<f32>, r: vec2<f32>, sense: f32) -> vec3<f32> {
    let d = q - p;
    let at = d.x * (r.y - p.y) - d.y * (r.x - p.x);
    if !(abs(at) > 0.0) { return vec3(-1.0, 0.0, 0.0); }
    return sense * sign(at) * vec3(d.y * p.x - d.x * p.y, -d.y, d.x);
}

// The half-planes of a triangle whose corners, not all beneath the facet, have heights `h` over it.
fn two_step_lines(g: Ground, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, h: vec3<f32>) -> Lines {
    let ta = thrown(g, a, h.x);
    let tb = thrown(g, b, h.y);
    let tc = thrown(g, c, h.z);
    let sa = on_screen(ta.xyz, g.pixel);
    let sb = on_screen(tb.xyz, g.pixel);
    let sc = on_screen(tc.xyz, g.pixel);
    let ab = half_plane(sa.xy, sb.xy, sc.xy, tc.w * sc.z);
    let bc = half_plane(sb.xy, sc.xy, sa.xy, ta.w * sa.z);
    let ca = half_plane(sc.xy, sa.xy, sb.xy, tb.w * sb.z);
    var own = vec3(3.0e38, 0.0, 0.0);
    if !all(h > vec3(0.0)) {
        // Through the two edges that cross the plane; the highest corner's shadow lies on the shadow's side.
        let ends = crossings(a, b, c, h);
        var top = vec3(sa.xy, ta.w * sa.z);
        if h.y >= max(h.x, h.z) { top = vec3(sb.xy, tb.w * sb.z); }
        if h.z >= max(h.x, h.y) { top = vec3(sc.xy, tc.w * sc.z); }
        own = half_plane(on_screen(ends.start, g.pixel).xy, on_screen(ends.end, g.pixel).xy, top.xy, top.z);
    }
    return Lines(vec4(ab.x, bc.x, ca.x, own.x), vec4(ab.y, bc.y, ca.y, own.y), vec4(ab.z, bc.z, ca.z, own.z));
}
