//! Where the nearest layer may be no single sheet over the whole texel.

use super::light_layers::{Layer, any_everywhere};
use super::triangle_setup::Triangle;
use super::view::{Cut, Flat, by_rows, centre, columns};

/// How far conservative tests reach out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margin {
    /// Texels.
    pub texels: f64,
    /// Depth.
    pub depth: f64,
}

impl Margin {
    /// Both, times `factor`.
    pub fn times(self, factor: f64) -> Self {
        Self { texels: self.texels * factor, depth: self.depth * factor }
    }
}

/// State of a texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Split {
    /// Silhouettes or uncertain layers.
    Marked,
    /// No caster.
    Uncovered,
    /// One sheet lies before this depth and covers the texel, all else lies behind it.
    At(f64),
}

/// Marks every texel that a triangle touches without a layer at the centre, or at a range of depths that holds the split depth; of an alpha-tested
/// one, at a depth before that; of one that reaches behind the light, without holding the texel.
pub fn marks(triangles: &[Triangle], layers: &[Layer], size: u32, margin: Margin) -> Vec<bool> {
    if any_everywhere(triangles) {
        return vec![true; layers.len()];
    }
    let figures: Vec<Option<Flat>> = triangles.iter().map(Triangle::flat).collect();
    let reach = 0.5 + margin.texels;
    let cuts: Vec<(Cut, bool)> = triangles.iter().filter_map(|t| Some((t.cut()?, t.tested.is_some()))).collect();
    let crossed = |texel: usize, (lo, hi): (f64, f64), tested: bool| {
        layers[texel].split().is_none_or(|split| lo <= split && (hi >= split || tested))
    };
    by_rows(&figures, size, reach, |y, list, row| {
        for (x, marked) in row.iter_mut().enumerate() {
            let (at, texel) = (centre(x as u32, y), y as usize * size as usize + x);
            *marked = cuts.iter().any(|(cut, tested)| {
                let open = || !cut.holds(at, margin) || crossed(texel, cut.depth_range(at, reach, margin), *tested);
                cut.touches(at, reach) && open()
            });
        }
        for &t in list {
            let Some(flat) = &figures[t as usize] else { continue };
            for x in columns(flat, reach, size) {
                let at = centre(x, y);
                if row[x as usize] || !flat.touches(at, reach) {
                    continue;
                }
                let range = flat.depth_range(at, reach, margin.depth);
                row[x as usize] = crossed((y * size + x) as usize, range, triangles[t as usize].tested.is_some());
            }
        }
    })
}

/// State of every texel, from marks and layers.
pub fn settle(layers: &[Layer], marked: &[bool]) -> Vec<Split> {
    let one = |(layer, &marked): (&Layer, &bool)| match layer.split() {
        _ if marked => Split::Marked,
        None => Split::Uncovered,
        Some(depth) => Split::At(depth),
    };
    layers.iter().zip(marked).map(one).collect()
}
