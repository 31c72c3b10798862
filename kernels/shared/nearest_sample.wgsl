// The nearest triangle of each sample of a word, kept by one invocation. A sample that a linear edge function cannot place
// is looked at from the nearer end of each edge; depths are compared by bounds, and computed where bounds overlap; where
// surfaces almost touch, the other one is kept as a rival. Needs `frame`, `samples`, `points`, `triangles`, eye_view.

// What is known of each sample of a word: its triangle, one that almost touches it there, and bounds of its depth.
var<private> best_ids: array<u32, 32>;
var<private> best_rivals: array<u32, 32>;
var<private> best_near: array<f32, 32>;
var<private> best_far: array<f32, 32>;

fn corners_of(t: u32) -> vec3<u32> {
    return vec3(triangles[3u * t], triangles[3u * t + 1u], triangles[3u * t + 2u]);
}

const TOUCHING = 9.5367432e-7;  // 2^-20: relative difference of depths that single precision is not asked about

fn share_vertex(i: vec3<u32>, j: vec3<u32>) -> bool {
    return any(i == j) || any(i == j.yzx) || any(i == j.zxy);
}

// Takes in that triangle `t`, of corners `i`, may be what sample `k` of a word sees; `offset` is the sample's.
// What is rare stands in a loop of one turn: CPU adapters jump over a loop, but not over a branch.
fn consider(k: u32, offset: vec2<f32>, t: u32, i: vec3<u32>, s: View, unsure: bool, pixel: u32) {
    var bounds = depth_bounds(s, s.over.x + offset.x * s.over.y + offset.y * s.over.z);
    var stays = bounds.x <= best_far[k];
    var touching = false;
    // Too near to tell, to what is known or to the near plane.
    let open = !(bounds.x >= frame.forward.w && bounds.y < best_near[k]);
    for (var look = stays && (unsure || open); look; look = false) {
        let ray = ray_at(pixel, offset);
        if unsure {
            let v = vec3(eye_edge_near(i.x, i.y, ray), eye_edge_near(i.y, i.z, ray), eye_edge_near(i.z, i.x, ray));
            stays = all(v >= vec3(0.0)) || all(v <= vec3(0.0));
        }
        if !stays || !open { continue; }
        bounds = vec2(eye_depth(i, ray));
        stays = bounds.x >= frame.forward.w;
        let other = best_ids[k];
        if !stays || other == NO_TRIANGLE { continue; }
        if best_near[k] != best_far[k] { best_near[k] = eye_depth(corners_of(other), ray); }
        best_far[k] = best_near[k];
        stays = bounds.x < best_far[k] || (bounds.x == best_far[k] && t < other);
        touching = abs(bounds.x - best_far[k]) <= TOUCHING * best_far[k] && !share_vertex(i, corners_of(other));
        best_rivals[k] = select(best_rivals[k], select(t, other, stays), touching);
    }
    if stays {
        if !touching { best_rivals[k] = NO_TRIANGLE; }
        best_ids[k] = t;
        best_near[k] = bounds.x;
        best_far[k] = bounds.y;
    }
}

fn look_at(t: u32, word: u32, count: u32, pixel: u32, centre: vec3<f32>) {
    let i = corners_of(t);
    let s = view_of(i, centre);
    let at = vec3(s.edges[0].x, s.edges[1].x, s.edges[2].x);
    let ax = vec3(s.edges[0].y, s.edges[1].y, s.edges[2].y);
    let ay = vec3(s.edges[0].z, s.edges[1].z, s.edges[2].z);
    let doubt = vec3(s.edges[0].w, s.edges[1].w, s.edges[2].w);
    var inside = 0u;
    var unsure = 0u;
    for (var p = 0u; p < (count + 1u) / 2u; p++) {
        let pair = samples[16u * word + p];
        let v = at + pair.x * ax + pair.y * ay;
        let w = at + pair.z * ax + pair.w * ay;
        inside |= select(1u, 0u, any(v > doubt) && any(v < -doubt)) << (2u * p);
        inside |= select(2u, 0u, any(w > doubt) && any(w < -doubt)) << (2u * p);
        unsure |= select(0u, 1u, any(abs(v) <= doubt)) << (2u * p);
        unsure |= select(0u, 2u, any(abs(w) <= doubt)) << (2u * p);
    }
    inside &= select((1u << count) - 1u, 0xffffffffu, count == 32u);
    while inside != 0u {
        let k = firstTrailingBit(inside);
        inside &= inside - 1u;
        consider(k, sample_offset(32u * word + k), t, i, s, ((unsure >> k) & 1u) != 0u, pixel);
    }
}
