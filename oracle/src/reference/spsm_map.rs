//! The closest triangle that touches each texel, and its 128-bit record.

use super::triangle_setup::Triangle;
use super::view::{Flat, by_rows, centre, columns};
use glam::{DVec2, DVec3};
use subpixel_shadows::spsm_code::SlopeCode;

/// The last word of an empty texel's record.
pub const EMPTY: u32 = u32::MAX;

/// Times its own range of depths by which a triangle may count as nearer than it is.
const LIFT: f64 = 2.0;

/// Least depth of the triangle's plane over the square, held to two ranges of depth before its nearest corner.
pub fn lifted(flat: &Flat, at: DVec2, reach: f64, margin: f64) -> f64 {
    let (lo, hi) = flat.depths();
    let first = lo - margin - LIFT * (hi - lo + 2.0 * margin);
    match flat.slope.filter(|_| !flat.is_thin()) {
        None => first,
        Some(slope) => {
            let middle = flat.corners[0].z + slope.dot(at - flat.corners[0].truncate());
            (middle - reach * (slope.x.abs() + slope.y.abs()) - margin).max(first)
        }
    }
}

/// Least conservative depth and triangle of each texel: of all triangles that touch the square of half side `reach` around
/// its centre the one with the least [`lifted`] depth there; of equals the lowest.
pub fn closest(triangles: &[Triangle], size: u32, reach: f64, margin: f64) -> Vec<Option<(f64, u32)>> {
    let figures: Vec<Option<Flat>> = triangles.iter().map(Triangle::flat).collect();
    by_rows(&figures, size, reach, |y, list, row: &mut [_]| {
        for &t in list {
            let Some(flat) = &figures[t as usize] else { continue };
            for x in columns(flat, reach, size).filter(|&x| flat.touches(centre(x, y), reach)) {
                let depth = lifted(flat, centre(x, y), reach, margin);
                let held: &mut Option<(f64, u32)> = &mut row[x as usize];
                if held.is_none_or(|(d, _)| depth < d) {
                    *held = Some((depth, t));
                }
            }
        }
    })
}

/// How records are made and read.
#[derive(Clone, Debug)]
pub struct Coding {
    /// Edge lines; else the paper's.
    pub lines: bool,
    /// The slope code of the paper's.
    pub slopes: SlopeCode,
    /// Texels a side.
    pub size: u32,
}

/// A decoded record, around its texel's centre, in texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Inside where `dot((x, y, 1), edge) >= 0`; |x| + |y| of each normal is 1.
    pub edges: [DVec3; 3],
    /// Depth per x, per y, at the centre.
    pub depth: DVec3,
    /// How far that may be off: per |x|, per |y|, at the centre.
    pub doubt: DVec3,
}

/// Slope in 16 bits: sign, 5 bits of exponent from 2^-20, 10 of mantissa.
pub fn slope_code_16(slope: f32) -> u32 {
    let size = ((slope.to_bits() & 0x7fff_ffff) + 0x1000) >> 13;
    (size as i32 - (107 << 10)).clamp(0, 0x7ffe) as u32 | slope.to_bits() >> 31 << 15
}

/// The slope of a 16-bit code.
pub fn slope_of_16(code: u32) -> f32 {
    match code & 0x7fff {
        0 => 0.0,
        size => f32::from_bits((size + (107 << 10)) << 13 | code >> 15 << 31),
    }
}

/// A value of 0 to 1 in steps of 1 / `most`.
pub fn unorm_code(value: f32, most: f32) -> u32 {
    (value.clamp(0.0, 1.0) * most + 0.5).floor() as u32
}

/// Likewise of a depth: what lies beyond the range, as a ground behind all casters may, has the code after the last.
pub fn depth_code(value: f32, most: f32) -> u32 {
    (value.max(0.0) * most + 0.5).floor().min(most + 1.0) as u32
}

/// Doubt of the depth of what lies beyond the range of the code: it is before nothing.
pub const BEYOND: f64 = 1e6;

/// Direction of a normal with |x| + |y| = 1, as its place around the diamond.
pub fn direction_code(x: f32, y: f32) -> u32 {
    let place = if y >= 0.0 { 1.0 - x } else { 3.0 + x };
    (place * 1024.0 + 0.5).floor() as u32 & 4095
}

/// Distance of an edge from the centre.
pub fn distance_code(distance: f32) -> u32 {
    (((distance + 0.75) * 1024.0).clamp(0.0, 4095.0) + 0.5).floor() as u32
}

