//! Files made here in every format that is read, and ways to damage them.

use std::path::{Path, PathBuf};

/// Numbers that look random and are the same for the same seed.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03)
    }

    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((u128::from(self.0 >> 11) * n as u128) >> 53) as usize
    }

    fn one_of<'a, T>(&mut self, things: &'a [T]) -> &'a T {
        &things[self.below(things.len())]
    }
}

/// A file that can be read, with the files that it names.
pub struct Sound {
    /// Its format, as the tables call it.
    pub format: &'static str,
    pub extension: &'static str,
    pub bytes: Vec<u8>,
}

/// A box on a floor and a bent strip: closed and open parts, edges of two faces and of one, triangles that see each
/// other.
fn solid() -> (Vec<[f32; 3]>, Vec<[u16; 3]>) {
    let mut positions: Vec<[f32; 3]> =
        (0..8u8).map(|k| [f32::from(k & 1), 0.25 + f32::from(k >> 1 & 1), f32::from(k >> 2)]).collect();
    let mut triangles: Vec<[u16; 3]> = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    positions.extend([[-3.0, 0.0, -3.0], [4.0, 0.0, -3.0], [4.0, 0.0, 4.0], [-3.0, 0.0, 4.0]]);
    triangles.extend([[8, 10, 9], [8, 11, 10]]);
    positions.extend([[-1.0, 0.5, 1.0], [-1.0, 1.5, 1.0], [-0.5, 0.5, 1.5], [-0.5, 1.5, 1.5], [0.0, 0.5, 1.5]]);
    triangles.extend([[12, 13, 14], [14, 13, 15], [14, 15, 16]]);
    (positions, triangles)
}

fn ply_text() -> Vec<u8> {
    let (positions, triangles) = solid();
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment a box\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\n\
         property uchar red\nelement face {}\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\n\
         end_header\n",
        positions.len(),
        triangles.len()
    );
    positions.iter().for_each(|p| text += &format!("{} {} {} 200\n", p[0], p[1], p[2]));
    triangles.iter().for_each(|t| text += &format!("3 {} {} {}\n", t[0], t[1], t[2]));
    text += "7\n";
    text.into_bytes()
}

fn ply_binary(big: bool) -> Vec<u8> {
    let (positions, triangles) = solid();
    let format = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty double z\nproperty float x\nproperty float y\n\
         property list uchar ushort seen\nelement tristrips 1\nproperty list int int vertex_indices\nelement face {}\n\
         property list uint ushort vertex_index\nend_header\n",
        positions.len(),
        triangles.len()
    )
    .into_bytes();
    let mut put = |little: &[u8]| {
        let mut value = little.to_vec();
        if big {
            value.reverse();
        }
        bytes.extend(value);
    };
    for (k, p) in positions.iter().enumerate() {
        put(&f64::from(p[2]).to_le_bytes());
        put(&p[0].to_le_bytes());
        put(&p[1].to_le_bytes());
        put(&[(k % 3) as u8]);
        (0..k % 3).for_each(|i| put(&(i as u16).to_le_bytes()));
    }
    put(&7i32.to_le_bytes());
    [8i32, 9, 11, 10, -1, 12, 13].iter().for_each(|v| put(&v.to_le_bytes()));
    for t in triangles {
        put(&3u32.to_le_bytes());
        t.iter().for_each(|v| put(&v.to_le_bytes()));
    }
    bytes
}

fn obj() -> Vec<u8> {
    let (positions, triangles) = solid();
    let mut text = String::from("# a box\nmtllib box.mtl\no box\nvn 0 1 0\nvt 0.5 0.5\n");
    positions.iter().for_each(|p| text += &format!("v {} {} {}\n", p[0], p[1], p[2]));
    text += "usemtl wood\ns off\n";
    for (k, t) in triangles.iter().enumerate() {
        let n = positions.len() as i32;
        let [a, b, c] = t.map(|v| i32::from(v) + 1);
        text += &match k % 3 {
            0 => format!("f {a} {b} {c}\n"),
            1 => format!("f {a}/1/1 {b}//1 {c}/1\n"),
            _ => format!("f {} {} \\\n {}\n", a - n - 1, b - n - 1, c - n - 1),
        };
    }
    text += "f 9 12 11 10\nl 1 2\np 3\n";
    text.into_bytes()
}

/// Positions as floats and as normalized shorts, indices, a strip, a sparse replacement; with what is not read beside
/// it.
pub fn gltf_buffer() -> Vec<u8> {
    let (positions, triangles) = solid();
    let mut bytes: Vec<u8> = positions.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    bytes.resize(204, 0);
    bytes.extend(triangles.iter().flatten().flat_map(|v| v.to_le_bytes()));
    bytes.resize(308, 0);
    // Four quantised positions at stride 8, a strip of four, one sparse index and its value.
    let corners: [[i16; 4]; 4] = [[0, 9000, 0, 0], [0, 20000, 0, 0], [32767, 9000, 0, 0], [32767, 20000, -5, 0]];
    bytes.extend(corners.iter().flatten().flat_map(|c| c.to_le_bytes()));
    bytes.extend([0, 1, 2, 3, 2, 0, 0, 0]);
    bytes.extend([0.5f32, 2.0, 0.5].iter().flat_map(|c| c.to_le_bytes()));
    bytes
}

