//! Small files that hold one tetrahedron each, and a folder to put them in.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

/// A temporary folder that goes away with the value.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let unique = format!("subpixel-{name}-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(unique);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Writes a file and returns its path.
    pub fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.join(name);
        // Some file systems write a file through to the disk when it is overwritten, but not when it is new.
        let _ = std::fs::remove_file(&path);
        std::fs::write(&path, bytes).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub const POSITIONS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
pub const TRIANGLES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

pub fn ply_text() -> String {
    let mut text = String::from(
        "ply\nformat ascii 1.0\ncomment made here\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n",
    );
    POSITIONS.iter().for_each(|p| text += &format!("{} {} {}\n", p[0], p[1], p[2]));
    TRIANGLES.iter().for_each(|t| text += &format!("3 {} {} {}\n", t[0], t[1], t[2]));
    text
}

/// With properties in an unusual order, of unusual types, and elements and lists that are of no interest.
pub fn ply_binary(big: bool) -> Vec<u8> {
    let format = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement camera 1\nproperty list uchar double k\nproperty short f\nelement vertex 4\nproperty uchar red\nproperty double z\nproperty float x\nproperty int y\nproperty list ushort uint seen\nelement face 4\nproperty float quality\nproperty list uint ushort vertex_index\nelement edge 2\nproperty int a\nend_header\n"
    )
    .into_bytes();
    let mut put = |little: &[u8]| {
        let mut value = little.to_vec();
        if big {
            value.reverse();
        }
        bytes.extend(value);
    };
    put(&[2]);
    put(&1.5f64.to_le_bytes());
    put(&2.5f64.to_le_bytes());
    put(&7i16.to_le_bytes());
    for (k, p) in POSITIONS.iter().enumerate() {
        put(&[200]);
        put(&f64::from(p[2]).to_le_bytes());
        put(&p[0].to_le_bytes());
        put(&(p[1] as i32).to_le_bytes());
        put(&(k as u16).to_le_bytes());
        (0..k).for_each(|i| put(&(i as u32).to_le_bytes()));
    }
    for t in TRIANGLES {
        put(&0.5f32.to_le_bytes());
        put(&3u32.to_le_bytes());
        t.iter().for_each(|v| put(&v.to_le_bytes()));
    }
    put(&1i32.to_le_bytes());
    put(&2i32.to_le_bytes());
    bytes
}

/// Positions, then indices.
pub fn tetrahedron_bin() -> Vec<u8> {
    let positions = POSITIONS.iter().flatten().flat_map(|c| c.to_le_bytes());
    positions.chain(TRIANGLES.iter().flatten().flat_map(|v| v.to_le_bytes())).collect()
}

/// The parts of a glTF document, each of which a test may change.
#[derive(Clone)]
pub struct GltfText {
    pub asset: String,
    pub uri: String,
    pub bytes: usize,
    pub views: String,
    pub accessors: String,
    pub primitive: String,
    pub nodes: String,
    pub scene: String,
    pub extra: String,
}

impl Default for GltfText {
    fn default() -> Self {
        Self {
            asset: r#"{"version":"2.0"}"#.into(),
            uri: r#","uri":"t.bin""#.into(),
            bytes: 72,
            views: r#"[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}]"#.into(),
            accessors: r#"[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
                {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}]"#
                .into(),
            primitive: r#"{"attributes":{"POSITION":0},"indices":1}"#.into(),
            nodes: r#"[{"mesh":0}]"#.into(),
            scene: r#""scene":0,"scenes":[{"nodes":[0]}]"#.into(),
            extra: String::new(),
        }
    }
}

impl GltfText {
    pub fn render(&self) -> String {
        let Self { asset, uri, bytes, views, accessors, primitive, nodes, scene, extra } = self;
        format!(
            r#"{{"asset":{asset},"buffers":[{{"byteLength":{bytes}{uri}}}],"bufferViews":{views},"accessors":{accessors},
            "meshes":[{{"name":"chair","primitives":[{primitive}]}}],"nodes":{nodes},{scene}{extra}}}"#
        )
    }

    pub fn without_uri(mut self) -> Self {
        self.uri.clear();
        self
    }

    pub fn with_data_uri(mut self) -> Self {
        self.uri = format!(r#","uri":"data:application/octet-stream;base64,{}""#, base64(&tetrahedron_bin()));
        self
    }
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let bits = (0..3).fold(0u32, |bits, k| bits << 8 | u32::from(*chunk.get(k).unwrap_or(&0)));
        for k in 0..4 {
            let digit = if k <= chunk.len() { DIGITS[(bits >> (18 - 6 * k) & 63) as usize] } else { b'=' };
            text.push(digit as char);
        }
    }
    text
}

pub fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().div_ceil(4) * 4, b' ');
    let mut bytes = b"glTF".to_vec();
    let words = [2, 12 + 8 + json.len() as u32 + 8 + bin.len() as u32, json.len() as u32];
    words.iter().for_each(|w| bytes.extend(w.to_le_bytes()));
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((bin.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(bin);
    bytes
}