fn edge(a: DVec2, b: DVec2, turn: f64) -> DVec3 {
    let n = turn * DVec2::new(a.y - b.y, b.x - a.x);
    let size = n.x.abs() + n.y.abs();
    if size > 0.0 { (n / size).extend(-(n / size).dot(a)) } else { DVec3::new(1.0, 0.0, -0.75) }
}

impl Coding {
    /// The record of a triangle in the texel around `middle`.
    pub fn encode(&self, flat: &Flat, middle: DVec2) -> [u32; 4] {
        let [a, b, c] = flat.corners.map(|p| p.truncate() - middle);
        let side = f64::from(self.size);
        let steepest = 2048.0 * side;
        let plane = match flat.slope {
            Some(s) if s.abs().max_element() < steepest => s.extend(flat.corners[0].z - s.dot(a)),
            _ => DVec3::new(0.0, 0.0, flat.depths().0),
        };
        let [x, y] = [plane.x, plane.y].map(|s| (s * side) as f32);
        if !self.lines {
            let vertex = |v: DVec2| {
                let [x, y] = ((v + middle) / side).to_array().map(|c| unorm_code(c as f32, 65_535.0));
                x | y << 16
            };
            let depth = depth_code(plane.z as f32, 65_534.0);
            let slopes = self.slopes.encode(y) << 8 | self.slopes.encode(x);
            return [vertex(a), vertex(b), vertex(c), depth << 16 | slopes];
        }
        let turn = if (b - a).perp_dot(c - a) > 0.0 { 1.0 } else { -1.0 };
        let depth = depth_code(((plane.z + 1.0) / 3.0) as f32, 16_777_214.0);
        let word = |k: usize, from, to| {
            let e = edge(from, to, turn);
            let direction = direction_code(e.x as f32, e.y as f32);
            direction << 20 | distance_code(e.z as f32) << 8 | depth >> (16 - 8 * k) & 255
        };
        [word(0, a, b), word(1, b, c), word(2, c, a), slope_code_16(y) << 16 | slope_code_16(x)]
    }

    /// The sheet of a record; `None` where the texel is empty.
    pub fn decode(&self, record: [u32; 4], middle: DVec2) -> Option<Sheet> {
        if record[3] == EMPTY {
            return None;
        }
        let side = f64::from(self.size);
        if !self.lines {
            // Whole numbers, which f64 holds with room for their products.
            let codes = [0, 1, 2].map(|k| DVec2::new(f64::from(record[k] & 0xffff), f64::from(record[k] >> 16)));
            let area = (codes[1] - codes[0]).perp_dot(codes[2] - codes[0]);
            let turn = if area > 0.0 { 1.0 } else { -1.0 };
            let [a, b, c] = codes.map(|code| (code * 2.0 * side - middle * 131_070.0) / 131_070.0);
            let mut edges = [edge(a, b, turn), edge(b, c, turn), edge(c, a, turn)];
            if area == 0.0 {
                edges[0] = DVec3::new(1.0, 0.0, -64.0);
            }
            let slope = |k: u32| (record[3] >> (8 * k) & 255).min(254) as usize;
            let [x, y] = [slope(0), slope(1)].map(|k| f64::from(self.slopes.values[k]) / side);
            let [dx, dy] = [slope(0), slope(1)].map(|k| f64::from(self.slopes.bounds[k]) / side);
            let depth = DVec3::new(x, y, f64::from(record[3] >> 16) / 65_534.0);
            let doubt = if record[3] >> 16 == 65_535 { BEYOND } else { 7.7e-6 };
            return Some(Sheet { edges, depth, doubt: DVec3::new(dx, dy, doubt) });
        }
        let edges = [0, 1, 2].map(|k| {
            let place = f64::from(record[k] >> 20) / 1024.0;
            let x = if place <= 2.0 { 1.0 - place } else { place - 3.0 };
            let y = (1.0 - x.abs()) * if place <= 2.0 { 1.0 } else { -1.0 };
            let code = record[k] >> 8 & 4095;
            DVec3::new(x, y, if code == 4095 { 64.0 } else { f64::from(code) / 1024.0 - 0.75 })
        });
        let depth = (record[0] & 255) << 16 | (record[1] & 255) << 8 | record[2] & 255;
        let [x, y] = [record[3] & 0xffff, record[3] >> 16].map(|c| f64::from(slope_of_16(c)) / side);
        let rest = 9.5e-7 / side;
        let beyond = if depth == 16_777_215 { BEYOND } else { 4e-7 };
        let doubt = DVec3::new(x.abs() / 2048.0 + rest, y.abs() / 2048.0 + rest, beyond);
        Some(Sheet { edges, depth: DVec3::new(x, y, f64::from(depth) * 3.0 / 16_777_214.0 - 1.0), doubt })
    }
}
