//! Pictures as files: written beside their place under another name and moved there when complete, so that no
//! half-written file is ever found.

#[cfg(not(target_family = "wasm"))]
use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageResult};
use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use subpixel_shadows::{Error, Result};

/// Writes visibility in `[0, 1]` as an 8-bit grey PNG, row 0 at the top. Values outside are clamped, and one that is
/// not a number is black.
///
/// # Errors
/// [`Error::File`] naming `path` if the file cannot be written, [`Error::Config`] if the sizes do not agree.
pub fn write_png_grey(path: &Path, width: u32, height: u32, visibility: &[f32]) -> Result<()> {
    check(width, height, visibility.len())?;
    let bytes: Vec<u8> = visibility.iter().map(|&v| byte(v)).collect();
    write(path, |out| PngEncoder::new(out).write_image(&bytes, width, height, ExtendedColorType::L8))
}

/// Writes 8-bit RGB as a PNG, row 0 at the top.
///
/// # Errors
/// As [`write_png_grey`].
pub fn write_png_rgb(path: &Path, width: u32, height: u32, pixels: &[[u8; 3]]) -> Result<()> {
    check(width, height, pixels.len())?;
    let bytes = pixels.as_flattened();
    write(path, |out| PngEncoder::new(out).write_image(bytes, width, height, ExtendedColorType::Rgb8))
}

/// Writes visibility as an EXR of 32-bit float RGBA, row 0 at the top: R = G = B = visibility, A = 1 where the pixel
/// centre sees a surface, else A = 0 with visibility 1.
///
/// # Errors
/// As [`write_png_grey`].
#[cfg(not(target_family = "wasm"))]
pub fn write_exr(path: &Path, width: u32, height: u32, visibility: &[f32], centre_hit: &[bool]) -> Result<()> {
    check(width, height, visibility.len())?;
    check(width, height, centre_hit.len())?;
    let pixel = |(&v, &hit): (&f32, &bool)| if hit { [v, v, v, 1.0] } else { [1.0, 1.0, 1.0, 0.0] };
    let pixels: Vec<[f32; 4]> = visibility.iter().zip(centre_hit).map(pixel).collect();
    let bytes = bytemuck::cast_slice(&pixels);
    write(path, |out| OpenExrEncoder::new(out).write_image(bytes, width, height, ExtendedColorType::Rgba32F))
}

/// Writes how `ours` differs from `truth`: the truth in pale grey, red where ours is brighter, blue where it is darker,
/// the stronger the larger the difference. A difference of one sample of 128 still shows.
///
/// # Errors
/// As [`write_png_grey`].
pub fn write_difference(path: &Path, width: u32, height: u32, ours: &[f32], truth: &[f32]) -> Result<()> {
    check(width, height, ours.len())?;
    check(width, height, truth.len())?;
    let pixels: Vec<[u8; 3]> = ours.iter().zip(truth).map(|(&o, &t)| difference_colour(o, t)).collect();
    write_png_rgb(path, width, height, &pixels)
}

/// Writes a text file as a whole or not at all.
///
/// # Errors
/// [`Error::File`] naming `path` if the file cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write(path, |out| Ok(out.write_all(text.as_bytes())?))
}

/// The colour that [`write_difference`] gives a difference.
pub(super) fn difference_colour(ours: f32, truth: f32) -> [u8; 3] {
    let grey = 0.6 + 0.25 * truth.clamp(0.0, 1.0);
    let difference = ours - truth;
    if difference == 0.0 {
        return [byte(grey); 3];
    }
    // The root lifts small differences; not a number is the strongest.
    let strength = if difference.is_nan() { 1.0 } else { 0.2 + 0.8 * difference.abs().min(1.0).sqrt() };
    let (strong, weak) = (byte(grey + (1.0 - grey) * strength), byte(grey * (1.0 - strength)));
    if difference > 0.0 { [strong, weak, weak] } else { [weak, weak, strong] }
}

fn byte(v: f32) -> u8 {
    (v.clamp(0.0, 1.0) * 255.0).round() as u8
}

