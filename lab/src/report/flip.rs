//! LDR-FLIP of grey pictures: the difference that a viewer notices when two pictures alternate.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: *FLIP: A Difference Evaluator for Alternating
//! Images*, HPG 2020, sections 4 and 5. For grey pictures the opponent channels are 0, so one filter and the lightness
//! are what is left of the colour pipeline, and every kernel splits into a row and a column.

use rayon::prelude::*;
use std::f64::consts::PI;
use subpixel_shadows::{Error, Result};

/// Pixels per degree of the paper's default viewing: a 0.7 m wide screen of 3840 pixels seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;

/// The FLIP map of two pictures of `width` × `height` grey values in `[0, 1]`, taken as sRGB-encoded, which is how
/// visibility is shown; each value in `[0, 1]`. Symmetric, and 0 where neighbourhoods are equal.
///
/// # Errors
/// [`Error::Config`] if the sizes do not agree or `pixels_per_degree` is not positive and finite.
pub fn flip(width: u32, height: u32, truth: &[f32], ours: &[f32], pixels_per_degree: f64) -> Result<Vec<f32>> {
    let (w, h) = (width as usize, height as usize);
    if w == 0 || h == 0 || truth.len() != w * h || ours.len() != w * h {
        let (a, b) = (truth.len(), ours.len());
        return Err(Error::Config(format!("FLIP of {a} and {b} pixels for pictures of {width} x {height}")));
    }
    if !(pixels_per_degree > 0.0 && pixels_per_degree.is_finite()) {
        return Err(Error::Config(format!("FLIP at {pixels_per_degree} pixels per degree")));
    }
    let kernels = Kernels::new(pixels_per_degree);
    let (a, b) = (View::new(truth, w, &kernels), View::new(ours, w, &kernels));
    let largest = largest_difference();
    Ok((0..w * h)
        .map(|k| {
            let colour = redistribute((a.lightness[k] - b.lightness[k]).abs().powf(0.7), largest);
            let feature = (a.edges[k] - b.edges[k]).abs().max((a.points[k] - b.points[k]).abs());
            let feature = (feature / 2.0f64.sqrt()).sqrt().clamp(0.0, 1.0);
            colour.powf(1.0 - feature) as f32
        })
        .collect())
}

/// The mean of the [`flip`] map.
///
/// # Errors
/// As [`flip`].
pub fn mean_flip(width: u32, height: u32, truth: &[f32], ours: &[f32]) -> Result<f64> {
    let map = flip(width, height, truth, ours, PIXELS_PER_DEGREE)?;
    Ok(map.iter().map(|&v| f64::from(v)).sum::<f64>() / map.len() as f64)
}

/// Features of one picture that are compared.
struct View {
    lightness: Vec<f64>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl View {
    fn new(picture: &[f32], w: usize, kernels: &Kernels) -> Self {
        let linear: Vec<f64> = picture.iter().map(|&v| srgb_to_linear(f64::from(v).clamp(0.0, 1.0))).collect();
        let contrast = &kernels.contrast;
        let lightness =
            convolve(&linear, w, contrast, contrast).iter().map(|&y| lightness(y.clamp(0.0, 1.0))).collect();
        let length = |kernel: &[f64]| -> Vec<f64> {
            let x = convolve(&linear, w, kernel, &kernels.smooth);
            let y = convolve(&linear, w, &kernels.smooth, kernel);
            x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).collect()
        };
        Self { lightness, edges: length(&kernels.edge), points: length(&kernels.point) }
    }
}

/// One-dimensional kernels of odd length.
struct Kernels {
    /// Contrast sensitivity of the eye to lightness.
    contrast: Vec<f64>,
    /// Gaussian, its first and its second derivative, at the width of features.
    smooth: Vec<f64>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

impl Kernels {
    fn new(pixels_per_degree: f64) -> Self {
        let sample = |radius: f64, f: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let r = radius.ceil() as i64;
            (-r..=r).map(|x| f(x as f64)).collect()
        };
        // The radius is that of the widest of the three opponent filters, 0.04 of blue and yellow.
        let radius = 3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * pixels_per_degree;
        let contrast = sample(radius, &|x| (-(PI * x / pixels_per_degree).powi(2) / 0.0047).exp());
        let deviation = 0.5 * 0.082 * pixels_per_degree;
        let gauss = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        let detail = |f: &dyn Fn(f64) -> f64| sample(3.0 * deviation, &|x| f(x) * gauss(x));
        Self {
            contrast: balanced(contrast),
            smooth: balanced(detail(&|_| 1.0)),
            edge: balanced(detail(&|x| -x)),
            point: balanced(detail(&|x| (x / deviation).powi(2) - 1.0)),
        }
    }
}

/// The kernel with its positive part scaled to a sum of 1, its negative part to −1.
fn balanced(mut kernel: Vec<f64>) -> Vec<f64> {
    let part = |positive: bool| kernel.iter().filter(|v| (**v > 0.0) == positive).sum::<f64>().abs();
    let (above, below) = (part(true), part(false));
    for v in &mut kernel {
        let sum = if *v > 0.0 { above } else { below };
        *v = if sum > 0.0 { *v / sum } else { 0.0 };
    }
    kernel
}

