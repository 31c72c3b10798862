// The pixel and the twenty-four around it, numbered row by row, and which of them a sample is nearest to
// (surface_receivers).

//@import frame
//@needs var<uniform> frame: Frame;

const OWN = 12u;     // the pixel itself
const NEXT = 8u;     // pixels that share a corner with it
const AROUND = 24u;
const MOST = 8u;     // pixels that one is chosen of
const NONE = 25u;

fn neighbour(at: vec2<i32>, k: u32) -> vec2<i32> {
    return at + vec2<i32>(vec2(k % 5u, k / 5u)) - 2;
}

// Of the pixels that share a corner those before that share a side, then the others row by row.
fn nth_neighbour(n: u32) -> u32 {
    if n < NEXT {
        let q = (0x86207531u >> (4u * n)) & 15u;
        return 6u + q % 3u + 5u * (q / 3u);
    }
    let m = n - NEXT;
    if m < 5u { return m; }
    if m > 10u { return m + 9u; }
    return 5u + 5u * ((m - 5u) >> 1u) + 4u * ((m - 5u) & 1u);
}

// Whether any of some pixels shares no corner with the one in the middle.
fn any_beyond(bits: u32) -> bool {
    return (bits & 0x1f8c63fu) != 0u;
}

fn is_in_image(at: vec2<i32>) -> bool {
    return all(at >= vec2(0)) && all(at < vec2<i32>(frame.image_size));
}

fn pixel_at(at: vec2<i32>) -> u32 {
    return u32(at.y) * frame.image_size.x + u32(at.x);
}

// Left, right, up, down.
fn step_to(side: u32) -> vec2<i32> {
    let by = select(-1, 1, (side & 1u) == 1u);
    return select(vec2(by, 0), vec2(0, by), side > 1u);
}

// The side of the pixel that an offset from its centre is nearest to.
fn side_of(offset: vec2<f32>) -> u32 {
    if abs(offset.x) >= abs(offset.y) { return select(0u, 1u, offset.x > 0.0); }
    return select(2u, 3u, offset.y > 0.0);
}

// How many of some pixels come before one.
fn rank_of(bits: u32, k: u32) -> u32 {
    return countOneBits(bits & ((1u << k) - 1u));
}

// Of the pixels `bits` the one whose centre is nearest to an offset, of equally near ones the first, but for
// those of which `before` has, in its four bits, the side that the offset is nearest to. The pixel itself is
// no neighbour.
fn nearest_of(bits: u32, before: u32, offset: vec2<f32>) -> u32 {
    if ((bits >> OWN) & 1u) == 1u { return OWN; }
    let side = side_of(offset);
    var best = NONE;
    var least = 3.0e38;
    for (var left = bits; left != 0u; left &= left - 1u) {
        let k = firstTrailingBit(left);
        let away = vec2<f32>(neighbour(vec2(0), k)) - offset;
        let open = ((before >> (4u * rank_of(bits, k) + side)) & 1u) == 0u;
        if open && dot(away, away) < least {
            least = dot(away, away);
            best = k;
        }
    }
    return best;
}
