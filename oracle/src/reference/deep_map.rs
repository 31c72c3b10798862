//! Visibility functions of the texels of a deep shadow map (Lokovic and Veach 2000), and their compression.

/// Places of depth 1.
const PLACES: f64 = 4_194_304.0;
/// The place of no depth.
pub const NO_PLACE: u32 = 0xff_ffff;
/// Errors of a texel that are tried, as far as it has sub-texels.
pub const TRIES: usize = 8;
/// All light.
pub const WHOLE: f64 = 128.0;

/// The place of a depth: the next one away from the light.
pub fn place_of(depth: f64) -> u32 {
    ((depth.clamp(0.0, 4.0) * PLACES).ceil() as u32).min(NO_PLACE)
}

/// The steps of a texel: places of its sub-texels that have one, sorted, of so many sub-texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps {
    /// Sorted places.
    pub places: Vec<u32>,
    /// Sub-texels.
    pub count: usize,
}

impl Steps {
    /// Those of texel `at` of a map of `size` × `size` depths, `sub` × `sub` a texel. Beyond the map's border there is no caster.
    pub fn of(depths: &[Option<f64>], size: u32, sub: u32, [x, y]: [u32; 2]) -> Self {
        let within = |from: u32| from * sub..((from + 1) * sub).min(size);
        let depth = |y: u32, x: u32| depths[(y * size + x) as usize].map(place_of);
        let found = within(y).flat_map(|y| within(x).filter_map(move |x| depth(y, x)));
        let mut places: Vec<u32> = found.filter(|place| *place < NO_PLACE).collect();
        places.sort_unstable();
        Self { places, count: (sub * sub) as usize }
    }

    /// Light at a place, of [`WHOLE`]: that of the sub-texels of which no caster is before it.
    pub fn light(&self, place: u32) -> f64 {
        WHOLE * (1.0 - self.places.iter().filter(|step| **step < place).count() as f64 / self.count as f64)
    }

    /// The places at which light changes, and those just behind them.
    fn corners(&self) -> Vec<u32> {
        let mut corners: Vec<u32> = self.places.iter().flat_map(|place| [*place, *place + 1]).collect();
        corners.dedup();
        corners
    }

    /// Nodes (place, light) whose lines are within `error` (of [`WHOLE`]) of the steps, and half a unit that rounding of the nodes adds.
    pub fn nodes(&self, error: f64) -> Vec<(u32, f64)> {
        let (Some(&first), Some(&last)) = (self.places.first(), self.places.last()) else { return Vec::new() };
        let rest = self.light(NO_PLACE);
        let mut nodes = vec![(first, WHOLE)];
        let (mut window, mut end) = ([f64::NEG_INFINITY, 0.0], first);
        for place in self.corners() {
            let mut origin = nodes[nodes.len() - 1];
            if place == origin.0 {
                continue;
            }
            // Light left behind the last is exact.
            let within = if place == last + 1 { 0.0 } else { error };
            let light = self.light(place);
            let slopes = |(from, lit): (u32, f64)| {
                let away = f64::from(place - from);
                [(light - within).max(rest) - lit, (light + within - lit).min(0.0)].map(|rise| rise / away)
            };
            let mut found = slopes(origin);
            if found[0].max(window[0]) > found[1].min(window[1]) && end > origin.0 {
                let along = 0.5 * (window[0] + window[1]) * f64::from(end - origin.0);
                origin = (end, ((origin.1 + along).clamp(rest, origin.1) + 0.5).floor());
                nodes.push(origin);
                window = [f64::NEG_INFINITY, 0.0];
                found = slopes(origin);
            }
            window[1] = window[1].min(found[1]);
            window[0] = window[0].max(found[0]).min(window[1]);
            end = place;
        }
        nodes.push((end, rest));
        nodes
    }

    /// The errors that are tried, of [`WHOLE`], from the one asked for on; beyond them there is a single line.
    pub fn errors(&self, asked: f64) -> impl Iterator<Item = f64> {
        let last = self.count.min(TRIES) - 1;
        (0..last).map(move |k| asked + (0.5 * WHOLE - asked) * (k as f64 / last as f64).powi(2))
    }

