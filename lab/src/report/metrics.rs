//! Error of a picture of visibility against a truth.
//!
//! Every figure is given over the whole image and over the *silhouette band*: the pixels whose truth is neither all lit
//! nor all dark, grown by one pixel. Most pixels of most pictures are easy, so whole-image figures flatter.

use oracle::truth::{bits, join_mask};
use serde::Serialize;
use subpixel_shadows::{Error, Result};

/// A picture of visibility that counts as true.
#[derive(Clone, Copy, Debug)]
pub struct Truth<'a> {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples a pixel; a pixel matches if it is within one sample.
    pub samples: u32,
    /// Visibility in `[0, 1]`, row by row from the top.
    pub visibility: &'a [f32],
}

/// Errors over some pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// How many pixels.
    pub pixels: u64,
    /// Root of the mean squared difference; `None` without pixels, as the next two.
    pub rmse: Option<f64>,
    /// Mean absolute difference.
    pub mean: Option<f64>,
    /// Largest absolute difference.
    pub max: Option<f64>,
    /// Share of the pixels within `1/samples` of truth; `None` without pixels, and with one sample, of which every picture is within 1.
    pub pixel_match: Option<f64>,
}

/// Errors of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Metrics {
    /// Over the whole image.
    pub whole: Errors,
    /// Over the silhouette band.
    pub band: Errors,
    /// Pixels that are fully lit in truth, less than that here by more than [`SHOWN`], and have no pixel of the band within one pixel:
    /// surfaces that shadow themselves.
    pub acne_pixels: u64,
    /// Pixels that are fully dark in truth and lit here by more than [`SHOWN`].
    pub leak_pixels: u64,
}

/// The least difference that a picture of 8 bits shows: half a step. Bounds of moments reach neither light nor dark quite.
pub const SHOWN: f32 = 0.5 / 255.0;

/// A difference that is one sample, give or take the rounding of `f32` shares.
const ROUNDING: f64 = 1e-6;

impl Truth<'_> {
    fn check(&self, ours: &[f32]) -> Result<()> {
        let pixels = self.width as usize * self.height as usize;
        if self.visibility.len() != pixels || ours.len() != pixels || self.samples == 0 {
            return Err(Error::Config(format!(
                "a picture of {} pixels against a truth of {} for an image of {} x {} with {} samples",
                ours.len(),
                self.visibility.len(),
                self.width,
                self.height,
                self.samples
            )));
        }
        Ok(())
    }

    /// Whether each pixel lies in the silhouette band.
    pub fn band(&self) -> Vec<bool> {
        let mixed: Vec<bool> = self.visibility.iter().map(|&v| v > 0.0 && v < 1.0).collect();
        self.grown(&mixed)
    }

    fn grown(&self, marked: &[bool]) -> Vec<bool> {
        let (w, h) = (self.width as usize, self.height as usize);
        let mut out = vec![false; marked.len()];
        for (at, _) in marked.iter().enumerate().filter(|(_, m)| **m) {
            let (i, j) = (at % w, at / w);
            for y in j.saturating_sub(1)..(j + 2).min(h) {
                out[y * w + i.saturating_sub(1)..y * w + (i + 2).min(w)].fill(true);
            }
        }
        out
    }

    /// All metrics of the picture `ours` (visibility, row by row from the top).
    ///
    /// A value that is not a number counts as an error of 1.
    ///
    /// # Errors
    /// [`Error::Config`] if the sizes do not agree or there are no samples.
    pub fn compare(&self, ours: &[f32]) -> Result<Metrics> {
        self.check(ours)?;
        let band = self.band();
        let near_band = self.grown(&band);
        let pairs = || self.visibility.iter().zip(ours).zip(&band);
        let mut metrics = Metrics {
            whole: self.errors(pairs().map(|((t, o), _)| (*t, *o))),
            band: self.errors(pairs().filter(|(_, b)| **b).map(|((t, o), _)| (*t, *o))),
            ..Metrics::default()
        };
        for (((&t, &o), _), &near) in pairs().zip(&near_band) {
            let below = o < 1.0 - SHOWN || o.is_nan();
            metrics.acne_pixels += u64::from(t == 1.0 && below && !near);
            metrics.leak_pixels += u64::from(t == 0.0 && o > SHOWN);
        }
        Ok(metrics)
    }

    fn errors(&self, pairs: impl Iterator<Item = (f32, f32)>) -> Errors {
        let within = 1.0 / f64::from(self.samples) + ROUNDING;
        let (mut n, mut squares, mut sum, mut max, mut matching) = (0u64, 0.0, 0.0, 0.0f64, 0u64);
        for (t, o) in pairs {
            let d = f64::from(o) - f64::from(t);
            let d = if d.is_nan() { 1.0 } else { d.abs() };
            n += 1;
            squares += d * d;
            sum += d;
            max = max.max(d);
            matching += u64::from(d <= within);
        }
        if n == 0 {
            return Errors::default();
        }
        let count = n as f64;
        Errors {
            pixels: n,
            rmse: Some((squares / count).sqrt()),
            mean: Some(sum / count),
            max: Some(max),
            pixel_match: (self.samples > 1).then(|| matching as f64 / count),
        }
    }
}