fn check(width: u32, height: u32, pixels: usize) -> Result<()> {
    if width == 0 || height == 0 || pixels != width as usize * height as usize {
        return Err(Error::Config(format!("{pixels} pixels for a picture of {width} x {height}")));
    }
    Ok(())
}

/// Whether `name` is that of an unfinished file of [`write`], or of a folder of such files
/// (`.subpixel-shadows-…part`), so that nobody misses it when the process that began it is dead.
pub fn part_of_dead(name: &str) -> bool {
    let numbers = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'-');
    let inner = name.strip_prefix('.').and_then(|n| n.strip_suffix(".part"));
    inner
        .and_then(|n| n.rsplit_once(MARK))
        .is_some_and(|(file, after)| numbers(after) && (file.is_empty() || file.ends_with('.')))
}

/// Before the process number in the names of unfinished files and folders.
const MARK: &str = "subpixel-shadows-";

/// A file that is removed again unless it gets its name.
struct Unfinished(Option<PathBuf>);

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // Nothing more can be done about a file that cannot be removed; the error that led here is reported.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// A file that keeps the first fault of the system: encoders put other words in its place.
pub(super) struct Disk {
    file: File,
    fault: Option<String>,
}

impl Disk {
    fn noted<T>(&mut self, done: std::io::Result<T>) -> std::io::Result<T> {
        if let Err(e) = &done
            && e.kind() != std::io::ErrorKind::Interrupted
        {
            self.fault.get_or_insert_with(|| e.to_string());
        }
        done
    }
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let done = self.file.write(bytes);
        self.noted(done)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        let done = self.file.flush();
        self.noted(done)
    }
}

impl Seek for Disk {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        let done = self.file.seek(to);
        self.noted(done)
    }
}

/// Lets `encode` write all of `file`; fails in the words of the system, where it is at fault.
fn fill(file: File, encode: impl FnOnce(&mut BufWriter<Disk>) -> ImageResult<()>) -> std::result::Result<(), String> {
    let mut out = BufWriter::new(Disk { file, fault: None });
    let encoded = encode(&mut out).map_err(|e| e.to_string());
    let encoded = encoded.and_then(|()| out.flush().map_err(|e| e.to_string()));
    // What is left in the buffer of a file that cannot be written is not tried again.
    let (disk, _) = out.into_parts();
    encoded.map_err(|e| disk.fault.unwrap_or(e))?;
    disk.file.sync_all().map_err(|e| e.to_string())
}

