//! Depth comparison with a map of nearest depths whose staircase borders are drawn anew as straight lines (Bondarev 2014).

use glam::{DVec2, DVec3};

/// A map and how it is asked.
#[derive(Clone, Copy, Debug)]
pub struct SmsrLookup<'a> {
    /// Nearest depth of each texel, row by row; `None` where there is no caster.
    pub depths: &'a [Option<f64>],
    /// Texels a side.
    pub size: u32,
    /// Texels to either side that a border is followed.
    pub reach: u32,
    /// Lines through the middles of the steps, on both sides of the border; else from the corners of dark texels.
    pub midpoints: bool,
    /// Depth that a receiver is moved towards the light.
    pub constant: f64,
    /// Times the steeper slope of the receiver, for each texel away from the pixel: what it is moved besides.
    pub slope: f64,
}

/// How far places and depths may be off: what depends on less is not told.
#[derive(Clone, Copy, Debug, Default)]
pub struct SmsrMargin {
    /// Texels.
    pub place: f64,
    /// Depth.
    pub depth: f64,
}

/// How a border ends on one side of a texel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// It turns to the texel's side: the next texel in the row is like the one beyond the border.
    Here,
    /// It turns away: beyond it the next texel is like the texel's own row.
    Away,
    /// Not within reach.
    Open,
}

/// A receiver's plane as the map sees it.
#[derive(Clone, Copy, Debug)]
struct Plane {
    /// The place that is asked for.
    at: DVec3,
    /// Where the pixel is, from which the bias grows.
    from: DVec2,
    slope: DVec2,
    doubt: SmsrMargin,
}