fn gltf(buffer: &str) -> String {
    let n = gltf_buffer().len();
    format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_mesh_quantization","KHR_lights_punctual"],
"extensionsRequired":["KHR_mesh_quantization"],"scene":0,"scenes":[{{"nodes":[0,2]}}],
"nodes":[{{"mesh":0,"children":[1],"scale":[1,1,1]}},{{"mesh":1,"translation":[0,0,2],"rotation":[0,0.6,0,0.8],"scale":[-2,1,1]}},
{{"children":[3,4]}},{{"camera":0,"translation":[2,4,6],"rotation":[-0.27,0.15,0.04,0.95]}},
{{"extensions":{{"KHR_lights_punctual":{{"light":0}}}},"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,1,5,2,1]}}],
"cameras":[{{"type":"perspective","perspective":{{"yfov":0.7,"znear":0.1}}}}],
"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"point"}}]}}}},"skins":[{{"joints":[1]}}],
"meshes":[{{"name":"box","primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"targets":[{{"POSITION":0}}]}}]}},
{{"name":"sheet","primitives":[{{"attributes":{{"POSITION":2}},"indices":3,"mode":5}},{{"attributes":{{"POSITION":2}},"mode":6}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":17,"type":"VEC3","sparse":{{"count":1,
"indices":{{"bufferView":4,"componentType":5121}},"values":{{"bufferView":5}}}}}},
{{"bufferView":1,"componentType":5123,"count":51,"type":"SCALAR"}},
{{"bufferView":2,"componentType":5122,"normalized":true,"count":4,"type":"VEC3"}},
{{"bufferView":3,"componentType":5121,"count":4,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":204}},{{"buffer":0,"byteOffset":204,"byteLength":102}},
{{"buffer":0,"byteOffset":308,"byteLength":32,"byteStride":8}},{{"buffer":0,"byteOffset":340,"byteLength":4}},
{{"buffer":0,"byteOffset":344,"byteLength":1}},{{"buffer":0,"byteOffset":348,"byteLength":12}}],
"buffers":[{{"byteLength":{n}{buffer}}}]}}"#
    )
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = |chunk: &[u8]| {
        let bits = (0..3).fold(0u32, |bits, k| bits << 8 | u32::from(*chunk.get(k).unwrap_or(&0)));
        (0..4).map(move |k| DIGITS[(bits >> (18 - 6 * k) & 63) as usize] as char).collect::<String>()
    };
    let text: String = bytes.chunks(3).map(digits).collect();
    let padding = (3 - bytes.len() % 3) % 3;
    format!("{}{}", &text[..text.len() - padding], "=".repeat(padding))
}

/// A binary glTF file of the two chunks.
fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
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

const TOML: &str = "mesh = \"box.obj\"\nground = true\n[camera]\neye = [4.0, 3.0, 6.0]\ntarget = [0.0, 1.0, 0.0]\n\
                    up = [0.0, 1.0, 0.0]\nfov = 40.0\n[light]\n\
                    spot = [3.0, 6.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\nangle = 60.0\n";

/// One or more files of each format, all of which can be read.
pub fn sound() -> Vec<Sound> {
    let of = |format, extension, bytes| Sound { format, extension, bytes };
    let data = format!(r#","uri":"data:application/octet-stream;base64,{}""#, base64(&gltf_buffer()));
    vec![
        of("ply, text", "ply", ply_text()),
        of("ply, little endian", "ply", ply_binary(false)),
        of("ply, big endian", "ply", ply_binary(true)),
        of("obj", "obj", obj()),
        of("gltf, buffer beside it", "gltf", gltf(r#","uri":"box.bin""#).into_bytes()),
        of("gltf, data URI", "gltf", gltf(&data).into_bytes()),
        of("glb", "glb", glb(gltf("").as_bytes(), &gltf_buffer())),
        of("toml, of a mesh", "toml", TOML.into()),
        of("toml, built in", "toml", b"builtin = \"plane\"\n[light]\ndirectional = [0.4, 1.0, 0.3]\n".to_vec()),
    ]
}

/// Writes the files that those of [`sound`] name.
pub fn write_companions(folder: &Path) -> std::io::Result<()> {
    std::fs::write(folder.join("box.bin"), gltf_buffer())?;
    std::fs::write(folder.join("box.obj"), obj())
}

/// Spellings of numbers at the borders of what can be held.
const NUMBERS: [&str; 30] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "127",
    "128",
    "255",
    "256",
    "32767",
    "65535",
    "65536",
    "2147483647",
    "-2147483648",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "1e18",
    "1e19",
    "3.4e38",
    "1e39",
    "-1e38",
    "1e-45",
    "1e-30",
    "nan",
    "inf",
    "0.1",
    "5126",
];

/// Pieces of text that mean something in one format or another.
const WORDS: [&str; 26] = [
    "{",
    "}",
    "[",
    "]",
    "\"",
    ",",
    ":",
    "\\",
    "\n",
    " ",
    "#",
    "e",
    "-",
    "null",
    "true",
    "{\"a\":",
    "[[[[",
    "f 1 2 3\n",
    "element vertex 9\n",
    "property list uchar int x\n",
    "../",
    "http://",
    "%2e%2e/",
    "[camera]\n",
    "\u{feff}",
    "\u{202e}",
];

/// Replaces the number that begins at or after `at`, if there is one.
fn replace_number(bytes: &mut Vec<u8>, at: usize, with: &str) {
    let numeric = |b: &u8| b.is_ascii_digit() || matches!(b, b'-' | b'+' | b'.' | b'e');
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|n| at + n) else { return };
    let start = bytes[..start].iter().rposition(|b| !numeric(b)).map_or(0, |n| n + 1);
    let end = bytes[start..].iter().position(|b| !numeric(b)).map_or(bytes.len(), |n| start + n);
    bytes.splice(start..end, with.bytes());
}

/// The bytes of a line about `at`, its end included.
fn line(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|&b| b == b'\n').map_or(0, |n| n + 1);
    let end = bytes[at..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |n| at + n + 1);
    start..end
}

/// Damages `bytes` in one way.
fn damage(bytes: &mut Vec<u8>, others: &[Sound], random: &mut Random) {
    if bytes.is_empty() {
        bytes.push(random.below(256) as u8);
        return;
    }
    let at = random.below(bytes.len());
    let reach = at + 1 + random.below(64.min(bytes.len() - at));
    match random.below(16) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = random.below(256) as u8,
        2 => drop(bytes.drain(at..reach)),
        3 => drop(bytes.splice(at..at, random.one_of::<&str>(&WORDS).bytes())),
        4 => bytes.truncate(at),
        5 => {
            // A piece of another file, of this or another format.
            let other = &random.one_of(others).bytes;
            let from = random.below(other.len());
            let piece = &other[from..other.len().min(from + 1 + random.below(200))];
            drop(bytes.splice(at..reach, piece.iter().copied()));
        }
        6 => {
            let piece = bytes[at..reach].to_vec();
            let times = 1 + random.below(50);
            drop(bytes.splice(at..at, piece.repeat(times)));
        }
        7 => {
            let whole = line(bytes, at);
            let copy = bytes[whole.clone()].to_vec();
            if random.below(2) == 0 {
                drop(bytes.drain(whole))
            } else {
                drop(bytes.splice(whole.start..whole.start, copy))
            }
        }
        8 => {
            let (one, two) = (line(bytes, at), line(bytes, random.below(bytes.len())));
            let piece = bytes[two].to_vec();
            drop(bytes.splice(one, piece));
        }
        9 => {
            // A word of a binary part.
            let words: [u32; 9] = [0, 1, u32::MAX, 0x7f80_0000, 0x7fc0_0000, 0x7f7f_ffff, 1, 0x8000_0000, 0x7fff_ffff];
            let mut word = random.one_of(&words).to_le_bytes();
            if random.below(2) == 0 {
                word.reverse();
            }
            let end = bytes.len().min(at + 4);
            bytes[at..end].copy_from_slice(&word[..end - at]);
        }
        _ => replace_number(bytes, at, random.one_of::<&str>(&NUMBERS)),
    }
}

/// Another number in place of one, which leaves the rest of the file as it was.
fn renumber(bytes: &mut Vec<u8>, random: &mut Random) {
    if bytes.is_empty() {
        return;
    }
    let at = random.below(bytes.len());
    let with = match random.below(3) {
        0 => random.below(20).to_string(),
        1 => random.below(400).to_string(),
        _ => (*random.one_of::<&str>(&NUMBERS)).to_owned(),
    };
    replace_number(bytes, at, &with);
}

/// A file of a format with 1 to 4 damages, and its number among the formats. Of half of them only numbers are changed,
/// so that they get past the reader of the text; every 16th is sound.
pub fn hostile(sound: &[Sound], random: &mut Random) -> (usize, Vec<u8>) {
    let which = random.below(sound.len());
    let mut bytes = sound[which].bytes.clone();
    let (how, times) = (random.below(16), 1 + random.below(4));
    if how >= 8 {
        (0..times).for_each(|_| damage(&mut bytes, sound, random));
    } else if how > 0 && sound[which].extension == "glb" {
        // The container stays whole.
        let (mut json, mut bin) = (gltf("").into_bytes(), gltf_buffer());
        for _ in 0..times {
            if random.below(3) > 0 { renumber(&mut json, random) } else { damage(&mut bin, sound, random) }
        }
        bytes = glb(&json, &bin);
    } else if how > 0 {
        (0..times).for_each(|_| renumber(&mut bytes, random));
    }
    (which, bytes)
}

/// Whether a message is one line of sensible length that names the file.
pub fn is_one_line_that_names(message: &str, file: &str) -> bool {
    message.contains(file) && message.chars().count() < 700 && !message.contains(char::is_control)
}

/// A folder of its own, gone with the value.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> std::io::Result<Self> {
        let path = std::env::temp_dir().join(format!("subpixel-shadows-hostile-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path)?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
