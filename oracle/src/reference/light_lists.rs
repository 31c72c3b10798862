//! Lights listed by tiles of 8 × 8 pixels.

use super::facet_classify::FacetState;
use super::resolve::FacetBits;
use glam::DVec3;

/// Pixels along a side of a tile.
pub const TILE: usize = 8;
/// Mark of a tile some light of which had no room.
pub const LACKS: u32 = 1 << 31;

/// The reach of a light.
#[derive(Clone, Copy, Debug)]
pub struct LightVolume {
    /// The light.
    pub at: DVec3,
    /// Distance that it reaches.
    pub range: f64,
    /// Axis of its cone, of length 1, and the cosine of half its angle.
    pub cone: Option<(DVec3, f64)>,
}

impl LightVolume {
    /// How far within reach a point is, below 0 outside.
    pub fn within(&self, point: DVec3) -> f64 {
        let away = point - self.at;
        let far = away.length();
        let in_cone = self.cone.map_or(f64::INFINITY, |(axis, cosine)| away.dot(axis) - cosine * far);
        (self.range - far).min(in_cone)
    }

    /// How far within reach a plane is where a ray from the origin meets it; below 0 where it meets none ahead.
    pub fn along(&self, [a, b, c]: [DVec3; 3], ray: DVec3) -> f64 {
        let normal = (b - a).cross(c - a);
        let t = normal.dot(a) / normal.dot(ray);
        if t > 0.0 { self.within(ray * t) } else { f64::NEG_INFINITY }
    }
}

/// Byte of a pixel: of its facets, each with the samples at which its plane is within reach.
pub fn byte(facets: &[(FacetBits, u128)]) -> u8 {
    let (mut seen, mut bright) = (0, 0);
    for (f, reached) in facets {
        let counted = match f.state {
            FacetState::Empty => 0,
            FacetState::Undecided => f.coverage & !f.invalid,
            _ => f.coverage,
        };
        let open = match f.state {
            FacetState::Lit => counted,
            FacetState::Undecided => counted & !f.occluded,
            _ => 0,
        };
        seen += counted.count_ones();
        bright += (open & reached).count_ones();
    }
    if bright == 0 { 0 } else { ((510 * bright + seen) / (2 * seen)) as u8 }
}

/// Words of the lists of an image of `size` pixels with room for `capacity` entries: of each light its number and a byte a pixel, row by row.
pub fn words(size: [usize; 2], lights: &[(u32, &[u8])], capacity: usize) -> Vec<u32> {
    let [across, down] = size.map(|side| side.div_ceil(TILE));
    let tiles = across * down;
    let mut heads = vec![[0u32; 2]; tiles];
    let mut entries: Vec<[u32; 18]> = Vec::new();
    let mut needed = 0;
    for (light, bytes) in lights {
        for (tile, head) in heads.iter_mut().enumerate() {
            let mut entry = [0u32; 18];
            entry[0] = *light;
            for k in 0..TILE * TILE {
                let (x, y) = (tile % across * TILE + k % TILE, tile / across * TILE + k / TILE);
                if x < size[0] && y < size[1] {
                    entry[2 + k / 4] |= u32::from(bytes[y * size[0] + x]) << (8 * (k % 4));
                }
            }
            if entry[2..].iter().all(|word| *word == 0) {
                continue;
            }
            needed += 1;
            if entries.len() == capacity {
                head[0] |= LACKS;
                continue;
            }
            entries.push(entry);
            let number = entries.len() as u32;
            match head[1] {
                0 => head[0] |= number,
                last => entries[last as usize - 1][1] = number,
            }
            head[1] = number;
        }
    }
    entries.resize(capacity, [0; 18]);
    let first = [needed, capacity as u32, across as u32, tiles as u32];
    first.into_iter().chain(heads.into_iter().flatten()).chain(entries.into_iter().flatten()).collect()
}

/// Lights of a pixel, in the order of the list, each with its byte where it is not 0; and whether none of its tile's lacks.
pub fn listed(words: &[u32], [x, y]: [usize; 2]) -> (Vec<(u32, u8)>, bool) {
    let (across, tiles) = (words[2] as usize, words[3] as usize);
    let tile = y / TILE * across + x / TILE;
    let (first, k) = (words[4 + 2 * tile], y % TILE * TILE + x % TILE);
    let (mut entry, mut lights) = ((first & !LACKS) as usize, Vec::new());
    while entry != 0 {
        let at = 4 + 2 * tiles + 18 * (entry - 1);
        let byte = (words[at + 2 + k / 4] >> (8 * (k % 4))) as u8;
        lights.extend((byte != 0).then_some((words[at], byte)));
        entry = words[at + 1] as usize;
    }
    (lights, first & LACKS == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_shares_within_reach() {
        let facet = |state, coverage, occluded| FacetBits { state, coverage, occluded, invalid: 0 };
        assert_eq!(byte(&[]), 0);
        assert_eq!(byte(&[(facet(FacetState::Empty, 15, 0), 15)]), 0);
        assert_eq!(byte(&[(facet(FacetState::Lit, 15, 0), 15)]), 255);
        assert_eq!(byte(&[(facet(FacetState::Lit, 15, 0), 3)]), 128);
        let two = [(facet(FacetState::Undecided, 3, 1), 3), (facet(FacetState::Dark, 12, 0), 12)];
        assert_eq!(byte(&two), 64);
        let reach = LightVolume { at: DVec3::Y, range: 2.0, cone: Some((DVec3::NEG_Y, 0.5f64.sqrt())) };
        assert!(reach.within(DVec3::ZERO) > 0.0 && reach.within(DVec3::X * 1.1) < 0.0);
        assert!(reach.within(DVec3::Y * -1.5) < 0.0);
    }

    /// Two lights over an image of two tiles and a bit: what is dark has no entry, what has no room marks its tile.
    #[test]
    fn lists_hold_what_is_lit() {
        let size = [17, 3];
        let all = [255u8; 51];
        let mut some = [0u8; 51];
        some[17 + 9] = 7;
        for (capacity, needed) in [(4, 4), (3, 4), (0, 4)] {
            let words = words(size, &[(5, &some), (9, &all)], capacity);
            assert_eq!(words[..4], [needed, capacity as u32, 3, 3]);
            let full = capacity == 4;
            assert_eq!(listed(&words, [9, 1]).0.len(), [0, 2][usize::from(capacity > 2)], "{capacity}");
            assert_eq!(listed(&words, [16, 2]), (if full { vec![(9, 255)] } else { vec![] }, full));
            if full {
                assert_eq!(listed(&words, [9, 1]), (vec![(5, 7), (9, 255)], true));
                assert_eq!(listed(&words, [8, 1]), (vec![(9, 255)], true));
            }
        }
    }
}