/// Rows by `across`, then columns by `down`; the picture goes on beyond its border with its border pixels.
fn convolve(picture: &[f64], w: usize, across: &[f64], down: &[f64]) -> Vec<f64> {
    let h = picture.len() / w;
    let near = |at: usize, k: usize, radius: usize, n: usize| (at + k).saturating_sub(radius).min(n - 1);
    let mut rows = vec![0.0; picture.len()];
    rows.par_chunks_mut(w).zip(picture.par_chunks(w)).for_each(|(out, row)| {
        for (x, o) in out.iter_mut().enumerate() {
            *o = across.iter().enumerate().map(|(k, a)| a * row[near(x, k, across.len() / 2, w)]).sum();
        }
    });
    let mut out = vec![0.0; picture.len()];
    out.par_chunks_mut(w).enumerate().for_each(|(y, out)| {
        for (k, d) in down.iter().enumerate() {
            let row = near(y, k, down.len() / 2, h) * w;
            out.iter_mut().zip(&rows[row..row + w]).for_each(|(o, r)| *o += d * r);
        }
    });
    out
}

fn srgb_to_linear(v: f64) -> f64 {
    if v > 0.04045 { ((v + 0.055) / 1.055).powf(2.4) } else { v / 12.92 }
}

/// The cube root of CIELAB, with its linear part near 0.
fn lab_root(t: f64) -> f64 {
    let delta = 6.0f64 / 29.0;
    if t > delta.powi(3) { t.cbrt() } else { t / (3.0 * delta * delta) + 4.0 / 29.0 }
}

fn lightness(y: f64) -> f64 {
    116.0 * lab_root(y) - 16.0
}

/// Distance of pure green and pure blue after the Hunt adjustment, the largest there is, raised to 0.7.
fn largest_difference() -> f64 {
    // Columns of the matrix from linear sRGB to XYZ, over the white point.
    let lab = |xyz: [f64; 3]| {
        let [x, y, z] = xyz.map(lab_root);
        let l = 116.0 * y - 16.0;
        [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
    };
    let white = [
        (10_135_552.0 + 8_788_810.0 + 4_435_075.0) / 24_577_794.0,
        1.0,
        (1_425_312.0 + 8_788_810.0 + 70_074_185.0) / 73_733_382.0,
    ];
    let green = [8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0];
    let blue = [4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0];
    let over_white = |c: [f64; 3]| lab([c[0] / white[0], c[1] / white[1], c[2] / white[2]]);
    let (g, b) = (over_white(green), over_white(blue));
    ((g[0] - b[0]).abs() + (g[1] - b[1]).hypot(g[2] - b[2])).powf(0.7)
}

/// Spreads the differences so that those up to 0.4 of the largest take 0.95 of the range.
fn redistribute(difference: f64, largest: f64) -> f64 {
    let knee = 0.4 * largest;
    if difference < knee { 0.95 / knee * difference } else { 0.95 + (difference - knee) / (largest - knee) * 0.05 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (64, 48);

    /// Stripes, a disc, a soft disc and a diagonal step.
    fn picture(k: usize) -> Vec<f32> {
        let at = |x: f64, y: f64| match k {
            0 => ((x * 3.0 + y * 5.0) % 33.0) / 32.0,
            1 => f64::from((x - 30.0).powi(2) + (y - 20.0).powi(2) < 200.0),
            2 => ((x - 30.5).hypot(y - 20.25) - 14.0).clamp(0.0, 1.0),
            _ => {
                if x + y > 50.0 {
                    1.0
                } else {
                    0.25
                }
            }
        };
        (0..SIZE.0 * SIZE.1).map(|p| at(f64::from(p % SIZE.0), f64::from(p / SIZE.0)) as f32).collect()
    }

    #[test]
    fn matches_the_authors_program() {
        // Means and values at (0,0), (30,20), (20,30), (63,47) of flip-evaluator 1.7, LDR, default viewing.
        let expected = [
            (0, 1, 0.914_017_379, [0.596_071_005, 0.620_844_960, 0.870_936_096, 0.982_172_787]),
            (1, 2, 0.948_363_781, [0.967_388_332, 0.967_388_332, 0.196_619_168, 0.967_388_332]),
            (2, 3, 0.548_473_418, [0.957_370_222, 0.991_965_294, 0.023_393_685, 0.0]),
            (3, 3, 0.0, [0.0; 4]),
        ];
        for (a, b, mean, values) in expected {
            let (a, b) = (picture(a), picture(b));
            let map = flip(SIZE.0, SIZE.1, &a, &b, PIXELS_PER_DEGREE).unwrap();
            for ((x, y), value) in [(0, 0), (30, 20), (20, 30), (63, 47)].into_iter().zip(values) {
                let ours = f64::from(map[x + y * 64]);
                assert!((ours - value).abs() < 1e-3, "({x}, {y}): {ours} for {value}");
            }
            let ours = mean_flip(SIZE.0, SIZE.1, &a, &b).unwrap();
            assert!((ours - mean).abs() < 1e-4, "{ours} for {mean}");
        }
    }

    #[test]
    fn notices_one_changed_pixel_and_is_symmetric() {
        let a = picture(1);
        let mut b = a.clone();
        b[30 + 20 * 64] = 0.0;
        let there = mean_flip(SIZE.0, SIZE.1, &a, &b).unwrap();
        assert!(there > 0.0);
        assert_eq!(there, mean_flip(SIZE.0, SIZE.1, &b, &a).unwrap());
        assert!(flip(64, 48, &a, &b[1..], PIXELS_PER_DEGREE).is_err());
        assert!(flip(64, 48, &a, &b, 0.0).is_err());
    }
}
