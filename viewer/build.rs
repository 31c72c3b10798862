//! The typeface of a web page: the letters that its texts and most names of files are made of. A window has all of it.

use epaint_default_fonts::UBUNTU_LIGHT;
use std::collections::BTreeSet;
use std::path::Path;
use std::{env, fs};

/// Letters of western and central Europe, and signs.
const KEPT: [std::ops::RangeInclusive<u32>; 5] =
    [0x20..=0x17f, 0x2010..=0x2030, 0x2190..=0x2193, 0x2200..=0x2265, 0x25a0..=0x25ff];

/// Tables that drawing needs. Left out are widths for single sizes, substitutions and positions of pairs, and names.
const TABLES: [&[u8; 4]; 11] =
    [b"OS/2", b"cmap", b"cvt ", b"fpgm", b"glyf", b"head", b"hhea", b"hmtx", b"loca", b"maxp", b"prep"];

/// Flags of the parts of a composed glyph.
const WORDS: u16 = 1;
const SCALE: u16 = 8;
const MORE: u16 = 32;
const SCALES: u16 = 64;
const MATRIX: u16 = 128;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let out = env::var_os("OUT_DIR").expect("cargo tells where");
    let made = subset(UBUNTU_LIGHT).expect("a sound typeface");
    fs::write(Path::new(&out).join("typeface.ttf"), made).expect("room for the typeface");
}

fn word(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn long(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn table<'a>(font: &'a [u8], name: &[u8; 4]) -> Option<&'a [u8]> {
    let count = usize::from(word(font, 4)?);
    let at = (0..count).map(|k| 12 + 16 * k).find(|&at| font.get(at..at + 4) == Some(&name[..]))?;
    let (first, length) = (long(font, at + 8)? as usize, long(font, at + 12)? as usize);
    font.get(first..first + length)
}

/// The glyph of a character by a table of format 4.
fn glyph_of(cmap: &[u8], character: u16) -> Option<u16> {
    let count = usize::from(word(cmap, 2)?);
    let of_format_4 = |k: usize| {
        let at = long(cmap, 4 + 8 * k + 4)? as usize;
        (word(cmap, at)? == 4).then(|| &cmap[at..])
    };
    let map = (0..count).find_map(of_format_4)?;
    let twice = usize::from(word(map, 6)?);
    let segment = (0..twice).step_by(2).find(|&k| word(map, 14 + k).is_some_and(|end| end >= character))?;
    let [start, delta, offset] = [1, 2, 3].map(|n| word(map, 16 + n * twice + segment));
    let (start, delta, offset) = (start?, delta?, offset?);
    if start > character {
        return None;
    }
    if offset == 0 {
        return Some(character.wrapping_add(delta));
    }
    let at = 16 + 3 * twice + segment + usize::from(offset) + 2 * usize::from(character - start);
    word(map, at).filter(|&glyph| glyph != 0).map(|glyph| glyph.wrapping_add(delta))
}

/// Glyphs that a glyph is composed of.
fn parts(glyph: &[u8]) -> Option<Vec<u16>> {
    let mut out = Vec::new();
    if glyph.is_empty() || word(glyph, 0)? < 0x8000 {
        return Some(out);
    }
    let mut at = 10;
    loop {
        let flags = word(glyph, at)?;
        out.push(word(glyph, at + 2)?);
        at += 4 + if flags & WORDS != 0 { 4 } else { 2 };
        at += [(SCALE, 2), (SCALES, 4), (MATRIX, 8)].iter().find(|(flag, _)| flags & flag != 0).map_or(0, |s| s.1);
        if flags & MORE == 0 {
            return Some(out);
        }
    }
}

/// The typeface with the outlines of what is kept: all else is empty, and numbers of glyphs stay.
fn subset(font: &[u8]) -> Option<Vec<u8>> {
    let [cmap, glyf, loca, head] = [b"cmap", b"glyf", b"loca", b"head"].map(|name| table(font, name));
    let (cmap, glyf, loca, head) = (cmap?, glyf?, loca?, head?);
    let wide = word(head, 50)? == 1;
    let place = |n: usize| if wide { long(loca, 4 * n) } else { word(loca, 2 * n).map(|half| 2 * u32::from(half)) };
    let count = usize::from(word(table(font, b"maxp")?, 4)?);
    let outline = |n: usize| glyf.get(place(n)? as usize..place(n + 1)? as usize);
    let mut kept: BTreeSet<u16> = KEPT.into_iter().flatten().filter_map(|c| glyph_of(cmap, c as u16)).collect();
    kept.insert(0);
    let mut open: Vec<u16> = kept.iter().copied().collect();
    while let Some(glyph) = open.pop() {
        for part in parts(outline(glyph.into())?)? {
            if kept.insert(part) {
                open.push(part);
            }
        }
    }
    let (mut outlines, mut places) = (Vec::new(), Vec::new());
    for n in 0..=count {
        let at = outlines.len() as u32;
        if wide {
            places.extend(at.to_be_bytes());
        } else {
            places.extend(((at / 2) as u16).to_be_bytes());
        }
        if n < count && kept.contains(&(n as u16)) {
            outlines.extend(outline(n)?);
            outlines.resize(outlines.len().next_multiple_of(4), 0);
        }
    }
    let contents = |name: &[u8; 4]| match name {
        b"glyf" => Some(outlines.clone()),
        b"loca" => Some(places.clone()),
        name => table(font, name).map(<[u8]>::to_vec),
    };
    let mut made = font.get(..4)?.to_vec();
    // Of these tables the greatest power of two is 8.
    made.extend([TABLES.len() as u16, 128, 3, 16 * (TABLES.len() as u16 - 8)].into_iter().flat_map(u16::to_be_bytes));
    let mut body = Vec::new();
    let first = 12 + 16 * TABLES.len();
    for name in TABLES {
        let data = contents(name)?;
        made.extend(name);
        made.extend([0, (first + body.len()) as u32, data.len() as u32].into_iter().flat_map(u32::to_be_bytes));
        body.extend(data);
        body.resize(body.len().next_multiple_of(4), 0);
    }
    made.extend(body);
    Some(made)
}
