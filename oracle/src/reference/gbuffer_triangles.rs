//! Definition of reading a G-buffer of several samples a pixel.

/// Triangles that a pixel's samples show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PixelSamples {
    /// The different triangles, in the order of their first samples.
    pub triangles: Vec<u32>,
    /// All samples show the same triangle.
    pub single: bool,
}

impl PixelSamples {
    /// Whether its samples must be searched one by one.
    pub fn complex(&self) -> bool {
        !self.triangles.is_empty() && !self.single
    }
}

/// Meaning of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TexelMeaning {
    /// No triangle.
    Nothing,
    /// A number of no triangle.
    Unknown,
    /// This triangle of the casters.
    Triangle(u32),
}

/// Meaning of a texel, of an application that counts from `first` and writes `none` for no triangle.
pub fn shown(id: u32, first: u32, none: u32, numbers: &[u32]) -> TexelMeaning {
    if id == none {
        return TexelMeaning::Nothing;
    }
    let named = id.checked_sub(first).and_then(|n| numbers.get(n as usize));
    named.map_or(TexelMeaning::Unknown, |&t| TexelMeaning::Triangle(t))
}

/// Triangles that each pixel's samples show, and how many samples name no triangle. `layers` has the texels of each sample.
pub fn pixels(layers: &[Vec<u32>], first: u32, none: u32, numbers: &[u32]) -> (Vec<PixelSamples>, u32) {
    let count = layers.first().map_or(0, Vec::len);
    let mut unknown = 0;
    let mut pixels = vec![PixelSamples { single: true, ..PixelSamples::default() }; count];
    for (texel, pixel) in layers.iter().flat_map(|layer| layer.iter().zip(0..)) {
        let shown = shown(*texel, first, none, numbers);
        unknown += u32::from(shown == TexelMeaning::Unknown);
        let pixel: &mut PixelSamples = &mut pixels[pixel as usize];
        match shown {
            TexelMeaning::Triangle(t) if !pixel.triangles.contains(&t) => pixel.triangles.push(t),
            TexelMeaning::Triangle(_) => {}
            _ => pixel.single = false,
        }
    }
    pixels.iter_mut().for_each(|p| p.single &= p.triangles.len() == 1);
    (pixels, unknown)
}

/// The nearest of `theirs` to each of `ours`, of equally near ones the first.
pub fn nearest(ours: &[[f32; 2]], theirs: &[[f32; 2]]) -> Vec<usize> {
    let distance = |a: &[f32; 2], b: &[f32; 2]| (f64::from(a[0] - b[0])).hypot(f64::from(a[1] - b[1]));
    let of = |a| {
        let mut best = 0;
        (1..theirs.len()).for_each(|k| {
            if distance(a, &theirs[k]) < distance(a, &theirs[best]) {
                best = k;
            }
        });
        best
    };
    ours.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_triangle_everywhere_is_single() {
        let layers = [vec![5, 5, 9, 9, 5], vec![5, 6, 9, 5, 77]];
        let (got, unknown) = pixels(&layers, 5, 9, &[3, 1]);
        let triangles: Vec<_> = got.iter().map(|p| p.triangles.clone()).collect();
        assert_eq!(triangles, [vec![3], vec![3, 1], vec![], vec![3], vec![3]]);
        assert_eq!(got.iter().map(PixelSamples::complex).collect::<Vec<_>>(), [false, true, false, true, true]);
        assert!(got[0].single && !got[2].single && unknown == 1);
        assert_eq!(nearest(&[[0.4, 0.5], [0.9, 0.9]], &[[0.5, 0.5], [0.3, 0.5], [0.99, 0.9]]), [0, 2]);
    }
}
