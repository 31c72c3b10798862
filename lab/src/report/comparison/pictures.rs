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

/// The part of each panel that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PanelCut {
    /// Its corner on the left at the top, pixels.
    pub corner: [u32; 2],
    /// Its width and height, pixels.
    pub size: [u32; 2],
    /// Pixels of the picture to one of it, in each direction.
    pub zoom: u32,
    /// Factor of differences.
    pub gain: f32,
}

impl PanelCut {
    /// The middle quarter of an image: half its width, half its height, so that pixels show.
    pub fn middle(size: [u32; 2]) -> Self {
        let cut = middle_of(size);
        Self { corner: [0, 1].map(|k| (size[k] - cut[k]) / 2), size: cut, zoom: 1, gain: 1.0 }
    }

    /// A part of an image, given by shares of it: left, top, width, height. At least a pixel, and within the image.
    pub fn part(size: [u32; 2], [left, top, width, height]: [f32; 4], zoom: u32, gain: f32) -> Self {
        let share = |k: usize, share: f32| (share * size[k] as f32).round() as u32;
        let corner = [share(0, left).min(size[0] - 1), share(1, top).min(size[1] - 1)];
        let sides = [share(0, width).clamp(1, size[0] - corner[0]), share(1, height).clamp(1, size[1] - corner[1])];
        Self { corner, size: sides, zoom, gain }
    }
}

/// Writes the panels from left to right, [`ACROSS`] in a row, of each what is cut out, and below it its difference from truth.
///
/// # Errors
/// [`subpixel_shadows::Error::Config`] if a panel is of another size; [`subpixel_shadows::Error::File`] naming `path` if it cannot be written.
pub fn side_by_side(path: &Path, size: [u32; 2], cut: PanelCut, panels: &[Panel]) -> Result<()> {
    let [w, h] = size.map(|s| s as usize);
    if panels.is_empty() || panels.iter().any(|p| p.ours.len() != w * h || p.truth.len() != w * h) {
        return Err(subpixel_shadows::Error::Config(format!(
            "{} panels that are not all of {w} x {h} pixels",
            panels.len()
        )));
    }
    let zoom = cut.zoom as usize;
    let [cut_w, cut_h] = cut.size.map(|side| side as usize * zoom);
    let across = panels.len().min(ACROSS);
    let down = panels.len().div_ceil(ACROSS);
    let (all_w, all_h) = (across * (cut_w + GAP) - GAP, down * (2 * cut_h + 2 * GAP) - GAP);
    let mut pixels = vec![[255; 3]; all_w * all_h];
    for (n, panel) in panels.iter().enumerate() {
        for y in 0..cut_h {
            for x in 0..cut_w {
                let [left, top] = cut.corner.map(|c| c as usize);
                let from = (top + y / zoom) * w + left + x / zoom;
                let (column, row) = (n % ACROSS, n / ACROSS);
                let to = (row * (2 * cut_h + 2 * GAP) + y) * all_w + column * (cut_w + GAP) + x;
                let (ours, truth) = (panel.ours[from], panel.truth[from]);
                pixels[to] = [(ours.clamp(0.0, 1.0) * 255.0).round() as u8; 3];
                pixels[to + (cut_h + GAP) * all_w] = difference_colour(truth + cut.gain * (ours - truth), truth);
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
        side_by_side(&path, [8, 8], PanelCut::middle([8, 8]), &[blank, panel]).unwrap();
        let image = image::open(&path).unwrap().to_rgb8();
        assert_eq!(image.dimensions(), (12, 12));
        let many = vec![Panel { ours: vec![1.0; 64], truth: vec![1.0; 64] }; 5];
        side_by_side(&path, [8, 8], PanelCut::middle([8, 8]), &many).unwrap();
        assert_eq!(image::open(&path).unwrap().to_rgb8().dimensions(), (28, 28));
        assert_eq!(image.get_pixel(8, 0).0, [255; 3]);
        assert_eq!(image.get_pixel(9, 0).0, [0; 3]);
        assert_ne!(image.get_pixel(8, 8).0, image.get_pixel(9, 8).0);
        assert_eq!(image.get_pixel(4, 0).0, [255; 3], "the gap");
        let large = PanelCut { zoom: 3, ..PanelCut::part([8, 8], [0.25, 0.25, 0.125, 0.125], 3, 1.0) };
        assert_eq!((large.corner, large.size), ([2, 2], [1, 1]));
        side_by_side(&path, [8, 8], large, &many[..1]).unwrap();
        let image = image::open(&path).unwrap().to_rgb8();
        assert_eq!(image.dimensions(), (3, 6 + GAP as u32));
        assert!((0..9).all(|k| image.get_pixel(k % 3, k / 3).0 == [255; 3]));
        assert_eq!(PanelCut::part([4, 4], [2.0, 0.0, 9.0, 9.0], 1, 1.0).size, [1, 4]);
        std::fs::remove_file(&path).unwrap();
        assert!(side_by_side(&path, [8, 8], PanelCut::middle([8, 8]), &[Panel::default()]).is_err());
        assert!(side_by_side(&path, [8, 8], PanelCut::middle([8, 8]), &[]).is_err());
    }
}
