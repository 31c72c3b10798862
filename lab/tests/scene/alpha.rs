//! Alpha-tested materials of glTF files: where their holes are, and what is wrong with them.

use super::files::{Folder, GltfText, POSITIONS, TRIANGLES, glb, tetrahedron_bin};
use lab::scene::{Loaded, load};
use subpixel_shadows::scene::{AlphaFilter, AlphaWrap};

/// Alpha of a picture of 3 x 2 pixels.
const ALPHA: [u8; 6] = [0, 60, 120, 180, 240, 255];
const UV: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.25], [0.5, 2.0], [-1.0, 0.75]];

fn png(with_alpha: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let to = std::io::Cursor::new(&mut bytes);
    let encoder = image::codecs::png::PngEncoder::new(to);
    let (pixels, colour): (Vec<u8>, _) = match with_alpha {
        true => (ALPHA.iter().flat_map(|&a| [9, 8, 7, a]).collect(), image::ExtendedColorType::Rgba8),
        false => (vec![5; 18], image::ExtendedColorType::Rgb8),
    };
    image::ImageEncoder::write_image(encoder, &pixels, 3, 2, colour).unwrap();
    bytes
}

/// The tetrahedron twice, once mirrored, with texture coordinates and a material; `extra`: images, textures, samplers, materials. The buffer is
/// in the file, and the picture behind it.
fn file(folder: &Folder, name: &str, picture: &[u8], extra: &str) -> Result<Loaded, String> {
    let uv: Vec<u8> = UV.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    let bin = [tetrahedron_bin(), uv, picture.to_vec()].concat();
    let mut padded = bin.clone();
    padded.resize(bin.len().next_multiple_of(4), 0);
    let text = GltfText {
        bytes: bin.len(),
        views: format!(
            r#"[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}},
            {{"buffer":0,"byteOffset":72,"byteLength":32}},{{"buffer":0,"byteOffset":104,"byteLength":{}}}]"#,
            picture.len()
        ),
        accessors: r#"[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
            {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"},
            {"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"}]"#
            .into(),
        primitive: r#"{"attributes":{"POSITION":0},"indices":1},
            {"attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":1}"#
            .into(),
        nodes: r#"[{"mesh":0},{"mesh":0,"scale":[-1,1,1],"translation":[-3,0,0]}]"#.into(),
        scene: r#""scene":0,"scenes":[{"nodes":[0,1]}]"#.into(),
        extra: format!(",{extra}"),
        ..GltfText::default()
    }
    .without_uri();
    let path = folder.file(name, &glb(&text.render(), &padded));
    load(&path).map_err(|e| e.to_string())
}

const IMAGE: &str = r#""images":[{"bufferView":3,"mimeType":"image/png"}],"textures":[{"source":0,"sampler":0}]"#;

#[test]
fn holes_are_those_of_the_material() {
    let folder = Folder::new("alpha");
    let materials = r#""samplers":[{"magFilter":9728,"wrapS":33071,"wrapT":33648}],"materials":[{"alphaMode":"BLEND"},
        {"alphaMode":"MASK","alphaCutoff":0.3,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5],"baseColorTexture":{"index":0,
        "extensions":{"KHR_texture_transform":{"offset":[0.5,0.25],"rotation":1.5707963267948966,"scale":[2,3]}}}}}]"#;
    let loaded = file(&folder, "holes.glb", &png(true), &format!("{IMAGE},{materials}")).unwrap();
    assert_eq!(loaded.note(), Some("not read: 1 see-through material, taken as opaque".to_owned()));
    let [map] = &loaded.alpha.maps[..] else { panic!("{:?}", loaded.alpha.maps) };
    assert_eq!((map.size, &map.alpha[..], map.cutoff), ([3, 2], &ALPHA[..], 0.6));
    assert_eq!((map.filter, map.wrap), (AlphaFilter::Nearest, [AlphaWrap::Clamp, AlphaWrap::Mirror]));
    // Four whole triangles, then four with holes, of each of two nodes.
    let tested: Vec<u32> = loaded.alpha.triangles.iter().map(|of| of.triangle).collect();
    assert_eq!(tested, [4, 5, 6, 7, 12, 13, 14, 15]);
    for (k, of) in loaded.alpha.triangles.iter().enumerate() {
        for (corner, uv) in loaded.mesh.corners(of.triangle as usize).into_iter().zip(of.uv) {
            let [x, y, z] = corner.as_vec3().to_array();
            let at = if k < 4 { [x, y, z] } else { [-3.0 - x, y, z] };
            let vertex = POSITIONS.iter().position(|p| *p == at).unwrap();
            assert!(TRIANGLES[k % 4].contains(&(vertex as u16)));
            // A quarter turn after the scale: (u, v) to (3 v, -2 u).
            let [u, v] = UV[vertex];
            let expected = [0.5 + 3.0 * v, 0.25 - 2.0 * u];
            assert!((0..2).all(|c| (uv[c] - expected[c]).abs() < 1e-5), "{uv:?}, {expected:?} expected");
        }
    }
}

