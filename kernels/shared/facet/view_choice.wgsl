// Which of several views of the light a pixel asks, for methods that ask one: the first that holds the pixel,
// that is its middle and its corners on the plane of its triangle, REACH texels within its map; where none
// does, that which holds most of it: in which the outermost of these points lies least far out. What is not
// in front of a view lies outside it by more than anything.

//@import receiver paraboloid
//@needs var<uniform> frame: Frame;
//@needs override REACH: f32;

struct LightViews {
    // of each view: to texel x and y, times the third; least divisor in front, 1 of a paraboloid view
    rows: array<vec4<f32>, 24>,
    count: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

const OUTSIDE = -3.0e38;

@group(0) @binding(1) var<uniform> views: LightViews;

// Texel x and y of a point in a view, the third 1; 0 where it is not in front of it.
fn texel_in(view: u32, point: vec3<f32>) -> vec3<f32> {
    let k = 4u * view;
    if views.rows[k + 3u].y != 0.0 {
        let at = paraboloid_texel(views.rows[k], views.rows[k + 1u], views.rows[k + 2u], from_light(point));
        return vec3(at.xy, select(0.0, 1.0, at.z > 0.0));
    }
    let p = vec4(point, 1.0);
    let w = dot(views.rows[k + 2u], p);
    if !(w > views.rows[k + 3u].x) { return vec3(0.0); }
    return vec3(vec2(dot(views.rows[k], p), dot(views.rows[k + 1u], p)) / w, 1.0);
}

// How far within the map of a view a point lies, texels; below 0 outside.
fn inset(view: u32, point: vec4<f32>) -> f32 {
    let at = texel_in(view, point.xyz);
    let within = min(at.xy, vec2(f32(frame.map_size)) - at.xy);
    return select(OUTSIDE, max(min(within.x, within.y), OUTSIDE), at.z != 0.0);
}

// The same of a pixel's corner, which says nothing where its ray misses the plane.
fn corner_inset(view: u32, point: vec4<f32>) -> f32 {
    return select(inset(view, point), -OUTSIDE, point.w == 0.0);
}

fn chosen_view(r: Receiver, pixel: u32) -> u32 {
    let middle = plane_point(r, pixel_ray(pixel));
    let a = plane_point(r, ray_at(pixel, vec2(-0.5)));
    let b = plane_point(r, ray_at(pixel, vec2(0.5, -0.5)));
    let c = plane_point(r, ray_at(pixel, vec2(0.5)));
    let d = plane_point(r, ray_at(pixel, vec2(-0.5, 0.5)));
    var chosen = 0u;
    var best = OUTSIDE;
    for (var view = 0u; view < views.count && best < REACH; view++) {
        let sides = min(min(corner_inset(view, a), corner_inset(view, b)),
            min(corner_inset(view, c), corner_inset(view, d)));
        let least = min(inset(view, middle), sides);
        if least > best {
            best = least;
            chosen = view;
        }
    }
    return chosen;
}
