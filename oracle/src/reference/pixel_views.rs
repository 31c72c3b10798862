//! Which of several views of the light a pixel asks.

use glam::DVec3;
use subpixel_shadows::light_view::LightView;

/// How far within the map of a view the outermost of some points lies, texels; below 0 outside, and infinitely far outside where one is
/// not in front of the view, whose rows take these points.
pub fn inset(view: &LightView, points: &[DVec3]) -> f64 {
    let side = f64::from(view.map_size);
    let of_point =
        |p: &DVec3| view.project(*p).map_or(f64::NEG_INFINITY, |at| at.x.min(at.y).min(side - at.x).min(side - at.y));
    points.iter().map(of_point).fold(f64::INFINITY, f64::min)
}

/// The first view with an inset of at least `reach`, else the first with the greatest.
pub fn chosen(insets: &[f64], reach: f64) -> usize {
    let greatest = insets.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let within = insets.iter().position(|&i| i >= reach);
    within.or_else(|| insets.iter().position(|&i| i == greatest)).unwrap_or(0)
}

/// Whether `view` may be chosen where each inset may be off by its `doubts`.
pub fn may_be_chosen(view: usize, insets: &[f64], doubts: &[f64], reach: f64) -> bool {
    let (Some(&own), Some(&doubt)) = (insets.get(view), doubts.get(view)) else { return false };
    let least = |k: usize| insets[k] - doubts[k];
    let greatest = own + doubt;
    let first = greatest >= reach && (0..view).all(|k| least(k) < reach);
    let most = (0..insets.len()).all(|k| least(k) < reach && (k == view || least(k) <= greatest));
    first || most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_that_holds_a_pixel_is_asked() {
        assert_eq!(chosen(&[0.5, 3.0, 9.0], 1.0), 1);
        assert_eq!(chosen(&[0.5, -3.0, 0.75], 1.0), 2);
        assert_eq!(chosen(&[f64::NEG_INFINITY; 2], 1.0), 0);
        for (insets, view) in [([0.5, 3.0, 9.0], 1), ([0.5, -3.0, 0.75], 2)] {
            for other in 0..3 {
                assert_eq!(may_be_chosen(other, &insets, &[0.01; 3], 1.0), other == view, "{insets:?}, {other}");
            }
        }
        assert!([0, 1].iter().all(|&view| may_be_chosen(view, &[0.99, 3.0], &[0.02; 2], 1.0)));
    }
}