impl SmsrLookup<'_> {
    /// Whether something lies before the plane in a texel; `None` if that is in doubt.
    fn dark(&self, plane: &Plane, [x, y]: [i64; 2]) -> Option<bool> {
        let size = i64::from(self.size);
        let held = (0..size).contains(&x) && (0..size).contains(&y);
        let Some(nearest) = held.then(|| self.depths[(y * size + x) as usize]).flatten() else { return Some(false) };
        let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let bend = self.slope * plane.slope.abs().max_element() * (middle - plane.from).abs().max_element();
        let depth = plane.at.z - self.constant + plane.slope.dot(middle - plane.at.truncate()) - bend;
        ((depth - nearest).abs() >= plane.doubt.depth).then_some(nearest < depth)
    }

    /// How many texels further, along a row and towards `along`, the border towards `across` goes on, and how it ends.
    fn run(&self, plane: &Plane, texel: [i64; 2], across: [i64; 2], along: [i64; 2], own: bool) -> Option<(u32, End)> {
        for k in 1..=self.reach {
            let next = [0, 1].map(|a| texel[a] + i64::from(k) * along[a]);
            if self.dark(plane, next)? != own {
                return Some((k - 1, End::Here));
            }
            if self.dark(plane, [0, 1].map(|a| next[a] + across[a]))? == own {
                return Some((k - 1, End::Away));
            }
        }
        Some((self.reach, End::Open))
    }

    /// How far from the border towards `across` the line runs beside a place of a texel, which is dark or not.
    fn height(&self, plane: &Plane, texel: [i64; 2], across: [i64; 2], own: bool) -> Option<f64> {
        if self.dark(plane, [0, 1].map(|a| texel[a] + across[a]))? == own || (own && !self.midpoints) {
            return Some(0.0);
        }
        let axis = usize::from(across[0] != 0);
        let along = [i64::from(axis == 0), i64::from(axis == 1)];
        let (before, first) = self.run(plane, texel, across, along.map(|a| -a), own)?;
        let (after, last) = self.run(plane, texel, across, along, own)?;
        // 0 at its beginning, 1 at its end.
        let t = (plane.at[axis] - texel[axis] as f64 + f64::from(before)) / f64::from(before + after + 1);
        if self.midpoints {
            let end = |end| match end {
                End::Here => 0.5,
                End::Away => -0.5,
                End::Open => 0.0,
            };
            return Some(if t < 0.5 { end(first) * (1.0 - 2.0 * t) } else { end(last) * (2.0 * t - 1.0) });
        }
        let opposite = self.dark(plane, [0, 1].map(|a| texel[a] - across[a]))? != own;
        let whole = if opposite { 0.5 } else { 1.0 };
        Some(match [first == End::Here, last == End::Here] {
            [true, true] => whole * (2.0 * t - 1.0).abs(),
            [true, false] => whole * (1.0 - t),
            [false, true] => whole * t,
            [false, false] => 0.0,
        })
    }

    /// Whether a place (texel x, y, depth) of a receiver with this slope (depth per texel) is lit, of a pixel whose first sample is
    /// at `from`; `None` if that is in doubt.
    pub fn is_lit(&self, at: DVec3, from: DVec2, slope: DVec2, doubt: SmsrMargin) -> Option<bool> {
        let plane = Plane { at, from, slope, doubt };
        let texel = [at.x, at.y].map(|v| v.floor() as i64);
        let inside = at.truncate() - DVec2::new(texel[0] as f64, texel[1] as f64);
        let edge = inside.min_element().min((1.0 - inside).min_element());
        if edge < doubt.place {
            return None;
        }
        let dark = self.dark(&plane, texel)?;
        let mut beyond = false;
        for (across, distance) in
            [([-1, 0], inside.x), ([1, 0], 1.0 - inside.x), ([0, -1], inside.y), ([0, 1], 1.0 - inside.y)]
        {
            let height = self.height(&plane, texel, across, dark)?;
            // A line rises by 2 over a texel at most, and the distance changes by 1.
            if (height - distance).abs() < 3.0 * doubt.place {
                return None;
            }
            beyond |= distance < height;
        }
        Some(dark == beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A map that is dark below a line over it, as its texels' centres tell, under a level receiver.
    fn below(size: u32, line: impl Fn(f64) -> f64) -> Vec<Option<f64>> {
        let at = |k: u32| (f64::from(k % size) + 0.5, f64::from(k / size) + 0.5);
        (0..size * size).map(|k| (at(k).1 > line(at(k).0)).then_some(0.25)).collect()
    }

    /// Share of places where a lookup is wrong about a line, and share of those that it draws too dark.
    fn wrong(size: u32, lookup: &SmsrLookup, line: impl Fn(f64) -> f64) -> [f64; 2] {
        let (mut off, mut dark, mut all) = (0, 0, 0);
        for k in 0..250_000u32 {
            let [x, y] = [k % 500, k / 500].map(|v| (f64::from(v) + 0.5) / 500.0 * f64::from(size - 56) + 28.0);
            let lit = lookup
                .is_lit(DVec3::new(x, y, 0.5), DVec2::ZERO, DVec2::ZERO, SmsrMargin::default())
                .expect("no doubt");
            all += 1;
            off += u32::from(lit != (y <= line(x)));
            dark += u32::from(!lit && y <= line(x));
        }
        [off, dark].map(|n| f64::from(n) / f64::from(all))
    }

    /// Straight borders of any slope within reach are drawn nearly where they are by midpoints, only outwards by corners; both far
    /// better than steps.
    #[test]
    fn straight_borders_are_straight() {
        let size = 96;
        for slope in [0.0, 0.07, 0.131, 0.31, 0.47, 0.77, 0.93] {
            let line = |x: f64| 48.3 + slope * (x - 48.0);
            let depths = below(size, line);
            let with =
                |reach, midpoints| SmsrLookup { depths: &depths, size, reach, midpoints, constant: 1e-3, slope: 0.5 };
            let steps = wrong(size, &with(0, true), line);
            let middle = wrong(size, &with(20, true), line);
            let corner = wrong(size, &with(20, false), line);
            if slope == 0.0 {
                assert!(steps == middle && steps == corner, "{steps:?} {middle:?} {corner:?}");
                continue;
            }
            let most = if slope < 0.2 { 0.1 } else { 0.7 };
            assert!(middle[0] < most * steps[0], "slope {slope}: {middle:?} of {steps:?}");
            let drift = (2.0 * middle[1] - middle[0]).abs();
            assert!(drift < 0.3 * steps[0], "slope {slope}: midpoints {middle:?} drift, beside steps {steps:?}");
            assert!(corner[1] > 0.9 * corner[0], "slope {slope}: corners {corner:?} grow the light");
        }
    }

    /// The line of one step: from the corner to the far end, and by midpoints.
    #[test]
    fn one_step_by_hand() {
        // Rows of y: dark from 2 on, from 1 on at x of 6 and more; a border of 4 texels from 2 to 6 ends beside a pit.
        let size = 9;
        let dark = |x: u32, y: u32| y >= 2 && x != 1 || y >= 1 && x >= 6;
        let depths: Vec<_> = (0..81).map(|k| dark(k % 9, k / 9).then_some(0.0)).collect();
        let lookup = |midpoints| SmsrLookup { depths: &depths, size, reach: 8, midpoints, constant: 0.0, slope: 0.5 };
        let lit = |midpoints, x, y| {
            lookup(midpoints)
                .is_lit(DVec3::new(x, y, 0.5), DVec2::ZERO, DVec2::ZERO, SmsrMargin::default())
                .expect("no doubt")
        };
        // Corner: height (x - 2) / 4 over the border at y of 2.
        for (x, height) in [(2.5, 0.125), (4.0, 0.5), (5.5, 0.875)] {
            assert!(!lit(false, x, 2.0 - height + 0.01) && lit(false, x, 2.0 - height - 0.01), "corner at {x}");
        }
        // Midpoints: from half a texel into the dark at 2 to half a texel into the light at 6.
        for (x, height) in [(3.0, -0.25), (3.9, -0.025), (5.0, 0.25), (5.9, 0.475)] {
            assert!(!lit(true, x, 2.0 - height + 0.01) && lit(true, x, 2.0 - height - 0.01), "middle at {x}");
        }
        // What depends on a place within the doubt is not told.
        let doubt = SmsrMargin { place: 0.01, depth: 0.0 };
        assert_eq!(lookup(false).is_lit(DVec3::new(4.0, 1.51, 0.5), DVec2::ZERO, DVec2::ZERO, doubt), None);
        let doubt = SmsrMargin { place: 0.0, depth: 0.6 };
        assert_eq!(lookup(false).is_lit(DVec3::new(4.5, 1.2, 0.5), DVec2::ZERO, DVec2::ZERO, doubt), None);
    }
}
