//! Wavefront OBJ: positions and faces; polygons become triangle fans.

use super::text::{coordinate, integer, shown, without_bom, words};
use super::{Mesh, Parsed};

/// Statements that say nothing of where the surface is. Free-form surfaces are among them: they are not read.
const IGNORED: [&[u8]; 45] = [
    b"vt",
    b"vn",
    b"vp",
    b"l",
    b"p",
    b"g",
    b"o",
    b"s",
    b"mg",
    b"mtllib",
    b"usemtl",
    b"usemap",
    b"maplib",
    b"cstype",
    b"deg",
    b"bmat",
    b"step",
    b"curv",
    b"curv2",
    b"surf",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
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
    b"bzp",
    b"bsp",
    b"cdc",
    b"cdp",
    b"res",
    b"vs",
    b"fl",
    b"cv",
];

/// Reads an OBJ file.
pub(super) fn parse(bytes: &[u8]) -> Parsed<Mesh> {
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
}

impl Reader {
    fn statement(&mut self, line: &[u8], number: u64) -> Parsed<()> {
        let mut words = words(line);
        match words.next() {
            Some(b"v") => self.vertex(words),
            Some(b"f" | b"fo") => self.face(words, number),
            Some(keyword) if keyword.starts_with(b"#") || IGNORED.contains(&keyword) => Ok(()),
            Some(keyword) => Err(format!("{} is not an OBJ statement", shown(keyword))),
            None => Ok(()),
        }
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

    fn finish(self) -> Parsed<Mesh> {
        let n = self.mesh.positions.len();
        match self.ahead {
            Some((v, line)) if v as usize >= n => {
                Err(format!("line {line}: face uses vertex {}, the file has {n}", u64::from(v) + 1))
            }
            _ => Ok(self.mesh),
        }
    }
}
