// Which sides of the light's view a point lies beyond, also where it is not in front of the light. Of a
// convex figure whose corners all lie beyond one side, nothing is in the view.

//@import frame from_lamp
//@needs var<uniform> frame: Frame;

// A point of the view: its divisor, how far it lies beyond each side (low x, low y, high x, high y), times
// the divisor, and the rounding of that.
struct InView {
    w: f32,
    beyond: vec4<f32>,
    noise: f32,
}

fn in_view(point: vec3<f32>) -> InView {
    let p = from_lamp(point);
    let u = dot(frame.map_u, p);
    let v = dot(frame.map_v, p);
    let w = dot(frame.map_w, p);
    let size = f32(frame.map_size);
    // Of the point's own coordinates, and of those seen from the light.
    let a = vec4(abs(p.xyz) + 0.25 * abs(point), 1.0);
    let noise = 4e-6 * (max(dot(abs(frame.map_u), a), dot(abs(frame.map_v), a))
        + size * dot(abs(frame.map_w), a));
    return InView(w, vec4(-u, -v, u - size * w, v - size * w), noise);
}

fn sides_beyond(point: vec3<f32>) -> u32 {
    let seen = in_view(point);
    // Margins are those of the unit cube.
    let reach = max(abs(point.x), max(abs(point.y), abs(point.z)));
    let slack = frame.map_margin * abs(seen.w) * max(1.0, reach) + seen.noise;
    let beyond = select(vec4(0u), vec4(1u, 2u, 4u, 8u), seen.beyond > vec4(slack));
    return beyond.x | beyond.y | beyond.z | beyond.w;
}
