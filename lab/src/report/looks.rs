//! Pictures of what a method knew: the classes of pixels, and the light-view map.

use super::picture::write_png_rgb;
use std::path::Path;
use subpixel_shadows::Result;
use subpixel_shadows::methods::{DebugMap, PixelClass};

/// The colour of each class, with the word for it.
pub const CLASS_COLOURS: [(PixelClass, &str, [u8; 3]); 5] = [
    (PixelClass::Empty, "black", [0, 0, 0]),
    (PixelClass::Dark, "grey-blue", [70, 80, 110]),
    (PixelClass::Lit, "cream", [245, 238, 215]),
    (PixelClass::Shadowed, "green", [0, 130, 90]),
    (PixelClass::Undecided, "red", [213, 50, 30]),
];

/// Colour of a texel without a caster.
pub const NO_CASTER: [u8; 3] = [20, 24, 48];
/// Colour of a marked texel, darker where its caster is farther.
const MARKED: [f32; 3] = [1.0, 0.45, 0.1];

/// Writes the class of each pixel as an RGB picture in [`CLASS_COLOURS`], row 0 at the top.
///
/// # Errors
/// As [`write_png_rgb`].
pub fn write_classes(path: &Path, width: u32, height: u32, classes: &[PixelClass]) -> Result<()> {
    let colour = |class: &PixelClass| CLASS_COLOURS[*class as usize].2;
    write_png_rgb(path, width, height, &classes.iter().map(colour).collect::<Vec<_>>())
}

/// Writes a light-view map as an RGB picture, a pixel a texel: the nearer its caster the brighter, between the nearest and the
/// farthest of the map; [`NO_CASTER`] where there is none. Marked texels are orange; where texels hold triangles each triangle
/// has a hue.
///
/// # Errors
/// As [`write_png_rgb`].
pub fn write_map(path: &Path, map: &DebugMap) -> Result<()> {
    let held = map.depths.iter().filter(|d| d.is_finite()).map(|d| d.clamp(0.0, 1.0));
    let (low, high) = held.fold((1.0f32, 0.0f32), |(low, high), d| (low.min(d), high.max(d)));
    let colour = |texel: usize| {
        let marked = map.marks.get(texel) == Some(&true);
        let depth = map.depths[texel];
        if !depth.is_finite() && !marked {
            return NO_CASTER;
        }
        let far = if depth.is_finite() { (depth.clamp(0.0, 1.0) - low) / (high - low).max(1e-9) } else { 0.0 };
        let tint = match map.triangles.get(texel) {
            _ if marked => MARKED,
            Some(&triangle) => hue(triangle),
            None => [1.0; 3],
        };
        tint.map(|c| (255.0 * c * (1.0 - 0.75 * far)).round() as u8)
    };
    write_png_rgb(
        path,
        map.size,
        map.depths.len() as u32 / map.size.max(1),
        &(0..map.depths.len()).map(colour).collect::<Vec<_>>(),
    )
}

/// Colours of the views of a light, in their order, each with its name.
pub const VIEW_COLOURS: [(&str, [u8; 3]); 6] = [
    ("red", [230, 60, 50]),
    ("green", [60, 190, 70]),
    ("blue", [70, 110, 240]),
    ("yellow", [235, 205, 60]),
    ("violet", [190, 80, 220]),
    ("cyan", [70, 205, 215]),
];

/// Writes a picture tinted by the view of the light that each pixel asks ([`VIEW_COLOURS`]), row 0 at the top. `shaded`: the picture as it is,
/// `triangles`: the triangle at each pixel centre, `u32::MAX` for none, where nothing is tinted.
///
/// # Errors
/// As [`write_png_rgb`].
pub fn write_views(path: &Path, size: [u32; 2], shaded: &[[u8; 3]], triangles: &[u32], views: &[u32]) -> Result<()> {
    let tinted = |((pixel, &triangle), &view): ((&[u8; 3], &u32), &u32)| {
        let (_, tint) = VIEW_COLOURS[view as usize % VIEW_COLOURS.len()];
        if triangle == u32::MAX {
            return *pixel;
        }
        [0, 1, 2].map(|k| ((u32::from(pixel[k]) + u32::from(tint[k])) / 2) as u8)
    };
    write_png_rgb(path, size[0], size[1], &shaded.iter().zip(triangles).zip(views).map(tinted).collect::<Vec<_>>())
}

/// A pale colour of its own for a number.
fn hue(n: u32) -> [f32; 3] {
    let mixed = (n ^ n >> 15).wrapping_mul(0x9e37_79b1);
    let turn = 6.0 * ((mixed ^ mixed >> 16) & 0xffff) as f32 / 65_536.0;
    [0.0, 4.0, 2.0].map(|at| 0.35 + 0.65 * (((turn + at) % 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_class_has_a_colour_of_its_own() {
        for (k, (class, ..)) in CLASS_COLOURS.iter().enumerate() {
            assert_eq!((*class, *class as usize), (PixelClass::ALL[k], k));
        }
        assert_eq!(CLASS_COLOURS.iter().map(|c| c.2).collect::<HashSet<_>>().len(), 5);
    }

    #[test]
    fn views_tint_what_is_seen() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-views-{}.png", std::process::id()));
        write_views(&path, [4, 1], &[[100; 3]; 4], &[0, 5, u32::MAX, 5], &[0, 1, 1, 7]).expect("written");
        let read = image::open(&path).expect("read").into_rgb8().pixels().map(|p| p.0).collect::<Vec<_>>();
        assert_eq!(read, [[165, 80, 75], [80, 145, 85], [100; 3], [80, 145, 85]]);
        // One view too few for the pixels.
        write_views(&path, [4, 1], &[[100; 3]; 4], &[0; 4], &[0; 3]).expect_err("a pixel has no view");
        std::fs::remove_file(path).expect("removed");
    }

    #[test]
    fn near_casters_are_bright_and_neighbours_differ() {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-looks-{}.png", std::process::id()));
        let map = DebugMap {
            size: 2,
            depths: vec![0.2, 0.8, f32::NAN, f32::NAN],
            marks: vec![false, false, true, false],
            ..DebugMap::default()
        };
        let read = |map: &DebugMap| {
            write_map(&path, map).expect("written");
            image::open(&path).expect("read").into_rgb8().pixels().map(|p| p.0).collect::<Vec<_>>()
        };
        let plain = read(&map);
        assert_eq!((plain[0], plain[1], plain[3]), ([255; 3], [64; 3], NO_CASTER));
        assert_eq!(plain[2], [255, 115, 26]);
        let coloured = read(&DebugMap { triangles: vec![0, 1, u32::MAX, u32::MAX], marks: Vec::new(), ..map });
        assert_eq!(coloured[2..], [NO_CASTER; 2]);
        let ways: HashSet<_> = (0..64).map(|n| hue(n).map(|c| (c * 31.0) as u8)).collect();
        assert!(coloured[0] != plain[0] && ways.len() > 32, "{}", ways.len());
        std::fs::remove_file(path).expect("removed");
    }
}