#[test]
fn materials_without_holes_are_whole() {
    let folder = Folder::new("whole");
    let mask = |more: &str| format!(r#"{IMAGE},"samplers":[{{}}],"materials":[{{}},{{"alphaMode":"MASK"{more}}}]"#);
    let texture = r#","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#;
    let whole = |picture: &[u8], more: &str| file(&folder, "whole.glb", picture, &mask(more)).unwrap();
    for (picture, more) in [
        (png(false), texture.to_owned()),
        (png(true), format!(r#","alphaCutoff":0{texture}"#)),
        (png(true), String::new()),
        (b"\xff\xd8\xff, whatever follows".to_vec(), texture.to_owned()),
    ] {
        let loaded = whole(&picture, &more);
        assert!(loaded.alpha.is_empty() && loaded.mesh.triangles.len() == 16, "{more}");
        assert!(loaded.note().is_none_or(|note| !note.contains("PNG")));
    }
    let unread = whole(b"RIFF\0\0\0\0WEBP", texture);
    assert!(unread.alpha.is_empty());
    assert_eq!(unread.note(), Some("not read: 1 alpha-tested material by an image that is no PNG".to_owned()));
    // Below the cutoff everywhere: a hole as a whole.
    let gone = whole(&png(false), r#","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}"#);
    assert!(gone.alpha.triangles.len() == 8 && !gone.alpha.is_solid(0, [0.4, 0.3, 0.3]));
    let here = whole(&png(true), texture);
    assert!(here.alpha.triangles.len() == 8 && here.alpha.maps[0].filter == AlphaFilter::Bilinear);
}

#[test]
fn what_is_wrong_is_told_in_a_line() {
    let folder = Folder::new("wrong");
    let of = |material: &str, images: &str| format!(r#"{images},"samplers":[{{}}],"materials":[{{}},{material}]"#);
    let mask =
        |texture: &str| format!(r#"{{"alphaMode":"MASK","pbrMetallicRoughness":{{"baseColorTexture":{texture}}}}}"#);
    let damaged = png(true)[..40].to_vec();
    let index = |k: u32| mask(&format!(r#"{{"index":{k}}}"#));
    let no_image = r#""textures":[{"source":3,"sampler":0}]"#;
    let no_sampler = r#""images":[{"bufferView":3}],"textures":[{"source":0,"sampler":9}]"#;
    let no_data = r#""images":[{}],"textures":[{"source":0}]"#;
    for (picture, extra, expected) in [
        (png(true), of(&index(7), IMAGE), "material 1: texture 7 is used, there are 1"),
        (png(true), of(&index(0), no_image), "material 1: image 3: is used, there are 0"),
        (png(true), of(&index(0), no_sampler), "material 1: sampler 9 is used, there are 1"),
        (png(true), of(&index(0), no_data), "material 1: image 0: has no data"),
        (damaged, of(&index(0), IMAGE), "material 1: image 0"),
        (png(true), of(&mask(r#"{"index":0,"texCoord":2}"#), IMAGE), "set 2 of texture coordinates"),
        (png(true), of(r#"{"alphaMode":"MASK","alphaCutoff":-1}"#, IMAGE), "cut off at -1"),
        (png(true), format!(r#"{IMAGE},"materials":[]"#), "material 1 is used"),
    ] {
        let told = file(&folder, "wrong.glb", &picture, &extra).unwrap_err();
        assert!(told.contains(expected) && told.contains("wrong.glb") && !told.contains('\n'), "{told}");
    }
}