/// Lets `encode` write the file and moves it to `path` when it is complete.
pub(super) fn write(path: &Path, encode: impl FnOnce(&mut BufWriter<Disk>) -> ImageResult<()>) -> Result<()> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let fault = |e: &dyn std::fmt::Display| Error::file(path, format!("cannot be written: {e}"));
    let name = path.file_name().ok_or_else(|| Error::file(path, "is not the name of a file"))?;
    let mark = format!(".{MARK}{}-{}.part", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let mut part = std::ffi::OsString::from(".");
    part.push(name);
    part.push(mark);
    let part = path.with_file_name(part);
    let file = File::create_new(&part).map_err(|e| fault(&e))?;
    let mut unfinished = Unfinished(Some(part.clone()));
    fill(file, encode).map_err(|e| fault(&e))?;
    std::fs::rename(&part, path).map_err(|e| fault(&e))?;
    unfinished.0 = None;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An empty folder of this test's own.
    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        path
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn exr_comes_back_bit_equal() {
        let folder = folder("exr");
        let (w, h) = (37, 21);
        let visibility: Vec<f32> = (0..w * h).map(|k| k as f32 / (w * h - 1) as f32).collect();
        let hits: Vec<bool> = (0..w * h).map(|k| k % 5 != 0).collect();
        let path = folder.join("visibility.exr");
        write_exr(&path, w, h, &visibility, &hits).unwrap();
        let read = image::open(&path).unwrap().into_rgba32f();
        assert_eq!((read.width(), read.height()), (w, h));
        for (k, pixel) in read.pixels().enumerate() {
            let v = if hits[k] { visibility[k] } else { 1.0 };
            let expected = [v, v, v, if hits[k] { 1.0 } else { 0.0 }];
            assert_eq!(pixel.0.map(f32::to_bits), expected.map(f32::to_bits), "pixel {k}");
        }
        assert_eq!(names(&folder), ["visibility.exr"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn png_comes_back_and_replaces_what_was_there() {
        let folder = folder("png");
        let path = folder.join("visibility.png");
        for picture in [[1.0, 1.0, 1.0, 1.0], [0.0, 0.5, 1.0, f32::NAN]] {
            write_png_grey(&path, 2, 2, &picture).unwrap();
        }
        assert_eq!(image::open(&path).unwrap().into_luma8().into_raw(), [0, 128, 255, 0]);
        write_difference(&path, 2, 2, &[0.0, 0.5, 1.0, 0.5], &[0.0, 1.0, 0.5, 0.5]).unwrap();
        let rgb: Vec<[u8; 3]> = image::open(&path).unwrap().into_rgb8().pixels().map(|p| p.0).collect();
        assert!(rgb[0][0] == rgb[0][2] && rgb[3][0] == rgb[3][2], "equal is grey: {rgb:?}");
        assert!(rgb[1][2] > rgb[1][0] && rgb[2][0] > rgb[2][2], "darker is blue, brighter red: {rgb:?}");
        assert_eq!(names(&folder), ["visibility.png"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn faults_name_the_file_and_leave_nothing() {
        let folder = folder("faults");
        let missing = folder.join("nowhere").join("a.png");
        let error = write_png_grey(&missing, 1, 1, &[1.0]).unwrap_err();
        assert!(error.to_string().contains("a.png"), "{error}");
        // A folder of that name is in the way: the finished file cannot be moved there.
        let taken = folder.join("taken.exr");
        std::fs::create_dir(&taken).unwrap();
        let error = write_exr(&taken, 1, 1, &[1.0], &[true]).unwrap_err();
        assert!(matches!(error, Error::File { .. }), "{error}");
        assert_eq!(names(&folder), ["taken.exr"]);
        assert!(write_png_grey(&taken, 2, 1, &[1.0]).is_err());
        assert!(write_png_rgb(&taken, 0, 0, &[]).is_err());
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    #[cfg(unix)]
    fn a_full_disk_is_told_in_the_words_of_the_system() {
        let pixels = [0u8; 16 * 64 * 64];
        let exr = |out: &mut BufWriter<Disk>| {
            OpenExrEncoder::new(out).write_image(&pixels, 64, 64, ExtendedColorType::Rgba32F)
        };
        let png =
            |out: &mut BufWriter<Disk>| PngEncoder::new(out).write_image(&pixels, 64, 64, ExtendedColorType::Rgba32F);
        let full = || File::options().write(true).open("/dev/full").unwrap();
        let faults = [fill(full(), exr).unwrap_err(), fill(full(), |out| Ok(out.write_all(b"text")?)).unwrap_err()];
        assert!(faults.iter().all(|e| e == "No space left on device (os error 28)"), "{faults:?}");
        // What is no fault of the system keeps the encoder's words.
        let refused = fill(full(), png).unwrap_err();
        assert!(refused.contains("Rgba32F"), "{refused}");
    }

    #[test]
    fn unfinished_files_are_known_by_their_names() {
        for name in [".subpixel-shadows-7.part", ".subpixel-shadows-7-0.part", ".a.b.subpixel-shadows-1-22.part"] {
            assert!(part_of_dead(name), "{name}");
        }
        let others = ["subpixel-shadows-7.part", ".subpixel-shadows-.part", ".subpixel-shadows-7x.part", ".a.7-0.part"];
        for name in others.iter().chain(&[".subpixel-shadows-7", ".asubpixel-shadows-7.part", ".part", ""]) {
            assert!(!part_of_dead(name), "{name}");
        }
    }
}
