//! Pictures side by side: visibility above, its difference from truth below.

use crate::report::picture::{difference_colour, write_png_rgb};
use std::path::Path;
use subpixel_shadows::Result;

/// One method's picture and the truth it is held against, visibility row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// The picture.
    pub ours: Vec<f32>,
    /// The truth.
    pub truth: Vec<f32>,
}

/// Pixels between panels.
pub const GAP: usize = 4;
/// Panels in a row.
pub const ACROSS: usize = 4;

/// Pixels of a panel of an image.
pub fn middle_of(size: [u32; 2]) -> [u32; 2] {
    size.map(|side| side.div_ceil(2))
}

/// Writes the panels from left to right, [`ACROSS`] in a row, the middle quarter (half the width, half the height) of each so that pixels show.
///
/// # Errors
/// [`subpixel_shadows::Error::Config`] if a panel is of another size; [`subpixel_shadows::Error::File`] naming `path` if it cannot be written.
pub fn side_by_side(path: &Path, size: [u32; 2], panels: &[Panel]) -> Result<()> {
    let [w, h] = size.map(|s| s as usize);
    if panels.is_empty() || panels.iter().any(|p| p.ours.len() != w * h || p.truth.len() != w * h) {
        return Err(subpixel_shadows::Error::Config(format!(
            "{} panels that are not all of {w} x {h} pixels",
            panels.len()
        )));
    }
    let [cut_w, cut_h] = middle_of(size).map(|s| s as usize);
    let (left, top) = ((w - cut_w) / 2, (h - cut_h) / 2);
    let across = panels.len().min(ACROSS);
    let down = panels.len().div_ceil(ACROSS);
    let (all_w, all_h) = (across * (cut_w + GAP) - GAP, down * (2 * cut_h + 2 * GAP) - GAP);
    let mut pixels = vec![[255; 3]; all_w * all_h];
    for (n, panel) in panels.iter().enumerate() {
        for y in 0..cut_h {
            for x in 0..cut_w {
                let from = (top + y) * w + left + x;
                let (column, row) = (n % ACROSS, n / ACROSS);
                let to = (row * (2 * cut_h + 2 * GAP) + y) * all_w + column * (cut_w + GAP) + x;
                let (ours, truth) = (panel.ours[from], panel.truth[from]);
                pixels[to] = [(ours.clamp(0.0, 1.0) * 255.0).round() as u8; 3];
                pixels[to + (cut_h + GAP) * all_w] = difference_colour(ours, truth);
            }
        }
    }
    write_png_rgb(path, all_w as u32, all_h as u32, &pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_each_panel_is_shown() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-panels-{}.png", std::process::id()));
        let mut ours = vec![0.0; 64];
        ours[8 * 2 + 2] = 1.0;
        let panel = Panel { ours, truth: vec![0.0; 64] };
        let blank = Panel { ours: vec![0.0; 64], truth: vec![0.0; 64] };
        side_by_side(&path, [8, 8], &[blank, panel]).unwrap();
        let image = image::open(&path).unwrap().to_rgb8();
        assert_eq!(image.dimensions(), (12, 12));
        let many = vec![Panel { ours: vec![1.0; 64], truth: vec![1.0; 64] }; 5];
        side_by_side(&path, [8, 8], &many).unwrap();
        assert_eq!(image::open(&path).unwrap().to_rgb8().dimensions(), (28, 28));
        assert_eq!(image.get_pixel(8, 0).0, [255; 3]);
        assert_eq!(image.get_pixel(9, 0).0, [0; 3]);
        assert_ne!(image.get_pixel(8, 8).0, image.get_pixel(9, 8).0);
        assert_eq!(image.get_pixel(4, 0).0, [255; 3], "the gap");
        std::fs::remove_file(&path).unwrap();
        assert!(side_by_side(&path, [8, 8], &[Panel::default()]).is_err());
        assert!(side_by_side(&path, [8, 8], &[]).is_err());
    }
}
