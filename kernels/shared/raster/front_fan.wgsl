// The part of a triangle that lies in front of the light, as a fan of one triangle or two, whose edges go
// from a vertex in front to where they are cut.

//@import frame undivided
//@needs var<uniform> frame: Frame;

struct Fan {
    middle: vec4<f32>,
    side_a: vec4<f32>,
    side_b: vec4<f32>,
    last: vec4<f32>,
    parts: u32,     // triangles of it
    extent: f32,    // the largest coordinate of one that is cut, else 0
}

// Where the edge from a point in front to one that is not comes to the nearest distance.
fn cut_point(front: vec4<f32>, behind: vec4<f32>) -> vec4<f32> {
    let p = undivided(front, frame.light_low.w);
    let q = undivided(behind, frame.light_low.w);
    let near = frame.light_low.w;
    let at = mix(p, q, clamp((p.w - near) / (p.w - q.w), 0.0, 1.0));
    return vec4(at.xyz / near, near);
}

fn largest_of(p: vec4<f32>) -> f32 { return max(abs(p.x), abs(p.y)); }

fn fan_of(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>) -> Fan {
    var fan = Fan(a, b, c, c, 1u, 0.0);
    let behind = vec3(a.w, b.w, c.w) <= vec3(0.0);
    // Few are cut: a loop that the others do not enter.
    for (var cut = any(behind); cut; cut = false) {
        fan.parts = 0u;
        if all(behind) || (frame.flags & FLAG_PERSPECTIVE) == 0u { continue; }
        // The vertex on a side of its own, and the others in their order.
        var alone = a;
        var first = b;
        var second = c;
        if behind.x == behind.z {
            alone = b;
            first = a;
        } else if behind.x == behind.y {
            alone = c;
            first = a;
            second = b;
        }
        if alone.w > 0.0 {
            fan.middle = alone;
            fan.side_a = cut_point(alone, first);
            fan.side_b = cut_point(alone, second);
            fan.last = fan.side_b;
            fan.parts = 1u;
        } else {
            fan.middle = first;
            fan.side_a = second;
            fan.side_b = cut_point(second, alone);
            fan.last = cut_point(first, alone);
            fan.parts = 2u;
        }
        fan.extent = max(max(largest_of(fan.middle), largest_of(fan.side_a)),
            max(largest_of(fan.side_b), largest_of(fan.last)));
    }
    return fan;
}