    /// The nodes of the least of these errors for which `most` of them suffice, and that error; of the single line none.
    pub fn compressed(&self, asked: f64, most: usize) -> (Vec<(u32, f64)>, Option<f64>) {
        let found = self.errors(asked).map(|e| (self.nodes(e), Some(e))).find(|(nodes, _)| nodes.len() <= most);
        let line = || {
            let nodes = self.nodes(0.0);
            (vec![nodes[0], nodes[nodes.len() - 1]], None)
        };
        found.unwrap_or_else(line)
    }

    /// Greatest difference of nodes from the steps at any place, of [`WHOLE`].
    pub fn difference(&self, nodes: &[(u32, f64)]) -> f64 {
        // Both are straight between these.
        let all = self.corners().into_iter().chain(nodes.iter().flat_map(|(place, _)| [*place, *place + 1]));
        all.chain([0, NO_PLACE]).map(|place| (light_of(nodes, place) - self.light(place)).abs()).fold(0.0, f64::max)
    }
}

/// Light at a place by nodes, of [`WHOLE`].
pub fn light_of(nodes: &[(u32, f64)], place: u32) -> f64 {
    let (Some(first), Some(last)) = (nodes.first(), nodes.last()) else { return WHOLE };
    if place <= first.0 {
        return WHOLE;
    }
    match nodes.windows(2).find(|pair| place <= pair[1].0) {
        Some(pair) => {
            let part = f64::from(place - pair[0].0) / f64::from(pair[1].0 - pair[0].0);
            pair[0].1 + (pair[1].1 - pair[0].1) * part
        }
        None => last.1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(places: &[u32], count: usize) -> Steps {
        Steps { places: places.to_vec(), count }
    }

    #[test]
    fn steps_are_the_share_of_sub_texels_in_front_of_which_nothing_is() {
        let depths = [Some(0.25), None, None, Some(0.5), Some(5.0), Some(0.75), None, None, None];
        let of = |at| Steps::of(&depths, 3, 2, at);
        let [near, far] = [0.25, 0.5].map(place_of);
        assert_eq!(of([0, 0]), steps(&[near, far], 4));
        // Three of its sub-texels are beyond the map, or beyond all depths.
        assert_eq!(of([1, 0]), steps(&[place_of(0.75)], 4));
        assert_eq!(of([1, 1]), steps(&[], 4));
        let light = |place| of([0, 0]).light(place) / WHOLE;
        assert_eq!([near, near + 1, far, far + 1].map(light), [1.0, 0.75, 0.75, 0.5]);
        assert_eq!(light_of(&[], 7), WHOLE);
    }

    #[test]
    fn nodes_of_no_error_are_the_steps() {
        let all = steps(&[100, 100, 101, 700, 900], 16);
        let nodes = all.nodes(0.0);
        assert_eq!(all.difference(&nodes), 0.0);
        assert_eq!((nodes[0], nodes[nodes.len() - 1]), ((100, WHOLE), (901, all.light(902))));
        let spoilt: Vec<_> = nodes.iter().map(|&(place, light)| (place + 1, light)).collect();
        assert!(all.difference(&spoilt) >= 8.0 && all.difference(&nodes[1..]) >= 8.0);
    }

    #[test]
    fn lines_are_within_the_error_of_the_steps() {
        let (mut state, mut shorter) = (9u32, 0);
        for trial in 0..400 {
            let mut next = || {
                state = state.wrapping_mul(0x9e37_79b1) ^ (state >> 15);
                state >> 7
            };
            let count = [4, 16, 64][trial % 3];
            let spread = [40, 3000, 1 << 22][next() as usize % 3];
            let mut places: Vec<u32> = (0..next() as usize % (count + 1)).map(|_| next() % spread).collect();
            places.sort_unstable();
            let all = steps(&places, count);
            let error = f64::from(next() % 65);
            let nodes = all.nodes(error);
            assert!(all.difference(&nodes) <= error + 0.5 + 1e-9, "{all:?} {error}: {nodes:?}");
            assert!(nodes.is_sorted_by(|a, b| a.0 < b.0 && a.1 >= b.1), "{nodes:?}");
            shorter += usize::from(nodes.len() < all.nodes(0.0).len());
            let (few, told) = if places.is_empty() { continue } else { all.compressed(error, 5) };
            assert!(few.len() <= 5 && told.is_none_or(|e| e >= error && all.difference(&few) <= e + 0.5 + 1e-9));
        }
        assert!(shorter > 150, "{shorter} compressed");
    }
}
