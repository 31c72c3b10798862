//! Wavefront OBJ: positions and faces; polygons become triangle fans.

use super::text::{coordinate, integer, shown, without_bom, words};
use super::{Loaded, Mesh, Parsed, numbered};

/// Statements that say nothing of where surfaces are, or only how they look.
const IGNORED: [&[u8]; 34] = [
    b"vt",
    b"vn",
    b"g",
    b"o",
    b"s",
    b"mg",
    b"usemap",
    b"maplib",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"lod",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"call",
    b"csh",
    b"vp",
    b"vs",
    b"fl",
    b"cv",
    b"mtllib",
    b"cstype",
    b"deg",
    b"bmat",
    b"step",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
];

/// Statements of what is not read and told of: points and lines, materials, free-form curves and surfaces.
const THIN: [&[u8]; 2] = [b"l", b"p"];
const MATERIALS: &[u8] = b"usemtl";
const FREE_FORM: [&[u8]; 8] = [b"curv", b"curv2", b"surf", b"bzp", b"bsp", b"cdc", b"cdp", b"res"];

/// Reads an OBJ file.
pub(super) fn parse(bytes: &[u8]) -> Parsed<Loaded> {
    let mut reader = Reader::default();
    let mut lines = without_bom(bytes).split(|&b| b == b'\n').zip(1u64..);
    while let Some((line, number)) = lines.next() {
        let mut line = std::borrow::Cow::Borrowed(line.trim_ascii_end());
        // A backslash at the end of a line continues it.
        while let Some(start) = line.strip_suffix(b"\\").filter(|_| !line.trim_ascii_start().starts_with(b"#")) {
            let mut joined = start.to_vec();
            joined.push(b' ');
            let Some((next, _)) = lines.next() else {
                return Err(format!("line {number}: the file ends after a backslash"));
            };
            joined.extend_from_slice(next.trim_ascii_end());
            line = joined.into();
        }
        reader.statement(&line, number).map_err(|e| format!("line {number}: {e}"))?;
    }
    reader.finish()
}

#[derive(Default)]
struct Reader {
    mesh: Mesh,
    /// Corners of the face being read.
    face: Vec<u32>,
    /// The highest vertex that a face used before it was declared, and the line.
    ahead: Option<(u32, u64)>,
    /// Statements of points and lines, of materials, of free-form curves and surfaces.
    thin: usize,
    materials: usize,
    free_form: usize,
}

impl Reader {
    fn statement(&mut self, line: &[u8], number: u64) -> Parsed<()> {
        let mut words = words(line);
        match words.next() {
            Some(b"v") => self.vertex(words),
            Some(b"f" | b"fo") => self.face(words, number),
            Some(keyword) if keyword.starts_with(b"#") || IGNORED.contains(&keyword) => Ok(()),
            Some(keyword) => self.unread(keyword),
            None => Ok(()),
        }
    }

    /// Counts a statement that is known and not read.
    fn unread(&mut self, keyword: &[u8]) -> Parsed<()> {
        let counter = if THIN.contains(&keyword) {
            &mut self.thin
        } else if keyword == MATERIALS {
            &mut self.materials
        } else if FREE_FORM.contains(&keyword) {
            &mut self.free_form
        } else {
            return Err(format!("{} is not an OBJ statement", shown(keyword)));
        };
        *counter += 1;
        Ok(())
    }

    fn vertex<'a>(&mut self, mut words: impl Iterator<Item = &'a [u8]>) -> Parsed<()> {
        let index = self.mesh.positions.len();
        let mut position = [0.0; 3];
        for (k, c) in position.iter_mut().enumerate() {
            let word = words.next().ok_or_else(|| format!("vertex {index} has {k} coordinates, needs 3"))?;
            *c = coordinate(word).map_err(|e| format!("vertex {index}: {e}"))?;
        }
        if index >= u32::MAX as usize {
            return Err(format!("vertex {index} is above the limit of {}", u32::MAX));
        }
        // A weight or a colour may follow; neither moves the vertex.
        self.mesh.positions.push(position);
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>, number: u64) -> Parsed<()> {
        let declared = self.mesh.positions.len();
        self.face.clear();
        for word in words.take_while(|w| !w.starts_with(b"#")) {
            let vertex = word.split(|&b| b == b'/').next().unwrap_or(word);
            let index = integer(vertex)?;
            let resolved = if index < 0 { declared as i64 + index } else { index - 1 };
            let resolved = u32::try_from(resolved)
                .ok()
                .filter(|&v| index != 0 && v < u32::MAX)
                .ok_or_else(|| format!("face uses vertex {index}, {declared} are declared so far"))?;
            if resolved as usize >= declared && self.ahead.is_none_or(|(v, _)| resolved > v) {
                self.ahead = Some((resolved, number));
            }
            self.face.push(resolved);
        }
        if self.face.len() < 3 {
            return Err(format!("face has {} corners, needs 3", self.face.len()));
        }
        let first = self.face[0];
        self.mesh.triangles.extend(self.face[1..].windows(2).map(|w| [first, w[0], w[1]]));
        if self.mesh.triangles.len() > Mesh::MAX_TRIANGLES {
            return Err(format!("more than {} triangles", Mesh::MAX_TRIANGLES));
        }
        Ok(())
    }

    fn finish(self) -> Parsed<Loaded> {
        let n = self.mesh.positions.len();
        match self.ahead {
            Some((v, line)) if v as usize >= n => {
                Err(format!("line {line}: face uses vertex {}, the file has {n}", u64::from(v) + 1))
            }
            _ => {
                let ignored = numbered([
                    (self.thin, "statement of points or lines", "statements of points or lines"),
                    (self.materials, "use of a material", "uses of materials"),
                    (self.free_form, "free-form curve or surface", "free-form curves and surfaces"),
                ]);
                Ok(Loaded { mesh: self.mesh, ignored, ..Loaded::default() })
            }
        }
    }
}