/// Samples of `ours` that differ from `truth` among those of `asked`, without and with those that are ambiguous:
/// `(outside the band, all)`. One mask a pixel; `ambiguous(pixel)` is asked for pixels with a difference only.
///
/// # Errors
/// [`Error::Config`] if there are not as many masks of each kind.
pub fn wrong_samples(
    asked: &[[u32; 4]],
    truth: &[[u32; 4]],
    ours: &[[u32; 4]],
    mut ambiguous: impl FnMut(usize) -> [u32; 4],
) -> Result<(u64, u64)> {
    if truth.len() != ours.len() || asked.len() != ours.len() {
        let (a, t, o) = (asked.len(), truth.len(), ours.len());
        return Err(Error::Config(format!("{o} masks against {t} of truth, {a} asked for")));
    }
    let (mut outside, mut all) = (0, 0);
    for (pixel, ((a, t), o)) in asked.iter().zip(truth).zip(ours).enumerate() {
        let wrong = (join_mask(*t) ^ join_mask(*o)) & join_mask(*a);
        if wrong != 0 {
            let doubt = join_mask(ambiguous(pixel));
            all += u64::from(wrong.count_ones());
            outside += bits(wrong & !doubt).count() as u64;
        }
    }
    Ok((outside, all))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 8 × 3: dark, dark, half, lit, lit, … in each row.
    fn row() -> Vec<f32> {
        [0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0].repeat(3)
    }

    fn truth(visibility: &[f32]) -> Truth<'_> {
        Truth { width: 8, height: 3, samples: 32, visibility }
    }

    #[test]
    fn equal_pictures_have_no_error() {
        let t = row();
        let m = truth(&t).compare(&t).unwrap();
        let none = Some(0.0);
        let errors = |pixels| Errors { pixels, rmse: none, mean: none, max: none, pixel_match: Some(1.0) };
        assert_eq!(m, Metrics { whole: errors(24), band: errors(9), acne_pixels: 0, leak_pixels: 0 });
    }

    #[test]
    fn each_fault_shows_in_its_figure() {
        let t = row();
        let with = |at: usize, v: f32| {
            let mut o = t.clone();
            o[at] = v;
            truth(&t).compare(&o).unwrap()
        };
        let one_sample = with(2, 0.5 + 1.0 / 32.0);
        assert_eq!((one_sample.whole.pixel_match, one_sample.whole.max), (Some(1.0), Some(1.0 / 32.0)));
        let edge = with(2, 0.75);
        assert_eq!(edge.band.max, Some(0.25));
        let close = |value: Option<f64>, to: f64| value.is_some_and(|v| (v - to).abs() < 1e-12);
        assert!(close(edge.band.rmse, 0.25 / 3.0));
        assert!(close(edge.whole.mean, 0.25 / 24.0));
        assert!(close(edge.band.pixel_match, 8.0 / 9.0));
        assert_eq!((edge.acne_pixels, edge.leak_pixels), (0, 0));
        let acne = with(6, 0.9);
        assert_eq!((acne.acne_pixels, acne.leak_pixels, acne.band.max), (1, 0, Some(0.0)));
        assert_eq!(with(4, 0.9).acne_pixels, 0, "next to the band it is an edge");
        assert_eq!(with(0, 0.1).leak_pixels, 1);
        assert_eq!((with(0, 0.001).leak_pixels, with(6, 0.999).acne_pixels), (0, 0), "no picture shows it");
        assert_eq!((with(0, 0.002).leak_pixels, with(6, 0.998).acne_pixels), (1, 1));
        let broken = with(7, f32::NAN);
        assert_eq!((broken.whole.max, broken.acne_pixels), (Some(1.0), 1));
    }

    /// No perfect score of a band that is not there, nor of "within one sample" where one sample is all there is.
    #[test]
    fn what_says_nothing_has_no_figure() {
        let lit = [1.0; 24];
        let m = truth(&lit).compare(&lit).unwrap();
        assert_eq!((m.band, m.whole.pixel_match), (Errors::default(), Some(1.0)));
        assert_eq!([m.band.rmse, m.band.mean, m.band.max, m.band.pixel_match], [None; 4]);
        let one = Truth { samples: 1, ..truth(&lit) }.compare(&[0.0; 24]).unwrap();
        assert_eq!((one.whole.pixel_match, one.whole.rmse), (None, Some(1.0)));
    }

    #[test]
    fn refuses_pictures_of_other_sizes() {
        let t = row();
        assert!(truth(&t).compare(&t[1..]).is_err());
        assert!(Truth { samples: 0, ..truth(&t) }.compare(&t).is_err());
        assert!(wrong_samples(&[[0; 4]], &[[0; 4]], &[], |_| [0; 4]).is_err());
    }

    #[test]
    fn wrong_samples_are_asked_about_where_they_differ() {
        let t = [[0b1111, 0, 0, 1], [7, 0, 0, 0], [0; 4]];
        let mut o = t;
        o[0] = [0b0101, 0, 0, 0];
        o[2] = [0b100, 0, 0, 0];
        let mut asked_about = Vec::new();
        let all = [[0b1111, 0, 0, 1]; 3];
        let count = wrong_samples(&all, &t, &o, |p| {
            asked_about.push(p);
            [0b0010, 0, 0, 0]
        });
        assert_eq!((count.unwrap(), asked_about), ((3, 4), vec![0, 2]));
        assert_eq!(wrong_samples(&[[1, 0, 0, 0]; 3], &t, &o, |_| [0; 4]).unwrap(), (0, 0));
        assert_eq!(wrong_samples(&all, &t, &t, |_| [0; 4]).unwrap(), (0, 0));
    }
}
